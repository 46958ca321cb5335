//! What samples contribute, each with the path that it came from, taken apart into vertices.

use etalon::camera::Sensor;
use etalon::integrator::{Draw, Tracer};
use etalon::path::{Contribution, Eye, Kind, Strategies, Subpaths, Vertex, Whole};
use etalon::sampler::{BlockSampler, Stream};
use etalon::scene::{Plan, Scene};

/// The vertices of a contribution from the light on.
fn vertices(found: &Contribution, paths: &Subpaths) -> Option<Vec<Vertex>> {
    let mut light: Vec<Vertex> = paths.light.iter().take(found.s).copied().collect();
    let mut eye: Vec<Vertex> = paths.eye.iter().take(found.t).copied().collect();
    let any = *paths.eye.first()?;
    if found.s == 1 {
        let end = found.end?;
        let (light_index, primitive) = end.light?;
        light = vec![Vertex {
            point: end.point,
            kind: Kind::Light { light: light_index, primitive },
            is_delta: false,
            ..any
        }];
    } else if found.t == 1 {
        eye = vec![Vertex { point: found.end?.point, ..any }];
    } else if found.t == 0 {
        light.truncate(found.s - 1);
        light.push(Vertex { point: found.end?.point, is_delta: false, ..any });
    }
    if found.s > 0 && found.t > 0 {
        light.last_mut()?.is_delta = false;
    }
    if let Some(last) = eye.last_mut() {
        last.is_delta = false;
    }
    Some(light.into_iter().chain(eye.into_iter().rev()).collect())
}

/// Calls `check` for every contribution of a number of samples.
pub fn each_contribution(
    scene: &Scene,
    strategies: Strategies,
    (samples, seed): (u32, u64),
    mut check: impl for<'a> FnMut(&Contribution, &Subpaths, Whole<'a, '_>, &Plan),
) {
    let view = scene.view().expect("a camera");
    let mut plan = Plan::of(scene, &Sensor::cie(), Strategies::ALL);
    plan.strategies = strategies;
    let tracer = Tracer::new(scene, &plan, Eye::Camera(&view.camera));
    let eye = Eye::Camera(&view.camera);
    let numbers = BlockSampler::new(seed, 0, 0, samples);
    for index in 0..samples {
        let sampler = numbers.sample(index);
        let wavelengths = plan.wavelengths.sample(sampler.single(Stream::Wavelength, 0));
        let [x, y] = sampler.pair(Stream::Pixel, 0).map(f64::from);
        let draw = Draw { position: [6.0 * x, 4.0 * y], wavelengths: &wavelengths, sampler: &sampler };
        let (mut paths, mut found) = (Subpaths::default(), Vec::new());
        tracer.trace(&draw, &mut paths, &mut |contribution| found.push(*contribution));
        for contribution in found {
            // Which point of a wide lens (1, 1) was joined to is not told.
            if (contribution.s, contribution.t) == (1, 1) && eye.has_aperture() {
                continue;
            }
            let vertices = vertices(&contribution, &paths).expect("a whole path");
            let whole = Whole::new(scene, &eye, &wavelengths, vertices).expect("the first vertex shines");
            check(&contribution, &paths, whole, &plan);
        }
    }
}
