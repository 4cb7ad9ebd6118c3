//! Published form of a URDF: the same elements, attributes and texts, on one line, without comments.
//!
//! Tools of ROS 2 read the value of each parameter as YAML (`ros2 param load`), which must give the same text. A plain scalar of YAML is
//! folded at line ends, ends at a colon or before a number sign next to a blank, and has no control characters. Such characters are written
//! as character references, which XML readers resolve.

/// Returns the published text of a well-formed URDF.
pub(super) fn published(urdf: &str) -> String {
    // XML readers do this before anything else (XML 1.0, 2.11).
    let urdf = urdf.replace("\r\n", "\n").replace('\r', "\n");
    let (mut output, mut text, mut rest) = (String::with_capacity(urdf.len()), String::new(), urdf.as_str());
    while !rest.is_empty() {
        let piece;
        if let Some(comment) = rest.strip_prefix("<!--") {
            (_, rest) = split_at_end(comment, "-->");
        } else if let Some(raw) = rest.strip_prefix("<![CDATA[") {
            (piece, rest) = split_at_end(raw, "]]>");
            text += &piece.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
        } else if rest.starts_with('<') {
            (piece, rest) = rest.split_at(tag_length(rest));
            put_text(&std::mem::take(&mut text), &mut output);
            put_tag(piece, &mut output);
        } else {
            (piece, rest) = rest.split_at(rest.find('<').unwrap_or(rest.len()));
            text += piece;
        }
    }
    put_text(&text, &mut output);
    output
}

/// Splits a text at `end`, into the part before it and the part after it.
fn split_at_end<'a>(text: &'a str, end: &str) -> (&'a str, &'a str) {
    text.split_once(end).unwrap_or((text, ""))
}

/// Returns the length in bytes of the tag or processing instruction at the beginning.
fn tag_length(text: &str) -> usize {
    let mut quote = None;
    for (at, c) in text.char_indices() {
        match (quote, c) {
            (None, '>') => return at + 1,
            (None, '"' | '\'') => quote = Some(c),
            (Some(open), c) if open == c => quote = None,
            _ => {}
        }
    }
    text.len()
}

/// Adds the text between two tags. Blanks that only separate elements are left out.
fn put_text(text: &str, output: &mut String) {
    if !text.chars().all(|c| " \t\n".contains(c)) {
        encode(text, output);
    }
}

/// Adds a tag. All kinds of blanks become spaces, also in attribute values (XML 1.0, 3.3.3).
fn put_tag(tag: &str, output: &mut String) {
    encode(&tag.replace(['\t', '\n'], " "), output);
}

/// Adds a text, with character references for characters that have a meaning in YAML.
fn encode(piece: &str, output: &mut String) {
    for (at, c) in piece.char_indices() {
        let follows_blank = piece[..at].ends_with(char::is_whitespace);
        let is_colon_blank = c.is_whitespace() && piece[..at].ends_with(':');
        let is_yaml = is_colon_blank || c == '#' && follows_blank || c.is_control();
        if is_yaml {
            output.push_str(&format!("&#{};", u32::from(c)));
        } else {
            output.push(c);
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use roxmltree::{Document, Node};

    use super::*;

    const URDF: &str = "<?xml version=\"1.0\"?>\n<!-- as: a drawing -->\n<robot\tname='r: 1'\n  a=\"it's # !-- this -->\">\r\n\t<!-- x -->\
        <link name='l'/>\n\t<text>\ta: b\n # c:\n<![CDATA[<d> & # e: f]]></text>\u{85}</robot>\n<!-- end: -->";

    /// Returns elements, attributes and texts, without comments and blanks between elements.
    fn content(text: &str) -> Vec<String> {
        let document = Document::parse(text).unwrap();
        let attributes = |node: Node<'_, '_>| -> Vec<String> {
            node.attributes().map(|a| format!("{}={}", a.name(), a.value())).collect()
        };
        let of = |node: Node<'_, '_>| {
            if node.is_element() {
                return Some(format!("{} {:?}", node.tag_name().name(), attributes(node)));
            }
            node.text().filter(|_| node.is_text()).map(ToOwned::to_owned)
        };
        // Texts with a comment between them are joined.
        let mut all: Vec<String> = Vec::new();
        let mut is_text_before = false;
        for node in document.descendants().filter(|node| !node.is_comment()) {
            let Some(one) = of(node) else { continue };
            match all.last_mut() {
                Some(last) if is_text_before && node.is_text() => *last += &one,
                _ => all.push(one),
            }
            is_text_before = node.is_text();
        }
        all.retain(|one| !one.chars().all(|c| " \t\n".contains(c)));
        all
    }

    #[test]
    fn a_published_urdf_has_the_same_content() {
        let text = published(URDF);
        assert_eq!(content(&text), content(URDF));
        assert!(!text.contains("drawing") && !text.contains("end:"), "{text}");
        assert!(!text.contains(['\t', '\r', '\n']) && !text.contains(": ") && !text.contains(" #"), "{text}");
    }

    #[test]
    fn a_plain_urdf_is_published_on_one_line() {
        let plain = "<robot name=\"r\">\n  <link\nname=\"l\"/>\n</robot>\n";
        assert_eq!(published(plain), "<robot name=\"r\"><link name=\"l\"/></robot>");
        assert_eq!(published(""), "");
    }

    proptest! {
        /// A launch file may contain any text.
        #[test]
        fn any_text_is_published_as_one_that_yaml_can_read(text in "(<|>|<!--|-->|<!\\[CDATA\\[|\\]\\]>|[a: #'\"\t\n\r&;]){0,40}") {
            let text = published(&text);
            prop_assert!(!text.contains(['\t', '\n']) && !text.contains(": ") && !text.contains(" #"), "{text:?}");
        }

        #[test]
        fn values_and_texts_stay_the_same(value in "[a: #'\t\n\r]{0,8}", text in "[a: #'\t\n\r]{0,8}", more in "[a: #\r\n]{0,8}") {
            let urdf = format!("<robot a=\"{value}\">{text}<!-- {text} -->{more}<![CDATA[<{more}]]><link/>{text}</robot>");
            prop_assert_eq!(content(&published(&urdf)), content(&urdf));
        }
    }
}
