//! `etalon render --strategies DIR`: the pyramid of bidirectional strategies.

use super::arguments::Effort;
use super::render::{DEFAULT_SPP, check_output};
use etalon::camera::{Development, Film};
use etalon::error::{Error, Result};
use etalon::image::{Facts, Layers, Tile, write_exr, write_sheet};
use etalon::integrator::{Stopwatch, Times, Tracer, render_pyramid};
use etalon::path::{Eye, Strategies};
use etalon::scene::{Plan, Scene, View};
use std::path::{Path, PathBuf};

/// Vertices of the longest paths shown.
const LONGEST: usize = 7;
/// Films of all strategies, weighted and by themselves, at most.
pub const FILMS: u64 = 70;
/// Name of the contact sheet.
const SHEET: &str = "strategies.png";

/// Makes the folder, before hours of work end in one that cannot be made.
pub fn prepare(folder: &Path) -> Result<()> {
    std::fs::create_dir_all(folder).map_err(|e| Error::io(folder, "make this folder", &e))?;
    check_output(&folder.join(SHEET), &["png"], "the contact sheet is a PNG")
}

/// Renders every strategy and writes its pictures; the contact sheet's name comes back.
///
/// On the sheet each row holds paths of one length, the strategies by themselves on the left
/// and weighted on the right; each row is exposed one stop more than the one above.
pub fn write(
    folder: &Path,
    scene: &Scene,
    view: &View,
    plan: &Plan,
    effort: &Effort,
    layers: Layers,
) -> Result<PathBuf> {
    let started = Stopwatch::start();
    let budget = effort.budget(DEFAULT_SPP);
    // Also what a render leaves out because another strategy is better at it.
    let strategies = effort.strategies();
    let meets_lights = strategies.meets_lights && plan.strategies.meets_lights;
    let meets_eye = strategies.meets_eye && view.camera.has_aperture();
    let strategies = Strategies { meets_lights, meets_eye, ..strategies };
    // Longer paths have no picture of their own, and joining each of their vertices takes time.
    let most_bounces = Some(LONGEST as u32 - 2);
    let plan = Plan { strategies, joins_each: true, most_bounces, ..plan.clone() };
    let tracer = Tracer::new(scene, &plan, Eye::Camera(&view.camera));
    let pyramid = render_pyramid(&tracer, view, &plan, &budget, LONGEST);
    let mut captioned: Vec<([u32; 2], String, &Film)> = Vec::new();
    for ((s, t), films) in &pyramid {
        let row = (s + t - 2) as u32;
        for (kind, film, first) in
            [("unweighted", &films.unweighted, 0), ("weighted", &films.weighted, LONGEST + 1)]
        {
            let times = Times { render: started.cost(), ..Times::default() };
            let facts = Facts::of(scene, view, &plan, effort.integrator(), &budget, film, times);
            write_exr(&folder.join(format!("s{s}-t{t}-{kind}.exr")), film, view, &facts, layers)?;
            captioned.push(([(first + s) as u32, row], format!("s{s} t{t} +{row} EV"), film));
        }
    }
    let development = Development::new(&view.exposure, view.white);
    let tiles: Vec<Tile<'_>> = captioned
        .iter()
        .map(|(place, caption, film)| {
            let white_luminance_cd_m2 = development.white_luminance_cd_m2 / f64::from(1 << place[1]);
            let development = Development { white_luminance_cd_m2, ..development };
            Tile { place: *place, caption, film, development }
        })
        .collect();
    let sheet = folder.join(SHEET);
    write_sheet(&sheet, &tiles)?;
    Ok(sheet)
}
