//! What can be wrong with a described shape or a mesh file.

use std::path::PathBuf;
use thiserror::Error;

/// Why a shape cannot be built.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum ShapeError {
    /// A coordinate, length or matrix entry is NaN or infinite.
    #[error("{what} must be finite")]
    NotFinite {
        /// The quantity.
        what: &'static str,
    },
    /// A size that must be positive is not.
    #[error("{what} must be positive, but is {value}")]
    NotPositive {
        /// The quantity.
        what: &'static str,
        /// What was given.
        value: f64,
    },
    /// A surface or vector without extent.
    #[error("{what} has no extent")]
    NoExtent {
        /// The thing.
        what: &'static str,
    },
    /// The corners of a quad cross over.
    #[error("the sides of the quad cross each other; give its vertices in order around it")]
    CrossedQuad,
    /// A curved shape under a transform that would bend it out of its kind.
    #[error(
        "a {shape} stays a {shape} only under rotation, translation, mirroring and uniform \
         scale; use a mesh instead"
    )]
    NotASimilarity {
        /// The kind of shape.
        shape: &'static str,
    },
    /// A transform that flattens space.
    #[error("the transform flattens space: its determinant is zero")]
    Singular,
    /// A triangle names a vertex that does not exist.
    #[error("triangle {triangle} names vertex {index}, but there are only {vertices} vertices")]
    NoSuchVertex {
        /// Index of the triangle, from 0.
        triangle: usize,
        /// The vertex it names, from 0.
        index: u32,
        /// How many there are.
        vertices: usize,
    },
    /// As many normals as vertices are needed.
    #[error("the mesh has {vertices} vertices but {normals} normals")]
    NormalCount {
        /// Number of vertices.
        vertices: usize,
        /// Number of normals.
        normals: usize,
    },
    /// Nothing is left of a shape at the precision of the scene.
    #[error("object {object} is too small beside the rest of the scene to be represented")]
    Vanishes {
        /// The object.
        object: u32,
    },
    /// More than `u32` can number.
    #[error("the scene has more primitives than can be numbered")]
    TooMany,
}

/// Why a mesh file cannot be read.
#[derive(Debug, Error)]
#[error("{}{}{}: {what}", file.display(), after_colon(*line), after_colon(*column))]
pub struct MeshFileError {
    /// The file.
    pub file: PathBuf,
    /// Line number from 1, where it is known.
    pub line: Option<usize>,
    /// Column from 1, in characters, where it is known.
    pub column: Option<usize>,
    /// What is wrong.
    pub what: MeshFault,
}

fn after_colon(number: Option<usize>) -> String {
    number.map(|n| format!(":{n}")).unwrap_or_default()
}

/// What is wrong with a mesh file.
#[derive(Debug, Error)]
pub enum MeshFault {
    /// The file holds another one, packed.
    #[error("the file is packed ({0})")]
    Packed(&'static str),
    /// The text or structure does not follow the format.
    #[error("{0}")]
    Syntax(String),
    /// A count that the rest of the file is too short for.
    #[error("{count} {what} are announced, but the file has room for at most {room}")]
    Count {
        /// What is counted.
        what: String,
        /// The announced number.
        count: usize,
        /// The number that fits.
        room: usize,
    },
    /// A face names a vertex that does not exist.
    #[error("the face names vertex {index}, but there are {vertices} vertices")]
    NoSuchVertex {
        /// The index as written.
        index: i64,
        /// How many there are.
        vertices: usize,
    },
    /// A normal without direction.
    #[error("a normal of zero length points nowhere")]
    NoDirection,
    /// A coordinate is NaN or infinite.
    #[error("a coordinate is not finite")]
    NotFinite,
    /// The file holds no face.
    #[error("the file holds no face")]
    Empty,
}

impl MeshFault {
    /// What to do about it.
    pub const fn remedy(&self) -> &'static str {
        match self {
            Self::Packed(_) => "unpack it and name the file that was inside",
            Self::Count { .. } => "the file is cut short or its header wrong; write it anew",
            Self::NoDirection => "compute the normals anew, or write the mesh without them",
            Self::Empty => "check the mesh, or write it anew with its faces",
            Self::Syntax(_) | Self::NoSuchVertex { .. } | Self::NotFinite => {
                "check the mesh, or write it anew"
            }
        }
    }
}
