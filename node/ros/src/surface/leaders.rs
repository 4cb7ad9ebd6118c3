//! `~/shaft`: positions and velocities of masters, for other hosts and tools.
//!
//! Law      a master is published as its slaves have seen it in that cycle, exact to 2^-32 inc; in m or rad by its own scale, or for a sum
//!          by the common scale of its members
//! Reads    the signals of a cycle

use super::messages::header;
use lineshaft_core::config::MachineConfig;
use lineshaft_core::object::{Leader, VIRTUAL_MASTER};
use lineshaft_core::signal::{Board, Directory, Signal};
use lineshaft_core::unit::SiScale;
use lineshaft_msgs::msg::{LeaderState, ShaftStates};

/// Signals of a master on the board, with its scale.
#[derive(Clone, Debug)]
pub(super) struct LeaderView {
    name: String,
    scale: Option<SiScale>,
    position: Signal,
    velocity: Signal,
    /// Fraction of an increment; `None` if the master is counted in whole increments.
    fraction: Option<Signal>,
    valid: Valid,
}

/// Signal for the validity of a master.
#[derive(Clone, Copy, Debug)]
enum Valid {
    /// The master is always valid.
    Always,
    /// A bit reports the validity.
    Bit(Signal),
    /// An error code of 0 means valid.
    Error(Signal),
}

impl LeaderView {
    /// Returns the views of all published masters, in their order.
    pub(super) fn all(config: &MachineConfig, directory: &Directory) -> Vec<Self> {
        let encoders = (0..).zip(&config.encoders).map(|(place, of)| (Leader::Encoder(place), of.name.as_str()));
        let axes = (0..).zip(&config.axes).filter(|(_, axis)| axis.drive.is_none());
        let axes = axes.map(|(place, axis)| (Leader::AxisCommand(place), axis.name.as_str()));
        let masters = (0..).zip(&config.masters).map(|(place, of)| (Leader::Sum(place), of.name.as_str()));
        let leaders = encoders.chain(axes).chain(masters).chain([(Leader::Virtual, VIRTUAL_MASTER)]);
        leaders.filter_map(|(leader, name)| Self::new(leader, name, config, directory)).collect()
    }

    fn new(leader: Leader, name: &str, config: &MachineConfig, directory: &Directory) -> Option<Self> {
        let position = config.signal_of(leader)?;
        let block = position.strip_suffix("position")?;
        let find = |signal: &str| directory.find(&format!("{block}{signal}"));
        let valid = match leader {
            Leader::Encoder(_) => Valid::Error(find("error")?),
            Leader::Sum(_) => Valid::Bit(find("valid")?),
            _ => Valid::Always,
        };
        Some(Self {
            name: name.to_owned(),
            scale: config.known_scale_of(leader).map(SiScale::from),
            position: directory.find(&position)?,
            velocity: find("velocity")?,
            fraction: find("fraction"),
            valid,
        })
    }

    fn state(&self, board: &Board) -> LeaderState {
        let (increments, rate) = (board.int(self.position), board.real(self.velocity));
        let fraction = self.fraction.map_or(0.0, |signal| board.real(signal));
        let valid = match self.valid {
            Valid::Always => true,
            Valid::Bit(signal) => board.bit(signal),
            Valid::Error(signal) => board.int(signal) == 0,
        };
        LeaderState {
            name: self.name.clone(),
            valid,
            has_scale: self.scale.is_some(),
            position: self.scale.map_or(0.0, |scale| scale.position(increments, fraction)),
            velocity: self.scale.map_or(0.0, |scale| scale.rate(rate)),
            position_increments: increments,
            fraction,
            velocity_increments: rate,
        }
    }
}

/// Returns the message of `~/shaft` with all masters. `stamp_ns` is t_k, in ns.
pub(super) fn shaft_states(views: &[LeaderView], board: &Board, cycle: u64, stamp_ns: u64) -> ShaftStates {
    ShaftStates { header: header(stamp_ns), cycle, leaders: views.iter().map(|view| view.state(board)).collect() }
}

#[cfg(test)]
mod tests;
