//! The structure that finds what a ray meets; the only file that names `obvhs`.
//!
//! A compressed eight-wide tree of boxes (Ylitie et al. 2017), built by `obvhs` and walked
//! here: its own box test drops hits nearer than a fixed distance and treats small direction
//! components as larger ones. The test here widens each box by the rounding bound of its own
//! arithmetic, so that no box is missed whose contents are met.

use super::builder::Parts;
use super::{Bounds, Frame, Hit, Meeting, PreciseRay, Primitive, Ray, SurfacePoint, precise::round_up};
use glam::{DVec3, UVec2, Vec3A};
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::node::Bvh2Node;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::cwbvh::bvh2_to_cwbvh::bvh2_to_cwbvh;
use obvhs::cwbvh::node::{CwBvhNode, extract_byte64};
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};
use std::ops::{ControlFlow, Range};

/// All surfaces of a scene.
pub struct Geometry {
    nodes: Vec<CwBvhNode>,
    /// In the order of the tree's leaves.
    slots: Vec<Slot>,
    /// Slot of each primitive.
    slot_of: Vec<u32>,
    normals: Vec<[Vec3A; 3]>,
    objects: Vec<Range<u32>>,
    bounds: Bounds,
    degenerate: usize,
    metres_per_unit: f64,
}

/// A primitive where the tree wants it: one cache line.
#[derive(Clone, Copy)]
struct Slot {
    primitive: Primitive,
    id: u32,
    object: u32,
}

/// Primitives in a leaf at most; the compressed node counts to three.
const LEAF_SIZE: u32 = 3;
/// Units in the last place of the scene's largest coordinate by which boxes are padded: it
/// covers the rounding of the positions that compressed boxes are built from.
const PADDING_ULPS: f32 = 4.0;
/// Share of nodes that each reinsertion pass of the tree optimiser looks at.
const REINSERTION_SHARE: f32 = 0.15;

impl Geometry {
    pub(crate) fn from_parts(parts: Parts) -> Self {
        let bounds = parts.primitives.iter().fold(Bounds::EMPTY, |b, p| b.union(&p.bounds()));
        let (nodes, order) = build_tree(&parts.primitives, &bounds);
        let mut object_of = vec![0; parts.primitives.len()];
        for (object, range) in parts.objects.iter().enumerate() {
            object_of[range.start as usize..range.end as usize].fill(object as u32);
        }
        let mut slot_of = vec![0; order.len()];
        for (slot, &id) in order.iter().enumerate() {
            slot_of[id as usize] = slot as u32;
        }
        let slot =
            |&id: &u32| Slot { primitive: parts.primitives[id as usize], id, object: object_of[id as usize] };
        Self {
            nodes,
            slots: order.iter().map(slot).collect(),
            slot_of,
            normals: parts.normals,
            objects: parts.objects,
            bounds,
            degenerate: parts.degenerate,
            metres_per_unit: parts.metres_per_unit,
        }
    }

    /// The nearest surface that `ray` meets; of surfaces at the same distance the one with
    /// the lowest number.
    #[inline]
    pub fn intersect(&self, ray: &Ray) -> Option<Hit> {
        let precise = PreciseRay::new(ray);
        let mut nearest: Option<(Meeting, u32)> = None;
        let mut limit = precise.t_max;
        self.walk(ray, |slot| {
            if let Some(meeting) = self.meet(slot, &precise) {
                let closer = match nearest {
                    Some((best, winner)) => {
                        (meeting.t, self.slots[slot as usize].id) < (best.t, self.slots[winner as usize].id)
                    }
                    None => true,
                };
                if closer {
                    nearest = Some((meeting, slot));
                    limit = meeting.t;
                }
            }
            ControlFlow::Continue(round_up(limit))
        });
        nearest.map(|(meeting, slot)| self.hit(&precise, &meeting, slot))
    }

    /// Whether `ray` meets anything.
    #[inline]
    pub fn occluded(&self, ray: &Ray) -> bool {
        let precise = PreciseRay::new(ray);
        let mut met = false;
        self.walk(ray, |slot| {
            met = self.meet(slot, &precise).is_some();
            if met { ControlFlow::Break(()) } else { ControlFlow::Continue(ray.t_max) }
        });
        met
    }

    /// Every primitive that `ray` meets, in any order, and the point where.
    pub(super) fn meet_all(&self, ray: &Ray, mut each: impl FnMut(u32, SurfacePoint)) {
        let precise = PreciseRay::new(ray);
        self.walk(ray, |slot| {
            if let Some(meeting) = self.meet(slot, &precise) {
                let Slot { primitive, id, .. } = &self.slots[slot as usize];
                each(*id, primitive.point(&precise, &meeting));
            }
            ControlFlow::Continue(ray.t_max)
        });
    }

    /// Number of objects.
    pub fn object_count(&self) -> u32 {
        self.objects.len() as u32
    }

    /// Number of primitives.
    pub fn primitive_count(&self) -> u32 {
        self.slots.len() as u32
    }

    /// Numbers of the primitives of an object.
    ///
    /// # Panics
    /// When there is no such object.
    pub fn primitives_of(&self, object: u32) -> Range<u32> {
        self.objects[object as usize].clone()
    }

    /// Number of the object that a primitive belongs to.
    ///
    /// # Panics
    /// When there is no such primitive.
    pub fn object_of(&self, primitive: u32) -> u32 {
        self.slot(primitive).object
    }

    /// A primitive by its number.
    ///
    /// # Panics
    /// When there is no such primitive.
    #[inline]
    pub fn primitive(&self, primitive: u32) -> &Primitive {
        &self.slot(primitive).primitive
    }

    /// Area of a primitive in square scene units.
    ///
    /// # Panics
    /// When there is no such primitive.
    pub fn area_of(&self, primitive: u32) -> f32 {
        self.primitive(primitive).area()
    }

    /// A box around everything, in scene units; empty without primitives.
    pub fn bounds(&self) -> Bounds {
        self.bounds
    }

    /// Length of a scene unit in metres: a power of two.
    pub fn metres_per_unit(&self) -> f64 {
        self.metres_per_unit
    }

    /// A position in metres as one in scene units.
    pub fn to_scene(&self, metres: DVec3) -> Vec3A {
        (metres / self.metres_per_unit).as_vec3a()
    }

    /// The coarsest spacing of positions in the scene, in metres: what a scene far from its
    /// origin loses.
    pub fn spacing_metres(&self) -> f64 {
        if self.bounds.is_empty() {
            return 0.0;
        }
        let reach = self.bounds.min.abs().max(self.bounds.max.abs()).max_element();
        f64::from(reach.next_up() - reach) * self.metres_per_unit
    }

    /// How many triangles were left out because they have no area.
    pub fn degenerate_triangles(&self) -> usize {
        self.degenerate
    }

    #[inline]
    fn slot(&self, primitive: u32) -> &Slot {
        &self.slots[self.slot_of[primitive as usize] as usize]
    }

    #[inline]
    fn meet(&self, slot: u32, ray: &PreciseRay) -> Option<Meeting> {
        let meeting = self.slots[slot as usize].primitive.intersect(ray)?;
        let t = settle(meeting.t);
        ray.reaches(t).then_some(Meeting { t, ..meeting })
    }

    #[inline]
    fn hit(&self, ray: &PreciseRay, meeting: &Meeting, slot: u32) -> Hit {
        let Slot { primitive, id, object } = &self.slots[slot as usize];
        let point = primitive.point(ray, meeting);
        let shading = self.shading_normal(primitive, meeting, point.normal);
        Hit { t: meeting.t as f32, point, shading: Frame::around(shading), primitive: *id, object: *object }
    }

    /// The interpolated vertex normal on the side of the geometric one, or that one itself.
    #[inline]
    fn shading_normal(&self, primitive: &Primitive, meeting: &Meeting, geometric: Vec3A) -> Vec3A {
        let Primitive::Triangle(triangle) = primitive else {
            return geometric;
        };
        let Some(index) = triangle.normals() else {
            return geometric;
        };
        let [a, b, c] = self.normals[index as usize];
        let (u, v) = (meeting.u as f32, meeting.v as f32);
        let blend = a * (1.0 - u - v) + b * u + c * v;
        match blend.try_normalize() {
            Some(normal) if normal.dot(geometric) < 0.0 => -normal,
            Some(normal) => normal,
            None => geometric,
        }
    }

    /// Visits the slots of every leaf whose box `ray` meets nearer than the limit that the
    /// last visit returned.
    #[inline]
    fn walk(&self, ray: &Ray, mut visit: impl FnMut(u32) -> ControlFlow<(), f32>) {
        if self.nodes.is_empty() {
            return;
        }
        let boxes = BoxRay::new(ray);
        let mut limit = ray.t_max;
        let mut stack = Stack::new();
        // Index of the first child; its high byte marks children to visit in order of
        // their priority, its low byte the slots that hold inner nodes.
        let mut group = UVec2::new(0, 0x8000_0000);
        loop {
            if group.y & 0xff00_0000 == 0 {
                match stack.pop() {
                    Some(next) => group = next,
                    None => return,
                }
            }
            let priority = 31 - group.y.leading_zeros();
            let place = (priority - 24) ^ (boxes.octant & 0xff);
            let before = (group.y & !(u32::MAX << place)).count_ones();
            let node = &self.nodes[(group.x + before) as usize];
            group.y &= !(1 << priority);
            if group.y & 0xff00_0000 != 0 {
                stack.push(group);
            }
            let met = boxes.children(node, limit);
            let mut leaves = met & 0x00ff_ffff;
            while leaves != 0 {
                let leaf = 31 - leaves.leading_zeros();
                leaves &= !(1 << leaf);
                match visit(node.primitive_base_idx + leaf) {
                    ControlFlow::Continue(nearer) => limit = nearer,
                    ControlFlow::Break(()) => return,
                }
            }
            group = UVec2::new(node.child_base_idx, met & 0xff00_0000 | u32::from(node.imask));
        }
    }
}

/// Rounds a distance to 34 significant bits, so that surfaces in one place are met at one
/// distance however their arithmetic went, and the lowest number decides between them.
#[inline]
fn settle(t: f64) -> f64 {
    const DROPPED_BITS: u32 = 19;
    const HALF: u64 = 1 << (DROPPED_BITS - 1);
    f64::from_bits((t.to_bits() + HALF) & !((1 << DROPPED_BITS) - 1))
}

fn build_tree(primitives: &[Primitive], bounds: &Bounds) -> (Vec<CwBvhNode>, Vec<u32>) {
    if primitives.is_empty() {
        return (Vec::new(), Vec::new());
    }
    let reach = bounds.min.abs().max(bounds.max.abs());
    let padding = reach * (PADDING_ULPS * f32::EPSILON);
    let boxes: Vec<Aabb> = primitives
        .iter()
        .map(|primitive| {
            let Bounds { min, max } = primitive.bounds();
            Aabb::new(min - padding, max + padding)
        })
        .collect();
    let wide = bvh2_to_cwbvh(&binary_tree(&boxes), LEAF_SIZE, true, false);
    (wide.nodes, wide.primitive_indices)
}

/// A binary tree by clustering, which suits rays best; by halving where clustering makes a
/// chain, as it does of many faces in one place. Chains take quadratic time to make and
/// overflow the call stack of what follows.
fn binary_tree(boxes: &[Aabb]) -> Bvh2 {
    if deepest_heap(boxes) > DEEPEST as usize {
        return halved(boxes);
    }
    let indices = (0..boxes.len() as u32).collect();
    let mut clustered = PlocBuilder::with_capacity(boxes.len()).build(
        PlocSearchDistance::Medium,
        boxes,
        indices,
        SortPrecision::U64,
        0,
    );
    if !is_shallow(&clustered) {
        return halved(boxes);
    }
    ReinsertionOptimizer::default().run(&mut clustered, REINSERTION_SHARE, None);
    if is_shallow(&clustered) { clustered } else { halved(boxes) }
}

/// Levels of a tree that is safe to walk by recursion.
const DEEPEST: u32 = 96;

/// How many boxes at most are the same box.
fn deepest_heap(boxes: &[Aabb]) -> usize {
    let bits = |b: &Aabb| (b.min.to_array().map(f32::to_bits), b.max.to_array().map(f32::to_bits));
    let mut keys: Vec<_> = boxes.iter().map(bits).collect();
    keys.sort_unstable();
    keys.chunk_by(|a, b| a == b).map(<[_]>::len).max().unwrap_or(0)
}

fn is_shallow(tree: &Bvh2) -> bool {
    let mut pending = vec![(0, 0)];
    while let Some((index, depth)) = pending.pop() {
        if depth > DEEPEST {
            return false;
        }
        let node = &tree.nodes[index as usize];
        if !node.is_leaf() {
            pending.extend([(node.first_index, depth + 1), (node.first_index + 1, depth + 1)]);
        }
    }
    true
}

/// A tree that halves the number of boxes at each level, along the axis on which their
/// centres lie farthest apart.
fn halved(boxes: &[Aabb]) -> Bvh2 {
    let mut order: Vec<u32> = (0..boxes.len() as u32).collect();
    let mut nodes = vec![Bvh2Node::default()];
    let mut pending = vec![(0, 0..boxes.len())];
    while let Some((node, range)) = pending.pop() {
        let members = &mut order[range.clone()];
        let (mut around, mut centers) = (Aabb::INVALID, Aabb::INVALID);
        for &member in members.iter() {
            around = around.union(&boxes[member as usize]);
            centers.extend(boxes[member as usize].center());
        }
        if members.len() == 1 {
            nodes[node] = Bvh2Node::new(around, 1, range.start as u32);
            continue;
        }
        let (axis, half) = (centers.largest_axis(), members.len() / 2);
        let center = |&member: &u32| boxes[member as usize].center_axis(axis);
        members.select_nth_unstable_by(half, |a, b| center(a).total_cmp(&center(b)));
        let children = nodes.len();
        nodes[node] = Bvh2Node::new(around, 0, children as u32);
        nodes.extend([Bvh2Node::default(); 2]);
        pending.push((children, range.start..range.start + half));
        pending.push((children + 1, range.start + half..range.end));
    }
    Bvh2 { nodes, primitive_indices: order, ..Bvh2::default() }
}

/// A ray as the box test wants it.
struct BoxRay {
    origin: Vec3A,
    inverse: Vec3A,
    /// Order in which to visit children: bits 2, 1, 0 set where x, y, z do not fall.
    octant: u32,
}

/// Direction components below this count as this: far below the spacing of positions at any
/// distance a scene holds, and its inverse stays finite through the box test.
const LEAST_COMPONENT: f32 = 1e-20;

/// Bound on the rounding of the box test, relative to its terms: five roundings.
const BOX_ROUNDING: f32 = 2.5 * f32::EPSILON;

impl BoxRay {
    #[inline]
    fn new(ray: &Ray) -> Self {
        let size = ray.direction.abs().max(Vec3A::splat(LEAST_COMPONENT));
        let direction = size.copysign(ray.direction);
        let falls = ray.direction.cmplt(Vec3A::ZERO).bitmask();
        let octant =
            (u32::from(falls & 1 == 0) << 2) | (u32::from(falls & 2 == 0) << 1) | u32::from(falls & 4 == 0);
        Self { origin: ray.origin, inverse: direction.recip(), octant: octant * 0x0101_0101 }
    }

    /// Which children of `node` the ray meets before `limit`, in the bit order of the node:
    /// inner nodes by priority in the high byte, primitives in the rest.
    #[inline]
    fn children(&self, node: &CwBvhNode, limit: f32) -> u32 {
        let scale = node.compute_extent() * self.inverse;
        let start = (Vec3A::from(node.p) - self.origin) * self.inverse;
        let slack = (start.abs() + scale.abs() * 255.0) * BOX_ROUNDING;
        let (nearest, farthest) = (start - slack, start + slack);
        let mut enter = [0.0f32; 8];
        let mut leave = [limit; 8];
        let sides = [
            (&node.child_min_x, &node.child_max_x),
            (&node.child_min_y, &node.child_max_y),
            (&node.child_min_z, &node.child_max_z),
        ];
        for (axis, (low, high)) in sides.into_iter().enumerate() {
            let rises = self.inverse[axis] > 0.0;
            let (near, far) = if rises { (low, high) } else { (high, low) };
            let (scale, nearest, farthest) = (scale[axis], nearest[axis], farthest[axis]);
            for child in 0..8 {
                let nearest = f32::from(near[child]) * scale + nearest;
                let farthest = f32::from(far[child]) * scale + farthest;
                // Comparisons, not `max` and `min`: nothing here is NaN, and these are one
                // instruction.
                enter[child] = if nearest > enter[child] { nearest } else { enter[child] };
                leave[child] = if farthest < leave[child] { farthest } else { leave[child] };
            }
        }
        let (bits, places) = node.get_child_and_index_bits(self.octant);
        let mut met = 0;
        for child in 0..8 {
            let bits = extract_byte64(bits, child) * u32::from(enter[child] <= leave[child]);
            met |= bits << extract_byte64(places, child);
        }
        met
    }
}

/// Groups of nodes still to visit. Depth is not bounded by anything but the number of
/// primitives, so what does not fit goes to the heap.
struct Stack {
    top: [UVec2; 24],
    used: usize,
    spilled: Vec<UVec2>,
}

impl Stack {
    #[inline]
    fn new() -> Self {
        Self { top: [UVec2::ZERO; 24], used: 0, spilled: Vec::new() }
    }

    #[inline]
    fn push(&mut self, group: UVec2) {
        match self.top.get_mut(self.used) {
            Some(place) => {
                *place = group;
                self.used += 1;
            }
            None => self.spilled.push(group),
        }
    }

    #[inline]
    fn pop(&mut self) -> Option<UVec2> {
        if let Some(group) = self.spilled.pop() {
            return Some(group);
        }
        self.used = self.used.checked_sub(1)?;
        Some(self.top[self.used])
    }
}
