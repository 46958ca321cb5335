//! An independent sample taken again: by the very function that took it for the picture.

use super::name::{MeterSample, PixelSample};
use crate::error::{Error, Result};
use crate::integrator::{Bounded, DirectLight, MeterTaken, Taken, Tracer, eye_of, meter_sensor};
use crate::path::{Contribution, Eye, Subpaths};
use crate::sampler::BlockSampler;
use crate::scene::{Plan, Scene, View};
use crate::spectrum::Wavelengths;

/// A sample taken again.
#[derive(Debug)]
pub struct Replayed {
    /// Its wavelengths.
    pub wavelengths: Wavelengths,
    /// Both subpaths.
    pub paths: Subpaths,
    /// Every contribution, in the order in which it was found.
    pub contributions: Vec<Contribution>,
    /// What it has left in its own pixel, channel by channel; zero where that is not finite.
    pub own: Vec<f64>,
    /// Other pixels that it has left light in, numbered in rows from the top left, and what.
    pub splats: Vec<(u32, Vec<f64>)>,
    /// What of it was not finite.
    pub non_finite: u64,
}

/// Takes a sample of a picture again, under the plan that the picture was rendered by.
///
/// # Errors
///
/// A pixel outside of the picture, or an index outside of its block.
pub fn replay_pixel(scene: &Scene, view: &View, plan: &Plan, name: &PixelSample) -> Result<Replayed> {
    let PixelSample { pixel: [x, y], seed, block, block_size, index, direct_light } = *name;
    let [width, height] = view.camera.resolution();
    if x >= width || y >= height {
        return Err(Error::new(format!("pixel {x},{y} lies outside of {width} x {height} pixels"))
            .hint("pixels are counted from 0, from the top left; --resolution gives the picture's size"));
    }
    check_index(index, block_size)?;
    let direct_plan;
    let plan = if direct_light {
        direct_plan = DirectLight::plan(scene, &view.sensor, plan);
        &direct_plan
    } else {
        plan
    };
    let eye = Eye::Camera(&view.camera);
    let bounded = Bounded::of(scene, plan, eye);
    let tracer = Tracer::new(scene, &bounded.plan, eye);
    let number = u64::from(y) * u64::from(width) + u64::from(x);
    let sampler = BlockSampler::new(seed, number, block, block_size).sample(index);
    let (mut paths, mut contributions, mut taken) = (Subpaths::default(), Vec::new(), Taken::default());
    let corner = [f64::from(x), f64::from(y)];
    let (wavelengths, non_finite) =
        taken.take(&tracer, &view.sensor, (corner, width), &sampler, &mut paths, |found| {
            contributions.push(*found);
        });
    let values = taken.splat_values.chunks_exact(view.sensor.channels.len()).map(<[f64]>::to_vec);
    let splats = taken.splat_pixels.into_iter().zip(values).collect();
    Ok(Replayed { wavelengths, paths, contributions, own: taken.own, splats, non_finite })
}

/// Takes a sample of a meter again, under the plan that it was read by.
///
/// # Errors
///
/// A meter that the scene does not have, or an index outside of the batch.
pub fn replay_meter(scene: &Scene, plan: &Plan, name: &MeterSample) -> Result<Replayed> {
    let MeterSample { meter, seed, block, block_size, index } = name;
    check_index(*index, *block_size)?;
    let number = scene.meters.iter().position(|known| known.name == *meter).ok_or_else(|| {
        Error::unknown_name("meter", meter, scene.meters.iter().map(|known| known.name.as_str()))
    })?;
    let eye = eye_of(&scene.meters[number]);
    let bounded = Bounded::of(scene, plan, eye);
    let tracer = Tracer::new(scene, &bounded.plan, eye);
    let sampler = BlockSampler::new(*seed, number as u64, *block, *block_size).sample(*index);
    let (mut paths, mut contributions) = (Subpaths::default(), Vec::new());
    let taken = MeterTaken::take(&tracer, &bounded.plan, &meter_sensor(), &sampler, &mut paths, |found| {
        contributions.push(*found);
    });
    Ok(Replayed {
        wavelengths: taken.wavelengths,
        paths,
        contributions,
        own: taken.recorded.unwrap_or_default().to_vec(),
        splats: Vec::new(),
        non_finite: u64::from(taken.recorded.is_none()),
    })
}

fn check_index(index: u32, block_size: u32) -> Result<()> {
    if index < block_size {
        return Ok(());
    }
    Err(Error::new(format!("a block of {block_size} samples has no sample {index}"))
        .hint("samples of a block are counted from 0"))
}
