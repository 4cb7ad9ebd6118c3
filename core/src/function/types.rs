//! Slot types: one file of this folder each, and one line of the list at the end of this file.
//!
//! The list makes the enum of types, the table of their descriptions, and the enum of their states. No match over the
//! types has a wildcard arm.

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

use super::description::Description;
use super::field::Words;
use super::program::{CallInputs, Fault, Outcome, Progress, Setting, SlotSetup, SlotType};
use lineshaft_program::Module;
use serde::{Deserialize, Serialize};

/// Makes [`Kind`], [`TYPES`] and [`Any`] from the list of types.
macro_rules! slot_types {
    ($($Kind:ident($Function:ty),)+) => {
        /// A function type.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
        pub enum Kind {
            $(#[doc = concat!("Type ", stringify!($Kind), "; [`TYPES`] describes it.")] $Kind,)+
        }

        /// Descriptions of all types, in the order of [`Kind`].
        pub const TYPES: &[Description] = &[$(<$Function as SlotType>::DESCRIPTION,)+];

        impl Kind {
            /// Returns the modes of the type in ascending order; none if the range of its field defines them.
            pub(crate) fn modes(self) -> Vec<i64> {
                match self { $(Self::$Kind => <$Function>::modes(),)+ }
            }

            /// Returns true if a function with this parameter set copies its source to its sink.
            pub fn copies_source(self, values: &[i64]) -> bool {
                match self { $(Self::$Kind => <$Function>::copies_source(Words(values)),)+ }
            }

            /// Returns true if a function with this parameter set copies values to its sink that any step may separate,
            /// `is_signal`: its source is a signal and no position.
            pub fn copies_values(self, values: &[i64], is_signal: bool) -> bool {
                match self { $(Self::$Kind => <$Function>::copies_values(Words(values), is_signal),)+ }
            }

            /// Returns the axes that a function with this parameter set monitors without a source, the first one in
            /// bit 0.
            pub fn monitored_axes(self, values: &[i64]) -> u8 {
                match self { $(Self::$Kind => <$Function>::monitored_axes(Words(values)),)+ }
            }
        }

        /// State of a function of any type.
        #[derive(Debug, Serialize, Deserialize)]
        pub(super) enum Any {
            $($Kind($Function),)+
        }

        impl Any {
            /// Creates a function at rest, with all memory that it will need.
            pub(super) fn new(kind: Kind, setup: &SlotSetup<'_>) -> Self {
                match kind { $(Kind::$Kind => Self::$Kind(<$Function>::new(setup)),)+ }
            }

            pub(super) fn check(&self, words: Words<'_>, setting: &Setting<'_>) -> Result<(), Fault> {
                match self { $(Self::$Kind(function) => function.check(words, setting),)+ }
            }

            pub(super) fn start(&mut self, words: Words<'_>, seen: &CallInputs<'_>) -> Outcome {
                match self { $(Self::$Kind(function) => function.start(words, seen),)+ }
            }

            pub(super) fn apply_values(&mut self, words: Words<'_>) {
                match self { $(Self::$Kind(function) => function.apply_values(words),)+ }
            }

            #[inline]
            pub(super) fn step(&mut self, seen: &CallInputs<'_>) -> Outcome {
                match self { $(Self::$Kind(function) => function.step(seen),)+ }
            }

            pub(super) fn read(&self, words: Words<'_>, setting: &Setting<'_>) -> Result<Option<(u16, i64)>, Fault> {
                match self { $(Self::$Kind(function) => function.read(words, setting),)+ }
            }

            pub(super) fn leave(&mut self, seen: &CallInputs<'_>) -> Option<Outcome> {
                match self { $(Self::$Kind(function) => function.leave(seen),)+ }
            }

            pub(super) fn rests(&self, rests: u8) -> u8 {
                match self { $(Self::$Kind(function) => function.rests(rests),)+ }
            }

            pub(super) fn progress(&self) -> Progress {
                match self { $(Self::$Kind(function) => function.progress(),)+ }
            }

            pub(super) fn drop_order(&mut self) {
                match self { $(Self::$Kind(function) => function.drop_order(),)+ }
            }

            #[inline]
            pub(super) fn shown(&self) -> &[i64] {
                match self { $(Self::$Kind(function) => function.shown(),)+ }
            }

            /// Returns true if both functions have the same type and setup, in any state.
            pub(super) fn is_set_up_as(&self, other: &Self) -> bool {
                match self {
                    $(Self::$Kind(function) => matches!(other, Self::$Kind(other) if function.is_set_up_as(other)),)+
                }
            }

            pub(super) fn runs_with(&self, words: Words<'_>, call_ns: u64) -> bool {
                match self { $(Self::$Kind(function) => function.runs_with(words, call_ns),)+ }
            }

            pub(super) fn is_valid_state(&self) -> bool {
                match self { $(Self::$Kind(function) => function.is_valid_state(),)+ }
            }

            pub(super) fn room(&self) -> usize {
                match self { $(Self::$Kind(function) => function.room(),)+ }
            }

            pub(super) fn word(&mut self, module: &Module, place: usize) -> u64 {
                match self { $(Self::$Kind(function) => function.word(module, place),)+ }
            }

            pub(super) fn exchange(&mut self, modules: (&Module, &Module), keeps: bool) -> bool {
                match self { $(Self::$Kind(function) => function.exchange(modules, keeps),)+ }
            }

            pub(super) fn belongs_to(&self, module: &Module, runs: bool) -> bool {
                match self { $(Self::$Kind(function) => function.belongs_to(module, runs),)+ }
            }
        }

        impl Clone for Any {
            fn clone(&self) -> Self {
                match self { $(Self::$Kind(function) => Self::$Kind(function.clone()),)+ }
            }

            /// Does not allocate if both functions belong to the same machine.
            fn clone_from(&mut self, other: &Self) {
                match self {
                    $(Self::$Kind(function) => match other {
                        Self::$Kind(other) => function.clone_from(other),
                        other => *self = other.clone(),
                    },)+
                }
            }
        }
    };
}

// Recordings and saved states contain the index of a type: new types follow the last one.
slot_types! {
    Dcopy(copy::Dcopy),
    Ecopy(copy::Ecopy),
    Sidiff(sidiff::Sidiff),
    Varsync(varsync::Varsync),
    Digdreh(digdreh::SpeedSwitch),
    Imes(imes::Imes),
    Binea(binea::Binea),
    Cam(cam::Cam),
    Fipw(interpolator::fipw::Fipw),
    Fipz(interpolator::fipz::Fipz),
    Xfipw(interpolator::xfipw::Xfipw),
    Dfkt(dfkt::Dfkt),
    Fgen(fgen::Fgen),
    Regl(regl::PidFunction),
    Epos(epos::Epos),
    Apsf(apsf::Apsf),
}

impl Kind {
    /// Returns the description of the type.
    pub fn description(self) -> &'static Description {
        // The rows are in the order of the enum; a test checks that.
        TYPES.get(self as usize).unwrap_or(&TYPES[0])
    }

    /// Returns the type of that name.
    pub fn find(name: &str) -> Option<Self> {
        TYPES.iter().find(|row| row.name == name).map(|row| row.kind)
    }

    /// Returns the name in cells.
    pub fn name(self) -> &'static str {
        self.description().name
    }
}
