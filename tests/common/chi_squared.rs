//! Samples fall as densely as the pdf says.
//!
//! Bins are the leaves of a kd-tree over a pilot run, so they are fine where the lobes are;
//! expected counts come from adaptive quadrature of the pdf, started from cells halved until
//! they hold a handful of pilot samples each. Draws of nothing are a bin of their own, so that the
//! integral of the pdf is tested along with its shape.

use etalon::material::{Bsdf, Quantity};
use glam::Vec3A;

use super::hemisphere::{Random, SQUARE_SOLID_ANGLE, from_square, gauss, to_square};

const PILOT: usize = 8_192;
/// Draws that are judged.
pub const SAMPLES: usize = 200_000;
/// Depth of the kd-tree at which its nodes are bins: 2^6 in each hemisphere.
const BIN_DEPTH: usize = 6;
/// Most pilot samples in a cell that quadrature starts from.
const CELL_POINTS: usize = 2;
/// Longer cells than this are halved on.
const MOST_ELONGATED: f64 = 4.0;
/// Halvings of a bin at most, enough for lobes of a thousandth of a degree.
const CELL_DEPTH: usize = 60;
/// Bins expected to hold fewer samples are pooled.
const POOLED_BELOW: f64 = 20.0;

#[derive(Clone, Copy)]
struct Cell {
    low: [f64; 2],
    high: [f64; 2],
}

impl Cell {
    const WHOLE: Self = Self { low: [0.0; 2], high: [1.0; 2] };

    fn split(self, axis: usize, at: f64) -> [Self; 2] {
        let (mut left, mut right) = (self, self);
        left.high[axis] = at;
        right.low[axis] = at;
        [left, right]
    }

    fn quarters(self) -> [Self; 4] {
        let middle = |axis: usize| 0.5 * (self.low[axis] + self.high[axis]);
        let [left, right] = self.split(0, middle(0));
        let ([a, b], [c, d]) = (left.split(1, middle(1)), right.split(1, middle(1)));
        [a, b, c, d]
    }

    fn area(self) -> f64 {
        (self.high[0] - self.low[0]) * (self.high[1] - self.low[1])
    }
}

/// A node of the tree: two children, or a bin with the cells of its quadrature.
enum Node {
    Fork { axis: usize, at: f64, children: Box<[Node; 2]> },
    Bin { cells: Vec<Cell>, count: usize },
}

impl Node {
    fn build(cell: Cell, points: &mut [[f64; 2]], depth: usize) -> Self {
        if depth == BIN_DEPTH {
            let mut cells = vec![];
            divide(cell, points, depth, &mut cells);
            return Self::Bin { cells, count: 0 };
        }
        let (axis, at, [left, right], middle) = halve(cell, points);
        let (below, above) = points.split_at_mut(middle);
        let children = Box::new([Self::build(left, below, depth + 1), Self::build(right, above, depth + 1)]);
        Self::Fork { axis, at, children }
    }

    fn count(&mut self, p: [f64; 2]) {
        match self {
            Self::Bin { count, .. } => *count += 1,
            Self::Fork { axis, at, children } => {
                children[usize::from(p[*axis] >= *at)].count(p);
            }
        }
    }

    fn bins<'a>(&'a self, all: &mut Vec<(&'a [Cell], usize)>) {
        match self {
            Self::Bin { cells, count } => all.push((cells, *count)),
            Self::Fork { children, .. } => children.iter().for_each(|child| child.bins(all)),
        }
    }
}

/// Splits at the median; in the middle where there are no points to speak of.
fn halve(cell: Cell, points: &mut [[f64; 2]]) -> (usize, f64, [Cell; 2], usize) {
    let axis = widest(cell, points);
    points.sort_by(|a, b| a[axis].total_cmp(&b[axis]));
    let centre = 0.5 * (cell.low[axis] + cell.high[axis]);
    let at = if points.len() < 4 { centre } else { points[points.len() / 2][axis] };
    let at = if at > cell.low[axis] && at < cell.high[axis] { at } else { centre };
    let middle = points.partition_point(|p| p[axis] < at);
    (axis, at, cell.split(axis, at), middle)
}

/// The axis along which the points spread most, or the cell where there are too few.
fn widest(cell: Cell, points: &[[f64; 2]]) -> usize {
    let spread = |axis: usize| {
        if points.len() < 4 {
            return cell.high[axis] - cell.low[axis];
        }
        let along = points.iter().map(|p| p[axis]);
        along.clone().fold(0.0, f64::max) - along.fold(1.0, f64::min)
    };
    usize::from(spread(1) > spread(0))
}

fn divide(cell: Cell, points: &mut [[f64; 2]], depth: usize, cells: &mut Vec<Cell>) {
    let side = |axis: usize| cell.high[axis] - cell.low[axis];
    let axis = usize::from(side(1) > side(0));
    let sliver = side(axis) > MOST_ELONGATED * side(1 - axis);
    let few = points.len() <= CELL_POINTS && (!sliver || points.is_empty());
    if few || depth == CELL_DEPTH {
        // Quartered to begin with: a peak in a corner can hide from a single cell.
        return cells.extend(cell.quarters());
    }
    let at = 0.5 * (cell.low[axis] + cell.high[axis]);
    points.sort_by(|a, b| a[axis].total_cmp(&b[axis]));
    let (below, above) = points.split_at_mut(points.partition_point(|p| p[axis] < at));
    let [left, right] = cell.split(axis, at);
    divide(left, below, depth + 1, cells);
    divide(right, above, depth + 1, cells);
}

/// Gauss's rule on a cell, refined until halving it both ways changes little.
fn integrate(cell: Cell, rule: &[(f64, f64)], depth: usize, f: &dyn Fn([f64; 2]) -> f64) -> f64 {
    let once = |cell: Cell| {
        let at = |axis: usize, t: f64| cell.low[axis] + (cell.high[axis] - cell.low[axis]) * t;
        let sum: f64 = rule
            .iter()
            .flat_map(|&(s, v)| rule.iter().map(move |&(t, w)| (s, t, v * w)))
            .map(|(s, t, w)| w * f([at(0, s), at(1, t)]))
            .sum();
        sum * cell.area()
    };
    let quarters = cell.quarters();
    let (coarse, fine) = (once(cell), quarters.map(once).iter().sum::<f64>());
    // Small against the standard deviation of a bin (3e-4) shared by its dozens of cells.
    let tolerance = 3e-6;
    if (coarse - fine).abs() < tolerance || depth == 0 {
        return fine;
    }
    quarters.iter().map(|&quarter| integrate(quarter, rule, depth - 1, f)).sum()
}

/// ln of the gamma function at a positive multiple of one half.
fn ln_gamma_of_half(twice: usize) -> f64 {
    let start = if twice.is_multiple_of(2) { 0.0 } else { 0.5 * std::f64::consts::PI.ln() };
    (0..)
        .map(|i| 2 - twice % 2 + 2 * i)
        .take_while(|&k| k < twice)
        .fold(start, |sum, k| sum + (k as f64 / 2.0).ln())
}

/// Probability that chi-squared exceeds `x`: the upper incomplete gamma function, by its
/// series or by its continued fraction (Numerical Recipes, 6.2).
pub fn tail_probability(x: f64, degrees: usize) -> f64 {
    let (a, x) = (degrees as f64 / 2.0, x / 2.0);
    let front = (a * x.ln() - x - ln_gamma_of_half(degrees)).exp();
    if x < a + 1.0 {
        let (mut term, mut sum) = (1.0 / a, 1.0 / a);
        for n in 1..10_000 {
            term *= x / (a + f64::from(n));
            sum += term;
        }
        return 1.0 - front * sum;
    }
    let mut b = x + 1.0 - a;
    let (mut c, mut d) = (1e300, 1.0 / b);
    let mut h = d;
    for i in 1..10_000 {
        let an = -f64::from(i) * (f64::from(i) - a);
        b += 2.0;
        d = 1.0 / (an * d + b);
        c = b + an / c;
        h *= c * d;
    }
    front * h
}

/// Chi-squared and its degrees of freedom, small bins pooled.
fn chi_squared(bins: &[(f64, f64)]) -> (f64, usize) {
    let mut pool = (0.0, 0.0);
    let mut terms = vec![];
    for &(expected, observed) in bins {
        if expected < POOLED_BELOW {
            pool = (pool.0 + expected, pool.1 + observed);
        } else {
            terms.push((expected, observed));
        }
    }
    // A pool that quadrature cannot tell from nothing is tested only for being hit.
    if pool.0 > 1.0 || pool.1 > 20.0 {
        terms.push((pool.0.max(1e-3), pool.1));
    }
    let sum = terms.iter().map(|(e, o)| (o - e) * (o - e) / e).sum();
    (sum, terms.len().saturating_sub(1).max(1))
}

/// How the draws of one direction fall.
pub struct Verdict {
    /// Probability of a chi-squared as large.
    pub p: f64,
    pub chi_squared: f64,
    pub degrees: usize,
    /// Of the pdf.
    pub integral: f64,
    /// Share of the draws that gave a direction.
    pub drawn: f64,
}

/// Draws from a material as seen from `wo`, and counts.
pub fn examine(bsdf: &Bsdf, wo: Vec3A, seed: u64) -> Verdict {
    let mut random = Random(seed);
    let mut draw = || {
        let (u_lobe, u) = (random.uniform(), random.pair());
        bsdf.sample(wo, u_lobe, u, Quantity::Radiance).map(|s| to_square(s.wi))
    };
    let mut pilot = [vec![], vec![]];
    for (below, p) in (0..PILOT).filter_map(|_| draw()) {
        pilot[below].push(p);
    }
    let mut trees = pilot.map(|mut points| Node::build(Cell::WHOLE, &mut points, 0));
    let mut failed = 0;
    for _ in 0..SAMPLES {
        match draw() {
            Some((below, p)) => trees[below].count(p),
            None => failed += 1,
        }
    }
    let rule = gauss(3);
    let mut bins = vec![];
    let mut integral = 0.0;
    for (below, tree) in trees.iter().enumerate() {
        let pdf = |p: [f64; 2]| {
            let density = bsdf.pdf(wo, from_square(below, p), Quantity::Radiance).hero();
            f64::from(density) * SQUARE_SOLID_ANGLE
        };
        let mut leaves = vec![];
        tree.bins(&mut leaves);
        for (cells, count) in leaves {
            let mass: f64 = cells.iter().map(|&cell| integrate(cell, &rule, 5, &pdf)).sum();
            integral += mass;
            bins.push((mass * SAMPLES as f64, count as f64));
        }
    }
    bins.push(((1.0 - integral).max(0.0) * SAMPLES as f64, f64::from(failed)));
    let (chi_squared, degrees) = chi_squared(&bins);
    let p = tail_probability(chi_squared, degrees);
    let drawn = 1.0 - f64::from(failed) / SAMPLES as f64;
    Verdict { p, chi_squared, degrees, integral, drawn }
}
