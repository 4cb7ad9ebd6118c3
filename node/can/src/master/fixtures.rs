//! Devices for the tests of this room.

use crate::config::{DeviceConfig, DriveConfig, Role};

/// What it is as a drive.
pub(super) fn as_drive(device: &mut DeviceConfig) -> &mut DriveConfig {
    match &mut device.role {
        Role::Drive(drive) => drive,
        Role::Module | Role::Encoder => panic!("it is a drive"),
    }
}
