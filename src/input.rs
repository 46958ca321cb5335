//! Files as bytes and text, before anything is made of them.
//!
//! What a file may cost is known before it is read: only regular files are opened, so that no
//! device or pipe is read without end or waited for, and none above a stated size. Text is
//! UTF-8; a byte order mark in front of it is passed over, as spreadsheets write one.

use crate::error::{Error, Result};
use std::fs::{File, Metadata};
use std::io::{self, ErrorKind, Read};
use std::path::Path;

/// The bytes of a regular file of at most `most_bytes`.
pub fn read_bytes(path: &Path, most_bytes: u64) -> io::Result<Vec<u8>> {
    read(path, most_bytes, Metadata::is_file)
}

/// The same of a file that the user names, which may be a pipe: one that is being written to
/// by the command beside this one.
pub fn read_bytes_or_pipe(path: &Path, most_bytes: u64) -> io::Result<Vec<u8>> {
    read(path, most_bytes, |metadata| metadata.is_file() || is_pipe(metadata))
}

#[cfg(unix)]
fn is_pipe(metadata: &Metadata) -> bool {
    use std::os::unix::fs::FileTypeExt as _;
    metadata.file_type().is_fifo()
}

#[cfg(not(unix))]
fn is_pipe(_: &Metadata) -> bool {
    false
}

fn read(path: &Path, most_bytes: u64, suits: impl Fn(&Metadata) -> bool) -> io::Result<Vec<u8>> {
    // Before it is opened: opening a pipe waits for its writer.
    let metadata = std::fs::metadata(path)?;
    // Reading says of a folder that it is one.
    if !metadata.is_dir() && !suits(&metadata) {
        return Err(io::Error::new(ErrorKind::InvalidInput, "it is a device, not a file"));
    }
    let too_large = |bytes: u64| {
        let size = format!("{} MiB, more than {}", bytes >> 20, most_bytes >> 20);
        io::Error::new(ErrorKind::FileTooLarge, format!("it has {size}"))
    };
    if metadata.len() > most_bytes {
        return Err(too_large(metadata.len()));
    }
    let mut bytes = Vec::new();
    // A file may grow while it is read, and a pipe has no length.
    File::open(path)?.take(most_bytes + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most_bytes { Err(too_large(bytes.len() as u64)) } else { Ok(bytes) }
}

/// The text of a file's bytes, without its byte order mark; an error carries line and column.
pub fn text_of(bytes: &[u8]) -> Result<&str> {
    if let Some(kind) = packed(bytes) {
        return Err(Error::new(format!("the file is packed ({kind})"))
            .hint("unpack it and name the file that was inside")
            .at(1, Some(1)));
    }
    if bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]) {
        return Err(Error::new("the text is UTF-16").hint("save the file as UTF-8 text").at(1, Some(1)));
    }
    let bytes = bytes.strip_prefix("\u{feff}".as_bytes()).unwrap_or(bytes);
    std::str::from_utf8(bytes).map_err(|error| {
        let sound = std::str::from_utf8(&bytes[..error.valid_up_to()]).unwrap_or_default();
        let (line, column) = line_and_column(sound, sound.len());
        Error::new(format!("the byte 0x{:02x} belongs to no UTF-8 text", bytes[error.valid_up_to()]))
            .hint("save the file as UTF-8 text")
            .at(line, Some(column))
    })
}

/// How a file is packed, by its first bytes; `None` where it is not.
pub fn packed(bytes: &[u8]) -> Option<&'static str> {
    const MARKS: [(&[u8], &str); 5] = [
        (b"\x1f\x8b", "gzip"),
        (b"PK\x03\x04", "zip"),
        (b"BZh", "bzip2"),
        (b"\xfd7zXZ\0", "xz"),
        (b"\x28\xb5\x2f\xfd", "zstd"),
    ];
    MARKS.into_iter().find(|(mark, _)| bytes.starts_with(mark)).map(|(_, kind)| kind)
}

/// One-based line and column, in characters, of a byte of a text.
pub fn line_and_column(text: &str, byte: usize) -> (usize, usize) {
    let before = &text[..byte];
    let line_start = before.rfind('\n').map_or(0, |i| i + 1);
    (before.matches('\n').count() + 1, before[line_start..].chars().count() + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_told_from_what_is_none() {
        let place = |bytes: &[u8]| {
            let error = text_of(bytes).expect_err("no text");
            (error.line, error.column)
        };
        assert_eq!(text_of("\u{feff}é".as_bytes()), Ok("é"));
        assert_eq!(place(b"\xff\xfe{\0"), (Some(1), Some(1)));
        assert_eq!(place(b"\x1f\x8b\x08"), (Some(1), Some(1)));
        assert_eq!(
            place("é\nü".as_bytes().iter().chain(b"\xe9").copied().collect::<Vec<_>>().as_slice()),
            (Some(2), Some(2))
        );
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn devices_are_not_read() {
        let error = read_bytes(Path::new("/dev/zero"), u64::MAX - 1).expect_err("a device");
        assert_eq!(error.kind(), ErrorKind::InvalidInput);
    }

    #[test]
    fn sizes_are_limited() {
        let file = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/Cargo.toml"));
        let error = read_bytes(file, 10).expect_err("it has more bytes");
        assert_eq!(error.kind(), ErrorKind::FileTooLarge);
    }
}
