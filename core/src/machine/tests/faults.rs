//! Random faults in random motions: each causes its specified reaction in the cycle in which it can be detected, and
//! none stays unreported.
//!
//! The expected reactions are repeated here from docs/spec/macs.md (ERR-02, LIM-08, A-17) and docs/errors.md.

mod cut;
mod idle;
mod page;
mod table;
mod ways;

use super::rig::{LINE, Rig, X, Y, at, config, couple, to};
use crate::axis::Safety;
use crate::code::Code;
use crate::command::{Action, Move};
use crate::config::{IoConfig, IoKind};
use crate::drive::inputs;
use crate::event::Kind;
use crate::object::{AxisSet, Leader, Object};
use crate::parameter::{Change, Row, Value};
use std::collections::BTreeMap;

/// Contacts of the cell, by their inputs.
const ESTOP: usize = 0;
const DOOR: usize = 1;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Fault {
    /// A slip of the motor (inc) that only the following error shows.
    Slip(i64),
    /// A slip with `max_encoder_jump` set, also within the following error limit.
    Jump(i64),
    /// The encoder line is cut, and the drive reports it.
    Cut,
    /// The drive reports a fault.
    Drive,
    /// The connection to the drive is lost.
    Lost,
    /// The limit switch ahead is reached; at rest, the one in the direction of rising counts.
    Switch,
    /// Both limit switches are active.
    Both,
    /// The guard opens.
    Door,
    /// The emergency stop opens.
    Estop,
    /// The index is missing while the axis searches for it.
    LostIndex,
    /// The reference switch never changes while the axis searches for it.
    StuckSwitch,
    /// A limit switch is stuck during the search for the reference switch.
    StuckLimit,
    /// A velocity goal reaches a software limit.
    VelocityIntoLimit,
    /// The leader moves the axis into a software limit.
    LedIntoLimit,
}

impl Fault {
    /// Returns the name under which the fault is counted.
    fn name(self) -> &'static str {
        match self {
            Fault::Slip(_) => "encoder jump, by the following error",
            Fault::Jump(_) => "encoder jump, by max_encoder_jump",
            Fault::Cut => "encoder line cut, told by the drive",
            Fault::Drive => "fault of the drive",
            Fault::Lost => "drive lost",
            Fault::Switch => "limit switch",
            Fault::Both => "both limit switches",
            Fault::Door => "interlock",
            Fault::Estop => "emergency stop",
            Fault::LostIndex => "index lost in homing",
            Fault::StuckSwitch => "reference switch stuck in homing",
            Fault::StuckLimit => "limit switch stuck in homing",
            Fault::VelocityIntoLimit => "software limit, at a velocity",
            Fault::LedIntoLimit => "software limit, coupled",
        }
    }

    /// Returns the code that other axes may report because of this fault.
    fn reaches_others(self) -> Option<Code> {
        match self {
            Fault::Door => Some(Code::INTERLOCK),
            Fault::Estop => Some(Code::EMERGENCY_STOP),
            _ => None,
        }
    }
}

/// Pseudo-random numbers, the same in every run.
struct Numbers(u64);

impl Numbers {
    fn below(&mut self, bound: u64) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % bound
    }
}

/// State of an axis: whether it is on, its brake, and whether it continues as before.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Shown {
    on: bool,
    brake: bool,
    goes_on: bool,
}

const fn shown(on: bool, brake: bool) -> Shown {
    Shown { on, brake, goes_on: false }
}

/// Returns the expected states in the cycle of the error, and once the axis is at rest.
fn by_errcond(errcond: i64) -> (Shown, Shown) {
    match errcond {
        0 => (shown(false, false), shown(false, false)),
        1 => (shown(false, true), shown(false, true)),
        2 => (shown(true, false), shown(true, false)),
        3 => (shown(true, false), shown(true, true)),
        4 => (shown(false, false), shown(false, false)),
        _ => (Shown { goes_on: true, ..shown(true, false) }, Shown { goes_on: true, ..shown(true, false) }),
    }
}

fn expected(fault: Fault, errcond: i64, endswmod: i64) -> (Shown, Shown) {
    match fault {
        Fault::Slip(_) => by_errcond(errcond),
        Fault::Jump(_) => by_errcond(if errcond == 5 { 2 } else { errcond }),
        // A failed homing stops in any case, but without a lock.
        Fault::LostIndex | Fault::StuckSwitch | Fault::StuckLimit => by_errcond(errcond),
        // The axis stops at the limit with any reaction, and the reaction follows.
        Fault::VelocityIntoLimit | Fault::LedIntoLimit => {
            (shown(true, false), by_errcond(if errcond == 5 { 2 } else { errcond }).1)
        }
        Fault::Cut | Fault::Drive | Fault::Lost => {
            let brake = matches!(errcond, 1 | 3);
            (shown(false, brake), shown(false, brake))
        }
        Fault::Switch | Fault::Both if endswmod == 1 || errcond == 5 => by_errcond(2),
        Fault::Switch | Fault::Both => by_errcond(errcond),
        Fault::Door => by_errcond(if errcond == 3 { 3 } else { 2 }),
        Fault::Estop => (shown(true, false), shown(false, true)),
    }
}

fn rig() -> Rig {
    let mut config = config(0);
    for name in ["estop", "door"] {
        config.io.push(IoConfig { name: name.into(), kind: IoKind::DigitalInput, latch: false });
    }
    config.safety = Safety { estop: Some(ESTOP as u32), interlock: Some(DOOR as u32) };
    let mut rig = Rig::of(config);
    rig.plant.set_digital(ESTOP, true);
    rig.plant.set_digital(DOOR, true);
    rig
}

fn set(rig: &mut Rig, key: &str, value: i64) {
    assign(rig, key, Value::Int(value));
}

fn assign(rig: &mut Rig, key: &str, value: Value) {
    let row = Row::find(key).map(|(row, _)| row).expect(key);
    let sequence = rig.give(Action::SetParameters([Change { axis: X, row, value }].into()));
    assert!(rig.was_accepted(sequence), "{key} {value:?}");
}

/// Starts a random motion of x.
fn begin(rig: &mut Rig, numbers: &mut Numbers) {
    let sign = if numbers.below(2) == 0 { 1.0 } else { -1.0 };
    let velocity = sign * (10_000.0 + numbers.below(80_000) as f64);
    match numbers.below(5) {
        0 => {}
        1 => _ = rig.give(Action::Move(at(X, velocity))),
        2 => {
            let far = rig.int("x.command.position") + if sign > 0.0 { 500_000 } else { -500_000 };
            _ = rig.give(Action::Move(Move { velocity: velocity.abs(), ..to(X, far) }));
        }
        3 => {
            _ = rig.give(Action::Synchronize(couple(X, Leader::AxisCommand(LINE), 1, 1)));
            _ = rig.give(Action::Move(at(LINE, velocity)));
        }
        _ => _ = rig.give(Action::Synchronize(couple(X, Leader::AxisActual(Y), 1, 2))),
    }
    rig.run(1 + numbers.below(250));
}

/// Injects a fault and returns its expected code.
fn inject(rig: &mut Rig, fault: Fault) -> Code {
    let velocity = rig.real("x.command.velocity");
    let drive = rig.plant.drive(0).expect("x");
    match fault {
        Fault::Slip(by) => {
            drive.jump(by);
            Code::FOLLOWING_ERROR
        }
        Fault::Jump(by) => {
            drive.jump(by);
            Code::ENCODER_JUMP
        }
        Fault::Cut => {
            drive.cut_encoder();
            Code::drive_fault(0x7305)
        }
        Fault::Drive => {
            drive.inject_fault(0x8611);
            Code::drive_fault(0x8611)
        }
        Fault::Lost => {
            drive.disconnect();
            Code::DRIVE_LOST
        }
        Fault::Switch => {
            let bit = if velocity < 0.0 { inputs::NEGATIVE_LIMIT } else { inputs::POSITIVE_LIMIT };
            drive.set_stuck_inputs(bit, bit);
            if velocity < 0.0 { Code::HARDWARE_LIMIT_NEGATIVE } else { Code::HARDWARE_LIMIT_POSITIVE }
        }
        Fault::Both => {
            let both = inputs::POSITIVE_LIMIT | inputs::NEGATIVE_LIMIT;
            drive.set_stuck_inputs(both, both);
            Code::BOTH_LIMIT_SWITCHES
        }
        Fault::Door => {
            rig.plant.set_digital(DOOR, false);
            Code::INTERLOCK
        }
        Fault::Estop => {
            rig.plant.set_digital(ESTOP, false);
            Code::EMERGENCY_STOP
        }
        Fault::LostIndex | Fault::StuckSwitch | Fault::StuckLimit | Fault::VelocityIntoLimit | Fault::LedIntoLimit => {
            unreachable!("it has a way of its own")
        }
    }
}

/// Returns the errors that an axis has reported since the list was emptied.
fn errors(rig: &Rig, axis: u16) -> Vec<Code> {
    let of_axis = rig.events.iter().filter(|event| event.source == Object::Axis(axis));
    of_axis.filter(|event| event.kind == Kind::Error).map(|event| event.code).collect()
}

fn check(rig: &Rig, what: Shown, text: &str) {
    let is = Shown {
        on: rig.int("x.enabled") == 1,
        brake: rig.int("x.brake") == 1,
        goes_on: rig.state("x") != "ERROR_STOP",
    };
    assert_eq!(is, what, "{text}");
}

fn any_fault(numbers: &mut Numbers) -> Fault {
    let sign = if numbers.below(2) == 0 { 1 } else { -1 };
    match numbers.below(14) {
        0 => Fault::Slip(sign * (1_001 + numbers.below(5_000) as i64)),
        // Above the step of all its motions; the following error limit is 1000.
        1 => Fault::Jump(sign * (300 + numbers.below(3_000) as i64)),
        2 => Fault::Cut,
        3 => Fault::Drive,
        4 => Fault::Lost,
        5 => Fault::Switch,
        6 => Fault::Both,
        7 => Fault::Door,
        8 => Fault::Estop,
        9 => Fault::LostIndex,
        10 => Fault::StuckSwitch,
        11 => Fault::StuckLimit,
        12 => Fault::VelocityIntoLimit,
        _ => Fault::LedIntoLimit,
    }
}

/// Runs one fault from its first cycle to the recovery.
fn run_fault(rig: &mut Rig, numbers: &mut Numbers) -> Fault {
    rig.events.clear();
    let (errcond, endswmod) = (numbers.below(6) as i64, numbers.below(2) as i64);
    set(rig, "error_reaction", errcond);
    set(rig, "endswmod", endswmod);
    let fault = any_fault(numbers);
    let code = match fault {
        Fault::LostIndex | Fault::StuckSwitch | Fault::StuckLimit => ways::fail_to_home(rig, numbers, fault),
        Fault::VelocityIntoLimit | Fault::LedIntoLimit => ways::run_into_limit(rig, numbers, fault),
        _ => {
            begin(rig, numbers);
            if matches!(fault, Fault::Jump(_)) {
                set(rig, "max_encoder_jump", 150);
            }
            assert_eq!(errors(rig, X), [], "{fault:?}");
            let code = inject(rig, fault);
            rig.run(1);
            code
        }
    };
    let at_limit = matches!(fault, Fault::VelocityIntoLimit | Fault::LedIntoLimit);
    let limit = at_limit.then(|| ways::limit(rig));
    let cycle = rig.machine.next_cycle() - 1;
    let text = format!("cycle {cycle}: {fault:?}, errcond {errcond}, endswmod {endswmod}");
    assert_eq!(errors(rig, X), [code], "{text}");
    check_reaction(rig, code, expected(fault, errcond, endswmod), &text);
    if let Some(limit) = limit {
        let before =
            (limit - rig.int("x.actual.position")) * if code == Code::SOFTWARE_LIMIT_POSITIVE { 1 } else { -1 };
        // If the reaction removes the power, this happens before the drive has made the last step, and never after the
        // limit.
        let most = if matches!(errcond, 0 | 1 | 4) { 2 } else { 0 };
        assert!((0..=most).contains(&before), "{text}: it stands {before} before the limit");
    }
    let may_go_on = matches!(fault, Fault::Slip(_)) && errcond == 5;
    assert!(may_go_on || rig.real("x.command.velocity") == 0.0, "{text}: it stands");
    recover(rig, &text);
    assert_eq!(errors(rig, X), [code], "{text}: told once");
    for other in [LINE, Y] {
        let told = errors(rig, other);
        assert!(told.len() <= 1 && told.iter().all(|told| Some(*told) == fault.reaches_others()), "{text}: {told:?}");
    }
    fault
}

/// Checks that the axis shows the error and its reaction, from this cycle until it is at rest.
fn check_reaction(rig: &mut Rig, code: Code, (at_once, at_rest): (Shown, Shown), text: &str) {
    assert_eq!(rig.int("x.error"), i64::from(code.0), "{text}");
    // A stop that ends in its first cycle has also executed the following action. If the encoder jumped within the
    // following error limit, the axis waits for it.
    let jumped = code == Code::ENCODER_JUMP && rig.int("x.following_error").abs() <= 1_000;
    let stands = rig.real("x.command.velocity") == 0.0 && !at_once.goes_on && !jumped;
    check(rig, if stands { at_rest } else { at_once }, text);
    if at_once.on && !at_once.goes_on {
        // A command of this cycle was already in progress; the next one is that of the stop.
        let now = rig.real("x.command.velocity").abs();
        rig.run(1);
        let next = rig.real("x.command.velocity").abs();
        // At a software limit the axis stops exactly there, with the deceleration needed for that.
        let at_limit = matches!(code, Code::SOFTWARE_LIMIT_POSITIVE | Code::SOFTWARE_LIMIT_NEGATIVE);
        let least = if at_limit { 1.0 } else { 999.0 };
        assert!(next <= (now - least).max(0.0), "{text}: {now} to {next} is no stop with 1 inc/ms^2");
    }
    rig.run(120);
    check(rig, at_rest, text);
    assert_eq!(rig.int("x.error"), i64::from(code.0), "{text}: the first error stays");
}

fn recover(rig: &mut Rig, text: &str) {
    let all = inputs::POSITIVE_LIMIT | inputs::NEGATIVE_LIMIT;
    let drive = rig.plant.drive(0).expect("x");
    drive.set_stuck_inputs(all, 0);
    drive.reconnect();
    drive.restore_index();
    rig.plant.set_digital(ESTOP, true);
    rig.plant.set_digital(DOOR, true);
    rig.run(1);
    rig.give(Action::Halt(AxisSet::first(3)));
    rig.run(120);
    for key in ["max_encoder_jump", "min_position", "max_position"] {
        assign(rig, key, Value::Unset);
    }
    let reset = rig.give(Action::ResetErrors(AxisSet::first(3)));
    rig.run(10);
    assert!(rig.done(reset).iter().all(|done| done.code.is_none()), "{text}: {:?}", rig.done(reset));
    let enable = rig.give(Action::Enable(AxisSet::first(3)));
    rig.run(40);
    assert_eq!((rig.state("x"), rig.int("x.error"), rig.done(enable).len()), ("STANDSTILL", 0, 3), "{text}");
}

/// 10^5 cycles, and 10^6 with LINESHAFT_LONG.
///
/// Proves: MACS-ERR-02, MACS-LIM-08
#[test]
fn every_fault_ends_in_its_reaction_in_its_cycle() {
    let cycles = if std::env::var_os("LINESHAFT_LONG").is_some() { 1_000_000 } else { 100_000 };
    let mut rig = rig();
    rig.enable();
    let mut numbers = Numbers(11);
    let mut counted: BTreeMap<&str, u64> = BTreeMap::new();
    while rig.machine.next_cycle() < cycles {
        *counted.entry(run_fault(&mut rig, &mut numbers).name()).or_default() += 1;
    }
    let faults: u64 = counted.values().sum();
    println!("{faults} faults in {} cycles, each answered in its cycle and told once:", rig.machine.next_cycle());
    for (name, times) in &counted {
        println!("{times:6} {name}");
    }
    assert_eq!(counted.len(), 14, "of all kinds");
    assert!(faults > cycles / 700, "{faults}");
}
