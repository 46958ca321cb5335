//! Where in a scene's text an entry stands: from a JSON pointer to line and column.

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

/// The second of two keys of the same name in one object: JSON allows it, we do not.
pub fn duplicate_key(text: &str) -> Option<(String, (usize, usize))> {
    let parsed = parse_to_ast(text, &CollectOptions::default(), &ParseOptions::default()).ok()?;
    let mut waiting: Vec<&Value<'_>> = parsed.value.iter().collect();
    while let Some(value) = waiting.pop() {
        match value {
            Value::Object(object) => {
                for (index, property) in object.properties.iter().enumerate() {
                    let name = name_of(property);
                    if object.properties[..index].iter().any(|earlier| name_of(earlier) == name) {
                        return Some((name.to_owned(), line_and_column(text, property.start())));
                    }
                    waiting.push(&property.value);
                }
            }
            Value::Array(array) => waiting.extend(&array.elements),
            _ => {}
        }
    }
    None
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
    }

    #[test]
    fn repeated_keys_are_found() {
        assert_eq!(duplicate_key(TEXT), Some(("b".to_owned(), (3, 14))));
        assert_eq!(duplicate_key("{\"a\": {\"b\": 1}, \"b\": 2}"), None);
    }
}
