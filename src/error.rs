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
            ErrorKind::InvalidData => "save the file as UTF-8 text",
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
        known
            .into_iter()
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

/// Passes text on with line breaks and other control characters written out, so that an
/// error stays on its line whatever names a file gives things.
struct OneLine<'a, 'b>(&'a mut fmt::Formatter<'b>);

impl fmt::Write for OneLine<'_, '_> {
    fn write_str(&mut self, text: &str) -> fmt::Result {
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
        use fmt::Write as _;
        let mut f = OneLine(f);
        if let Some(file) = &self.file {
            write!(f, "{}", file.display())?;
            if let Some(line) = self.line {
                write!(f, ":{line}")?;
                if let Some(column) = self.column {
                    write!(f, ":{column}")?;
                }
            }
        }
        let separator = if self.file.is_some() { " " } else { "" };
        match &self.pointer {
            Some(pointer) => write!(f, "{separator}{pointer}: ")?,
            None if self.file.is_some() => f.write_str(": ")?,
            None => {}
        }
        f.write_str(&self.message)?;
        match &self.hint {
            Some(hint) => write!(f, "; {hint}"),
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
    fn suggestions_are_near_or_absent() {
        assert_eq!(Error::nearest("corenell-white", ["cornell-white", "gold"]), Some("cornell-white"));
        assert_eq!(Error::nearest("zzz", ["cornell-white", "gold"]), None);
    }
}
