//! Where two subpaths are joined: what that adds to their densities, and the weight of it.

use super::contribution::Subpaths;
use super::eye::Eye;
use super::strategies::Strategies;
use super::weights::{Known, Side};
use crate::measure::AreaPdf;
use crate::spectrum::Spectrum;

/// What a joint adds to the densities that both subpaths keep.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fresh {
    /// Density from the eye of the last vertex from the light.
    pub light_last: AreaPdf,
    /// Density from the eye of the one before it.
    pub light_before: AreaPdf,
    /// Density from the light of the last vertex from the eye.
    pub eye_last: AreaPdf,
    /// Density from the light of the one before it.
    pub eye_before: AreaPdf,
}

impl Default for Fresh {
    fn default() -> Self {
        let none = AreaPdf::ZERO;
        Self { light_last: none, light_before: none, eye_last: none, eye_before: none }
    }
}

/// Where two subpaths are joined.
#[derive(Clone, Copy, Debug)]
pub(super) struct Joint {
    pub s: usize,
    pub t: usize,
    /// Density of the light's vertex where its neighbour asks for it.
    pub asked: f64,
    /// Density of the light's vertex where a subpath starts from it.
    pub started: f64,
    pub fresh: Fresh,
    /// The vertex on the lens that light has met, for t = 0.
    pub lens: Option<Known>,
}

impl Joint {
    /// The weight from the sums that the walks have kept; not a number where those do not
    /// suffice.
    #[inline]
    pub(super) fn quick_weight(&self, paths: &Subpaths, eye: &Eye<'_>, strategies: &Strategies) -> f64 {
        let light = self.light_side(paths, strategies).sum();
        let mut eye = self.eye_side(paths, eye, strategies).sum();
        if self.s == 1 {
            eye *= (self.started / self.asked).powi(2);
        }
        1.0 / (1.0 + light + eye)
    }

    /// Share of a strategy that is listed and joins no delta.
    #[inline]
    fn share(&self, strategies: &Strategies, s: usize, joins: bool) -> f64 {
        if !joins || !strategies.plans(s, self.s + self.t - s) {
            0.0
        } else if s == 1 && self.s != 1 {
            (self.asked / self.started).powi(2)
        } else {
            1.0
        }
    }

    #[inline]
    fn light_side(&self, paths: &Subpaths, strategies: &Strategies) -> Side {
        let Self { s, fresh, .. } = self;
        let mut side = Side::default();
        if *s == 0 {
            return side;
        }
        let walk = &paths.light;
        let drawn = match (&self.lens, s) {
            (Some(lens), _) => lens.light.hero(),
            (None, 1) => self.asked,
            (None, _) => walk[s - 1].forward.hero(),
        };
        side.last_share = self.share(strategies, s - 1, *s == 1 || !walk[s - 2].is_delta);
        if side.last_share == 0.0 && !strategies.joins_both_ways() {
            return side;
        }
        side.last = fresh.light_last.hero() / drawn;
        if *s > 1 && strategies.joins_both_ways() {
            side.before = fresh.light_before.hero() / walk[s - 2].forward.hero();
            let joins = *s == 2 || !walk[s - 2].is_delta && !walk[s - 3].is_delta;
            side.before_share = self.share(strategies, s - 2, joins);
            side.given_away = if *s > 2 { walk[s - 3].given_away } else { 0.0 };
        }
        side
    }

    #[inline]
    fn eye_side(&self, paths: &Subpaths, eye: &Eye<'_>, strategies: &Strategies) -> Side {
        let Self { s, t, fresh, .. } = self;
        let mut side = Side::default();
        if *t == 0 {
            return side;
        }
        let walk = &paths.eye;
        let drawn = if *t == 1 { eye.pdf_area() } else { walk[t - 1].forward.hero() };
        side.last_share = self.share(strategies, s + 1, *t == 1 || !walk[t - 2].is_delta);
        if side.last_share == 0.0 && !strategies.joins_both_ways() {
            return side;
        }
        side.last = fresh.eye_last.hero() / drawn;
        if *t > 1 && strategies.joins_both_ways() {
            side.before = fresh.eye_before.hero() / walk[t - 2].forward.hero();
            let joins = *t == 2 || !walk[t - 2].is_delta && !walk[t - 3].is_delta;
            side.before_share = self.share(strategies, s + 2, joins);
            side.given_away = if *t > 2 { walk[t - 3].given_away } else { 0.0 };
        }
        side
    }
}

impl Subpaths {
    /// A joint of a subpath from a light that was walked.
    pub(super) fn joint(&self, s: usize, t: usize, fresh: Fresh, lens: Option<Known>) -> Joint {
        Joint { s, t, asked: self.asked, started: self.light[0].forward.hero(), fresh, lens }
    }

    /// Collects what weights need of the vertices, numbered from the light; those beyond what
    /// any strategy differs by may be missing.
    pub(super) fn gather(&mut self, joint: &Joint, eye: &Eye<'_>, strategies: &Strategies) {
        let Joint { s, t, fresh, .. } = *joint;
        let open = |density: f64| Known {
            light: AreaPdf::of_all_lanes(density),
            eye: AreaPdf::of_all_lanes(density),
            lanes: Spectrum::ONE,
            is_delta: false,
        };
        self.known.clear();
        if s == 1 {
            self.known.push(open(joint.started));
        }
        let walked = if joint.lens.is_some() { s - 1 } else { s };
        for vertex in self.light.iter().take(if s == 1 { 0 } else { walked }) {
            self.known.push(Known {
                light: vertex.forward,
                eye: vertex.reverse,
                lanes: vertex.lanes,
                is_delta: vertex.is_delta,
            });
        }
        self.known.extend(joint.lens);
        let (_, most) = strategies.span(s + t);
        let wanted = (most + 1).saturating_sub(self.known.len());
        for vertex in self.eye.iter().take(if t == 1 { 0 } else { t }).rev().take(wanted) {
            self.known.push(Known {
                light: vertex.reverse,
                eye: vertex.forward,
                lanes: vertex.lanes,
                is_delta: vertex.is_delta,
            });
        }
        if t == 1 {
            self.known.push(open(eye.pdf_area()));
        }
        if let Some(last) = s.checked_sub(1) {
            self.known[last].eye = fresh.light_last;
            self.known[last].is_delta = false;
        }
        if let Some(before) = s.checked_sub(2) {
            self.known[before].eye = fresh.light_before;
        }
        if let Some(last) = self.known.get_mut(s) {
            last.light = fresh.eye_last;
            last.is_delta = false;
        }
        if let Some(before) = self.known.get_mut(s + 1) {
            before.light = fresh.eye_before;
        }
    }
}
