//! The bidirectional mutation (Veach and Guibas 1997, section 5.3.1): a stretch of the path is
//! cut out, and another one, of nearly as many vertices, grows from both its ends.

use super::Mutator;
use crate::metropolis::grow::Until;
use crate::metropolis::numbers::Numbers;
use crate::metropolis::path::{Path, ln_sum};

/// Probability of cutting out a stretch of one edge, two edges, and j edges over 2^-j.
const ONE_EDGE: f64 = 0.25;
const TWO_EDGES: f64 = 0.5;
/// Vertices of the longest stretch.
const LONGEST: usize = 8;
/// Probability of putting in as many vertices as were cut out, one more or one fewer, and j
/// more or fewer over 2^-j.
const SAME: f64 = 0.5;
const NEXT: f64 = 0.15;
const FURTHER: f64 = 0.2;
/// Weight of a stretch that no joint of the same length could close.
const HARDLY: f64 = 0.1;

/// A stretch of a path: how many vertices are kept before and after it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Cut {
    from_light: usize,
    from_eye: usize,
}

impl Mutator<'_, '_> {
    pub(super) fn bidirectional(&mut self, x: &Path, y: &mut Path, numbers: &mut Numbers) -> Option<f64> {
        let world = self.world;
        let cuts: Vec<(Cut, f64)> = self.cuts(x).collect();
        let cut = cuts[numbers.choose(cuts.iter().map(|(_, weight)| *weight))?].0;
        let removed = x.count() - cut.from_light - cut.from_eye;
        let inserted = numbers.choose((0..=LONGEST).map(|inserted| inserting(removed, inserted)))?;
        let from_light = numbers.index(inserted + 1);
        y.copy_nodes(x);
        self.draft.keep(x, cut.from_light, cut.from_eye);
        let (s, t) = (cut.from_light + from_light, cut.from_eye + inserted - from_light);
        // A path needs both its ends.
        if inserted == 0 && (s == 0 || t == 0) {
            return None;
        }
        let lengths = (Until::Vertices(s), Until::Vertices(t));
        world.complete(&mut self.draft, lengths, &y.wavelengths, numbers)?;
        self.draft.finish(y);
        if !y.judge(world) {
            return None;
        }
        Some(y.ln_target - x.ln_target + self.ln_transition(y, x, cut) - self.ln_transition(x, y, cut))
    }

    /// Logarithm of the density of coming from one path to another by a stretch that both have
    /// in common but for its inside.
    fn ln_transition(&self, from: &Path, to: &Path, cut: Cut) -> f64 {
        let (mut total, mut this) = (0.0, 0.0);
        for (other, weight) in self.cuts(from) {
            total += weight;
            if other == cut {
                this = weight;
            }
        }
        let removed = from.count() - cut.from_light - cut.from_eye;
        let inserted = to.count() - cut.from_light - cut.from_eye;
        let end = to.count() - cut.from_eye;
        // Any of its splits may have made the stretch.
        let splits = (cut.from_light..=end).map(|s| to.ln_between(cut.from_light, end, s));
        (this / total).ln()
            + (probability_of(removed, inserted) / (inserted + 1) as f64).ln()
            + ln_sum(splits)
    }

    /// The stretches of a path that may be cut out, and the weight of each.
    fn cuts<'p>(&self, path: &'p Path) -> impl Iterator<Item = (Cut, f64)> + use<'p> {
        let count = path.count();
        // The point of a pinhole is the only one.
        let least_from_eye = usize::from(!self.world.eye.has_aperture());
        let most_from_eye = move |from_light: usize| count - from_light;
        (0..=count)
            .flat_map(move |from_light| {
                let most = most_from_eye(from_light);
                let least = most.saturating_sub(LONGEST).max(least_from_eye);
                (least..=most).map(move |from_eye| Cut { from_light, from_eye })
            })
            .map(move |cut| (cut, weight(path, cut)))
            .filter(|(_, weight)| *weight > 0.0)
    }
}

/// Weight with which so many vertices replace so many others.
fn inserting(removed: usize, inserted: usize) -> f64 {
    match removed.abs_diff(inserted) {
        // Nothing in the place of nothing is no change.
        0 if removed == 0 => 0.0,
        0 => SAME,
        1 => NEXT,
        more => FURTHER * 0.5_f64.powi(more as i32),
    }
}

/// Probability with which so many vertices replace so many others.
fn probability_of(removed: usize, inserted: usize) -> f64 {
    let all: f64 = (0..=LONGEST).map(|other| inserting(removed, other)).sum();
    if inserted > LONGEST { 0.0 } else { inserting(removed, inserted) / all }
}

/// Weight of a stretch: by its length, and by how many of the joints that could close it are
/// possible at all, which is what acceptance is to be expected of it.
fn weight(path: &Path, cut: Cut) -> f64 {
    let count = path.count();
    let ends_at = count - cut.from_eye;
    // Something is kept, something cut, and walks go on from the ends.
    let kept = cut.from_light + cut.from_eye;
    let goes_on = |index: usize| index == 0 || index + 1 == count || !path.is_delta(index);
    if kept == 0 || kept > count || cut.from_light >= count || cut.from_eye >= count {
        return 0.0;
    }
    if cut.from_light > 0 && !goes_on(cut.from_light - 1) || cut.from_eye > 0 && !goes_on(ends_at) {
        return 0.0;
    }
    let removed = ends_at - cut.from_light;
    let by_length = match removed {
        0 => ONE_EDGE,
        1 => TWO_EDGES,
        more => 0.5_f64.powi(more as i32 + 1),
    };
    let joints = (cut.from_light..=ends_at).filter(|s| path.joins(*s)).count();
    by_length * (HARDLY + joints as f64 / (removed + 1) as f64)
}
