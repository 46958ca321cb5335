//! Answers to rays: the nearest surface, whether there is any, and all of them.

use super::super::precise::round_up;
use super::super::primitive::Triangle;
use super::super::{Frame, Hit, Meeting, PreciseRay, Primitive, Ray, SurfacePoint};
use super::walk::{Candidate, Visitor, walk};
use super::{Geometry, Slot};
use glam::Vec3A;
use std::ops::ControlFlow;

/// Whether the processor has all that the wide build of the walk is compiled for.
#[cfg(target_arch = "x86_64")]
#[inline]
pub(super) fn has_wide_registers() -> bool {
    use std::arch::is_x86_feature_detected as has;
    has!("avx2") && has!("bmi1") && has!("bmi2") && has!("lzcnt") && has!("popcnt")
}

impl Geometry {
    /// The nearest surface that `ray` meets; of surfaces at the same distance the one with
    /// the lowest number.
    #[inline]
    pub fn intersect(&self, ray: &Ray) -> Option<Hit> {
        let precise = PreciseRay::new(ray);
        let (meeting, slot) = self.nearest(ray, &precise)?;
        Some(self.hit(&precise, &meeting, slot))
    }

    /// Whether `ray` meets anything.
    #[inline]
    pub fn occluded(&self, ray: &Ray) -> bool {
        #[cfg(target_arch = "x86_64")]
        if has_wide_registers() {
            // SAFETY: the processor has what the function is compiled for.
            #[expect(unsafe_code, reason = "wider registers where the processor has them")]
            return unsafe { self.occluded_avx2(ray) };
        }
        self.occluded_anywhere(ray)
    }

    #[inline]
    fn nearest(&self, ray: &Ray, precise: &PreciseRay) -> Option<(Meeting, u32)> {
        #[cfg(target_arch = "x86_64")]
        if has_wide_registers() {
            // SAFETY: the processor has what the function is compiled for.
            #[expect(unsafe_code, reason = "wider registers where the processor has them")]
            return unsafe { self.nearest_avx2(ray, precise) };
        }
        self.nearest_anywhere(ray, precise)
    }

    // Without fused multiplication, which rounds once where the other build rounds twice.
    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2,bmi1,bmi2,lzcnt,popcnt")]
    pub(super) fn nearest_avx2(&self, ray: &Ray, precise: &PreciseRay) -> Option<(Meeting, u32)> {
        self.find_nearest(ray, precise)
    }

    pub(super) fn nearest_anywhere(&self, ray: &Ray, precise: &PreciseRay) -> Option<(Meeting, u32)> {
        self.find_nearest(ray, precise)
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2,bmi1,bmi2,lzcnt,popcnt")]
    pub(super) fn occluded_avx2(&self, ray: &Ray) -> bool {
        self.find_any(ray)
    }

    pub(super) fn occluded_anywhere(&self, ray: &Ray) -> bool {
        self.find_any(ray)
    }

    #[inline(always)]
    fn find_nearest(&self, ray: &Ray, precise: &PreciseRay) -> Option<(Meeting, u32)> {
        let mut search = Nearest { geometry: self, ray: precise, found: None, limit: ray.t_max };
        walk(&self.tree, ray, precise, self.reach, &mut search);
        search.found
    }

    #[inline(always)]
    fn find_any(&self, ray: &Ray) -> bool {
        let precise = PreciseRay::new(ray);
        let mut search = Any { geometry: self, ray: &precise, limit: ray.t_max, met: false };
        walk(&self.tree, ray, &precise, self.reach, &mut search);
        search.met
    }

    /// Every primitive that `ray` meets, in any order, and the point where; one of two pieces
    /// perhaps twice.
    pub(in super::super) fn meet_all(&self, ray: &Ray, each: impl FnMut(u32, SurfacePoint)) {
        let precise = PreciseRay::new(ray);
        let mut search = Every { geometry: self, ray: &precise, limit: ray.t_max, each };
        walk(&self.tree, ray, &precise, self.reach, &mut search);
    }

    #[inline(always)]
    fn meet(&self, candidate: Candidate, ray: &PreciseRay) -> Option<(Meeting, u32)> {
        let (meeting, slot) = match candidate {
            Candidate::Triangle(vertices, slot) => (Triangle::meet(&vertices, ray)?, slot),
            Candidate::Primitive(slot) => (self.slots[slot as usize].primitive.intersect(ray)?, slot),
        };
        let t = settle(meeting.t);
        ray.reaches(t).then_some((Meeting { t, ..meeting }, slot))
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
}

/// The search for the nearest primitive.
struct Nearest<'a> {
    geometry: &'a Geometry,
    ray: &'a PreciseRay,
    found: Option<(Meeting, u32)>,
    limit: f32,
}

impl Visitor for Nearest<'_> {
    const SORTED: bool = true;

    #[inline(always)]
    fn visit(&mut self, candidate: Candidate) -> ControlFlow<(), f32> {
        if let Some((meeting, slot)) = self.geometry.meet(candidate, self.ray) {
            let id = |slot: u32| self.geometry.slots[slot as usize].id;
            let is_nearer = self.found.as_ref().is_none_or(|(best, winner)| {
                meeting.t < best.t || meeting.t == best.t && id(slot) < id(*winner)
            });
            if is_nearer {
                self.limit = round_up(meeting.t);
                self.found = Some((meeting, slot));
            }
        }
        ControlFlow::Continue(self.limit)
    }
}

/// The search for any primitive.
struct Any<'a> {
    geometry: &'a Geometry,
    ray: &'a PreciseRay,
    limit: f32,
    met: bool,
}

impl Visitor for Any<'_> {
    const SORTED: bool = false;

    #[inline(always)]
    fn visit(&mut self, candidate: Candidate) -> ControlFlow<(), f32> {
        self.met = self.geometry.meet(candidate, self.ray).is_some();
        if self.met { ControlFlow::Break(()) } else { ControlFlow::Continue(self.limit) }
    }
}

/// The search for every primitive.
struct Every<'a, F> {
    geometry: &'a Geometry,
    ray: &'a PreciseRay,
    limit: f32,
    each: F,
}

impl<F: FnMut(u32, SurfacePoint)> Visitor for Every<'_, F> {
    const SORTED: bool = false;

    #[inline(always)]
    fn visit(&mut self, candidate: Candidate) -> ControlFlow<(), f32> {
        if let Some((meeting, slot)) = self.geometry.meet(candidate, self.ray) {
            let Slot { primitive, id, .. } = &self.geometry.slots[slot as usize];
            (self.each)(*id, primitive.point(self.ray, &meeting));
        }
        ControlFlow::Continue(self.limit)
    }
}

/// Rounds a distance to 34 significant bits, so that surfaces in one place are met at one
/// distance however their arithmetic went, and the lowest number decides between them.
#[inline(always)]
fn settle(t: f64) -> f64 {
    const DROPPED_BITS: u32 = 19;
    const HALF: u64 = 1 << (DROPPED_BITS - 1);
    f64::from_bits((t.to_bits() + HALF) & !((1 << DROPPED_BITS) - 1))
}
