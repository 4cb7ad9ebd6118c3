//! Reads key `regulator` of a drive: the control law of a position loop that this program closes.

use crate::document::Value;
use lineshaft_core::drive::Interface;
use lineshaft_core::regulator::Law;

/// Reads the key; `interface` is that of the drive, if known.
pub(super) fn law(value: &Value<'_>, interface: Option<Interface>) -> Option<Law> {
    let law = value.choice(&Law::ALL.map(|law| (law.name(), law)))?;
    match interface {
        Some(interface) if !interface.closes_loop_here() => {
            let sentence = format!(
                "regulator is for a drive whose position loop is closed here, with interface velocity, torque or voltage; this one has {}",
                interface.name()
            );
            value.refuse(sentence, Some("leave it out".to_owned()));
            None
        }
        _ => Some(law),
    }
}
