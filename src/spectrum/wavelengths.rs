//! Which wavelengths a path carries, and how they are drawn.
//!
//! All lanes of a path are drawn together: one uniform number, rotated by equal steps, goes
//! through one inverse distribution (hero wavelength sampling: Wilkie et al. 2014), so the
//! lanes are stratified and each has the marginal density of a wavelength drawn alone.
//!
//! The distribution is a mixture: a density over the 1 nm grid for the continuum, and a
//! probability for each spectral line, which has a wavelength and no width. A lane sits on a
//! line or in the continuum and stands for that part of the light alone; the sum over both is
//! what the lane estimates.

use super::lanes::{LANES, Spectrum};

/// First wavelength that transport considers, nm: where the CIE observer's table begins.
pub const FIRST_NM: f64 = 360.0;
/// Last wavelength that transport considers, nm.
pub const LAST_NM: f64 = 830.0;
/// Points of the 1 nm grid.
pub const GRID_POINTS: usize = 471;

/// The wavelengths of the 1 nm grid.
pub fn grid_nm() -> impl ExactSizeIterator<Item = f64> + Clone {
    (0..GRID_POINTS).map(|i| FIRST_NM + i as f64)
}

/// The grid cell that a wavelength from 360 to 830 nm lies in, and where in it, 0 to 1.
pub(super) fn place_on_grid(nm: f64) -> (usize, f64) {
    let cell = ((nm - FIRST_NM).max(0.0) as usize).min(GRID_POINTS - 2);
    (cell, nm - FIRST_NM - cell as f64)
}

/// Value at a wavelength from 360 to 830 nm of a curve known at the grid points; linear
/// between.
pub fn between_grid_points(values: &[f64], nm: f64) -> f64 {
    let (cell, fraction) = place_on_grid(nm);
    values[cell] + (values[cell + 1] - values[cell]) * fraction
}

/// Marks a lane in the continuum.
const CONTINUUM: u32 = u32::MAX;

/// The wavelengths that one path carries.
#[derive(Clone, Copy, Debug)]
pub struct Wavelengths {
    /// Wavelength of each lane in nm.
    pub nm: Spectrum,
    /// How each lane's wavelength was drawn: density per nm in the continuum, probability on
    /// a line.
    pub density: Spectrum,
    /// Grid cell of each lane: its wavelength lies between this grid point and the next.
    pub(super) cell: [u16; LANES],
    /// Position within the cell, 0 to 1.
    pub(super) fraction: Spectrum,
    /// The line of each lane, or [`CONTINUUM`].
    line: [u32; LANES],
}

impl Wavelengths {
    /// The line that a lane sits on, by its place in the scene's list; `None` in the
    /// continuum.
    #[inline]
    pub fn line(&self, lane: usize) -> Option<u32> {
        (self.line[lane] != CONTINUUM).then_some(self.line[lane])
    }

    /// Whether any lane sits on a line.
    #[inline]
    pub fn meet_lines(&self) -> bool {
        self.line != [CONTINUUM; LANES]
    }
}

/// A distribution over wavelength: a density that is constant within each cell of the 1 nm
/// grid, and a probability for each line.
#[derive(Clone, Debug)]
pub struct WavelengthSampler {
    /// In order of wavelength; nothing in it has probability zero.
    pieces: Vec<Piece>,
    /// The same for drawing, with one more behind the last that no number reaches.
    stretches: Vec<Stretch>,
    /// For each of [`GUIDES`] equal parts of [0, 1) the piece that its first number falls in: from
    /// there the piece of any number is a few steps away, and no search over all is needed.
    guides: Box<[u16; GUIDES]>,
}

/// Bits of the numbers that wavelengths are drawn by: those of the sampler's.
const NUMBER_BITS: u32 = 24;
/// Bits of the number of guides: parts of [0, 1) are told by a shift, and most hold the end of no
/// piece, or of one.
const GUIDE_BITS: u32 = 11;
/// Parts of [0, 1) with a guide.
const GUIDES: usize = 1 << GUIDE_BITS;

/// The numbers, in units of 2^-24, that draw from one piece.
#[derive(Clone, Copy, Debug)]
struct Stretch {
    /// The first of them.
    first: u32,
    /// Place within the cell that the first draws, 0 to 1, and how much farther each further one
    /// is; zero for a line.
    fraction: f32,
    step: f32,
    /// Wavelength in nm that the first draws.
    nm: f32,
    density: f32,
    cell: u16,
    line: u32,
}

impl Stretch {
    fn of(piece: &Piece) -> Self {
        let numbers = f64::from(1 << NUMBER_BITS);
        let first = (piece.start * numbers).ceil();
        let density = piece.probability as f32;
        match piece.source {
            Source::Cell(cell) => {
                let fraction = (first / numbers - piece.start) / piece.probability;
                Self {
                    first: first as u32,
                    fraction: fraction as f32,
                    step: (1.0 / (numbers * piece.probability)) as f32,
                    nm: (FIRST_NM + cell as f64 + fraction) as f32,
                    density,
                    cell: cell as u16,
                    line: CONTINUUM,
                }
            }
            Source::Line(line, nm) => {
                let (cell, fraction) = place_on_grid(nm);
                let (first, fraction, nm) = (first as u32, fraction as f32, nm as f32);
                Self { first, fraction, step: 0.0, nm, density, cell: cell as u16, line }
            }
        }
    }

    /// Behind the last.
    const fn end() -> Self {
        let first = u32::MAX;
        Self { first, fraction: 0.0, step: 0.0, nm: 0.0, density: 0.0, cell: 0, line: CONTINUUM }
    }
}

/// A part of the distribution.
#[derive(Clone, Copy, Debug)]
struct Piece {
    source: Source,
    /// Sum of the probabilities before it.
    start: f64,
    probability: f64,
}

/// What a lane stands for.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Source {
    /// The continuum in a cell of the grid, which is 1 nm wide.
    Cell(usize),
    /// The line of an index at a wavelength in nm.
    Line(u32, f64),
}

impl Source {
    /// What orders the pieces: a line stands before the cell that it lies in.
    fn place(&self) -> (usize, bool, f64) {
        match *self {
            Self::Cell(cell) => (cell, true, 0.0),
            Self::Line(_, nm) => (place_on_grid(nm).0, false, nm),
        }
    }
}

impl WavelengthSampler {
    /// Share of the probability that is spread evenly over all cells and lines of the support.
    const EVEN_SHARE: f64 = 0.02;

    /// A sampler whose density follows `weight_at_grid_points` (any scale, not negative).
    ///
    /// Wherever the weight is positive at either end of a cell, the density is positive over
    /// the whole cell; `None` if all weights are zero.
    pub fn proportional_to(weight_at_grid_points: &[f64]) -> Option<Self> {
        Self::mixture(weight_at_grid_points, &[])
    }

    /// A sampler for a continuum, whose weight per nm is given at the grid points, and lines,
    /// each given by wavelength in nm (360 to 830) and weight.
    ///
    /// Whatever has a positive weight is drawn with a positive probability; `None` if all
    /// weights are zero.
    pub fn mixture(weight_at_grid_points: &[f64], lines: &[(f64, f64)]) -> Option<Self> {
        let cells = weight_at_grid_points.windows(2).map(|w| 0.5 * (w[0] + w[1]));
        let cells = cells.enumerate().map(|(cell, weight)| (Source::Cell(cell), weight));
        let lines = (0..).zip(lines).map(|(index, (nm, weight))| (Source::Line(index, *nm), *weight));
        let mut weights: Vec<(Source, f64)> = cells.chain(lines).filter(|(_, w)| *w > 0.0).collect();
        weights.sort_by(|(a, _), (b, _)| a.place().partial_cmp(&b.place()).expect("wavelengths are finite"));
        let total: f64 = weights.iter().map(|(_, weight)| weight).sum();
        if total <= 0.0 || !total.is_finite() {
            return None;
        }
        let support = weights.len() as f64;
        let mut start = 0.0;
        let piece = |(source, weight): (Source, f64)| {
            let probability = (1.0 - Self::EVEN_SHARE) * weight / total + Self::EVEN_SHARE / support;
            let piece = Piece { source, start, probability };
            start += probability;
            piece
        };
        let pieces: Vec<Piece> = weights.into_iter().map(piece).collect();
        let end = std::iter::once(Stretch::end());
        let stretches: Vec<Stretch> = pieces.iter().map(Stretch::of).chain(end).collect();
        let piece_of = |u: u32| stretches.partition_point(|stretch| stretch.first <= u) - 1;
        let guide = |part: usize| piece_of((part as u32) << (NUMBER_BITS - GUIDE_BITS)) as u16;
        let guides = Box::new(std::array::from_fn(guide));
        Some(Self { pieces, stretches, guides })
    }

    /// The same density everywhere.
    pub fn even() -> Self {
        Self::proportional_to(&[1.0; GRID_POINTS]).expect("the weights are positive")
    }

    /// Density of the continuum at a wavelength, per nm; zero outside the grid.
    pub fn pdf_per_nm(&self, nm: f64) -> f64 {
        let cell = (nm - FIRST_NM).floor();
        if cell < 0.0 { 0.0 } else { self.probability_of(|source| *source == Source::Cell(cell as usize)) }
    }

    /// Probability of the line of an index; zero for one that is never drawn.
    pub fn line_probability(&self, index: u32) -> f64 {
        self.probability_of(|source| matches!(source, Source::Line(line, _) if *line == index))
    }

    fn probability_of(&self, is_meant: impl Fn(&Source) -> bool) -> f64 {
        self.pieces.iter().find(|piece| is_meant(&piece.source)).map_or(0.0, |piece| piece.probability)
    }

    /// The lanes of a path from one uniform number in [0, 1).
    pub fn sample(&self, u: f32) -> Wavelengths {
        let mut drawn = Wavelengths {
            nm: Spectrum::ZERO,
            density: Spectrum::ZERO,
            cell: [0; LANES],
            fraction: Spectrum::ZERO,
            line: [CONTINUUM; LANES],
        };
        const NUMBERS: u32 = 1 << NUMBER_BITS;
        let hero = (u * NUMBERS as f32) as u32;
        let (mut further, mut step) = (Spectrum::ZERO, Spectrum::ZERO);
        for lane in 0..LANES {
            let number = hero.wrapping_add(lane as u32 * (NUMBERS / LANES as u32)) % NUMBERS;
            let stretch = self.stretch(number);
            further[lane] = (number - stretch.first) as f32;
            step[lane] = stretch.step;
            drawn.fraction[lane] = stretch.fraction;
            drawn.nm[lane] = stretch.nm;
            drawn.density[lane] = stretch.density;
            drawn.cell[lane] = stretch.cell;
            drawn.line[lane] = stretch.line;
        }
        drawn.nm += further * step;
        drawn.fraction = (drawn.fraction + further * step).map(|fraction| fraction.min(1.0));
        drawn
    }

    /// The stretch that a number below 2^24 falls in.
    #[inline]
    fn stretch(&self, number: u32) -> &Stretch {
        let mut place = usize::from(self.guides[(number >> (NUMBER_BITS - GUIDE_BITS)) as usize]);
        while self.stretches[place + 1].first <= number {
            place += 1;
        }
        &self.stretches[place]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_lane_integrates_what_the_grid_integrates() {
        // Weight and integrand differ, and the weight vanishes below 400 nm with the integrand.
        let weights: Vec<f64> = grid_nm().map(|nm| (nm - 400.0).clamp(0.0, 120.0)).collect();
        let sampler = WavelengthSampler::proportional_to(&weights).expect("positive weights");
        let integrand = |nm: f64| if nm < 400.0 { 0.0 } else { 1.0 + (nm * 0.02).sin() };
        let truth: f64 = (0..430_000).map(|i| integrand(400.0 + (f64::from(i) + 0.5) * 1e-3) * 1e-3).sum();
        const SAMPLES: u32 = 200_000;
        let mut sums = [0.0; LANES];
        for i in 0..SAMPLES {
            let drawn = sampler.sample((i as f32 + 0.5) / SAMPLES as f32);
            for (lane, sum) in sums.iter_mut().enumerate() {
                *sum += integrand(f64::from(drawn.nm[lane])) / f64::from(drawn.density[lane]);
            }
        }
        for sum in sums {
            let value = sum / f64::from(SAMPLES);
            // An equidistant rule in u: the error is of the order of one cell's share.
            assert!((value / truth - 1.0).abs() < 1e-3, "{value} against {truth}");
        }
    }

    /// Continuum and lines together, with weights unlike the integrand: no lane counts a line
    /// twice, misses it, or takes its probability for a density.
    #[test]
    fn every_lane_sums_continuum_and_lines() {
        let weights: Vec<f64> = grid_nm().map(|nm| (nm - 500.0).clamp(0.0, 10.0)).collect();
        let lines = [(589.592_4, 700.0), (404.656_5, 30.0), (830.0, 1e-9), (450.0, 0.0), (360.0, 90.0)];
        let sampler = WavelengthSampler::mixture(&weights, &lines).expect("positive weights");
        let powers = [20.0, 35.0, 7.0, 0.0, 11.0];
        let truth = 330.0 + powers.iter().sum::<f64>();
        const SAMPLES: u32 = 200_000;
        let mut sums = [0.0; LANES];
        for i in 0..SAMPLES {
            let drawn = sampler.sample((i as f32 + 0.5) / SAMPLES as f32);
            for (lane, sum) in sums.iter_mut().enumerate() {
                let value = match drawn.line(lane) {
                    None => f64::from(drawn.nm[lane] >= 500.0),
                    Some(line) => {
                        assert_eq!(drawn.nm[lane], lines[line as usize].0 as f32);
                        powers[line as usize]
                    }
                };
                *sum += value / f64::from(drawn.density[lane]);
            }
        }
        for sum in sums {
            let value = sum / f64::from(SAMPLES);
            assert!((value / truth - 1.0).abs() < 2e-3, "{value} against {truth}");
        }
    }

    #[test]
    fn lines_alone_need_no_continuum() {
        let sampler = WavelengthSampler::mixture(&[0.0; GRID_POINTS], &[(589.0, 2.0), (589.6, 1.0)]);
        let sampler = sampler.expect("positive weights");
        let drawn = sampler.sample(0.999_999_9);
        assert!((0..LANES).all(|lane| drawn.line(lane).is_some()));
        assert!((sampler.line_probability(0) + sampler.line_probability(1) - 1.0).abs() < 1e-12);
        assert_eq!((sampler.pdf_per_nm(589.0), sampler.line_probability(2)), (0.0, 0.0));
        assert!(WavelengthSampler::mixture(&[0.0; GRID_POINTS], &[(589.0, 0.0)]).is_none());
    }

    #[test]
    fn density_sums_to_one_and_covers_the_support() {
        let mut weights = vec![0.0; GRID_POINTS];
        weights[100] = 1e-12;
        weights[300] = 1.0;
        let sampler = WavelengthSampler::proportional_to(&weights).expect("positive weights");
        let total: f64 = sampler.pieces.iter().map(|piece| piece.probability).sum();
        assert!((total - 1.0).abs() < 1e-12);
        for nm in [459.5, 460.5, 659.5, 660.5] {
            assert!(sampler.pdf_per_nm(nm) >= WavelengthSampler::EVEN_SHARE / 4.0 * 0.99, "{nm}");
        }
    }
}
