//! Mesh files, whole and broken.
#![expect(clippy::unwrap_used, reason = "a set-up that fails is a test that fails")]

use etalon::geometry::{Mesh, MeshFileError, parse_obj, parse_ply};
use glam::DVec3;
use std::path::Path;

fn obj(text: &str) -> Result<Mesh, MeshFileError> {
    parse_obj(Path::new("part.obj"), text.as_bytes())
}

fn ply(text: &str) -> Result<Mesh, MeshFileError> {
    parse_ply(Path::new("part.ply"), text.as_bytes())
}

const VERTICES: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

fn square_ply(vertices: &str, faces: &str, body: &str) -> String {
    format!(
        "ply\nformat ascii 1.0\ncomment made by hand\nelement vertex {vertices}\n\
         property double x\nproperty float y\nproperty float z\n\
         element face {faces}\nproperty list uchar int vertex_indices\nend_header\n{body}"
    )
}

const SQUARE: &str = "0 0 0\n1 0 0\n1 1 0.1\n0 1 0\n";

#[test]
fn polygons_become_fans() {
    let mesh = obj(&format!("# a square\nmtllib x.mtl\n{VERTICES}vt 0 0\nf 1/1 2/1 3/1 -1\n"));
    let mesh = mesh.unwrap();
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3]]);
    assert_eq!((mesh.positions.len(), mesh.normals.len()), (4, 0));
    let mesh = ply(&square_ply("4", "1", &format!("{SQUARE}4 0 1 2 3\n"))).unwrap();
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(mesh.positions[1], DVec3::X);
    assert!(mesh.normals.is_empty());
}

#[test]
fn corners_with_different_normals_are_different_vertices() {
    let text = format!("{VERTICES}vn 0 0 1\nvn 1 0 0\nf 1//1 2//1 3//1\nf 1//2 3//2 4\n");
    let mesh = obj(&text).unwrap();
    assert_eq!(mesh.triangles, [[0, 1, 2], [3, 4, 5]]);
    assert_eq!(mesh.normals[3..], [DVec3::X, DVec3::X, DVec3::ZERO]);
}

#[test]
fn coordinates_keep_double_precision() {
    let mesh = obj("v 0.1 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    assert_eq!(mesh.positions[0].x, 0.1);
}

#[test]
fn binary_ply_reads_as_text_does() {
    let text = square_ply("4", "1", "").replace("ascii", "binary_little_endian");
    let mut bytes = text.into_bytes();
    for [x, y, z] in [[0.0f32, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.5], [0.0, 1.0, 0.0]] {
        bytes.extend(f64::from(x).to_le_bytes());
        bytes.extend(y.to_le_bytes());
        bytes.extend(z.to_le_bytes());
    }
    bytes.push(4);
    for index in 0..4i32 {
        bytes.extend(index.to_le_bytes());
    }
    let mesh = parse_ply(Path::new("b.ply"), &bytes).unwrap();
    assert_eq!(mesh.positions[2], DVec3::new(1.0, 1.0, 0.5));
    assert_eq!(mesh.triangles.len(), 2);
    for length in 0..bytes.len() {
        assert!(parse_ply(Path::new("b.ply"), &bytes[..length]).is_err(), "cut at {length}");
    }
}

#[test]
fn broken_obj_files_name_their_line() {
    let far = i64::MIN;
    let broken = [
        ("".to_string(), Some(1)),
        (VERTICES.to_string(), Some(1)),
        ("v 0 0\n".to_string(), Some(1)),
        ("v 0 0 zero\n".to_string(), Some(1)),
        ("v 0 0 nan\n".to_string(), Some(1)),
        ("v 0 0 1e999\n".to_string(), Some(1)),
        (format!("{VERTICES}f 1 2\n"), Some(5)),
        (format!("{VERTICES}f\n"), Some(5)),
        (format!("{VERTICES}f 1 2 5\n"), Some(5)),
        (format!("{VERTICES}f 0 1 2\n"), Some(5)),
        (format!("{VERTICES}f -5 1 2\n"), Some(5)),
        (format!("{VERTICES}\nf {far} 1 2\n"), Some(6)),
        (format!("{VERTICES}f 1//1 2//1 3//1\n"), Some(5)),
        (format!("{VERTICES}f 1 2 99999999999999999999\n"), Some(5)),
        (format!("{VERTICES}f 1 b 3\n"), Some(5)),
        (format!("{VERTICES}f / / /\n"), Some(5)),
        (format!("{VERTICES}surface 1 2 3\n"), Some(5)),
        ("\u{0}\u{1}\u{2}".to_string(), Some(1)),
    ];
    for (text, line) in broken {
        let error = obj(&text).expect_err(&text);
        assert_eq!(error.line, line, "{text:?}: {error}");
        assert!(error.column.is_some(), "{text:?}: {error}");
        assert!(error.to_string().starts_with("part.obj"), "{error}");
    }
}

#[test]
fn broken_ply_files_are_refused() {
    let whole = format!("{SQUARE}4 0 1 2 3\n");
    let broken = [
        String::new(),
        "ply".into(),
        "plx\nformat ascii 1.0\nend_header\n".into(),
        "ply\nend_header\n".into(),
        "ply\nformat ascii 1.0\nproperty float x\nend_header\n".into(),
        "ply\nformat ascii 1.0\nelement vertex 99999999999999999999999\nend_header\n".into(),
        "ply\nformat ascii 1.0\nelement vertex 9000000000000000000\nend_header\n".into(),
        "ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nend_header\n".into(),
        square_ply("4000000000", "1", &whole),
        square_ply("4", "4000000000", &whole),
        square_ply("5", "1", &whole),
        square_ply("4", "1", SQUARE),
        square_ply("4", "1", &format!("{SQUARE}4 0 1 2 4\n")),
        square_ply("4", "1", &format!("{SQUARE}4 0 1 2 -1\n")),
        square_ply("4", "1", &format!("{SQUARE}4 0 1 2\n")),
        square_ply("4", "1", &format!("{SQUARE}2 0 1\n")),
        square_ply("4", "1", &format!("{SQUARE}4000000000 0 1 2\n")),
        square_ply("4", "0", SQUARE),
        square_ply("4", "1", &whole.replace("0.1", "x")),
        square_ply("4", "1", &whole.replace("0.1", "nan")),
        square_ply("4", "1", &whole).replace("float z", "float w"),
        square_ply("4", "1", &whole).replace("list uchar int", "list uchar float"),
    ];
    for text in broken {
        let error = ply(&text).expect_err(&text);
        assert!(error.to_string().starts_with("part.ply:"), "{error}");
        assert!(error.line.is_some() && error.column.is_some(), "{error}");
        assert!(!error.to_string().contains('\n'), "{error}");
    }
}

#[test]
fn a_list_that_announces_more_than_there_is_costs_no_memory() {
    let text = square_ply("4", "1", "").replace("ascii", "binary_little_endian");
    let text = text.replace("list uchar int", "list uint int");
    let mut bytes = text.into_bytes();
    bytes.extend([0; 64]);
    bytes.extend(u32::MAX.to_le_bytes());
    bytes.extend([0; 64]);
    assert!(parse_ply(Path::new("b.ply"), &bytes).is_err());
}

#[test]
fn damaged_bytes_never_panic() {
    let text = square_ply("4", "1", &format!("{SQUARE}4 0 1 2 3\n"));
    let obj_text = format!("{VERTICES}vn 0 0 1\nf 1//1 2//1 3//1 4//1\n");
    let mut state = 1u32;
    let mut next = |limit: usize| {
        state = state.wrapping_mul(747796405).wrapping_add(2891336453);
        (state >> 8) as usize % limit
    };
    for _ in 0..20_000 {
        let (mut a, mut b) = (text.clone().into_bytes(), obj_text.clone().into_bytes());
        for _ in 0..1 + next(3) {
            let place = next(a.len());
            a[place] = next(256) as u8;
            let place = next(b.len());
            b[place] = next(256) as u8;
        }
        let _ = parse_ply(Path::new("a.ply"), &a);
        let _ = parse_obj(Path::new("b.obj"), &b);
    }
}
