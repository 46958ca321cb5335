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
mod safely;
#[cfg(feature = "pictures")]
mod sheet;

#[cfg(feature = "pictures")]
pub use developed::{DEVELOPED_ENDINGS, write_developed, write_raw};
#[cfg(feature = "pictures")]
pub use exif::Label;
#[cfg(feature = "exr")]
pub use exr_file::{FACTS_ATTRIBUTE, Layers, RESPONSES_ATTRIBUTE, write_exr};
#[cfg(feature = "exr")]
pub use exr_read::{Rendered, parse_exr, read_exr, read_facts};
pub use facts::{Facts, Stopping};
pub use levels::read_levels;
pub use safely::{Writer, write_text, write_whole};
#[cfg(feature = "pictures")]
pub use sheet::{Tile, write_sheet};
