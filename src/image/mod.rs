//! Pictures on disk: absolute values with their facts, and developed pictures.
//!
//! Files are written whole or not at all ([`write_whole`]): an interrupted or failed write leaves
//! what was there before.

pub mod checkpoint;
mod developed;
mod exif;
mod exr_file;
mod exr_read;
mod facts;
mod safely;
mod sheet;

pub use developed::{DEVELOPED_ENDINGS, write_developed, write_raw};
pub use exif::Label;
pub use exr_file::{FACTS_ATTRIBUTE, Layers, RESPONSES_ATTRIBUTE, write_exr};
pub use exr_read::{Rendered, parse_exr, read_exr, read_facts, read_levels};
pub use facts::{ErrorFacts, Facts, Projection, Stopping};
pub use safely::{Writer, write_text, write_whole};
pub use sheet::{Tile, write_sheet};
