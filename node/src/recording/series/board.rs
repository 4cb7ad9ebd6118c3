//! Loads the signals of a machine from ~/signals and the attached cell.

use super::select::{Select, alias};
use super::{Budget, LateMessages, Refusal, SeriesError, Track};
use crate::cell::Cell;
use lineshaft_core::config::MachineConfig;
use lineshaft_core::machine::Machine;
use lineshaft_core::signal::{Entry, Measure, Type};
use lineshaft_core::unit::Scale;
use lineshaft_msgs::msg::Signals;

/// Conversion of the words of a signal to values.
#[derive(Clone, Copy, Debug)]
struct Reading {
    /// Index of its track; `None` if the signal is not selected.
    track: Option<usize>,
    is_real: bool,
    scale: Option<(Scale, u8)>,
    /// Time in ns from which cycles are missing, if its value has been unknown since then.
    unknown: Option<u64>,
}

/// The signals of a board over time.
pub(super) struct BoardTracks {
    readings: Vec<Reading>,
    tracks: Vec<Track>,
    /// Number and time of the previous cycle.
    previous: Option<(u64, u64)>,
    topic: String,
    /// Number of cycles whose time is before that of the previous cycle.
    late: u64,
}

impl BoardTracks {
    /// Creates the tracks for the machine of a cell; only selected signals are kept.
    pub(super) fn new(
        (cell, files): (&[u8], Option<&str>),
        topic: &str,
        select: &mut Select,
    ) -> Result<Self, SeriesError> {
        let text = String::from_utf8_lossy(cell);
        let cell = Cell::parse_recorded("cell.yaml", text, files).map_err(SeriesError::Cell)?;
        let machine = Machine::new(cell.machine)?;
        let (mut readings, mut tracks) = (Vec::new(), Vec::new());
        for (_, entry) in machine.directory().iter() {
            let scale = scale_of(machine.config(), entry);
            let alias = alias(&entry.name).filter(|alias| machine.directory().find(alias).is_none());
            let track = select.wants(&entry.name, alias.as_deref()).then(|| {
                let unit = match scale {
                    Some((scale, order)) => scale.unit().unit().with_order(order).to_string(),
                    None => entry.measure.unit().to_owned(),
                };
                tracks.push(Track::new(entry.name.clone(), unit, entry.kind, topic.to_owned()));
                tracks.len() - 1
            });
            readings.push(Reading { track, is_real: entry.kind == Type::Real, scale, unknown: None });
        }
        Ok(Self { readings, tracks, previous: None, topic: topic.to_owned(), late: 0 })
    }

    /// Adds the signals of a cycle.
    pub(super) fn take(&mut self, time: u64, signals: &Signals, budget: &mut Budget) -> Result<(), Refusal> {
        let Signals { index, word, .. } = signals;
        if index.len() != word.len() {
            return Err(format!("index has {} places, word has {}", index.len(), word.len()).into());
        }
        let (before, previous) = self.previous.unwrap_or((signals.cycle.wrapping_sub(1), time));
        self.late += u64::from(time < previous);
        // If the clock was set back, the time stays the same.
        let time = time.max(previous);
        if signals.cycle.wrapping_sub(before) != 1 {
            // A change in the missing cycles is visible only at the next change, or in a message with all signals.
            self.readings.iter_mut().for_each(|reading| reading.unknown = reading.unknown.or(Some(previous)));
        }
        for (&index, &word) in index.iter().zip(word) {
            let Some(reading) = self.readings.get_mut(index as usize) else {
                return Err(format!("place {index} of {} signals", self.readings.len()).into());
            };
            let unknown = reading.unknown.take();
            if let Some(track) = reading.track.and_then(|track| self.tracks.get_mut(track)) {
                let value = reading.value(word);
                match unknown {
                    Some(from) => track.resume(from, time, value, budget)?,
                    None => track.change(previous, time, value, budget)?,
                }
            }
        }
        self.previous = Some((signals.cycle, time));
        Ok(())
    }

    /// Returns the tracks, each up to the last cycle, and the late cycles.
    pub(super) fn finish(mut self, budget: &mut Budget) -> Result<(Vec<Track>, Option<LateMessages>), Refusal> {
        let end = self.previous.map_or(0, |(_, time)| time);
        for reading in &self.readings {
            let Some(track) = reading.track.and_then(|track| self.tracks.get_mut(track)) else { continue };
            match reading.unknown {
                Some(from) => track.lose(from, end, budget)?,
                None => track.finish(end),
            }
        }
        let late =
            (self.late > 0).then_some(LateMessages { topic: self.topic, messages: self.late, are_left_out: false });
        Ok((self.tracks, late))
    }
}

impl Reading {
    fn value(&self, word: u64) -> f64 {
        let (int, real) = (word.cast_signed(), f64::from_bits(word));
        match self.scale {
            Some((scale, 0)) if !self.is_real => scale.position_to_unit(int, 0.0),
            Some((scale, _)) => scale.rate_to_unit(real),
            None if self.is_real => real,
            None => int as f64,
        }
    }
}

/// Returns the scale in which a signal is displayed, and its order of derivative.
fn scale_of(config: &MachineConfig, entry: &Entry) -> Option<(Scale, u8)> {
    let order = match entry.measure {
        Measure::Position => 0,
        Measure::Velocity => 1,
        Measure::Acceleration => 2,
        Measure::Jerk => 3,
        Measure::None | Measure::Voltage => return None,
    };
    let (object, signal) = entry.name.split_once('.')?;
    // The increments of the leader may have another scale. Counts from and to the drive have their own direction and
    // origin.
    if signal == "sync.master" || signal == "output.position" || signal.rsplit('.').next() == Some("count") {
        return None;
    }
    let axis = config.axes.iter().find(|axis| axis.name == object).map(|axis| axis.scale);
    let scale = axis.or_else(|| config.encoders.iter().find(|encoder| encoder.name == object).map(|found| found.scale));
    // If the axis unit is a fraction of a unit, such as 0.1 mm, values are given in the unit itself, because it has a
    // name.
    let scale = scale.filter(|scale| !scale.is_in_increments());
    scale.map(|scale| (scale.with_unit(scale.unit().unit()).unwrap_or(scale), order))
}
