//! From a scene's text to [`SceneFile`], every fault with its line and column.

use super::file::SceneFile;
use super::locate::{duplicate_key, locate};
use crate::error::{Error, Result};
use std::path::Path;

/// Larger scene files are refused before they are read; meshes belong in PLY or OBJ files.
const MOST_BYTES: u64 = 256 << 20;

/// Reads a scene file's text.
pub fn read_text(file: &Path) -> Result<String> {
    let failed = |e: &std::io::Error| Error::io(file, "read the scene", e);
    let bytes = std::fs::metadata(file).map_err(|e| failed(&e))?.len();
    if bytes > MOST_BYTES {
        return Err(Error::new(format!("the scene file has {} MiB", bytes >> 20))
            .hint("move meshes into PLY files that the scene names")
            .in_file(file));
    }
    std::fs::read_to_string(file).map_err(|e| failed(&e))
}

/// Parses a scene's text; errors carry line, column and pointer, but not yet the file.
pub fn parse(text: &str) -> Result<SceneFile> {
    let mut deserializer = serde_json::Deserializer::from_str(text);
    let scene: SceneFile = serde_path_to_error::deserialize(&mut deserializer)
        .map_err(|e| explain(text, &pointer_of(e.path()), e.inner()))?;
    deserializer.end().map_err(|e| explain(text, "", &e))?;
    match duplicate_key(text) {
        None => Ok(scene),
        Some((key, (line, column))) => Err(Error::new(format!("the key \"{key}\" stands twice in one object"))
            .hint("remove or rename one of them")
            .at(line, Some(column))),
    }
}

/// Gives an error that knows its pointer the line and column that the pointer leads to.
pub fn place(text: &str, error: Error) -> Error {
    if error.line.is_some() || error.file.is_some() {
        return error; // of another file, with its own lines
    }
    let pointer = error.pointer.clone().unwrap_or_default();
    match locate(text, &pointer) {
        Some((line, column)) => error.at(line, Some(column)),
        None => error,
    }
}

fn pointer_of(path: &serde_path_to_error::Path) -> String {
    use serde_path_to_error::Segment;
    path.iter()
        .map(|segment| match segment {
            Segment::Seq { index } => format!("/{index}"),
            Segment::Map { key } => format!("/{key}"),
            Segment::Enum { variant } => format!("/{variant}"),
            Segment::Unknown => String::new(),
        })
        .collect()
}

/// Turns serde's message into ours, with a suggestion where a key or name is unknown.
fn explain(text: &str, pointer: &str, error: &serde_json::Error) -> Error {
    let whole = error.to_string();
    let message = whole.split(" at line ").next().unwrap_or(&whole);
    let quoted: Vec<&str> = message.split('`').skip(1).step_by(2).collect();
    let unknown = message.starts_with("unknown field") || message.starts_with("unknown variant");
    let mut explained = match quoted.split_first() {
        Some((wrong, known)) if unknown => {
            let name = pointer.rsplit('/').next().unwrap_or_default();
            let parent = if name == *wrong { pointer.trim_end_matches(wrong).trim_end_matches('/') } else { pointer };
            let at = format!("{parent}/{wrong}");
            let mut fault = Error::unknown_name("key", wrong, known.iter().copied());
            fault.pointer = Some(if parent.is_empty() { "/".to_owned() } else { parent.to_owned() });
            if let Some((line, column)) = locate(text, &at) {
                fault = fault.at(line, Some(column));
            }
            return fault;
        }
        _ if message.starts_with("missing field") => {
            let key = quoted.first().copied().unwrap_or_default();
            let mut fault = Error::new(format!("the key \"{key}\" is missing")).hint("add it; `etalon schema` lists all keys");
            fault.pointer = (!pointer.is_empty()).then(|| pointer.to_owned());
            return place(text, fault);
        }
        _ if error.is_syntax() || error.is_eof() => {
            Error::new(format!("not valid JSON: {message}")).hint("check commas, quotes and brackets just before this place")
        }
        _ => Error::new(message.to_owned()).hint("`etalon schema` describes what belongs here"),
    };
    explained.pointer = (!pointer.is_empty()).then(|| pointer.to_owned());
    explained.at(error.line(), Some(error.column()))
}
