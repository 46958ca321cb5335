//! What the structure promises beyond its answers: that the quick tests turn nothing away that
//! the exact ones accept, and that processors agree.

use super::super::{GeometryBuilder, PreciseRay, Ray, Transform, specimens};
use super::Geometry;
use super::block::{Block, BlockRay};
use super::node::WIDTH;
use crate::geometry::primitive::Triangle;
use glam::{DVec3, Vec3A};

/// PCG-RXS-M-XS 32 (O'Neill 2014).
struct Random(u32);

impl Random {
    /// Uniform in [-1, 1).
    fn signed(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(747796405).wrapping_add(2891336453);
        let word = ((self.0 >> ((self.0 >> 28) + 4)) ^ self.0).wrapping_mul(277803737);
        (((word >> 22) ^ word) >> 8) as f32 / (1 << 23) as f32 - 1.0
    }

    fn vector(&mut self) -> Vec3A {
        Vec3A::new(self.signed(), self.signed(), self.signed())
    }

    /// Of any size down to 1e-8.
    fn sized(&mut self) -> Vec3A {
        self.vector() * 10f32.powf(-4.0 + 4.0 * self.signed())
    }
}

/// Every kind of shape, many times, over one another.
fn mixed() -> Geometry {
    let mut builder = GeometryBuilder::new();
    let mut random = Random(1);
    for _ in 0..10 {
        for (_, shape) in specimens() {
            let size = f64::from(0.2 + 0.1 * random.signed());
            let place = Transform::in_order(&[
                Transform::scale(DVec3::splat(size)).expect("a size"),
                Transform::translate(random.vector().as_dvec3()).expect("a shift"),
            ]);
            builder.add_object(&shape, &place.expect("a placement")).expect("a shape");
        }
    }
    builder.build().expect("a scene")
}

#[test]
fn no_triangle_is_turned_away_that_is_met_exactly() {
    let mut random = Random(2);
    let (mut met, mut passed, mut asked) = (0, 0, 0);
    for i in 0..200_000 {
        // From far to near, from large to small, slivers among them, all within reach one; rays
        // go through corners, edges, a hair beside them, and elsewhere.
        let corner = random.vector() * 0.4;
        let (first, second) = (random.sized() * 0.3, random.sized() * 0.3);
        let vertices = [corner, corner + first, corner + second].map(|v| v.to_array());
        let origin = if i % 3 == 0 { corner + random.sized() } else { random.vector() * 4.0 };
        let share = [0.0, 0.5, 1.0, 0.5 + 0.5 * random.signed()][i % 4];
        let beside = random.vector() * if i % 2 == 0 { 0.0 } else { 1e-6 };
        let target = corner + first * share + beside;
        let mut direction = target - origin;
        if i % 5 != 0 {
            direction = direction.normalize_or(Vec3A::X);
        }
        let ray = Ray { t_max: if i % 7 == 0 { 1.0 } else { f32::INFINITY }, ..Ray::new(origin, direction) };
        let precise = PreciseRay::new(&ray);
        let mut block = Block::EMPTY;
        block.set(i % WIDTH, &vertices, 0, false);
        let may_meet = block.may_meet(&BlockRay::new(&precise, 1.0), ray.t_max);
        assert_eq!(may_meet & !(1 << (i % WIDTH)), 0, "only one triangle is there");
        let is_met = Triangle::meet(&vertices, &precise).is_some();
        assert!(!is_met || may_meet != 0, "{ray:?} meets {vertices:?}");
        (met, passed, asked) = (met + u32::from(is_met), passed + u32::from(may_meet != 0), asked + 1);
    }
    assert!(met > asked / 20 && passed < asked - asked / 20, "{met} met, {passed} passed of {asked}");
}

#[test]
fn rays_that_miss_by_a_thousandth_are_turned_away() {
    let mut random = Random(3);
    let vertices = [[0.0, 0.0, 0.0], [0.2, 0.0, 0.0], [0.0, 0.2, 0.0]];
    let mut block = Block::EMPTY;
    for place in 0..WIDTH {
        block.set(place, &vertices, 0, false);
    }
    for _ in 0..10_000 {
        let origin = Vec3A::new(random.signed(), random.signed(), 0.8);
        let beside = Vec3A::new(0.1 + 0.1 * random.signed(), -0.001, 0.0);
        let precise = PreciseRay::new(&Ray::new(origin, (beside - origin).normalize()));
        assert_eq!(block.may_meet(&BlockRay::new(&precise, 1.0), f32::INFINITY), 0);
    }
}

#[cfg(target_arch = "x86_64")]
#[test]
fn wider_registers_give_the_same_bits() {
    if !super::answer::has_wide_registers() {
        return;
    }
    let geometry = mixed();
    let mut random = Random(4);
    let mut hits = 0;
    for i in 0..100_000 {
        let direction = random.vector().normalize_or(Vec3A::X);
        let t_max = if i % 3 == 0 { 0.5 } else { f32::INFINITY };
        let ray = Ray { t_max, ..Ray::new(random.vector(), direction) };
        let precise = PreciseRay::new(&ray);
        // SAFETY: the processor has what the functions are compiled for.
        #[expect(unsafe_code, reason = "both ways are compared")]
        let wide = unsafe { (geometry.nearest_avx2(&ray, &precise), geometry.occluded_avx2(&ray)) };
        let bits = |found: Option<(super::super::Meeting, u32)>| {
            found.map(|(m, slot)| (m.t.to_bits(), m.u.to_bits(), m.v.to_bits(), slot))
        };
        let plain = bits(geometry.nearest_anywhere(&ray, &precise));
        assert_eq!(bits(wide.0), plain);
        assert_eq!(wide.1, geometry.occluded_anywhere(&ray));
        assert_eq!(wide.1, plain.is_some());
        hits += u32::from(wide.1);
    }
    assert!((1_000..99_000).contains(&hits), "{hits} hits");
}
