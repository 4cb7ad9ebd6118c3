//! Splits a program into tokens, for the tests that read it.

/// An identifier or a sign of the program, with its line.
pub(crate) type Token = (usize, String);

/// Returns the end of a comment, a string or a character that begins there; none if there is none.
fn end_of_text(signs: &[char], at: usize) -> Option<usize> {
    let from = |place: usize| signs.get(place).copied().unwrap_or('\n');
    let find = |mut place: usize, ends: &dyn Fn(usize) -> bool| {
        while place < signs.len() && !ends(place) {
            place += 1;
        }
        place
    };
    match (signs.get(at)?, from(at + 1)) {
        ('/', '/') => Some(find(at, &|place| from(place) == '\n')),
        ('/', '*') => {
            let (mut depth, mut place) = (1, at + 2);
            while depth > 0 && place < signs.len() {
                match (from(place), from(place + 1)) {
                    ('/', '*') => (depth, place) = (depth + 1, place + 2),
                    ('*', '/') => (depth, place) = (depth - 1, place + 2),
                    _ => place += 1,
                }
            }
            Some(place)
        }
        ('r', '"' | '#') => {
            let hashes = find(at + 1, &|place| from(place) != '#') - at - 1;
            let begin = at + 1 + hashes;
            let is_end = |place: usize| from(place) == '"' && (1..=hashes).all(|more| from(place + more) == '#');
            (from(begin) == '"').then(|| find(begin + 1, &is_end) + 1 + hashes)
        }
        ('"', _) => {
            let mut place = at + 1;
            while place < signs.len() && from(place) != '"' {
                place += if from(place) == '\\' { 2 } else { 1 };
            }
            Some(place + 1)
        }
        ('\'', '\\') => Some(find(at + 3, &|place| from(place) == '\'') + 1),
        ('\'', _) if from(at + 2) == '\'' => Some(at + 3),
        _ => None,
    }
}

/// Returns the identifiers and signs of a program, without comments, strings and characters, except those that are
/// `kept`; `::` is one sign.
pub(crate) fn tokens(text: &str, kept: impl Fn(&str) -> bool) -> Vec<Token> {
    let signs: Vec<char> = text.chars().collect();
    let is_word = |sign: &char| sign.is_alphanumeric() || *sign == '_';
    let (mut found, mut line, mut at) = (Vec::new(), 1, 0);
    while let Some(sign) = signs.get(at) {
        let letters = signs.iter().skip(at).take_while(|sign| is_word(sign)).count();
        let end = match end_of_text(&signs, at) {
            Some(end) => end,
            None if letters > 0 => at + letters,
            None if *sign == ':' && signs.get(at + 1) == Some(&':') => at + 2,
            None => at + 1,
        };
        let end = end.min(signs.len());
        let word: String = signs[at..end].iter().collect();
        if !sign.is_whitespace() && (end_of_text(&signs, at).is_none() || kept(&word)) {
            found.push((line, word));
        }
        line += signs[at..end].iter().filter(|sign| **sign == '\n').count();
        at = end;
    }
    found
}

/// Returns the end of the item, field or statement that begins there.
pub(crate) fn end_of_item(tokens: &[Token], mut at: usize) -> usize {
    let mut depth = 0_i32;
    while let Some((_, word)) = tokens.get(at) {
        match word.as_str() {
            "{" | "(" | "[" => depth += 1,
            "}" | ")" | "]" if depth == 0 => return at,
            "}" if depth == 1 => return at + 1,
            "}" | ")" | "]" => depth -= 1,
            ";" | "," if depth == 0 => return at + 1,
            _ => {}
        }
        at += 1;
    }
    at
}

/// Whether `#[cfg(test)]` begins there.
pub(crate) fn is_test_only(tokens: &[Token], at: usize) -> bool {
    let signs = ["#", "[", "cfg", "(", "test", ")", "]"];
    signs.iter().zip(at..).all(|(sign, at)| tokens.get(at).is_some_and(|(_, word)| word == sign))
}
