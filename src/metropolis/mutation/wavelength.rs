//! Another wavelength: on the same vertices, or where smooth surfaces disperse on those that
//! the same rays lead to.

use super::moved::{Amount, joint_beyond};
use super::{Mutator, PRIMARY_STEPS};
use crate::metropolis::numbers::Numbers;
use crate::metropolis::path::Path;
use crate::path::Kind;
use glam::Vec3A;

impl Mutator<'_, '_> {
    pub(super) fn wavelength(&mut self, x: &Path, y: &mut Path, numbers: &mut Numbers) -> Option<f64> {
        let world = self.world;
        y.copy_nodes(x);
        y.u_wavelength = PRIMARY_STEPS.along_unit(x.u_wavelength, numbers);
        y.wavelengths = world.plan.wavelengths.sample(y.u_wavelength);
        for node in &mut y.nodes {
            if let Kind::Surface(surface) = &mut node.kind {
                *surface = surface.at(world.scene, &y.wavelengths);
            }
        }
        // Refraction by another index leads elsewhere.
        let index = |path: &Path, at: usize| {
            let surface = path.nodes[at].surface();
            surface.map_or(1.0, |surface| surface.bsdf.radiance_scale(Vec3A::Z))
        };
        let turns = |at: &usize| x.is_delta(*at) && x.crosses(*at) && index(x, *at) != index(y, *at);
        let last = x.count() - 1;
        let Some(nearest_light) = (1..last).find(turns) else {
            let carries = y.judge(world);
            return carries.then_some(y.ln_target - x.ln_target);
        };
        let nearest_eye = (1..last).rev().find(turns)?;
        // What the eye's rays lead to begins at the first joint, or takes in the whole path.
        let seen = (1..last).rev().find(|index| !x.is_delta(*index));
        let reached = seen.and_then(|seen| joint_beyond(x, seen)).unwrap_or(0);
        if nearest_light > reached {
            return self.moved_from_eye(x, y, Amount::Nothing, numbers);
        }
        let given = (0..last - 1).rev().find(|index| !x.is_delta(*index))?;
        let lit = !x.is_delta(last - 1) && nearest_light > given && nearest_eye < last;
        if lit { self.moved_from_light(x, y, Amount::Nothing, numbers) } else { None }
    }
}
