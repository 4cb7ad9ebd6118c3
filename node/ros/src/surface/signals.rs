//! Signals of an axis in SI units.

use lineshaft_core::config::MachineConfig;
use lineshaft_core::signal::axis::AxisSignal;
use lineshaft_core::signal::gantry::GantrySignal;
use lineshaft_core::signal::{Board, Directory, Signal};
use lineshaft_core::unit::{Scale, SiScale};
use lineshaft_msgs::msg::AxisState;

/// Signals of an axis on the board, with its scale.
#[derive(Clone, Debug)]
pub struct AxisView {
    pub(super) name: String,
    pub(super) is_virtual: bool,
    first: Signal,
    /// First of [`GantrySignal`], if the axis has two drives.
    gantry: Option<Signal>,
    scale: Scale,
    si: SiScale,
}

impl AxisView {
    /// Returns the views of all axes, in file order.
    pub fn all(config: &MachineConfig, directory: &Directory) -> Vec<Self> {
        let first = |name: &str| directory.find(&format!("{name}.state"));
        let axes = config.axes.iter();
        axes.filter_map(|axis| {
            let is_virtual = axis.drive.is_none();
            let gantry = axis.second.and_then(|_| directory.find(&format!("{}.skew", axis.name)));
            let (name, first, scale) = (axis.name.clone(), first(&axis.name)?, axis.scale);
            Some(Self { name, is_virtual, first, gantry, scale, si: scale.into() })
        })
        .collect()
    }

    pub(super) fn int(&self, board: &Board, signal: AxisSignal) -> i64 {
        board.int(signal.of(self.first))
    }

    pub(super) fn real(&self, board: &Board, signal: AxisSignal) -> f64 {
        board.real(signal.of(self.first))
    }

    pub(super) fn bit(&self, board: &Board, signal: AxisSignal) -> bool {
        board.bit(signal.of(self.first))
    }

    /// Returns a small enum or word.
    pub(super) fn small(&self, board: &Board, signal: AxisSignal) -> u8 {
        u8::try_from(self.int(board, signal)).unwrap_or(u8::MAX)
    }

    /// Converts increments to m or rad.
    pub(super) fn si(&self, increments: i64, fraction: f64) -> f64 {
        self.si.position(increments, fraction)
    }

    /// Returns a velocity or acceleration, in SI units.
    pub(super) fn rate(&self, board: &Board, signal: AxisSignal) -> f64 {
        self.si.rate(self.real(board, signal))
    }

    /// Returns a position in the unit of the axis, with the unit.
    pub(super) fn length_text(&self, board: &Board, signal: AxisSignal) -> String {
        self.scale.format_increments(self.int(board, signal))
    }

    /// Returns the state of the second drive and the skew of the gantry, with the unit; `None` if the axis has one drive.
    pub(super) fn second_drive(&self, board: &Board) -> Option<(i64, String)> {
        let int = |signal: GantrySignal| self.gantry.map(|first| board.int(signal.of(first)));
        Some((int(GantrySignal::SecondState)?, self.scale.format_increments(int(GantrySignal::Skew)?)))
    }

    /// Returns a velocity in the unit of the axis, with the unit.
    pub(super) fn velocity_text(&self, board: &Board, signal: AxisSignal) -> String {
        self.scale.format_rate(self.real(board, signal), 1)
    }

    /// Returns the command position, in m or rad.
    pub(super) fn command(&self, board: &Board) -> f64 {
        let fraction = self.real(board, AxisSignal::CommandFraction);
        self.si(self.int(board, AxisSignal::CommandPosition), fraction)
    }

    /// Returns the position that the master or the trajectory demands, in m or rad: the command position plus the synchronization error.
    pub(super) fn desired(&self, board: &Board) -> f64 {
        let lag = self.int(board, AxisSignal::SyncError);
        let fraction = self.real(board, AxisSignal::CommandFraction);
        self.si(self.int(board, AxisSignal::CommandPosition).saturating_add(lag), fraction)
    }

    /// Returns target minus command position, in increments.
    pub(super) fn to_go(&self, board: &Board) -> i64 {
        let target = self.int(board, AxisSignal::TargetPosition);
        target.saturating_sub(self.int(board, AxisSignal::CommandPosition))
    }

    pub(super) fn effort(&self, board: &Board) -> f64 {
        self.real(board, AxisSignal::ActualEffort)
    }

    /// Returns the message of `~/axis_states` for this axis.
    pub(super) fn state(&self, board: &Board) -> AxisState {
        use AxisSignal::*;
        let int = |signal| self.int(board, signal);
        let bit = |signal| self.bit(board, signal);
        AxisState {
            name: self.name.clone(),
            state: self.small(board, State),
            drive_state: self.small(board, DriveState),
            reference: self.small(board, Reference),
            mode_of_operation: i8::try_from(int(ModeOfOperation)).unwrap_or(0),
            enabled: bit(Enabled),
            homed: bit(Homed),
            in_position: bit(InPosition),
            in_velocity: bit(InVelocity),
            in_sync: bit(InSync),
            warning: bit(Warning),
            positive_limit: bit(LimitPositive) || bit(LimitSoftwarePositive),
            negative_limit: bit(LimitNegative) || bit(LimitSoftwareNegative),
            error_code: u32::try_from(int(Error)).unwrap_or(u32::MAX),
            command_position: self.command(board),
            command_velocity: self.rate(board, CommandVelocity),
            command_acceleration: self.rate(board, CommandAcceleration),
            position: self.si(int(ActualPosition), 0.0),
            velocity: self.rate(board, ActualVelocity),
            effort: self.effort(board),
            following_error: self.si(int(FollowingError), 0.0),
            sync_error: self.si(int(SyncError), 0.0),
            command_increments: int(CommandPosition),
            position_increments: int(ActualPosition),
            following_error_increments: int(FollowingError),
            sync_error_increments: int(SyncError),
        }
    }
}
