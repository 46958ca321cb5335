//! Which algorithm is the best for a scene, found out by trying: `--integrator auto`.
//!
//! A pilot takes a small share of the work that the render is to take, with random numbers of its
//! own, and nothing of it enters the picture: given what is picked, the render is that of the
//! pick, bit for bit, and as unbiased. Judged are path tracing, bidirectional path tracing with
//! its groups of strategies on and off (`samples`) and, where they may win, chains of paths
//! (`chains`), by the efficiency 1 / (relative mean squared error x work). Work is counted, not
//! timed (`work`): with a number of samples the same seed picks the same on any number of threads,
//! and so gives the same bits.

mod chains;
mod report;
mod samples;
mod selection;
mod work;

pub use report::{By, Report, Row};
pub use selection::Selection;
pub use work::Counts;

use crate::integrator::{Bounded, Budget, FEWEST_SAMPLES, Integrator, cpu_seconds};
use crate::material::Material;
use crate::path::{Eye, Groups, Strategies};
use crate::sampler::mix;
use crate::scene::{Leaving, Plan, Scene, View};
use report::UNTRIED;
use samples::{Findings, Pilot, SAMPLES_PER_PIXEL};
use std::time::Instant;

/// Share of a render's work that its pilot may take.
const SHARE: f64 = 0.04;
/// Part of that for samples; the rest is for chains.
const OF_SAMPLES: f64 = 0.5;
/// Pixels looked at to see what a sample costs, at least and at most.
const PROBE_PIXELS: u64 = 64;
const FEWEST_PIXELS: u64 = 256;
const MOST_PIXELS: u64 = 1 << 14;
/// Mutations of a pilot of chains, at least and at most.
const MUTATIONS: [u64; 2] = [1 << 16, 1 << 21];
/// Times as efficient as the best list that chains without memory must be, judged as chains are, for
/// these to be tried at more than the ordinary share of the work.
const PROMISE: f64 = 4.0;
/// That share, and the mutations that are enough then.
const PROMISED_SHARE: f64 = 0.12;
const FEWEST_PROMISED: u64 = 1 << 14;
/// What is simpler is picked where it is within this factor of the best.
const NEAR_TIE: f64 = 1.05;
/// Light that a list may miss by rounding.
const NOTHING_MISSING: f64 = 1e-4;
/// Factor in disfavour of chains: short ones do not show how long they remember, and the pilot's
/// samples, whose pixels are independent, are not stratified as a render's blocks of 16 are, which
/// makes lists look up to twice as bad as they are. Against efficiencies measured at 64 to 96
/// pixels' width (pilots for 60 s, 2026-11-23) chains looked 1 to 2 times better than they are on
/// cornell-ccd, 3 on schoedl-2007-small-bulb, 3 to 4 on schoedl-2007, 4 on stanford and slit-room, 5
/// on yale-grey and door-ajar. Where they win by far, as past the door, they win in spite of it.
const MEMORY: f64 = 6.0;
/// Chains are tried only where they would win at this multiple of the error that chains without
/// memory would have: half of what they are judged by, since cells tell that error roughly.
const HOPE: f64 = 0.5 * MEMORY;
/// Names the pilot's random numbers.
const SEED: u64 = 0x0070_696c_6f74;

/// Lists of strategies, the simplest first.
const LISTS: [Groups; 5] = [
    Groups::PATH,
    Groups::LIGHT,
    Groups { path: true, joins: false, splats: true },
    Groups { path: true, joins: true, splats: false },
    Groups::ALL,
];

/// What was picked, and why.
#[derive(Clone, Debug)]
pub struct Choice {
    /// What is to be rendered with.
    pub selection: Selection,
    /// The figures.
    pub report: Report,
}

/// Picks what renders a view of a scene best within a budget, under plans that leave out what
/// `leaving` lets them and, where bounces are limited, follow so many.
pub fn choose(
    scene: &Scene,
    view: &View,
    budget: &Budget,
    most_bounces: Option<u32>,
    leaving: &Leaving,
) -> Choice {
    let (began, cpu_before) = (Instant::now(), cpu_seconds());
    let plan_of = |groups: Groups| {
        let plan = Plan::under(scene, &view.sensor, groups.strategies(), leaving);
        Plan { most_bounces, ..plan }
    };
    let plans = LISTS.map(plan_of);
    let mut choice = match after_pilot(scene, view, budget, &plans) {
        Ok(choice) => choice,
        Err(why) => by_rule(scene, &plans, why),
    };
    choice.report.wall_s = began.elapsed().as_secs_f64();
    choice.report.cpu_s = cpu_seconds().zip(cpu_before).map(|(now, before)| now - before);
    choice
}

/// Whether a plan misses no light that all strategies together find.
fn misses_nothing(plan: &Plan, all: &Plan) -> bool {
    plan.unreachable.iter().all(|class| all.unreachable.iter().any(|other| other.word == class.word))
}

/// What is picked where nothing could be measured.
fn by_rule(scene: &Scene, plans: &[Plan; LISTS.len()], why: &'static str) -> Choice {
    let is_smooth = scene.used_materials().any(Material::is_smooth);
    let finds_all = misses_nothing(&plans[0], &plans[LISTS.len() - 1]);
    let (groups, reason) = match (finds_all, is_smooth) {
        (false, _) => (Groups::ALL, "path would miss light"),
        (true, true) => (Groups::ALL, "there are smooth surfaces"),
        (true, false) => (Groups::PATH, "nothing is smooth"),
    };
    let selection = Selection::of_groups(groups);
    let report = Report::by_rule(selection, format!("{why}; {reason}"));
    Choice { selection, report }
}

/// Processor seconds that the render can be expected to take with a sample's seconds.
fn render_seconds(view: &View, budget: &Budget, seconds_per_sample: f64) -> f64 {
    let pixels: f64 = view.camera.resolution().map(f64::from).iter().product();
    // Until its error is looked at, a run takes so many in any case.
    let most = if budget.error.is_some() { 2 * FEWEST_SAMPLES } else { u64::MAX };
    let by_samples = budget.samples_per_pixel.min(most) as f64 * pixels * seconds_per_sample;
    let by_time =
        budget.time.map_or(f64::INFINITY, |time| time.as_secs_f64() * rayon::current_num_threads() as f64);
    by_samples.min(by_time)
}

fn after_pilot(
    scene: &Scene,
    view: &View,
    budget: &Budget,
    plans: &[Plan; LISTS.len()],
) -> Result<Choice, &'static str> {
    /// What a sample of a path takes at least: below it, even looking is too dear.
    const LEAST_S: f64 = 5e-7;
    if scene.emitters.iter().all(|emitter| emitter.weight() == 0.0) {
        return Err("nothing shines");
    }
    let too_little = "too little is to be rendered for a pilot";
    let fewest_s = (FEWEST_PIXELS * SAMPLES_PER_PIXEL) as f64 * LEAST_S;
    if SHARE * render_seconds(view, budget, LEAST_S * LISTS.len() as f64) < fewest_s {
        return Err(too_little);
    }
    let all = &plans[LISTS.len() - 1];
    let bounded = Bounded::of(scene, all, Eye::Camera(&view.camera));
    // Strategies that the plan of all leaves out are sampled by none of its paths.
    let is_sampled = |s: &Strategies| {
        let of_all = &all.strategies;
        (!s.direct_asks_eye || of_all.direct_asks_eye) && (!s.light_to_eye || of_all.light_to_eye)
    };
    let lists = plans.each_ref().map(|plan| (plan.strategies, is_sampled(&plan.strategies)));
    let seed = mix(budget.seed ^ mix(SEED));
    let pilot = |pixels: u64| Pilot::new(scene, view, &bounded.plan, &lists, (seed, pixels)).run();
    let counts = pilot(PROBE_PIXELS).counts;
    let cheapest = LISTS.map(|groups| counts.seconds_per_sample(groups));
    let render_s = render_seconds(view, budget, cheapest[0]);
    let allowed_s = SHARE * render_s;
    let pixel_s = counts.seconds_per_pilot_sample() * SAMPLES_PER_PIXEL as f64;
    let pixels = (OF_SAMPLES * allowed_s / pixel_s) as u64;
    if pixels < FEWEST_PIXELS {
        return Err(too_little);
    }
    let pixels = pixels.min(MOST_PIXELS);
    let findings = pilot(pixels);
    if !findings.found_light() {
        return Err("the pilot found no light");
    }
    let mut rows = rows(&findings, plans, &lists);
    let usable = rows.iter().enumerate().filter(|(_, row)| row.excluded.is_none());
    let best = usable.map(|(list, row)| (list, row.cost())).min_by(|(_, a), (_, b)| a.total_cmp(b));
    let Some((list, best)) = best.filter(|(_, cost)| cost.is_finite()) else {
        return Err("the pilot's figures are beyond any number");
    };
    let spent_s = pixels as f64 * pixel_s;
    let chains =
        try_chains(scene, view, (&bounded.plan, &findings), (list, best), (mix(seed), spent_s, render_s));
    let mutations = chains.mutations;
    rows.push(chains);
    let picked = pick(&rows);
    let selection = rows[picked].name;
    let samples = (pixels + PROBE_PIXELS) * SAMPLES_PER_PIXEL;
    Ok(Choice { selection, report: Report::of(rows, picked, samples, mutations, render_s, findings.counts) })
}

/// The simplest of the best.
fn pick(rows: &[Row]) -> usize {
    let usable = |row: &&Row| row.excluded.is_none();
    let best = rows.iter().filter(usable).map(Row::cost).fold(f64::INFINITY, f64::min);
    let is_near = |row: &Row| row.excluded.is_none() && row.cost() <= NEAR_TIE * best;
    rows.iter().position(is_near).expect("the best is near itself")
}

fn rows(findings: &Findings, plans: &[Plan; LISTS.len()], lists: &[(Strategies, bool)]) -> Vec<Row> {
    let all = &plans[LISTS.len() - 1];
    let of_list = |list: usize| {
        let (groups, plan, expected) = (LISTS[list], &plans[list], &findings.lists[list]);
        let misses_some = expected.missing > NOTHING_MISSING;
        let share = format!("{:.2} % of the light", 100.0 * expected.missing);
        let excluded = if !misses_nothing(plan, all) {
            let words = plan.unreachable.iter().map(|class| class.word).collect::<Vec<_>>().join(", ");
            let share = if misses_some { format!(", {share}") } else { String::new() };
            Some(format!("cannot find light on the way {words}{share}"))
        } else if misses_some {
            Some(format!("cannot find {share}"))
        } else if !lists[list].1 {
            Some("no more than a bound is known: how roulette ends its long walks is not in it".to_owned())
        } else {
            None
        };
        Row {
            name: Selection::of_groups(groups),
            relmse_per_sample: Some(expected.relmse),
            scatter_per_sample: lists[list].1.then_some(expected.scatter),
            seconds_per_sample: findings.counts.seconds_per_sample(groups),
            efficiency: None,
            excluded,
            mutations: 0,
        }
    };
    (0..LISTS.len()).map(of_list).collect()
}

/// Chains, measured where they may be better than the best list, of which place and cost are given.
fn try_chains(
    scene: &Scene,
    view: &View,
    (plan, findings): (&Plan, &Findings),
    (list, best): (usize, f64),
    (seed, spent_s, render_s): (u64, f64, f64),
) -> Row {
    let seconds_per_sample = findings.counts.seconds_per_mutation();
    let row = |relmse: Option<f64>, mutations: u64, excluded: Option<&str>| Row {
        name: Selection::whole(Integrator::Mlt),
        relmse_per_sample: relmse,
        scatter_per_sample: relmse,
        seconds_per_sample,
        efficiency: None,
        excluded: excluded.map(ToOwned::to_owned),
        mutations,
    };
    let at_best = findings.visits * seconds_per_sample;
    if HOPE * at_best > best {
        let reason = "not tried: even chains that remember little would be slower";
        return row(Some(HOPE * findings.visits), 0, Some(reason));
    }
    let within = |share: f64| (((share * render_s - spent_s) / seconds_per_sample) as u64).min(MUTATIONS[1]);
    let promise = best / (MEMORY * at_best);
    let (fewest, mutations) = match within(SHARE) {
        few if few < MUTATIONS[0] && promise >= PROMISE => {
            (FEWEST_PROMISED, within(PROMISED_SHARE).min(MUTATIONS[0]))
        }
        mutations => (MUTATIONS[0], mutations),
    };
    if mutations < fewest {
        return row(None, 0, Some(UNTRIED));
    }
    match chains::measure(scene, view, plan, (findings, list), (seed, mutations)) {
        Some(chained) => {
            // A fresh path costs about what a mutation does.
            let before_s = chained.needed_paths * seconds_per_sample;
            if before_s >= render_s {
                return row(None, chained.mutations, Some("chains would find their starts too late"));
            }
            let relmse = MEMORY * chained.relmse * render_s / (render_s - before_s);
            row(Some(relmse), chained.mutations, None)
        }
        None => row(None, 0, Some("chains found nothing to start from")),
    }
}
