//! Common wrapper of all function types.

mod apsf;
mod binea;
mod cam;
mod copy;
mod dfkt;
mod digdreh;
mod epos;
mod fgen;
mod imes;
mod interpolator;
mod regl;
mod sidiff;
mod varsync;

use super::field::{Field, Words};
use super::kind::Kind;
use super::program::{CallInputs, Fault, FunctionProgram, Outcome, Progress, Setting, WORDS};
use super::shown::Shown;
use super::wires::MemorySize;
use apsf::Apsf;
use binea::Binea;
use cam::Cam;
use copy::{Dcopy, Ecopy};
use dfkt::Dfkt;
use digdreh::SpeedSwitch;
use epos::Epos;
use fgen::Fgen;
use imes::Imes;
use interpolator::fipw::{self, Fipw};
use interpolator::fipz::{self, Fipz};
use interpolator::xfipw::{self, Xfipw};
use lineshaft_program::Module;
use regl::PidFunction;
use serde::{Deserialize, Serialize};
use sidiff::Sidiff;
use varsync::Varsync;

pub(super) const DCOPY: &[Field] = copy::DCOPY_FIELDS;
pub(super) const ECOPY: &[Field] = copy::ECOPY_FIELDS;
pub(super) const SIDIFF: &[Field] = sidiff::FIELDS;
pub(super) const VARSYNC: &[Field] = varsync::FIELDS;
pub(super) const DIGDREH: &[Field] = digdreh::FIELDS;
pub(super) const IMES: &[Field] = imes::FIELDS;
pub(super) const BINEA: &[Field] = binea::FIELDS;
pub(super) const CAM: &[Field] = cam::FIELDS;
pub(super) const FIPW: &[Field] = fipw::FIELDS;
pub(super) const FIPZ: &[Field] = fipz::FIELDS;
pub(super) const XFIPW: &[Field] = xfipw::FIELDS;
pub(super) const DFKT: &[Field] = dfkt::FIELDS;
pub(super) const DFKT_SHOWS: &[Shown] = dfkt::SHOWS;
pub(super) const FGEN: &[Field] = fgen::FIELDS;
pub(super) const REGL: &[Field] = regl::FIELDS;
pub(super) const EPOS: &[Field] = epos::FIELDS;
pub(super) const APSF: &[Field] = apsf::FIELDS;

/// Returns the modes of a type in ascending order; none if the range of its field defines them.
pub(crate) fn modes(kind: Kind) -> Vec<i64> {
    match kind {
        Kind::Fipw => interpolator::modes(false),
        Kind::Xfipw => interpolator::modes(true),
        _ => Vec::new(),
    }
}

/// A function of any type.
#[derive(Debug, Serialize, Deserialize)]
pub(super) enum Any {
    Dcopy(Dcopy),
    Ecopy(Ecopy),
    Sidiff(Sidiff),
    Varsync(Varsync),
    Digdreh(SpeedSwitch),
    Imes(Imes),
    Binea(Binea),
    Cam(Cam),
    Fipw(Fipw),
    Fipz(Fipz),
    Xfipw(Xfipw),
    Dfkt(Dfkt),
    Fgen(Fgen),
    Regl(PidFunction),
    Epos(Epos),
    Apsf(Box<Apsf>),
}

/// Applies the same expression to a function of any type.
macro_rules! each {
    ($any:expr, $function:ident => $do:expr) => {
        match $any {
            Any::Dcopy($function) => $do,
            Any::Ecopy($function) => $do,
            Any::Sidiff($function) => $do,
            Any::Varsync($function) => $do,
            Any::Digdreh($function) => $do,
            Any::Imes($function) => $do,
            Any::Binea($function) => $do,
            Any::Cam($function) => $do,
            Any::Fipw($function) => $do,
            Any::Fipz($function) => $do,
            Any::Xfipw($function) => $do,
            Any::Dfkt($function) => $do,
            Any::Fgen($function) => $do,
            Any::Regl($function) => $do,
            Any::Epos($function) => $do,
            Any::Apsf($function) => $do,
        }
    };
}

impl Any {
    /// Creates a function at rest, with all memory that it will need.
    pub(super) fn new(kind: Kind, has_words: [bool; WORDS], room: MemorySize, module: Option<&Module>) -> Self {
        let [has_word, _] = has_words;
        match kind {
            Kind::Dcopy => Self::Dcopy(Dcopy::new()),
            Kind::Ecopy => Self::Ecopy(Ecopy::new()),
            Kind::Sidiff => Self::Sidiff(Sidiff::new()),
            Kind::Varsync => Self::Varsync(Varsync::new(has_word)),
            Kind::Digdreh => Self::Digdreh(SpeedSwitch::new()),
            Kind::Imes => Self::Imes(Imes::new()),
            Kind::Binea => Self::Binea(Binea::new(room.mean, has_word)),
            Kind::Cam => Self::Cam(Cam::new(room.mean, room.cams)),
            Kind::Fipw => Self::Fipw(Fipw::new()),
            Kind::Fipz => Self::Fipz(Fipz::new()),
            Kind::Xfipw => Self::Xfipw(Xfipw::new()),
            Kind::Dfkt => Self::Dfkt(Dfkt::new()),
            Kind::Fgen => Self::Fgen(Fgen::new(has_word)),
            Kind::Regl => Self::Regl(PidFunction::new(has_words)),
            Kind::Epos => Self::Epos(Epos::new(has_words)),
            Kind::Apsf => Self::Apsf(Box::new(Apsf::new(module))),
        }
    }

    pub(super) fn kind(&self) -> Kind {
        match self {
            Self::Dcopy(_) => Kind::Dcopy,
            Self::Ecopy(_) => Kind::Ecopy,
            Self::Sidiff(_) => Kind::Sidiff,
            Self::Varsync(_) => Kind::Varsync,
            Self::Digdreh(_) => Kind::Digdreh,
            Self::Imes(_) => Kind::Imes,
            Self::Binea(_) => Kind::Binea,
            Self::Cam(_) => Kind::Cam,
            Self::Fipw(_) => Kind::Fipw,
            Self::Fipz(_) => Kind::Fipz,
            Self::Xfipw(_) => Kind::Xfipw,
            Self::Dfkt(_) => Kind::Dfkt,
            Self::Fgen(_) => Kind::Fgen,
            Self::Regl(_) => Kind::Regl,
            Self::Epos(_) => Kind::Epos,
            Self::Apsf(_) => Kind::Apsf,
        }
    }

    pub(super) fn check(&self, words: Words<'_>, setting: &Setting<'_>) -> Result<(), Fault> {
        each!(self, function => function.check(words, setting))
    }

    pub(super) fn start(&mut self, words: Words<'_>, seen: &CallInputs<'_>) -> Outcome {
        each!(self, function => function.start(words, seen))
    }

    pub(super) fn renew(&mut self, words: Words<'_>) {
        each!(self, function => function.apply_values(words));
    }

    #[inline]
    pub(super) fn step(&mut self, seen: &CallInputs<'_>) -> Outcome {
        each!(self, function => function.step(seen))
    }

    pub(super) fn read(&self, words: Words<'_>, setting: &Setting<'_>) -> Result<Option<(u16, i64)>, Fault> {
        each!(self, function => function.read(words, setting))
    }

    pub(super) fn progress(&self) -> Progress {
        each!(self, function => function.progress())
    }

    pub(super) fn drop_order(&mut self) {
        each!(self, function => function.drop_order());
    }

    pub(super) fn rests(&self, rests: u8) -> u8 {
        each!(self, function => function.rests(rests))
    }

    /// Returns true if both functions have the same setup, in any state.
    pub(super) fn is_set_up_as(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Varsync(mine), Self::Varsync(other)) => mine.is_set_up_as(other),
            (Self::Binea(mine), Self::Binea(other)) => mine.is_set_up_as(other),
            (Self::Cam(mine), Self::Cam(other)) => mine.is_set_up_as(other),
            (Self::Fgen(mine), Self::Fgen(other)) => mine.is_set_up_as(other),
            (Self::Regl(mine), Self::Regl(other)) => mine.is_set_up_as(other),
            (Self::Epos(mine), Self::Epos(other)) => mine.is_set_up_as(other),
            (Self::Apsf(mine), Self::Apsf(other)) => mine.room() == other.room(),
            _ => self.kind() == other.kind(),
        }
    }

    pub(super) fn is_set(&self, words: Words<'_>, call_ns: u64) -> bool {
        each!(self, function => function.runs_with(words, call_ns))
    }

    /// Returns the published values that it stores; `None` if each call returns them.
    #[inline]
    pub(super) fn shown(&self) -> Option<&[i64]> {
        match self {
            Self::Dfkt(function) => Some(function.shown()),
            Self::Fgen(function) => Some(function.shown()),
            Self::Epos(function) => Some(function.shown()),
            Self::Apsf(function) => Some(function.shown()),
            _ => None,
        }
    }

    pub(super) fn leave(&mut self, seen: &CallInputs<'_>) -> Option<Outcome> {
        each!(self, function => function.leave(seen))
    }

    /// Returns true if the type has a call of RESET.
    pub(super) fn has_leave(&self) -> bool {
        matches!(self, Self::Apsf(_))
    }

    /// Returns the value that the last call left for a memory cell.
    pub(super) fn word(&mut self, module: &Module, place: usize) -> u64 {
        match self {
            Self::Apsf(function) => function.word(module, place),
            _ => 0,
        }
    }

    /// Replaces the program. Returns false if it cannot keep the state, or lacks memory for the new one.
    pub(super) fn exchange(&mut self, modules: (&Module, &Module), keeps: bool) -> bool {
        match self {
            Self::Apsf(function) => function.exchange(modules, keeps),
            _ => true,
        }
    }

    /// Returns the reserved pages of memory for its program.
    pub(super) fn room(&self) -> usize {
        match self {
            Self::Apsf(function) => function.room(),
            _ => 0,
        }
    }

    /// Returns true if its state belongs to that program.
    pub(super) fn is_of(&self, module: &Module, runs: bool) -> bool {
        match self {
            Self::Apsf(function) => function.belongs_to(module, runs),
            _ => true,
        }
    }

    pub(super) fn is_sound(&self) -> bool {
        each!(self, function => function.is_valid_state())
    }
}

impl Clone for Any {
    fn clone(&self) -> Self {
        match self {
            Self::Dcopy(function) => Self::Dcopy(function.clone()),
            Self::Ecopy(function) => Self::Ecopy(function.clone()),
            Self::Sidiff(function) => Self::Sidiff(function.clone()),
            Self::Varsync(function) => Self::Varsync(function.clone()),
            Self::Digdreh(function) => Self::Digdreh(function.clone()),
            Self::Imes(function) => Self::Imes(function.clone()),
            Self::Binea(function) => Self::Binea(function.clone()),
            Self::Cam(function) => Self::Cam(function.clone()),
            Self::Fipw(function) => Self::Fipw(function.clone()),
            Self::Fipz(function) => Self::Fipz(function.clone()),
            Self::Xfipw(function) => Self::Xfipw(function.clone()),
            Self::Dfkt(function) => Self::Dfkt(function.clone()),
            Self::Fgen(function) => Self::Fgen(function.clone()),
            Self::Regl(function) => Self::Regl(function.clone()),
            Self::Epos(function) => Self::Epos(function.clone()),
            Self::Apsf(function) => Self::Apsf(function.clone()),
        }
    }

    /// Does not allocate if both functions belong to the same machine.
    fn clone_from(&mut self, other: &Self) {
        match (self, other) {
            (Self::Dcopy(mine), Self::Dcopy(other)) => mine.clone_from(other),
            (Self::Ecopy(mine), Self::Ecopy(other)) => mine.clone_from(other),
            (Self::Sidiff(mine), Self::Sidiff(other)) => mine.clone_from(other),
            (Self::Varsync(mine), Self::Varsync(other)) => mine.clone_from(other),
            (Self::Digdreh(mine), Self::Digdreh(other)) => mine.clone_from(other),
            (Self::Imes(mine), Self::Imes(other)) => mine.clone_from(other),
            (Self::Binea(mine), Self::Binea(other)) => mine.clone_from(other),
            (Self::Cam(mine), Self::Cam(other)) => mine.clone_from(other),
            (Self::Apsf(mine), Self::Apsf(other)) => mine.clone_from(other),
            (mine, other) => *mine = other.clone(),
        }
    }
}
