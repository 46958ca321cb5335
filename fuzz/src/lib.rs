//! What each reader is fed with, and what must hold of anything it returns.
//!
//! The fuzz targets and `tests/fuzz_corpus.rs` call the same functions: a reader may refuse
//! any bytes, in one line, but neither panic nor hand on what later steps cannot hold.

pub mod checkpoint;

use etalon::error::Error;
use etalon::geometry::{GeometryBuilder, Mesh, MeshFileError, Shape, Transform, parse_obj, parse_ply};
use etalon::image::{parse_exr, read_levels};
use etalon::input::text_of;
use etalon::scene::{Files, Scene};
use etalon::spectrum::library::{self, Purpose};
use etalon::spectrum::{CsvTable, Curve};
use std::collections::BTreeMap;
use std::path::Path;

/// A longer line is no message.
const LONGEST_MESSAGE: usize = 2000;

/// The files that a scene may name; there are no others, wherever its paths lead.
fn files() -> BTreeMap<String, Vec<u8>> {
    let ply = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
               property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n\
               0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    let obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 2\nf 1//1 2//1 3\n";
    let csv = "wavelength_nm,value\n360,0.1\n500,0.9\n830,0.4\n";
    [("mesh.ply", ply), ("mesh.obj", obj), ("table.csv", csv)]
        .map(|(name, text)| (name.to_owned(), text.as_bytes().to_vec()))
        .into()
}

/// A scene's text.
pub fn scene(bytes: &[u8]) {
    let text = match text_of(bytes) {
        Err(error) => return expect_a_place(&error),
        Ok(text) => text,
    };
    match Scene::from_files(text, &Files::held(&files())) {
        Err(error) => expect_a_place(&error),
        Ok(scene) => {
            if let Some(view) = &scene.view {
                let _ = (view.facts(), view.record());
            }
        }
    }
}

/// A PLY file's bytes.
pub fn ply(bytes: &[u8]) {
    mesh(parse_ply(Path::new("mesh.ply"), bytes), bytes.len());
}

/// An OBJ file's bytes.
pub fn obj(bytes: &[u8]) {
    mesh(parse_obj(Path::new("mesh.obj"), bytes), bytes.len());
}

/// Building takes a hundred times as long as reading, so that only files of some lengths are
/// built.
const BUILT_LENGTHS: usize = 16;

fn mesh(read: Result<Mesh, MeshFileError>, bytes: usize) {
    match read {
        Err(error) => {
            assert!(error.line.is_some() && error.column.is_some(), "no place: {error:.200}");
            expect_one_line(&Error::new(error.what.to_string()).hint(error.what.remedy()).to_string());
        }
        Ok(mesh) => {
            mesh.check().expect("a mesh that was read is sound");
            assert!(!mesh.triangles.is_empty());
            if !bytes.is_multiple_of(BUILT_LENGTHS) {
                return;
            }
            let mut builder = GeometryBuilder::new();
            if builder.add_object(&Shape::Mesh(mesh), &Transform::IDENTITY).is_ok() {
                let _ = builder.build();
            }
        }
    }
}

/// A table's text, as a table, as light and as a refractive index.
pub fn csv(bytes: &[u8]) {
    let table = match text_of(bytes).and_then(CsvTable::parse) {
        Err(error) => return expect_a_place(&error),
        Ok(table) => table,
    };
    assert!(table.rows.iter().all(|row| row.len() == table.columns.len()));
    let _ = table.line_of(table.rows.len() - 1);
    for purpose in [Purpose::Reflectance, Purpose::Emission] {
        match library::light(&table, None, purpose) {
            Err(error) => expect_one_line(&error.to_string()),
            Ok(light) => look_at(light.continuum()),
        }
    }
    match library::refractive_index(&table) {
        Err(error) => expect_one_line(&error.to_string()),
        Ok(index) => {
            let _ = (index.at(360.0), index.at(830.0), index.fitted_range_nm());
        }
    }
}

fn look_at(curve: &Curve) {
    let _ = (curve.at(550.0), curve.on_grid(550.0), curve.extremes(), curve.integral(360.0, 830.0));
}

/// A picture's bytes: a render as `etalon develop` reads it, and a flat field.
pub fn exr(bytes: &[u8]) {
    if let Err(error) = parse_exr(bytes) {
        expect_one_line(&error.to_string());
    }
    if let Err(error) = read_levels(Path::new("flat.exr"), bytes) {
        expect_one_line(&error.to_string());
    }
}

fn expect_a_place(error: &Error) {
    expect_one_line(&error.to_string());
    assert!(error.line.is_some() && error.column.is_some(), "no place: {error}");
    assert!(error.hint.is_some(), "no remedy: {error}");
}

fn expect_one_line(message: &str) {
    assert!(!message.is_empty() && !message.contains('\n'), "{message:?}");
    assert!(message.len() < LONGEST_MESSAGE, "{} bytes: {message:.200}", message.len());
}
