//! Devices for the tests of this room.

use crate::config::{DeviceConfig, DriveConfig, Identity, Role, Terminals, VelocityFactor};
use crate::drive::{DriveMode, Layout};
use crate::{NodeId, Watching};
use lineshaft_core::drive::Capabilities;

/// A drive in csp, which tells what is needed.
pub(super) fn drive(place: usize, node: NodeId, watching: Watching) -> DeviceConfig {
    let terminals = Terminals::default();
    DeviceConfig {
        node,
        watching,
        layout: Layout::plan(node, DriveMode::Csp, [None; 2], &terminals, None)
            .expect("without a dictionary nothing is missing"),
        identity: Identity::default(),
        startup: Vec::new(),
        terminals,
        role: Role::Drive(DriveConfig {
            place,
            axis: format!("x{place}"),
            object: 0,
            probes: [None; 2],
            mode: DriveMode::Csp,
            drive_type: None,
            offers: Capabilities { delay: 1, position: true, homes: true, ..Capabilities::default() },
            per_revolution: None,
            velocity: VelocityFactor::default(),
        }),
    }
}

/// What it is as a drive.
pub(super) fn as_drive(device: &mut DeviceConfig) -> &mut DriveConfig {
    match &mut device.role {
        Role::Drive(drive) => drive,
        Role::Module | Role::Encoder => panic!("it is a drive"),
    }
}
