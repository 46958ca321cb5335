//! Where in a scene's text an entry stands: from a JSON pointer to line and column.

use crate::error::pointer_segment;
use crate::input::line_and_column;
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
    let mut path = Vec::new();
    let (key, byte) = repeated_in(parsed.value.as_ref()?, &mut path)?;
    let pointer = path.iter().rev().map(|segment| format!("/{segment}")).collect();
    Some(Repeated { key: key.to_owned(), pointer, place: line_and_column(text, byte) })
}

/// A repeated key and where it stands; `path` gets the segments that lead to its object, the
/// innermost first.
///
/// They are written only once it is found: where names are long, the pointers of all entries
/// would be many times as long as the file.
fn repeated_in<'a>(value: &'a Value<'_>, path: &mut Vec<String>) -> Option<(&'a str, usize)> {
    match value {
        Value::Object(object) => {
            let mut seen = std::collections::HashSet::new();
            if let Some(property) = object.properties.iter().find(|property| !seen.insert(name_of(property)))
            {
                return Some((name_of(property), property.start()));
            }
            object.properties.iter().find_map(|property| {
                let found = repeated_in(&property.value, path)?;
                path.push(pointer_segment(name_of(property)));
                Some(found)
            })
        }
        Value::Array(array) => array.elements.iter().enumerate().find_map(|(index, element)| {
            let found = repeated_in(element, path)?;
            path.push(index.to_string());
            Some(found)
        }),
        _ => None,
    }
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
