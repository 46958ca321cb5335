//! Numbers to try, and the two claims about a map and its inverse.

use etalon::sampler::mix;
use glam::DVec3;

/// Half the spacing of `f32` at one: the relative rounding of a number.
pub const ROUNDING: f64 = 1.0 / (1 << 24) as f64;

/// The largest tolerance on a number that still says something.
pub const TELLING: f64 = 0.02;

/// How much further a draw may be off than the neighbouring numbers' draws are apart: at a rim
/// the map is a square root, and stretches the last spacing 2.4 times as much as the one
/// before.
const SPACINGS: f64 = 3.0;

/// Numbers per map.
const COUNT: u64 = 2_000;

/// A number in [0, 1), a multiple of 2^-24, that a name alone decides.
pub fn number(name: u64) -> f32 {
    (mix(name) >> 40) as f32 * ROUNDING as f32
}

/// Two numbers: mostly anywhere, sometimes at an edge of the square.
pub fn pair(seed: u64, index: u64) -> [f32; 2] {
    let name = mix(mix(seed) ^ index);
    let edges = [0.0, ROUNDING as f32, 0.5, 1.0 - 2.0 * ROUNDING as f32, 1.0 - ROUNDING as f32];
    [0, 1].map(|axis| {
        let choice = mix(name ^ (2 + axis)) % 64;
        edges.get(choice as usize).copied().unwrap_or_else(|| number(name ^ axis))
    })
}

/// A point of the unit sphere that a name alone decides.
pub fn direction(name: u64) -> DVec3 {
    let z = 1.0 - 2.0 * f64::from(number(mix(name)));
    let (sin, cos) = (std::f64::consts::TAU * f64::from(number(mix(name) ^ 1))).sin_cos();
    let across = (1.0 - z * z).sqrt();
    DVec3::new(across * cos, across * sin, z)
}

/// What a map draws: which of several pieces, and where.
pub type Drawn = (u32, DVec3);

/// A map from numbers, as its tests see it.
pub struct Map<'a> {
    pub name: String,
    /// What the numbers draw; `None` for nothing.
    pub draw: &'a dyn Fn([f32; 2]) -> Option<Drawn>,
    /// Rounding of what is drawn, by its place.
    pub rounding: &'a dyn Fn(DVec3) -> f64,
    /// Numbers this far apart draw what is clearly different, and mostly of one piece.
    pub step: f32,
}

/// How well a map could be judged.
#[derive(Default)]
pub struct Tally {
    pub tried: u32,
    /// Neighbouring numbers draw what is far apart.
    pub coarse: u32,
    /// Not drawn again, at an edge of the map.
    pub lost: u32,
    /// The numbers could be told.
    pub told: u32,
}

impl Tally {
    /// Fails where the claims were empty too often.
    pub fn assert_telling(&self, name: &str, least_told: f64) {
        let Self { tried, coarse, lost, told } = *self;
        assert!(tried > 100, "{name}: only {tried} draws");
        assert!(f64::from(coarse) <= 0.15 * f64::from(tried), "{name}: {coarse} of {tried} are coarse");
        let least = least_told * f64::from(tried);
        assert!(f64::from(told) >= least, "{name}: {told} of {tried} numbers are told");
        assert!(f64::from(lost) <= 1e-3 * f64::from(tried), "{name}: {lost} of {tried} are lost");
    }

    /// Takes another map's judgements to its own.
    pub fn add(&mut self, other: &Self) {
        self.tried += other.tried;
        self.coarse += other.coarse;
        self.lost += other.lost;
        self.told += other.told;
    }
}

impl Map<'_> {
    /// Draws from many numbers, inverts, and holds the result to both claims.
    pub fn inverts(&self, seed: u64, invert: impl Fn([f32; 2]) -> Option<[f32; 2]>) -> Tally {
        let mut tally = Tally::default();
        for u in (0..COUNT).map(|index| pair(seed, index)) {
            let Some(drawn) = (self.draw)(u) else { continue };
            let name = &self.name;
            let back = invert(u).unwrap_or_else(|| panic!("{name}: {u:?} drew {drawn:?}, which is refused"));
            self.redraws(drawn, back, &mut tally);
            let Some(tolerance) = self.resolution(u, drawn).filter(|t| *t < TELLING) else { continue };
            tally.told += 1;
            for (a, b) in u.into_iter().zip(back) {
                // A turn by nothing and a whole one are the same.
                let apart = (f64::from(a) - f64::from(b)).abs();
                let apart = apart.min(1.0 - apart);
                assert!(apart <= tolerance, "{name}: {u:?} gave {back:?}, tolerance {tolerance:e}");
            }
        }
        tally
    }

    /// The first claim: `back` draws `target` again.
    ///
    /// Not where `back` is at an edge: beyond the last number, 1 - 2^-24, the narrowest lobes
    /// still have tails that no number draws, and between two numbers the map may go over to
    /// another piece, or to nothing. The tally counts where that excuse is needed.
    pub fn redraws(&self, target: Drawn, back: [f32; 2], tally: &mut Tally) {
        let name = &self.name;
        assert!(back.iter().all(|v| (0.0..1.0).contains(v)), "{name}: {back:?} out of [0, 1)");
        let of_piece = |u| (self.draw)(u).filter(|drawn| drawn.0 == target.0);
        let neighbours = around(back, ROUNDING as f32).map(of_piece);
        let at_edge = back.contains(&(1.0 - ROUNDING as f32)) || neighbours.contains(&None);
        tally.tried += 1;
        let rounding = (self.rounding)(target.1);
        let (mut error, mut tolerance) = (f64::INFINITY, rounding);
        if let Some((_, place)) = of_piece(back) {
            let spacing = neighbours.iter().flatten().map(|near| near.1.distance(place)).fold(0.0, f64::max);
            error = place.distance(target.1);
            tolerance += SPACINGS * spacing;
            tally.coarse += u32::from(spacing > 100.0 * rounding);
        }
        tally.lost += u32::from(error > tolerance);
        let kept = error <= tolerance || at_edge;
        assert!(
            kept,
            "{name}: {back:?} draws {:?}, not {target:?}: {error:e}, tolerance {tolerance:e}",
            (self.draw)(back)
        );
    }

    /// Rounding of what is drawn over the least stretch of the map about `u`; `None` where it
    /// breaks off, and near the edges of the square, where the stretch changes within a step.
    fn resolution(&self, u: [f32; 2], drawn: Drawn) -> Option<f64> {
        let inside = 4.0 * self.step..1.0 - 4.0 * self.step;
        if !u.iter().all(|v| inside.contains(v)) {
            return None;
        }
        let [left, right, low, high] = around(u, self.step).map(|near| Some((near, (self.draw)(near)?)));
        let along = |from: Option<([f32; 2], Drawn)>, to: Option<([f32; 2], Drawn)>, axis: usize| {
            let ((from, a), (to, b)) = (from?, to?);
            (a.0 == b.0).then(|| (b.1 - a.1) / f64::from(to[axis] - from[axis]))
        };
        let (x, y) = (along(left, right, 0)?, along(low, high, 1)?);
        // The smaller singular value of the matrix with columns x and y.
        let (trace, area2) = (x.length_squared() + y.length_squared(), x.cross(y).length_squared());
        let larger2 = 0.5 * (trace + (trace * trace - 4.0 * area2).max(0.0).sqrt());
        Some((self.rounding)(drawn.1) / (area2 / larger2).sqrt() + 2.0 * ROUNDING)
    }
}

/// The pairs a step away along either axis, within the square.
fn around([u, v]: [f32; 2], step: f32) -> [[f32; 2]; 4] {
    let inside = |v: f32| v.clamp(0.0, 1.0 - ROUNDING as f32);
    [[inside(u - step), v], [inside(u + step), v], [u, inside(v - step)], [u, inside(v + step)]]
}
