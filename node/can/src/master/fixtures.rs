//! Devices for the tests of this module.

use crate::config::{DeviceConfig, Role};
use crate::eds::{self, Dictionary};
use lineshaft_cia402::config::DriveConfig;

/// Returns the drive configuration of a device.
pub(super) fn as_drive(device: &mut DeviceConfig) -> &mut DriveConfig {
    match &mut device.role {
        Role::Drive(drive) => drive,
        Role::Module | Role::Encoder => panic!("it is a drive"),
    }
}

/// Returns the dictionary of the simulated drive with objects that cannot be mapped.
pub(super) fn dictionary_without(objects: &[&str]) -> Dictionary {
    let mut text = include_str!("../../../../launch-configs/can/cia402_sim.eds").to_owned();
    for object in objects {
        let at = text.find(&format!("[{object}]")).expect("the drive has it");
        let (before, of) = text.split_at(at);
        text = format!("{before}{}", of.replacen("PDOMapping=0x1", "PDOMapping=0", 1));
    }
    eds::parse(text.as_bytes(), Some(3)).expect("it is good")
}
