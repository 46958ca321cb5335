//! One strategy by itself, unweighted.

use etalon::camera::Sensor;
use etalon::integrator::{Draw, Tracer};
use etalon::path::{Eye, Kind, Strategies, Subpaths};
use etalon::sampler::{BlockSampler, Stream};
use etalon::scene::{Plan, Scene};
use etalon::statistics::{BATCHES, BatchMean};
use std::collections::BTreeMap;

/// What a strategy finds: mean of the picture for each class of paths, in W sr^-1 m^-2 nm^-1 as
/// mean over the lanes. A class is the path's vertices, s for those at a delta.
pub type Classes = BTreeMap<String, BatchMean>;
/// What several strategies find of one class.
pub type Findings = Vec<((usize, usize), BatchMean)>;

/// The mean picture of one strategy alone, class by class.
pub fn alone(scene: &Scene, strategy: (usize, usize), samples: u32) -> Classes {
    alone_with(scene, strategy, samples, 17)
}

/// The same with a seed.
pub fn alone_with(scene: &Scene, (s, t): (usize, usize), samples: u32, seed: u64) -> Classes {
    let view = scene.view().expect("a camera");
    let mut plan = Plan::of(scene, &Sensor::cie(), Strategies::ALL);
    // Those that a plan leaves out are right all the same.
    plan.strategies = Strategies::ALL.only(s, t);
    let tracer = Tracer::new(scene, &plan, Eye::Camera(&view.camera));
    let size = samples / BATCHES as u32;
    let mut sums: BTreeMap<String, [f64; BATCHES]> = BTreeMap::new();
    for batch in 0..BATCHES {
        let name = (s * 16 + t) as u64;
        let numbers = BlockSampler::new(seed, name, batch as u32, size);
        for index in 0..size {
            let sampler = numbers.sample(index);
            let wavelengths = plan.wavelengths.sample(sampler.single(Stream::Wavelength, 0));
            let [x, y] = sampler.pair(Stream::Pixel, 0).map(|u| 8.0 * f64::from(u));
            let draw = Draw { position: [x, y], wavelengths: &wavelengths, sampler: &sampler };
            let (mut paths, mut found) = (Subpaths::default(), Vec::new());
            tracer.trace(&draw, &mut paths, &mut |contribution| {
                if (contribution.s, contribution.t) == (s, t) {
                    assert!(contribution.weight == 1.0, "alone, ({s}, {t}) takes all: {contribution:?}");
                    found.push(*contribution);
                }
            });
            for contribution in found {
                let delta = |delta: bool| if delta { 's' } else { 'd' };
                // Vertices next to the joint are joined at, whatever their walk did from there.
                let light = paths.light.iter().take(s.saturating_sub(usize::from(t > 0)));
                let eye = paths.eye.iter().take(t.saturating_sub(1));
                let mut class: String = light.map(|v| delta(v.is_delta)).collect();
                class.extend(std::iter::repeat_n('d', s + t - class.len() - eye.len()));
                class.extend(eye.rev().map(|v| delta(v.is_delta && !matches!(v.kind, Kind::Eye { .. }))));
                let value = f64::from(contribution.estimate.mean()) / f64::from(size);
                sums.entry(class).or_insert([0.0; BATCHES])[batch] += value;
            }
        }
    }
    sums.into_iter().map(|(class, means)| (class, BatchMean::of(&means))).collect()
}
