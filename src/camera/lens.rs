//! Rays from the sensor through a pinhole or a thin lens.

use crate::geometry::{Ray, SurfacePoint};
use crate::sampler::inverse::{ANY, square_of_disk};
use glam::{DVec3, Vec3A};
use serde::{Deserialize, Serialize};

/// Where a camera is, in scene units and right-handed world coordinates.
#[derive(Clone, Copy, Debug)]
pub struct CameraPlacement {
    /// Pinhole, or centre of the lens.
    pub position: DVec3,
    /// Unit vector along the optical axis, into the scene.
    pub forward: DVec3,
    /// Unit vector to the right in the picture.
    pub right: DVec3,
    /// Unit vector up in the picture.
    pub up: DVec3,
}

/// The opening of a thin lens and where it focuses, in scene units.
#[derive(Clone, Copy, Debug)]
pub struct LensAperture {
    /// Radius of the entrance pupil.
    pub radius: f64,
    /// Distance of the plane in focus along the optical axis.
    pub focus_distance: f64,
}

/// Which part of a picture another one is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Crop {
    /// Width and height of the whole picture in pixels.
    pub whole: [u32; 2],
    /// Column and row of the part's top left pixel in it.
    pub corner: [u32; 2],
}

/// A camera that turns picture positions into rays.
#[derive(Clone, Debug)]
pub struct Camera {
    placement: CameraPlacement,
    resolution: [u32; 2],
    /// Half width and half height of the picture at distance one.
    half_extent: [f64; 2],
    /// Offset of the principal point from the picture's middle, in pixels (right, down).
    principal_point_px: [f64; 2],
    aperture: Option<LensAperture>,
    crop: Option<Crop>,
}

impl Camera {
    /// A camera whose picture spans `half_extent` (tangents of the half angles of view).
    pub const fn new(
        placement: CameraPlacement,
        resolution: [u32; 2],
        half_extent: [f64; 2],
        principal_point_px: [f64; 2],
        aperture: Option<LensAperture>,
    ) -> Self {
        Self { placement, resolution, half_extent, principal_point_px, aperture, crop: None }
    }

    /// Width and height in pixels.
    pub const fn resolution(&self) -> [u32; 2] {
        self.resolution
    }

    /// Whether the lens has an opening, so that a ray needs a point on it.
    pub const fn has_aperture(&self) -> bool {
        self.aperture.is_some()
    }

    /// Where the camera stands, in scene units.
    pub const fn placement(&self) -> &CameraPlacement {
        &self.placement
    }

    /// Tangents of half the horizontal and half the vertical angle of view.
    pub const fn half_extent(&self) -> [f64; 2] {
        self.half_extent
    }

    /// Offset of the principal point from the picture's middle, in pixels (right, down).
    pub const fn principal_point_px(&self) -> [f64; 2] {
        self.principal_point_px
    }

    /// Distance of the plane in focus in scene units; `None` for a pinhole.
    pub fn focus_distance(&self) -> Option<f64> {
        self.aperture.map(|aperture| aperture.focus_distance)
    }

    /// Full horizontal and vertical angle of view in degrees.
    pub fn field_of_view_deg(&self) -> [f64; 2] {
        self.half_extent.map(|h| 2.0 * h.atan().to_degrees())
    }

    /// The same camera with another number of pixels of the same shape; the picture's width
    /// stays, its height follows the new aspect.
    #[must_use]
    pub fn with_resolution(&self, resolution: [u32; 2]) -> Self {
        let [width, height] = resolution.map(f64::from);
        let scale = width / f64::from(self.resolution[0]);
        let taller = height / (scale * f64::from(self.resolution[1]));
        let mut camera = self.clone();
        camera.resolution = resolution;
        camera.half_extent[1] = self.half_extent[1] * taller;
        camera.principal_point_px = self.principal_point_px.map(|p| p * scale);
        camera
    }

    /// The same camera with a part of its picture: `width` by `height` pixels from the one in
    /// column `x` and row `y` on; `None` where that is empty or reaches outside.
    pub fn cropped(&self, [x, y, width, height]: [u32; 4]) -> Option<Self> {
        let corner = [x, y].map(f64::from);
        let (whole, part) = (self.resolution, [width, height]);
        for axis in 0..2 {
            let end = [x, y][axis].checked_add(part[axis])?;
            if part[axis] == 0 || end > whole[axis] {
                return None;
            }
        }
        let mut camera = self.clone();
        for axis in 0..2 {
            let [whole, part] = [whole[axis], part[axis]].map(f64::from);
            camera.half_extent[axis] *= part / whole;
            camera.principal_point_px[axis] += 0.5 * (whole - part) - corner[axis];
        }
        camera.resolution = part;
        camera.crop = Some(Crop { whole, corner: [x, y] });
        Some(camera)
    }

    /// Of which picture this one is a part, if of any.
    pub const fn crop(&self) -> Option<Crop> {
        self.crop
    }

    /// The ray through a picture position in pixels (from the top left corner) and, with an
    /// aperture, through the point of the lens that `u_lens` in [0, 1)^2 names.
    pub fn ray(&self, pixel: [f64; 2], u_lens: [f32; 2]) -> Ray {
        let through = self.through(pixel);
        let position = self.placement.position;
        let Some(aperture) = self.aperture else {
            return Ray::new(vec3a(position), vec3a(through.normalize()));
        };
        let offset = self.lens_offset(&aperture, u_lens);
        let direction = (through * aperture.focus_distance - offset).normalize();
        Ray::new(vec3a(position + offset), vec3a(direction))
    }

    /// The ray from a point of the lens that is recorded at a picture position in pixels.
    pub fn ray_from(&self, lens_point: Vec3A, pixel: [f64; 2]) -> Ray {
        let through = self.through(pixel);
        let offset = lens_point.as_dvec3() - self.placement.position;
        let direction = self.aperture.map_or(through, |aperture| through * aperture.focus_distance - offset);
        Ray::new(lens_point, vec3a(direction.normalize()))
    }

    /// From the centre of the lens to a picture position, at distance one along the axis.
    fn through(&self, pixel: [f64; 2]) -> DVec3 {
        let CameraPlacement { forward, right, up, .. } = self.placement;
        let [width, height] = self.resolution.map(f64::from);
        let x = 2.0 * (pixel[0] - self.principal_point_px[0]) / width - 1.0;
        let y = 1.0 - 2.0 * (pixel[1] - self.principal_point_px[1]) / height;
        forward + right * (x * self.half_extent[0]) + up * (y * self.half_extent[1])
    }

    /// The point of the lens that `u_lens` in [0, 1)^2 names, uniform over its area; the
    /// pinhole where there is none.
    pub fn lens_point(&self, u_lens: [f32; 2]) -> SurfacePoint {
        let offset = self.aperture.map_or(DVec3::ZERO, |aperture| self.lens_offset(&aperture, u_lens));
        self.point_at(vec3a(self.placement.position + offset))
    }

    /// The numbers that name a point of the lens, of which `point` (in scene units) may be off
    /// by a rounding; 0.5 for a pinhole, where they decide nothing.
    pub fn invert_lens(&self, point: Vec3A) -> [f32; 2] {
        let Some(aperture) = self.aperture else { return [ANY; 2] };
        let offset = (point.as_dvec3() - self.placement.position) / aperture.radius;
        square_of_disk([offset.dot(self.placement.right), offset.dot(self.placement.up)])
    }

    /// A position on the lens as a point without error, facing the scene.
    pub fn point_at(&self, position: Vec3A) -> SurfacePoint {
        SurfacePoint { position, error: Vec3A::ZERO, normal: vec3a(self.placement.forward) }
    }

    fn lens_offset(&self, aperture: &LensAperture, u_lens: [f32; 2]) -> DVec3 {
        let [x, y] = disk_point(u_lens).map(|c| c * aperture.radius);
        self.placement.right * x + self.placement.up * y
    }

    /// Density of a point of the lens per square scene unit; `None` for a pinhole.
    pub fn pdf_lens_area(&self) -> Option<f64> {
        self.aperture.map(|aperture| 1.0 / (std::f64::consts::PI * aperture.radius * aperture.radius))
    }

    /// Where in the picture light is recorded, in pixels, that arrives at a point of the lens
    /// from a direction (which points into the scene); `None` outside the picture.
    pub fn picture_position(&self, lens_point: Vec3A, direction: Vec3A) -> Option<[f64; 2]> {
        let CameraPlacement { position, forward, right, up } = self.placement;
        let direction = direction.as_dvec3();
        let along = direction.dot(forward);
        if along <= 0.0 {
            return None;
        }
        // The point of the plane in focus, or of the plane at distance one.
        let (offset, distance) = match self.aperture {
            Some(aperture) => (lens_point.as_dvec3() - position, aperture.focus_distance),
            None => (DVec3::ZERO, 1.0),
        };
        let slope = direction / along + offset / distance;
        let [width, height] = self.resolution.map(f64::from);
        let x = (slope.dot(right) / self.half_extent[0] + 1.0) * 0.5 * width + self.principal_point_px[0];
        let y = (1.0 - slope.dot(up) / self.half_extent[1]) * 0.5 * height + self.principal_point_px[1];
        ((0.0..width).contains(&x) && (0.0..height).contains(&y)).then_some([x, y])
    }

    /// Density in sr^-1 of a direction into the scene when positions are uniform over the
    /// whole picture: 1 / (A cos^3) for a picture of area A at distance one.
    pub fn pdf_solid_angle(&self, direction: Vec3A) -> f64 {
        let cosine = direction.as_dvec3().dot(self.placement.forward);
        let area = 4.0 * self.half_extent[0] * self.half_extent[1];
        if cosine > 0.0 { 1.0 / (area * cosine * cosine * cosine) } else { 0.0 }
    }

    /// Where a ray meets the front of the lens, and how far away; never for a pinhole.
    pub fn meet_lens(&self, ray: &Ray) -> Option<(SurfacePoint, f32)> {
        let aperture = self.aperture?;
        let direction = ray.direction.as_dvec3();
        let span = self.placement.position - ray.origin.as_dvec3();
        let approach = direction.dot(self.placement.forward);
        let distance = span.dot(self.placement.forward) / approach;
        let offset = direction * distance - span;
        let meets = approach < 0.0 && distance > 0.0 && offset.length_squared() < aperture.radius.powi(2);
        meets.then(|| (self.point_at(vec3a(self.placement.position + offset)), distance as f32))
    }
}

fn vec3a(v: DVec3) -> Vec3A {
    v.as_vec3a()
}

/// Uniform point of the unit disk by the concentric map (Shirley and Chiu 1997).
fn disk_point(u: [f32; 2]) -> [f64; 2] {
    use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};
    let [a, b] = u.map(|v| 2.0 * f64::from(v) - 1.0);
    if a == 0.0 && b == 0.0 {
        return [0.0, 0.0];
    }
    let (radius, angle) =
        if a.abs() > b.abs() { (a, FRAC_PI_4 * (b / a)) } else { (b, FRAC_PI_2 - FRAC_PI_4 * (a / b)) };
    [radius * angle.cos(), radius * angle.sin()]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera(aperture: Option<LensAperture>) -> Camera {
        let placement = CameraPlacement {
            position: DVec3::new(0.25, 0.5, -1.0),
            forward: DVec3::Z,
            right: DVec3::NEG_X,
            up: DVec3::Y,
        };
        Camera::new(placement, [40, 20], [0.5, 0.25], [0.0, 0.0], aperture)
    }

    #[test]
    fn all_rays_of_a_pixel_meet_in_the_plane_of_focus() {
        let focused = camera(Some(LensAperture { radius: 0.05, focus_distance: 2.0 }));
        let centre = camera(None).ray([7.3, 12.9], [0.0; 2]);
        let target = centre.origin + centre.direction * (2.0 / centre.direction.z);
        for i in 0..64_u8 {
            let u = [f32::from(i % 8) / 8.0, f32::from(i / 8) / 8.0];
            let ray = focused.ray([7.3, 12.9], u);
            let met = ray.origin + ray.direction * ((target.z - ray.origin.z) / ray.direction.z);
            assert!((met - target).length() < 1e-5, "{met} against {target}");
        }
    }

    #[test]
    fn light_is_recorded_where_its_ray_was_drawn() {
        for aperture in [None, Some(LensAperture { radius: 0.05, focus_distance: 2.0 })] {
            let camera = Camera { principal_point_px: [1.5, -0.5], ..camera(aperture) };
            for (x, y, u) in [(0.5, 0.5, [0.1, 0.9]), (39.5, 3.25, [0.7, 0.4]), (17.0, 19.9, [0.5, 0.01])] {
                let ray = camera.ray([x, y], u);
                let [px, py] = camera.picture_position(ray.origin, ray.direction).expect("in the picture");
                assert!((px - x).abs() < 1e-4 && (py - y).abs() < 1e-4, "{px} {py} against {x} {y}");
            }
        }
    }

    /// The mean of 1/p over directions drawn with density p is the picture's solid angle: for
    /// a centred picture 4 asin(sin a sin b) with half angles a, b of its sides' planes.
    #[test]
    fn directions_fall_as_densely_as_they_say() {
        let camera = camera(None);
        let (mut sum, mut count) = (0.0, 0.0);
        for row in 0..200 {
            for column in 0..400 {
                let place = [(f64::from(column) + 0.5) * 0.1, (f64::from(row) + 0.5) * 0.1];
                sum += 1.0 / camera.pdf_solid_angle(camera.ray(place, [0.0; 2]).direction);
                count += 1.0;
            }
        }
        let [a, b] = camera.half_extent.map(f64::atan);
        let truth = 4.0 * (a.sin() * b.sin()).asin();
        assert!((sum / count / truth - 1.0).abs() < 1e-5, "{} against {truth}", sum / count);
    }

    #[test]
    fn a_part_of_the_picture_sees_what_the_whole_sees_there() {
        let whole = Camera { principal_point_px: [1.5, -0.5], ..camera(None) };
        let part = whole.cropped([3, 7, 5, 11]).expect("inside");
        assert_eq!(part.resolution(), [5, 11]);
        for (x, y) in [(0.25, 0.5), (4.9, 10.1), (2.5, 3.75)] {
            let (ours, theirs) =
                (part.ray([x, y], [0.0; 2]).direction, whole.ray([x + 3.0, y + 7.0], [0.0; 2]).direction);
            assert!((ours - theirs).length() < 1e-6, "{ours} against {theirs}");
        }
        assert!(whole.cropped([0, 0, 40, 20]).is_some());
        for outside in [[0, 0, 41, 20], [39, 0, 2, 1], [0, 19, 1, 2], [3, 3, 0, 1], [u32::MAX, 0, 1, 1]] {
            assert!(whole.cropped(outside).is_none(), "{outside:?}");
        }
    }

    #[test]
    fn another_resolution_keeps_the_shape_of_a_pixel() {
        let oblong = Camera { half_extent: [0.5, 0.3], ..camera(None) };
        assert_eq!(oblong.with_resolution([40, 20]).half_extent, [0.5, 0.3]);
        assert_eq!(oblong.with_resolution([80, 80]).half_extent, [0.5, 0.6]);
    }

    #[test]
    fn corners_span_the_field_of_view() {
        let ray = camera(None).ray([0.0, 0.0], [0.0; 2]);
        let slope = ray.direction / ray.direction.z;
        // Top left: to the left is +x for a camera whose right is -x.
        assert!((slope.x - 0.5).abs() < 1e-6 && (slope.y - 0.25).abs() < 1e-6);
    }
}
