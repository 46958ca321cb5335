//! What chains run in: the scene, its plan, the eye, and what counts as bright.

use super::lengths::Lengths;
use crate::camera::Sensor;
use crate::light::Light;
use crate::path::{Eye, Media};
use crate::scene::{Plan, Scene, View};
use crate::spectrum::{GRID_POINTS, LANES};

/// Everything that a path is judged by.
#[derive(Clone)]
pub struct World<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// What it needs, with every bidirectional strategy to choose from.
    pub plan: &'a Plan,
    /// Where paths end.
    pub eye: Eye<'a>,
    /// What the eye is in.
    pub eye_media: Media,
    /// What is recorded.
    pub sensor: &'a Sensor,
    /// Weight of each channel in the target function.
    pub weights: Vec<f64>,
    /// How often fresh paths are how long.
    pub lengths: Lengths,
    /// Width and height of the picture in pixels.
    pub resolution: [u32; 2],
    /// The unit of radiance in which targets are stated, in W sr^-1 m^-2 nm^-1: a power of two.
    pub light_unit: f32,
}

/// Exponents of two between which a unit and its inverse are normal numbers.
const UNIT_EXPONENTS: std::ops::RangeInclusive<i32> = -126..=126;

/// The power of two that brings the brightest emission of a scene to between one and two.
///
/// Chains decide by logarithms, which round otherwise under brighter lamps; in this unit a
/// scene whose lamps are all scaled by a power of two is the same scene, bit for bit.
fn light_unit(scene: &Scene) -> f32 {
    let brightest = |light: &Light| {
        let emission = match light {
            Light::Point(light) => &light.intensity,
            Light::Area(light) => light.radiance(),
        };
        let lines = emission.lines().map(|(_, power)| power);
        emission.at_grid_points().chain(lines).fold(0.0, f64::max)
    };
    let lights = (0..scene.lights.len()).map(|index| brightest(scene.lights.get(index as u32)));
    let largest = lights.fold(0.0, f64::max);
    if largest == 0.0 {
        return 1.0;
    }
    // The exponent from the bits: a logarithm may round up to the next one.
    let exponent = (largest.to_bits() >> 52) as i32 - 1023;
    2.0_f32.powi(exponent.clamp(*UNIT_EXPONENTS.start(), *UNIT_EXPONENTS.end()))
}

impl<'a> World<'a> {
    /// A view of a scene under its plan.
    ///
    /// The target function is the sum over channels of what they record, each over the
    /// integral of its response: wherever a channel sees something, it is positive.
    pub fn new(scene: &'a Scene, view: &'a View, plan: &'a Plan) -> Self {
        let start = view.camera.placement().position.as_vec3a();
        let integral = |channel: &crate::camera::Channel| -> f64 {
            (0..GRID_POINTS).map(|i| f64::from(channel.response.at_grid_point(i)).abs()).sum()
        };
        let weight = |sum: f64| if sum > 0.0 { 1.0 / sum } else { 0.0 };
        Self {
            scene,
            plan,
            eye: Eye::Camera(&view.camera),
            eye_media: if plan.tracks_media { Media::around(scene, start) } else { Media::NONE },
            sensor: &view.sensor,
            weights: view.sensor.channels.iter().map(|channel| weight(integral(channel))).collect(),
            lengths: Lengths::unknown(plan.strategies),
            resolution: view.camera.resolution(),
            light_unit: light_unit(scene),
        }
    }

    /// Lanes whose densities must be known: all of them where they differ.
    pub const fn lanes(&self) -> usize {
        if self.plan.lanes_differ { LANES } else { 1 }
    }
}
