//! Colours and dashes of a figure.

use super::canvas::{Colour, Stroke};

pub(super) const PAPER: Colour = Colour(255, 255, 255);
pub(super) const INK: Colour = Colour(34, 34, 34);
pub(super) const PALE_INK: Colour = Colour(95, 95, 95);
pub(super) const FRAME: Colour = Colour(150, 150, 150);
pub(super) const GRID: Colour = Colour(230, 230, 230);
pub(super) const BIT_EDGE: Colour = Colour(0, 114, 178);
pub(super) const BIT_FILL: Colour = Colour(176, 212, 236);
/// A lane that changes faster than a pixel.
pub(super) const BUSY: Colour = Colour(150, 150, 150);
pub(super) const LANE_EDGE: Colour = Colour(120, 120, 120);

/// Okabe and Ito without the yellow, which is hard to see on white, and a grey for their black; neighbours differ the most.
const CURVES: [Colour; 7] = [
    Colour(0, 114, 178),
    Colour(213, 94, 0),
    Colour(230, 159, 0),
    Colour(204, 121, 167),
    Colour(0, 158, 115),
    Colour(50, 50, 50),
    Colour(86, 180, 233),
];

/// The first curve of a panel, below the others, is wide and without gaps.
const FIRST: f64 = 3.0;
const ALONE: f64 = 2.0;
/// All others are narrower and have gaps, through which those below show: lengths of dash and gap (px).
const DASHES: [&[f64]; 6] =
    [&[8.0, 5.0], &[3.0, 6.0], &[12.0, 8.0, 2.0, 8.0], &[16.0, 12.0], &[5.0, 11.0], &[2.0, 4.0, 2.0, 10.0]];

/// How the curve in this place among the `count` of its panel is drawn. The first 43 differ.
pub(super) fn curve(place: usize, count: usize) -> Stroke {
    let colour = CURVES[place % CURVES.len()];
    match place.checked_sub(1) {
        None => Stroke { colour, width: if count > 1 { FIRST } else { ALONE }, dash: &[] },
        Some(further) => Stroke { colour, width: 1.6, dash: DASHES[further % DASHES.len()] },
    }
}

/// A mark, by severity.
pub(super) fn mark(severity: u8) -> Colour {
    match severity {
        0 => Colour(120, 120, 120),
        1 => Colour(214, 120, 0),
        _ => Colour(200, 30, 30),
    }
}

const STATES: [Colour; 7] = [
    Colour(205, 235, 222),
    Colour(204, 224, 242),
    Colour(250, 224, 200),
    Colour(240, 218, 232),
    Colour(250, 240, 200),
    Colour(216, 238, 250),
    Colour(218, 212, 236),
];

/// The ground of a state, by its number and name: faults are red, what is off is grey.
pub(super) fn state(number: usize, name: &str) -> Colour {
    let name = name.to_ascii_uppercase();
    if name.contains("ERROR") || name.contains("FAULT") {
        Colour(244, 178, 170)
    } else if name.contains("DISABLED") || name.starts_with("NOT_READY") || name == "OFF" {
        Colour(226, 226, 226)
    } else {
        STATES[number.wrapping_sub(1) % STATES.len()]
    }
}

/// The ground of a code: any but 0 is an error.
pub(super) fn code(number: i64) -> Colour {
    if number == 0 { state(0, "OFF") } else { state(0, "ERROR") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_two_of_many_curves_look_the_same() {
        let looks: Vec<(Colour, &[f64])> =
            (0..43).map(|place| (curve(place, 43).colour, curve(place, 43).dash)).collect();
        for (place, look) in looks.iter().enumerate() {
            assert!(!looks[..place].contains(look), "{place}");
        }
    }

    #[test]
    fn a_curve_on_another_one_covers_it_nowhere_for_long() {
        for place in 1..43 {
            let (stroke, gaps) = (curve(place, 43), curve(place, 43).dash.chunks_exact(2));
            assert!(stroke.width < curve(0, 43).width);
            assert!(!stroke.dash.is_empty() && gaps.remainder().is_empty() && gaps.clone().all(|gap| gap[1] >= 3.0));
        }
    }
}
