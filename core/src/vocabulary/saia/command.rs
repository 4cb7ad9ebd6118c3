//! Command flags of the module.

use serde::{Deserialize, Serialize};

macro_rules! commands {
    ($($(#[doc = $doc:literal])+ $name:ident $text:literal;)*) => {
        /// A command flag, in the order in which flags that are set together run.
        ///
        /// The manual leaves that order open (A14): loads before `fressf`, `fressf` before starts, reads last.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
        #[repr(u8)]
        pub enum Command {
            $($(#[doc = $doc])+ $name,)*
        }

        impl Command {
            /// All commands with the names of the manual in lower case.
            pub const ALL: &'static [(Command, &'static str)] = &[$((Command::$name, $text)),*];
        }
    };
}

commands! {
    /// AxInit, the function block that must run first (SAIA-INI-01).
    Initialise "axinit";
    /// Mode and direction for the next start (SAIA-CMD-01).
    SelectMode "fselom";
    /// Limit of the position error and its reaction (SAIA-CMD-02).
    SetPositionError "fsetpe";
    /// Destination, relative (SAIA-CMD-04).
    LoadDestinationRelative "flddr";
    /// Destination, absolute (SAIA-CMD-03).
    LoadDestination "fldda";
    /// Velocity, relative (SAIA-CMD-06).
    LoadVelocityRelative "fldvr";
    /// Velocity, absolute (SAIA-CMD-05).
    LoadVelocity "fldva";
    /// Acceleration, relative; switches the motor off (SAIA-CMD-08).
    LoadAccelerationRelative "fldar";
    /// Acceleration, absolute; switches the motor off (SAIA-CMD-07).
    LoadAcceleration "fldaa";
    /// Controller parameters into their buffer (SAIA-CMD-09).
    LoadRegulator "fldrp";
    /// Activates the controller parameters (SAIA-CMD-10).
    UpdateRegulator "fupdrp";
    /// Waits for one index (SAIA-CMD-28).
    SetIndex "fsetip";
    /// The actual position becomes 0 (SAIA-CMD-29).
    SetZero "fsetzp";
    /// Break position, relative (SAIA-CMD-27).
    LoadBreakRelative "fldbpr";
    /// Break position, absolute (SAIA-CMD-26).
    LoadBreak "fldbpa";
    /// Clears status flags (SAIA-CMD-25).
    ResetFlags "fressf";
    /// Motor off (SAIA-CMD-13).
    MotorOff "fmotoff";
    /// Stops as selected by the control word (SAIA-CMD-12).
    Stop "fstop";
    /// Starts, or changes the present motion (SAIA-CMD-11).
    Start "fstart";
    /// One count up (SAIA-CMD-14).
    StepForward "fsstepf";
    /// One count down (SAIA-CMD-15).
    StepBackward "fsstepb";
    /// In positive direction until a stop (SAIA-CMD-16).
    Forward "fforw";
    /// In negative direction until a stop (SAIA-CMD-17).
    Backward "fbackw";
    /// Reads the actual position (SAIA-CMD-18).
    ReadActualPosition "frdap";
    /// Reads the position of the profile (SAIA-CMD-19).
    ReadSetPosition "frdsp";
    /// Reads the actual velocity (SAIA-CMD-20).
    ReadActualVelocity "frdav";
    /// Reads the velocity of the profile (SAIA-CMD-21).
    ReadSetVelocity "frdsv";
    /// Reads the integral term of the controller (SAIA-CMD-22).
    ReadIntegral "frdits";
    /// Reads the index position (SAIA-CMD-23).
    ReadIndex "frdip";
    /// Reads the signal register (SAIA-CMD-24).
    ReadSignals "frdsr";
}

impl Command {
    /// Returns the name of the manual in lower case.
    pub fn name(self) -> &'static str {
        Self::ALL.get(self as usize).map_or("", |(_, name)| name)
    }

    /// Returns the command of that name.
    pub fn find(name: &str) -> Option<Self> {
        Self::ALL.iter().find(|(_, known)| *known == name).map(|(command, _)| *command)
    }

    /// Returns true if it starts a motion.
    pub(super) fn starts(self) -> bool {
        matches!(self, Self::Start | Self::StepForward | Self::StepBackward | Self::Forward | Self::Backward)
    }
}

/// Command flags that are set together.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Commands(u32);

impl Commands {
    /// Sets one more flag. Returns false if it was set already.
    pub fn insert(&mut self, command: Command) -> bool {
        let bit = 1 << command as u8;
        let is_new = self.0 & bit == 0;
        self.0 |= bit;
        is_new
    }

    /// Returns true if no flag is set.
    pub fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// Returns true if the flags need an initialised module.
    pub(super) fn wakes(self) -> bool {
        self.0 != 0 && self.0 & 1 << Command::Initialise as u8 == 0
    }

    /// Returns the flags in the order in which they run.
    pub fn iter(self) -> impl Iterator<Item = Command> {
        Command::ALL.iter().map(|(command, _)| *command).filter(move |command| self.0 >> *command as u8 & 1 == 1)
    }
}

impl FromIterator<Command> for Commands {
    fn from_iter<I: IntoIterator<Item = Command>>(commands: I) -> Self {
        let mut set = Self::default();
        commands.into_iter().for_each(|command| {
            set.insert(command);
        });
        set
    }
}
