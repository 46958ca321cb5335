//! Light selection that knows the lit point: a binary tree over the lights.
//!
//! Every node knows a box around its lights, a cone of their normals and the sum of their
//! intensities. From these follows what the lights can give a point at most, up to the box's
//! own extent, and a walk from the root chooses at each node in that proportion (Conty
//! Estevez and Kulla 2018, "Importance Sampling of Many Lights with Adaptive Tree Splitting",
//! with one light drawn and no splitting). Only the position of the point counts, not its
//! normal: surfaces may transmit, and the same probability must follow from a position alone.

use super::cluster::Cluster;
use super::split::{Member, split};
use glam::{DVec3, Vec3, Vec3A};

/// A binary tree over the lights of a scene.
#[derive(Clone, Debug)]
pub(super) struct Hierarchy {
    /// The root, then pairs of siblings.
    nodes: Vec<Node>,
    /// For each light the turns from the root to its leaf, the first in the lowest bit; set
    /// where the turn is to the second of a pair.
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
    /// Two nodes, by the index of the first.
    Pair(u32),
    /// A light, by its index.
    Light(u32),
}

/// Depth from which sets are halved whatever they hold: a trail has 64 turns, and 2^32 lights
/// are told apart by halving 32 times.
const HALVING_DEPTH: u32 = 32;
/// Largest number below one.
const BELOW_ONE: f64 = 1.0 - f64::EPSILON / 2.0;

impl Hierarchy {
    /// A tree over lights given by their indices, all below `count`; `None` for no lights.
    pub fn new(mut members: Vec<Member>, count: usize) -> Option<Self> {
        let all = members.iter().map(|(_, cluster)| *cluster).reduce(|a, b| a.union(&b))?;
        let mut nodes = Vec::with_capacity(2 * members.len());
        nodes.push(Node::new(&all));
        let mut tree = Self { nodes, trails: vec![0; count] };
        tree.grow(0, &mut members, 0, 0);
        Some(tree)
    }

    /// Puts lights below the node at an index.
    fn grow(&mut self, node: usize, members: &mut [Member], depth: u32, trail: u64) {
        if let [(light, _)] = members {
            self.nodes[node].below = Below::Light(*light);
            self.trails[*light as usize] = trail;
            return;
        }
        let size = if depth < HALVING_DEPTH { split(members) } else { members.len() / 2 };
        let (left, right) = members.split_at_mut(size);
        let first = self.nodes.len();
        self.nodes[node].below = Below::Pair(first as u32);
        for half in [&*left, &*right] {
            let (one, others) = half.split_first().expect("neither half is empty");
            let whole = others.iter().fold(one.1, |whole, (_, cluster)| whole.union(cluster));
            self.nodes.push(Node::new(&whole));
        }
        self.grow(first, left, depth + 1, trail);
        self.grow(first + 1, right, depth + 1, trail | 1 << depth);
    }

    /// Picks a light for a position by a number in [0, 1); with it the probability of that
    /// choice.
    #[inline]
    pub fn choose(&self, from: Vec3A, mut u: f64) -> (u32, f64) {
        self.descend(from, |share| {
            let goes_right = u >= share;
            u = if goes_right { (u - share) / (1.0 - share) } else { u / share };
            u = u.min(BELOW_ONE);
            goes_right
        })
    }

    /// Probability that `choose` picks a light for a position, by the very same arithmetic.
    #[inline]
    pub fn probability(&self, from: Vec3A, light: u32) -> f64 {
        let mut trail = self.trails[light as usize];
        let (_, probability) = self.descend(from, |_| {
            let goes_right = trail & 1 == 1;
            trail >>= 1;
            goes_right
        });
        probability
    }

    /// Walks from the root to a light, turning as told when asked with the share of the first
    /// of a pair; the light, and the product of the shares along the way.
    #[inline]
    fn descend(&self, from: Vec3A, mut goes_right: impl FnMut(f64) -> bool) -> (u32, f64) {
        let from = from.as_dvec3();
        let (mut node, mut probability) = (&self.nodes[0], 1.0);
        loop {
            let first = match node.below {
                Below::Light(light) => return (light, probability),
                Below::Pair(first) => first as usize,
            };
            let (left, right) = (&self.nodes[first], &self.nodes[first + 1]);
            let share = share_of_left(left, right, from);
            if goes_right(share) {
                (node, probability) = (right, probability * (1.0 - share));
            } else {
                (node, probability) = (left, probability * share);
            }
        }
    }
}

/// Probability of the first of two siblings.
#[inline]
fn share_of_left(left: &Node, right: &Node, from: DVec3) -> f64 {
    let ((left_gives, left_square), (right_gives, right_square)) = (left.towards(from), right.towards(from));
    // Over a common denominator: at a point light itself the squared distance is zero.
    let (a, b) = (left_gives * right_square, right_gives * left_square);
    if a + b > 0.0 { a / (a + b) } else { left.intensity / (left.intensity + right.intensity) }
}

impl Node {
    fn new(cluster: &Cluster) -> Self {
        let (sin, cos) = cluster.normals.half_angle.sin_cos();
        Self {
            center: cluster.bounds.center().into(),
            radius: cluster.bounds.radius(),
            axis: cluster.normals.axis.as_vec3(),
            cos: cos as f32,
            sin: sin as f32,
            both_ways: cluster.normals.both_ways,
            intensity: cluster.intensity.max(f64::MIN_POSITIVE),
            below: Below::Light(u32::MAX),
        }
    }

    /// The largest intensity towards a position, and the squared distance to divide it by:
    /// that of the centre, but none within the ball around the box.
    #[inline]
    fn towards(&self, from: DVec3) -> (f64, f64) {
        let span = from - self.center.as_dvec3();
        let (square, radius2) = (span.length_squared(), f64::from(self.radius).powi(2));
        if square <= radius2 {
            return (self.intensity, radius2);
        }
        // A cone of all directions has this cosine.
        if self.cos == -1.0 {
            return (self.intensity, square);
        }
        (self.intensity * self.cosine(span, square.sqrt()), square)
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
