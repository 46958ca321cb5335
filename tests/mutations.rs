//! Every mutation leaves the distribution of paths as it is, and a chain judges a path as its
//! vertices alone say.
//!
//! Paths are drawn independently and weighed by what they count, so that they follow the
//! chain's distribution; each is mutated once. If the mutation keeps the distribution, then
//! whatever is measured on paths, its mean change by accepted mutations is zero. A mutation
//! whose transition probabilities are wrong anywhere carries light from one place to another.

mod common;

use common::rooms::rooms;
use etalon::metropolis::{Mutation, Mutator, Numbers, Path, Place, World};
use etalon::path::{Kind, Strategies, Vertex, Whole};
use etalon::scene::{Plan, Scene};
use etalon::spectrum::Spectrum;
use rayon::prelude::*;

/// Largest |z| of a mean change. Some 800 means: a false alarm once in 2000 draws of the seeds.
const SIGMAS: f64 = 5.0;
/// Fresh paths of a room.
const PATHS: u64 = 400_000;
/// Paths of one piece of parallel work.
const PIECE: u64 = 4000;
/// Numbers measured on a path.
const MEASURES: usize = 12;

/// What is measured on a path: where it ends in the picture, how long it is and of what, its
/// wavelengths and colour, how far from the light and the eye its vertices are.
fn measures(path: &Path, world: &World<'_>) -> [f64; MEASURES] {
    let count = path.count();
    let share = |axis: usize| path.position[axis] / f64::from(world.resolution[axis]);
    let deltas = (1..count - 1).filter(|index| path.is_delta(*index)).count();
    let distance = |a: usize, b: usize| {
        let [a, b] = [a, b].map(|index| path.nodes[index].point.position.as_dvec3());
        (a - b).length()
    };
    let flag = |is: bool| f64::from(u8::from(is));
    [
        share(0),
        share(1),
        flag(share(0) > 0.25 && share(0) < 0.75 && share(1) > 0.25 && share(1) < 0.75),
        flag(count == 4),
        flag(count > 5),
        flag(deltas > 0),
        deltas as f64 / count as f64,
        flag(path.is_delta(count - 2)),
        flag(path.is_delta(1)),
        f64::from(path.wavelengths.nm[0] > 550.0),
        distance(0, 1).min(1.0),
        distance(1, 2).min(1.0),
    ]
}

/// Sums over independent paths of one measure's change, and of its square.
#[derive(Clone, Copy, Default)]
struct Change {
    sum: f64,
    squares: f64,
    moved: u32,
}

fn world<'a>(scene: &'a Scene, plan: &'a Plan) -> World<'a> {
    World::new(scene, scene.view().expect("a camera"), plan)
}

/// Changes by each mutation: of every measure.
fn changes(world: &World<'_>) -> Vec<[Change; MEASURES]> {
    let nothing = || vec![[Change::default(); MEASURES]; Mutation::ALL.len()];
    let add = |mut all: Vec<[Change; MEASURES]>, more: Vec<[Change; MEASURES]>| {
        for (into, from) in all.iter_mut().flatten().zip(more.iter().flatten()) {
            into.sum += from.sum;
            into.squares += from.squares;
            into.moved += from.moved;
        }
        all
    };
    let piece = |piece: u64| {
        let mut all = nothing();
        let place = Place { key: piece, chain: 0, bits: 0, drawn: 0 };
        let mut mutator = Mutator::new(world, place);
        let wavelengths = world.plan.wavelengths.sample(0.0);
        let (mut x, mut y) = (Path::empty(wavelengths), Path::empty(wavelengths));
        for index in piece * PIECE..(piece + 1) * PIECE {
            let mut numbers = Numbers::of(&[5, index]);
            if mutator.fresh(&mut x, &mut numbers).is_none() {
                continue;
            }
            let weight = x.ln_estimate().exp();
            let before = measures(&x, world);
            for mutation in Mutation::ALL {
                if !mutation.applies(&x) {
                    continue;
                }
                let Some(ln_ratio) = mutator.propose(mutation, &x, &mut y, &mut numbers) else { continue };
                let applies = if mutation.applies(&y) { 1.0 } else { 0.0 };
                let acceptance = (ln_ratio.exp() * applies).min(1.0);
                let after = measures(&y, world);
                for (measure, change) in all[mutation as usize].iter_mut().enumerate() {
                    let by = weight * acceptance * (after[measure] - before[measure]);
                    change.sum += by;
                    change.squares += by * by;
                    change.moved += u32::from(by != 0.0);
                }
            }
        }
        all
    };
    let pieces: Vec<_> = (0..PATHS / PIECE).into_par_iter().map(piece).collect();
    pieces.into_iter().fold(nothing(), add)
}

#[test]
fn mutations_leave_the_distribution_as_it_is() {
    let mut moved = [0_u32; Mutation::ALL.len()];
    let mut wrong = Vec::new();
    for (name, scene) in rooms() {
        let plan = Plan::of(&scene, &scene.view().expect("a camera").sensor, Strategies::ALL);
        let mut world = world(&scene, &plan);
        // As in a render: how long fresh paths are follows from the scene.
        let found = world.find(3, 4096, 1 << 24).found;
        let starts = world.starts(&found, 16, &mut Numbers::of(&[4]));
        world.learn(3, starts, 256);
        for (mutation, changes) in Mutation::ALL.iter().zip(changes(&world)) {
            for (measure, change) in changes.iter().enumerate() {
                moved[*mutation as usize] += change.moved;
                let z = change.sum / change.squares.sqrt();
                if z.abs() > 3.5 {
                    println!(
                        "{name}, {}: measure {measure}: z = {z:.2} of {}",
                        mutation.name(),
                        change.moved
                    );
                }
                if z.abs() > SIGMAS {
                    wrong.push(format!("{name}, {}: measure {measure}: z = {z:.2}", mutation.name()));
                }
            }
        }
    }
    println!("{moved:?}");
    assert!(wrong.is_empty(), "{wrong:#?}");
    assert!(moved.iter().all(|moved| *moved > 10_000), "{moved:?}");
}

/// What each strategy has of a path, what a fresh path counts, and what channels record of it
/// against [`Whole`], which knows nothing of how a chain keeps them; both from the same vertices.
#[test]
fn paths_are_judged_from_their_vertices() {
    /// Two computations in 32 bits of the same number.
    const ROUNDING: f64 = 2e-3;
    /// Share of the mean that is nothing.
    const NOTHING: f64 = 1e-5;
    for (name, scene) in rooms() {
        let plan = Plan::of(&scene, &scene.view().expect("a camera").sensor, Strategies::ALL);
        let world = world(&scene, &plan);
        let mut mutator = Mutator::new(&world, Place { key: 0, chain: 0, bits: 0, drawn: 0 });
        let mut path = Path::empty(plan.wavelengths.sample(0.0));
        let (mut judged, mut compared) = (0, Vec::new());
        for index in 0..40_000 {
            let made = mutator.fresh(&mut path, &mut Numbers::of(&[6, index]));
            // Longer walks survive by chance, of which the vertices tell nothing.
            if made.is_none() || path.count() > 32 {
                continue;
            }
            let vertices: Vec<Vertex> = path.nodes.iter().map(|node| vertex(&world, node)).collect();
            let whole = Whole::new(&scene, &world.eye, &path.wavelengths, vertices).expect("a light");
            let ln_probability = |s: usize| {
                let (all, from_light) = path.counted(s);
                world.lengths.probability(all, from_light).ln()
            };
            let made = |s: &usize| whole.is_made_by(&plan.strategies, *s);
            let densities: Vec<f64> = (0..=path.count())
                .map(|s| if made(&s) { ln_probability(s) + whole.density(s)[0] } else { f64::NEG_INFINITY })
                .collect();
            let largest = densities.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            let ln_fresh = largest + densities.iter().map(|ln| (ln - largest).exp()).sum::<f64>().ln();
            for (s, slow) in densities.iter().enumerate() {
                let fast = (ln_probability(s) + path.ln_strategy(s) - path.ln_fresh).exp();
                let slow = (slow - ln_fresh).exp();
                assert!((fast - slow).abs() < ROUNDING, "{name}, share of s = {s}: {fast}, whole {slow}");
            }
            let value = whole.value().expect("a path with a value");
            let value = Spectrum::from_fn(|lane| value[lane] as f32);
            let mut recorded = Vec::new();
            world.sensor.record(value, &path.wavelengths, |_, v| recorded.push(v));
            let target: f64 = recorded.iter().zip(&world.weights).map(|(v, weight)| v.abs() * weight).sum();
            // Other wavelengths share the path by the density that they would make it with.
            if !plan.lanes_differ && target.is_finite() {
                let estimate = path.ln_estimate().exp() * f64::from(world.light_unit);
                compared.push((estimate, target / ln_fresh.exp()));
            }
            // What the whole path counts is in 32 bits, and dim wavelengths leave their range.
            for (share, v) in path.channels.iter().zip(&recorded).filter(|(_, v)| (1e-30..1e30).contains(*v))
            {
                assert!(
                    (share * target / v - 1.0).abs() < ROUNDING,
                    "{name}: {share} of {target}, whole {v}"
                );
            }
            judged += 1;
        }
        let mean = compared.iter().map(|(_, slow)| slow).sum::<f64>() / compared.len() as f64;
        for (fast, slow) in compared {
            let allowed = ROUNDING * slow + NOTHING * mean;
            assert!((fast - slow).abs() < allowed, "{name}: {fast}, whole {slow}, mean {mean}");
        }
        assert!(judged > 100, "{name}: {judged} paths");
    }
}

fn vertex(world: &World<'_>, node: &etalon::metropolis::Node) -> Vertex {
    let start = etalon::path::Media::NONE;
    let mut vertex = Vertex::at(node.point, node.kind, start);
    vertex.is_delta = node.is_delta;
    debug_assert!(!matches!(vertex.kind, Kind::Eye { has_area } if has_area != world.eye.has_aperture()));
    vertex
}
