//! What a scene's instruments read, with a confidence interval.

use super::Integrator;
use super::tracer::{Draw, Tracer};
use crate::camera::{CIE_SENSOR, Sensor};
use crate::geometry::Ray;
use crate::path::{Eye, Subpaths};
use crate::sampler::{BlockSampler, Stream};
use crate::scene::{Meter, MeterKind, Plan, Scene};
use crate::statistics::{BATCHES, BatchMean};
use rayon::prelude::*;

/// Channel of luminance or illuminance in [`meter_sensor`].
const Y: usize = 1;
/// Channel of the radiant quantity in [`meter_sensor`].
const RADIANT: usize = 3;

/// An instrument's reading.
#[derive(Clone, Debug)]
pub struct Reading {
    /// The instrument's name.
    pub name: String,
    /// Whether it is an illuminance meter (lx and W/m2) or a luminance meter (cd/m2 and
    /// W sr^-1 m^-2).
    pub is_illuminance: bool,
    /// Photometric value: lx or cd/m2.
    pub photometric: BatchMean,
    /// Radiant value within 360 to 830 nm: W/m2 or W sr^-1 m^-2.
    pub radiant: BatchMean,
    /// Tristimulus means, Y the photometric value.
    pub xyz: [f64; 3],
    /// Samples that were not finite; they count as zero.
    pub non_finite_samples: u64,
}

/// Reads every meter of a scene with `samples` paths each, rounded up to whole batches.
pub fn read_meters(scene: &Scene, integrator: Integrator, samples: u64, seed: u64) -> Vec<Reading> {
    let sensor = meter_sensor();
    let mut plan = Plan::of(scene, &sensor, integrator.strategies());
    plan.strategies = plan.strategies.for_instruments();
    let one = |(index, meter): (usize, &Meter)| {
        let eye = match meter.kind {
            MeterKind::Illuminance(point) => Eye::Irradiance(point),
            MeterKind::Luminance { position, direction } => Eye::Radiance(Ray::new(position, direction)),
        };
        let run = Run { samples, seed, index: index as u64 };
        read(&Tracer::new(scene, &plan, eye), &plan, &sensor, meter, &run)
    };
    scene.meters.iter().enumerate().map(one).collect()
}

/// Tristimulus values and the radiant quantity.
fn meter_sensor() -> Sensor {
    Sensor::named(CIE_SENSOR).expect("the CIE sensor is built in").with_radiant_channel()
}

struct Run {
    samples: u64,
    seed: u64,
    index: u64,
}

fn read(tracer: &Tracer<'_>, plan: &Plan, sensor: &Sensor, meter: &Meter, run: &Run) -> Reading {
    let size = run.samples.div_ceil(BATCHES as u64).clamp(1, 1 << 24) as u32;
    let batches: Vec<([f64; 4], u64)> = (0..BATCHES as u32)
        .into_par_iter()
        .map(|batch| {
            let numbers = BlockSampler::new(run.seed, run.index, batch, size);
            let (mut sums, mut non_finite) = ([0.0; 4], 0);
            let mut paths = Subpaths::default();
            for index in 0..size {
                let sampler = numbers.sample(index);
                let wavelengths = plan.wavelengths.sample(sampler.single(Stream::Wavelength, 0));
                let position = sampler.pair(Stream::Pixel, 0).map(f64::from);
                let draw = Draw { position, wavelengths: &wavelengths, sampler: &sampler };
                let received = tracer.gather(&draw, &mut paths);
                if received.is_finite() {
                    sensor.record(received, &wavelengths, |channel, value| sums[channel] += value);
                } else {
                    non_finite += 1;
                }
            }
            (sums.map(|sum| sum / f64::from(size)), non_finite)
        })
        .collect();
    let channel = |index: usize| BatchMean::of(&std::array::from_fn(|b| batches[b].0[index]));
    Reading {
        name: meter.name.clone(),
        is_illuminance: matches!(meter.kind, MeterKind::Illuminance(_)),
        photometric: channel(Y),
        radiant: channel(RADIANT),
        xyz: [0, 1, 2].map(|index| channel(index).mean),
        non_finite_samples: batches.iter().map(|(_, count)| count).sum(),
    }
}
