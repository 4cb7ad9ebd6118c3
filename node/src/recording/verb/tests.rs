//! Tests the exact texts of commands, refusals, and the round trip of all actions that interfaces create.

mod law;
mod wf;

use super::*;
use crate::cell::Cell;
use lineshaft_core::command::{
    AbortTrigger, BufferMode, CamIn, CommandFunction, DisengageAt, Engage, GearOut, HomeAxis, HomingMethod, Level,
    MasterPosition, MemoryValue, Move, MoveMode, OutAn, OutputValue, Probe, ProbeEdge, QueryTrajectory, RunFunction,
    SetEncoderPosition, SetMasterPosition, SetPosition, Setpoint, ShiftPosition, Synchronize as Coupling, TouchProbe,
};
use lineshaft_core::function::Order;
use lineshaft_core::machine::Machine;
use lineshaft_core::modulo::Direction;
use lineshaft_core::object::{AxisSet, Leader, Object};
use lineshaft_core::parameter::{Change, Row, Value as Set};
use lineshaft_core::position::{Length, Position};
use lineshaft_core::request::{Amount, PhaseRequest};
use lineshaft_core::sync::gear::Ratio;
use lineshaft_core::sync::{CamStart, Disengage, SyncMode};
use lineshaft_core::unit::Quantity;

/// Scales that are simple (x, turret), that have no exact decimal (odd), and that have the finest and the coarsest
/// resolution of a cell.
const CELL: &str = "
lineshaft: 1
cycle: 1 ms
backends: {plant: {type: sim}}
io:
  mark: {type: di, backend: plant, address: 0, latch: true}
  start: {type: di, backend: plant, address: 1}
  lamp: {type: do, backend: plant, address: 0}
  speed: {type: ao, backend: plant, address: 0}
memory:
  feed: {type: i16, initial: 7}
  big: {type: i64, initial: 0}
  gain: {type: f64, initial: 0.5}
  flag: {type: bit, initial: 0}
tables:
  knife: {form: xy, points: [[0, 0], [5000, 1200], [20000, 20000]]}
masters:
  sum: {add: [belt], subtract: [x]}
functions:
  index: {slot: 0, type: epos, acceleration: 1, stop_decel: 1, drive_resolution: 1}
encoders:
  belt: {backend: plant, address: 0, bits: 16, type: linear, scale: {increments: 40, per: 1 mm}}
axes:
  x: {type: linear, unit: mm, scale: {increments: 1000, per: 1 mm}, drive: virtual, max_velocity: 1 m/s,
      max_acceleration: 5 m/s^2}
  turret: {type: rotary, unit: deg, modulo: 360 deg, scale: {increments: 36000, per: 360 deg}, drive: virtual,
      max_velocity: 90 deg/s, max_acceleration: 360 deg/s^2}
  odd: {type: rotary, unit: rad, scale: {increments: 1048573, per: 0.7 rev}, drive: virtual, max_velocity: 1 rad/s,
      max_acceleration: 5 rad/s^2}
  fine: {type: linear, unit: nm, scale: {increments: 999983, per: 1 nm}, drive: virtual, max_velocity: 1 mm/s,
      max_acceleration: 5 mm/s^2}
  coarse: {type: linear, scale: {increments: 1, per: 299792458 m}, drive: virtual, max_velocity: 1e9 m/s,
      max_acceleration: 1e9 m/s^2}
";

/// A cell and the signals of its machine.
struct Desk {
    config: MachineConfig,
    directory: Directory,
}

impl Desk {
    fn new() -> Self {
        let cell = Cell::parse("cell.yaml", CELL).unwrap_or_else(|problems| panic!("{problems}"));
        let machine = Machine::new(cell.machine.clone()).unwrap();
        Self { directory: machine.directory().clone(), config: cell.machine }
    }

    fn write(&self, action: &Action) -> String {
        to_json(&Command { sequence: 17, source: Source::Ros, action: action.clone() }, &self.config)
    }

    fn read(&self, json: &str) -> Result<Action, String> {
        from_json(json, &self.config, &self.directory)
    }

    /// Checks that the command with number 17 has that text, and that the text is read as that action.
    #[track_caller]
    fn is(&self, action: &Action, json: &str) {
        assert_eq!(self.write(action), json);
        assert_eq!(self.read(json).as_ref(), Ok(action));
    }
}

fn to(axis: u16, target: Length) -> Move {
    Move {
        axis,
        mode: MoveMode::Absolute,
        target,
        velocity: 0.0,
        acceleration: 0.0,
        deceleration: 0.0,
        jerk: 0.0,
        direction: Direction::Shortest,
        buffer_mode: BufferMode::Aborting,
    }
}

fn set(axis: u16, key: &str, value: Set) -> Change {
    Change { axis, row: Row::find(key).unwrap().0, value }
}

#[test]
fn orders_and_goals_of_functions_name_their_fields() {
    let desk = Desk::new();
    let values = |values: &[(u16, i64)]| values.into();
    let order = CommandFunction { slot: 0, order: Order::ValueNew, values: values(&[(2, -5)]) };
    let text = r#"{"command_function":{"function":"index","command":"value_new","parameters":{"travel":-5}}}"#;
    desk.is(&Action::CommandFunction(order), text);
    let goal = RunFunction { slot: 0, values: values(&[]) };
    desk.is(&Action::RunFunction(goal), r#"{"run_function":{"id":"17","function":"index"}}"#);
    let goal = RunFunction { slot: 0, values: values(&[(2, i64::MIN), (0, 8)]) };
    let text = r#"{"run_function":{"id":"17","function":"index","parameters":{"travel":-9223372036854775808,"ba":8}}}"#;
    desk.is(&Action::RunFunction(goal), text);
    let nobody = desk.read(r#"{"run_function":{"id":"17","function":"dial"}}"#).expect_err("no such function");
    assert!(nobody.contains("no function is called `dial`"), "{nobody}");
}

#[test]
fn moves_are_written_in_increments_without_what_is_default() {
    let desk = Desk::new();
    let all = Move {
        mode: MoveMode::Relative,
        velocity: 500.25,
        acceleration: 1e-7,
        deceleration: 2e5,
        jerk: 1e20,
        direction: Direction::Current,
        buffer_mode: BufferMode::Aborting,
        ..to(1, Length { nearest: 12345, rest: Position::from_f64(0.25) })
    };
    desk.is(
        &Action::Move(all),
        r#"{"move_axis":{"id":"17","axis":"turret","mode":"relative","position":"12345.25 inc","velocity":"500.25 inc/s","acceleration":"1e-7 inc/s^2","deceleration":"200000 inc/s^2","jerk":"1e20 inc/s^3","direction":"current"}}"#,
    );
    desk.is(
        &Action::Move(to(0, Length::default())),
        r#"{"move_axis":{"id":"17","axis":"x","mode":"absolute","position":"0 inc"}}"#,
    );
    let run = Move { mode: MoveMode::Velocity, ..to(0, Length::default()) };
    desk.is(&Action::Move(run), r#"{"move_axis":{"id":"17","axis":"x","mode":"velocity","velocity":"0 inc/s"}}"#);
}

#[test]
fn position_is_written_with_ten_decimals_and_read_in_units_of_2_32() {
    let desk = Desk::new();
    let half = 1_i128 << 31;
    for (nearest, rest, text) in [
        (3, -half, "2.5"),
        (-3, half, "-2.5"),
        (3, half - 1, "3.4999999998"),
        (0, half - 1, "0.4999999998"),
        (0, 1 - half, "-0.4999999998"),
        (7, 1, "7.0000000002"),
        (7, -1, "6.9999999998"),
        ((1 << 62) - 1, half - 1, "4611686018427387903.4999999998"),
        (1 - (1 << 62), 1 - half, "-4611686018427387903.4999999998"),
    ] {
        let target = Length { nearest, rest: Position::from_raw(rest) };
        let json = format!(r#"{{"move_axis":{{"id":"17","axis":"x","mode":"absolute","position":"{text} inc"}}}}"#);
        desk.is(&Action::Move(to(0, target)), &json);
    }
}

fn search(source: Object) -> Probe {
    Probe {
        axis: 0,
        relative: false,
        target: Length::whole(9),
        velocity: 0.0,
        acceleration: 0.0,
        deceleration: 0.0,
        jerk: 0.0,
        source,
        edge: ProbeEdge::Rising,
        distance: Length::default(),
    }
}

#[test]
fn probes_name_what_latches() {
    let desk = Desk::new();
    desk.is(
        &Action::Probe(search(Object::Io(0))),
        r#"{"probe_axis":{"id":"17","axis":"x","mode":"absolute","position":"9 inc","event":"mark","distance":"0 inc"}}"#,
    );
    let full = Probe {
        relative: true,
        velocity: 0.5,
        jerk: 3.0,
        edge: ProbeEdge::Both,
        distance: Length { nearest: -7, rest: Position::from_f64(0.25) },
        ..search(Object::Encoder(0))
    };
    desk.is(
        &Action::Probe(full),
        r#"{"probe_axis":{"id":"17","axis":"x","mode":"relative","position":"9 inc","velocity":"0.5 inc/s","jerk":"3 inc/s^3","event":"belt","edge":"both","distance":"-6.75 inc"}}"#,
    );
}

#[test]
fn touch_probes_name_what_latches_and_their_window() {
    let desk = Desk::new();
    let once = TouchProbe { axis: 1, source: Object::Io(0), edge: ProbeEdge::Rising, continuous: false, window: None };
    desk.is(&Action::TouchProbe(once), r#"{"touch_probe":{"axis":"turret","event":"mark"}}"#);
    let window = Some([Length::default(), Length { nearest: -7, rest: Position::from_f64(0.25) }]);
    let full = TouchProbe { axis: 0, source: Object::Encoder(0), edge: ProbeEdge::Both, continuous: true, window };
    desk.is(
        &Action::TouchProbe(full),
        r#"{"touch_probe":{"axis":"x","event":"belt","edge":"both","continuous":true,"first_position":"0 inc","last_position":"-6.75 inc"}}"#,
    );
    let none = AbortTrigger { axis: 0, source: None };
    desk.is(&Action::AbortTrigger(none), r#"{"abort_trigger":{"axis":"x"}}"#);
    let of_mark = AbortTrigger { source: Some(Object::Io(0)), ..none };
    desk.is(&Action::AbortTrigger(of_mark), r#"{"abort_trigger":{"axis":"x","event":"mark"}}"#);
    let query = QueryTrajectory { axis: 0, at_ns: 1_000_000_007 };
    desk.is(&Action::QueryTrajectory(query), r#"{"query_trajectory":{"axis":"x","time":"1000000007 ns"}}"#);
}

/// Returns a coupling to x, in mode position.
fn coupling(axis: u16) -> Coupling {
    Coupling {
        axis,
        leader: Some(Leader::AxisCommand(0)),
        mode: SyncMode::Position,
        engage: Engage::Immediately,
        disengage: Disengage::Stop,
        numerator: 0,
        denominator: 0,
        offset: Length::default(),
        velocity: 0.0,
        acceleration: 0.0,
        cam: None,
    }
}

#[test]
fn couplings_name_their_leader() {
    let desk = Desk::new();
    let coupling = coupling(1);
    let head = r#"{"synchronize":{"id":"17","axis":"turret","master":"#;
    desk.is(&Action::Synchronize(coupling), &format!(r#"{head}"x","mode":"position"}}}}"#));
    let full = Coupling {
        leader: Some(Leader::Encoder(0)),
        mode: SyncMode::Velocity,
        disengage: Disengage::KeepVelocity,
        numerator: i64::MIN,
        denominator: i64::MAX,
        offset: Length::whole(-4),
        velocity: 0.1,
        acceleration: 3.0,
        ..coupling
    };
    desk.is(
        &Action::Synchronize(full),
        &format!(
            r#"{head}"belt","mode":"velocity","disengage":"keep_velocity","numerator":-9223372036854775808,"denominator":9223372036854775807,"offset":"-4 inc","velocity":"0.1 inc/s","acceleration":"3 inc/s^2"}}}}"#
        ),
    );
    let actual = Coupling { leader: Some(Leader::AxisActual(0)), ..coupling };
    let sum = Coupling { leader: Some(Leader::Sum(0)), ..coupling };
    desk.is(&Action::Synchronize(sum), &format!(r#"{head}"sum","mode":"position"}}}}"#));
    let of_machine = Coupling { leader: Some(Leader::Virtual), ..coupling };
    desk.is(&Action::Synchronize(of_machine), &format!(r#"{head}"machine.vmaster","mode":"position"}}}}"#));
    let by_parameter = Coupling { leader: None, ..coupling };
    desk.is(&Action::Synchronize(by_parameter), r#"{"synchronize":{"id":"17","axis":"turret","mode":"position"}}"#);
    desk.is(&Action::Synchronize(actual), &format!(r#"{head}"x.actual","mode":"position"}}}}"#));
}

#[test]
fn cams_name_their_table() {
    let desk = Desk::new();
    let plain = CamIn {
        table: 0,
        start: CamStart::Absolute,
        master_scale: Ratio::ONE,
        slave_scale: Ratio::ONE,
        master_offset: Length::default(),
        slave_offset: Length::default(),
    };
    let on = |cam| Action::Synchronize(Coupling { leader: Some(Leader::Encoder(0)), cam: Some(cam), ..coupling(0) });
    let head = r#"{"synchronize":{"id":"17","axis":"x","master":"belt","mode":"cam","table":"knife","cam_start":"#;
    desk.is(&on(plain), &format!(r#"{head}"absolute"}}}}"#));
    let full = CamIn {
        start: CamStart::RampIn,
        master_scale: Ratio::new(-1, 20).unwrap(),
        slave_scale: Ratio::new(7, 3).unwrap(),
        master_offset: Length::whole(40),
        slave_offset: Length::whole(-5),
        ..plain
    };
    let fields = r#""master_scale":"-1/20","slave_scale":"7/3","master_offset":"40 inc","slave_offset":"-5 inc""#;
    desk.is(&on(full), &format!(r#"{head}"ramp_in",{fields}}}}}"#));
    let waits = |axis, leader, engage| {
        Action::Synchronize(Coupling { leader: Some(leader), cam: Some(plain), engage, ..coupling(axis) })
    };
    let head =
        |axis, master| format!(r#"{{"synchronize":{{"id":"17","axis":"{axis}","master":"{master}","mode":"cam","#);
    let fields = r#""table":"knife","cam_start":"absolute"}}"#;
    let turn = desk.config.axes[1].modulo;
    let at = |position| Engage::AtPosition { position, turn };
    let end = waits(0, Leader::Encoder(0), Engage::AtEnd);
    desk.is(&end, &format!(r#"{}"engage":"at_end",{fields}"#, head("x", "belt")));
    let place = waits(0, Leader::AxisCommand(1), at(-9_000));
    let written = format!(r#"{}"engage":"at_position","master_increments":-9000,{fields}"#, head("x", "turret"));
    desk.is(&place, &written);
    let zero = waits(0, Leader::AxisActual(1), at(0));
    desk.is(&zero, &format!(r#"{}"engage":"at_position",{fields}"#, head("x", "turret.actual")));
    let latch = waits(0, Leader::AxisCommand(1), Engage::OnEvent(Object::Encoder(0)));
    desk.is(&latch, &format!(r#"{}"engage":"on_event","event":"belt",{fields}"#, head("x", "turret")));
    let gear = |engage| {
        Action::Synchronize(Coupling {
            leader: Some(Leader::AxisCommand(1)),
            engage,
            numerator: 3,
            denominator: 1,
            ..coupling(0)
        })
    };
    let head = r#"{"synchronize":{"id":"17","axis":"x","master":"turret","mode":"position","#;
    let pair = Engage::InPosition { position: -9_000, turn, slave: 40, distance: 2_000 };
    let places = r#""master_increments":-9000,"slave_increments":40,"start_distance_increments":2000"#;
    desk.is(&gear(pair), &format!(r#"{head}"engage":"at_position",{places},"numerator":3,"denominator":1}}}}"#));
    let latch = gear(Engage::OnEvent(Object::Io(0)));
    desk.is(&latch, &format!(r#"{head}"engage":"on_event","event":"mark","numerator":3,"denominator":1}}}}"#));
}

/// The shift of the master is written as given, because its increments depend on the leader.
#[test]
fn phase_shifts_of_slave_and_master() {
    let desk = Desk::new();
    let of = |side, amounts: [Amount; 3]| {
        let [shift, velocity, acceleration] = amounts;
        let request = PhaseRequest { axis: "turret".into(), side, shift, velocity, acceleration };
        Action::Phase(desk.config.resolve_phase(&request).unwrap())
    };
    let number = Amount::Number;
    let slave = of(0, [number(-std::f64::consts::PI), number(0.0), number(0.0)]);
    desk.is(&slave, r#"{"phase":{"id":"17","axis":"turret","side":"slave","shift":"-18000 inc"}}"#);
    let degrees =
        |text, order| Amount::Quantity(Quantity::parse(text, &desk.config.axes[1].scale.dimensions(order)).unwrap());
    let master = of(1, [degrees("0.1 deg", 0), degrees("2 inc/s", 1), number(1e-3)]);
    let fields = r#""shift":"0.1 deg","velocity":"2 inc/s","acceleration":0.001"#;
    desk.is(&master, &format!(r#"{{"phase":{{"id":"17","axis":"turret","side":"master",{fields}}}}}"#));
}

#[test]
fn the_end_of_a_coupling_names_its_place() {
    let desk = Desk::new();
    let out = |at, disengage| Action::GearOut(GearOut { axis: 1, at, disengage });
    let head = r#"{"gear_out":{"axis":"turret","at":"#;
    desk.is(&out(DisengageAt::Now, Some(Disengage::Stop)), &format!(r#"{head}"now"}}}}"#));
    let kept = out(DisengageAt::Leader(-9_000), Some(Disengage::KeepVelocity));
    let fields = r#""master_position","increments":-9000,"disengage":"keep_velocity""#;
    desk.is(&kept, &format!("{head}{fields}}}}}"));
    let fields = r#""position","disengage":"as_goal""#;
    desk.is(&out(DisengageAt::Axis(0), None), &format!("{head}{fields}}}}}"));
}

#[test]
fn a_value_for_the_lower_loops_names_its_level() {
    let desk = Desk::new();
    let of = |value, level| Action::OutAn(OutAn { axis: 1, value, level });
    desk.is(&of(0.125, Level::Setpoint), r#"{"out_an":{"axis":"turret","value":0.125}}"#);
    desk.is(&of(-1.0, Level::Effort), r#"{"out_an":{"axis":"turret","value":-1.0,"level":"effort"}}"#);
}

#[test]
fn the_other_verbs_word_for_word() {
    let desk = Desk::new();
    let two: AxisSet = [1, 0].into_iter().collect();
    for (action, verb) in [
        (Action::Enable(two), "enable"),
        (Action::Disable(two), "disable"),
        (Action::Halt(two), "halt"),
        (Action::QuickStop(two), "quick_stop"),
        (Action::ResetErrors(two), "reset_errors"),
    ] {
        desk.is(&action, &format!(r#"{{"{verb}":{{"axes":["x","turret"]}}}}"#));
    }
    desk.is(&Action::Abort, r#"{"abort":{}}"#);
    for (method, text) in [
        (HomingMethod::Configured, ""),
        (HomingMethod::Cia402(-128), r#","scheme":"cia402","method":-128"#),
        (HomingMethod::Cia402(0), r#","scheme":"cia402","method":0"#),
        (HomingMethod::Macs(3), r#","scheme":"macs","method":3"#),
    ] {
        let homing = Action::HomeAxis(HomeAxis { axis: 1, method });
        desk.is(&homing, &format!(r#"{{"home_axis":{{"id":"17","axis":"turret"{text}}}}}"#));
    }
    let quarter = Length { nearest: -7, rest: Position::from_f64(0.25) };
    for (position, text) in [(Length::whole(1 << 61), "2305843009213693952"), (quarter, "-6.75")] {
        let zero = Action::SetPosition(SetPosition { axis: 0, position });
        desk.is(&zero, &format!(r#"{{"set_position":{{"axis":"x","position":"{text} inc"}}}}"#));
    }
    let zero = Action::ShiftPosition(ShiftPosition { axis: 1, distance: quarter });
    desk.is(&zero, r#"{"set_position":{"axis":"turret","relative":true,"position":"-6.75 inc"}}"#);
    let zero = Action::SetEncoderPosition(SetEncoderPosition { encoder: 0, position: quarter });
    desk.is(&zero, r#"{"set_position":{"axis":"belt","position":"-6.75 inc"}}"#);
    for (position, text) in [
        (MasterPosition::Increments(Length::whole(5)), r#""position":"5 inc""#),
        (MasterPosition::Shown(-5.5), r#""units":"axis_unit","position":-5.5"#),
        (MasterPosition::Shown(0.125), r#""units":"axis_unit","position":0.125"#),
    ] {
        let zero = Action::SetMasterPosition(SetMasterPosition { axis: 1, position });
        desk.is(&zero, &format!(r#"{{"set_position":{{"axis":"turret.master",{text}}}}}"#));
    }
    desk.is(&Action::Cancel { goal: 17 }, r#"{"cancel":{"id":"17"}}"#);
    desk.is(&Action::Cancel { goal: u64::MAX }, r#"{"cancel":{"id":"18446744073709551615"}}"#);
    let changes = [
        set(0, "max_velocity", Set::Real(800_000.5)),
        set(1, "min_position", Set::Int(-7)),
        set(0, "profile", Set::Int(0)),
        set(0, "in_position_time", Set::Int(20_000_000)),
        set(0, "max_jerk", Set::Unset),
        set(0, "max_position", Set::Unset),
        set(0, "error_reaction", Set::Int(3)),
    ];
    desk.is(
        &Action::SetParameters(changes.into()),
        r#"{"set_parameters":{"x.max_velocity":"800000.5 inc/s","turret.min_position":"-7 inc","x.profile":"trapezoid","x.in_position_time":"20000000 ns","x.max_jerk":null,"x.max_position":null,"x.error_reaction":3}}"#,
    );
    for (index, value, text) in [
        (0, 5.0, r#""feed":5"#),
        (0, -32_768.0, r#""feed":-32768"#),
        (1, 9_223_372_036_854_774_784.0, r#""big":9223372036854774784"#),
        (1, -9_223_372_036_854_775_808.0, r#""big":-9223372036854775808"#),
        (2, 5.0, r#""gain":5.0"#),
        (2, -0.0, r#""gain":-0.0"#),
        (2, 5e-324, r#""gain":5e-324"#),
        (3, 1.0, r#""flag":1"#),
    ] {
        desk.is(&Action::set_memory(index, value), &format!(r#"{{"set_memory":{{{text}}}}}"#));
    }
    let both = [(2, -0.5), (0, 7.0)].map(|(index, value)| MemoryValue { index, value });
    desk.is(&Action::SetMemory(both.into()), r#"{"set_memory":{"gain":-0.5,"feed":7}}"#);
    for (index, value, text) in
        [(2, 1.0, r#""lamp":1"#), (2, 0.0, r#""lamp":0"#), (3, -2.5, r#""speed":-2.5"#), (3, -0.0, r#""speed":-0.0"#)]
    {
        desk.is(&Action::set_output(index, value), &format!(r#"{{"set_output":{{{text}}}}}"#));
    }
    let both = [(3, 0.5), (2, 1.0)].map(|(index, value)| OutputValue { index, value });
    desk.is(&Action::SetOutputs(both.into()), r#"{"set_output":{"speed":0.5,"lamp":1}}"#);
    desk.is(&Action::Note { code: Code::RECORD_FAILED, number: 28 }, r#"{"note":{"code":10217,"number":28}}"#);
    desk.is(
        &Action::Note { code: Code::CLOCK_STEPPED, number: -1_767_225_600_123_456_789 },
        r#"{"note":{"code":10372,"number":-1767225600123456789}}"#,
    );
    desk.is(&Action::Note { code: Code::RECORD_LOST, number: -1 }, r#"{"note":{"code":10216,"number":-1}}"#);
    desk.is(
        &Action::Refuse("say \"no\"\n\\ \u{7f}\u{2028}\u{feff}é𝄞".into()),
        r#"{"refuse":{"text":"say \"no\"\n\\ \u007f\u2028\ufeffé𝄞"}}"#,
    );
    desk.is(&Action::Refuse("".into()), r#"{"refuse":{"text":""}}"#);
}

#[test]
fn a_scenario_takes_the_texts_but_for_the_two_that_are_no_verbs() {
    let cell = Cell::parse("cell.yaml", CELL).unwrap();
    let read = |verb: &str| {
        let text = format!(
            "{{scenario: s, cycles: 9, steps: [{{at: 0, do: {{move_axis: {{id: 17, axis: x, position: 0}}}}}}, {{at: 1, do: {verb}}}]}}"
        );
        crate::scenario::Scenario::parse("s", &text, &cell).map(drop).map_err(|problems| problems.to_string())
    };
    // An ID is a text, with or without quotes.
    assert_eq!(read(r#"{"cancel":{"id":"17"}}"#), Ok(()));
    assert_eq!(read("{cancel: {id: 17}}"), Ok(()));
    assert_eq!(read(r#"{"set_parameters":{"x.max_jerk":null}}"#), Ok(()));
    assert!(read(r#"{"cancel":{"id":"18"}}"#).unwrap_err().contains("no command has the id `18`"));
    assert!(read(r#"{"refuse":{"text":"no"}}"#).unwrap_err().contains("there is no verb `refuse`"));
    assert!(read(r#"{"note":{"code":10216,"number":1}}"#).unwrap_err().contains("there is no verb `note`"));
}

#[test]
fn what_is_wrong_is_one_sentence() {
    let desk = Desk::new();
    for (json, sentence) in [
        ("", "the command has 0 verbs; one is expected"),
        ("{}", "the command has 0 verbs; one is expected"),
        ("[]", "the command is a list; a mapping is expected"),
        ("\"halt\"", "the command is `halt`; a mapping is expected"),
        ("{\"halt\":", "this is not YAML: "),
        (r#"{"jump":{}}"#, "there is no verb `jump`, known are enable, "),
        (r#"{"home_axis":{"id":"17"}}"#, "missing key `axis` in home_axis"),
        (r#"{"home_axis":{"id":"h","axis":"x"}}"#, "id is `h`; the sequence number of a command is expected"),
        (r#"{"home_axis":{"id":"17","axis":"x","scheme":3}}"#, "scheme is 3; 0 CONFIGURED, 1 CIA402, 2 MACS are"),
        (r#"{"home_axis":{"id":"17","axis":"x","method":128}}"#, "method is 128; -128..127 is allowed"),
        (r#"{"set_position":{"axis":"q"}}"#, "no axis is called `q`"),
        (r#"{"set_position":{"axis":"x","position":"1 s"}}"#, "position: `1 s` is a time"),
        (r#"{"load_table":{}}"#, "missing key `points` in load_table"),
        (r#"{"halt":{"axes":["?"]}}"#, "no axis is called `?`; there are x, turret, odd, fine, coarse"),
        (r#"{"halt":{"axes":[]},"enable":{}}"#, "the command has 2 verbs; one is expected"),
        (r#"{"move_axis":{"id":"17","axis":"q"}}"#, "no axis is called `q`"),
        (r#"{"probe_axis":{"id":"17","axis":"x"}}"#, "missing key `event` in probe_axis"),
        (r#"{"probe_axis":{"id":"17","axis":"x","event":"start"}}"#, "`start` does not latch; mark, belt can"),
        (r#"{"probe_axis":{"id":"17","axis":"x","event":"mark","mode":4}}"#, "mode is 4; 0 ABSOLUTE, 1 RELATIVE are"),
        (r#"{"probe_axis":{"id":"17","axis":"x","event":"mark","edge":4}}"#, "edge is 4; 0 RISING, 1 FALLING, 2 BOTH"),
        (r#"{"probe_axis":{"id":"17","axis":"x","event":"mark","distance":"1 s"}}"#, "distance: `1 s` is a time"),
        (r#"{"touch_probe":{"axis":"x"}}"#, "missing key `event` in touch_probe"),
        (r#"{"touch_probe":{"axis":"x","event":"start"}}"#, "`start` does not latch; mark, belt can"),
        (r#"{"touch_probe":{"axis":"x","event":"mark","first_position":"1 s"}}"#, "first_position: `1 s` is a time"),
        (r#"{"abort_trigger":{"axis":"x","event":"start"}}"#, "`start` does not latch; mark, belt can"),
        (r#"{"set_position":{"axis":"belt","relative":true}}"#, "no axis is called `belt`"),
        (r#"{"move_axis":{"id":"m","axis":"x"}}"#, "id is `m`; the sequence number of a command is expected"),
        (r#"{"cancel":{"id":"-1"}}"#, "id is `-1`; the sequence number of a command is expected"),
        (r#"{"cancel":{"id":"18446744073709551616"}}"#, "id is `18446744073709551616`; the sequence number"),
        (r#"{"cancel":{}}"#, "missing key `id` in cancel"),
        (r#"{"set_memory":{}}"#, "set_memory is empty; `cell: value` is expected"),
        (r#"{"set_memory":{"gain":null}}"#, "gain has no value; a number is expected"),
        (
            r#"{"set_memory":{"big":9007199254740993}}"#,
            "big is 9007199254740993; beyond +-2^53 only what an f64 holds can be set, the nearest is 9007199254740992",
        ),
        // The nearest f64 is 2^63, which exceeds the memory cell.
        (
            r#"{"set_memory":{"big":9223372036854775807}}"#,
            "big is 9223372036854775807; beyond +-2^53 only what an f64 holds can be set",
        ),
        (r#"{"set_memory":{"big":9223372036854775808}}"#, "big is 9223372036854775808; -9223372036854775808..92"),
        (r#"{"set_memory":{"feed":40000}}"#, "feed is 40000; -32768..32767 is allowed"),
        (
            r#"{"set_parameters":{"x.max_velocity":null}}"#,
            "x.max_velocity is `null`; a velocity such as 0.5 m/s is expected",
        ),
        (r#"{"set_parameters":{"x.profile":null}}"#, "x.profile is `null`; one of trapezoid, s_ramp, jerk is expected"),
        (r#"{"set_parameters":{"x.?":"1 inc/s"}}"#, "no parameter is called `x.?`"),
        (r#"{"inject":{"input":{"feed":1}}}"#, "feed is no input"),
        (r#"{"inject":{"drive_lost":{"axis":"x"}}}"#, "x is virtual: it has no drive"),
        (r#"{"refuse":{}}"#, "missing key `text` in refuse"),
        (r#"{"refuse":{"text":["a"]}}"#, "text is a list; a text is expected"),
        (r#"{"note":{"code":10001,"number":1}}"#, "code is 10001; notes are 10216, 10217, 10218, 10370, 10371, 10372"),
        (r#"{"note":{"code":10216}}"#, "missing key `number` in note"),
        (r#"{"note":{"code":-1,"number":1.5}}"#, "code is -1; 0..4294967295 is allowed"),
    ] {
        let told = desk.read(json).expect_err(json);
        assert!(told.starts_with(sentence), "{json}: {told}");
        assert!(!told.contains('\n'), "{json}: {told}");
    }
    let deep = "[".repeat(100_000);
    assert_eq!(desk.read(&deep).unwrap_err(), "lists and mappings are nested deeper than 64 levels");
    let wide = format!("{{\"halt\":{{\"axes\":[{}\"x\"]}}}}", "\"x\",".repeat(4_100_000));
    assert_eq!(desk.read(&wide).unwrap_err(), "the file has more than 4000000 values");
}

#[test]
fn an_injection_is_no_command() {
    let cell = CELL.replace(
        "drive: virtual, max_velocity: 1 m/s",
        "drive: {backend: plant, address: 0, interface: position}, max_velocity: 1 m/s",
    );
    let cell = Cell::parse("cell.yaml", cell).unwrap();
    let machine = Machine::new(cell.machine.clone()).unwrap();
    let told = from_json(r#"{"inject":{"drive_lost":{"axis":"x"}}}"#, &cell.machine, machine.directory());
    assert_eq!(told.unwrap_err(), "inject is no command of the machine");
}

#[test]
fn what_no_door_makes_is_written_so_that_it_does_not_read_back() {
    let desk = Desk::new();
    for action in [
        Action::Halt(AxisSet::EMPTY),
        Action::Halt(AxisSet::one(400)),
        Action::Move(to(9, Length::default())),
        Action::Probe(search(Object::Machine)),
        Action::Probe(search(Object::Memory(0))),
        Action::Probe(search(Object::Io(1))),
        Action::Probe(search(Object::Io(99))),
        Action::Probe(search(Object::Axis(0))),
        Action::AbortTrigger(AbortTrigger { axis: 0, source: Some(Object::Machine) }),
        Action::set_memory(99, 1.0),
        Action::set_memory(2, f64::NAN),
        Action::set_memory(2, f64::INFINITY),
        Action::set_memory(0, 0.5),
        Action::set_memory(0, 32_768.0),
        Action::set_memory(1, 9_223_372_036_854_775_808.0),
        Action::set_memory(3, 2.0),
        Action::SetMemory([].into()),
        Action::SetMemory([MemoryValue { index: 2, value: 1.0 }; 2].into()),
        Action::SetOutputs([].into()),
        Action::SetOutputs([OutputValue { index: 2, value: 1.0 }; 2].into()),
        Action::set_output(99, 1.0),
        Action::set_output(0, 1.0),
        Action::set_output(2, 0.5),
        Action::set_output(3, f64::NAN),
        Action::SetParameters([Change { axis: 0, row: 999, value: Set::Int(1) }].into()),
        Action::SetParameters([Change { axis: 9, row: 0, value: Set::Int(1) }].into()),
        Action::SetParameters([set(0, "max_velocity", Set::Real(f64::NAN))].into()),
        Action::Note { code: Code::NONE, number: 1 },
    ] {
        let json = desk.write(&action);
        assert!(desk.read(&json).is_err(), "{json}");
    }
}

#[test]
fn a_saia_verb_is_written_with_its_registers_and_flags_in_one_order() {
    use lineshaft_core::vocabulary::saia::{Command as Flag, Register, Request};
    let desk = Desk::new();
    let request =
        Request { axis: 1, commands: [Flag::Start, Flag::LoadDestination].into_iter().collect(), ..Request::default() };
    let request = request.with(Register::McFac, Set::Real(1.33333)).with(Register::Mcw, Set::Int(0x41B));
    let request = request.with(Register::KProp, Set::Int(-7));
    desk.is(
        &Action::vocabulary(request),
        r#"{"saia":{"axis":"turret","set":{"kprop":-7,"mcfac":1.33333,"mcw":1051},"commands":["fldda","fstart"]}}"#,
    );
    desk.is(&Action::vocabulary(Request::default()), r#"{"saia":{"axis":"x"}}"#);
}

#[test]
fn trajectory_points_are_written_by_axis_and_missing_values_are_none() {
    use lineshaft_core::trajectory::{Knot, OnExcess, Tolerance, Track, Trajectory, TrajectoryLimits};
    let knot = |position, velocity| Knot { position, velocity, acceleration: None };
    let none = Tolerance::default();
    let path = Tolerance { position: Some(1000.0), ..none };
    let goal = Tolerance { position: Some(0.1), velocity: Some(2.5), acceleration: Some(3e20) };
    let quarter = Position::whole(-1) + Position::from_f64(0.25);
    let x = Track {
        axis: 0,
        knots: Box::new([knot(quarter, Some(7.5)), knot(Position::whole(9), None)]),
        path,
        ..Track::default()
    };
    let odd = Track {
        axis: 2,
        knots: Box::new([knot(Position::ZERO, Some(0.0)), knot(Position::whole(1), None)]),
        goal,
        start: Some(4.0),
        ..Track::default()
    };
    let run = Trajectory::new(-5, Box::new([10, 20]), Box::new([odd, x]), Some(30)).expect("a sound one");
    let limits = TrajectoryLimits { margin: 0.01, on_excess: OnExcess::Refuse, max_stretch: 2.0 };
    let run = run.within(limits).ended_after(Some(40));
    Desk::new().is(
        &Action::Trajectory(run.into()),
        r#"{"follow_joint_trajectory":{"id":"17","joints":["odd","x"],"start":"-5 ns","points":[{"time":"10 ns","positions":["0 inc","-0.75 inc"],"velocities":["0 inc/s","7.5 inc/s"]},{"time":"20 ns","positions":["1 inc","9 inc"]}],"path_tolerance":{"x":{"position":"1000 inc"}},"goal_tolerance":{"odd":{"position":"0.1 inc","velocity":"2.5 inc/s","acceleration":"3e20 inc/s^2"}},"goal_time":"30 ns","start_tolerance":{"odd":{"position":"4 inc"}},"trajectory_limits":{"margin":0.01,"on_excess":"refuse","max_stretch":2.0},"max_duration":"40 ns"}}"#,
    );
}

/// A trajectory that no interface creates cannot be read back: one axis has a velocity, the other has none.
#[test]
fn a_trajectory_with_gaps_is_refused() {
    use lineshaft_core::trajectory::{Knot, Track, Trajectory};
    let track = |axis, velocity| Track {
        axis,
        knots: Box::new([Knot { position: Position::ZERO, velocity, acceleration: None }]),
        ..Track::default()
    };
    let run = Trajectory::new(0, Box::new([10]), Box::new([track(0, None), track(1, Some(0.0))]), None).expect("sound");
    let desk = Desk::new();
    assert!(desk.read(&desk.write(&Action::Trajectory(run.into()))).is_err());
}

/// The longest trajectory exceeds the size limit of a file, and can still be read back.
#[test]
fn the_longest_trajectory_reads_back() {
    use lineshaft_core::trajectory::{Knot, MAX_KNOTS, Track, Trajectory};
    let position = Position::whole((1 << 61) + 1) + Position::from_f64(1.0 / 3.0);
    let rate = Some(-1.2345678901234567e-10);
    let mut knots = vec![Knot { position, velocity: rate, acceleration: rate }; MAX_KNOTS];
    knots[MAX_KNOTS - 1] = Knot { position: Position::whole(1 << 61), velocity: Some(0.0), acceleration: rate };
    let times = (0..MAX_KNOTS as u64).map(|place| (1 << 60) + place).collect();
    let track = Track { axis: 4, knots: knots.into(), ..Track::default() };
    let run = Action::Trajectory(Trajectory::new(0, times, Box::new([track]), None).expect("a sound one").into());
    let desk = Desk::new();
    let json = desk.write(&run);
    assert!(json.len() > crate::document::MAX_BYTES, "{} bytes", json.len());
    assert!(desk.read(&json).as_ref() == Ok(&run));
}

fn stream(axes: [Option<(f64, Option<u64>)>; 5]) -> Setpoints {
    let axes = axes.map(|axis| axis.map(|(velocity, duration)| Setpoint { velocity, duration })).to_vec();
    Setpoints { source: Source::Ros, axes }
}

#[test]
fn setpoints_are_one_verb_by_axis_in_increments() {
    let desk = Desk::new();
    let read = |json: &str| applied_from_json(json, Source::Ros, &desk.config, &desk.directory);
    for (set, json) in [
        (stream([Some((-12.5, None)), None, None, None, None]), r#"{"setpoints":{"axes":{"x":"-12.5 inc/s"}}}"#),
        (
            stream([Some((0.0, None)), None, Some((1e20, Some(250_000_000))), None, None]),
            r#"{"setpoints":{"axes":{"x":"0 inc/s","odd":{"velocity":"1e20 inc/s","duration":"250000000 ns"}}}}"#,
        ),
    ] {
        assert_eq!(setpoints_to_json(&set, &desk.config), json);
        assert_eq!(read(json), Ok(Applied::Stream(set)));
        assert_eq!(desk.read(json), Err("setpoints are no command".to_owned()));
    }
    for (json, sentence) in [
        (r#"{"setpoints":{"axes":{"w":"1 inc/s"}}}"#, "no axis is called `w`"),
        (r#"{"setpoints":{"axes":{}}}"#, "no axis is named"),
        (r#"{"setpoints":{}}"#, "axes"),
        (r#"{"setpoints":{"axes":{"x":"1 inc"}}}"#, "velocity of x"),
        (r#"{"setpoints":{"axes":{"x":{"velocity":"1 inc/s","duration":"-1 ns"}}}}"#, "duration"),
        (r#"{"setpoints":{"axes":{"x":{"duration":"1 ns"}}}}"#, "velocity"),
        (r#"{"setpoints":{"axes":{"x":"1 inc/s"},"speed":1}}"#, "speed"),
    ] {
        let refused = read(json).unwrap_err();
        assert!(refused.contains(sentence), "{json}: {refused}");
    }
}
