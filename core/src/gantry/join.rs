//! Joins the process data of two drives to those of one drive.
//!
//! Law      motion: of the first drive. State: the one further from operation enabled, a fault of either. Online, fresh
//!          and valid: if both are. Limit switches: of either. Effort: the sum

use crate::drive::{BusState, DriveInput, DriveState, MODE_CSP, STATUS_WARNING};

/// Returns the state of a drive; an offline drive is not ready to switch on.
pub(super) fn state(input: &DriveInput) -> DriveState {
    if input.online { DriveState::from_status(input.status) } else { DriveState::NotReady }
}

/// Returns the distance of a state from operation enabled. The joined state is that of the drive with the larger one.
fn distance_from_enabled(state: DriveState) -> u8 {
    match state {
        DriveState::Enabled => 0,
        DriveState::SwitchedOn => 1,
        DriveState::Ready => 2,
        DriveState::SwitchOnDisabled => 3,
        DriveState::NotReady => 4,
        // The drive may still run.
        DriveState::QuickStop => 5,
        DriveState::Fault => 6,
        DriveState::FaultReaction => 7,
    }
}

fn worse(one: BusState, other: BusState) -> BusState {
    match (one, other) {
        (BusState::Off, _) | (_, BusState::Off) => BusState::Off,
        (BusState::Degraded, _) | (_, BusState::Degraded) => BusState::Degraded,
        _ => BusState::Active,
    }
}

/// Returns the joined inputs. The reference switch is set by the gantry.
pub(super) fn joined([first, second]: [&DriveInput; 2]) -> DriveInput {
    let is_in_fault = |input: &DriveInput| matches!(state(input), DriveState::Fault | DriveState::FaultReaction);
    let further =
        if distance_from_enabled(state(second)) > distance_from_enabled(state(first)) { second } else { first };
    let fault = if is_in_fault(first) || !is_in_fault(second) { first.fault } else { second.fault };
    DriveInput {
        effort: first.effort + second.effort,
        status: further.status | (first.status | second.status) & STATUS_WARNING,
        mode: if first.mode == MODE_CSP { second.mode } else { first.mode },
        fault,
        online: first.online && second.online,
        fresh: first.fresh && second.fresh,
        bus: worse(first.bus, second.bus),
        emergency: first.emergency.or(second.emergency),
        inputs: first.inputs | second.inputs,
        unacknowledged: first.unacknowledged || second.unacknowledged,
        ..*first
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use DriveState::{Enabled, Fault, FaultReaction, NotReady, QuickStop, Ready, SwitchOnDisabled, SwitchedOn};

    const ALL: [DriveState; 8] =
        [NotReady, SwitchOnDisabled, Ready, SwitchedOn, Enabled, QuickStop, FaultReaction, Fault];

    fn shows(state: DriveState) -> DriveInput {
        DriveInput { online: true, fresh: true, status: state.status(), mode: MODE_CSP, ..DriveInput::default() }
    }

    /// Each state with every other one, in both orders.
    #[test]
    fn both_are_enabled_where_each_is_and_in_fault_where_either_is() {
        for one in ALL {
            for other in ALL {
                let both = state(&joined([&shows(one), &shows(other)]));
                assert_eq!(both, state(&joined([&shows(other), &shows(one)])), "{one:?} {other:?}");
                assert_eq!(both == Enabled, one == Enabled && other == Enabled, "{one:?} {other:?}");
                let is_fault = |state| matches!(state, Fault | FaultReaction);
                assert_eq!(is_fault(both), is_fault(one) || is_fault(other), "{one:?} {other:?}");
                // A drive that may still run is waited for.
                let reacts = one == FaultReaction || other == FaultReaction;
                assert_eq!(both == FaultReaction, reacts, "{one:?} {other:?}");
            }
        }
    }

    /// From any pair of states without fault, the control words for the joined state bring both to operation enabled.
    #[test]
    fn control_words_of_joined_state_enable_both_drives() {
        let word = |state| match state {
            SwitchOnDisabled => 0x06,
            Ready => 0x07,
            SwitchedOn | Enabled => 0x0F,
            _ => 0x00,
        };
        for one in [NotReady, SwitchOnDisabled, Ready, SwitchedOn, Enabled, QuickStop] {
            for other in [NotReady, SwitchOnDisabled, Ready, SwitchedOn, Enabled, QuickStop] {
                let (mut pair, mut cycles) = ([one, other], 0);
                while pair != [Enabled; 2] {
                    let both = state(&joined([&shows(pair[0]), &shows(pair[1])]));
                    pair = pair.map(|state| state.next(word(both), 0));
                    cycles += 1;
                    assert!(cycles < 12, "{one:?} {other:?} stay in {pair:?}");
                }
            }
        }
    }

    #[test]
    fn error_of_either_drive_is_error_of_the_pair() {
        let good = shows(Enabled);
        for place in [0, 1] {
            let with = |change: fn(&mut DriveInput)| {
                let mut pair = [good, good];
                change(&mut pair[place]);
                joined([&pair[0], &pair[1]])
            };
            assert!(!with(|drive| drive.online = false).online);
            assert!(!with(|drive| drive.fresh = false).fresh);
            assert_eq!(with(|drive| drive.bus = BusState::Off).bus, BusState::Off);
            assert_eq!(with(|drive| drive.bus = BusState::Degraded).bus, BusState::Degraded);
            assert_eq!(with(|drive| drive.mode = 3).mode, 3);
            assert_eq!(with(|drive| (drive.status, drive.fault) = (Fault.status(), 0x2310)).fault, 0x2310);
            assert_ne!(with(|drive| drive.status |= STATUS_WARNING).status & STATUS_WARNING, 0);
            assert_eq!(with(|drive| drive.effort = 2.5).effort, 2.5);
            assert!(with(|drive| drive.unacknowledged = true).unacknowledged);
        }
    }
}
