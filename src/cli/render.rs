//! `etalon render`: a scene to an EXR in absolute units and, if asked, a developed picture.

use super::arguments::Effort;
use super::auto;
use super::checkpoint::Keeping;
use super::error_words::error_words;
use super::faults;
use super::memory;
use super::strategies;
use clap::Args;
use etalon::camera::{Camera, Darkroom, planes};
use etalon::error::{Error, Result};
use etalon::image::checkpoint::Identity;
use etalon::image::{
    DEVELOPED_ENDINGS, Facts, Label, Layers, Stopping, write_developed, write_exr, write_text,
};
use etalon::integrator::{Budget, Integrator, Memory, Rendering, Stopwatch, Times};
use etalon::metropolis::Outcome;
use etalon::path::Groups;
use etalon::pilot::{Report, Selection};
use etalon::scene::conditions::{Condition, Kind, ORDINARY_SPP, conditions, in_short};
use etalon::scene::{NOTHING_SHINES, Plan, Scene, View};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Samples per pixel where nothing is said.
pub(super) const DEFAULT_SPP: u64 = ORDINARY_SPP as u64;

/// What a developed picture may be.
pub(super) const DEVELOPED_RULE: &str = "a developed picture is a PNG, a TIFF or a JPEG";

#[derive(Debug, Args)]
pub struct Arguments {
    /// Scene file
    scene: PathBuf,
    /// EXR to write: X, Y, Z in cd/m2 with standard errors, and all facts
    #[arg(short, long, value_name = "OUT.exr")]
    output: PathBuf,
    /// Developed picture to write as well, PNG or JPEG (8 bits) or TIFF (16 bits)
    #[arg(long, value_name = "OUT.png")]
    png: Option<PathBuf>,
    #[command(flatten)]
    effort: Effort,
    #[command(flatten)]
    keeping: Keeping,
    /// Also write the facts of the render, those of the EXR, as a JSON file
    #[arg(long, value_name = "FILE.json")]
    report: Option<PathBuf>,
    /// Also write what each bidirectional strategy finds, weighted and by itself: EXRs and a
    /// contact sheet, for paths of up to 7 vertices
    #[arg(long, value_name = "DIR", conflicts_with_all = ["time", "error"])]
    strategies: Option<PathBuf>,
    /// Render a part of the picture alone: X,Y,WIDTH,HEIGHT in pixels from the top left corner
    #[arg(long, value_name = "X,Y,W,H", value_parser = crop)]
    crop: Option<[u32; 4]>,
    /// Exit with code 3 where the picture is not what it should be: without rendering, where light
    /// of some paths cannot be found; else with the picture written, where samples were not finite
    /// or radiance has no finite value
    #[arg(long)]
    strict: bool,
    /// Add linear sRGB channels R, G, B in cd/m2 to the EXR
    #[arg(long)]
    linear_srgb: bool,
    /// Add this many spectral layers over 360 to 830 nm to the EXR
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=470))]
    spectral_layers: Option<u16>,
}

pub fn run(arguments: &Arguments) -> anyhow::Result<ExitCode> {
    let since = Stopwatch::start();
    // Before rendering: hours of work should not end in a name that cannot be written.
    check_output(&arguments.output, &["exr"], "the output is an OpenEXR file")?;
    if let Some(png) = &arguments.png {
        check_output(png, &DEVELOPED_ENDINGS, DEVELOPED_RULE)?;
    }
    if let Some(report) = &arguments.report {
        check_output(report, &["json"], "the report is a JSON file")?;
    }
    check_distinct(arguments)?;
    arguments.keeping.check()?;
    let asked = arguments.effort.selection()?;
    let is_mlt = asked.is_some_and(|selection| selection.integrator == Integrator::Mlt);
    if arguments.strategies.is_some() && is_mlt {
        return Err(Error::new("a chain's path belongs to no single strategy")
            .hint("use --strategies with --integrator bdpt, whose strategies mlt shares")
            .into());
    }
    arguments.effort.start_threads()?;
    let scene = Scene::load(&arguments.scene)?;
    let mut view = arguments.effort.resize(scene.view().map_err(|e| e.in_file(&arguments.scene))?);
    if let Some(part) = arguments.crop {
        view.camera = cropped(&view, part)?;
    }
    if let Some(count) = arguments.spectral_layers {
        view.sensor = view.sensor.with_spectral_layers(usize::from(count));
    }
    let layers = Layers { linear_srgb: arguments.linear_srgb };
    if let Some(folder) = &arguments.strategies {
        strategies::prepare(folder)?;
        memory::check(&view, memory::Numbers::of_films(strategies::FILMS))?;
    }
    let (settled, choice) =
        auto::settle(&scene, &view, &arguments.effort, DEFAULT_SPP, Some(&arguments.keeping))?;
    if arguments.strategies.is_some() && settled.integrator() == Integrator::Mlt {
        return Err(Error::new("auto has picked mlt, and a chain's path belongs to no single strategy")
            .hint("use --strategies with --integrator bdpt, whose strategies mlt shares")
            .into());
    }
    let effort = &settled;
    let plan = effort.plan(&scene, &view.sensor);
    if arguments.strict && !plan.unreachable.is_empty() {
        eprintln!("error: {}: {}", arguments.scene.display(), missing(&scene, &plan, effort.selected()));
        return Ok(ExitCode::from(3));
    }
    let files = Files {
        exr: &arguments.output,
        png: arguments.png.as_deref(),
        layers,
        since,
        keeping: Some(&arguments.keeping),
        choice,
    };
    let rendered = render_to_files(&scene, &view, effort, DEFAULT_SPP, &files);
    if let (Some(report), Err(error)) = (&arguments.report, &rendered)
        && let Some(nothing) = error.downcast_ref::<NothingFound>()
    {
        write_report(report, &serde_json::json!({ "metropolis": nothing.outcome }))?;
    }
    let facts = rendered?;
    if let Some(report) = &arguments.report {
        write_report(report, &facts)?;
    }
    super::print(&format!(
        "{}: {} samples per pixel in {:.1} s{}{}",
        arguments.output.display(),
        facts.samples_per_pixel,
        facts.seconds,
        memory::in_words(facts.memory),
        error_words(&facts)
    ));
    if !facts.conditions.is_empty() {
        super::print(&format!(
            "conditions {}; `etalon check --explain` tells more",
            in_short(&facts.conditions)
        ));
    }
    if let Some(outcome) = &facts.metropolis {
        tell(outcome);
    }
    let is_sound = faults::tell(&facts, &arguments.scene, &arguments.output, arguments.strict);
    if let Some(folder) = &arguments.strategies {
        let sheet = strategies::write(folder, &scene, &view, &plan, effort, layers)?;
        super::print(&format!("{}: every strategy by itself and weighted", sheet.display()));
    }
    Ok(if arguments.strict && !is_sound { ExitCode::from(3) } else { ExitCode::SUCCESS })
}

fn crop(text: &str) -> std::result::Result<[u32; 4], String> {
    let numbers: std::result::Result<Vec<u32>, _> = text.split(',').map(str::parse).collect();
    let explain = || "give column, row, width and height as in 100,80,64,48".to_owned();
    numbers.ok().and_then(|numbers| numbers.try_into().ok()).ok_or_else(explain)
}

fn cropped(view: &View, part: [u32; 4]) -> Result<Camera> {
    view.camera.cropped(part).ok_or_else(|| {
        let [width, height] = view.camera.resolution();
        let [x, y, w, h] = part;
        Error::new(format!(
            "--crop {x},{y},{w},{h} is empty or reaches outside the picture of {width} x {height} pixels"
        ))
        .hint("give the column and the row of its top left pixel, then its width and height")
    })
}

fn write_report(file: &Path, report: &impl serde::Serialize) -> anyhow::Result<()> {
    let text = serde_json::to_string_pretty(report)?;
    Ok(write_text(file, "report", &(text + "\n"))?)
}

/// What the chains of a render say about themselves.
fn tell(outcome: &Outcome) {
    if let Some(report) = &outcome.report {
        super::print(report.to_string().trim_end());
    } else if let Some(paths) = outcome.found_none_in {
        eprintln!("warning: the picture is direct light alone; {}", none_found(paths, outcome));
    }
}

/// That a search ended without light, and what that says.
fn none_found(paths: u64, outcome: &Outcome) -> String {
    let most = outcome.most_probable_hit().unwrap_or(1.0);
    format!("beyond it, found none in {paths} paths; hit probability below {most:.1e} at 95 %")
}

/// The error of a scene in which lamps shine and no light was found.
#[derive(Debug)]
pub struct NothingFound {
    text: String,
    outcome: Outcome,
}

impl std::error::Error for NothingFound {}

impl std::fmt::Display for NothingFound {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.text)
    }
}

/// What a plan's strategies cannot find, on one line.
fn missing(scene: &Scene, plan: &Plan, selection: Selection) -> String {
    let classes: Vec<String> =
        plan.unreachable.iter().map(|class| format!("{} ({})", class.meaning, class.word)).collect();
    let of_scene = match selection.integrator {
        Integrator::Path => {
            "give the lamp its real size, or use --integrator bdpt and give the camera a lens (focus_distance)"
        }
        Integrator::Light => "use --integrator bdpt, and give a point light its real size",
        Integrator::Bdpt | Integrator::Mlt => {
            "give the lamp its real size, or the camera a lens (focus_distance)"
        }
    };
    let of_groups = selection.groups.and_then(|groups| groups_to_add(scene, plan, groups));
    let remedy = of_groups.unwrap_or_else(|| of_scene.to_owned());
    format!("cannot be found and is missing: {}; {remedy}", classes.join("; "))
}

/// What to do with `--groups` for the light that all groups together would find; `None` where that
/// is no more than some do.
fn groups_to_add(scene: &Scene, plan: &Plan, groups: Groups) -> Option<String> {
    let missed_by = |groups: Groups| etalon::scene::unreachable(scene, &groups.strategies()).len();
    let fewest = missed_by(Groups::ALL);
    if plan.unreachable.len() <= fewest {
        return None;
    }
    let with_one_more = [
        ("path", Groups { path: true, ..groups }),
        ("splats", Groups { splats: true, ..groups }),
        ("joins", Groups { joins: true, ..groups }),
    ];
    let enough = with_one_more.into_iter().find(|(_, groups)| missed_by(*groups) == fewest);
    Some(
        enough.map_or_else(|| "leave --groups out".to_owned(), |(name, _)| format!("add {name} to --groups")),
    )
}

/// Whether a file of this name can be written: its ending, its folder, the permissions.
pub(super) fn check_output(file: &Path, endings: &[&str], rule: &str) -> Result<()> {
    let ending = file.extension().map(|ending| ending.to_string_lossy().to_lowercase());
    if !ending.is_some_and(|ending| endings.contains(&ending.as_str())) {
        let hint = format!("end the file's name in .{}", endings.join(" or ."));
        return Err(Error::new(rule).hint(hint).in_file(file));
    }
    check_place(file)
}

/// Whether there can be a file of this name: its folder, the permissions.
pub(super) fn check_place(file: &Path) -> Result<()> {
    if file.is_dir() {
        return Err(Error::new("the output is a folder").hint("choose another name").in_file(file));
    }
    let folder =
        file.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or_else(|| Path::new("."));
    if !folder.is_dir() {
        return Err(Error::new("the folder of the output does not exist")
            .hint("make it first")
            .in_file(file));
    }
    // Only an attempt tells whether the folder may be written to.
    let probe = file.with_extension(format!("{}.probe", std::process::id()));
    let attempt = std::fs::File::create_new(&probe).and_then(|_| std::fs::remove_file(&probe));
    attempt.map_err(|e| Error::io(file, "write to this folder", &e))
}

/// Refuses two outputs in one file.
fn check_distinct(arguments: &Arguments) -> Result<()> {
    let Arguments { output, png, report, keeping, .. } = arguments;
    let named = [
        ("the picture", Some(output)),
        ("the developed picture", png.as_ref()),
        ("the report", report.as_ref()),
        ("the checkpoint", keeping.checkpoint.as_ref()),
    ];
    let mut taken: Vec<(&str, PathBuf)> = Vec::new();
    for (what, file) in named {
        let Some(file) = file else { continue };
        let place = place_of(file);
        if let Some((other, _)) = taken.iter().find(|(_, there)| *there == place) {
            let fault = format!("{what} would overwrite {other}");
            return Err(Error::new(fault).hint("choose another name").in_file(file));
        }
        taken.push((what, place));
    }
    Ok(())
}

/// Where a file is, however it is spelt.
fn place_of(file: &Path) -> PathBuf {
    let folder =
        file.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or_else(|| Path::new("."));
    let whole = file.canonicalize().ok();
    let named = || Some(folder.canonicalize().ok()?.join(file.file_name()?));
    whole.or_else(named).unwrap_or_else(|| file.to_owned())
}

/// What a render is written to.
pub struct Files<'a> {
    pub exr: &'a Path,
    pub png: Option<&'a Path>,
    pub layers: Layers,
    /// Counts from where the scene began to be read.
    pub since: Stopwatch,
    /// Where it is kept on the way, if anywhere.
    pub keeping: Option<&'a Keeping>,
    /// What picked the algorithm, where nobody named it.
    pub choice: Option<Report>,
}

/// Warns of what makes a render take very long, before it does.
fn warn_of_cost(conditions: &[Condition]) {
    /// The condition that may cost a thousand times more; others cost a little.
    const HIGH_ALBEDO: &str = "high_albedo";
    let costs = conditions.iter().flat_map(|condition| {
        let costs = condition.effect.iter().filter(|effect| effect.kind == Kind::Cost);
        costs.map(move |effect| (condition, effect))
    });
    for (condition, effect) in costs.filter(|(condition, _)| condition.name == HIGH_ALBEDO) {
        eprintln!("warning: {}: {}", condition.place, effect.what);
    }
}

/// Renders a view and writes the files; the facts that went into them come back.
pub fn render_to_files(
    scene: &Scene,
    view: &View,
    effort: &Effort,
    default_spp: u64,
    files: &Files<'_>,
) -> anyhow::Result<Facts> {
    memory::check(view, memory::Numbers::of(effort.integrator(), &effort.budget(default_spp)))?;
    let integrator = effort.integrator();
    let plan = effort.plan(scene, &view.sensor);
    if !plan.unreachable.is_empty() {
        eprintln!("warning: {}", missing(scene, &plan, effort.selected()));
    }
    let nothing_shines = plan.reasons.iter().any(|reason| reason == NOTHING_SHINES);
    if nothing_shines {
        eprintln!("warning: {NOTHING_SHINES}");
    }
    view.record().warnings.iter().for_each(|warning| eprintln!("warning: {warning}"));
    let conditions = conditions(scene, Some(view));
    warn_of_cost(&conditions);
    let mut budget = effort.budget(default_spp);
    if nothing_shines && budget.is_open() {
        // No error could be reached, and none is there.
        budget = Budget { samples_per_pixel: 1, time: None, error: None, ..budget };
    }
    let identity = Identity::of(scene, view, &plan, effort.selected(), &budget);
    let keeping = files.keeping.cloned().unwrap_or_default();
    let (from, watch) = keeping.begin(identity, view, &budget)?;
    let load = files.since.cost();
    let rendering = integrator.go_on(scene, view, &plan, &budget, &watch, from);
    watch.finish();
    if let Some(outcome) = &rendering.metropolis
        && let Some(paths) = outcome.found_none_in
        && !outcome.direct_light
    {
        let what = none_found(paths, outcome);
        let text = format!("{}: no direct light was found; {what}; no picture is written", scene.name);
        return Err(NothingFound { text, outcome: outcome.clone() }.into());
    }
    let pilot = files.choice.as_ref().map(Report::cost);
    let times = Times {
        load: Some(pilot.map_or(load, |pilot| load.minus(pilot))),
        pilot,
        bootstrap: rendering.bootstrap,
        render: rendering.blocks,
    };
    let Rendering { film, metropolis, truncation, ends, spent, .. } = rendering;
    let mut facts = Facts {
        cpu_seconds: spent.cpu_seconds,
        parts: spent.parts,
        stopping: Stopping { ends, ..Stopping::of(&budget) },
        metropolis,
        truncation: Some(truncation),
        conditions,
        groups: effort.groups.map(|groups| groups.to_string()),
        auto: files.choice.clone(),
        ..Facts::of(scene, view, &plan, integrator, &budget, &film, times)
    };
    let planes = planes(&film, &view.sensor, &view.flat_field());
    let camera = facts.camera.clone();
    let darkroom = Darkroom::new(&camera, &planes)?;
    facts.camera.saturated_pixels = darkroom.saturated_pixels();
    write_exr(files.exr, &film, view, &facts, files.layers).map_err(|e| watch.reassure(e))?;
    if let Some(png) = files.png {
        let label = Label { scene: &facts.scene, camera: &camera, tone: camera.tone };
        write_developed(png, &darkroom, &label).map_err(|e| watch.reassure(e))?;
    }
    facts.memory = Memory::so_far();
    Ok(facts)
}
