//! Points land on surfaces as densely as they say.
#![expect(clippy::unwrap_used, reason = "a set-up that fails is a test that fails")]

use etalon::geometry::primitive::Sphere;
use etalon::geometry::{Geometry, GeometryBuilder, Ray, Shape, SurfacePoint, Transform, specimens};
use etalon::light::{AreaLight, Light};
use etalon::spectrum::{Dense, Emission, WavelengthSampler};
use glam::{DVec3, Vec3, Vec3A};
use std::f64::consts::{PI, TAU};

/// PCG-XSH-RR 64/32 (O'Neill 2014).
struct Random(u64);

impl Random {
    /// Uniform in [0, 1).
    fn unit(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        let mixed = ((self.0 >> 18) ^ self.0) >> 27;
        let bits = (mixed as u32).rotate_right((self.0 >> 59) as u32);
        (bits >> 8) as f32 / (1 << 24) as f32
    }

    fn direction(&mut self) -> DVec3 {
        let z = 1.0 - 2.0 * f64::from(self.unit());
        let (sin, cos) = (TAU * f64::from(self.unit())).sin_cos();
        let across = (1.0 - z * z).sqrt();
        DVec3::new(across * cos, across * sin, z)
    }
}

/// Running mean and variance of each of several quantities.
#[derive(Default)]
struct Means {
    count: f64,
    sums: Vec<[f64; 2]>,
}

impl Means {
    fn add(&mut self, values: &[f64]) {
        self.count += 1.0;
        self.sums.resize(values.len(), [0.0; 2]);
        for (sum, value) in self.sums.iter_mut().zip(values) {
            sum[0] += value;
            sum[1] += value * value;
        }
    }

    /// Mean and its squared standard error.
    fn get(&self, index: usize) -> (f64, f64) {
        let [sum, squares] = self.sums[index];
        let mean = sum / self.count;
        (mean, (squares / self.count - mean * mean).max(0.0) / self.count)
    }
}

/// How many standard errors a test may be off.
const SIGMA: f64 = 5.0;

/// The area, then the areas in eight octants around `center`, then first moments.
fn features(point: Vec3A, center: Vec3A, weight: f64, into: &mut [f64; 12]) {
    let from_center = (point - center).as_dvec3();
    into[0] += weight;
    let octant = (from_center.x > 0.0) as usize
        + 2 * (from_center.y > 0.0) as usize
        + 4 * (from_center.z > 0.0) as usize;
    into[1 + octant] += weight;
    for axis in 0..3 {
        into[9 + axis] += weight * from_center[axis];
    }
}

fn by_sampling(geometry: &Geometry, random: &mut Random) -> Means {
    let center = geometry.bounds().center();
    let mut means = Means::default();
    for _ in 0..400_000 {
        let mut values = [0.0; 12];
        for id in 0..geometry.primitive_count() {
            // A primitive at random, as dense as its number; the mean of 1/density is area.
            if geometry.primitive_count() > 8 && random.unit() >= 1.0 / 64.0 {
                continue;
            }
            let share = if geometry.primitive_count() > 8 { 64.0 } else { 1.0 };
            let primitive = geometry.primitive(id);
            let point = primitive.sample_area([random.unit(), random.unit()]);
            features(point.position, center, share * f64::from(primitive.area()), &mut values);
        }
        means.add(&values);
        if geometry.primitive_count() > 8 && means.count >= 20_000.0 {
            break;
        }
    }
    means
}

/// Random straight lines cross a surface uniformly over its area; the expected number of
/// crossings of a line through a ball of radius R is area / (2 pi R^2) (Cauchy, Crofton).
fn by_crossing_lines(geometry: &Geometry, random: &mut Random) -> Means {
    let center = geometry.bounds().center();
    let radius = f64::from(geometry.bounds().radius()) * 1.01;
    let mut means = Means::default();
    for _ in 0..400_000 {
        let direction = random.direction();
        let (tangent, bitangent) = direction.any_orthonormal_pair();
        let distance = radius * f64::from(random.unit()).sqrt();
        let (sin, cos) = (TAU * f64::from(random.unit())).sin_cos();
        let origin =
            center.as_dvec3() - direction * (2.0 * radius) + (tangent * cos + bitangent * sin) * distance;
        let direction = direction.as_vec3a();
        let mut ray = Ray::new(origin.as_vec3a(), direction);
        let mut values = [0.0; 12];
        while let Some(hit) = geometry.intersect(&ray) {
            features(hit.point.position, center, TAU * radius * radius, &mut values);
            ray = hit.point.ray_along(direction);
        }
        means.add(&values);
    }
    means
}

#[test]
fn points_land_uniformly_over_the_area() {
    for (name, shape) in specimens() {
        let mut builder = GeometryBuilder::new();
        let turn = Transform::rotate(DVec3::new(0.3, -1.0, 0.7), 37.0).unwrap();
        builder.add_object(&shape, &turn).unwrap();
        let geometry = builder.build().unwrap();
        let mut random = Random(1);
        let sampled = by_sampling(&geometry, &mut random);
        let crossed = by_crossing_lines(&geometry, &mut random);
        for index in 0..12 {
            let ((a, va), (b, vb)) = (sampled.get(index), crossed.get(index));
            let error = (va + vb).sqrt() + 1e-6 * a.abs();
            let total = crossed.get(0).0;
            assert!((a - b).abs() <= SIGMA * error, "{name}[{index}]: {a} | {b} +- {error}");
            assert!(error <= 0.02 * total, "{name}[{index}]: +- {error} of {total} is too noisy");
        }
    }
}

#[test]
fn areas_are_those_of_the_closed_forms() {
    let side = (0.8f64.powi(2) + 0.3f64.powi(2) + 0.7f64.powi(2)).sqrt();
    let expected = [
        ("sphere", 4.0 * PI * 0.7 * 0.7),
        ("open cylinder", TAU * 0.35 * side),
        ("capped cylinder", TAU * 0.35 * side + TAU * 0.35 * 0.35),
        ("disk", PI * 0.6 * 0.6),
        ("level square", 1.0),
        ("box", 2.0 * (0.9 * 1.0 + 1.0 * 0.8 + 0.8 * 0.9)),
    ];
    for (name, area) in expected {
        let shape = specimens().into_iter().find(|s| s.0 == name).unwrap().1;
        let mut builder = GeometryBuilder::new();
        builder.add_object(&shape, &Transform::IDENTITY).unwrap();
        let geometry = builder.build().unwrap();
        let unit = geometry.metres_per_unit();
        let sum: f64 = geometry.primitives_of(0).map(|id| f64::from(geometry.area_of(id))).sum();
        assert!((sum * unit * unit / area - 1.0).abs() < 1e-6, "{name}: {sum} | {area}");
    }
}

#[test]
fn directions_to_a_sphere_fill_its_cone_uniformly() {
    let sphere = Sphere::new(Vec3::new(0.1, -0.2, 0.3), 0.25).unwrap();
    // Closer than rounding can tell, 1.3e-7 here, a point counts as on the sphere.
    for distance in [0.250_000_2f64, 0.26, 0.5, 3.0] {
        let mut random = Random(2);
        let axis = random.direction();
        let from = (sphere.center().as_dvec3() + axis * distance).as_vec3a();
        let true_distance = from.as_dvec3().distance(sphere.center().as_dvec3());
        let sin2 = (0.25 / true_distance).powi(2).min(1.0);
        let cos = (1.0 - sin2).sqrt();
        let mut means = Means::default();
        for _ in 0..400_000 {
            let u = [random.unit(), random.unit()];
            let (point, pdf) = sphere.sample_solid_angle(from, u).unwrap();
            assert_eq!(pdf, sphere.pdf_solid_angle(from, &point));
            let towards = (point.position - from).as_dvec3().normalize();
            assert!(point.normal.as_dvec3().dot(towards) < 1e-3, "{point:?} from {from}");
            let weight = 1.0 / f64::from(pdf);
            let along = -towards.dot(axis);
            means.add(&[weight, weight * along, weight * along * along]);
        }
        // Integrals of 1, z, z^2 over the cone.
        let truths = [1.0 - cos, (1.0 - cos * cos) / 2.0, (1.0 - cos.powi(3)) / 3.0];
        for (index, truth) in truths.into_iter().enumerate() {
            let (mean, variance) = means.get(index);
            let truth = TAU * truth;
            let error = SIGMA * variance.sqrt() + 1e-4 * truth;
            assert!((mean - truth).abs() < error, "{distance}[{index}]: {mean} | {truth} +- {error}");
        }
    }
}

#[test]
fn from_inside_a_sphere_the_density_covers_all_directions() {
    let sphere = Sphere::new(Vec3::ZERO, 0.8).unwrap();
    let from = Vec3A::new(0.3, 0.1, -0.4);
    let mut random = Random(3);
    let mut means = Means::default();
    for _ in 0..1_000_000 {
        let u = [random.unit(), random.unit()];
        let (point, pdf) = sphere.sample_solid_angle(from, u).unwrap();
        let towards = (point.position - from).as_dvec3().normalize();
        let weight = 1.0 / f64::from(pdf);
        means.add(&[weight, weight * towards.x, weight * towards.z, weight * towards.z.powi(2)]);
    }
    for (index, truth) in [4.0 * PI, 0.0, 0.0, 4.0 * PI / 3.0].into_iter().enumerate() {
        let (mean, variance) = means.get(index);
        let error = SIGMA * variance.sqrt();
        assert!((mean - truth).abs() < error, "[{index}]: {mean} | {truth} +- {error}");
        assert!(error < 0.1, "[{index}]: +- {error} is too noisy");
    }
}

#[test]
fn a_tiny_far_sphere_shines_as_much_as_it_should() {
    let sphere = Sphere::new(Vec3::ZERO, 1e-6).unwrap();
    let from = Vec3A::new(0.0, 0.0, 1e6);
    let mut random = Random(4);
    for _ in 0..1_000 {
        let u = [random.unit(), random.unit()];
        let (point, pdf) = sphere.sample_solid_angle(from, u).unwrap();
        let irradiance_over_radiance = 1.0 / f64::from(pdf);
        assert!((irradiance_over_radiance / 3.14159e-24 - 1.0).abs() < 1e-3);
        assert!(point.position.is_finite() && point.normal.z >= 0.0);
    }
}

/// Solid angle of a triangle (Van Oosterom and Strackee 1983).
fn solid_angle([a, b, c]: [DVec3; 3]) -> f64 {
    let [l, m, n] = [a, b, c].map(DVec3::length);
    let below = l * m * n + a.dot(b) * n + a.dot(c) * m + b.dot(c) * l;
    2.0 * a.dot(b.cross(c)).abs().atan2(below)
}

/// A square, a strip of 1 to 300 and a sheared parallelogram, from places that touch their middle,
/// their edge and their plane, and from afar: the mean of one over the density is the solid angle,
/// and rays that find a point are told the density with which it is drawn.
#[test]
fn directions_to_flat_lamps_fill_their_solid_angle() {
    let wavelengths = WavelengthSampler::even().sample(0.3);
    let (u, v) = (DVec3::new(0.6, 0.0, 0.8), DVec3::new(0.0, 1.0, 0.0));
    for (shape, edges) in [[u, v], [u, v / 300.0], [u, v + 0.4 * u]].into_iter().enumerate() {
        let vertices = [DVec3::ZERO, edges[0], edges[0] + edges[1], edges[1]];
        let mut builder = GeometryBuilder::new();
        builder.add_object(&Shape::Quad { vertices }, &Transform::IDENTITY).unwrap();
        let geometry = builder.build().unwrap();
        let light = AreaLight::new(&geometry, 0, Emission::new(Dense::Flat(1.0), vec![]), true);
        let light = Light::Area(light);
        let normal = edges[0].cross(edges[1]).normalize();
        for [s, t, height] in [
            [0.5, 0.5, 1e-3],
            [0.5, 0.5, 0.1],
            [0.0, 1.0, 0.05],
            [1.2, 0.4, 0.02],
            [1.01, 0.5, 2e-4],
            [0.3, 0.7, 1.0],
            [3.0, -2.0, 4.0],
        ] {
            // Area sampling, which is left to what is no rectangle, does not converge there.
            if shape == 2 && height < 0.05 {
                continue;
            }
            let position = geometry.to_scene(edges[0] * s + edges[1] * t - normal * height);
            let from = SurfacePoint { position, error: Vec3A::ZERO, normal: normal.as_vec3a() };
            let corners = vertices.map(|corner| (geometry.to_scene(corner) - position).as_dvec3());
            let [a, b, c, d] = corners;
            let truth = solid_angle([a, b, c]) + solid_angle([a, c, d]);
            let mut random = Random(7);
            let mut means = Means::default();
            for _ in 0..40_000 {
                let drawn =
                    light.sample_towards(&geometry, &from, [random.unit(), random.unit()], &wavelengths);
                let drawn = drawn.unwrap();
                let told = light.pdf_towards(&geometry, &from, &drawn.point, drawn.primitive.unwrap());
                assert!((told / drawn.pdf_solid_angle - 1.0).abs() < 1e-6, "{told} {drawn:?}");
                means.add(&[1.0 / f64::from(drawn.pdf_solid_angle)]);
            }
            let (mean, variance) = means.get(0);
            let error = SIGMA * variance.sqrt() + 3e-6 * truth;
            assert!(
                (mean - truth).abs() < error,
                "{shape} from {s} {t} {height}: {mean} | {truth} +- {error}"
            );
        }
    }
}
