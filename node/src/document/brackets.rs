//! Finds a bracket or a quotation mark that nothing closes, in a text that the YAML parser refuses. The parser reports
//! the error in a later line.
//!
//! Law      a quotation mark opens where a value can begin; a bracket does so, too, and anywhere inside of brackets. It
//!          is not closed if a bracket of the other kind closes after it, or if a later line is not indented further
//!          than the key or the dash before it and the brackets of the rest of the text do not close it either
//! Reads    the whole text, without comments and block scalars

use super::{MAX_DEPTH, Place};

/// An opening bracket or quotation mark.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Opened {
    /// `{`, `[`, `"` or `'`.
    pub(super) sign: char,
    pub(super) place: Place,
    /// Minimum indentation of further lines of the value.
    least: usize,
}

impl Opened {
    /// Returns the sign that closes it.
    fn closing(self) -> char {
        match self.sign {
            '{' => '}',
            '[' => ']',
            quote => quote,
        }
    }

    /// Returns the error message.
    pub(super) fn sentence(self) -> String {
        let Self { sign, place: Place { line, col }, .. } = self;
        match sign {
            '{' | '[' => format!("`{}` is missing for `{sign}` at {line}:{col}", self.closing()),
            _ => format!("the closing quotation mark is missing for {sign} at {line}:{col}"),
        }
    }
}

/// Returns the first bracket or quotation mark that nothing closes.
pub(super) fn unclosed(text: &str) -> Option<Opened> {
    let mut reader = Reader::default();
    let mut lines = (1..).zip(text.lines());
    lines.find_map(|(number, line)| reader.read(number, line)).or_else(|| reader.end())
}

#[derive(Default)]
struct Reader {
    /// Open brackets, the outermost first.
    brackets: Vec<Opened>,
    quote: Option<Opened>,
    /// Innermost open bracket at the first line that is not indented far enough to be inside of it.
    left: Option<Opened>,
    /// Minimum indentation of the lines of a block scalar.
    block: Option<usize>,
}

impl Reader {
    /// Reads a line; returns what is certainly not closed.
    fn read(&mut self, number: usize, line: &str) -> Option<Opened> {
        let signs: Vec<char> = line.chars().collect();
        let indentation = signs.iter().take_while(|sign| **sign == ' ').count();
        let first = *signs.get(indentation)?;
        if self.block.is_some_and(|least| indentation >= least) {
            return None;
        }
        self.block = None;
        if let Some(quote) = self.quote {
            if indentation < quote.least {
                return self.left.or(Some(quote));
            }
        } else if let Some(outermost) = self.brackets.first() {
            let is_inside = indentation >= outermost.least || matches!(first, ']' | '}' | '#');
            if !is_inside {
                self.left = self.left.or(self.brackets.last().copied());
            }
        }
        self.read_signs(number, &signs, indentation)
    }

    fn read_signs(&mut self, number: usize, signs: &[char], indentation: usize) -> Option<Opened> {
        let is_blank = |at: usize| signs.get(at).is_none_or(|sign| matches!(sign, ' ' | '\t'));
        // Start of the key or value, and the dash before it.
        let (mut begin, mut dash) = (indentation, None);
        while signs.get(begin) == Some(&'-') && is_blank(begin + 1) {
            dash = Some(begin);
            begin += 1;
            while begin < signs.len() && is_blank(begin) {
                begin += 1;
            }
        }
        let least_after = |at: usize| if at > begin { begin + 1 } else { dash.map_or(begin, |dash: usize| dash + 1) };
        let (mut at, mut can_begin, mut after_quote) = (indentation, true, false);
        while let Some(&sign) = signs.get(at) {
            let here = at;
            at += 1;
            if let Some(quote) = self.quote {
                let is_doubled = sign == '\'' && signs.get(at) == Some(&'\'');
                if sign == '\\' && quote.sign == '"' || sign == quote.sign && is_doubled {
                    at += 1;
                } else if sign == quote.sign {
                    self.quote = None;
                    (can_begin, after_quote) = (false, true);
                }
                continue;
            }
            let is_flow = !self.brackets.is_empty();
            let least = self.brackets.first().map_or_else(|| least_after(here), |outermost| outermost.least);
            let opened = Opened { sign, place: Place { line: number, col: here + 1 }, least };
            match sign {
                ' ' | '\t' => continue,
                '#' if here == 0 || is_blank(here - 1) => break,
                '"' | '\'' if can_begin => self.quote = Some(opened),
                '[' | '{' if can_begin || is_flow => {
                    if self.brackets.len() > MAX_DEPTH {
                        return self.left.or(self.brackets.first().copied());
                    }
                    self.brackets.push(opened);
                    can_begin = true;
                }
                ']' | '}' if is_flow => {
                    let open = self.brackets.pop()?;
                    if open.closing() != sign {
                        return self.left.or(Some(open));
                    }
                    if self.brackets.is_empty() {
                        self.left = None;
                    }
                    can_begin = false;
                }
                ',' if is_flow => can_begin = true,
                ':' if after_quote || is_blank(at) => can_begin = true,
                '-' | '?' if can_begin && !is_flow && is_blank(at) => {}
                '|' | '>' if can_begin && !is_flow => {
                    self.block = Some(opened.least);
                    break;
                }
                // An anchor or a tag is in front of its value.
                '&' | '!' if can_begin => {
                    let ends = |sign: char| sign.is_whitespace() || is_flow && ",[]{}".contains(sign);
                    while signs.get(at).is_some_and(|sign| !ends(*sign)) {
                        at += 1;
                    }
                }
                _ => can_begin = false,
            }
            after_quote = false;
        }
        None
    }

    /// Returns what is open at the end of the text.
    fn end(&self) -> Option<Opened> {
        self.left.or(self.quote).or(self.brackets.last().copied())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn found(text: &str) -> Option<(char, usize, usize)> {
        unclosed(text).map(|Opened { sign, place: Place { line, col }, .. }| (sign, line, col))
    }

    #[test]
    fn bracket_without_a_closing_one_is_found_where_it_opens() {
        for (text, expected) in [
            ("a: {b: 1\nc: {d: 2}\n", ('{', 1, 4)),
            ("a:\n  b: {c: {d: 1}\n  e: {f: 2}\n", ('{', 2, 6)),
            ("a:\n  b: {c: {d: 1\n  e: {f: 2}\n", ('{', 2, 10)),
            ("a: [1, 2\n", ('[', 1, 4)),
            ("steps:\n  - {at: 0, do: {enable: {axes: [x, y}}}\n  - {at: 1}\n", ('[', 2, 33)),
            ("steps:\n  - at: 0\n    do: [{a: {}}, {b: {}}\n  - at: 1\n    do: {c: {}}\n", ('[', 3, 9)),
            ("- {a: 1,\n   b: 2\n- {c: 3}\n", ('{', 1, 3)),
            ("a: &v {k: 70\nb: 1\n", ('{', 1, 7)),
        ] {
            assert_eq!(found(text), Some(expected), "{text:?}");
        }
    }

    #[test]
    fn quotation_mark_without_a_closing_one_is_found_where_it_opens() {
        for (text, expected) in [
            ("a: \"b\nc: 2\n", ('"', 1, 4)),
            ("a:\n  b: 'c\n  d: 'e'\n", ('\'', 2, 6)),
            ("- {a: \"b, c: 1}\n- {a: \"d\", c: 2}\n", ('"', 1, 7)),
            ("a: [\"b\\\"]\n", ('"', 1, 5)),
        ] {
            assert_eq!(found(text), Some(expected), "{text:?}");
        }
    }

    #[test]
    fn text_whose_brackets_are_closed_has_none() {
        for text in [
            "",
            "a: {b: 1 c: 2}\n",
            "a: {b: [1, 2], c: {d: 3}}\nb: [\n  1,\n  2\n]\n",
            "- {a: 1,\n   b: [2,\n       3]}\n",
            "{\n\"a\": {\"b\":[1]},\n\"c\": 2\n}\n",
            "a: it's 5\" {not} [this\nb: don't # {nor this\n# [nor that\n",
            "a: 'it''s' # '\nb: \"say \\\"no\\\" {\"\nc: \"two\n  lines [\"\n",
            "a: |\n  {text [of\n\n  a \"block\nb: >-\n   'more {\nc: - |\n",
            "\"a[1]\": 5\n? b\n: {c: 1}\n",
            // The second line is not indented far enough.
            "  x: {a: 1,\n b: 2}\n  y: 3\n",
        ] {
            assert_eq!(found(text), None, "{text:?}");
        }
    }
}
