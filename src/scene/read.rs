//! From a scene's text to [`SceneFile`], every fault with its line and column.

use super::file::SceneFile;
use super::locate::{Repeated, duplicate_key, locate};
use crate::error::{Error, Result, pointer_segment};
use crate::input;
use std::path::Path;

/// Larger scene files are refused before they are read; meshes belong in PLY or OBJ files.
const MOST_BYTES: u64 = 64 << 20;

/// Reads a scene file's text.
pub fn read_text(file: &Path) -> Result<String> {
    let bytes = input::read_bytes_or_pipe(file, MOST_BYTES).map_err(|e| {
        let fault = Error::io(file, "read the scene", &e);
        match e.kind() {
            std::io::ErrorKind::FileTooLarge => fault.hint("move meshes into PLY files that the scene names"),
            _ => fault,
        }
    })?;
    Ok(input::text_of(&bytes).map_err(|e| e.in_file(file))?.to_owned())
}

/// Parses a scene's text; errors carry line, column and pointer, but not yet the file.
pub fn parse(text: &str) -> Result<SceneFile> {
    let mut deserializer = serde_json::Deserializer::from_str(text);
    let scene: SceneFile = serde_path_to_error::deserialize(&mut deserializer)
        .map_err(|e| explain(text, &pointer_of(e.path()), e.inner()))?;
    deserializer.end().map_err(|e| explain(text, "", &e))?;
    match duplicate_key(text) {
        None => Ok(scene),
        Some(repeated) => Err(twice(&repeated)),
    }
}

fn twice(Repeated { key, pointer, place: (line, column) }: &Repeated) -> Error {
    let fault = Error::new(format!("the key \"{key}\" stands twice in one object"));
    at_pointer(fault, pointer).hint("remove or rename one of them").at(*line, Some(*column))
}

/// Gives an error that knows its pointer the line and column that the pointer leads to.
pub fn place(text: &str, error: Error) -> Error {
    if error.line.is_some() || error.file.is_some() {
        return error; // of another file, with its own lines
    }
    let pointer = error.pointer.clone().unwrap_or_default();
    let error = at_pointer(error, &pointer);
    match locate(text, pointer.trim_end_matches('/')) {
        Some((line, column)) => error.at(line, Some(column)),
        None => error,
    }
}

fn pointer_of(path: &serde_path_to_error::Path) -> String {
    use serde_path_to_error::Segment;
    path.iter()
        .map(|segment| match segment {
            Segment::Seq { index } => format!("/{index}"),
            Segment::Map { key: name } | Segment::Enum { variant: name } => {
                format!("/{}", pointer_segment(name))
            }
            Segment::Unknown => String::new(),
        })
        .collect()
}

/// Sets the pointer; the whole file is shown as `/`.
fn at_pointer(mut fault: Error, pointer: &str) -> Error {
    fault.pointer = Some(if pointer.is_empty() { "/".to_owned() } else { pointer.to_owned() });
    fault
}

/// Turns serde's message into ours, placed where the entry at fault stands.
fn explain(text: &str, pointer: &str, error: &serde_json::Error) -> Error {
    let whole = error.to_string();
    let message =
        if error.line() > 0 { whole.rsplit_once(" at line ").map_or(&*whole, |(m, _)| m) } else { &whole };
    let quoted: Vec<&str> = message.split('`').skip(1).step_by(2).collect();
    if let Some((wrong, known)) = quoted.split_first().filter(|_| message.starts_with("unknown ")) {
        return unknown(text, pointer, (wrong, known), error);
    }
    if let Some(repeated) = duplicate_key(text).filter(|_| message.starts_with("duplicate field")) {
        return twice(&repeated);
    }
    let fault = if message.starts_with("missing field") {
        let key = quoted.first().copied().unwrap_or_default();
        Error::new(format!("the key \"{key}\" is missing")).hint("add it; `etalon schema` lists all keys")
    } else if message == "recursion limit exceeded" {
        let fault = Error::new("lists or objects stand more than 127 deep in one another")
            .hint("check brackets; no part of a scene is that deep");
        return at_pointer(fault, pointer).at(error.line(), Some(column_in_characters(text, error)));
    } else if message == "number out of range" {
        Error::new("a number is too large to be held").hint("write a number below 1e308; check its unit")
    } else if !(error.is_syntax() || error.is_eof()) {
        Error::new(plain_words(message)).hint("`etalon schema` describes what belongs here")
    } else if serde_json::from_str::<serde::de::IgnoredAny>(text).is_ok() {
        // What serde calls a fault of syntax where the JSON is in order: a list that is too
        // long, or an alternative that is not written as one key.
        match message {
            "trailing characters" => Error::new("the list has more entries than belong here"),
            _ => Error::new("one key that says which kind is meant belongs here, with its entries inside"),
        }
        .hint("`etalon schema` describes what belongs here")
    } else {
        let (line, column) = (error.line(), column_in_characters(text, error));
        let fault = Error::new(format!("not valid JSON: {message}")).hint(remedy(text, line, column));
        return at_pointer(fault, pointer).at(line, Some(column));
    };
    let placed = place(text, at_pointer(fault, pointer));
    match placed.line {
        Some(_) => placed,
        // The text is not JSON farther on, so that the pointer leads nowhere.
        None => placed.at(error.line(), Some(column_in_characters(text, error))),
    }
}

/// What to do about text that is not JSON, by what stands at the fault.
fn remedy(text: &str, line: usize, column: usize) -> &'static str {
    let line = text.split('\n').nth(line.saturating_sub(1)).unwrap_or_default();
    let at = line.char_indices().nth(column.saturating_sub(1)).map_or(line.len(), |(at, _)| at);
    let rest = line[at..].trim_start();
    let starts = |marks: &[&str]| marks.iter().any(|mark| rest.starts_with(mark));
    if starts(&["//", "/*", "#"]) {
        "JSON has no comments; write a \"description\", or leave them out"
    } else if starts(&["NaN", "nan", "Inf", "inf", "-Inf", "-inf", "-nan"]) {
        "write a finite number; JSON knows no others"
    } else {
        "check commas, quotes and brackets just before this place"
    }
}

/// An unknown key, kind or value, with a suggestion.
fn unknown(text: &str, pointer: &str, (wrong, known): (&str, &[&str]), error: &serde_json::Error) -> Error {
    let segment = pointer_segment(wrong);
    let parent = pointer.strip_suffix(&format!("/{segment}")).unwrap_or(pointer);
    let whole: Option<serde_json::Value> = serde_json::from_str(text).ok();
    let what = match whole.as_ref().and_then(|value| value.pointer(parent)) {
        Some(serde_json::Value::String(_)) => "value",
        _ => "key",
    };
    let mut fault = Error::unknown_name(what, wrong, known.iter().copied());
    let (line, column) = locate(text, &format!("{parent}/{segment}")).unwrap_or_else(|| {
        // The text is not JSON farther on; serde stands behind the word and its quotes.
        let behind = column_in_characters(text, error);
        (error.line(), behind.saturating_sub(wrong.chars().count() + 1).max(1))
    });
    fault = fault.at(line, Some(column));
    at_pointer(fault, parent)
}

/// The column of a fault of syntax: serde counts bytes, and from 0 at the end of the text.
fn column_in_characters(text: &str, error: &serde_json::Error) -> usize {
    let line = text.split('\n').nth(error.line().saturating_sub(1)).unwrap_or_default();
    let bytes_before = error.column().saturating_sub(1).min(line.len());
    String::from_utf8_lossy(&line.as_bytes()[..bytes_before]).chars().count() + 1
}

/// `invalid type: string "x", expected f64` in plain words.
fn plain_words(message: &str) -> String {
    let parts = message.split_once(": ").and_then(|(_, rest)| rest.rsplit_once(", expected "));
    let Some((found, expected)) = parts.filter(|_| message.starts_with("invalid ")) else {
        let length = message
            .strip_prefix("invalid length ")
            .and_then(|rest| rest.split_once(", expected an array of length "));
        return match length {
            Some((found, expected)) => format!("a list of {found} where a list of {expected} belongs"),
            None => message.to_owned(),
        };
    };
    let found = match found {
        "sequence" => "a list".to_owned(),
        "map" => "an object".to_owned(),
        other => other.replace("floating point", "number").replace("integer", "number").replace('`', ""),
    };
    let expected = match expected {
        "f64" => "a number",
        "u32" if found.rsplit(' ').next().is_some_and(|n| n.parse::<u64>().is_ok()) => {
            "a whole number below 4294967296"
        }
        "u32" => "a whole number from 0 up",
        "a sequence" => "a list",
        "a map" => "an object",
        kind if kind.starts_with("struct") => "an object with keys",
        kind if kind.starts_with("enum") => "a kind, written as one key with its entries inside,",
        array if array.starts_with("an array") => "a list",
        other => other,
    };
    format!("{found} where {expected} belongs")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn serde_in_plain_words() {
        for (said, plain) in [
            ("invalid type: string \"x\", expected f64", "string \"x\" where a number belongs"),
            (
                "invalid type: floating point `0.5`, expected u32",
                "number 0.5 where a whole number from 0 up belongs",
            ),
            ("invalid length 2, expected an array of length 3", "a list of 2 where a list of 3 belongs"),
            ("a band has two wavelengths", "a band has two wavelengths"),
        ] {
            assert_eq!(plain_words(said), plain);
        }
    }
}
