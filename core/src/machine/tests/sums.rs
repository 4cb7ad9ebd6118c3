//! Sums of masters: exact, without delay, and lost with each member.

use super::rig::{LINE, Rig, X, Y, at, cases, config, couple, to};
use crate::code::Code;
use crate::command::{Action, CommandFunction, MasterPosition, SetMasterPosition, SetPosition};
use crate::config::{
    ConfigError, MachineConfig, MemoryConfig, MemoryKind, SinkConfig, SlotConfig, SourceConfig, SumConfig,
};
use crate::encoder::Form;
use crate::function::{Kind, Order};
use crate::machine::{Machine, StateError};
use crate::object::{AxisSet, Leader};
use crate::parameter::{Change, Row, Value};
use crate::position::Length;
use proptest::prelude::*;

const BELT: Leader = Leader::Encoder(0);
const SUM: Leader = Leader::Sum(0);

pub(super) fn master(name: &str, add: &[Leader], subtract: &[Leader]) -> SumConfig {
    SumConfig { name: name.into(), add: add.to_vec(), subtract: subtract.to_vec() }
}

/// Returns a cell in which x follows its leader without limits.
fn cell(masters: Vec<SumConfig>) -> MachineConfig {
    let mut config = MachineConfig { masters, ..config(0) };
    let p = &mut config.axes[usize::from(X)].parameters;
    (p.max_velocity, p.max_acceleration) = (1e11, 1e14);
    config
}

pub(super) fn enabled(config: MachineConfig) -> Rig {
    let mut rig = Rig::of(config);
    rig.enable();
    rig
}

fn sum_of(add: &[Leader], subtract: &[Leader]) -> Rig {
    enabled(cell(vec![master("sum", add, subtract)]))
}

/// Returns a slot that copies its source.
pub(super) fn copying(source: Leader, sink: SinkConfig) -> SlotConfig {
    let mut slot = SlotConfig::new("f".into(), 0, Kind::Dcopy);
    (slot.source, slot.sink) = (SourceConfig::Lead(source), sink);
    slot
}

pub(super) fn raw(rig: &Rig, leader: Leader) -> i128 {
    rig.machine.state.leads.get(leader).position.raw()
}

fn origin(axis: u16, position: i64) -> Action {
    Action::SetPosition(SetPosition { axis, position: Length::whole(position) })
}

pub(super) fn start(slot: u16) -> Action {
    Action::CommandFunction(CommandFunction { slot, order: Order::Start, values: Box::new([]) })
}

/// The slave is at 355/113 of belt + y - line in each of 10^5 cycles, to the unit of 2^-32, with any reversals.
#[test]
fn a_follower_of_a_sum_is_exact_over_many_reversals() {
    let (actual, line) = (Leader::AxisActual(Y), Leader::AxisCommand(LINE));
    let mut rig = sum_of(&[BELT, actual], &[line]);
    rig.give(Action::Synchronize(couple(X, SUM, 355, 113)));
    let (mut turns, mut before) = (0, 0);
    for cycle in 0_i64..100_000 {
        if cycle % 700 == 0 {
            let place = cycle / 700 * 7_919 % 20_011 - 10_000;
            rig.give_all(vec![Action::Move(to(LINE, place)), Action::Move(to(Y, -place / 3))]);
        }
        rig.plant.jump_encoder(0, if cycle / 1_000 % 2 == 0 { cycle % 5 } else { -(cycle % 4) });
        rig.run(1);
        let members = raw(&rig, BELT) + raw(&rig, actual) - raw(&rig, line);
        assert_eq!(raw(&rig, Leader::AxisCommand(X)), (members * 355).div_euclid(113), "in cycle {cycle}");
        assert_eq!((rig.int("sum.position"), rig.int("sum.valid")), ((members >> 32) as i64, 1));
        assert_eq!(rig.real("sum.fraction") * 4_294_967_296.0, f64::from(members as u32), "in cycle {cycle}");
        turns += i64::from((members < before) != (cycle / 1_000 % 2 == 1));
        before = members;
    }
    assert!(turns > 100, "{turns}");
    assert_eq!((rig.int("x.in_sync"), rig.int("x.error")), (1, 0));
}

#[derive(Clone, Copy, Debug)]
struct Step {
    belt: i64,
    drive: i64,
    line: f64,
}

fn step() -> impl Strategy<Value = Step> {
    (-300_i64..300, -400_i64..400, -90_000.0..90_000.0_f64).prop_map(|(belt, drive, line)| Step { belt, drive, line })
}

proptest! {
    #![proptest_config(cases(16))]

    /// slave = ratio * (sum of the members), for any changes of them, any signs and any ratio, also through a sum of
    /// sums.
    #[test]
    fn a_slave_is_the_ratio_of_the_sum_of_the_members(
        signs in prop::array::uniform3(-1_i64..=1),
        (numerator, denominator) in (prop::sample::select(vec![-1_000_003_i64, -7, 1, 355, 99_991]), 1_i64..5_000),
        steps in prop::collection::vec(step(), 1..80),
        is_nested: bool,
    ) {
        prop_assume!(signs != [0; 3]);
        let members = [BELT, Leader::AxisActual(Y), Leader::AxisCommand(LINE)];
        let with = |sign| -> Vec<Leader> {
            members.iter().zip(signs).filter(|(_, of)| *of == sign).map(|(member, _)| *member).collect()
        };
        let (add, subtract) = (with(1), with(-1));
        // Directly, or subtracted from zero twice.
        let masters = if is_nested {
            vec![master("sum", &[], &[Leader::Sum(1)]), master("inner", &subtract, &add)]
        } else {
            vec![master("sum", &add, &subtract)]
        };
        let mut rig = enabled(cell(masters));
        rig.give(Action::Synchronize(couple(X, SUM, numerator, denominator)));
        for Step { belt, drive, line } in steps {
            rig.plant.jump_encoder(0, belt);
            rig.plant.drive(1).unwrap().jump(drive);
            rig.give(Action::Move(at(LINE, line)));
            for _ in 0..3 {
                let sum: i128 = members.iter().zip(signs).map(|(member, sign)| raw(&rig, *member) * i128::from(sign)).sum();
                let exact = (sum * i128::from(numerator)).div_euclid(denominator.into());
                prop_assert_eq!(raw(&rig, Leader::AxisCommand(X)), exact);
                rig.run(1);
            }
        }
    }
}

/// y moves before x, although it is after it in the file; line is a member through a sum of its own.
#[test]
fn what_moves_in_the_same_cycle_has_no_lag() {
    let masters = vec![
        master("sum", &[Leader::AxisCommand(Y), Leader::Sum(1)], &[]),
        master("inner", &[Leader::AxisCommand(LINE)], &[]),
    ];
    let mut rig = enabled(cell(masters));
    rig.give(Action::Synchronize(couple(Y, Leader::AxisCommand(LINE), 1, 1)));
    rig.give(Action::Synchronize(couple(X, SUM, 1, 1)));
    rig.give(Action::Move(to(LINE, 20_000)));
    for _ in 0..400 {
        rig.run(1);
        let (line, y) = (raw(&rig, Leader::AxisCommand(LINE)), raw(&rig, Leader::AxisCommand(Y)));
        assert_eq!((y, raw(&rig, Leader::AxisCommand(X))), (line, 2 * line));
        assert_eq!(rig.int("sum.position"), ((2 * line) >> 32) as i64);
    }
    let velocity = rig.real("y.command.velocity") + rig.real("line.command.velocity");
    assert!(velocity > 9e4);
    assert_eq!(rig.real("sum.velocity"), velocity);
}

/// With a sink in a sum, the axis that its slot reads moves first, and the axis that it moves can be after it.
#[test]
fn loops_are_refused_through_sums_and_sinks() {
    let (command, sink) = (Leader::AxisCommand, Leader::Sink(0));
    let sums = || {
        vec![
            master("sum", &[BELT], &[command(Y)]),
            master("outer", &[SUM], &[]),
            master("by_sink", &[sink], &[]),
            master("inputs", &[Leader::AxisActual(Y), BELT], &[]),
        ]
    };
    let slot = copying(command(X), SinkConfig::Axis(LINE));
    let cell = |masters| MachineConfig { slots: vec![slot.clone()], ..cell(masters) };
    let mut rig = enabled(cell(sums()));
    let mut refused = |axis: u16, leader| {
        let given = rig.give(Action::Synchronize(couple(axis, leader, 1, 1)));
        rig.refusal(given)
    };
    for leader in [SUM, Leader::Sum(1)] {
        assert_eq!(refused(Y, leader), "y: the axis would follow itself");
    }
    // The slot reads x.
    assert_eq!(refused(X, Leader::Sum(2)), "x: the axis would follow itself");
    let last = rig.give_all(vec![
        Action::Synchronize(couple(X, Leader::Sum(1), 1, 1)),
        Action::Synchronize(couple(Y, Leader::Sum(2), 1, 1)),
        Action::Synchronize(couple(Y, Leader::Sum(3), 1, 1)),
    ]);
    assert!(rig.was_accepted(last - 2));
    assert_eq!(rig.refusal(last - 1), "y: the axis would follow itself");
    assert!(rig.was_accepted(last), "following an input makes no loop");

    // A function that would move an axis that it reads through a sum.
    let masters = vec![master("sum", &[BELT, command(X)], &[])];
    let slots = vec![copying(SUM, SinkConfig::Axis(X))];
    let mut rig = enabled(MachineConfig { slots, ..super::sums::cell(masters) });
    let given = rig.give(start(0));
    assert_eq!(rig.refusal(given), "x: the axis would follow itself");

    // Selectors that may couple at any time.
    for (of_x, of_y, is_good) in [
        (SUM, command(X), false),
        (Leader::Sum(1), command(X), false),
        (Leader::Sum(3), command(X), true),
        (command(LINE), Leader::Sum(2), true),
        (command(Y), Leader::Sum(2), false),
    ] {
        let mut cell = cell(sums());
        cell.axes[usize::from(X)].vocabularies.amc.master = Some(of_x);
        cell.axes[usize::from(Y)].vocabularies.amc.master = Some(of_y);
        let found = Machine::new(cell).err();
        assert_eq!(matches!(found, Some(ConfigError::MasterLoop { .. })), !is_good, "{of_x:?}, {of_y:?}");
        assert_eq!(found.is_none(), is_good);
    }
}

/// In the cycle in which the encoder or the drive gives no value, also if the member is subtracted.
#[test]
fn a_member_that_is_lost_stops_the_follower_in_its_cycle() {
    for by_drive in [false, true] {
        let mut rig = sum_of(&[Leader::AxisCommand(LINE)], &[BELT, Leader::AxisActual(Y)]);
        rig.give(Action::Synchronize(couple(X, SUM, 1, 1)));
        rig.give(Action::Move(at(LINE, 20_000.0)));
        rig.run(100);
        assert_eq!((rig.state("x"), rig.int("sum.valid")), ("SYNCHRONIZED_MOTION", 1));
        if by_drive {
            rig.plant.drive(1).unwrap().disconnect();
        } else {
            rig.modify_inputs = |inputs| inputs.encoder[0].valid = false;
        }
        rig.run(1);
        assert_eq!((rig.state("x"), rig.int("x.error")), ("ERROR_STOP", i64::from(Code::LEADER_LOST.0)));
        assert_eq!(rig.int("sum.valid"), 0);
        rig.give(Action::ResetErrors(AxisSet::one(X)));
        rig.run(1);
        let again = rig.give(Action::Synchronize(couple(X, SUM, 1, 1)));
        assert!(rig.refusal(again).contains("lost"), "{}", rig.refusal(again));
    }
}

/// Two changes, each within the limit of a follower, but not their sum.
#[test]
fn a_jump_of_the_sum_is_one_of_the_leader() {
    let mut config = cell(vec![master("sum", &[BELT], &[Leader::Encoder(1)])]);
    let mut encoder = config.encoders[0].clone();
    encoder.form = Form::Incremental(64);
    config.encoders = vec![encoder.clone(), crate::config::EncoderConfig { name: "other".into(), ..encoder }];
    for (by, state) in [(1 << 30, "SYNCHRONIZED_MOTION"), ((1 << 30) + 1, "ERROR_STOP")] {
        let mut rig = enabled(config.clone());
        rig.give(Action::Synchronize(couple(X, SUM, 1, 1 << 20)));
        rig.plant.jump_encoder(0, by);
        rig.plant.jump_encoder(1, -by);
        rig.run(1);
        let code = if state == "ERROR_STOP" { Code::ENCODER_JUMP } else { Code::NONE };
        assert_eq!((rig.state("x"), rig.int("x.error")), (state, i64::from(code.0)));
        assert_eq!(rig.int("sum.position"), 2 * by);
    }
}

/// An added member, a subtracted one, and a sink that starts again at another value: x is at rest, its shown master
/// position is unchanged, and both continue from there.
#[test]
fn a_new_zero_of_a_member_is_no_motion() {
    let masters = vec![master("sum", &[Leader::AxisCommand(LINE), Leader::Sink(0)], &[Leader::AxisActual(Y)])];
    let slots = vec![copying(BELT, SinkConfig::None)];
    let mut rig = enabled(MachineConfig { slots, ..cell(masters) });
    rig.plant.jump_encoder(0, 70);
    rig.give(Action::Synchronize(couple(X, SUM, 1, 1)));
    rig.give_all(vec![Action::Move(to(LINE, 3_000)), Action::Move(to(Y, 1_000))]);
    rig.run(1_000);
    rig.mirror();
    let stands = |rig: &Rig, of_sum: i64| {
        assert_eq!((rig.int("x.command.position"), rig.real("x.master.position")), (2_000, 2_000.0));
        assert_eq!((rig.int("x.sync.error"), rig.int("sum.position")), (0, of_sum));
    };
    stands(&rig, 2_000);
    for (action, of_sum) in [(origin(LINE, -7), -1_007), (origin(Y, 400), -407), (start(0), -337)] {
        let given = rig.give(action);
        assert!(rig.was_accepted(given));
        rig.run(3);
        stands(&rig, of_sum);
    }
    rig.plant.jump_encoder(0, 5);
    rig.give(Action::Move(to(Y, 390)));
    rig.run(300);
    assert_eq!((rig.int("x.command.position"), rig.real("x.master.position")), (2_015, 2_015.0));
    assert_eq!(rig.int("sum.position"), -322);
    // The value that x shows of it may be set: it belongs to x.
    let position = MasterPosition::Increments(Length::whole(11));
    rig.give(Action::SetMasterPosition(SetMasterPosition { axis: X, position }));
    assert_eq!((rig.real("x.master.position"), rig.int("sum.position")), (11.0, -322));
}

/// When line is inverted, it is at -3000: the value that x shows does not change.
#[test]
fn a_member_that_is_turned_over_is_no_motion() {
    let mut rig = sum_of(&[BELT], &[Leader::AxisActual(Y)]);
    rig.give(Action::Synchronize(couple(X, SUM, 1, 1)));
    rig.give(Action::Move(to(Y, 3_000)));
    rig.run(1_000);
    let row = Row::find("posdrct").unwrap().0;
    rig.give(Action::Disable(AxisSet::one(Y)));
    rig.run(50);
    let turned = rig.give(Action::SetParameters([Change { axis: Y, row, value: Value::Int(-1) }].into()));
    assert!(rig.was_accepted(turned));
    rig.run(3);
    assert_eq!((rig.int("y.actual.position"), rig.int("sum.position")), (-3_000, 3_000));
    assert_eq!((rig.int("x.command.position"), rig.real("x.master.position")), (-3_000, -3_000.0));
}

/// A slot reads the present values of encoders, and the commands of the last cycle, as it does for each alone.
#[test]
fn a_function_reads_a_sum() {
    let masters = vec![master("sum", &[BELT], &[Leader::AxisCommand(LINE)])];
    let slots = vec![copying(SUM, SinkConfig::Memory(0))];
    let memory = vec![MemoryConfig { name: "m".into(), kind: MemoryKind::I64, initial: 0.0 }];
    let mut rig = enabled(MachineConfig { slots, memory, ..cell(masters) });
    rig.give(Action::Move(at(LINE, 20_000.0)));
    rig.give(start(0));
    for _ in 0..200 {
        let before = raw(&rig, Leader::AxisCommand(LINE));
        rig.plant.jump_encoder(0, 3);
        rig.run(1);
        let seen = (raw(&rig, BELT) - before) >> 32;
        assert_eq!((i128::from(rig.int("m")), rig.int("f.error")), (seen, 0));
    }
    rig.modify_inputs = |inputs| inputs.encoder[0].valid = false;
    rig.run(2);
    assert!(!rig.machine.state.leads.get(Leader::Sink(0)).valid);
}

#[test]
fn a_state_of_other_sums_is_one_of_another_cell() {
    let rig = sum_of(&[BELT], &[]);
    let image = postcard::to_allocvec(rig.machine.state()).unwrap();
    let restored = |add: &[Leader], subtract: &[Leader]| {
        let state = postcard::from_bytes(&image).unwrap();
        Machine::restore(cell(vec![master("sum", add, subtract)]), state).err()
    };
    assert_eq!(restored(&[BELT], &[]), None);
    assert_eq!(restored(&[], &[BELT]), Some(StateError::Leads));
}
