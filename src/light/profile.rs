//! A lamp's measured light distribution about an axis: relative intensity at angles.
//!
//! Intensity is linear in the angle between the tabulated ones, as photometric files are
//! read, and zero beyond them. Flux within an angle then has a closed form, which gives the
//! flux, the density and, solved for the angle, the samples.

use crate::error::{Error, Result};
use glam::{DVec3, Vec3A};
use std::f64::consts::{PI, TAU};

/// Intensity about an axis, relative to its largest value.
#[derive(Clone, Debug, PartialEq)]
pub struct Profile {
    axis: DVec3,
    /// Angles from the axis in radians, rising.
    angles: Vec<f64>,
    /// Relative intensity at each angle, at most 1.
    intensities: Vec<f64>,
    /// Flux within each angle over the largest intensity, in sr.
    within_sr: Vec<f64>,
}

impl Profile {
    /// A profile about a unit axis from relative intensities, on any scale, at angles in
    /// degrees.
    ///
    /// # Errors
    /// Where the lists differ in length, angles do not rise within 0 to 180 degrees, an
    /// intensity is negative or not finite, or all are zero.
    pub fn new(axis: DVec3, angles_deg: &[f64], relative_intensity: &[f64]) -> Result<Self> {
        let example = "for example angles_deg [0, 45, 90] and relative_intensity [1, 0.7, 0]";
        let refuse = |what: String, key: &str| Err(Error::new(what).hint(example).under(key));
        if angles_deg.len() != relative_intensity.len() || angles_deg.len() < 2 {
            let (angles, values) = (angles_deg.len(), relative_intensity.len());
            return refuse(format!("{angles} angles and {values} intensities"), "relative_intensity");
        }
        let rises = angles_deg.windows(2).all(|pair| pair[0] < pair[1]);
        if !rises || !angles_deg.iter().all(|angle| (0.0..=180.0).contains(angle)) {
            return refuse("angles that do not rise within 0 to 180 degrees".to_owned(), "angles_deg");
        }
        if let Some(value) = relative_intensity.iter().find(|value| !(**value >= 0.0 && value.is_finite())) {
            return refuse(format!("an intensity of {value}"), "relative_intensity");
        }
        let largest = relative_intensity.iter().fold(0.0, |a: f64, b| a.max(*b));
        let angles: Vec<f64> = angles_deg.iter().map(|angle| angle.to_radians()).collect();
        let intensities: Vec<f64> = relative_intensity.iter().map(|value| value / largest).collect();
        let mut profile = Self { axis, within_sr: vec![0.0], angles, intensities };
        for index in 1..profile.angles.len() {
            let up_to = profile.within_sr[index - 1] + profile.flux_from(index - 1, profile.angles[index]);
            profile.within_sr.push(up_to);
        }
        if largest > 0.0 && profile.solid_angle_sr() > 0.0 {
            return Ok(profile);
        }
        refuse("a profile that is dark everywhere".to_owned(), "relative_intensity")
    }

    /// The axis, a unit vector.
    pub const fn axis(&self) -> DVec3 {
        self.axis
    }

    /// Flux over largest intensity, in sr.
    pub fn solid_angle_sr(&self) -> f64 {
        self.within_sr.last().copied().unwrap_or(0.0)
    }

    /// Intensity in a direction relative to the largest.
    pub fn towards(&self, direction: Vec3A) -> f32 {
        let angle = self.angle_of(direction);
        self.interval(angle).map_or(0.0, |index| {
            let (at_axis, slope) = self.line(index);
            (at_axis + slope * angle).clamp(0.0, 1.0) as f32
        })
    }

    /// The angle from the axis within which the share `u` of the flux lies.
    pub(super) fn angle_at(&self, u: f64) -> f64 {
        let target = u * self.solid_angle_sr();
        let last = self.angles.len() - 2;
        let index = self.within_sr.partition_point(|within| *within <= target).saturating_sub(1).min(last);
        let (mut low, mut high) = (self.angles[index], self.angles[index + 1]);
        // Bisection to the last bit of f32: flux rises with the angle, and Newton's steps would
        // divide by an intensity that may be zero.
        for _ in 0..30 {
            let middle = 0.5 * (low + high);
            if self.within_sr[index] + self.flux_from(index, middle) <= target {
                low = middle;
            } else {
                high = middle;
            }
        }
        0.5 * (low + high)
    }

    /// The share of the flux within the angle of a direction; `None` where it is dark.
    pub(super) fn share_within(&self, direction: Vec3A) -> Option<f64> {
        let angle = self.angle_of(direction);
        let index = self.interval(angle)?;
        let (at_axis, slope) = self.line(index);
        let share = (self.within_sr[index] + self.flux_from(index, angle)) / self.solid_angle_sr();
        (at_axis + slope * angle > 0.0).then_some(share)
    }

    /// Angle of a direction from the axis, exact near the poles where the arc cosine is not.
    fn angle_of(&self, direction: Vec3A) -> f64 {
        let direction = direction.as_dvec3();
        self.axis.cross(direction).length().atan2(self.axis.dot(direction))
    }

    /// The interval of the table that holds an angle.
    fn interval(&self, angle: f64) -> Option<usize> {
        let above = self.angles.partition_point(|a| *a <= angle);
        let last = self.angles.len() - 1;
        match above {
            0 => None,
            // The last angle belongs to the table; pi itself may come out a rounding above.
            _ if above > last => (angle <= self.angles[last] || self.angles[last] >= PI).then(|| last - 1),
            _ => Some(above - 1),
        }
    }

    /// Intercept and slope per radian of the intensity in an interval.
    fn line(&self, index: usize) -> (f64, f64) {
        let slope = (self.intensities[index + 1] - self.intensities[index])
            / (self.angles[index + 1] - self.angles[index]);
        (self.intensities[index] - slope * self.angles[index], slope)
    }

    /// Flux between the start of an interval and an angle in it, in sr: 2 pi times the integral
    /// of (a + b t) sin t, which is b sin t - (a + b t) cos t.
    fn flux_from(&self, index: usize, angle: f64) -> f64 {
        let (a, b) = self.line(index);
        let antiderivative = |t: f64| b * t.sin() - (a + b * t) * t.cos();
        TAU * (antiderivative(angle) - antiderivative(self.angles[index]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Closed forms: uniform 4 pi; a hemisphere 2 pi; a cone that falls linearly from 1 at the
    /// axis to 0 at a has 2 pi (1 - sin(a) / a).
    #[test]
    fn flux_has_its_closed_form() {
        let flux = |angles: &[f64], values: &[f64]| {
            Profile::new(DVec3::Y, angles, values).expect("a sound profile").solid_angle_sr()
        };
        assert!((flux(&[0.0, 180.0], &[3.0, 3.0]) / (4.0 * PI) - 1.0).abs() < 1e-14);
        assert!((flux(&[0.0, 50.0, 90.0], &[1.0, 1.0, 1.0]) / TAU - 1.0).abs() < 1e-14);
        let a = 40_f64.to_radians();
        assert!((flux(&[0.0, 40.0], &[2.0, 0.0]) / (TAU * (1.0 - a.sin() / a)) - 1.0).abs() < 1e-13);
    }

    #[test]
    fn angles_and_shares_of_the_flux_are_inverse() {
        let profile = Profile::new(DVec3::Z, &[10.0, 30.0, 31.0, 120.0], &[0.0, 1.0, 0.2, 0.0])
            .expect("a sound profile");
        for step in 1..200 {
            let u = f64::from(step) / 200.0;
            let angle = profile.angle_at(u);
            let direction = DVec3::new(angle.sin(), 0.0, angle.cos()).as_vec3a();
            let share = profile.share_within(direction).expect("not dark");
            assert!((share - u).abs() < 2e-6, "{share} for {u}");
        }
        assert_eq!(profile.share_within(Vec3A::Z), None);
        assert_eq!(profile.share_within(Vec3A::NEG_Z), None);
    }

    #[test]
    fn senseless_profiles_are_refused() {
        for (angles, values) in [
            (&[0.0, 90.0][..], &[1.0][..]),
            (&[0.0], &[1.0]),
            (&[0.0, 0.0], &[1.0, 1.0]),
            (&[0.0, 181.0], &[1.0, 1.0]),
            (&[0.0, f64::NAN], &[1.0, 1.0]),
            (&[0.0, 90.0], &[1.0, -0.1]),
            (&[0.0, 90.0], &[0.0, 0.0]),
            (&[0.0, 90.0], &[1.0, f64::INFINITY]),
        ] {
            assert!(Profile::new(DVec3::Z, angles, values).is_err(), "{angles:?} {values:?}");
        }
    }
}
