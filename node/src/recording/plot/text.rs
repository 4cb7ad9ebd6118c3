//! Text of a figure: its width, and how it is wrapped or shortened to fit.
//!
//! All widths are those of the bundled font. A viewer shows an SVG in its own sans-serif font, which is rarely wider.

use plotters::style::{FontDesc, FontFamily, FontStyle, register_font};
use std::sync::Once;

/// DejaVu Sans 2.37, unchanged; its licence is next to it.
static FONT: &[u8] = include_bytes!("../../../fonts/DejaVuSans.ttf");
/// Size at which plotters draws a font with an em of 1.
pub(super) const SIZE_PER_EM: f64 = 1.24;
/// Factor for finer widths: plotters measures whole pixels.
const FINE: f64 = 10.0;
/// Maximum length of a text, in characters: no figure has room for more.
const LONGEST: usize = 4000;
const DOTS: char = '\u{2026}';

/// Registers the bundled font with plotters; no other font is used.
pub(super) fn use_bundled_font() {
    static ONCE: Once = Once::new();
    // If the bundled font cannot be read, every text that is drawn reports the error.
    ONCE.call_once(|| {
        let _ = register_font("sans-serif", FontStyle::Normal, FONT);
    });
}

pub(super) fn font(em: f64) -> FontDesc<'static> {
    FontDesc::new(FontFamily::SansSerif, em * SIZE_PER_EM, FontStyle::Normal)
}

/// Returns the width of a text, in px, for a font size `em`, in px.
pub(super) fn width(text: &str, em: f64) -> f64 {
    font(em * FINE).box_size(text).map_or(0.0, |(width, _)| f64::from(width) / FINE)
}

/// Returns the text, or as much of its start and end as fits with dots in between; empty if not even three letters fit.
pub(super) fn shorten(text: &str, em: f64, room: f64) -> String {
    let letters: Vec<char> = text.chars().take(LONGEST).collect();
    if width(text, em) <= room {
        return text.to_owned();
    }
    let cut = |kept: usize| -> String {
        let (front, back) = (kept.div_ceil(2), kept / 2);
        letters[..front].iter().chain([&DOTS]).chain(&letters[letters.len() - back..]).collect()
    };
    let kept = (3..letters.len()).collect::<Vec<_>>().partition_point(|&kept| width(&cut(kept), em) <= room);
    if kept == 0 { String::new() } else { cut(kept + 2) }
}

/// Wraps a text at spaces into at most `most` lines. A word that is too long is shortened, and so is the last line.
pub(super) fn wrap(text: &str, em: f64, room: f64, most: usize) -> Vec<String> {
    let (mut lines, mut line): (Vec<String>, String) = (Vec::new(), String::new());
    for word in text.split(' ') {
        let longer = if line.is_empty() { word.to_owned() } else { format!("{line} {word}") };
        if line.is_empty() || lines.len() + 1 == most || width(&longer, em) <= room {
            line = longer;
        } else {
            lines.push(std::mem::replace(&mut line, word.to_owned()));
        }
    }
    lines.push(line);
    lines.iter().map(|line| shorten(line, em, room)).collect()
}

/// Returns the text on one line, without characters that SVG does not allow.
pub(super) fn clean(text: &str) -> String {
    let good = |letter: char| match letter {
        '\u{fffe}' | '\u{ffff}' => '?',
        letter if letter.is_control() => ' ',
        letter => letter,
    };
    text.trim().chars().take(LONGEST).map(good).collect()
}

/// Returns the number with thin spaces between groups of three digits, and with a minus sign as wide as a plus sign.
pub(super) fn grouped(digits: &str) -> String {
    let (sign, digits) = digits.strip_prefix('-').map_or(("", digits), |digits| ("\u{2212}", digits));
    let (whole, part) = digits.split_once('.').map_or((digits, None), |(whole, part)| (whole, Some(part)));
    let mut text = sign.to_owned();
    for (place, digit) in whole.chars().enumerate() {
        if place > 0 && whole.len() > 4 && (whole.len() - place).is_multiple_of(3) {
            text.push('\u{2009}');
        }
        text.push(digit);
    }
    part.map_or(text.clone(), |part| format!("{text}.{part}"))
}

/// Formats a value for a line of text, with up to six digits.
pub(super) fn number(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    if value.fract() == 0.0 && value.abs() < 1e15 {
        return grouped(&format!("{value:.0}"));
    }
    if !(1e-4..1e9).contains(&value.abs()) {
        return format!("{value:.3e}");
    }
    let digits = (5 - value.abs().log10().floor() as i32).clamp(0, 9) as usize;
    let text = format!("{value:.digits$}");
    let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    grouped(text)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn text_that_fits_is_kept_and_longer_text_loses_its_middle() {
        use_bundled_font();
        let text = "STANDSTILL";
        let room = width(text, 11.0);
        assert!((66.0..76.0).contains(&room), "{room}");
        assert_eq!(shorten(text, 11.0, room), text);
        assert_eq!(shorten(text, 11.0, 55.0), "STA\u{2026}ILL");
        assert_eq!(shorten(text, 11.0, 10.0), "");
    }

    #[test]
    fn words_go_to_the_next_line_and_the_last_line_is_shortened() {
        use_bundled_font();
        let lines = wrap("one two three four five six", 11.0, width("one two th", 11.0), 2);
        assert_eq!(lines[0], "one two");
        assert!(lines.len() == 2 && lines[1].contains(DOTS), "{lines:?}");
    }

    #[test]
    fn numbers_are_grouped_by_thousands_and_short() {
        assert_eq!(grouped("-1234567.25"), "\u{2212}1\u{2009}234\u{2009}567.25");
        assert_eq!(grouped("1234"), "1234");
        assert_eq!(number(0.1 + 0.2), "0.3");
        assert_eq!(number(1.0 / 3.0), "0.333333");
        assert_eq!(number(1.5e-9), "1.500e-9");
    }

    #[test]
    fn characters_that_an_svg_cannot_hold_are_removed() {
        assert_eq!(clean(" a\tb\u{0}c\u{fffe}\n"), "a b c?");
    }

    proptest! {
        #[test]
        fn shortened_text_fits(text in ".{0,80}", room in 0.0..400.0) {
            use_bundled_font();
            prop_assert!(width(&shorten(&text, 11.0, room), 11.0) <= room);
        }
    }
}
