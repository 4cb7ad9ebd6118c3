use super::rig::{LINE, Rig, X, Y, at, config, couple, parameters, scale, to};
use crate::code::Code;
use crate::command::{Action, Commands, Move, Synchronize};
use crate::config::AxisConfig;
use crate::drive::{Backend, EncoderInput};
use crate::object::{AxisSet, Leader};
use crate::sync::Disengage;

const TO_LINE: Leader = Leader::AxisCommand(LINE);

/// Proves: MACS-SYNC-02, MACS-CMD-11
#[test]
fn a_coupled_axis_follows_a_virtual_axis_exactly_at_355_to_113() {
    let mut rig = Rig::enabled();
    rig.give(Action::Synchronize(couple(X, TO_LINE, 355, 113)));
    rig.run(1);
    assert_eq!((rig.state("x"), rig.int("x.in_sync"), rig.int("x.reference")), ("SYNCHRONIZED_MOTION", 1, 4));
    // 20 mm/s and 200 mm/s^2 are 62.8 mm/s and 628 mm/s^2 at the slave.
    rig.give(Action::Move(Move { velocity: 20_000.0, acceleration: 2e5, deceleration: 2e5, ..to(LINE, 30_000) }));
    for _ in 0..1_700 {
        rig.run(1);
        let line = rig.machine.state.leads.get(Leader::AxisCommand(LINE)).position;
        let exact = (line.raw() * 355).div_euclid(113);
        assert_eq!(rig.machine.state.leads.get(Leader::AxisCommand(X)).position.raw(), exact);
        assert_eq!((rig.int("x.sync.error"), rig.int("x.in_sync")), (0, 1));
    }
    assert_eq!((rig.state("line"), rig.int("x.command.position")), ("STANDSTILL", 30_000 * 355 / 113));
}

#[test]
fn coupled_on_the_run_it_catches_up_and_then_follows_without_error() {
    let mut rig = Rig::enabled();
    rig.give(Action::Move(at(LINE, 20_000.0)));
    rig.run(200);
    let start = rig.machine.state.leads.get(Leader::AxisCommand(LINE)).position;
    rig.give(Action::Synchronize(couple(X, TO_LINE, -1, 2)));
    let at_coupling = rig.machine.state.leads.get(Leader::AxisCommand(LINE)).position;
    assert!(at_coupling > start);
    assert_eq!((rig.int("x.in_sync"), rig.int("x.sync.status")), (0, 1));
    rig.run_until("x.in_sync", 1);
    rig.run(500);
    let way = rig.machine.state.leads.get(Leader::AxisCommand(LINE)).position - at_coupling;
    let x = rig.machine.state.leads.get(Leader::AxisCommand(X)).position;
    assert_eq!(x.raw(), (-way.raw()).div_euclid(2));
    assert!((rig.real("x.command.velocity") + 10_000.0).abs() < 1e-3);
}

/// Proves: MACS-SYNC-02
#[test]
fn left_out_ratio_is_syncfacts_to_syncfactm() {
    let mut rig = Rig::enabled();
    let row = |key| crate::parameter::Row::find(key).unwrap().0;
    let change =
        |key, value| crate::parameter::Change { axis: X, row: row(key), value: crate::parameter::Value::Int(value) };
    let set = rig.give(Action::SetParameters(Box::new([change("syncfactm", 2), change("syncfacts", 1)])));
    assert!(rig.was_accepted(set));
    rig.give(Action::Synchronize(couple(X, TO_LINE, 0, 0)));
    rig.give(Action::Move(to(LINE, 1_000)));
    rig.run_until("line.state", 1);
    assert_eq!(rig.int("x.command.position"), 500);
}

/// 2/3 inc are 2863311530.67 units of 2^-32: the remaining third of a unit is rounded up to a whole one.
#[test]
fn a_new_ratio_takes_the_remainder_along() {
    let mut rig = Rig::enabled();
    rig.give(Action::Synchronize(couple(X, Leader::Encoder(0), 2, 3)));
    rig.plant.jump_encoder(0, 1);
    rig.run(1);
    rig.give(Action::Synchronize(couple(X, Leader::Encoder(0), 1, 3)));
    rig.plant.jump_encoder(0, 1);
    rig.run(1);
    let raw = rig.machine.state.leads.get(Leader::AxisCommand(X)).position.raw();
    assert_eq!(raw, 2_863_311_530 + 1 + 1_431_655_765);
}

#[test]
fn a_chain_of_gears_adds_no_delay_whatever_the_order_of_the_file() {
    let mut rig = Rig::enabled();
    // y leads x, x leads no axis; then x is before y in the file, but y has to be first.
    rig.give(Action::Synchronize(couple(Y, TO_LINE, 1, 1)));
    rig.give(Action::Synchronize(couple(X, Leader::AxisCommand(Y), 1, 1)));
    rig.give(Action::Move(to(LINE, 20_000)));
    for _ in 0..400 {
        rig.run(1);
        assert_eq!(rig.int("x.command.position"), rig.int("line.command.position"));
    }
}

/// 64 axes, each the master of the previous one in the file, at 1 : 1, every other one inverted: the last one is at the
/// position of the first one in every cycle.
#[test]
fn a_chain_of_sixty_four_adds_no_delay() {
    let mut config = config(0);
    let line = config.axes.remove(usize::from(LINE));
    let axis = |name: String| AxisConfig::new(name, scale(), None, parameters());
    config.axes = std::iter::once(line).chain((1..=64).map(|place| axis(format!("s{place}")))).collect();
    let mut rig = Rig::of(config);
    rig.enable();
    let couplings = (1..=64_u16).map(|place| {
        // The last axis of the file is the first of the chain.
        let leader = if place == 64 { LINE } else { place + 1 };
        Action::Synchronize(couple(place, Leader::AxisCommand(leader), if place % 2 == 0 { 1 } else { -1 }, 1))
    });
    let last = rig.give_all(couplings.collect());
    assert!(rig.was_accepted(last));
    rig.give(Action::Move(Move { velocity: 20_000.0, ..to(LINE, 20_000) }));
    for _ in 0..1_500 {
        rig.run(1);
        assert_eq!(rig.int("s1.command.position"), rig.int("line.command.position"));
    }
    assert_eq!(rig.int("s1.command.position"), 20_000);
}

#[test]
fn loops_are_refused_even_when_they_are_asked_for_in_one_cycle() {
    let mut rig = Rig::enabled();
    let own = rig.give(Action::Synchronize(couple(X, Leader::AxisCommand(X), 1, 1)));
    assert_eq!(rig.refusal(own), "x: the axis would follow itself");
    let last = rig.give_all(vec![
        Action::Synchronize(couple(X, Leader::AxisCommand(Y), 1, 1)),
        Action::Synchronize(couple(Y, Leader::AxisCommand(X), 1, 1)),
    ]);
    assert!(rig.was_accepted(last - 1));
    assert_eq!(rig.refusal(last), "y: the axis would follow itself");
    let by_actual = rig.give(Action::Synchronize(couple(Y, Leader::AxisActual(X), 1, 1)));
    assert!(rig.was_accepted(by_actual), "following an input makes no loop");
}

#[test]
fn bad_ratios_are_refused() {
    let mut rig = Rig::enabled();
    for (numerator, denominator) in [(1, 0), (0, 1), (i64::MIN, 1)] {
        let sequence = rig.give(Action::Synchronize(couple(X, TO_LINE, numerator, denominator)));
        assert!(rig.refusal(sequence).contains("both parts must not be 0"));
    }
    assert_eq!(rig.state("x"), "STANDSTILL");
}

#[test]
fn cancel_uncouples_with_a_stop_or_keeps_the_velocity() {
    for (disengage, state) in [(Disengage::Stop, "STANDSTILL"), (Disengage::KeepVelocity, "CONTINUOUS_MOTION")] {
        let mut rig = Rig::enabled();
        rig.give(Action::Move(at(LINE, 20_000.0)));
        let goal = rig.give(Action::Synchronize(Synchronize { disengage, ..couple(X, TO_LINE, 1, 1) }));
        rig.run(500);
        rig.give(Action::Cancel { goal });
        rig.run(100);
        assert_eq!((rig.state("x"), rig.done(goal)[0].code), (state, Code::CANCELLED), "{disengage:?}");
        let velocity = if disengage == Disengage::Stop { 0.0 } else { 20_000.0 };
        assert!((rig.real("x.command.velocity") - velocity).abs() < 1e-3);
        if disengage == Disengage::Stop {
            assert_eq!(rig.real("x.command.fraction"), 0.0);
        }
    }
}

#[test]
fn a_coupling_that_stands_still_ends_at_once() {
    for by_halt in [false, true] {
        let mut rig = Rig::enabled();
        let goal = rig.give(Action::Synchronize(couple(X, TO_LINE, 355, 113)));
        rig.run(10);
        let end = if by_halt { Action::Halt(AxisSet::one(X)) } else { Action::Cancel { goal } };
        let end = rig.give(end);
        assert_eq!((rig.state("x"), rig.done(end).len()), ("STANDSTILL", 1));
        let code = if by_halt { Code::HALTED } else { Code::CANCELLED };
        assert_eq!(rig.done(goal)[0].code, code);
    }
}

#[test]
fn an_encoder_leads_through_its_wrap_and_its_loss_stops_the_follower() {
    let mut rig = Rig::enabled();
    let belt = Leader::Encoder(0);
    rig.give(Action::Synchronize(couple(X, belt, 1, 1)));
    let mut inputs = rig.machine.inputs();
    let mut outputs = rig.machine.outputs();
    let mut read = |rig: &mut Rig, count: i64, valid| {
        inputs.begin(0, 0);
        rig.plant.read(&mut inputs);
        inputs.encoder[0] = EncoderInput { count, epoch: 0, valid, index: None };
        rig.machine.cycle(&inputs, Commands::default(), &mut outputs);
        rig.plant.write(&outputs);
        rig.events.extend_from_slice(rig.machine.events());
    };
    let mut way = 0_i64;
    for _ in 0..4_000 {
        way += 19;
        read(&mut rig, way & 0xFFFF, true);
    }
    assert_eq!((rig.int("x.command.position"), rig.int("x.in_sync")), (way, 1));
    assert_eq!(rig.int("belt.position"), way);
    read(&mut rig, way & 0xFFFF, false);
    assert_eq!((rig.state("x"), rig.int("x.error")), ("ERROR_STOP", i64::from(Code::LEADER_LOST.0)));
    assert_eq!(rig.int("belt.error"), i64::from(Code::ENCODER_INVALID.0));
    let told = |rig: &Rig| rig.events.iter().filter(|event| event.code == Code::ENCODER_INVALID).count();
    assert_eq!(told(&rig), 1);
    for _ in 0..100 {
        read(&mut rig, way & 0xFFFF, false);
    }
    assert_eq!((rig.real("x.command.velocity"), told(&rig)), (0.0, 1), "told once, not in every cycle");
}

#[test]
fn a_disabled_axis_cannot_be_coupled_and_a_lost_drive_cannot_lead() {
    let mut rig = Rig::enabled();
    rig.give(Action::Disable(AxisSet::one(Y)));
    rig.run(3);
    let off = rig.give(Action::Synchronize(couple(Y, TO_LINE, 1, 1)));
    assert!(rig.refusal(off).contains("not enabled"));
    rig.plant.drive(1).unwrap().disconnect();
    rig.run(1);
    let lost = rig.give(Action::Synchronize(couple(X, Leader::AxisActual(Y), 1, 1)));
    assert!(rig.refusal(lost).contains("lost"));
}

#[test]
fn more_than_64_commands_of_a_cycle_are_refused_not_lost() {
    let mut rig = Rig::enabled();
    let last = rig.give_all(vec![Action::Halt(AxisSet::one(X)); 66]);
    assert!(rig.refusal(last).contains("too many"));
    assert!(rig.refusal(last - 1).contains("too many"));
    assert!(rig.was_accepted(last - 2));
}
