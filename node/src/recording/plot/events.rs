//! Events of a figure: which of them are drawn, and where their numbers are placed.
//!
//! Law      errors are before warnings, warnings before limits, latches and ends of goals. Answers, states and
//!          parameters are never drawn, only counted. Expected events of objects without a signal in the figure are
//!          only counted as well.

use super::text::clean;
use crate::recording::series::EventMark;

/// Maximum number of events with a number and a text.
pub(super) const MOST_LISTED: usize = 12;

/// Maximum number of event kinds that are counted separately.
const MOST_KINDS: usize = 11;

/// An event with a number.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Listed {
    /// Number from 1, in the order of time.
    pub(super) number: usize,
    /// Time, in s.
    pub(super) time: f64,
    pub(super) severity: u8,
    pub(super) source: String,
    pub(super) text: String,
}

/// The events of a figure.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Events {
    pub(super) listed: Vec<Listed>,
    /// Events drawn without a number: time in s, and severity.
    pub(super) plain: Vec<(f64, u8)>,
    /// Text about the events that are not listed; empty if all are.
    pub(super) rest: String,
}

impl Events {
    /// Selects the events from `from` to `to` (in s) for a figure of these objects.
    pub(super) fn new(marks: &[EventMark], objects: &[&str], from: f64, to: f64) -> Self {
        let rank = |mark: &EventMark| {
            let is_shown = mark.severity > 0 || mark.source == "machine" || objects.contains(&mark.source.as_str());
            rank(mark).filter(|_| is_shown)
        };
        let mut marks: Vec<&EventMark> = marks.iter().filter(|mark| mark.time >= from && mark.time <= to).collect();
        marks.sort_by(|a, b| a.time.total_cmp(&b.time));
        let mut places: Vec<usize> = (0..marks.len()).filter(|&place| rank(marks[place]).is_some()).collect();
        places.sort_by_key(|&place| rank(marks[place]));
        let (listed, plain) = places.split_at(places.len().min(MOST_LISTED));
        let mut shown = vec![false; marks.len()];
        listed.iter().for_each(|&place| shown[place] = true);
        let kept = marks.iter().zip(&shown).filter(|(_, shown)| **shown).enumerate();
        let listed = kept
            .map(|(place, (mark, _))| Listed {
                number: place + 1,
                time: mark.time,
                severity: mark.severity,
                source: clean(&mark.source),
                text: sentence(mark),
            })
            .collect();
        let plain = plain.iter().map(|&place| (marks[place].time, marks[place].severity)).collect();
        let left_out: Vec<&EventMark> =
            marks.iter().zip(&shown).filter(|(_, shown)| !**shown).map(|(mark, _)| *mark).collect();
        Self { listed, plain, rest: rest(&left_out) }
    }
}

/// Returns the text of an event without its source, which has its own column in the list.
fn sentence(mark: &EventMark) -> String {
    let text = mark.text.strip_prefix(&mark.source).and_then(|text| text.strip_prefix(": ")).unwrap_or(&mark.text);
    clean(if text.is_empty() { &mark.kind } else { text })
}

/// Returns the rank of an event, lower for more important ones; `None` if it is never drawn.
fn rank(mark: &EventMark) -> Option<u8> {
    match (mark.severity, mark.kind.as_str()) {
        (2.., _) => Some(0),
        (1, _) => Some(1),
        (0, "limit" | "latch" | "mark" | "reset" | "homed" | "error" | "refused" | "overrun" | "warning") => Some(2),
        (0, "done") => Some(3),
        _ => None,
    }
}

/// Returns text such as `not listed: 2 errors, 1 warning, 40 accepted, 38 state`.
fn rest(marks: &[&EventMark]) -> String {
    let mut counts: Vec<(String, usize)> = Vec::new();
    for severity in [2, 1, 0] {
        let mut kinds: Vec<(String, usize)> = Vec::new();
        for mark in marks.iter().filter(|mark| mark.severity.min(2) == severity) {
            let kind = match severity {
                2 => "error".to_owned(),
                1 => "warning".to_owned(),
                _ => clean(&mark.kind),
            };
            let known = |kinds: &[(String, usize)], kind: &str| kinds.iter().position(|(name, _)| name == kind);
            // Usually there are few kinds, but a bag of another recorder may have any number.
            let kind =
                if kinds.len() < MOST_KINDS || known(&kinds, &kind).is_some() { kind } else { "other".to_owned() };
            match known(&kinds, &kind) {
                Some(place) => kinds[place].1 += 1,
                None => kinds.push((kind, 1)),
            }
        }
        kinds.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
        counts.extend(kinds);
    }
    let counted = |(kind, count): &(String, usize)| {
        let plural = if *count > 1 && ["error", "warning"].contains(&kind.as_str()) { "s" } else { "" };
        format!("{count} {kind}{plural}")
    };
    let counts: Vec<String> = counts.iter().map(counted).collect();
    if counts.is_empty() { String::new() } else { format!("events not listed: {}", counts.join(", ")) }
}

/// Returns places for tags of a given width near the wanted ones, in their order, without overlap and between two
/// edges.
pub(super) fn spread(wanted: &[f64], width: f64, low: f64, high: f64) -> Vec<f64> {
    let mut places: Vec<f64> = Vec::new();
    for &wanted in wanted {
        let least = places.last().map_or(low + width / 2.0, |last| last + width);
        places.push(wanted.max(least));
    }
    let mut most = high - width / 2.0;
    for place in places.iter_mut().rev() {
        *place = place.min(most);
        most = *place - width;
    }
    places
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn mark(time: f64, severity: u8, kind: &str) -> EventMark {
        let (source, text) = ("x".to_owned(), format!("{kind} at {time}"));
        EventMark { time, severity, kind: kind.to_owned(), source, text }
    }

    #[test]
    fn errors_and_warnings_come_before_what_is_expected() {
        let mut marks: Vec<EventMark> = (0..100).map(|n| mark(f64::from(n), 0, "latch")).collect();
        marks.extend((0..50).map(|n| mark(f64::from(n), 0, "accepted")));
        marks.extend([mark(70.5, 2, "error"), mark(80.5, 1, "refused"), mark(200.0, 2, "error")]);
        let events = Events::new(&marks, &["x"], 0.0, 100.0);
        assert_eq!(events.listed.len(), MOST_LISTED);
        let last: Vec<_> = events.listed[10..].iter().map(|one| (one.number, one.time, one.severity)).collect();
        assert_eq!(last, [(11, 70.5, 2), (12, 80.5, 1)]);
        assert_eq!(events.plain.len(), 90);
        assert_eq!(events.rest, "events not listed: 90 latch, 50 accepted");
    }

    #[test]
    fn what_is_shown_leaves_nothing_to_count() {
        let events = Events::new(&[mark(1.0, 2, "error")], &[], 0.0, 2.0);
        assert_eq!((events.listed.len(), events.rest.as_str()), (1, ""));
    }

    #[test]
    fn of_objects_that_are_not_shown_only_trouble_is() {
        let marks = [
            mark(1.0, 0, "done"),
            mark(2.0, 1, "refused"),
            EventMark { source: "y".to_owned(), ..mark(3.0, 0, "done") },
        ];
        let events = Events::new(&marks, &["y"], 0.0, 5.0);
        assert_eq!(events.listed.iter().map(|one| one.time).collect::<Vec<_>>(), [2.0, 3.0]);
        assert_eq!(events.rest, "events not listed: 1 done");
    }

    #[test]
    fn source_is_not_shown_twice() {
        let mark = EventMark { text: "x: drive fault 8611h".to_owned(), ..mark(1.0, 2, "error") };
        assert_eq!(Events::new(&[mark], &[], 0.0, 2.0).listed[0].text, "drive fault 8611h");
    }

    #[test]
    fn tags_that_meet_are_moved_apart() {
        assert_eq!(spread(&[50.0, 50.0, 50.0], 10.0, 0.0, 100.0), [50.0, 60.0, 70.0]);
        assert_eq!(spread(&[2.0, 3.0, 80.0], 10.0, 0.0, 100.0), [5.0, 15.0, 80.0]);
        assert_eq!(spread(&[99.0, 99.0], 10.0, 0.0, 100.0), [85.0, 95.0]);
    }

    proptest! {
        #[test]
        fn tags_never_overlap_and_stay_inside(mut wishes in prop::collection::vec(0.0..900.0, 0..12)) {
            wishes.sort_by(f64::total_cmp);
            let places = spread(&wishes, 20.0, 0.0, 900.0);
            prop_assert_eq!(places.len(), wishes.len());
            prop_assert!(places.windows(2).all(|pair| pair[1] - pair[0] >= 20.0 - 1e-6));
            prop_assert!(places.iter().all(|&place| (10.0 - 1e-6..=890.0 + 1e-6).contains(&place)), "{:?}", places);
        }
    }
}
