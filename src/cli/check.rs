//! `etalon check`: a scene explained in numbers, without rendering.

use clap::Args;
use etalon::integrator::Integrator;
use etalon::light::EmitterFacts;
use etalon::light::power::EmitterShape;
use etalon::scene::conditions::{Condition, LOOKED_FOR, conditions, in_short};
use etalon::scene::{Decision, Leaving, Plan, PlanItem, Scene, View};
use std::fmt::Write as _;
use std::path::PathBuf;
use std::process::ExitCode;

#[derive(Debug, Args)]
pub struct Arguments {
    /// Scene file
    scene: PathBuf,
    /// Print the extreme conditions of the scene, and what each does to the error to be expected
    #[arg(long)]
    explain: bool,
    /// What the plan leaves out: lean (all that the scene does not need), full (nothing), or
    /// keep=NAME,... (all but these)
    #[arg(long = "plan", value_name = "WHAT", default_value_t = Leaving::all(), value_parser = super::arguments::leaving)]
    leaving: Leaving,
}

pub fn run(arguments: &Arguments) -> anyhow::Result<ExitCode> {
    let scene = Scene::load(&arguments.scene)?;
    let found = conditions(&scene, scene.view.as_ref());
    let mut text = describe(&scene, &arguments.leaving)?;
    let more = if found.is_empty() || arguments.explain { "" } else { "; --explain tells more" };
    writeln!(text, "conditions {}{more}", in_short(&found))?;
    if arguments.explain {
        explain(&mut text, &found)?;
    }
    super::print(text.trim_end());
    Ok(ExitCode::SUCCESS)
}

/// The extreme conditions, and what was looked for.
fn explain(text: &mut String, found: &[Condition]) -> std::fmt::Result {
    found.iter().try_for_each(|condition| write!(text, "{condition}"))?;
    let absent: Vec<&str> = LOOKED_FOR
        .iter()
        .map(|(name, _)| *name)
        .filter(|name| found.iter().all(|condition| condition.name != *name))
        .collect();
    writeln!(text, "not found  {}", absent.join(", "))
}

fn describe(scene: &Scene, leaving: &Leaving) -> Result<String, std::fmt::Error> {
    let mut text = String::new();
    let geometry = &scene.geometry;
    writeln!(text, "scene      {} ({})", scene.name, scene.hash)?;
    writeln!(
        text,
        "geometry   {} objects, {} primitives; one unit is {} m, positions are exact to {:.2e} m",
        geometry.object_count(),
        geometry.primitive_count(),
        geometry.metres_per_unit(),
        geometry.spacing_metres()
    )?;
    for emitter in &scene.emitters {
        lamp(&mut text, emitter)?;
    }
    if scene.emitters.is_empty() {
        writeln!(text, "lights     none: everything is black")?;
    }
    if let Some(view) = &scene.view {
        camera(&mut text, view)?;
    }
    if !scene.meters.is_empty() {
        writeln!(
            text,
            "meters     {}",
            scene.meters.iter().map(|m| m.name.as_str()).collect::<Vec<_>>().join(", ")
        )?;
    }
    if let Some(view) = &scene.view {
        plans(&mut text, scene, view, leaving)?;
        for integrator in Integrator::ALL {
            let plan = Plan::of(scene, &view.sensor, integrator.strategies());
            for class in &plan.unreachable {
                writeln!(text, "missing    {}: {} ({})", integrator.name(), class.meaning, class.word)?;
            }
        }
    }
    for note in &scene.notes {
        writeln!(text, "note       {note}")?;
    }
    Ok(text)
}

/// What is left out and what is kept: by all integrators, or by those that are named.
fn plans(text: &mut String, scene: &Scene, view: &View, leaving: &Leaving) -> std::fmt::Result {
    let plan_of = |integrator: Integrator| Plan::under(scene, &view.sensor, integrator.strategies(), leaving);
    let plans = Integrator::ALL.map(|integrator| (integrator, plan_of(integrator)));
    let mut told: Vec<&PlanItem> = Vec::new();
    for item in plans.iter().flat_map(|(_, plan)| &plan.items) {
        let is_same = |other: &PlanItem| other.name == item.name && other.reason == item.reason;
        if told.iter().any(|other| is_same(other)) {
            continue;
        }
        told.push(item);
        let takers = || plans.iter().filter(|(_, plan)| plan.items.iter().any(is_same));
        let names: Vec<&str> = takers().map(|(integrator, _)| integrator.name()).collect();
        let who = if names.len() == plans.len() { String::new() } else { format!(" ({})", names.join(", ")) };
        let what = if item.decision == Decision::LeftOut { "without" } else { "with" };
        writeln!(text, "plan       {what} {}{who}: {item}", item.name)?;
    }
    for remark in &plans[0].1.remarks {
        writeln!(text, "plan       {remark}")?;
    }
    Ok(())
}

fn lamp(text: &mut String, lamp: &EmitterFacts) -> std::fmt::Result {
    write!(
        text,
        "light      {}: {:.6} lm, {:.6} W (360-830 nm)",
        lamp.name, lamp.luminous_flux.0, lamp.radiant_flux.0
    )?;
    if let EmitterShape::Surface { area_m2, .. } = lamp.shape {
        write!(text, ", {:.6} m2", area_m2)?;
    }
    if let Some(luminance) = lamp.luminance {
        write!(text, ", {:.6} cd/m2", luminance.0)?;
    }
    if let Some(intensity) = lamp.intensity {
        write!(text, ", {:.6} cd", intensity.0)?;
    }
    if let Some([x, y]) = lamp.chromaticity {
        write!(text, ", xy ({x:.5}, {y:.5})")?;
    }
    match lamp.colour_temperature() {
        Some(cct) => writeln!(text, ", CCT {:.0} K (Duv {:+.4})", cct.kelvin.0, cct.duv),
        None if lamp.chromaticity.is_none() => writeln!(text, ", dark"),
        None => writeln!(text, ", no CCT (too far from the Planckian locus)"),
    }
}

fn camera(text: &mut String, view: &View) -> std::fmt::Result {
    let facts = view.facts();
    let exposure = &view.exposure;
    let [width, height] = view.camera.resolution();
    writeln!(
        text,
        "camera     {width} x {height} pixels, {:.2} x {:.2} deg, {} mm, {}",
        facts.field_of_view_deg[0],
        facts.field_of_view_deg[1],
        view.focal_length_mm,
        if view.camera.has_aperture() { "thin lens" } else { "pinhole" }
    )?;
    writeln!(
        text,
        "exposure   ISO {}, {} s, f/{}, q {}: EV100 {:.3}, saturation at {:.6} cd/m2, white at {:.6} cd/m2 ({:?} anchor)",
        exposure.iso.0,
        exposure.shutter.0,
        exposure.f_stop.0,
        exposure.q,
        facts.ev100,
        facts.saturation_luminance_cd_m2,
        facts.white_luminance_cd_m2,
        exposure.anchor
    )?;
    for (channel, coverage) in view.sensor.channels.iter().skip(3).zip(&view.sensor.coverage) {
        writeln!(
            text,
            "sensor     {} {}: {:.2} % of its response lies within 360-830 nm",
            view.sensor.name,
            channel.name,
            100.0 * coverage
        )?;
    }
    let record = view.record();
    for stage in &record.stages {
        writeln!(text, "stage      {}: {}, {}", stage.name, if stage.on { "on" } else { "off" }, stage.what)?;
    }
    for warning in &record.warnings {
        writeln!(text, "warning    {warning}")?;
    }
    Ok(())
}
