//! Pictures on disk: absolute values with their facts, and developed pictures.
//!
//! Files are written whole or not at all ([`write_whole`]): an interrupted or failed write leaves
//! what was there before.

#[cfg(feature = "checkpoints")]
pub mod checkpoint;
#[cfg(feature = "pictures")]
mod developed;
#[cfg(feature = "pictures")]
mod exif;
#[cfg(feature = "exr")]
mod exr_file;
#[cfg(feature = "exr")]
mod exr_read;
mod facts;
mod levels;
#[cfg(feature = "exr")]
mod luminance;
mod safely;
#[cfg(feature = "pictures")]
mod sheet;
#[cfg(feature = "exr")]
mod stated;
#[cfg(feature = "pictures")]
mod z_map;

#[cfg(feature = "pictures")]
pub use developed::{DEVELOPED_ENDINGS, write_developed, write_raw};
#[cfg(feature = "pictures")]
pub use exif::Label;
#[cfg(feature = "exr")]
pub use exr_file::{FACTS_ATTRIBUTE, Layers, RESPONSES_ATTRIBUTE, write_exr};
#[cfg(feature = "exr")]
pub use exr_read::{Rendered, parse_exr, read_exr, read_facts};
pub use facts::{ErrorFacts, Facts, Projection, Stopping};
pub use levels::read_levels;
#[cfg(feature = "exr")]
pub use luminance::{LuminancePicture, Unit, read_luminance};
pub use safely::{Writer, write_text, write_whole};
#[cfg(feature = "pictures")]
pub use sheet::{Tile, write_sheet};
#[cfg(feature = "exr")]
pub use stated::{Spent, Stated, Times};
#[cfg(feature = "pictures")]
pub use z_map::write_z_map;
