//! The stretch from the eye over mirrors to the first vertex that is none, drawn anew.
//!
//! Positions in the picture are stratified between the chains of a block: at the same turn
//! each chain has another cell of the picture, and for a single chain every position is as
//! probable as any other, whatever it drew before. A stratification along a chain would make
//! what is proposed depend on where it has been.

use super::{Mutator, Place};
use crate::material::Quantity;
use crate::metropolis::grow::{Source, survives};
use crate::metropolis::numbers::Numbers;
use crate::metropolis::path::Path;
use crate::sampler::{mix, owen_sobol_2d};

impl Place {
    /// The next position in the unit square.
    fn next(&mut self) -> [f32; 2] {
        let key = mix(self.key ^ mix(self.drawn));
        self.drawn += 1;
        owen_sobol_2d(self.chain, self.bits, key)
    }
}

impl Mutator<'_, '_> {
    pub(super) fn lens_subpath(&mut self, x: &Path, y: &mut Path, numbers: &mut Numbers) -> Option<f64> {
        let world = self.world;
        let u = self.place.next();
        let kept = (1..x.count() - 1).rev().find(|index| !x.is_delta(*index))?;
        y.copy_nodes(x);
        self.draft.keep(x, kept, 0);
        self.draft.eye.push(world.eye_node(numbers)?);
        let position = [0, 1].map(|i| f64::from(u[i]) * f64::from(world.resolution[i]));
        let mut ray = world.eye_ray(&self.draft.eye[0], position)?;
        loop {
            if !survives(&self.draft.eye, numbers) {
                return None;
            }
            self.draft.eye.push(world.meet(&ray, &y.wavelengths)?);
            let [.., from, node] = &mut self.draft.eye[..] else { return None };
            if !node.is_mirror() {
                break;
            }
            let drawn = numbers.scatter();
            ray = world.scattered_ray(node, from, drawn, Quantity::Radiance)?;
        }
        if !world.sees(self.draft.light.last()?, self.draft.eye.last()?) {
            return None;
        }
        self.draft.finish(y);
        // Density of everything from the first vertex seen on, up to the point of the lens.
        let drawn = |path: &Path| path.ln_between(kept, path.count(), kept);
        y.judge(world).then(|| y.ln_target - x.ln_target + drawn(x) - drawn(y))
    }
}
