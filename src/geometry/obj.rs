//! Wavefront OBJ: vertices, vertex normals and faces; materials and texture coordinates are
//! passed over.
//!
//! Read here rather than by a library for three things a scene needs: coordinates in double
//! precision, line and column in errors, and no way to panic. What is held is at most 64 times
//! the file's size: nothing is made for a number that is announced, only for words that stand
//! there.

use super::words::{column, words};
use super::{Mesh, MeshFault, MeshFileError};
use crate::input::packed;
use glam::DVec3;
use std::collections::HashMap;
use std::path::Path;

/// Statements that carry no surface.
const PASSED_OVER: [&str; 9] = ["vt", "vp", "g", "o", "s", "usemtl", "mtllib", "l", "p"];

/// Reads the contents of an OBJ file; polygons become fans of triangles around their first
/// vertex, and `name` stands in errors.
pub fn parse_obj(name: &Path, bytes: &[u8]) -> Result<Mesh, MeshFileError> {
    let at = |line: usize, column: usize, what: MeshFault| MeshFileError {
        file: name.into(),
        line: Some(line),
        column: Some(column),
        what,
    };
    if let Some(kind) = packed(bytes) {
        return Err(at(1, 1, MeshFault::Packed(kind)));
    }
    let bytes = bytes.strip_prefix("\u{feff}".as_bytes()).unwrap_or(bytes);
    let mut reader = ObjReader::default();
    for (number, line) in bytes.split(|&b| b == b'\n').enumerate() {
        let line = String::from_utf8_lossy(line);
        reader.statement(&line).map_err(|(byte, what)| at(number + 1, column(&line, byte), what))?;
    }
    if reader.mesh.triangles.is_empty() {
        return Err(at(1, 1, MeshFault::Empty));
    }
    if !reader.any_normals {
        reader.mesh.normals.clear();
    }
    Ok(reader.mesh)
}

/// A fault and the byte of the line that it stands at.
type Fault = (usize, MeshFault);

#[derive(Default)]
struct ObjReader {
    positions: Vec<DVec3>,
    normals: Vec<DVec3>,
    any_normals: bool,
    mesh: Mesh,
    /// Mesh vertex of each pair of position and normal in use.
    vertices: HashMap<(usize, Option<usize>), u32>,
    polygon: Vec<u32>,
}

impl ObjReader {
    fn statement(&mut self, line: &str) -> Result<(), Fault> {
        let line = line.split('#').next().unwrap_or_default();
        let mut words = words(line);
        match words.next() {
            None => Ok(()),
            Some((_, "v")) => vector(line, words).map(|v| self.positions.push(v)),
            Some((start, "vn")) => {
                let normal = vector(line, words)?;
                if normal == DVec3::ZERO {
                    return Err((start, MeshFault::NoDirection));
                }
                self.normals.push(normal);
                Ok(())
            }
            Some((start, "f")) => self.face(start, words),
            Some((_, word)) if PASSED_OVER.contains(&word) => Ok(()),
            Some((start, word)) => Err((start, MeshFault::Syntax(format!("unknown statement \"{word}\"")))),
        }
    }

    fn face<'a>(
        &mut self,
        start: usize,
        corners: impl Iterator<Item = (usize, &'a str)>,
    ) -> Result<(), Fault> {
        self.polygon.clear();
        for (byte, corner) in corners {
            let vertex = self.corner(corner).map_err(|what| (byte, what))?;
            self.polygon.push(vertex);
        }
        if self.polygon.len() < 3 {
            let found = self.polygon.len();
            return Err((start, MeshFault::Syntax(format!("a face needs 3 vertices, found {found}"))));
        }
        self.mesh.push_polygon(&self.polygon);
        Ok(())
    }

    /// A corner: `position`, `position/texture`, `position//normal` or all three.
    fn corner(&mut self, text: &str) -> Result<u32, MeshFault> {
        let mut parts = text.split('/');
        let position = resolve(parts.next().unwrap_or_default(), self.positions.len())?;
        let normal = match parts.nth(1) {
            None | Some("") => None,
            Some(index) => Some(resolve(index, self.normals.len())?),
        };
        let next = u32::try_from(self.mesh.positions.len())
            .map_err(|_| MeshFault::Syntax("too many vertices".into()))?;
        let vertex = *self.vertices.entry((position, normal)).or_insert(next);
        if vertex == next {
            self.mesh.positions.push(self.positions[position]);
            self.mesh.normals.push(normal.map_or(DVec3::ZERO, |index| self.normals[index]));
            self.any_normals |= normal.is_some();
        }
        Ok(vertex)
    }
}

/// An index as written, from 1, or negative from the end, as one from 0.
fn resolve(text: &str, count: usize) -> Result<usize, MeshFault> {
    let index: i64 =
        text.parse().map_err(|_| MeshFault::Syntax(format!("\"{text}\" is not a vertex number")))?;
    let from_zero = match index {
        1.. => usize::try_from(index - 1).ok(),
        0 => None,
        _ => usize::try_from(index.unsigned_abs()).ok().and_then(|back| count.checked_sub(back)),
    };
    from_zero.filter(|&found| found < count).ok_or(MeshFault::NoSuchVertex { index, vertices: count })
}

fn vector<'a>(line: &str, mut words: impl Iterator<Item = (usize, &'a str)>) -> Result<DVec3, Fault> {
    let mut vector = DVec3::ZERO;
    for axis in 0..3 {
        let missing = || (line.trim_end().len(), MeshFault::Syntax("three coordinates are needed".into()));
        let (byte, word) = words.next().ok_or_else(missing)?;
        let wrong = |_| (byte, MeshFault::Syntax(format!("\"{word}\" is not a number")));
        vector[axis] = word.parse().map_err(wrong)?;
        if !vector[axis].is_finite() {
            return Err((byte, MeshFault::NotFinite));
        }
    }
    Ok(vector)
}
