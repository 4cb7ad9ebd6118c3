//! Quotes texts in messages.

/// Maximum number of characters of a text that a message quotes.
pub const MOST_QUOTED: usize = 60;

/// Returns the text in quotation marks, shortened if it is long.
pub fn quoted(text: &str) -> String {
    let cut: String = text.chars().take(MOST_QUOTED).collect();
    let more = if cut.len() < text.len() { ".." } else { "" };
    format!("{cut:?}{more}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_text_is_cut_at_a_character() {
        assert_eq!(quoted("a\"b"), r#""a\"b""#);
        assert_eq!(quoted(&"ä".repeat(61)), format!("\"{}\"..", "ä".repeat(60)));
    }
}
