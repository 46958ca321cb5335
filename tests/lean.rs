//! A lean build says what it lacks; built with everything, these tests are not there.

#![cfg(not(feature = "meshes"))]

use etalon::scene::Scene;
use std::path::Path;

fn refusal(shape: &str, file: &str) -> String {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
    std::fs::write(folder.join(file), "").expect("the test's own folder can be written to");
    let text = format!(
        r#"{{ "name": "lean", "length_unit": "m",
  "materials": {{ "paper": {{ "lambertian": {{ "reflectance": 0.5 }} }} }},
  "objects": [ {{ "name": "part", "material": "paper",
    "shape": {{ "{shape}": {{ "file": "{file}" }} }} }} ] }}"#
    );
    let scene = folder.join("lean.json");
    std::fs::write(&scene, text).expect("the test's own folder can be written to");
    Scene::load(&scene).map(|_| ()).expect_err("no mesh file can be read").to_string()
}

#[test]
fn a_mesh_file_names_the_feature_that_reads_it() {
    for (shape, file) in [("ply", "lean.ply"), ("obj", "lean.obj")] {
        let error = refusal(shape, file);
        assert!(error.contains("\"meshes\"") && error.contains("lean.json:4:"), "{error}");
    }
}
