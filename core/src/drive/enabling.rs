//! State of a drive that was not enabled in time, encoded as the number of an event.
//!
//! Law      a number of an axis is decoded to the state from which it was encoded
//! Refuses  invalid numbers: they are decoded to `None`

use super::DriveState;

/// State of a drive after the enable timeout.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NotEnabled {
    /// State of the drive (6041h).
    pub state: DriveState,
    /// Mode of operation display (6061h).
    pub mode: i8,
}

impl NotEnabled {
    /// Returns the number of an event: the state in bits 0 to 7, the mode in bits 8 to 15.
    pub fn to_number(self) -> i64 {
        i64::from(self.state as u8) | i64::from(self.mode.cast_unsigned()) << 8
    }

    /// Decodes a number; `None` if it is invalid.
    pub fn from_number(number: i64) -> Option<Self> {
        let [state, mode, 0, 0, 0, 0, 0, 0] = number.to_le_bytes() else { return None };
        let state = DriveState::ALL.into_iter().find(|known| *known as u8 == state)?;
        Some(Self { state, mode: mode.cast_signed() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn every_state_and_mode_reads_back() {
        for state in DriveState::ALL {
            for mode in i8::MIN..=i8::MAX {
                let shown = NotEnabled { state, mode };
                assert_eq!(NotEnabled::from_number(shown.to_number()), Some(shown));
            }
        }
        // Operation enabled (4), manufacturer-specific mode -1.
        assert_eq!(NotEnabled { state: DriveState::Enabled, mode: -1 }.to_number(), 0xFF04);
    }

    proptest! {
        #[test]
        fn any_number_reads_as_what_makes_it_or_as_nothing(number: i64) {
            if let Some(shown) = NotEnabled::from_number(number) {
                prop_assert_eq!(shown.to_number(), number);
            }
        }
    }
}
