//! Actions after a stop once the axis is at rest: the power is removed and the brake closes then, and not earlier; and
//! an axis that was stopped by a software limit must not try again.

use super::super::rig::{LINE, Rig, X, at, config, couple};
use crate::code::Code;
use crate::command::{Action, Move};
use crate::config::{IoConfig, IoKind};
use crate::drive::Inputs;
use crate::event::Kind;
use crate::object::{AxisSet, Leader};
use crate::parameter::{Change, Row, Value};
use crate::sim::{Model, SecondOrder};

const MS: u64 = 1_000_000;

fn errors(rig: &Rig) -> Vec<Code> {
    let found = rig.events.iter().filter(|event| event.kind == Kind::Error);
    found.map(|event| event.code).collect()
}

fn set(rig: &mut Rig, key: &str, value: i64) {
    let changed = [Change { axis: X, row: Row::find(key).unwrap().0, value: Value::Int(value) }];
    let sequence = rig.give(Action::SetParameters(changed.into()));
    assert!(rig.was_accepted(sequence));
}

/// x has limits of -2 mm and 4 mm with 2 m/s^2; the line reaches its velocity at once.
fn coupled(profile: i64) -> Rig {
    let mut config = config(0);
    config.axes[usize::from(LINE)].parameters.max_acceleration = 1e9;
    let p = &mut config.axes[usize::from(X)].parameters;
    (p.min_position, p.max_position) = (Some(-2_000), Some(4_000));
    (p.max_acceleration, p.max_jerk) = (2e6, Some(1e8));
    let mut rig = Rig::of(config);
    rig.enable();
    set(&mut rig, "profile", profile);
    rig
}

fn lead(rig: &mut Rig, velocity: f64) {
    rig.give(Action::Move(at(LINE, velocity)));
    rig.run(5);
    rig.give(Action::Synchronize(couple(X, Leader::AxisCommand(LINE), 1, 1)));
}

/// Runs until the axis is stopped and at rest. Returns its velocity at the start of the stop (inc/s).
fn run_to_limit(rig: &mut Rig) -> f64 {
    rig.run_until("x.state", 7);
    let velocity = rig.real("x.command.velocity");
    rig.run(500);
    assert_eq!(rig.real("x.command.velocity"), 0.0);
    velocity
}

fn reset(rig: &mut Rig) {
    rig.give(Action::ResetErrors(AxisSet::one(X)));
    rig.run(10);
    assert_eq!((rig.state("x"), rig.int("x.error")), ("STANDSTILL", 0));
}

/// At the limit the axis follows error_reaction. A new attempt has the reaction of code 98 at a switch: endswmod 1
/// stops and holds; with 0 error_reaction decides, where 5 holds, too.
///
/// Proves: MACS-LIM-05, MACS-LIM-08
#[test]
fn a_new_attempt_at_a_software_limit_reacts_as_its_code_says() {
    for (endswmod, reaction, first, again) in
        [(1, 0, false, true), (0, 0, false, false), (1, 2, true, true), (1, 5, true, true), (0, 5, true, true)]
    {
        let mut rig = coupled(0);
        set(&mut rig, "endswmod", endswmod);
        set(&mut rig, "error_reaction", reaction);
        lead(&mut rig, 20_000.0);
        run_to_limit(&mut rig);
        assert_eq!(rig.int("x.enabled") == 1, first, "endswmod {endswmod}, error_reaction {reaction}");
        rig.give(Action::ResetErrors(AxisSet::one(X)));
        rig.run(10);
        if !first {
            rig.enable();
        }
        lead(&mut rig, 20_000.0);
        run_to_limit(&mut rig);
        assert_eq!(errors(&rig), [Code::SOFTWARE_LIMIT_POSITIVE, Code::LIMIT_VIOLATION]);
        assert_eq!(rig.int("x.enabled") == 1, again, "endswmod {endswmod}, error_reaction {reaction}, again");
        assert_eq!(rig.int("x.command.position"), 4_000);
    }
}

/// It was led there at 20 mm/s and had to brake, so it was before its limit when the stop started: the first new
/// attempt is 98.
///
/// Proves: MACS-LIM-05
#[test]
fn what_was_braked_before_its_limit_may_not_try_again_either() {
    for way in [1.0, -1.0] {
        for velocity_goal in [false, true] {
            let mut rig = coupled(0);
            rig.mirror();
            if velocity_goal {
                rig.give(Action::Move(Move { acceleration: 1e6, deceleration: 1e6, ..at(X, 20_000.0 * way) }));
            } else {
                lead(&mut rig, 20_000.0 * way);
            }
            assert!(run_to_limit(&mut rig).abs() > 10_000.0);
            let (limit, code) = match way > 0.0 {
                true => (4_000, Code::SOFTWARE_LIMIT_POSITIVE),
                false => (-2_000, Code::SOFTWARE_LIMIT_NEGATIVE),
            };
            assert_eq!((rig.int("x.command.position"), errors(&rig)), (limit, vec![code]));
            for attempt in 1..3 {
                reset(&mut rig);
                lead(&mut rig, 20_000.0 * way);
                run_to_limit(&mut rig);
                assert_eq!(rig.int("x.command.position"), limit);
                assert_eq!((errors(&rig).len(), errors(&rig)[attempt]), (attempt + 1, Code::LIMIT_VIOLATION));
            }
            // Led away by 1 mm it has left the limit: motion into the limit is not a new attempt.
            reset(&mut rig);
            lead(&mut rig, -10_000.0 * way);
            rig.run(100);
            assert_eq!(rig.state("x"), "SYNCHRONIZED_MOTION");
            rig.give(Action::Halt(AxisSet::one(X)));
            rig.run(100);
            assert!((rig.int("x.command.position") - limit).abs() > 500);
            lead(&mut rig, 20_000.0 * way);
            run_to_limit(&mut rig);
            assert_eq!(errors(&rig)[3..], [code]);
        }
    }
}

/// A limit that was moved further counts as another limit.
///
/// Proves: MACS-LIM-06
#[test]
fn a_limit_that_was_moved_on_is_another_one() {
    let mut rig = coupled(0);
    lead(&mut rig, 20_000.0);
    run_to_limit(&mut rig);
    set(&mut rig, "max_position", 6_000);
    reset(&mut rig);
    lead(&mut rig, 20_000.0);
    run_to_limit(&mut rig);
    assert_eq!((errors(&rig), rig.int("x.command.position")), (vec![Code::SOFTWARE_LIMIT_POSITIVE; 2], 6_000));
}

/// Returns a rig with a drive that is far behind its command when this stops.
fn lagging(reaction: i64, io: &[IoKind]) -> Rig {
    let mut config = config(0);
    config.io = io.iter().map(|kind| IoConfig { name: "contact".into(), kind: *kind, latch: false }).collect();
    let x = &mut config.axes[usize::from(X)];
    (x.parameters.min_position, x.parameters.max_position) = (Some(-20_000), Some(20_000));
    (x.parameters.error_reaction, x.parameters.max_following_error) = (reaction, 50_000);
    config.safety.estop = (!io.is_empty()).then_some(0);
    let model = Model::SecondOrder(SecondOrder::new(5.0, 1.0, MS).expect("a drive"));
    let mut rig = Rig::with(config, [model, Model::Ideal]);
    rig.plant.set_digital(0, true);
    rig.enable();
    rig.give(Action::Move(at(X, 50_000.0)));
    rig.run(200);
    rig
}

/// Runs until the power is removed. Returns for how many cycles the command has been at rest then.
fn run_until_off(rig: &mut Rig) -> u64 {
    let mut stands = 0;
    for _ in 0..10_000 {
        if rig.int("x.output.control") == 0 {
            return stands;
        }
        assert_eq!(rig.int("x.brake"), 0, "it closes no earlier");
        rig.run(1);
        stands = if rig.real("x.command.velocity") == 0.0 { stands + 1 } else { 0 };
    }
    panic!("the power stays");
}

/// With a drive of 5 Hz and damping 1, the remaining distance d at the stop of the command decreases as d (1 + wt)
/// e^-wt, where d is 2 / w of 50 mm/s less the share of the 50 ms ramp: about 1.5 mm. At rest means at most 2 inc in 5
/// ms.
///
/// Proves: MACS-ERR-02
#[test]
fn power_is_removed_once_the_axis_not_its_command_is_at_rest() {
    for (what, reaction) in [("limit", 0), ("limit", 1), ("limit", 3), ("disable", 2), ("contact", 2), ("limit", 2)] {
        let io: &[IoKind] = if what == "contact" { &[IoKind::DigitalInput] } else { &[] };
        let mut rig = lagging(reaction, io);
        rig.mirror();
        match what {
            "disable" => _ = rig.give(Action::Disable(AxisSet::one(X))),
            "contact" => rig.plant.set_digital(0, false),
            _ => _ = rig.run_until("x.state", 7),
        }
        if reaction == 2 && what == "limit" {
            rig.run(2_000);
            assert_eq!((rig.int("x.enabled"), rig.int("x.brake")), (1, 0), "it holds");
            continue;
        }
        let before = |rig: &Rig| rig.int("x.actual.position");
        let (mut last, mut stands) = (std::collections::VecDeque::from([before(&rig)]), 0);
        let is_done = |rig: &Rig| rig.int("x.output.control") == 0 || rig.int("x.brake") == 1;
        while !is_done(&rig) {
            rig.run(1);
            last.push_front(before(&rig));
            stands = if rig.real("x.command.velocity") == 0.0 { stands + 1 } else { 0 };
            assert!(stands < 1_000, "{what} {reaction}");
        }
        assert!(stands > 100, "{what} {reaction}: {stands} ms after its command");
        let moved = last[0].abs_diff(last[5]);
        assert!(moved <= 5, "{what} {reaction}: {moved} inc in 5 ms");
        assert_eq!(rig.int("x.brake"), i64::from(reaction & 1 == 1 || what == "contact"), "{what} {reaction}");
        let sequence = rig.give(Action::ResetErrors(AxisSet::one(X)));
        rig.run(20);
        assert_eq!(rig.done(sequence).len(), 1, "{what} {reaction}");
    }
}

/// The wait ends after 5 s, and a reset in between does not end it earlier.
#[test]
fn axis_that_never_comes_to_rest_is_switched_off_after_timeout() {
    fn tremble(inputs: &mut Inputs) {
        inputs.drive[0].count += 50 * (inputs.cycle & 1) as i64;
    }
    let mut rig = lagging(0, &[]);
    rig.run_until("x.state", 7);
    rig.modify_inputs = tremble;
    let sequence = rig.give(Action::ResetErrors(AxisSet::one(X)));
    let waited = run_until_off(&mut rig);
    assert!((5_000..5_010).contains(&waited), "{waited}");
    assert_eq!(rig.done(sequence).len(), 0);
    rig.modify_inputs = |_| {};
    rig.run(20);
    assert_eq!((rig.state("x"), rig.done(sequence).len()), ("DISABLED", 1));
}

/// A drive that moves away from its command by more than the following error limit is not waited for.
#[test]
fn axis_moving_away_from_command_is_switched_off() {
    fn run_away(inputs: &mut Inputs) {
        inputs.drive[0].count += 40 * inputs.cycle as i64 - 20_000;
    }
    let mut rig = lagging(0, &[]);
    set(&mut rig, "max_following_error", 4_000);
    rig.run_until("x.state", 7);
    rig.modify_inputs = run_away;
    let waited = run_until_off(&mut rig);
    // About 40 ms until the command is at rest; with 40 inc/ms past it, the error is 4 mm 100 ms after the drive
    // reached the position.
    assert!((50..300).contains(&waited), "{waited}");
    let error = rig.int("x.fault.actual") - rig.int("x.actual.position");
    assert!(error < -4_000, "{error}");
}
