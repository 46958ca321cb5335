//! Where in a scene's text an entry stands: from a JSON pointer to line and column.

use crate::error::pointer_segment;
use jsonc_parser::ast::{ObjectProp, Value};
use jsonc_parser::common::Ranged;
use jsonc_parser::{CollectOptions, ParseOptions, parse_to_ast};

/// One-based line and column of the entry that a JSON pointer names, or of the innermost
/// enclosing entry that exists; `None` where the text is not JSON at all.
pub fn locate(text: &str, pointer: &str) -> Option<(usize, usize)> {
    let parsed = parse_to_ast(text, &CollectOptions::default(), &ParseOptions::default()).ok()?;
    let mut value = parsed.value.as_ref()?;
    let mut start = value.start();
    for segment in pointer.split('/').skip(1) {
        let segment = segment.replace("~1", "/").replace("~0", "~");
        let (next, place) = match value {
            Value::Object(object) => match object.properties.iter().find(|p| name_of(p) == segment) {
                Some(property) => (&property.value, property.start()),
                None => break,
            },
            Value::Array(array) => match segment.parse::<usize>().ok().and_then(|i| array.elements.get(i)) {
                Some(element) => (element, element.start()),
                None => break,
            },
            _ => break,
        };
        value = next;
        start = place;
    }
    Some(line_and_column(text, start))
}

/// The second of two keys of the same name in one object, with the pointer of the object:
/// JSON allows it, we do not.
pub fn duplicate_key(text: &str) -> Option<Repeated> {
    let parsed = parse_to_ast(text, &CollectOptions::default(), &ParseOptions::default()).ok()?;
    let mut waiting: Vec<(&Value<'_>, String)> =
        parsed.value.iter().map(|value| (value, String::new())).collect();
    while let Some((value, pointer)) = waiting.pop() {
        match value {
            Value::Object(object) => {
                let mut seen = std::collections::HashSet::new();
                for property in &object.properties {
                    let name = name_of(property);
                    if !seen.insert(name) {
                        let place = line_and_column(text, property.start());
                        return Some(Repeated { key: name.to_owned(), pointer, place });
                    }
                    waiting.push((&property.value, format!("{pointer}/{}", pointer_segment(name))));
                }
            }
            Value::Array(array) => {
                // A mesh has millions of numbers, and no keys in them.
                let inside = array.elements.iter().enumerate();
                let inside =
                    inside.filter(|(_, element)| matches!(element, Value::Object(_) | Value::Array(_)));
                waiting.extend(inside.map(|(index, element)| (element, format!("{pointer}/{index}"))));
            }
            _ => {}
        }
    }
    None
}

/// A key that stands twice in one object.
#[derive(Debug, PartialEq, Eq)]
pub struct Repeated {
    /// The key.
    pub key: String,
    /// JSON pointer of the object.
    pub pointer: String,
    /// Line and column of the second.
    pub place: (usize, usize),
}

fn name_of<'a>(property: &'a ObjectProp<'_>) -> &'a str {
    property.name.as_str()
}

fn line_and_column(text: &str, byte: usize) -> (usize, usize) {
    let before = &text[..byte];
    let line_start = before.rfind('\n').map_or(0, |i| i + 1);
    (before.matches('\n').count() + 1, before[line_start..].chars().count() + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "{\n  \"a\": [1,\n    {\"b\": 2, \"b\": 3}]\n}";

    #[test]
    fn pointers_lead_to_keys_and_elements() {
        assert_eq!(locate(TEXT, "/a"), Some((2, 3)));
        assert_eq!(locate(TEXT, "/a/1/b"), Some((3, 6)));
        assert_eq!(locate(TEXT, "/a/1/missing"), Some((3, 5)));
        assert_eq!(locate("{\"x/~\": 1, \"x\": 2}", "/x~1~0"), Some((1, 2)));
        assert_eq!(locate("{\"é\": 1, \"x\": 2}", "/x"), Some((1, 10)));
    }

    #[test]
    fn repeated_keys_are_found() {
        let repeated = Repeated { key: "b".to_owned(), pointer: "/a/1".to_owned(), place: (3, 14) };
        assert_eq!(duplicate_key(TEXT), Some(repeated));
        assert_eq!(duplicate_key("{\"a\": {\"b\": 1}, \"b\": 2}"), None);
    }
}
