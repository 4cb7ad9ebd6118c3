//! What an error does to its axis, by kind; `axis/watch/reaction.rs` does it.

/// Kinds of errors by what they do to their axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Class {
    /// No error of an axis: a refusal, the end of a goal, a warning, a notice.
    NoError,
    /// As parameter error_reaction (ERRCOND) says.
    Parameter,
    /// As error_reaction says, but 5 stops as 2 does: what commanded the motion is gone, or it would run into its end.
    Ends,
    /// A homing or a search for an index has failed: as error_reaction says; with 5 it ends and the axis stops, and takes goals.
    Search,
    /// A limit switch: endswmod 1 stops as 2 does; else as [`Class::Ends`].
    Switch,
    /// A software limit: the axis stops at the limit, and once it stands as error_reaction says.
    SoftwareLimit,
    /// Its own encoder cannot be trusted: where the position loop is closed here the drive is switched off, with the brake
    /// for all but error_reaction 0; else as [`Class::Ends`].
    Feedback,
    /// Its two drives are too far from square: as skew_reaction says.
    Skew,
    /// Nothing is left to command: the drive gets no voltage, and the brake closes for 1 and 3.
    Drive,
    /// The axis stops with max_deceleration and holds; with error_reaction 3 the brake closes then.
    Interlock,
    /// The axis stops with max_deceleration, then the drive is switched off and the brake closed.
    EmergencyStop,
    /// A SAIA command that is refused; only saia.command_error motor_off makes an error of it, which switches the drive off, with the
    /// brake for 1 and 3.
    Command,
}

impl Class {
    /// What the axis does, in words.
    pub fn text(self) -> &'static str {
        match self {
            Self::NoError => "",
            Self::Parameter => "as `error_reaction` says",
            Self::Ends => "as `error_reaction` says; 5 stops as 2",
            Self::Search => {
                "where it ends a homing or a search: as `error_reaction` says; with 5 the axis stops, and takes goals"
            }
            Self::Switch => "`endswmod` 1: stop and hold; else as `error_reaction` says, 5 as 2",
            Self::SoftwareLimit => "stops at the limit, then as `error_reaction` says; 5 holds",
            Self::Feedback => "drive off where the position loop is closed here; else as `error_reaction` says, 5 as 2",
            Self::Skew => "as `skew_reaction` says",
            Self::Drive => "drive off",
            Self::Interlock => "stop with `max_deceleration`, then hold",
            Self::EmergencyStop => "stop with `max_deceleration`, then drive off and brake closed",
            Self::Command => "none; with `saia.command_error` motor_off: drive off",
        }
    }
}
