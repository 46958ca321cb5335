//! What the README shows works as it stands there.

use etalon::scene::Scene;
use std::path::Path;

#[test]
fn the_scene_in_the_readme_is_a_scene() {
    let readme = include_str!("../README.md");
    let start = readme.find("```json\n").expect("the README shows a scene") + "```json\n".len();
    let length = readme[start..].find("```").expect("the scene ends");
    let scene =
        Scene::from_text(&readme[start..start + length], Path::new(".")).unwrap_or_else(|e| panic!("{e}"));
    assert!((scene.emitters[0].luminous_flux.0 - 800.0).abs() < 1e-3);
    assert_eq!(scene.meters.len(), 1);
}

#[test]
fn the_readme_names_every_subcommand() {
    let readme = include_str!("../README.md");
    for command in [
        "render", "develop", "compare", "converge", "check", "measure", "replay", "spectra", "schema",
        "validate",
    ] {
        assert!(readme.contains(&format!("etalon {command}")), "{command}");
    }
}
