//! What plans say they save, against the page that says how it was measured.

use etalon::integrator::Integrator;
use etalon::scene::{PLAN_ITEMS, Plan, plan_savings};
use std::path::Path;

#[test]
fn plans_say_what_the_page_says() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("validation/plan.md");
    let page = std::fs::read_to_string(file).expect("the page is there");
    let rows = plan_savings().map(|saving| {
        let ratio = match (saving.efficiency_ratio, saving.efficiency_ratio_ci95) {
            (Some(ratio), Some([low, high])) => format!("{ratio:.3} ({low:.3} to {high:.3})"),
            _ => String::new(),
        };
        format!(
            "| {} | {} | {} | {:.0} | {:.0} | {:.1} % | {ratio} |",
            saving.item,
            saving.scene,
            saving.integrator,
            saving.instructions_kept,
            saving.instructions_left_out,
            100.0 * saving.share()
        )
    });
    let rows: Vec<String> = rows.collect();
    let on_page = page.lines().filter(|line| rows.iter().any(|row| row == line)).count();
    let table = page.lines().filter(|line| line.ends_with(" |") && line.contains(" % |")).count();
    assert_eq!((on_page, table), (rows.len(), rows.len()), "rows in common, rows of the page");
}

/// What plans say of other numbers of wavelengths is the least and the most of the page's scenes.
#[test]
fn plans_say_of_wavelengths_what_the_page_says() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("validation/plan.md");
    let page = std::fs::read_to_string(file).expect("the page is there");
    let (_, table) = page.split_once("## Wavelengths per path").expect("the section is there");
    let per_cent = |wavelengths: &str| {
        let cells = table.lines().map(|line| line.split('|').map(str::trim).collect::<Vec<_>>());
        let ratios = cells.filter(|cells| cells.get(3) == Some(&wavelengths));
        let ratios = ratios.map(|cells| cells[6].parse::<f64>().expect("a ratio"));
        let mut sorted: Vec<i64> = ratios.map(|ratio| (100.0 * (ratio - 1.0)).round().abs() as i64).collect();
        sorted.sort_unstable();
        format!("{} to {} %", sorted[0], sorted[sorted.len() - 1])
    };
    let said = format!("4 would be {} more efficient, 16 {} less", per_cent("4"), per_cent("16"));
    let scene = crate::common::scene(&crate::common::scenes::diffuse());
    let sensor = &scene.view().expect("a camera").sensor;
    let plan = Plan::of(&scene, sensor, Integrator::Path.strategies());
    assert!(plan.remarks.iter().any(|remark| remark.contains(&said)), "{said}: {:?}", plan.remarks);
}

/// A saving says what it costs in efficiency as well, and where it was measured.
#[test]
fn a_saving_that_costs_efficiency_says_so() {
    for saving in plan_savings() {
        let said = saving.to_string();
        assert!(
            said.ends_with(&format!(": measured on {} by {}", saving.scene, saving.integrator)),
            "{said}"
        );
        let ratio = saving.efficiency_ratio.map(|ratio| format!(", {ratio:.2} times as efficient:"));
        assert_eq!(ratio.is_some(), said.contains(" times as efficient"), "{said}");
        assert!(ratio.is_none_or(|ratio| said.contains(&ratio)), "{said}");
    }
}

#[test]
fn every_item_was_measured() {
    for item in PLAN_ITEMS {
        assert!(plan_savings().any(|saving| saving.item == item), "{item}");
    }
    for saving in plan_savings() {
        assert!(saving.share().is_finite() && saving.instructions_left_out > 0.0, "{saving:?}");
    }
}
