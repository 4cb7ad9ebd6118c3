//! Parameters of encoders.

use crate::code::Code;
use crate::encoder::{Absolute, Parity, WordCode, source};
use serde::{Deserialize, Serialize};

/// Where positions come from, and how their sources are read.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Encoders {
    /// Most that the encoder moves in a cycle (inc); left out: not supervised.
    pub max_jump: Option<i64>,
    /// ENCODERTYPE
    pub encodertype: i64,
    /// MENCODERTYPE
    pub mencodertype: i64,
    /// Velocity of the simulated master (inc/s).
    pub master_velocity: f64,
    /// ENCCONTROL: bit 0 soft change, bit 1 soft zero.
    pub enccontrol: i64,
    /// MENCCONTROL: the same of the master.
    pub menccontrol: i64,
    /// ENCODERFREQ: clock rate (Hz), or with type 9 the distance of simulated marks (inc).
    pub encoderfreq: i64,
    /// MD4: 0 incremental, 1 absolute.
    pub md4: i64,
    /// MD5: steps of a turn times turns of an absolute encoder.
    pub md5: i64,
    /// MD7: incremental: side of the cam on which reference travel ends; absolute: value of the first word.
    pub md7: i64,
    /// MD34: incremental: pulses of a revolution; absolute: largest step of a cycle (inc); 0: not supervised.
    pub md34: i64,
    /// MD41: encoder monitoring is on.
    pub md41: i64,
    /// What the cell has for ENCODERTYPE to choose from.
    pub absolute: source::AbsoluteSources,
}

impl Default for Encoders {
    /// As the rows have it.
    fn default() -> Self {
        Self {
            max_jump: None,
            encodertype: 0,
            mencodertype: 0,
            master_velocity: 0.0,
            enccontrol: 0,
            menccontrol: 0,
            encoderfreq: 262_000,
            md4: 0,
            md5: 0,
            md7: 0,
            md34: 0,
            md41: 0,
            absolute: source::AbsoluteSources::default(),
        }
    }
}

/// Clock rates of serial encoders (Hz).
const RATES: std::ops::RangeInclusive<i64> = 39_000..=5_000_000;

impl Encoders {
    /// The absolute encoder of a positioning module: Gray code only (WF-ABS-01); MD16 is its parity (WF-MD-09).
    pub fn module(&self, md16: i64) -> Absolute {
        let parity = match md16 {
            1 => Some(Parity::Even),
            2 => Some(Parity::Odd),
            _ => None,
        };
        let steps = u32::try_from(self.md5).unwrap_or(u32::MAX).max(2);
        let max_step = (self.md34 > 0).then_some(self.md34);
        let omitted = u32::try_from(self.md7).unwrap_or(u32::MAX);
        Absolute { code: WordCode::Gray, parity, omitted, max_step, ..Absolute::single_turn(steps) }
    }

    /// Is what the axis reads an absolute encoder?
    pub fn is_absolute(&self) -> bool {
        self.md4 == 1 || self.absolute.chosen_by(self.encodertype)
    }

    /// Are the numbers ones that there are?
    ///
    /// # Errors
    /// The key of one that is not, and why.
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
        if self.md4 == 0 && !(0..=2).contains(&self.md7) {
            return Err(("wf.md7", Code::WF_NO_CAM_SIDE));
        }
        match source::Master::decode(self.mencodertype) {
            None => Err(("mencodertype", Code::ENCODER_UNKNOWN_TYPE)),
            Some(source::Master::Bus(_)) => Err(("mencodertype", Code::ENCODER_NEEDS_BUS)),
            Some(_) => Ok(()),
        }
    }
}
