//! What a scene's instruments read, with a confidence interval.

use super::Integrator;
use super::depth::{Bounded, Truncation};
use super::tracer::{Draw, Tracer};
use crate::camera::{CIE_SENSOR, Sensor};
use crate::geometry::Ray;
use crate::path::{BothFates, Contribution, Eye, Subpaths};
use crate::replay::{Faults, MeterSample, SampleName};
use crate::sampler::{BlockSampler, Sampler, Stream};
use crate::scene::{Leaving, Meter, MeterKind, Plan, Scene};
use crate::spectrum::{Spectrum, Wavelengths};
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
    pub faults: Faults,
    /// What a limit on bounces has cut off, and what was trapped.
    pub truncation: Truncation,
}

/// Reads every meter of a scene with `samples` paths each, rounded up to whole batches.
pub fn read_meters(scene: &Scene, integrator: Integrator, samples: u64, seed: u64) -> Vec<Reading> {
    read_meters_under(scene, &instrument_plan(scene, integrator), samples, seed)
}

/// The plan by which an algorithm reads a scene's meters.
pub fn instrument_plan(scene: &Scene, integrator: Integrator) -> Plan {
    instrument_plan_under(scene, integrator, &Leaving::all())
}

/// The same with a say in what it leaves out.
pub fn instrument_plan_under(scene: &Scene, integrator: Integrator, leaving: &Leaving) -> Plan {
    let mut plan = Plan::under(scene, &meter_sensor(), integrator.strategies(), leaving);
    plan.strategies = plan.strategies.for_instruments();
    plan
}

/// Reads every meter under a plan.
pub fn read_meters_under(scene: &Scene, plan: &Plan, samples: u64, seed: u64) -> Vec<Reading> {
    let sensor = meter_sensor();
    let one = |(index, meter): (usize, &Meter)| {
        let eye = eye_of(meter);
        let bounded = Bounded::of(scene, plan, eye);
        let run = Run { samples, seed, index: index as u64 };
        read(&Tracer::new(scene, &bounded.plan, eye), &bounded, &sensor, meter, &run)
    };
    scene.meters.iter().enumerate().map(one).collect()
}

/// What light is gathered for by a meter.
pub const fn eye_of(meter: &Meter) -> Eye<'static> {
    match meter.kind {
        MeterKind::Illuminance(point) => Eye::Irradiance(point),
        MeterKind::Luminance { position, direction } => Eye::Radiance(Ray::new(position, direction)),
    }
}

/// Tristimulus values and the radiant quantity.
pub fn meter_sensor() -> Sensor {
    Sensor::named(CIE_SENSOR).expect("the CIE sensor is built in").with_radiant_channel()
}

struct Run {
    samples: u64,
    seed: u64,
    index: u64,
}

/// One sample of a meter.
#[derive(Clone, Copy, Debug)]
pub struct MeterTaken {
    /// Its wavelengths.
    pub wavelengths: Wavelengths,
    /// What it has received.
    pub received: Spectrum,
    /// What that is in each channel of [`meter_sensor`]; `None` where it is not finite.
    pub recorded: Option<[f64; 4]>,
}

impl MeterTaken {
    /// Takes a sample; `see` is shown every contribution.
    pub fn take(
        tracer: &Tracer<'_>,
        plan: &Plan,
        sensor: &Sensor,
        sampler: &Sampler,
        paths: &mut Subpaths,
        see: impl FnMut(&Contribution),
    ) -> Self {
        let wavelengths = plan.wavelengths.sample(sampler.single(Stream::Wavelength, 0));
        let position = sampler.pair(Stream::Pixel, 0).map(f64::from);
        let draw = Draw { position, wavelengths: &wavelengths, sampler };
        let received = tracer.gather_seen(&draw, paths, see);
        let mut values = [0.0; 4];
        sensor.record(received, &wavelengths, |channel, value| values[channel] = value);
        let is_finite = received.is_finite() && values.iter().all(|value| value.is_finite());
        Self { wavelengths, received, recorded: is_finite.then_some(values) }
    }
}

/// What a batch of samples comes to.
struct Batch {
    sums: [f64; 4],
    faults: Faults,
    fates: BothFates,
}

fn read(tracer: &Tracer<'_>, bounded: &Bounded<'_>, sensor: &Sensor, meter: &Meter, run: &Run) -> Reading {
    let size = run.samples.div_ceil(BATCHES as u64).clamp(1, 1 << 24) as u32;
    let one = |batch: u32| {
        let numbers = BlockSampler::new(run.seed, run.index, batch, size);
        let (mut sums, mut faults) = ([0.0; 4], Faults::default());
        let mut paths = Subpaths::default();
        for index in 0..size {
            let sampler = numbers.sample(index);
            let taken = MeterTaken::take(tracer, &bounded.plan, sensor, &sampler, &mut paths, |_| {});
            if let Some(values) = taken.recorded {
                sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += value);
            } else {
                let (meter, seed, block, block_size) = (meter.name.clone(), run.seed, batch, size);
                faults.note(1, || SampleName::Meter(MeterSample { meter, seed, block, block_size, index }));
            }
        }
        Batch { sums: sums.map(|sum| sum / f64::from(size)), faults, fates: paths.fates }
    };
    let batches: Vec<Batch> = (0..BATCHES as u32).into_par_iter().map(one).collect();
    let channel = |index: usize| BatchMean::of(&std::array::from_fn(|b| batches[b].sums[index]));
    let (photometric, radiant) = (channel(Y), channel(RADIANT));
    let xyz = [0, 1, 2].map(|index| channel(index).mean);
    let (mut faults, mut fates) = (Faults::default(), BothFates::default());
    for batch in batches {
        faults.merge(batch.faults);
        fates.merge(&batch.fates);
    }
    Reading {
        name: meter.name.clone(),
        is_illuminance: matches!(meter.kind, MeterKind::Illuminance(_)),
        photometric,
        radiant,
        xyz,
        faults,
        truncation: bounded.truncation(&fates),
    }
}
