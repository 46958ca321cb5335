//! Light selection that knows the lit point: a tree over the lights.
//!
//! Every node knows a box around its lights, a cone of their normals and the sum of their
//! intensities. From these follows what the lights can give a point at most, up to the box's
//! own extent, and a walk from the root chooses at each node in that proportion (Conty
//! Estevez and Kulla 2018, "Importance Sampling of Many Lights with Adaptive Tree Splitting",
//! with one light drawn and no splitting). Nodes have two children, but those of few lights
//! have them all: asking each costs no more than the turns it saves, and bounds are tightest
//! there. Only the position of the point counts, not its normal: surfaces may transmit, and
//! the same probability must follow from a position alone.

use super::cluster::Cluster;
use super::split::{Member, split};
use glam::{DVec3, Vec3, Vec3A};

/// A tree over the lights of a scene.
#[derive(Clone, Debug)]
pub(super) struct Hierarchy {
    /// The root, then siblings together.
    nodes: Vec<Node>,
    /// For each light the turns from the root to its leaf, the first in the lowest bits: which
    /// sibling, in as many bits as tell them apart.
    trails: Vec<u64>,
}

/// Lights taken together, in as few bytes as choosing needs.
#[derive(Clone, Debug)]
struct Node {
    center: Vec3,
    /// Of the ball around the box.
    radius: f32,
    axis: Vec3,
    /// Of the half angle of the cone of normals.
    cos: f32,
    sin: f32,
    both_ways: bool,
    intensity: f64,
    below: Below,
}

/// What a node holds.
#[derive(Clone, Copy, Debug)]
enum Below {
    /// Siblings, by the index of the first and their number.
    Nodes { first: u32, count: u8 },
    /// A light, by its index.
    Light(u32),
}

/// Largest number of lights below one node without another between.
const SIBLINGS: usize = 8;
/// Depth from which sets are halved whatever they hold: fewer than 2^32 lights are down to
/// [`SIBLINGS`] after 29 more turns, and 29 + 29 + 3 bits fit a trail.
const HALVING_DEPTH: u32 = 29;
/// Largest number below one.
const BELOW_ONE: f64 = 1.0 - f64::EPSILON / 2.0;
/// Cosine of the half angle of a cone of all directions.
const ALL_AROUND: f32 = -1.0;
/// What a light may give at most, as seen at a point light itself: siblings add up to a number.
const MOST: f64 = f64::MAX / SIBLINGS as f64;

impl Hierarchy {
    /// A tree over lights, of indices below `count`; `None` for no lights.
    pub fn new(mut members: Vec<Member>, count: usize) -> Option<Self> {
        let first = members.first()?;
        let mut tree = Self { nodes: Vec::with_capacity(2 * members.len()), trails: vec![0; count] };
        tree.nodes.push(Node::new(&first.cluster, Below::Light(first.light)));
        tree.nodes[0] = tree.grow(&mut members, 0, 0).1;
        Some(tree)
    }

    /// The node of some lights, to which a trail of `depth` bits leads, and what it knows of
    /// them; those below it have their places.
    fn grow(&mut self, members: &mut [Member], depth: u32, trail: u64) -> (Cluster, Node) {
        if let [Member { light, cluster, .. }] = members {
            self.trails[*light as usize] = trail;
            return (*cluster, Node::new(cluster, Below::Light(*light)));
        }
        let parts: Vec<&mut [Member]> = if members.len() <= SIBLINGS {
            members.chunks_mut(1).collect()
        } else {
            let size = if depth < HALVING_DEPTH { split(members) } else { members.len() / 2 };
            <[_; 2]>::from(members.split_at_mut(size)).into()
        };
        let (first, count) = (self.nodes.len(), parts.len());
        self.nodes.resize(first + count, self.nodes[0].clone());
        let mut all: Option<Cluster> = None;
        for (turn, part) in parts.into_iter().enumerate() {
            let bits = turn_bits(count as u8);
            let (cluster, node) = self.grow(part, depth + bits, trail | (turn as u64) << depth);
            self.nodes[first + turn] = node;
            all = Some(all.map_or(cluster, |all| all.union(&cluster)));
        }
        let all = all.expect("there are two parts or more");
        (all, Node::new(&all, Below::Nodes { first: first as u32, count: count as u8 }))
    }

    /// Picks a light for a position by a number in [0, 1); with it the probability of that
    /// choice.
    #[inline]
    pub fn choose(&self, from: Vec3A, mut u: f64) -> (u32, f64) {
        self.descend(from, |shares| {
            for (turn, share) in shares.iter().enumerate() {
                if u < *share {
                    u = (u / share).min(BELOW_ONE);
                    return turn;
                }
                u -= share;
            }
            // Rounding has left a remainder.
            u = BELOW_ONE;
            shares.iter().rposition(|share| *share > 0.0).expect("shares add up to one")
        })
    }

    /// Probability that `choose` picks a light for a position, by the very same arithmetic.
    #[inline]
    pub fn probability(&self, from: Vec3A, light: u32) -> f64 {
        let mut trail = self.trails[light as usize];
        let (_, probability) = self.descend(from, |shares| {
            let bits = turn_bits(shares.len() as u8);
            let turn = trail & ((1 << bits) - 1);
            trail >>= bits;
            turn as usize
        });
        probability
    }

    /// Walks from the root to a light, turning as told when asked with the shares of siblings;
    /// the light, and the product of the shares along the way.
    #[inline]
    fn descend(&self, from: Vec3A, mut turn: impl FnMut(&[f64]) -> usize) -> (u32, f64) {
        let from = from.as_dvec3();
        let (mut node, mut probability) = (&self.nodes[0], 1.0);
        loop {
            let (first, count) = match node.below {
                Below::Light(light) => return (light, probability),
                Below::Nodes { first, count } => (first as usize, count as usize),
            };
            let siblings = &self.nodes[first..first + count];
            let mut shares = [0.0; SIBLINGS];
            share_out(siblings, from, &mut shares[..count]);
            let turn = turn(&shares[..count]);
            node = &siblings[turn];
            probability *= shares[turn];
        }
    }
}

/// Bits that tell this many siblings apart.
#[inline]
const fn turn_bits(count: u8) -> u32 {
    u8::BITS - (count - 1).leading_zeros()
}

/// Probabilities of siblings for a position: by what they give at most; where all are dark, by
/// intensity.
#[inline]
fn share_out(siblings: &[Node], from: DVec3, shares: &mut [f64]) {
    let mut sum = 0.0;
    for (share, node) in shares.iter_mut().zip(siblings) {
        *share = node.gives(from);
        sum += *share;
    }
    if sum == 0.0 {
        shares.iter_mut().zip(siblings).for_each(|(share, node)| *share = node.intensity);
        sum = shares.iter().sum();
    }
    shares.iter_mut().for_each(|share| *share /= sum);
}

impl Node {
    fn new(cluster: &Cluster, below: Below) -> Self {
        let (sin, cos) = cluster.normals.half_angle.sin_cos();
        Self {
            center: cluster.bounds.center().into(),
            radius: cluster.bounds.radius(),
            axis: cluster.normals.axis.as_vec3(),
            cos: cos as f32,
            sin: sin as f32,
            both_ways: cluster.normals.both_ways,
            intensity: cluster.intensity.max(f64::MIN_POSITIVE),
            below,
        }
    }

    /// The largest intensity towards a position over the squared distance of the centre, or
    /// over that of the rim from within the ball around the box.
    #[inline]
    fn gives(&self, from: DVec3) -> f64 {
        let span = from - self.center.as_dvec3();
        let (square, radius2) = (span.length_squared(), f64::from(self.radius).powi(2));
        let cosine =
            if square <= radius2 || self.cos == ALL_AROUND { 1.0 } else { self.cosine(span, square.sqrt()) };
        (self.intensity * cosine / square.max(radius2).max(f64::MIN_POSITIVE)).min(MOST)
    }

    /// Bound on the cosine of emission towards a position outside the ball, given by its span
    /// from the centre: the angle off the axis, less the half angle of the normals, less half
    /// of what the ball subtends.
    #[inline]
    fn cosine(&self, span: DVec3, distance: f64) -> f64 {
        let cos = span.dot(self.axis.as_dvec3()) / distance;
        let cos = if self.both_ways { cos.abs() } else { cos };
        let sin_ball = f64::from(self.radius) / distance;
        let off_axis = (cos, sine(cos));
        let off_cone = less(off_axis, (f64::from(self.cos), f64::from(self.sin)));
        less(off_cone, (sine(sin_ball), sin_ball)).0.max(0.0)
    }
}

/// The sine that goes with a cosine of an angle up to pi, or the other way round up to pi/2.
#[inline]
fn sine(cosine: f64) -> f64 {
    (1.0 - cosine * cosine).max(0.0).sqrt()
}

/// Cosine and sine of one angle less another, zero where that is negative.
#[inline]
fn less((cos, sin): (f64, f64), (other_cos, other_sin): (f64, f64)) -> (f64, f64) {
    if cos >= other_cos {
        return (1.0, 0.0);
    }
    (cos * other_cos + sin * other_sin, sin * other_cos - cos * other_sin)
}
