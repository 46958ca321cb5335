//! Cones of normals: all that the hierarchy of lights knows about where its lights face.

use glam::DVec3;
use std::f64::consts::PI;

/// The directions within an angle from an axis; perhaps those opposite as well.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Cone {
    /// Unit vector.
    pub axis: DVec3,
    /// Greatest angle from the axis, up to pi.
    pub half_angle: f64,
    /// Whether the opposite directions belong to it too, as for lights with two sides.
    pub both_ways: bool,
}

/// Axes closer than this to opposite leave no plane to turn in: their cone is all directions.
const OPPOSITE: f64 = 1e-6;

impl Cone {
    /// All directions.
    pub const ALL: Self = Self { axis: DVec3::Z, half_angle: PI, both_ways: false };

    /// A single direction, a unit vector; perhaps its opposite as well.
    pub const fn along(axis: DVec3, both_ways: bool) -> Self {
        Self { axis, half_angle: 0.0, both_ways }
    }

    /// A cone around both, the narrowest where neither is taken both ways (Conty Estevez and
    /// Kulla 2018, algorithm 1).
    pub fn union(&self, other: &Self) -> Self {
        let both_ways = self.both_ways || other.both_ways;
        let (wide, mut narrow) =
            if self.half_angle >= other.half_angle { (self, *other) } else { (other, *self) };
        if wide.half_angle >= PI {
            return Self::ALL;
        }
        if both_ways && wide.axis.dot(narrow.axis) < 0.0 {
            narrow.axis = -narrow.axis;
        }
        // Half angles by their tangents keep small ones exact, where an arc cosine does not.
        let between = 2.0 * (wide.axis - narrow.axis).length().atan2((wide.axis + narrow.axis).length());
        if between + narrow.half_angle <= wide.half_angle {
            return Self { both_ways, ..*wide };
        }
        let half_angle = 0.5 * (wide.half_angle + between + narrow.half_angle);
        if half_angle >= PI || between > PI - OPPOSITE {
            return Self::ALL;
        }
        let turn = half_angle - wide.half_angle;
        let axis = wide.axis * (between - turn).sin() + narrow.axis * turn.sin();
        Self { axis: axis.normalize(), half_angle, both_ways }
    }

    /// Mean of the directions: the shorter, the wider the cone; zero where it is taken both
    /// ways or holds all.
    pub fn mean(&self) -> DVec3 {
        if self.both_ways { DVec3::ZERO } else { self.axis * (0.5 * (1.0 + self.half_angle.cos())) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn holds(cone: &Cone, direction: DVec3) -> bool {
        let cosine = cone.axis.dot(direction);
        let cosine = if cone.both_ways { cosine.abs() } else { cosine };
        cosine.clamp(-1.0, 1.0).acos() <= cone.half_angle + 1e-7
    }

    #[test]
    fn a_union_holds_both_and_is_no_wider_than_it_must_be() {
        let along = |x: f64, y: f64, z: f64| Cone::along(DVec3::new(x, y, z).normalize(), false);
        let right_angle = along(1.0, 0.0, 0.0).union(&along(0.0, 1.0, 0.0));
        assert!((right_angle.half_angle - PI / 4.0).abs() < 1e-12);
        assert!(holds(&right_angle, DVec3::X) && holds(&right_angle, DVec3::Y));
        let three = right_angle.union(&along(0.0, 0.0, 1.0));
        assert!([DVec3::X, DVec3::Y, DVec3::Z].iter().all(|d| holds(&three, *d)) && three.half_angle < 1.2);
        assert_eq!(three.union(&along(1.0, 1.0, 1.0)), three);
        assert_eq!(along(0.0, 0.0, 1.0).union(&along(0.0, 0.0, -1.0)), Cone::ALL);
        let same = along(1.0, 2.0, 3.0);
        assert_eq!(same.union(&same), same);
        let near = same.union(&along(1.0, 2.0, 3.0 + 1e-12));
        assert!(near.axis.is_finite() && near.half_angle < 1e-11);
    }

    #[test]
    fn opposite_sides_of_a_lamp_are_one_axis() {
        let cone = Cone::along(DVec3::Z, true).union(&Cone::along(-DVec3::Z, false));
        assert_eq!((cone.half_angle, cone.both_ways), (0.0, true));
        assert!(holds(&cone, DVec3::Z) && holds(&cone, -DVec3::Z) && !holds(&cone, DVec3::X));
    }

    #[test]
    fn the_mean_of_a_half_space_is_half_way_along_its_axis() {
        let half_space = Cone { half_angle: PI / 2.0, ..Cone::along(DVec3::X, false) };
        assert!((half_space.mean() - DVec3::X * 0.5).length() < 1e-12);
        assert_eq!(Cone::along(DVec3::Y, false).mean(), DVec3::Y);
        assert_eq!((Cone::along(DVec3::Y, true).mean(), Cone::ALL.mean()), (DVec3::ZERO, DVec3::ZERO));
    }
}
