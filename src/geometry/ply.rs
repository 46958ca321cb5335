//! Stanford PLY, text or binary: elements `vertex` and `face`; other elements and properties
//! are passed over.

use super::{Mesh, MeshFault, MeshFileError};
use glam::DVec3;
use ply_rs_bw::parser::{ParseError, Parser, Reader};
use ply_rs_bw::ply::{
    ElementDef, Encoding, Header, Property, PropertyAccess, PropertyAccessResult, PropertyType, ScalarType,
};
use std::path::Path;

/// Reads a PLY file; polygons become fans of triangles around their first vertex.
pub fn read_ply(path: &Path) -> Result<Mesh, MeshFileError> {
    let bytes =
        std::fs::read(path).map_err(|e| MeshFileError { file: path.into(), line: None, what: e.into() })?;
    parse_ply(path, &bytes)
}

/// Reads the contents of a PLY file; `name` stands in errors.
pub fn parse_ply(name: &Path, bytes: &[u8]) -> Result<Mesh, MeshFileError> {
    read(bytes).map_err(|(line, what)| MeshFileError { file: name.into(), line, what })
}

/// A fault with the line it is in, where that is known.
type Fault = (Option<usize>, MeshFault);

fn read(bytes: &[u8]) -> Result<Mesh, Fault> {
    let mut reader = Reader::new(bytes);
    let header = Parser::<Item>::new().read_header(&mut reader).map_err(syntax)?;
    let mut mesh = Mesh::default();
    let mut any_normals = false;
    let mut faces = Vec::new();
    for (name, element) in &header.elements {
        check_room(element, &header, reader.get_ref().len()).map_err(|what| (None, what))?;
        let items =
            Parser::<Item>::new().read_payload_for_element(&mut reader, element, &header).map_err(syntax)?;
        match name.as_str() {
            "vertex" => {
                any_normals = has(element, &["nx", "ny", "nz"]);
                require(element, &["x", "y", "z"]).map_err(|what| (None, what))?;
                mesh.positions = items.iter().map(|item| item.position).collect();
                mesh.normals = items.iter().map(|item| item.normal).collect();
            }
            "face" => faces = items,
            _ => {}
        }
    }
    if !any_normals {
        mesh.normals.clear();
    }
    assemble(mesh, &faces).map_err(|what| (None, what))
}

fn assemble(mut mesh: Mesh, faces: &[Item]) -> Result<Mesh, MeshFault> {
    if !mesh.positions.iter().chain(&mesh.normals).all(|v| v.is_finite()) {
        return Err(MeshFault::NotFinite);
    }
    let vertices = mesh.positions.len();
    for face in faces {
        if let Some(&index) = face.indices.iter().find(|&&index| index >= vertices as u32) {
            return Err(MeshFault::NoSuchVertex { index: i64::from(index), vertices });
        }
        if face.indices.len() < 3 {
            let found = face.indices.len();
            return Err(MeshFault::Syntax(format!("a face needs 3 vertices, found {found}")));
        }
        mesh.push_polygon(&face.indices);
    }
    if mesh.triangles.is_empty() { Err(MeshFault::Empty) } else { Ok(mesh) }
}

/// Refuses an element count that the rest of the file cannot hold, before memory is spent.
fn check_room(element: &ElementDef, header: &Header, bytes_left: usize) -> Result<(), MeshFault> {
    let least: usize = match header.encoding {
        // A digit and a space or line break for each property.
        Encoding::Ascii => 2 * element.properties.len(),
        _ => element.properties.iter().map(|(_, p)| least_bytes(&p.data_type)).sum(),
    };
    // The last line of a text may lack its line break.
    let room = bytes_left.saturating_add(1) / least.max(1);
    if element.count > room {
        let what = format!("items of \"{}\"", element.name);
        return Err(MeshFault::Count { what, count: element.count, room });
    }
    Ok(())
}

fn least_bytes(data: &PropertyType) -> usize {
    let (PropertyType::Scalar(scalar) | PropertyType::List(scalar, _)) = data;
    match scalar {
        ScalarType::Char | ScalarType::UChar => 1,
        ScalarType::Short | ScalarType::UShort => 2,
        ScalarType::Int | ScalarType::UInt | ScalarType::Float => 4,
        ScalarType::Double => 8,
    }
}

fn has(element: &ElementDef, names: &[&str]) -> bool {
    names.iter().all(|&name| element.properties.iter().any(|(key, _)| key == name))
}

fn require(element: &ElementDef, names: &[&str]) -> Result<(), MeshFault> {
    if has(element, names) {
        Ok(())
    } else {
        Err(MeshFault::Syntax(format!("\"{}\" lacks one of {names:?}", element.name)))
    }
}

fn syntax(error: ParseError) -> Fault {
    // The message repeats the line number in front of the first line of its explanation.
    let text = error.to_string();
    let text = match error.line() {
        Some(line) => text.trim_start_matches(&format!("Line {line}: ")).to_string(),
        None => text,
    };
    (error.line(), MeshFault::Syntax(text.split_whitespace().collect::<Vec<_>>().join(" ")))
}

/// A vertex or a face, whichever its properties say.
#[derive(Default)]
struct Item {
    position: DVec3,
    normal: DVec3,
    indices: Vec<u32>,
}

impl Item {
    fn number(&mut self, name: &str, value: f64) -> PropertyAccessResult {
        let place = match name {
            "x" => &mut self.position.x,
            "y" => &mut self.position.y,
            "z" => &mut self.position.z,
            "nx" => &mut self.normal.x,
            "ny" => &mut self.normal.y,
            "nz" => &mut self.normal.z,
            _ => return PropertyAccessResult::Ignored,
        };
        *place = value;
        PropertyAccessResult::Set
    }

    fn list(&mut self, name: &str, property: &Property) -> PropertyAccessResult {
        if !matches!(name, "vertex_indices" | "vertex_index") {
            return PropertyAccessResult::Ignored;
        }
        // `None` for a negative index or one that is not whole.
        match property.to_u32_list() {
            Some(indices) => self.indices = indices,
            None => return PropertyAccessResult::UnsupportedType,
        }
        PropertyAccessResult::Set
    }
}

impl PropertyAccess for Item {
    fn new() -> Self {
        Self::default()
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        let value = match property {
            Property::Char(v) => f64::from(v),
            Property::UChar(v) => f64::from(v),
            Property::Short(v) => f64::from(v),
            Property::UShort(v) => f64::from(v),
            Property::Int(v) => f64::from(v),
            Property::UInt(v) => f64::from(v),
            Property::Float(v) => f64::from(v),
            Property::Double(v) => v,
            list => return self.list(name, &list),
        };
        self.number(name, value)
    }
}
