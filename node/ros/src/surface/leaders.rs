//! `~/shaft`: what leads, for other hosts and tools.
//!
//! Law      a leader is told as its followers of that cycle have seen it, exact to 2^-32 inc; m or rad by its scale, of a sum by that of all its members
//! Reads    the signals of a cycle

use super::messages::header;
use lineshaft_core::config::MachineConfig;
use lineshaft_core::object::{Leader, VIRTUAL_MASTER};
use lineshaft_core::signal::{Board, Directory, Signal};
use lineshaft_core::unit::SiScale;
use lineshaft_msgs::msg::{LeaderState, ShaftStates};

/// Where a leader stands on the board, and how its increments read.
#[derive(Clone, Debug)]
pub(super) struct LeaderView {
    name: String,
    scale: Option<SiScale>,
    position: Signal,
    velocity: Signal,
    /// None of what is counted.
    fraction: Option<Signal>,
    valid: Valid,
}

/// Where it stands whether it leads.
#[derive(Clone, Copy, Debug)]
enum Valid {
    /// Nothing of it can be lost.
    Always,
    /// A bit says so.
    Bit(Signal),
    /// A code says what is wrong.
    Error(Signal),
}

impl LeaderView {
    /// The views of all leaders that are told, in their order.
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

/// ~/shaft: all leaders. `stamp_ns` is t_k (ns).
pub(super) fn shaft_states(views: &[LeaderView], board: &Board, cycle: u64, stamp_ns: u64) -> ShaftStates {
    ShaftStates { header: header(stamp_ns), cycle, leaders: views.iter().map(|view| view.state(board)).collect() }
}

#[cfg(test)]
mod tests;
