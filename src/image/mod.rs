//! Pictures on disk: absolute values with their facts, and developed pictures.
//!
//! Files are written under a temporary name and renamed when whole, so that an interrupted
//! or failed write leaves what was there before.

mod developed;
mod exif;
mod exr_file;
mod exr_read;
mod facts;
mod sheet;

pub use developed::{DEVELOPED_ENDINGS, write_developed, write_raw};
pub use exif::Label;
pub use exr_file::{FACTS_ATTRIBUTE, Layers, RESPONSES_ATTRIBUTE, write_exr};
pub use exr_read::{Rendered, parse_exr, read_exr, read_levels};
pub use facts::Facts;
pub use sheet::{Tile, write_sheet};

use crate::error::{Error, Result};
use std::path::Path;

/// Writes through a temporary file beside `path`, renamed into place on success.
fn write_whole(path: &Path, write: impl FnOnce(&Path) -> std::result::Result<(), String>) -> Result<()> {
    let name = path.file_name().ok_or_else(|| Error::new("the output path names no file").in_file(path))?;
    let temporary = path.with_file_name(format!(".{}.{}.part", name.to_string_lossy(), std::process::id()));
    let written =
        write(&temporary).and_then(|()| std::fs::rename(&temporary, path).map_err(|e| e.to_string()));
    written.map_err(|reason| {
        // Nothing more can be done about a leftover that cannot be removed either.
        let _ = std::fs::remove_file(&temporary);
        Error::new(format!("cannot write the picture: {reason}"))
            .hint("check that the folder exists and has room")
            .in_file(path)
    })
}
