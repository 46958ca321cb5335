//! Lights taken together: where they are, where they face, how brightly they shine.

use super::cone::Cone;
use crate::geometry::Bounds;

/// A light as the hierarchy sees it, or several as one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Cluster {
    /// A box around all that shines.
    pub bounds: Bounds,
    /// The normals of what shines.
    pub normals: Cone,
    /// Sum of the lights' largest intensities, in the unit of their power per sr.
    pub intensity: f64,
}

impl Cluster {
    /// Both together.
    pub fn union(&self, other: &Self) -> Self {
        Self {
            bounds: self.bounds.union(&other.bounds),
            normals: self.normals.union(&other.normals),
            intensity: self.intensity + other.intensity,
        }
    }
}
