//! Parameters of encoders.

use super::vocabularies::SIDE_OR_OMITTED;
use crate::code::Code;
use crate::encoder::{Absolute, Parity, WordCode, source};
use serde::{Deserialize, Serialize};

/// Sources of positions, and their settings.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Encoders {
    /// Maximum change of the encoder per cycle (inc); `None`: not monitored.
    pub max_jump: Option<i64>,
    /// ENCODERTYPE
    pub encodertype: i64,
    /// MENCODERTYPE
    pub mencodertype: i64,
    /// Velocity of the simulated master (inc/s).
    pub master_velocity: f64,
    /// ENCCONTROL: bit 0 soft change, bit 1 soft zero.
    pub enccontrol: i64,
    /// MENCCONTROL: the same for the master.
    pub menccontrol: i64,
    /// ENCODERFREQ: clock rate (Hz), or with type 9 the distance of simulated marks (inc).
    pub encoderfreq: i64,
    /// Type of the encoder of the drive: 0 incremental, 1 absolute.
    pub kind: i64,
    /// Steps per turn times turns of an absolute encoder.
    pub steps: i64,
    /// Incremental: side of the cam on which reference travel ends; absolute: value of the first word.
    pub side_or_omitted: i64,
    /// Incremental: position of the reference point (inc); absolute: parity of the word, 0 none, 1 even, 2 odd.
    pub reference_or_parity: i64,
    /// Incremental: pulses per revolution; absolute: maximum change per cycle (inc); 0: not monitored.
    pub pulses_or_step: i64,
    /// Whether the encoder is monitored.
    pub monitored: i64,
    /// Absolute encoders of the cell that ENCODERTYPE can select.
    pub absolute: source::AbsoluteSources,
}

impl Default for Encoders {
    /// Returns the defaults of the rows.
    fn default() -> Self {
        Self {
            max_jump: None,
            encodertype: 0,
            mencodertype: 0,
            master_velocity: 0.0,
            enccontrol: 0,
            menccontrol: 0,
            encoderfreq: 262_000,
            kind: 0,
            steps: 0,
            side_or_omitted: 0,
            reference_or_parity: 0,
            pulses_or_step: 0,
            monitored: 0,
            absolute: source::AbsoluteSources::default(),
        }
    }
}

/// Clock rates of serial encoders (Hz).
const RATES: std::ops::RangeInclusive<i64> = 39_000..=5_000_000;

impl Encoders {
    /// Returns the absolute encoder of a positioning module: Gray code only (WF-ABS-01), with its parity (WF-MD-09).
    pub fn module(&self) -> Absolute {
        let parity = match self.reference_or_parity {
            1 => Some(Parity::Even),
            2 => Some(Parity::Odd),
            _ => None,
        };
        let steps = u32::try_from(self.steps).unwrap_or(u32::MAX).max(2);
        let max_step = (self.pulses_or_step > 0).then_some(self.pulses_or_step);
        let omitted = u32::try_from(self.side_or_omitted).unwrap_or(u32::MAX);
        Absolute { code: WordCode::Gray, parity, omitted, max_step, ..Absolute::single_turn(steps) }
    }

    /// Returns true if the axis reads an absolute encoder.
    pub fn is_absolute(&self) -> bool {
        self.kind == 1 || self.absolute.chosen_by(self.encodertype)
    }

    /// Checks that the numbers are valid.
    ///
    /// # Errors
    /// The key of an invalid number, and the reason.
    pub fn check(&self) -> Result<(), (&'static str, Code)> {
        match source::Feedback::decode(self.encodertype) {
            None => return Err(("encodertype", Code::ENCODER_UNKNOWN_TYPE)),
            Some(source::Feedback::Bus(_)) => return Err(("encodertype", Code::ENCODER_NEEDS_BUS)),
            Some(_) => {}
        }
        let is_simulated = source::Feedback::decode(self.encodertype) == Some(source::Feedback::Simulated);
        if !is_simulated && !RATES.contains(&self.encoderfreq) {
            return Err(("encoderfreq", Code::ENCODER_NO_RATE));
        }
        if self.kind == 0 && !(0..=2).contains(&self.side_or_omitted) {
            return Err((SIDE_OR_OMITTED, Code::WF_NO_CAM_SIDE));
        }
        match source::Master::decode(self.mencodertype) {
            None => Err(("mencodertype", Code::ENCODER_UNKNOWN_TYPE)),
            Some(source::Master::Bus(_)) => Err(("mencodertype", Code::ENCODER_NEEDS_BUS)),
            Some(_) => Ok(()),
        }
    }
}
