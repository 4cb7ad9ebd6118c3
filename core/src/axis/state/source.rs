//! The source of the position of an axis, from the cell and its parameters.
//!
//! Law      ENCODERTYPE selects one of the sources of the cell: the process data of the drive, an entry of section
//!          `encoders`, the command
//! Refuses  sources that the cell does not have, sources that a drive with its own position loop does not read; for an
//!          axis with two drives, everything that both drives cannot do together
//! Source   MACS-ENC-01, -04, -07, -13; WF-ABS; contract section 8

use crate::axis::state::homing::methods::squares;
use crate::code::Code;
use crate::drive::Interface;
use crate::encoder::source::{self, AbsoluteSources};
use crate::encoder::{Absolute, Form, WordCode};
use crate::parameter::AxisParameters;
use crate::parameter::vocabularies::ENCODER_KIND;
use serde::{Deserialize, Serialize};

/// Source of the position in the cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Wired {
    /// Values of that form from the drive.
    Drive(Form),
    /// An entry of section `encoders`.
    Encoder(u16),
}

impl Wired {
    /// Returns which sources of an axis with this wiring are absolute. `entry`: forms of the entries of section
    /// `encoders`.
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
    /// Returns counts that do not wrap.
    fn default() -> Self {
        Self::Drive(Form::Incremental(64))
    }
}

/// Selected source of the position.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Source {
    /// Values of that form from the drive.
    Drive(Form),
    /// An entry of section `encoders`.
    Encoder(u16),
    /// The command while the axis is on (MACS-ENC-13); the position of the drive while it is off.
    Simulated,
}

impl Source {
    /// Returns the source that the parameters select from those of the cell.
    ///
    /// # Errors
    /// The key of the parameter that selects an unavailable source, and the reason.
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

    /// Whether a loop of that interface can use it. A drive with interface position closes the loop with its own
    /// encoder, whose values it decodes itself.
    pub fn fits(self, interface: Interface) -> bool {
        match self {
            Self::Drive(Form::Absolute(encoder)) => interface != Interface::Position || is_plain(encoder),
            Self::Drive(Form::Incremental(_)) | Self::Simulated => true,
            Self::Encoder(_) => interface != Interface::Position,
        }
    }

    /// Whether both read the same values. The largest step is only a check.
    pub(in crate::axis) fn reads_as(self, other: Self) -> bool {
        let read = |source| match source {
            Self::Drive(Form::Absolute(encoder)) => Self::Drive(Form::Absolute(Absolute { max_step: None, ..encoder })),
            other => other,
        };
        read(self) == read(other)
    }

    /// Returns the form of the values from the drive.
    pub(in crate::axis) fn form(self) -> Form {
        match self {
            Self::Drive(form) => form,
            Self::Encoder(_) | Self::Simulated => Form::Incremental(64),
        }
    }
}

/// Whether its values are counts, so that a drive may close its loop with it.
fn is_plain(encoder: Absolute) -> bool {
    encoder.code == WordCode::Binary && encoder.parity.is_none() && !encoder.corrects
}

/// Checks whether the axis can read the source of its parameters.
///
/// # Errors
/// The key of the invalid parameter, and the reason.
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

/// Checks whether two drives can move an axis with these parameters.
///
/// # Errors
/// The key of the parameter that prevents it, and the reason.
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
