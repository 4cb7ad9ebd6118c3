//! The source of an axis' position, as the cell and its parameters name it.
//!
//! Law      ENCODERTYPE chooses among what the cell has: the drive's words, an entry of section `encoders`, the command
//! Refuses  sources that the cell does not have, sources that a drive which closes the loop itself does not read; of an axis with two drives
//!          what both cannot do together
//! Source   MACS-ENC-01, -04, -07, -13; WF-ABS; contract section 8

use super::homing::methods::squares;
use crate::code::Code;
use crate::drive::Interface;
use crate::encoder::source::AbsoluteSources;
use crate::encoder::{Absolute, Form, WordCode, source};
use crate::parameter::AxisParameters;
use crate::parameter::vocabularies::ENCODER_KIND;
use serde::{Deserialize, Serialize};

/// What the cell says of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Wired {
    /// The drive tells it in words of that form.
    Drive(Form),
    /// An entry of section `encoders`.
    Encoder(u16),
}

impl Wired {
    /// Which sources of an axis that is wired so are absolute, where the entries of section `encoders` have these
    /// forms.
    pub fn absolute_sources(self, entry: impl Fn(u16) -> Option<Form>) -> AbsoluteSources {
        let is_absolute = |form| matches!(form, Some(Form::Absolute(_)));
        let own = match self {
            Self::Drive(form) => is_absolute(Some(form)),
            Self::Encoder(place) => is_absolute(entry(place)),
        };
        AbsoluteSources { own, terminals: [0, 1, 2].map(|place| is_absolute(entry(place))) }
    }
}

impl Default for Wired {
    /// Counts that do not wrap.
    fn default() -> Self {
        Self::Drive(Form::Incremental(64))
    }
}

/// Where the position comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Source {
    /// The drive, in words of that form.
    Drive(Form),
    /// An entry of section `encoders`.
    Encoder(u16),
    /// The command, while the axis is on (MACS-ENC-13); off, where the drive stands.
    Simulated,
}

impl Source {
    /// What parameters make of what the cell says.
    ///
    /// # Errors
    /// The key of the parameter that asks for something that is not there, and why not.
    pub fn of(wired: Wired, encoders: usize, p: &AxisParameters) -> Result<Self, (&'static str, Code)> {
        use source::Feedback;
        const KEY: &str = "encodertype";
        let own = || match wired {
            Wired::Drive(_) if p.encoder.kind == 1 => Self::Drive(Form::Absolute(p.encoder.module())),
            Wired::Drive(form) => Self::Drive(form),
            Wired::Encoder(place) => Self::Encoder(place),
        };
        let chosen = Feedback::decode(p.encoder.encodertype).ok_or((KEY, Code::ENCODER_UNKNOWN_TYPE))?;
        if p.encoder.kind == 1 && (chosen != Feedback::Incremental || matches!(wired, Wired::Encoder(_))) {
            return Err((ENCODER_KIND, Code::ENCODER_CHOSEN_TWICE));
        }
        match chosen {
            Feedback::Incremental | Feedback::SineCosine => Ok(own()),
            Feedback::Absolute { corrects, .. } => match wired {
                Wired::Drive(form) => {
                    let steps = u32::try_from(p.macs.encoder).unwrap_or(u32::MAX).max(2);
                    let encoder = match form {
                        Form::Absolute(encoder) => encoder,
                        Form::Incremental(_) => Absolute::single_turn(steps),
                    };
                    Ok(Self::Drive(Form::Absolute(Absolute { overflow: !corrects, corrects, ..encoder })))
                }
                Wired::Encoder(_) => Err((KEY, Code::ENCODER_CHOSEN_TWICE)),
            },
            Feedback::Simulated => Ok(Self::Simulated),
            Feedback::Terminal(number) if usize::from(number) <= encoders => Ok(Self::Encoder(u16::from(number) - 1)),
            Feedback::Terminal(_) => Err((KEY, Code::ENCODER_NO_TERMINAL)),
            Feedback::Bus(_) => Err((KEY, Code::ENCODER_NEEDS_BUS)),
        }
    }

    /// Can a loop that is closed there use it? A drive with interface position closes it with its own encoder, whose words it
    /// decodes itself.
    pub fn fits(self, interface: Interface) -> bool {
        match self {
            Self::Drive(Form::Absolute(encoder)) => interface != Interface::Position || is_plain(encoder),
            Self::Drive(Form::Incremental(_)) | Self::Simulated => true,
            Self::Encoder(_) => interface != Interface::Position,
        }
    }

    /// Does it read the same words as another one? How large a step may be only judges them.
    pub(super) fn reads_as(self, other: Self) -> bool {
        let read = |source| match source {
            Self::Drive(Form::Absolute(encoder)) => Self::Drive(Form::Absolute(Absolute { max_step: None, ..encoder })),
            other => other,
        };
        read(self) == read(other)
    }

    /// Form of the words that the drive tells.
    pub(super) fn form(self) -> Form {
        match self {
            Self::Drive(form) => form,
            Self::Encoder(_) | Self::Simulated => Form::Incremental(64),
        }
    }
}

/// Are its words counts, so that a drive may close its loop with it?
fn is_plain(encoder: Absolute) -> bool {
    encoder.code == WordCode::Binary && encoder.parity.is_none() && !encoder.corrects
}

/// May the axis read what its parameters say?
///
/// # Errors
/// The key that says otherwise, and why it may not.
pub fn may_read(
    wired: Wired,
    encoders: usize,
    interface: Option<Interface>,
    parameters: &AxisParameters,
) -> Result<(), (&'static str, Code)> {
    let Some(interface) = interface else { return Ok(()) };
    let source = Source::of(wired, encoders, parameters)?;
    match parameters.encoder.kind {
        _ if source.fits(interface) => Ok(()),
        1 => Err((ENCODER_KIND, Code::WF_LOOP_IN_DRIVE)),
        _ => Err(("encodertype", Code::ENCODER_LOOP_IN_DRIVE)),
    }
}

/// Can two drives carry an axis with these parameters?
///
/// # Errors
/// The key of the parameter that does not let them, and why not.
pub fn may_carry(wired: Wired, p: &AxisParameters) -> Result<(), (&'static str, Code)> {
    if p.gantry.max_skew.is_none() {
        return Err(("max_skew", Code::GANTRY_NO_LIMIT));
    }
    if p.homing.in_drive {
        return Err(("homing.in_drive", Code::GANTRY_IN_DRIVE));
    }
    if p.homing.method != 0 && !squares(p.homing.method) {
        return Err(("homing.method", Code::GANTRY_HOMING));
    }
    let (switch, second) = (p.assigned.refswitch.unsigned_abs(), p.gantry.second_refswitch.unsigned_abs());
    if switch != 0 && switch == second {
        return Err(("i_refswitch_second", Code::GANTRY_ONE_SWITCH));
    }
    match (wired, Source::of(wired, 0, p)) {
        (Wired::Drive(form), Ok(source)) if source == Source::Drive(form) => Ok(()),
        _ if p.encoder.kind == 1 => Err((ENCODER_KIND, Code::GANTRY_SOURCE)),
        _ => Err(("encodertype", Code::GANTRY_SOURCE)),
    }
}
