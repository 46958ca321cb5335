//! Light paths: the one representation that all integrators share.
//!
//! A complete path's vertices are numbered from the light. It is made of two subpaths by a
//! strategy ([`Strategies`]); each vertex ([`Vertex`]) keeps the density with which either end
//! reaches it, per area, so that strategies are weighed in one place (`weights`).

mod connect;
mod contribution;
mod eye;
mod fate;
mod forgetful;
mod groups;
mod joint;
mod media;
mod roulette;
mod source;
mod strategies;
mod vertex;
mod walk;
mod weights;
mod whole;

pub use connect::Joiner;
pub use contribution::{Contribution, End, Subpaths};
pub use eye::{Eye, EyeRay, Sight};
pub use fate::{BothFates, Fate, Fates};
pub use forgetful::needs_no_vertices;
pub use groups::{Groups, Shares};
pub use media::Media;
pub use roulette::Roulette;
pub use strategies::Strategies;
pub use vertex::{Kind, Surface, Vertex};
pub use walk::{Heading, TRAPPED_BOUNCES, Walker, transmittance};
pub use weights::{Density, Judged, Known, Lanes, Made};
pub use whole::Whole;
