//! Text of a figure: how wide it is, and how it is shortened until it fits.
//!
//! All widths are those of the font that comes with the program. An SVG is shown in what its reader has for sans-serif,
//! which is hardly ever wider.

use ab_glyph::{Font as _, FontRef, GlyphId, OutlinedGlyph};
use std::collections::HashSet;

/// DejaVu Sans 2.37, unchanged; its licence stands beside it.
static BYTES: &[u8] = include_bytes!("../../../fonts/DejaVuSans.ttf");
const DOTS: char = '\u{2026}';

/// The font of all text.
pub(super) struct Font {
    font: FontRef<'static>,
    units_per_em: f32,
}

impl Font {
    pub(super) fn new() -> Self {
        let font = FontRef::try_from_slice(BYTES).expect("the bundled font is a font: a test reads it");
        let units_per_em = font.units_per_em().unwrap_or(1000.0);
        Self { font, units_per_em }
    }

    /// Width of a text (px) whose letters have the size `em` (px).
    pub(super) fn width(&self, text: &str, em: f64) -> f64 {
        text.chars().map(|letter| self.advance(self.font.glyph_id(letter))).sum::<f64>() * em
    }

    /// The letters of a text one after the other from 0, each as an outline with its place from the start of the text (px).
    pub(super) fn outlines(&self, text: &str, em: f64) -> Vec<OutlinedGlyph> {
        let size = em as f32 * self.font.height_unscaled() / self.units_per_em;
        let mut x = 0.0;
        let mut outlines = Vec::new();
        for letter in text.chars() {
            let id = self.font.glyph_id(letter);
            let glyph = id.with_scale_and_position(size, ab_glyph::point(x as f32, 0.0));
            outlines.extend(self.font.outline_glyph(glyph));
            x += self.advance(id) * em;
        }
        outlines
    }

    /// In em.
    fn advance(&self, id: GlyphId) -> f64 {
        f64::from(self.font.h_advance_unscaled(id) / self.units_per_em)
    }

    /// The text, or as much of its start as fits, with dots; empty where not even three letters do.
    pub(super) fn shorten(&self, text: &str, em: f64, room: f64) -> String {
        self.cut(text, em, room, |letters, kept| letters[..kept].iter().chain([&DOTS]).collect())
    }

    /// Names, or as much of the start and the end of each as fits, cut where they still differ.
    pub(super) fn shorten_names(&self, names: &[&str], em: f64, room: f64) -> Vec<String> {
        let count = |names: &mut dyn Iterator<Item = &str>| names.collect::<HashSet<_>>().len();
        let wanted = count(&mut names.iter().copied());
        // Names begin with their object and end with what it is: the middle tells the least, but where objects have numbers.
        let cuts = [2, 3, 1, 0, 4].map(|quarters| {
            let short = |name: &&str| self.shorten_within(name, em, room, quarters);
            names.iter().map(short).collect::<Vec<_>>()
        });
        let [middle, ..] = &cuts;
        let good = cuts.iter().find(|cut| count(&mut cut.iter().map(String::as_str)) == wanted);
        good.unwrap_or(middle).clone()
    }

    /// The text, or as much of its start and its end as fits, with so many quarters of that in front.
    fn shorten_within(&self, text: &str, em: f64, room: f64, quarters: usize) -> String {
        self.cut(text, em, room, |letters, kept| {
            let front = kept * quarters / 4;
            let back = kept - front;
            letters[..front].iter().chain([&DOTS]).chain(&letters[letters.len() - back..]).collect()
        })
    }

    fn cut(&self, text: &str, em: f64, room: f64, cut: impl Fn(&[char], usize) -> String) -> String {
        // No figure is wide enough for more letters than this.
        let letters: Vec<char> = text.chars().take(4000).collect();
        if letters.len() < 4000 && self.width(text, em) <= room {
            return text.to_owned();
        }
        let fits = |&kept: &usize| self.width(&cut(&letters, kept), em) <= room;
        let kept = (3..letters.len()).collect::<Vec<_>>().partition_point(fits);
        if kept == 0 { String::new() } else { cut(&letters, kept + 2).replace(" \u{2026}", "\u{2026}") }
    }

    /// Breaks a list of words into lines at its blanks; what does not fit in the last line is cut off with dots.
    pub(super) fn wrap(&self, text: &str, em: f64, room: f64, lines: usize) -> Vec<String> {
        let mut wrapped: Vec<String> = Vec::new();
        let mut line = String::new();
        for word in text.split(' ') {
            let longer = if line.is_empty() { word.to_owned() } else { format!("{line} {word}") };
            if line.is_empty() || wrapped.len() + 1 == lines || self.width(&longer, em) <= room {
                line = longer;
            } else {
                wrapped.push(std::mem::replace(&mut line, word.to_owned()));
            }
        }
        wrapped.push(line);
        wrapped.iter().map(|line| self.shorten(line, em, room)).collect()
    }
}

/// The text on one line, without what a picture cannot hold.
pub(super) fn clean(text: &str) -> String {
    let good = |letter: char| match letter {
        '\u{fffe}' | '\u{ffff}' => '?',
        letter if letter.is_control() => ' ',
        letter => letter,
    };
    text.trim().chars().take(4000).map(good).collect()
}

/// `inc/s^2` as people write it.
pub(super) fn unit(unit: &str) -> String {
    clean(unit).replace("^2", "\u{b2}").replace("^3", "\u{b3}").replace('*', "\u{b7}")
}

/// The whole number with thin spaces between its thousands, and a minus that is as wide as a plus.
pub(super) fn grouped(digits: &str) -> String {
    let (sign, digits) = digits.strip_prefix('-').map_or(("", digits), |digits| ("\u{2212}", digits));
    let (whole, part) =
        digits.split_once('.').map_or((digits, String::new()), |(whole, part)| (whole, format!(".{part}")));
    if whole.len() < 5 {
        return format!("{sign}{whole}{part}");
    }
    let mut text = sign.to_owned();
    for (place, digit) in whole.chars().enumerate() {
        if place > 0 && (whole.len() - place).is_multiple_of(3) {
            text.push('\u{2009}');
        }
        text.push(digit);
    }
    text + &part
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_text_that_fits_stays_and_a_longer_one_is_cut_at_its_end() {
        let font = Font::new();
        let text = "STANDSTILL";
        let width = font.width(text, 11.0);
        assert!((66.0..68.0).contains(&width), "{width}");
        assert_eq!(font.shorten(text, 11.0, width), text);
        assert_eq!(font.shorten(text, 11.0, 50.0), "STAND\u{2026}");
        assert_eq!(font.shorten(text, 11.0, 10.0), "");
    }

    #[test]
    fn names_are_cut_where_they_still_differ() {
        let font = Font::new();
        let of = |names: &[&str]| font.shorten_names(names, 12.0, 120.0);
        assert_eq!(of(&["turret.limit.software_positive", "x.y"]), ["turret.li\u{2026}e_positive", "x.y"]);
        let numbered = ["conveyor_11.actual.position", "conveyor_12.actual.position"];
        assert_eq!(of(&numbered), ["conveyor_11.\u{2026}ition", "conveyor_12.\u{2026}ition"]);
        let topics = ["x /left/cell/joint_states", "x /right/cell/joint_states"];
        assert_ne!(of(&topics)[0], of(&topics)[1]);
    }

    #[test]
    fn words_go_to_the_next_line_and_the_last_one_is_cut() {
        let font = Font::new();
        let lines = font.wrap("one two three four five six", 11.0, font.width("one two th", 11.0), 2);
        assert_eq!(lines, ["one two", "three fo\u{2026}"]);
    }

    #[test]
    fn numbers_are_grouped_by_thousands() {
        assert_eq!(grouped("-1234567.25"), "\u{2212}1\u{2009}234\u{2009}567.25");
        assert_eq!(grouped("1234"), "1234");
    }

    #[test]
    fn what_a_picture_cannot_hold_is_taken_out() {
        assert_eq!(clean(" a\tb\u{0}c\u{fffe}\n"), "a b c?");
        assert_eq!(unit("kg*m^2"), "kg\u{b7}m\u{b2}");
    }

    proptest! {
        #[test]
        fn a_shortened_text_fits(text in ".{0,80}", room in 0.0..400.0) {
            let font = Font::new();
            let names = font.shorten_names(&[&text, "x"], 11.0, room);
            for short in [font.shorten(&text, 11.0, room), names[0].clone()] {
                prop_assert!(font.width(&short, 11.0) <= room);
            }
        }
    }
}
