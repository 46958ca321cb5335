//! The words of a line and the columns that they stand in.

/// The words of a line, with the byte that each begins at.
pub fn words(line: &str) -> impl Iterator<Item = (usize, &str)> {
    let mut next = 0;
    line.split(|c: char| c.is_ascii_whitespace()).filter_map(move |word| {
        let start = next;
        next += word.len() + 1;
        (!word.is_empty()).then_some((start, word))
    })
}

/// One-based column, in characters, of a byte of a line.
pub fn column(line: &str, byte: usize) -> usize {
    line[..byte].chars().count() + 1
}
