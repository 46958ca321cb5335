//! What plans say they save, against the page that says how it was measured.

use etalon::scene::{PLAN_ITEMS, plan_savings};
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

#[test]
fn every_item_was_measured() {
    for item in PLAN_ITEMS {
        assert!(plan_savings().any(|saving| saving.item == item), "{item}");
    }
    for saving in plan_savings() {
        assert!(saving.share().is_finite() && saving.instructions_left_out > 0.0, "{saving:?}");
    }
}
