//! Controllers and hardware as messages of controller_manager.

use super::switches::{Controller, Controllers};
use crate::surface::joint_names::JointNames;
use lineshaft_core::config::MachineConfig;
use lineshaft_msgs::foreign::controller_manager_msgs::msg::{
    ControllerState, HardwareComponentState, HardwareInterface,
};
use lineshaft_msgs::foreign::lifecycle_msgs::msg::State;
use std::collections::BTreeSet;

/// Class of all controllers.
pub(super) const TYPE: &str = "joint_trajectory_controller/JointTrajectoryController";
/// Base class of all controllers.
pub(super) const BASE_CLASS: &str = "controller_interface::ControllerInterface";
/// Plugin of the hardware.
const PLUGIN: &str = "lineshaft";

const COMMANDS: [&str; 1] = ["position"];
const STATES: [&str; 2] = ["position", "velocity"];

/// Returns `JOINT/INTERFACE` for each joint, then for each interface.
fn interfaces(joints: &[String], names: &[&str]) -> Vec<String> {
    joints.iter().flat_map(|joint| names.iter().map(move |name| format!("{joint}/{name}"))).collect()
}

/// Returns all controllers. `rate` is the number of cycles per second.
pub(super) fn controllers(all: &Controllers, rate: u16) -> Vec<ControllerState> {
    all.all().iter().zip(all.active()).map(|(one, is_active)| controller(one, is_active, rate)).collect()
}

fn controller(one: &Controller, is_active: bool, rate: u16) -> ControllerState {
    let commands = interfaces(&one.joints.names, &COMMANDS);
    ControllerState {
        name: one.name.clone(),
        state: if is_active { "active" } else { "inactive" }.to_owned(),
        r#type: TYPE.to_owned(),
        update_rate: rate,
        claimed_interfaces: if is_active { commands.clone() } else { Vec::new() },
        required_command_interfaces: commands,
        required_state_interfaces: interfaces(&one.joints.names, &STATES),
        ..ControllerState::default()
    }
}

/// Hardware: one component for all axes with a drive.
#[derive(Clone, Debug)]
pub(super) struct Hardware {
    name: String,
    joints: Vec<String>,
    rate: u16,
}

impl Hardware {
    /// Returns the hardware of a machine; `name` is the name of the node.
    pub(super) fn of(config: &MachineConfig, names: &JointNames, name: &str) -> Self {
        let driven = (0..).zip(&config.axes).filter(|(_, axis)| axis.drive.is_some());
        let joints = driven.map(|(place, _)| names.get(place).to_owned()).collect();
        let cycles = 1_000_000_000 / config.cycle_ns.max(1);
        Self { name: name.to_owned(), joints, rate: u16::try_from(cycles).unwrap_or(u16::MAX) }
    }

    /// Returns the number of cycles per second.
    pub(super) fn rate(&self) -> u16 {
        self.rate
    }

    /// Returns the component. `state` is that of the node; interfaces are available in its states inactive and active.
    pub(super) fn component(&self, controllers: &Controllers, state: State) -> HardwareComponentState {
        let is_available = matches!(state.id, State::PRIMARY_STATE_INACTIVE | State::PRIMARY_STATE_ACTIVE);
        let active = controllers.all().iter().zip(controllers.active()).filter(|(_, is_active)| *is_active);
        let claimed: BTreeSet<String> = active.flat_map(|(one, _)| interfaces(&one.joints.names, &COMMANDS)).collect();
        let shown =
            |name: String| HardwareInterface { data_type: "double".to_owned(), is_available, is_claimed: false, name };
        let command = |name: String| HardwareInterface { is_claimed: claimed.contains(&name), ..shown(name) };
        HardwareComponentState {
            name: self.name.clone(),
            r#type: "system".to_owned(),
            is_async: false,
            rw_rate: self.rate,
            class_type: PLUGIN.to_owned(),
            plugin_name: PLUGIN.to_owned(),
            state,
            command_interfaces: interfaces(&self.joints, &COMMANDS).into_iter().map(command).collect(),
            state_interfaces: interfaces(&self.joints, &STATES).into_iter().map(shown).collect(),
        }
    }
}
