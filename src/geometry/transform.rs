//! Affine transforms in double precision.

use super::ShapeError;
use glam::{DAffine3, DMat3, DVec3};

/// An affine transform from a shape's own coordinates to the world's, in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transform {
    affine: DAffine3,
}

/// How far from a similarity, relative to its scale, a matrix may be by rounding alone.
const SIMILARITY_SLACK: f64 = 1.0 / (1u64 << 40) as f64;

impl Default for Transform {
    fn default() -> Self {
        Self::IDENTITY
    }
}

impl Transform {
    /// Leaves everything where it is.
    pub const IDENTITY: Self = Self { affine: DAffine3::IDENTITY };

    /// Moves by `offset`.
    pub fn translate(offset: DVec3) -> Result<Self, ShapeError> {
        Self::checked(DAffine3::from_translation(offset))
    }

    /// Turns by `degrees` around `axis` (any length) through the origin, counter-clockwise
    /// seen against the axis. Multiples of 90 degrees around a coordinate axis are exact.
    pub fn rotate(axis: DVec3, degrees: f64) -> Result<Self, ShapeError> {
        if !(axis.is_finite() && degrees.is_finite()) {
            return Err(ShapeError::NotFinite { what: "the rotation" });
        }
        // Dividing by the largest component first keeps huge and tiny axes in range.
        let axis = (axis / axis.abs().max_element())
            .try_normalize()
            .ok_or(ShapeError::NoExtent { what: "the rotation axis" })?;
        let (sin, cos) = sin_cos_degrees(degrees);
        let cross = |v: DVec3| axis.cross(v) * sin + axis * axis.dot(v) * (1.0 - cos) + v * cos;
        let matrix = DMat3::from_cols(cross(DVec3::X), cross(DVec3::Y), cross(DVec3::Z));
        Self::checked(DAffine3::from_mat3(matrix))
    }

    /// Scales along the coordinate axes; negative factors mirror.
    pub fn scale(factors: DVec3) -> Result<Self, ShapeError> {
        Self::checked(DAffine3::from_scale(factors))
    }

    /// The transform of a matrix given by its three rows of four: `x' = rows * (x, 1)`.
    pub fn matrix(rows: [[f64; 4]; 3]) -> Result<Self, ShapeError> {
        let column = |i: usize| DVec3::new(rows[0][i], rows[1][i], rows[2][i]);
        Self::checked(DAffine3 {
            matrix3: DMat3::from_cols(column(0), column(1), column(2)),
            translation: column(3),
        })
    }

    /// This transform first, `next` after it.
    pub fn then(&self, next: &Self) -> Result<Self, ShapeError> {
        Self::checked(next.affine * self.affine)
    }

    /// All transforms of a list, the first one applied first.
    pub fn in_order(list: &[Self]) -> Result<Self, ShapeError> {
        list.iter().try_fold(Self::IDENTITY, |so_far, next| so_far.then(next))
    }

    /// Where a point goes.
    #[inline]
    pub fn point(&self, point: DVec3) -> DVec3 {
        self.affine.transform_point3(point)
    }

    /// Where a displacement goes.
    #[inline]
    pub fn vector(&self, vector: DVec3) -> DVec3 {
        self.affine.transform_vector3(vector)
    }

    /// The direction across a surface whose normal was `normal`; not of unit length.
    #[inline]
    pub fn normal(&self, normal: DVec3) -> DVec3 {
        // The cofactor matrix: the inverse transpose times the determinant, whose sign is
        // taken out again so that a mirror keeps the side.
        let DMat3 { x_axis: x, y_axis: y, z_axis: z } = self.affine.matrix3;
        let cofactor = y.cross(z) * normal.x + z.cross(x) * normal.y + x.cross(y) * normal.z;
        if self.mirrors() { -cofactor } else { cofactor }
    }

    /// Whether the transform turns left hands into right ones.
    #[inline]
    pub fn mirrors(&self) -> bool {
        self.affine.matrix3.determinant() < 0.0
    }

    /// The factor by which all lengths grow; `None` when directions differ.
    pub fn similarity(&self) -> Option<f64> {
        let DMat3 { x_axis: x, y_axis: y, z_axis: z } = self.affine.matrix3;
        let square = x.length_squared();
        let slack = SIMILARITY_SLACK * square;
        let equal =
            (y.length_squared() - square).abs() <= slack && (z.length_squared() - square).abs() <= slack;
        let right = x.dot(y).abs().max(y.dot(z).abs()).max(z.dot(x).abs()) <= slack;
        (equal && right).then(|| square.sqrt())
    }

    fn checked(affine: DAffine3) -> Result<Self, ShapeError> {
        if !affine.is_finite() {
            return Err(ShapeError::NotFinite { what: "the transform" });
        }
        if affine.matrix3.determinant() == 0.0 {
            return Err(ShapeError::Singular);
        }
        Ok(Self { affine })
    }
}

/// Sine and cosine, exact at multiples of a right angle.
fn sin_cos_degrees(degrees: f64) -> (f64, f64) {
    let degrees = degrees.rem_euclid(360.0);
    if degrees == 0.0 {
        (0.0, 1.0)
    } else if degrees == 90.0 {
        (1.0, 0.0)
    } else if degrees == 180.0 {
        (0.0, -1.0)
    } else if degrees == 270.0 {
        (-1.0, 0.0)
    } else {
        degrees.to_radians().sin_cos()
    }
}
