//! Texts for the numbers of CANopen.
//!
//! Source   CiA 301 (states, transmission types)

use crate::NmtState;

/// Returns the text of an NMT state.
pub fn nmt_state(state: NmtState) -> &'static str {
    match state {
        NmtState::BootUp => "booted",
        NmtState::Stopped => "stopped",
        NmtState::Operational => "operational",
        NmtState::PreOperational => "pre-operational",
    }
}

/// Returns the text of a transmission type (1400h:02, 1800h:02).
pub fn transmission(kind: u8) -> String {
    match kind {
        0 => "0 (sync, when changed)".to_owned(),
        1 => "1 (each sync)".to_owned(),
        2..=240 => format!("{kind} (every {kind} syncs)"),
        252 => "252 (sync, when asked)".to_owned(),
        253 => "253 (when asked)".to_owned(),
        254 => "254 (event of the vendor)".to_owned(),
        255 => "255 (event)".to_owned(),
        other => format!("{other} (reserved)"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn transmission_types_have_texts_of_standard() {
        assert_eq!((transmission(3), transmission(241)), ("3 (every 3 syncs)".into(), "241 (reserved)".into()));
    }
}
