//! Notices about bus nodes, encoded as the number of a note (`Action::Note`).
//!
//! Law      a number of a backend is decoded to the notice from which it was encoded
//! Refuses  invalid numbers: they are decoded to `None`

use super::Emergency;
use crate::object::MAX_AXES;

/// No axis has this number.
const NO_AXIS: u16 = u16::MAX;
const _: () = assert!(MAX_AXES <= NO_AXIS as usize);

/// Change of a bus node (NMT and its supervision, CiA 301).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NodeChange {
    /// Boot-up.
    Booted = 1,
    /// Neither heartbeats nor answers to guarding.
    Silent = 2,
    /// Heartbeats or answers to guarding again.
    Back = 3,
    /// Configured and started.
    Ready = 4,
    /// State stopped, without a command.
    Stopped = 5,
    /// State pre-operational, without a command.
    Left = 6,
    /// Started, but without a first heartbeat: the node is not supervised.
    Unwatched = 7,
}

impl NodeChange {
    const ALL: [(Self, &str); 7] = [
        (Self::Booted, "it has booted"),
        (Self::Silent, "it is silent: no sign of life"),
        (Self::Back, "it was silent, and is back"),
        (Self::Ready, "it is configured and operational"),
        (Self::Stopped, "somebody has stopped it"),
        (Self::Left, "somebody has taken it out of operation"),
        (Self::Unwatched, "it sends no heartbeat (1017h), so that nothing watches it"),
    ];

    /// Returns the text for messages.
    pub fn text(self) -> &'static str {
        Self::ALL.iter().find(|row| row.0 == self).map_or("", |row| row.1)
    }
}

/// Notice of a change of a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NodeNotice {
    /// Axis of the drive; `None` for another device.
    pub axis: Option<u16>,
    /// Node number, 1 to 127.
    pub node: u8,
    /// The change.
    pub change: NodeChange,
}

impl NodeNotice {
    /// Returns the number of a note.
    pub fn to_number(self) -> i64 {
        i64::from(self.axis.unwrap_or(NO_AXIS)) | i64::from(self.node) << 16 | i64::from(self.change as u8) << 24
    }

    /// Decodes a number; `None` if it is invalid.
    pub fn from_number(number: i64) -> Option<Self> {
        let [a, b, node, change, 0, 0, 0, 0] = number.to_le_bytes() else { return None };
        let (change, _) = *NodeChange::ALL.iter().find(|(known, _)| *known as u8 == change)?;
        let axis = u16::from_le_bytes([a, b]);
        Some(Self { axis: (axis != NO_AXIS).then_some(axis), node, change })
    }
}

/// Emergency message of a node that is no drive of the machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ForeignEmergency {
    /// Node number, 1 to 127.
    pub node: u8,
    /// Error code (as in 603Fh).
    pub code: u16,
    /// Error register (1001h).
    pub register: u8,
}

impl ForeignEmergency {
    /// Returns the message of a node, without the manufacturer-specific data.
    pub fn new(node: u8, Emergency { code, register, .. }: Emergency) -> Self {
        Self { node, code, register }
    }

    /// Returns the number of a note.
    pub fn to_number(self) -> i64 {
        i64::from(self.code) | i64::from(self.register) << 16 | i64::from(self.node) << 24
    }

    /// Decodes a number; `None` if it is invalid.
    pub fn from_number(number: i64) -> Option<Self> {
        let [a, b, register, node, 0, 0, 0, 0] = number.to_le_bytes() else { return None };
        Some(Self { node, code: u16::from_le_bytes([a, b]), register })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn number_decodes_to_encoded_notice(axis in prop::option::of(0..NO_AXIS), node: u8, place in 0..NodeChange::ALL.len(), code: u16, register: u8) {
            let notice = NodeNotice { axis, node, change: NodeChange::ALL[place].0 };
            prop_assert_eq!(NodeNotice::from_number(notice.to_number()), Some(notice));
            let message = ForeignEmergency { node, code, register };
            prop_assert_eq!(ForeignEmergency::from_number(message.to_number()), Some(message));
        }

        #[test]
        fn any_number_reads_as_what_makes_it_or_as_nothing(number: i64) {
            prop_assert!(NodeNotice::from_number(number).is_none_or(|notice| notice.to_number() == number));
            prop_assert!(ForeignEmergency::from_number(number).is_none_or(|message| message.to_number() == number));
        }
    }
}
