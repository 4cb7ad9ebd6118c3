//! The signals of an axis in SI units.

use super::host::{Host, Snapshot};
use lineshaft_core::signal::Signal;
use lineshaft_core::signal::axis::AxisSignal;
use lineshaft_core::unit::Scale;
use lineshaft_msgs::msg::AxisState;

/// Where an axis stands on the board, and how its increments read.
#[derive(Clone, Debug)]
pub(super) struct AxisView {
    pub name: String,
    pub is_virtual: bool,
    first: Signal,
    scale: Scale,
}

impl AxisView {
    /// The views of all axes, in file order.
    pub(super) fn all(host: &dyn Host) -> Vec<Self> {
        let first = |name: &str| host.directory().find(&format!("{name}.state"));
        let axes = host.config().axes.iter();
        axes.filter_map(|axis| {
            let is_virtual = axis.drive.is_none();
            Some(Self { name: axis.name.clone(), is_virtual, first: first(&axis.name)?, scale: axis.scale })
        })
        .collect()
    }

    pub(super) fn int(&self, snapshot: &Snapshot, signal: AxisSignal) -> i64 {
        snapshot.board.int(signal.of(self.first))
    }

    fn real(&self, snapshot: &Snapshot, signal: AxisSignal) -> f64 {
        snapshot.board.real(signal.of(self.first))
    }

    pub(super) fn bit(&self, snapshot: &Snapshot, signal: AxisSignal) -> bool {
        snapshot.board.bit(signal.of(self.first))
    }

    /// A small enum or word.
    fn small(&self, snapshot: &Snapshot, signal: AxisSignal) -> u8 {
        u8::try_from(self.int(snapshot, signal)).unwrap_or(u8::MAX)
    }

    /// Whole increments in m or rad.
    pub(super) fn si(&self, increments: i64, fraction: f64) -> f64 {
        self.scale.position_to_si(increments, fraction)
    }

    /// A velocity or acceleration in SI units.
    pub(super) fn rate(&self, snapshot: &Snapshot, signal: AxisSignal) -> f64 {
        self.scale.rate_to_si(self.real(snapshot, signal))
    }

    pub(super) fn effort(&self, snapshot: &Snapshot) -> f64 {
        self.real(snapshot, AxisSignal::ActualEffort)
    }

    /// Everything that `~/axis_states` tells.
    pub(super) fn state(&self, snapshot: &Snapshot) -> AxisState {
        use AxisSignal::*;
        let int = |signal| self.int(snapshot, signal);
        let bit = |signal| self.bit(snapshot, signal);
        let command = self.si(int(CommandPosition), self.real(snapshot, CommandFraction));
        AxisState {
            name: self.name.clone(),
            state: self.small(snapshot, State),
            drive_state: self.small(snapshot, DriveState),
            reference: self.small(snapshot, Reference),
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
            command_position: command,
            command_velocity: self.rate(snapshot, CommandVelocity),
            command_acceleration: self.rate(snapshot, CommandAcceleration),
            position: self.si(int(ActualPosition), 0.0),
            velocity: self.rate(snapshot, ActualVelocity),
            effort: self.effort(snapshot),
            following_error: self.si(int(FollowingError), 0.0),
            sync_error: self.si(int(SyncError), 0.0),
            command_increments: int(CommandPosition),
            position_increments: int(ActualPosition),
            following_error_increments: int(FollowingError),
            sync_error_increments: int(SyncError),
        }
    }
}
