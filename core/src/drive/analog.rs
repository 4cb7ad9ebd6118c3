//! Drive without a bus: a voltage is its reference, an output enables it, and an input reports that it is ready.
//!
//! Law      volts = 10 V * reference / full, within +-10 V, while it is enabled; 0 V in a quick stop, in which a
//!          velocity drive brakes and a torque drive coasts. It counts as enabled `enable_ns` after its enable output.
//!          If it was ready and then is not, it is in fault, until it is ready again and its fault is reset
//! Reads    the outputs of an axis to any drive; the ready input
//! Writes   the inputs that a drive on a bus reports; reference (V) and enable
//! Source   MACS-CAN-01 (DRIVETYPE 0), MACS-REG-09, WF-CLC-04

use super::{DriveInput, DriveOutput, DriveState, Mode};
use serde::{Deserialize, Serialize};

/// Voltage of the full reference (V).
pub const FULL_VOLTS: f64 = 10.0;
/// Maximum time from the enable output until a drive follows its reference (ns): less than the enable timeout of an
/// axis.
pub const LONGEST_ENABLE_NS: u64 = 4_000_000_000;
/// Generic error (603Fh): the input gives no details.
const NOT_READY: u16 = 0x1000;

/// Wiring of such a drive; entries by their indices in section `io`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct AnalogWiring {
    /// Analog output of the reference.
    pub reference: u16,
    /// Digital output of the enable.
    pub enable: u16,
    /// Digital input of the ready signal; `None`: always ready.
    pub ready: Option<u16>,
    /// Value of 10 V: a velocity (inc/s), or an effort in the unit of max_effort.
    pub full: f64,
    /// Time from the enable output until the drive follows its reference (ns).
    pub enable_ns: u64,
}

/// State of the drive between cycles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct AnalogDrive {
    state: DriveState,
    last_control: u16,
    mode: i8,
    /// Time since its enable output was switched on (ns).
    enabled_ns: u64,
}

impl AnalogDrive {
    /// Returns the inputs that a drive on a bus would report.
    pub fn read(&mut self, is_ready: bool) -> DriveInput {
        self.state = match self.state {
            DriveState::NotReady if is_ready => DriveState::SwitchOnDisabled,
            DriveState::NotReady => DriveState::NotReady,
            state if is_ready => state,
            _ => DriveState::Fault,
        };
        let fault = if self.state == DriveState::Fault { NOT_READY } else { 0 };
        let status = self.state.status();
        DriveInput { status, mode: self.mode, fault, online: true, fresh: true, ..DriveInput::default() }
    }

    /// Returns its reference (V) and its enable for the outputs of the axis in this cycle.
    pub fn write(&mut self, wiring: &AnalogWiring, output: &DriveOutput, cycle_ns: u64) -> (f64, bool) {
        let asked = match self.state {
            DriveState::NotReady => DriveState::NotReady,
            state => state.next(output.control, self.last_control),
        };
        let is_enabled = matches!(asked, DriveState::Enabled | DriveState::QuickStop);
        let is_awaited = self.state == DriveState::SwitchedOn && self.enabled_ns < wiring.enable_ns;
        self.state = if asked == DriveState::Enabled && is_awaited { self.state } else { asked };
        self.enabled_ns = if is_enabled { self.enabled_ns.saturating_add(cycle_ns) } else { 0 };
        (self.last_control, self.mode) = (output.control, output.mode.number());
        let reference = match output.mode {
            Mode::Velocity => output.velocity,
            Mode::Torque => output.effort,
            _ => 0.0,
        };
        let volts = FULL_VOLTS * reference / wiring.full;
        let follows = self.state == DriveState::Enabled && volts.is_finite();
        (if follows { volts.clamp(-FULL_VOLTS, FULL_VOLTS) } else { 0.0 }, is_enabled)
    }
}

#[cfg(test)]
mod tests {
    use super::super::control;
    use super::*;
    use DriveState::*;

    const WIRING: AnalogWiring =
        AnalogWiring { reference: 0, enable: 1, ready: Some(2), full: 2000.0, enable_ns: 2_500_000 };

    fn output(control: u16, velocity: f64) -> DriveOutput {
        DriveOutput { control, velocity, mode: Mode::Velocity, ..DriveOutput::default() }
    }

    fn shown(drive: &mut AnalogDrive, is_ready: bool) -> DriveState {
        let input = drive.read(is_ready);
        assert!(input.online && input.fresh);
        let state = DriveState::from_status(input.status);
        assert_eq!(input.fault, if state == Fault { NOT_READY } else { 0 });
        state
    }

    /// Returns a drive in operation enabled, at 1 ms.
    fn enabled() -> AnalogDrive {
        let mut drive = AnalogDrive::default();
        let steps = [
            (control::SHUTDOWN, SwitchOnDisabled, false),
            (control::SWITCH_ON, Ready, false),
            (control::ENABLE, SwitchedOn, true),
            (control::ENABLE, SwitchedOn, true),
            (control::ENABLE, SwitchedOn, true),
            (control::ENABLE, SwitchedOn, true),
        ];
        for (word, before, enable) in steps {
            assert_eq!(shown(&mut drive, true), before);
            assert_eq!(drive.write(&WIRING, &output(word, 0.0), 1_000_000), (0.0, enable), "{before:?}");
        }
        drive
    }

    /// 2.5 ms are three cycles: enable in the first, operation enabled is reported after three cycles of waiting.
    #[test]
    fn drive_counts_as_enabled_after_enable_time() {
        let mut drive = enabled();
        assert_eq!(shown(&mut drive, true), Enabled);
        let mut at_once = AnalogDrive::default();
        let wiring = AnalogWiring { enable_ns: 0, ..WIRING };
        for word in [control::SHUTDOWN, control::SWITCH_ON, control::ENABLE] {
            at_once.read(true);
            at_once.write(&wiring, &output(word, 0.0), 1_000_000);
        }
        assert_eq!(shown(&mut at_once, true), Enabled);
    }

    #[test]
    fn volts_are_parts_of_full_and_end_at_ten() {
        let mut drive = enabled();
        let mut volts = |velocity| {
            drive.read(true);
            drive.write(&WIRING, &output(control::ENABLE, velocity), 1_000_000)
        };
        assert_eq!(volts(500.0), (2.5, true));
        assert_eq!(volts(-2000.0), (-10.0, true));
        assert_eq!(volts(2001.0), (10.0, true));
        assert_eq!(volts(f64::NAN), (0.0, true));
        assert_eq!(volts(f64::NEG_INFINITY), (0.0, true));
        let effort = DriveOutput {
            control: control::ENABLE,
            effort: 400.0,
            velocity: 9.0,
            mode: Mode::Torque,
            ..output(0, 0.0)
        };
        assert_eq!(drive.write(&WIRING, &effort, 1_000_000), (2.0, true));
        let other = DriveOutput { mode: Mode::Position, ..effort };
        assert_eq!(drive.write(&WIRING, &other, 1_000_000), (0.0, true));
    }

    #[test]
    fn without_ready_it_is_in_fault_until_it_is_ready_and_reset() {
        let mut drive = enabled();
        assert_eq!(shown(&mut drive, false), Fault);
        assert_eq!(drive.write(&WIRING, &output(control::ENABLE, 500.0), 1_000_000), (0.0, false));
        assert_eq!(shown(&mut drive, true), Fault, "nobody has reset it");
        drive.write(&WIRING, &output(control::FAULT_RESET, 0.0), 1_000_000);
        assert_eq!(shown(&mut drive, false), Fault, "reset, and not ready");
        drive.write(&WIRING, &output(0, 0.0), 1_000_000);
        assert_eq!(shown(&mut drive, true), Fault);
        drive.write(&WIRING, &output(control::FAULT_RESET, 0.0), 1_000_000);
        assert_eq!(shown(&mut drive, true), SwitchOnDisabled);
    }

    #[test]
    fn before_it_is_ready_once_it_has_no_fault_and_is_not_enabled() {
        let mut drive = AnalogDrive::default();
        for word in [control::SHUTDOWN, control::SWITCH_ON, control::ENABLE, control::ENABLE] {
            assert_eq!(shown(&mut drive, false), NotReady);
            assert_eq!(drive.write(&WIRING, &output(word, 5.0), 1_000_000), (0.0, false));
        }
        assert_eq!(shown(&mut drive, true), SwitchOnDisabled);
    }

    /// In a quick stop it stays enabled at 0 V, with which a velocity drive brakes. When disabled, it is neither
    /// enabled nor has a reference.
    #[test]
    fn quick_stop_outputs_zero_volts_and_disable_removes_enable() {
        let mut drive = enabled();
        drive.read(true);
        assert_eq!(drive.write(&WIRING, &output(control::QUICK_STOP, 500.0), 1_000_000), (0.0, true));
        assert_eq!(shown(&mut drive, true), QuickStop);
        assert_eq!(
            drive.write(&WIRING, &output(control::ENABLE, 500.0), 1_000_000),
            (0.0, true),
            "it does not come back"
        );
        drive.read(true);
        assert_eq!(drive.write(&WIRING, &output(control::DISABLE_VOLTAGE, 500.0), 1_000_000), (0.0, false));
        assert_eq!(shown(&mut drive, true), SwitchOnDisabled);
    }
}
