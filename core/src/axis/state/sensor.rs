//! State of the source of the actual position, and new zeros of a cycle.

use super::source::{Source, Wired};
use crate::encoder::{Form, Pulses, Reader};
use crate::parameter::AxisParameters;
use crate::position::Position;
use serde::{Deserialize, Serialize};

/// State of the source of the actual position.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(in crate::axis) struct Sensor {
    pub(in crate::axis) source: Source,
    /// Set while the source is new: its first value becomes the position (`Some(None)`), or the position stays this
    /// (inc, in the direction of the drive).
    pub(in crate::axis) starts: Option<Option<i64>>,
    /// Raw count of this cycle.
    pub raw: i64,
    /// Whether an index pulse came in this cycle.
    pub(in crate::axis) marked: bool,
    /// Whether the position of the last index pulse is valid in the coordinate of the axis.
    pub index_known: bool,
    /// Position of the axis at the last reading (inc).
    pub(in crate::axis) seen: i64,
    pub(in crate::axis) pulses: Pulses,
    /// Finding of supervision in this cycle.
    pub(in crate::axis) found: Option<Found>,
    /// Distance by which a new source has moved the coordinate.
    pub(in crate::axis) moved: Position,
    /// Distance by which other users of the encoder have moved its value (inc, in the direction of the drive).
    pub(in crate::axis) pending: i64,
    /// New zero of this cycle.
    pub(in crate::axis) claim: Option<Claim>,
}

/// A new zero of one cycle: of an encoder, or of a master that is an encoder.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Claim {
    /// Number of its command: of several new zeros of one encoder the last one counts.
    pub sequence: u64,
    /// Change of the displayed position (inc, in the direction of the encoder).
    pub by: i64,
    /// Whether it applies to the axis alone (MACS-ENC-11).
    pub is_soft: bool,
}

impl Claim {
    /// Returns the new zero combined with an earlier one of the same cycle, if there is one.
    pub fn after(self, before: Option<Self>) -> Self {
        Self { by: before.map_or(0, |before| before.by).saturating_add(self.by), ..self }
    }
}

/// A finding of supervision, kept until it can be reported.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(in crate::axis) enum Found {
    Substituted,
    Pulses { by: i64, tolerance: i64 },
}

impl Sensor {
    pub(in crate::axis) fn new(wired: Wired, encoders: usize, parameters: &AxisParameters) -> Self {
        // An unreadable source was refused before.
        let source = Source::of(wired, encoders, parameters).unwrap_or(Source::Drive(Form::Incremental(64)));
        Self {
            source,
            starts: matches!(source, Source::Encoder(_)).then_some(None),
            raw: 0,
            marked: false,
            index_known: false,
            seen: 0,
            pulses: Pulses::default(),
            found: None,
            moved: Position::ZERO,
            pending: 0,
            claim: None,
        }
    }

    /// Returns a reader for the process data of the drive.
    pub(in crate::axis) fn reader(&self) -> Reader {
        Reader::new(self.source.form())
    }

    pub(in crate::axis) fn is_simulated(&self) -> bool {
        self.source == Source::Simulated
    }

    /// Whether the encoder has no other user, and there is nothing to take over or to report.
    pub(in crate::axis) fn is_settled(&self) -> bool {
        let is_own = !matches!(self.source, Source::Encoder(_));
        let begins = self.starts.is_some() || self.marked || self.pending != 0 || self.moved != Position::ZERO;
        is_own && !begins && self.found.is_none() && self.claim.is_none()
    }
}
