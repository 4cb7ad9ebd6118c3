//! Modes of operation of a simulated drive: evaluates the objects in each cycle of the mechanics.
//!
//! Law      csv and cst follow their setpoint; csp and ip interpolate to it, ip while bit 4 of the control word is 1. pp moves to
//!          set-points with a trapezoidal profile. pv and tq use ramps, vl the ramp of 6048h and 6049h with bits 4 to 6. Bit 8 halts pp,
//!          pv, vl and tq. A drive that is not enabled is at rest
//! Reads    6040h, 6060h, the setpoints and ramps of the mode, position and state of the drive
//! Writes   the commands to the mechanics, bits 10 and 12 of the status word, 6061h
//! Source   CiA 402-2

use super::interpolation::{self, Interpolator};
use super::objects as simulated;
use super::profile::{HALT, Positioner, Ramp, SetpointCommand, nearest, velocity_on_ramp};
use super::table::ObjectTable;
use crate::config::VelocityFactor;
use crate::mode::DriveMode;
use crate::object::Object;
use crate::objects;
use lineshaft_core::drive::{
    DriveInput, DriveOutput, DriveState, HomingOrder, MODE_HOMING, Mode, STATUS_TARGET_REACHED,
};

/// Status word bit 12: the drive follows its setpoint (csp, csv, cst, ip), the set-point is acknowledged (pp), or the velocity is 0 (pv).
const STATUS_12: u16 = 0x1000;
/// Control word bit 4: interpolation enabled (ip), ramp enabled (vl).
const BIT_4: u16 = 0x10;
/// Control word bit 5 in mode vl: ramp unlocked.
const RAMP_UNLOCKED: u16 = 0x20;
/// Control word bit 6 in mode vl: ramp follows its input.
const RAMP_INPUT: u16 = 0x40;

/// Returns the mode with a number of 6060h; `None` if it is not in [`DriveMode`].
fn drive_mode(number: i8) -> Option<DriveMode> {
    DriveMode::NAMES.into_iter().map(|(_, mode)| mode).find(|mode| mode.number() == number)
}

/// State of the mode of operation between cycles.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Modes {
    /// 6060h in the last cycle.
    number: i8,
    /// Mode of the mechanics in the last cycle.
    mechanics_mode: i8,
    positioner: Positioner,
    /// Interpolator of csp and ip.
    interpolator: Interpolator,
    /// Velocity demand value of pv and vl, in counts/s.
    velocity: f64,
    /// Torque demand value of tq, in 0.1 % of rated torque.
    torque: f64,
    /// Bits of the status word while the operation is enabled.
    status: u16,
}

/// Inputs of the modes in one cycle.
#[derive(Clone, Copy, Debug)]
struct CycleInputs<'a> {
    table: &'a ObjectTable,
    factor: VelocityFactor,
    count: i64,
    control: u16,
    is_on: bool,
    cycle_s: f64,
}

impl CycleInputs<'_> {
    /// Returns an object in velocity units of the drive in counts/s, or one in such units per second in counts/s^2.
    fn per_second(&self, object: Object) -> f64 {
        per_second(self.factor, self.table.get(object).into())
    }

    /// Returns a signed object in velocity units of the drive in counts/s.
    fn signed_per_second(&self, object: Object) -> f64 {
        per_second(self.factor, self.table.signed(object).into())
    }

    fn has(&self, bit: u16) -> bool {
        self.control & bit != 0
    }

    /// Returns the ramp of 6083h and 6084h.
    fn ramp(&self) -> Ramp {
        let [up, down] = [simulated::PROFILE_ACCELERATION, simulated::PROFILE_DECELERATION];
        Ramp { up: self.per_second(up), down: self.per_second(down) }
    }

    /// Returns the ramp of 6048h and 6049h; without a time the ramp is infinitely steep.
    fn vl_ramp(&self) -> Ramp {
        let of = |[velocity, time]: [Object; 2]| match self.table.get(time) {
            0 => f64::INFINITY,
            seconds => self.per_second(velocity) / f64::from(seconds),
        };
        Ramp { up: of(simulated::VL_ACCELERATION), down: of(simulated::VL_DECELERATION) }
    }
}

/// Converts a velocity from units of the drive to counts/s.
fn per_second(factor: VelocityFactor, units: f64) -> f64 {
    units * f64::from(factor.denominator) / f64::from(factor.numerator)
}

impl Modes {
    /// Runs one cycle of the mechanics. Returns their setpoint.
    pub(super) fn step(
        &mut self,
        table: &ObjectTable,
        factor: VelocityFactor,
        drive: &DriveInput,
        cycle_s: f64,
    ) -> DriveOutput {
        let number = table.signed(objects::MODE) as i8;
        let control = table.get(objects::CONTROL_WORD) as u16;
        let is_on = DriveState::from_status(drive.status) == DriveState::Enabled;
        let now = CycleInputs { table, factor, count: drive.count, control, is_on, cycle_s };
        if number != self.number || !is_on {
            self.rest(&now);
        }
        self.number = number;
        let mut output = DriveOutput { position: now.count, control, ..DriveOutput::default() };
        let mode = drive_mode(number);
        match mode {
            Some(mode @ (DriveMode::Csp | DriveMode::Ip | DriveMode::Pp)) => {
                output.mode = Mode::Position;
                output.position = self.position(mode, &now);
            }
            Some(mode @ (DriveMode::Csv | DriveMode::Pv | DriveMode::Vl)) => {
                output.mode = if mode == DriveMode::Vl { Mode::Speed } else { Mode::Velocity };
                output.velocity = self.velocity(mode, &now);
            }
            Some(mode @ (DriveMode::Cst | DriveMode::Tq)) => {
                output.mode = Mode::Torque;
                output.effort = self.torque(mode, &now);
            }
            None if number == MODE_HOMING => output.mode = Mode::Homing(homing(&now)),
            None => {}
        }
        self.mechanics_mode = output.mode.number();
        self.status = mode.map_or(0, |mode| self.status_bits(mode, &now));
        output
    }

    /// Resets the state of all modes.
    fn rest(&mut self, now: &CycleInputs<'_>) {
        self.positioner.rest_at(now.count, now.control);
        self.interpolator.rest_at(now.count);
        (self.velocity, self.torque) = (0.0, 0.0);
    }

    fn position(&mut self, mode: DriveMode, now: &CycleInputs<'_>) -> i64 {
        let object = match mode {
            DriveMode::Csp => objects::TARGET_POSITION,
            DriveMode::Ip if now.is_on && now.has(BIT_4) => objects::INTERPOLATION_POSITION,
            DriveMode::Ip => return self.interpolator.hold(),
            _ if !now.is_on => return now.count,
            _ => {
                let (target, velocity) =
                    (now.table.signed(objects::TARGET_POSITION), now.per_second(simulated::PROFILE_VELOCITY));
                let order = SetpointCommand { target, velocity, ramp: now.ramp() };
                return self.positioner.step(now.control, order, now.cycle_s);
            }
        };
        let cycles = interpolation::cycles(now.table, now.cycle_s);
        self.interpolator.step(nearest(now.table.signed(object), now.count), cycles)
    }

    fn velocity(&mut self, mode: DriveMode, now: &CycleInputs<'_>) -> f64 {
        match mode {
            DriveMode::Csv => return now.signed_per_second(objects::TARGET_VELOCITY),
            _ if !now.is_on => {}
            DriveMode::Pv => {
                let target = if now.has(HALT) { 0.0 } else { now.signed_per_second(objects::TARGET_VELOCITY) };
                self.velocity = velocity_on_ramp(self.velocity, target, now.ramp(), now.cycle_s);
            }
            _ if !now.has(RAMP_UNLOCKED) && now.has(BIT_4) && !now.has(HALT) => {}
            _ => {
                let runs = now.has(BIT_4) && now.has(RAMP_INPUT) && !now.has(HALT);
                let target = if runs { now.signed_per_second(objects::VL_TARGET_VELOCITY) } else { 0.0 };
                self.velocity = velocity_on_ramp(self.velocity, target, now.vl_ramp(), now.cycle_s);
            }
        }
        self.velocity
    }

    fn torque(&mut self, mode: DriveMode, now: &CycleInputs<'_>) -> f64 {
        let target = f64::from(now.table.signed(objects::TARGET_TORQUE));
        if mode == DriveMode::Cst {
            return target;
        }
        if now.is_on {
            let slope = f64::from(now.table.get(simulated::TORQUE_SLOPE));
            let target = if now.has(HALT) { 0.0 } else { target };
            self.torque = velocity_on_ramp(self.torque, target, Ramp { up: slope, down: slope }, now.cycle_s);
        }
        self.torque
    }

    fn status_bits(&self, mode: DriveMode, now: &CycleInputs<'_>) -> u16 {
        let bit = |on: bool, bit: u16| if on { bit } else { 0 };
        let reached =
            |target: f64, demand: f64| bit(demand == if now.has(HALT) { 0.0 } else { target }, STATUS_TARGET_REACHED);
        match mode {
            DriveMode::Csp | DriveMode::Csv | DriveMode::Cst => STATUS_12,
            DriveMode::Ip => bit(now.has(BIT_4), STATUS_12),
            DriveMode::Pp => {
                bit(self.positioner.is_acknowledged(), STATUS_12)
                    | bit(self.positioner.is_reached(), STATUS_TARGET_REACHED)
            }
            DriveMode::Pv => {
                reached(now.signed_per_second(objects::TARGET_VELOCITY), self.velocity)
                    | bit(self.velocity == 0.0, STATUS_12)
            }
            DriveMode::Tq => reached(now.table.signed(objects::TARGET_TORQUE).into(), self.torque),
            DriveMode::Vl => 0,
        }
    }

    /// Returns 6061h for the mode of the mechanics.
    pub(super) fn displayed_mode(&self, mode: i8) -> i8 {
        if mode == self.mechanics_mode && mode != 0 { self.number } else { mode }
    }

    /// Returns bits 10 and 12 for this status word.
    pub(super) fn status(&self, status: u16) -> u16 {
        if DriveState::from_status(status) == DriveState::Enabled { self.status } else { 0 }
    }

    /// Returns the vl velocity demand value in units of the drive, within 16 bits.
    pub(super) fn vl_demand(&self, factor: VelocityFactor) -> i16 {
        let is_vl = self.number == DriveMode::Vl.number();
        units(factor, if is_vl { self.velocity } else { 0.0 })
    }
}

/// Returns a velocity in units of the drive, within 16 bits.
pub(super) fn units(factor: VelocityFactor, counts_per_s: f64) -> i16 {
    factor.to_drive(counts_per_s).clamp(i16::MIN.into(), i16::MAX.into()) as i16
}

/// Returns the homing command of 6098h, 6099h and 609Ah.
fn homing(now: &CycleInputs<'_>) -> HomingOrder {
    HomingOrder {
        method: now.table.signed(objects::HOMING_METHOD) as i8,
        search_velocity: now.per_second(objects::HOMING_SEARCH),
        zero_velocity: now.per_second(objects::HOMING_ZERO),
        acceleration: now.per_second(objects::HOMING_ACCELERATION),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lineshaft_core::drive::{MODE_CSP, MODE_CSV};

    /// 10 ms.
    const CYCLE_S: f64 = 0.01;
    const ENABLED: u16 = 0x0037;

    /// A drive with its objects and outputs; its mechanics are those of the test.
    struct Rig {
        table: ObjectTable,
        modes: Modes,
        drive: DriveInput,
    }

    impl Rig {
        fn new(mode: DriveMode) -> Self {
            let mut table = ObjectTable::plain();
            table.set(objects::MODE, mode.number().cast_unsigned().into());
            let drive = DriveInput { status: ENABLED, ..DriveInput::default() };
            Self { table, modes: Modes::default(), drive }
        }

        fn put(&mut self, object: Object, value: i32) {
            self.table.set(object, value.cast_unsigned());
        }

        fn step(&mut self, control: u16) -> DriveOutput {
            self.table.set(objects::CONTROL_WORD, control.into());
            self.modes.step(&self.table, VelocityFactor::default(), &self.drive, CYCLE_S)
        }

        fn bits(&self) -> u16 {
            self.modes.status(self.drive.status)
        }
    }

    /// 6083h 1000 and 6084h 2000 counts/s^2, 10 ms: 10 counts/s per cycle up, 20 down. Bit 10: velocity reached; bit 12: velocity is 0.
    #[test]
    fn profile_velocity_follows_its_ramps_and_halts() {
        let mut rig = Rig::new(DriveMode::Pv);
        rig.put(simulated::PROFILE_ACCELERATION, 1_000);
        rig.put(simulated::PROFILE_DECELERATION, 2_000);
        rig.put(objects::TARGET_VELOCITY, 30);
        let run = |rig: &mut Rig, control: u16, cycles: usize| -> Vec<(f64, u16)> {
            (0..cycles).map(|_| (rig.step(control).velocity, rig.bits())).collect()
        };
        assert_eq!(run(&mut rig, 0x0F, 4), [(10.0, 0), (20.0, 0), (30.0, 0x0400), (30.0, 0x0400)]);
        assert_eq!(run(&mut rig, 0x10F, 3), [(10.0, 0), (0.0, 0x1400), (0.0, 0x1400)]);
        rig.put(objects::TARGET_VELOCITY, -15);
        assert_eq!(run(&mut rig, 0x0F, 2), [(-10.0, 0), (-15.0, 0x0400)]);
        assert_eq!(rig.step(0x0F).mode, Mode::Velocity);
        rig.drive.status = 0x0033;
        assert_eq!(run(&mut rig, 0x07, 1), [(0.0, 0)], "off: it begins at 0 again");
    }

    /// The mechanics report csv; 6061h reports the commanded mode.
    #[test]
    fn display_is_the_mode_of_the_drive_not_that_of_the_mechanics() {
        for (mode, given) in [(DriveMode::Pv, MODE_CSV), (DriveMode::Pp, MODE_CSP), (DriveMode::Ip, MODE_CSP)] {
            let mut rig = Rig::new(mode);
            assert_eq!(rig.step(0x0F).mode.number(), given);
            assert_eq!((rig.modes.displayed_mode(given), rig.modes.displayed_mode(0)), (mode.number(), 0));
        }
    }

    /// ip: the setpoint applies while bit 4 is 1; after that, the last one is held.
    #[test]
    fn interpolated_position_follows_while_bit_4_is_set() {
        let mut rig = Rig::new(DriveMode::Ip);
        rig.drive.count = 100;
        rig.put(objects::INTERPOLATION_POSITION, 150);
        assert_eq!((rig.step(0x0F).position, rig.bits()), (100, 0));
        assert_eq!((rig.step(0x1F).position, rig.bits()), (150, 0x1000));
        rig.put(objects::INTERPOLATION_POSITION, 170);
        assert_eq!((rig.step(0x0F).position, rig.bits()), (150, 0));
        rig.drive.status = 0x0033;
        assert_eq!(rig.step(0x1F).position, 100, "off: where it is");
    }

    /// vl: 6048h 100 per 1 s, 6049h 200 per 1 s. Bit 5 = 0 locks the velocity, bits 4 or 6 = 0 ramp it down. Without 6048h:02 it jumps.
    #[test]
    fn velocity_mode_uses_its_ramp_with_bits_4_to_6() {
        let mut rig = Rig::new(DriveMode::Vl);
        rig.put(objects::VL_TARGET_VELOCITY, 3);
        assert_eq!(rig.step(0x7F).velocity, 3.0);
        assert_eq!(rig.step(0x7F).mode, Mode::Speed);
        for ([velocity, time], rate) in [(simulated::VL_ACCELERATION, 100), (simulated::VL_DECELERATION, 200)] {
            rig.put(velocity, rate);
            rig.put(time, 1);
        }
        rig.put(objects::VL_TARGET_VELOCITY, 6);
        assert_eq!([rig.step(0x7F).velocity, rig.step(0x5F).velocity, rig.step(0x7F).velocity], [4.0, 4.0, 5.0]);
        assert_eq!((rig.modes.vl_demand(VelocityFactor::default()), rig.bits()), (5, 0));
        assert_eq!([rig.step(0x3F).velocity, rig.step(0x6F).velocity], [3.0, 1.0]);
        assert_eq!(rig.step(0x0F).velocity, 0.0);
        // Halt also stops a locked ramp.
        assert_eq!([rig.step(0x7F).velocity, rig.step(0x5F).velocity, rig.step(0x15F).velocity], [1.0, 1.0, 0.0]);
    }

    /// tq: 6087h 1000 per mille per second, 10 ms: 10 per mille per cycle.
    #[test]
    fn profile_torque_follows_its_slope() {
        let mut rig = Rig::new(DriveMode::Tq);
        rig.put(simulated::TORQUE_SLOPE, 1_000);
        rig.put(objects::TARGET_TORQUE, -25);
        let run: Vec<_> = (0..3).map(|_| (rig.step(0x0F).effort, rig.bits())).collect();
        assert_eq!(run, [(-10.0, 0), (-20.0, 0), (-25.0, 0x0400)]);
        assert_eq!(rig.step(0x10F).effort, -15.0);
    }
}
