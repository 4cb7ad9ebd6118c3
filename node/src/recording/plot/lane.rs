//! Lanes of a timing diagram: states over time, reduced to those that are visible in a picture.

use super::curve::Window;
use super::text::clean;
use crate::recording::series::Kind;
use lineshaft_core::code::Code;

/// Width in px below which a state cannot be distinguished from its neighbours.
const NARROW: f64 = 1.5;

/// A range of a lane with one content.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LaneRange {
    /// Left edge, in px.
    pub(super) from: f64,
    /// Right edge, in px.
    pub(super) to: f64,
    pub(super) content: Content,
}

/// Content of a range of a lane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Content {
    Value(i64),
    /// Several values, each narrower than a pixel.
    Busy,
}

/// Returns the ranges of a signal. `width`, in px, is that of the whole time shown.
pub(super) fn stays(window: &Window<'_>, width: f64) -> Vec<LaneRange> {
    let scale = width / (window.to - window.from);
    let x = |time: f64| ((time - window.from) * scale).clamp(0.0, width);
    let mut lane = LaneBuilder::default();
    let mut open: Option<(f64, i64)> = None;
    for (time, value) in window.broken(window.steps()) {
        let (x, value) = (x(time), value.is_finite().then_some(value as i64));
        if let Some((from, before)) = open
            && value != Some(before)
        {
            lane.push(from, x, before);
            open = None;
        }
        open = open.or(value.map(|value| (x, value)));
    }
    if let Some((from, value)) = open {
        lane.push(from, width, value);
    }
    lane.flush();
    lane.done
}

#[derive(Debug, Default)]
struct LaneBuilder {
    done: Vec<LaneRange>,
    /// Adjacent narrow ranges: start, end, number, and value of the last one.
    narrow: Option<(f64, f64, usize, i64)>,
}

impl LaneBuilder {
    fn push(&mut self, from: f64, to: f64, value: i64) {
        if to - from >= NARROW {
            self.flush();
            self.done.push(LaneRange { from, to, content: Content::Value(value) });
            return;
        }
        match &mut self.narrow {
            Some((_, end, count, last)) if from <= *end + 1e-6 => {
                (*end, *count, *last) = (to, *count + 1, value);
            }
            _ => {
                self.flush();
                self.narrow = Some((from, to, 1, value));
            }
        }
    }

    fn flush(&mut self) {
        if let Some((from, to, count, value)) = self.narrow.take() {
            let content = if count == 1 { Content::Value(value) } else { Content::Busy };
            self.done.push(LaneRange { from, to: to.max(from + 1.0), content });
        }
    }
}

/// Returns a value of a lane as text.
pub(super) fn value_text(kind: &Kind, value: i64) -> String {
    match kind {
        Kind::Enum(names) => match usize::try_from(value).ok().and_then(|place| names.get(place)) {
            Some(name) => clean(name),
            None => value.to_string(),
        },
        Kind::Word => format!("{value:X}h"),
        Kind::Code => code_text(value),
        Kind::Real | Kind::Int | Kind::Bit => value.to_string(),
    }
}

/// Returns text such as `FOLLOWING_ERROR` or `DRIVE_FAULT 8611h`; the number if the code has no name.
fn code_text(value: i64) -> String {
    let code = u32::try_from(value).ok().map(Code);
    let name = Code::rows().find(|row| Some(row.code) == code).map(|row| row.name.to_owned());
    let fault = || {
        let fault = u16::try_from(value.checked_sub(i64::from(Code::DRIVE_FAULT))?).ok()?;
        Some(format!("DRIVE_FAULT {fault:X}h"))
    };
    name.or_else(fault).unwrap_or_else(|| value.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::series::Series;

    fn series(points: &[(f64, f64)], gaps: &[(f64, f64)]) -> Series {
        let (name, unit, topic) = (String::new(), String::new(), String::new());
        Series { name, unit, kind: Kind::Bit, topic, points: points.to_vec(), gaps: gaps.to_vec() }
    }

    fn of(points: &[(f64, f64)], width: f64) -> Vec<LaneRange> {
        stays(&Window::new(&series(points, &[]), 0.0, 10.0), width)
    }

    #[test]
    fn nothing_is_known_in_a_gap() {
        let series = series(&[(0.0, 1.0), (2.0, 1.0), (6.0, 1.0), (9.0, 1.0)], &[(2.0, 6.0), (9.0, 10.0)]);
        let stays = stays(&Window::new(&series, 0.0, 10.0), 100.0);
        assert_eq!(stays.iter().map(|stay| (stay.from, stay.to)).collect::<Vec<_>>(), [(0.0, 20.0), (60.0, 90.0)]);
    }

    #[test]
    fn codes_have_names() {
        let of = |value| value_text(&Kind::Code, value);
        assert_eq!((of(0), of(10_201)), ("NONE".to_owned(), "FOLLOWING_ERROR".to_owned()));
        assert_eq!((of(0x1_8611), of(77), of(-1)), ("DRIVE_FAULT 8611h".to_owned(), "77".to_owned(), "-1".to_owned()));
        assert_eq!(of(i64::MIN), i64::MIN.to_string());
    }

    #[test]
    fn equal_values_make_one_stay_and_the_last_one_holds_to_the_end() {
        let points = [(0.0, 1.0), (1.0, 1.0), (4.0, 2.0), (5.0, 2.0)];
        let stay = |from, to, value| LaneRange { from, to, content: Content::Value(value) };
        assert_eq!(of(&points, 100.0), [stay(0.0, 40.0, 1), stay(40.0, 100.0, 2)]);
    }

    #[test]
    fn a_pulse_of_one_cycle_is_seen() {
        let points = [(0.0, 0.0), (5.0, 1.0), (5.001, 0.0)];
        let pulse = of(&points, 100.0)[1];
        assert_eq!(pulse.content, Content::Value(1));
        assert!(pulse.to - pulse.from >= 1.0);
    }

    #[test]
    fn what_changes_faster_than_a_pixel_is_busy() {
        let points: Vec<(f64, f64)> = (0..1000).map(|n| (3.0 + f64::from(n) * 1e-3, f64::from(n % 2))).collect();
        let stays = of(&points, 100.0);
        assert_eq!(stays.iter().map(|stay| stay.content).collect::<Vec<_>>(), [Content::Busy, Content::Value(1)]);
        assert!((stays[0].from - 30.0).abs() < 1e-6 && (stays[0].to - 39.99).abs() < 1e-6);
    }

    #[test]
    fn not_a_number_is_a_gap() {
        let stays = of(&[(0.0, 1.0), (2.0, f64::NAN), (6.0, 1.0)], 100.0);
        assert_eq!(stays.iter().map(|stay| (stay.from, stay.to)).collect::<Vec<_>>(), [(0.0, 20.0), (60.0, 100.0)]);
    }

    #[test]
    fn a_state_without_a_name_is_its_number() {
        let kind = Kind::Enum(vec!["OFF".to_owned()]);
        assert_eq!(value_text(&kind, 0), "OFF");
        assert_eq!(value_text(&kind, -1), "-1");
        assert_eq!(value_text(&kind, 9), "9");
        assert_eq!(value_text(&Kind::Word, 0x1f), "1Fh");
    }
}
