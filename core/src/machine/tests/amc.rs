//! Reference selector on an axis: cases that no scenario covers.

use super::rig::{LINE, Rig, X, Y, at, config, couple, to};
use crate::code::Code;
use crate::command::{Action, Move};
use crate::config::{ConfigError, IoConfig, IoKind, MachineConfig, TableConfig};
use crate::drive::{Backend, Edge, EncoderInput, Latch};
use crate::event::Kind;
use crate::machine::Machine;
use crate::modulo::Modulo;
use crate::object::{AxisSet, Leader, Object};
use crate::parameter::{Change, Row, Value};
use crate::table::{Form, Table};
use crate::text::message;
use crate::vocabulary::amc::Wiring;
use std::sync::Arc;

mod any;

const MARK: Object = Object::Io(0);

/// One revolution of x is 360 inc, and x follows the belt; y has two limits and follows the line.
fn wired() -> MachineConfig {
    let mut config = config(0);
    config.io = vec![IoConfig { name: "mark".into(), kind: IoKind::DigitalInput, latch: true }];
    let (x, y) = (usize::from(X), usize::from(Y));
    config.axes[x].modulo = Modulo::new(360, 1);
    let cam = Some(0);
    config.axes[x].vocabularies.amc = Wiring { master: Some(Leader::Encoder(0)), freeze: Some(MARK), cam };
    config.axes[y].vocabularies.amc = Wiring { master: Some(Leader::AxisCommand(LINE)), freeze: Some(MARK), cam };
    config.tables = vec![TableConfig { name: "cam".into(), table: Arc::new(cam_table()) }];
    config.axes[y].parameters.min_position = Some(-20_000);
    config.axes[y].parameters.max_position = Some(50_000);
    config
}

/// Slopes of 2, 0 and -1, over 400 inc of the master: 100 inc in a period.
fn cam_table() -> Table {
    Table::new(Form::Xy, &[0, 100, 300, 400], &[0, 200, 200, 100]).expect("points")
}

fn enabled(config: MachineConfig) -> Rig {
    let mut rig = Rig::of(config);
    rig.enable();
    rig
}

fn changes(axis: u16, values: &[(&str, i64)]) -> Action {
    let change = |&(key, value): &(&str, i64)| {
        let key = format!("amc.{key}");
        let (row, entry) = Row::find(&key).expect("a key of the catalogue");
        let value = if entry.default == Value::Real(0.0) { Value::Real(value as f64) } else { Value::Int(value) };
        Change { axis, row, value }
    };
    Action::SetParameters(values.iter().map(change).collect())
}

fn set(rig: &mut Rig, axis: u16, values: &[(&str, i64)]) -> u64 {
    rig.give(changes(axis, values))
}

fn latch(object: Object, age_ns: u32, position: Option<i64>) -> Latch {
    Latch { object, edge: Edge::Rising, age_ns: Some(age_ns), position }
}

fn warnings(rig: &Rig) -> Vec<String> {
    let told = rig.events.iter().filter(|event| event.kind == Kind::Warning);
    told.map(|event| message(event, rig.machine.config())).collect()
}

/// A master runs the whole cycle before its follower, at any place in the file, and through a chain.
#[test]
fn a_selector_follows_its_master_without_delay_whatever_the_order_of_the_file() {
    let mut config = config(0);
    config.axes[usize::from(X)].vocabularies.amc.master = Some(Leader::AxisCommand(Y));
    let mut rig = enabled(config);
    rig.give(Action::Synchronize(couple(Y, Leader::AxisCommand(LINE), 1, 1)));
    set(&mut rig, X, &[("reference_select", 4)]);
    rig.give(Action::Move(to(LINE, 20_000)));
    for _ in 0..400 {
        rig.run(1);
        assert_eq!(rig.int("x.command.position"), rig.int("line.command.position"));
    }
    assert_eq!(rig.int("x.in_sync"), 1);
}

#[test]
fn masters_that_close_a_loop_are_refused() {
    let mut looped = config(0);
    looped.axes[usize::from(X)].vocabularies.amc.master = Some(Leader::AxisCommand(Y));
    let mut good = looped.clone();
    looped.axes[usize::from(Y)].vocabularies.amc.master = Some(Leader::AxisCommand(X));
    let error = Machine::new(looped).unwrap_err();
    assert!(matches!(error, ConfigError::MasterLoop { .. }));
    assert_eq!(error.to_string(), "x: its reference selector would follow itself, directly or through others");
    // The actual position is an input, so it closes no loop.
    good.axes[usize::from(Y)].vocabularies.amc.master = Some(Leader::AxisActual(X));
    let mut rig = enabled(good);
    let closes = rig.give(Action::Synchronize(couple(Y, Leader::AxisCommand(X), 1, 1)));
    assert_eq!(rig.refusal(closes), "y: the axis would follow itself");
    let through = rig.give_all(vec![
        Action::Synchronize(couple(LINE, Leader::AxisCommand(X), 1, 1)),
        Action::Synchronize(couple(Y, Leader::AxisCommand(LINE), 1, 1)),
    ]);
    assert!(rig.was_accepted(through - 1));
    assert_eq!(rig.refusal(through), "y: the axis would follow itself");
}

/// The device captured 12 while the belt is at 20 in this cycle: 8 inc have passed, independent of the age.
///
/// Proves: AMC-EVT-05, AMC-EVT-07
#[test]
fn a_captured_position_of_the_master_is_the_freeze_point() {
    let mut config = wired();
    config.axes[usize::from(X)].vocabularies.amc.freeze = Some(Object::Encoder(0));
    let mut rig = enabled(config);
    set(&mut rig, X, &[("action_on_event", 2)]);
    rig.plant.jump_encoder(0, 20);
    rig.plant.add_latch(latch(Object::Encoder(0), 1, Some(12)));
    rig.run(1);
    assert_eq!((rig.int("x.amc.select"), rig.int("x.amc.profile_input_position")), (4, 8));
    rig.run(20);
    assert_eq!((rig.int("x.command.position"), rig.int("x.in_sync")), (8, 1));
}

/// 20 inc in the cycle of 1 ms: 0.4 ms ago the master was 8 inc back, 0.1 ms ago 2 inc. The first edge counts.
///
/// Proves: AMC-EVT-01, AMC-EVT-05
#[test]
fn of_two_edges_in_a_sample_the_first_one_is_the_event() {
    let mut rig = enabled(wired());
    set(&mut rig, X, &[("action_on_event", 2)]);
    rig.plant.jump_encoder(0, 20);
    rig.plant.add_latch(latch(MARK, 100_000, None));
    rig.plant.add_latch(latch(MARK, 400_000, None));
    rig.run(1);
    assert_eq!(rig.int("x.amc.profile_input_position"), 8);
}

/// The cam starts 150 inc after point 1: the master runs 50 inc at slope 0 and 60 inc at slope -1; then selector 7
/// holds the target (M09).
///
/// Proves: AMC-SEL-03, AMC-FSM-07, AMC-EVT-04
#[test]
fn reference_3_is_the_cam_from_its_start_index_and_position_on() {
    let mut rig = enabled(wired());
    rig.plant.jump_encoder(0, 777);
    rig.run(1);
    let told = set(&mut rig, X, &[("cam_start_index", 1), ("cam_start_position", 150), ("reference_select", 3)]);
    rig.run(1);
    assert!(rig.was_accepted(told));
    assert_eq!((rig.int("x.reference"), rig.int("x.amc.select"), rig.state("x")), (3, 3, "SYNCHRONIZED_MOTION"));
    // 250 + 50 + 30 + 30 = 360: 40 inc more are -100, up to the end of the period, then 20 inc at slope 2.
    for (step, wanted) in [(50, 0), (30, -30), (30, -60), (60, -60)] {
        rig.plant.jump_encoder(0, step);
        rig.run(100);
        assert_eq!(rig.int("x.command.position"), wanted, "{step}");
    }
    set(&mut rig, X, &[("reference_select", 7)]);
    rig.plant.jump_encoder(0, 30);
    rig.run(100);
    assert_eq!((rig.int("x.command.position"), rig.int("x.amc.select")), (-60, 7));
}

/// 20 inc in the cycle of 1 ms, 0.4 ms ago: 8 inc of the master count, 16 of the slave. A second edge does not start
/// again (M12).
///
/// Proves: AMC-SEL-08, AMC-EVT-02, AMC-EVT-05
#[test]
fn event_action_1_starts_the_cam_at_the_freeze_point() {
    let mut rig = enabled(wired());
    set(&mut rig, X, &[("action_on_event", 1)]);
    rig.plant.jump_encoder(0, 20);
    rig.plant.add_latch(latch(MARK, 400_000, None));
    rig.run(1);
    assert_eq!((rig.int("x.amc.select"), rig.int("x.amc.profile_input_position")), (3, 16));
    assert_eq!(rig.machine.parameters(X).unwrap().vocabularies.amc.reference_select, 3);
    rig.run(20);
    rig.plant.jump_encoder(0, 10);
    rig.plant.add_latch(latch(MARK, 0, None));
    rig.run(20);
    assert_eq!((rig.int("x.command.position"), rig.int("x.in_sync")), (36, 1));
}

#[test]
fn a_cam_that_cannot_start_is_refused_and_changes_nothing() {
    let mut rig = enabled(wired());
    let refused = set(&mut rig, X, &[("cam_start_index", 2), ("cam_start_position", 100), ("reference_select", 3)]);
    rig.run(1);
    assert_eq!(rig.refusal(refused), "cam: its start is at 400; 0 up to 400, its end, is possible");
    assert_eq!(rig.machine.parameters(X).unwrap().vocabularies.amc.reference_select, 0);
    let words = Table::new(Form::Words, &[], &[1]).unwrap();
    let mut config = wired();
    config.tables[0].table = Arc::new(words);
    let mut rig = enabled(config);
    let refused = set(&mut rig, X, &[("reference_select", 3)]);
    rig.run(1);
    assert_eq!(rig.refusal(refused), "cam: words of a data block are no cam; form y and form xy are");
}

/// Direct write and event in one sample: the event takes precedence, and so does its freeze point.
///
/// Proves: AMC-SEL-09
#[test]
fn event_takes_precedence_over_write_and_trigger() {
    let mut rig = enabled(wired());
    set(&mut rig, X, &[("action_on_event", 2)]);
    rig.plant.add_latch(latch(MARK, 0, None));
    set(&mut rig, X, &[("reference_select", 1), ("reference_select_trigger", 6), ("position_reference", 90)]);
    assert_eq!(rig.int("x.amc.select"), 4);
    rig.run(5);
    assert_eq!((rig.int("x.amc.select"), rig.int("x.command.position")), (4, 0));
}

#[test]
fn an_event_of_an_axis_that_is_off_counts_for_nothing() {
    let mut rig = Rig::of(wired());
    set(&mut rig, X, &[("action_on_event", 2)]);
    rig.plant.add_latch(latch(MARK, 0, None));
    rig.run(1);
    rig.enable();
    assert_eq!((rig.int("x.amc.select"), rig.machine.parameters(X).unwrap().vocabularies.amc.reference_select), (0, 0));
}

/// The master is lost when the event occurs: this is reported, and the present reference remains in force.
#[test]
fn a_lost_master_is_refused_and_changes_nothing() {
    let mut rig = enabled(wired());
    set(&mut rig, X, &[("action_on_event", 2), ("position_reference", 50), ("reference_select", 1)]);
    rig.run(100);
    let (mut inputs, mut outputs) = (rig.machine.inputs(), rig.machine.outputs());
    rig.plant.add_latch(latch(MARK, 0, None));
    inputs.begin(0, 0);
    rig.plant.read(&mut inputs);
    inputs.encoder[0] = EncoderInput { count: 0, epoch: 0, valid: false, index: None };
    rig.machine.cycle(&inputs, Default::default(), &mut outputs);
    rig.plant.write(&outputs);
    rig.events.extend_from_slice(rig.machine.events());
    assert_eq!(warnings(&rig), ["x: what the axis follows is lost"]);
    assert_eq!((rig.int("x.amc.select"), rig.int("x.amc.profile_input_position")), (1, 50));
    assert_eq!(rig.machine.parameters(X).unwrap().vocabularies.amc.reference_select, 1);
    let command = crate::command::Command {
        sequence: 900,
        source: crate::command::Source::Scenario,
        action: changes(X, &[("reference_select", 4)]),
    };
    inputs.begin(0, 0);
    rig.plant.read(&mut inputs);
    inputs.encoder[0] = EncoderInput { count: 0, epoch: 0, valid: false, index: None };
    rig.machine.cycle(&inputs, crate::command::Commands::queue(&[command]), &mut outputs);
    rig.events.extend_from_slice(rig.machine.events());
    assert_eq!(rig.refusal(900), "x: what the axis follows is lost");
}

/// 100 units of travel, then enable: by then the target exceeds the limit.
///
/// Proves: AMC-SEL-08
#[test]
fn selection_that_cannot_start_at_enable_is_reported_and_reset() {
    let mut rig = Rig::of(wired());
    let kept = set(&mut rig, Y, &[("reference_select", 1), ("position_reference", 50_001)]);
    assert!(rig.was_accepted(kept), "off, nothing is judged yet");
    let version = rig.machine.parameter_version();
    rig.enable();
    assert_eq!(warnings(&rig), ["y: target 50.001 mm exceeds max_position 50 mm"]);
    assert_eq!((rig.int("y.amc.select"), rig.int("y.command.position")), (0, 0));
    assert_eq!(rig.machine.parameters(Y).unwrap().vocabularies.amc.reference_select, 0);
    assert!(rig.machine.parameter_version() > version, "who shows parameters has to see it");
}

/// 2147483647 / 1000 inc per unit: R = 360 inc is 0.36 units, which leaves 5 965 232 353 revolutions; with one
/// increment per unit it is 5 965 232.
///
/// Proves: AMC-ROT-04
#[test]
fn the_integrators_of_input_and_output_never_differ_by_more_than_they_hold() {
    let mut config = wired();
    let per = crate::unit::Quantity::new(crate::unit::Fraction::from_integer(1), crate::unit::Unit::MILLIMETRE);
    let scale = crate::unit::Scale::new(crate::unit::Fraction::from_integer(1), per).unwrap();
    config.axes[usize::from(X)].scale = scale.with_unit(crate::unit::Unit::MILLIMETRE).unwrap();
    let mut rig = enabled(config);
    let most = 5_965_232 * 360;
    set(&mut rig, X, &[("rotary_mode", 6), ("position_reference", most), ("reference_select", 6)]);
    assert_eq!(rig.int("x.amc.profile_input_turns"), 5_965_232);
    let static_limit = set(&mut rig, X, &[("position_reference", most + 1)]);
    assert!(rig.refusal(static_limit).contains("further than the 5965232 turns"));
    // One further revolution in addition to the remaining travel.
    let further = set(&mut rig, X, &[("position_reference", 360)]);
    assert!(rig.refusal(further).contains("amc.position_reference 360 mm leads further than the 5965232 turns"));
    assert_eq!(rig.machine.parameters(X).unwrap().vocabularies.amc.position_reference, most);
    assert_eq!(rig.int("x.amc.profile_input_turns"), 5_965_232);
}

#[test]
fn positions_beyond_2_to_the_62_are_refused() {
    let mut config = wired();
    config.axes[usize::from(X)].modulo = None;
    let mut rig = enabled(config);
    let most = (1 << 62) - 1;
    set(&mut rig, X, &[("position_reference", most), ("reference_select", 6)]);
    rig.run(3);
    set(&mut rig, X, &[("reference_select", 7)]);
    let beyond = set(&mut rig, X, &[("reference_select", 6)]);
    assert!(rig.refusal(beyond).contains("is outside +-2^62 increments"), "{}", rig.refusal(beyond));
    let least = set(&mut rig, X, &[("reference_select", 1), ("position_reference", -most)]);
    assert!(rig.was_accepted(least));
    assert_eq!(rig.int("x.target.position"), -most);
    let wide = set(&mut rig, X, &[("position_reference", i64::MIN)]);
    assert!(rig.refusal(wide).contains("is allowed"));
}

/// With a sampling time of 250 us a change is added unmodified, in every mode.
///
/// Proves: AMC-ROT-01
#[test]
fn fast_samples_have_no_rotary_modes() {
    for (cycle_ns, end) in [(250_000, 10), (500_000, 370)] {
        let mut config = wired();
        config.cycle_ns = cycle_ns;
        let mut rig = Rig::of(config);
        rig.give(Action::Enable(AxisSet::first(3)));
        rig.run(200);
        set(&mut rig, X, &[("rotary_mode", 1), ("position_reference", 350), ("reference_select", 1)]);
        rig.run(2000);
        assert_eq!(rig.int("x.command.position"), 350);
        set(&mut rig, X, &[("position_reference", 10)]);
        rig.run(2000);
        assert_eq!(rig.int("x.command.position"), end, "{cycle_ns} ns");
    }
}

/// At 40 inc per cycle and 0.5 inc per cycle^2 a stop takes 80 cycles and 1600 inc: the profile passes the boundary and
/// returns, while PIP stays within its revolution.
///
/// Proves: AMC-ROT-19, AMC-ROT-13
#[test]
fn mode_3_entered_at_speed_may_pass_a_boundary_that_pip_does_not() {
    let mut rig = enabled(wired());
    set(&mut rig, X, &[("speed_reference", 40_000), ("reference_select", 2), ("rotary_mode", 3)]);
    rig.run_until("x.in_velocity", 1);
    let turn = rig.int("x.turns");
    set(&mut rig, X, &[("position_reference", 300), ("reference_select", 1)]);
    let inputs = rig.int("x.amc.profile_input_turns");
    assert!(inputs == turn || inputs == turn + 1, "the turn of the sample in which it was selected");
    let mut furthest = 0;
    for _ in 0..1000 {
        rig.run(1);
        furthest = furthest.max(rig.int("x.turns"));
        assert_eq!((rig.int("x.amc.profile_input_turns"), rig.int("x.amc.profile_input_position")), (inputs, 300));
    }
    assert!(furthest > inputs, "it could not stop before the boundary");
    assert_eq!((rig.int("x.turns"), rig.int("x.modulo.position")), (inputs, 300));
}

/// The target moves in every cycle: the axis follows it with a lag of at most the stopping time of its profile.
///
/// Proves: AMC-POS-01
#[test]
fn a_reference_that_moves_in_every_sample_is_followed_within_the_limits() {
    let mut config = wired();
    config.axes[usize::from(X)].modulo = None;
    let mut rig = enabled(config);
    set(&mut rig, X, &[("reference_select", 1)]);
    let mut before = 0.0;
    for k in 1..=500_i64 {
        set(&mut rig, X, &[("position_reference", 20 * k)]);
        let velocity = rig.real("x.command.velocity");
        assert!((velocity - before).abs() <= 1_001.0 && velocity <= 100_000.0, "1000 inc/s in a cycle at most");
        before = velocity;
        assert_eq!(rig.int("x.amc.profile_input_position"), 20 * k);
    }
    let late = 10_000 - rig.int("x.command.position");
    // v^2 / (2 d) at 20 000 inc/s and 1 000 000 inc/s^2 is 200 inc, plus the travel of one cycle.
    assert!((0..=220).contains(&late), "{late} inc behind");
    rig.run_until("x.state", 1);
    assert_eq!(rig.int("x.command.position"), 10_000);
}

/// Proves: AMC-POS-04, AMC-SEL-07
#[test]
fn holding_after_a_speed_or_a_goal_stays_where_the_profile_was() {
    let mut rig = enabled(wired());
    set(&mut rig, Y, &[("speed_reference", 10_000), ("reference_select", 2)]);
    rig.run(200);
    let now = rig.int("y.command.position");
    set(&mut rig, Y, &[("reference_select", 7)]);
    let target = rig.int("y.target.position");
    assert!((now..=now + 11).contains(&target), "the place of that sample: {target} after {now}");
    rig.run_until("y.state", 1);
    assert_eq!(rig.int("y.command.position"), target);
    rig.give(Action::Move(Move { velocity: 1_000.0, ..to(Y, 0) }));
    rig.run(50);
    let hold = set(&mut rig, Y, &[("reference_select", 7)]);
    assert!(rig.was_accepted(hold));
    assert_eq!(rig.int("y.amc.active"), 1);
    rig.run_until("y.state", 1);
    assert_eq!(rig.int("y.command.position"), rig.int("y.amc.profile_input_position"));
}

/// Every error that locks the axis ends the reference in its cycle: a following error, also that of another axis that
/// stops all axes.
#[test]
fn error_ends_the_reference_in_its_cycle() {
    let mut config = wired();
    config.axes[usize::from(X)].parameters.supervision.following_error_stops_all = 1;
    let mut rig = enabled(config);
    for axis in [X, Y] {
        set(&mut rig, axis, &[("reference_select", 2)]);
    }
    rig.run(10);
    rig.plant.drive(0).unwrap().jump(-5_000);
    rig.run_until("x.state", 7);
    for (axis, name) in [(X, "x"), (Y, "y")] {
        assert_eq!((rig.state(name), rig.int(&format!("{name}.amc.select"))), ("ERROR_STOP", 0));
        assert_eq!(rig.machine.parameters(axis).unwrap().vocabularies.amc.reference_select, 0, "{name}");
    }
}

/// The gear stops without a profile, and `synchronize` takes the axis over.
#[test]
fn gear_stops_at_once_and_coupling_replaces_it() {
    let mut rig = enabled(wired());
    rig.give(Action::Move(at(LINE, 20_000.0)));
    set(&mut rig, Y, &[("stop_mode", 1), ("reference_select", 4)]);
    rig.run(500);
    assert_eq!(rig.int("y.in_sync"), 1);
    let actual = rig.int("y.actual.position");
    set(&mut rig, Y, &[("reference_select", 0)]);
    assert_eq!(rig.int("y.command.position"), actual + 20, "where the slave is in that sample");
    assert_eq!((rig.int("y.amc.stop_reference"), rig.real("y.command.velocity")), (actual + 20, 0.0));
    rig.run(2);
    assert_eq!(rig.state("y"), "STANDSTILL");
    set(&mut rig, Y, &[("reference_select", 4)]);
    rig.give(Action::Synchronize(couple(Y, Leader::AxisCommand(LINE), 1, 2)));
    assert_eq!((rig.int("y.amc.select"), rig.int("y.amc.active"), rig.state("y")), (0, 0, "SYNCHRONIZED_MOTION"));
}

/// While the axis decelerates 3000 inc before the limit, a tenth of the deceleration would lead it beyond the limit.
#[test]
fn a_target_that_the_profile_cannot_reach_leaves_the_old_one_in_force() {
    let mut rig = enabled(wired());
    set(&mut rig, Y, &[("position_reference", 50_000), ("reference_select", 1)]);
    while rig.int("y.command.position") < 47_000 {
        rig.run(1);
    }
    let (row, _) = Row::find("max_acceleration").unwrap();
    rig.give(Action::SetParameters(Box::new([Change { axis: Y, row, value: Value::Real(1e5) }])));
    set(&mut rig, Y, &[("position_reference", 49_000)]);
    let told = warnings(&rig);
    assert!(told.len() == 1 && told[0].contains("beyond max_position, on its way"), "{told:?}");
    assert_eq!((rig.int("y.amc.profile_input_position"), rig.int("y.target.position")), (50_000, 50_000));
    rig.run_until("y.state", 1);
    assert_eq!((rig.int("y.command.position"), rig.int("y.amc.select")), (50_000, 1));
    // The rejected change is reported once, and the next change applies.
    assert_eq!(warnings(&rig).len(), 1);
    set(&mut rig, Y, &[("position_reference", 48_000)]);
    rig.run_until("y.state", 1);
    assert_eq!(rig.int("y.command.position"), 48_000);
}

/// For any speed and start position, the axis stops at the limit, in time and without an error.
///
/// Proves: AMC-SEL-09
#[test]
fn a_speed_ends_at_the_software_limit_and_stays_selected() {
    for (speed, start) in [(100_000, 0), (50_000, 49_990), (1_000, 30_000), (99_999, -20_000), (300, 49_999)] {
        let mut rig = enabled(wired());
        rig.give(Action::Move(to(Y, start)));
        rig.run_until("y.in_position", 1);
        set(&mut rig, Y, &[("speed_reference", speed), ("reference_select", 2)]);
        for _ in 0..(70_000_000 / speed + 500) {
            rig.run(1);
            assert!(rig.int("y.command.position") <= 50_000 && rig.real("y.command.acceleration").abs() <= 1_000_001.0);
        }
        assert_eq!((rig.int("y.command.position"), rig.int("y.error"), rig.int("y.amc.select")), (50_000, 0, 2));
        set(&mut rig, Y, &[("speed_reference", -speed)]);
        rig.run(100);
        assert!(rig.int("y.command.position") < 50_000, "and away from it");
    }
}

/// A virtual axis is always switched on: its selector acts from the first sample.
#[test]
fn a_selection_of_the_cell_begins_in_cycle_0_on_a_virtual_axis() {
    let mut config = wired();
    let p = &mut config.axes[usize::from(LINE)].parameters.vocabularies.amc;
    (p.reference_select, p.position_reference) = (6, 1_000);
    let mut rig = Rig::of(config);
    rig.run(1);
    assert_eq!((rig.int("line.amc.select"), rig.int("line.target.position")), (6, 1_000));
    rig.run(500);
    assert_eq!(rig.int("line.command.position"), 1_000);
}

#[test]
fn config_with_unknown_selection_is_refused() {
    let mut config = wired();
    config.axes[usize::from(X)].parameters.vocabularies.amc.reference_select = 5;
    let error = Machine::new(config).unwrap_err();
    assert_eq!(error.to_string(), "x: amc.reference_select has a value that the rest of the axis does not allow");
}

#[test]
fn refused_reference_has_its_own_error_code() {
    let mut rig = enabled(wired());
    let sequence = set(&mut rig, X, &[("position_reference", 360)]);
    let refused = rig.events.iter().find(|event| event.command == sequence).unwrap();
    assert_eq!(refused.code, Code::AMC_OUTSIDE_TURN);
    let kept = "x: amc.position_reference 0.36 mm is outside the turn, at most 0.359 mm either way; \
                amc.rotary_mode 4 to 6 takes more";
    assert_eq!(rig.refusal(sequence), kept);
    let narrower = set(&mut rig, X, &[("rotary_mode", 4), ("position_reference", 800)]);
    assert!(rig.was_accepted(narrower));
    let back = set(&mut rig, X, &[("rotary_mode", 0)]);
    assert!(rig.refusal(back).contains("0.8 mm is outside the turn"));
}
