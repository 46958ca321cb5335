//! A path that depends on no other: the large step, and where chains come from.

use super::Mutator;
use crate::metropolis::grow::Until;
use crate::metropolis::numbers::Numbers;
use crate::metropolis::path::Path;

impl Mutator<'_, '_> {
    /// Makes a path by a strategy that is drawn with it, and judges it.
    ///
    /// Its density is the sum over all strategies that would make it, each with the
    /// probability of being drawn ([`Path::ln_fresh`]).
    pub fn fresh(&mut self, y: &mut Path, numbers: &mut Numbers) -> Option<()> {
        let world = self.world;
        y.u_wavelength = numbers.single();
        y.wavelengths = world.plan.wavelengths.sample(y.u_wavelength);
        let (vertices, s) = world.lengths.draw(numbers)?;
        self.draft.light.clear();
        self.draft.eye.clear();
        let lengths = (Until::Counted(s), Until::Counted(vertices - s));
        world.complete(&mut self.draft, lengths, &y.wavelengths, numbers)?;
        self.draft.finish(y);
        y.judge(world).then_some(())
    }
}
