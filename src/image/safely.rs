//! Files are written whole or not at all: under another name in the same folder, forced onto the
//! disk, and only then renamed.
//!
//! Whatever goes wrong on the way, a full disk or an end of the process, the file that was there
//! before is still there. Only a process that is killed leaves its unfinished file behind.

use crate::error::{Error, Result};
use std::fs::File;
use std::io::{BufWriter, Write as _};
use std::path::Path;

/// Where a file is being written.
pub type Writer = BufWriter<File>;

/// Writes a file whole; `what` it is stands in the error.
///
/// # Errors
/// Where `write` fails, or the disk does; nothing is left of the attempt.
pub fn write_whole(
    path: &Path,
    what: &str,
    write: impl FnOnce(&mut Writer) -> std::result::Result<(), String>,
) -> Result<()> {
    let name = path.file_name().ok_or_else(|| Error::new("the output path names no file").in_file(path))?;
    let temporary = path.with_file_name(format!(".{}.{}.part", name.to_string_lossy(), std::process::id()));
    let written = write_through(&temporary, write)
        .and_then(|()| std::fs::rename(&temporary, path).map_err(|e| e.to_string()));
    written.map_err(|reason| {
        // Nothing more can be done about a leftover that cannot be removed either.
        let _ = std::fs::remove_file(&temporary);
        // What the system says, without its number.
        let reason = reason.split(" (os error").next().unwrap_or_default();
        Error::new(format!("cannot write the {what}: {reason}"))
            .hint("check that the folder exists, may be written to and has room")
            .in_file(path)
    })?;
    settle(path);
    Ok(())
}

/// Writes a text whole.
///
/// # Errors
/// Those of [`write_whole`].
pub fn write_text(path: &Path, what: &str, text: &str) -> Result<()> {
    write_whole(path, what, |to| to.write_all(text.as_bytes()).map_err(|e| e.to_string()))
}

/// A file is renamed only when all of it is on the disk: else a power failure could leave the new
/// name without its content.
fn write_through(
    temporary: &Path,
    write: impl FnOnce(&mut Writer) -> std::result::Result<(), String>,
) -> std::result::Result<(), String> {
    let mut writer = BufWriter::new(File::create(temporary).map_err(|e| e.to_string())?);
    write(&mut writer)?;
    writer.flush().map_err(|e| e.to_string())?;
    writer.get_ref().sync_all().map_err(|e| e.to_string())
}

/// Has the folder remember the new name. A file system that cannot do that has the file
/// nevertheless.
fn settle(path: &Path) {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    if let Ok(folder) = File::open(folder.unwrap_or_else(|| Path::new("."))) {
        let _ = folder.sync_all();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_write_that_fails_leaves_what_was_there() {
        let folder = std::env::temp_dir().join(format!("etalon-safely-{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("the folder can be made");
        let file = folder.join("facts.json");
        write_text(&file, "report", "before").expect("written");
        let failed = write_whole(&file, "report", |to| {
            to.write_all(b"half of it").map_err(|e| e.to_string())?;
            Err("No space left on device (os error 28)".to_owned())
        });
        let message = failed.expect_err("it fails").to_string();
        assert!(
            message.contains("facts.json: cannot write the report: No space left on device; "),
            "{message}"
        );
        assert_eq!(std::fs::read_to_string(&file).expect("readable"), "before");
        assert_eq!(std::fs::read_dir(&folder).expect("readable").count(), 1);
        write_text(&file, "report", "after").expect("written");
        assert_eq!(std::fs::read_to_string(&file).expect("readable"), "after");
        std::fs::remove_dir_all(&folder).expect("removed");
    }
}
