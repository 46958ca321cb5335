//! The only error type: where in which file, what stood there, what to do about it.

use std::fmt;
use std::path::{Path, PathBuf};

/// The result of everything that reads what a user wrote.
pub type Result<T> = std::result::Result<T, Error>;

/// A fault in something a user gave: a scene, a table, a mesh, an argument.
///
/// Displayed on one line as `file:line:column /pointer: what; what to do`, with the parts
/// that are unknown left out.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub struct Error {
    /// The file at fault.
    pub file: Option<PathBuf>,
    /// One-based line in that file.
    pub line: Option<usize>,
    /// One-based column, counted in characters.
    pub column: Option<usize>,
    /// JSON pointer of the entry at fault, such as `/objects/3/material`.
    pub pointer: Option<String>,
    /// What is wrong, without a full stop.
    pub message: String,
    /// What to do about it, without a full stop.
    pub hint: Option<String>,
}

impl Error {
    /// An error that knows only what is wrong; add the place with the other methods.
    pub fn new(message: impl Into<String>) -> Self {
        Self { file: None, line: None, column: None, pointer: None, message: message.into(), hint: None }
    }

    /// Adds what to do about it.
    #[must_use]
    pub fn hint(mut self, hint: impl Into<String>) -> Self {
        self.hint = Some(hint.into());
        self
    }

    /// Adds the file, unless one is known already.
    #[must_use]
    pub fn in_file(mut self, file: &Path) -> Self {
        self.file.get_or_insert_with(|| file.to_owned());
        self
    }

    /// Adds a one-based line and, where known, column.
    #[must_use]
    pub fn at(mut self, line: usize, column: Option<usize>) -> Self {
        self.line = Some(line);
        self.column = column;
        self
    }

    /// Puts a JSON pointer segment in front of what is known: errors travel outwards.
    #[must_use]
    pub fn under(mut self, segment: impl fmt::Display) -> Self {
        let inner = self.pointer.take().unwrap_or_default();
        self.pointer = Some(format!("/{}{inner}", pointer_segment(&segment.to_string())));
        self
    }

    /// The error of a file that cannot be read or written.
    pub fn io(file: &Path, doing: &str, source: &std::io::Error) -> Self {
        use std::io::ErrorKind;
        let hint = match source.kind() {
            ErrorKind::NotFound => "check the path",
            ErrorKind::PermissionDenied => "check the permissions",
            ErrorKind::IsADirectory => "name a file, not a folder",
            ErrorKind::InvalidInput => "save what it gives to a file and name that",
            ErrorKind::FileTooLarge => "check that this is the right file",
            _ => "check the disk and the path",
        };
        Self::new(format!("cannot {doing}: {}", reason(source))).in_file(file).hint(hint)
    }

    /// The error of a file that a scene names and that cannot be read: the fault is the
    /// scene's, so the place stays open for the entry that names it.
    pub fn named_file(named: &str, source: &std::io::Error) -> Self {
        let fault = Self::io(Path::new(named), &format!("read \"{named}\""), source);
        let hint = match source.kind() {
            std::io::ErrorKind::NotFound => {
                Some("check the path; it is taken relative to the scene's folder".to_owned())
            }
            _ => fault.hint,
        };
        Self { file: None, hint, ..fault }
    }

    /// `"; did you mean …?"` material: the known name nearest to a wrong one.
    pub fn nearest<'a>(wrong: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
        /// Below this Jaro-Winkler similarity a suggestion confuses more than it helps.
        const ALIKE: f64 = 0.75;
        /// Longer names are not compared: the time grows with the product of both lengths.
        const LONGEST: usize = 100;
        let known = known.into_iter().filter(|name| wrong.len().max(name.len()) <= LONGEST);
        known
            .map(|name| (strsim::jaro_winkler(wrong, name), name))
            .filter(|(likeness, _)| *likeness > ALIKE)
            .max_by(|a, b| a.0.total_cmp(&b.0))
            .map(|(_, name)| name)
    }

    /// An unknown name, with the nearest known one or all of them as the hint.
    pub fn unknown_name<'a>(what: &str, wrong: &str, known: impl IntoIterator<Item = &'a str>) -> Self {
        let known: Vec<&str> = known.into_iter().collect();
        let hint = match Self::nearest(wrong, known.iter().copied()) {
            Some(name) => format!("did you mean \"{name}\"?"),
            None if known.is_empty() => format!("no {what} is defined"),
            None if known.len() > 12 => {
                format!("{} are known, {} among them", known.len(), known[..8].join(", "))
            }
            None => format!("known: {}", known.join(", ")),
        };
        Self::new(format!("unknown {what} \"{wrong}\"")).hint(hint)
    }

    /// Something that was left out when the library was built.
    pub(crate) fn not_built(what: &str, feature: &str) -> Self {
        Self::new(format!("{what} were left out of this build"))
            .hint(format!("build etalon with the cargo feature \"{feature}\""))
    }
}

/// A name as a segment of a JSON pointer (RFC 6901).
pub(crate) fn pointer_segment(name: &str) -> String {
    name.replace('~', "~0").replace('/', "~1")
}

/// What the system says, without its number.
fn reason(source: &std::io::Error) -> String {
    let text = source.to_string();
    text.split(" (os error").next().unwrap_or_default().to_owned()
}

/// Passes text on with line breaks and other control characters written out and its middle
/// left out where it is long, so that an error stays on its line whatever names a file gives
/// things.
struct OneLine<'a, 'b>(&'a mut fmt::Formatter<'b>);

impl OneLine<'_, '_> {
    /// Writes one part of a message.
    fn part(&mut self, text: &str) -> fmt::Result {
        /// Characters at either end of a part that is shortened.
        const KEPT: usize = 150;
        let end = text.char_indices().nth(KEPT).map(|(at, _)| at);
        let start = text.char_indices().rev().nth(KEPT - 1).map(|(at, _)| at);
        match (end, start) {
            (Some(end), Some(start)) if end < start => {
                self.controls_escaped(&text[..end])?;
                self.0.write_str(" … ")?;
                self.controls_escaped(&text[start..])
            }
            _ => self.controls_escaped(text),
        }
    }

    fn controls_escaped(&mut self, text: &str) -> fmt::Result {
        for part in text.split_inclusive(char::is_control) {
            let plain = part.trim_end_matches(char::is_control);
            self.0.write_str(plain)?;
            write!(self.0, "{}", part[plain.len()..].escape_default())?;
        }
        Ok(())
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut line = OneLine(f);
        if let Some(file) = &self.file {
            line.controls_escaped(&file.display().to_string())?;
            if let Some(number) = self.line {
                write!(line.0, ":{number}")?;
                if let Some(column) = self.column {
                    write!(line.0, ":{column}")?;
                }
            }
        }
        match &self.pointer {
            Some(pointer) => {
                line.0.write_str(if self.file.is_some() { " " } else { "" })?;
                line.part(pointer)?;
                line.0.write_str(": ")?;
            }
            None if self.file.is_some() => line.0.write_str(": ")?,
            None => {}
        }
        line.part(&self.message)?;
        match &self.hint {
            Some(hint) => {
                line.0.write_str("; ")?;
                line.part(hint)
            }
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn display_names_place_fault_and_remedy() {
        let error = Error::new("unknown key \"fstop\"")
            .hint("did you mean \"f_stop\"?")
            .under("camera")
            .at(12, Some(9))
            .in_file(Path::new("scene.json"));
        assert_eq!(
            error.to_string(),
            "scene.json:12:9 /camera: unknown key \"fstop\"; did you mean \"f_stop\"?"
        );
    }

    #[test]
    fn a_name_with_a_line_break_stays_on_its_line() {
        let error = Error::new("unknown material \"a\nb\"").under("x/y~z");
        assert_eq!(error.to_string(), "/x~1y~0z: unknown material \"a\\nb\"");
    }

    #[test]
    fn a_long_name_is_shortened_in_its_middle() {
        let name = format!("a{}z", "é".repeat(1_000_000));
        let line = Error::new(format!("unknown material \"{name}\"")).hint(name).to_string();
        assert!(line.starts_with("unknown material \"aéé") && line.ends_with("ééz"), "{line:.100}");
        assert!(line.len() < 1500, "{}", line.len());
    }

    #[test]
    fn suggestions_are_near_or_absent() {
        assert_eq!(Error::nearest("corenell-white", ["cornell-white", "gold"]), Some("cornell-white"));
        assert_eq!(Error::nearest("zzz", ["cornell-white", "gold"]), None);
    }
}
