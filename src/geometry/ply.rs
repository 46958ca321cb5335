//! Stanford PLY, text or binary: elements `vertex` and `face`; other elements and properties
//! are passed over.
//!
//! The library knows the format; items are asked of it one at a time, so that a fault has its
//! place and nothing is held but the mesh. What is held is at most 64 times the file's size: an
//! element's count is checked against the bytes that are left before any item is read.

use super::words::{column, words};
use super::{Mesh, MeshFault, MeshFileError};
use crate::input::packed;
use glam::DVec3;
use ply_rs_bw::parser::{ParseError, Parser, Reader};
use ply_rs_bw::ply::{
    ElementDef, Encoding, Header, Property, PropertyAccess, PropertyAccessResult, PropertyType, ScalarType,
};
use std::io::ErrorKind;
use std::path::Path;

/// Reads the contents of a PLY file; polygons become fans of triangles around their first
/// vertex, and `name` stands in errors.
///
/// A fault in binary data stands at the header's line that announces the items.
pub fn parse_ply(name: &Path, bytes: &[u8]) -> Result<Mesh, MeshFileError> {
    read(bytes).map_err(|((line, column), what)| MeshFileError {
        file: name.into(),
        line: Some(line),
        column: Some(column),
        what,
    })
}

/// One-based line and column.
type Place = (usize, usize);

/// A fault and its place.
type Fault = (Place, MeshFault);

fn read(bytes: &[u8]) -> Result<Mesh, Fault> {
    if let Some(kind) = packed(bytes) {
        return Err(((1, 1), MeshFault::Packed(kind)));
    }
    let mut reader = Reader::new(bytes);
    let header = Parser::<Item>::new().read_header(&mut reader).map_err(|e| header_fault(bytes, &e))?;
    let rest = *reader.get_ref();
    let head = &bytes[..bytes.len() - rest.len()];
    let lines_read = head.iter().filter(|&&byte| byte == b'\n').count();
    let mut payload = Payload { encoding: header.encoding, rest, lines_read };
    let mut mesh = Mesh::default();
    let vertices = header.elements.iter().find(|(name, _)| *name == "vertex").map_or(0, |(_, e)| e.count);
    for (_, element) in &header.elements {
        let announced = (line_of(head, &element.name), 1);
        check(element, &header, payload.rest.len()).map_err(|what| (announced, what))?;
        for number in 0..element.count {
            payload.next(element, number, announced, |item| add(&mut mesh, item, element, vertices))?;
        }
    }
    if mesh.triangles.is_empty() {
        return Err(((line_of(head, "face"), 1), MeshFault::Empty));
    }
    Ok(mesh)
}

/// Why a header cannot be read, in words of the file's.
fn header_fault(bytes: &[u8], error: &ParseError) -> Fault {
    let number = error.line().unwrap_or(1);
    let line = bytes.split(|&byte| byte == b'\n').nth(number - 1).unwrap_or_default();
    let what = if !bytes.starts_with(b"ply") {
        "the file does not begin with \"ply\"".to_owned()
    } else if error.kind() == ErrorKind::UnexpectedEof {
        "the header does not end with \"end_header\"".to_owned()
    } else if error.line().is_none() {
        "the header has no line \"format\"".to_owned()
    } else {
        format!("the header's line \"{}\" is not understood", String::from_utf8_lossy(line).trim())
    };
    ((number, 1), MeshFault::Syntax(what))
}

/// Adds an item to the mesh; a fault names the property that it is in, and which number of its
/// list.
fn add(
    mesh: &mut Mesh,
    item: &Item,
    element: &ElementDef,
    vertices: usize,
) -> Result<(), (&'static str, usize, MeshFault)> {
    match element.name.as_str() {
        "vertex" => {
            let axes = ["x", "y", "z", "nx", "ny", "nz"];
            let numbers = item.position.to_array().into_iter().chain(item.normal.to_array());
            if let Some((axis, _)) = axes.into_iter().zip(numbers).find(|(_, number)| !number.is_finite()) {
                return Err((axis, 0, MeshFault::NotFinite));
            }
            mesh.positions.push(item.position);
            if has(element, &["nx", "ny", "nz"]) {
                if item.normal == DVec3::ZERO {
                    return Err(("nx", 0, MeshFault::NoDirection));
                }
                mesh.normals.push(item.normal);
            }
        }
        "face" => {
            if item.indices.len() < 3 {
                let found = item.indices.len();
                let what = MeshFault::Syntax(format!("a face needs 3 vertices, found {found}"));
                return Err((INDICES[0], 0, what));
            }
            let unknown = |index: &u32| usize::try_from(*index).map_or(true, |index| index >= vertices);
            if let Some(place) = item.indices.iter().position(unknown) {
                let index = i64::from(item.indices[place]);
                return Err((INDICES[0], place + 1, MeshFault::NoSuchVertex { index, vertices }));
            }
            mesh.push_polygon(&item.indices);
        }
        _ => {}
    }
    Ok(())
}

/// What follows the header.
struct Payload<'a> {
    encoding: Encoding,
    rest: &'a [u8],
    lines_read: usize,
}

impl Payload<'_> {
    /// Reads the next item of an element and hands it on.
    fn next(
        &mut self,
        element: &ElementDef,
        number: usize,
        announced: Place,
        mut take: impl FnMut(&Item) -> Result<(), (&'static str, usize, MeshFault)>,
    ) -> Result<(), Fault> {
        let parser = Parser::<Item>::new();
        let numbered = |what: &dyn std::fmt::Display| {
            MeshFault::Syntax(format!("{what}, in number {number} of \"{}\" counted from 0", element.name))
        };
        let read = match self.encoding {
            Encoding::Ascii => return self.next_line(element, number, take),
            Encoding::BinaryBigEndian => parser.read_big_endian_element(&mut self.rest, element),
            Encoding::BinaryLittleEndian => parser.read_little_endian_element(&mut self.rest, element),
        };
        let item = read.map_err(|error| match error.kind() {
            ErrorKind::UnexpectedEof => (announced, numbered(&"the file ends within an item")),
            _ => (announced, numbered(&NO_INDEX)),
        })?;
        take(&item).map_err(|(_, _, what)| match what {
            what @ MeshFault::NoSuchVertex { .. } => (announced, what),
            what => (announced, numbered(&what)),
        })
    }

    fn next_line(
        &mut self,
        element: &ElementDef,
        number: usize,
        mut take: impl FnMut(&Item) -> Result<(), (&'static str, usize, MeshFault)>,
    ) -> Result<(), Fault> {
        self.lines_read += 1;
        if self.rest.is_empty() {
            let what = format!("the text ends after {number} of {} of \"{}\"", element.count, element.name);
            return Err(((self.lines_read, 1), MeshFault::Syntax(what)));
        }
        let end = self.rest.iter().position(|&byte| byte == b'\n').unwrap_or(self.rest.len());
        let (line, rest) = self.rest.split_at(end);
        self.rest = rest.get(1..).unwrap_or_default();
        let line = String::from_utf8_lossy(line);
        let line = line.trim_end();
        let at = |byte: usize| (self.lines_read, column(line, byte));
        let item = Parser::<Item>::new().read_ascii_element(line, element).map_err(|error| {
            let no_number = |word: &str| !word.parse::<f64>().is_ok_and(f64::is_finite);
            let no_index = |word: &str| word.parse::<u32>().is_err();
            let is_index = error.kind() == ErrorKind::InvalidData;
            if let Some((byte, word)) = words(line).find(|(_, word)| no_number(word)) {
                (at(byte), MeshFault::Syntax(format!("\"{word}\" is not a finite number")))
            } else if let Some((byte, _)) = words(line).find(|(_, word)| is_index && no_index(word)) {
                (at(byte), MeshFault::Syntax(NO_INDEX.to_owned()))
            } else {
                let what = format!("the numbers are not those of \"{}\" in the header", element.name);
                (at(line.len()), MeshFault::Syntax(what))
            }
        })?;
        take(&item).map_err(|(property, place, what)| {
            // After a list only the line is known.
            let before = element.properties.iter().take_while(|(name, _)| !is_meant(name, property));
            let scalars = before.clone().all(|(_, p)| matches!(p.data_type, PropertyType::Scalar(_)));
            let word = if scalars { words(line).nth(before.count() + place) } else { None };
            (at(word.map_or(0, |(byte, _)| byte)), what)
        })
    }
}

/// The line of the header that announces an element; 1 where none does.
fn line_of(head: &[u8], element: &str) -> usize {
    let announces = |line: &[u8]| {
        let line = String::from_utf8_lossy(line);
        let mut words = words(&line);
        words.next().is_some_and(|(_, word)| word == "element")
            && words.next().is_some_and(|(_, word)| word == element)
    };
    head.split(|&byte| byte == b'\n').position(announces).map_or(1, |index| index + 1)
}

/// Refuses an element that lacks what a mesh needs, or a count that the rest of the file cannot
/// hold, before memory is spent.
fn check(element: &ElementDef, header: &Header, bytes_left: usize) -> Result<(), MeshFault> {
    let lacks = |what: &str| Err(MeshFault::Syntax(format!("\"{}\" lacks {what}", element.name)));
    match element.name.as_str() {
        "vertex" if !has(element, &["x", "y", "z"]) => return lacks("one of x, y, z"),
        "face" if element.count > 0 && !INDICES.iter().any(|name| has(element, &[name])) => {
            return lacks("vertex_indices");
        }
        _ => {}
    }
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

/// Both names that the list of a face's vertices has in the wild.
const INDICES: [&str; 2] = ["vertex_indices", "vertex_index"];

fn is_meant(name: &str, property: &str) -> bool {
    name == property || (INDICES.contains(&name) && INDICES.contains(&property))
}

/// What is wrong with a vertex that a face names by no number.
const NO_INDEX: &str = "a vertex number is negative or not whole";

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
        if !INDICES.contains(&name) {
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
