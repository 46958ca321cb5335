//! Wavefront OBJ: vertices, vertex normals and faces; materials and texture coordinates are
//! passed over.
//!
//! Read here rather than by a library for three things a scene needs: coordinates in double
//! precision, line numbers in errors, and no way to panic.

use super::{Mesh, MeshFault, MeshFileError};
use glam::DVec3;
use std::collections::HashMap;
use std::path::Path;

/// Statements that carry no surface.
const PASSED_OVER: [&str; 9] = ["vt", "vp", "g", "o", "s", "usemtl", "mtllib", "l", "p"];

/// Reads an OBJ file; polygons become fans of triangles around their first vertex.
pub fn read_obj(path: &Path) -> Result<Mesh, MeshFileError> {
    let bytes =
        std::fs::read(path).map_err(|e| MeshFileError { file: path.into(), line: None, what: e.into() })?;
    parse_obj(path, &bytes)
}

/// Reads the contents of an OBJ file; `name` stands in errors.
pub fn parse_obj(name: &Path, bytes: &[u8]) -> Result<Mesh, MeshFileError> {
    let mut reader = ObjReader::default();
    for (number, line) in bytes.split(|&b| b == b'\n').enumerate() {
        let line = String::from_utf8_lossy(line);
        reader.statement(&line).map_err(|what| MeshFileError {
            file: name.into(),
            line: Some(number + 1),
            what,
        })?;
    }
    if reader.mesh.triangles.is_empty() {
        return Err(MeshFileError { file: name.into(), line: None, what: MeshFault::Empty });
    }
    if !reader.any_normals {
        reader.mesh.normals.clear();
    }
    Ok(reader.mesh)
}

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
    fn statement(&mut self, line: &str) -> Result<(), MeshFault> {
        let line = line.split('#').next().unwrap_or_default();
        let mut words = line.split_ascii_whitespace();
        match words.next() {
            None => Ok(()),
            Some("v") => vector(words).map(|v| self.positions.push(v)),
            Some("vn") => vector(words).map(|v| self.normals.push(v)),
            Some("f") => self.face(words),
            Some(word) if PASSED_OVER.contains(&word) => Ok(()),
            Some(word) => Err(MeshFault::Syntax(format!("unknown statement \"{word}\""))),
        }
    }

    fn face<'a>(&mut self, corners: impl Iterator<Item = &'a str>) -> Result<(), MeshFault> {
        self.polygon.clear();
        for corner in corners {
            let vertex = self.corner(corner)?;
            self.polygon.push(vertex);
        }
        if self.polygon.len() < 3 {
            let found = self.polygon.len();
            return Err(MeshFault::Syntax(format!("a face needs 3 vertices, found {found}")));
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

fn vector<'a>(mut words: impl Iterator<Item = &'a str>) -> Result<DVec3, MeshFault> {
    let mut vector = DVec3::ZERO;
    for axis in 0..3 {
        let word = words.next().ok_or_else(|| MeshFault::Syntax("three coordinates are needed".into()))?;
        vector[axis] = word.parse().map_err(|_| MeshFault::Syntax(format!("\"{word}\" is not a number")))?;
    }
    if vector.is_finite() { Ok(vector) } else { Err(MeshFault::NotFinite) }
}
