//! Tests the exact texts of commands.

mod coupling;
mod law;
mod refusals;
mod trajectory;
mod wf;

use super::*;
use crate::cell::Cell;
use lineshaft_core::command::{
    AbortTrigger, BufferMode, CommandFunction, Engage, GearOut, HomeAxis, HomingMethod, Level, MasterPosition,
    MemoryValue, Move, MoveMode, OutAn, OutputValue, Probe, ProbeEdge, QueryTrajectory, RunFunction,
    SetEncoderPosition, SetMasterPosition, SetPosition, Setpoint, ShiftPosition, Synchronize as Coupling, TouchProbe,
};
use lineshaft_core::function::Order;
use lineshaft_core::machine::Machine;
use lineshaft_core::modulo::Direction;
use lineshaft_core::object::{AxisSet, Leader, Object};
use lineshaft_core::parameter::{Change, Row, Value as Set};
use lineshaft_core::position::{Length, Position};
use lineshaft_core::request::Amount;
use lineshaft_core::sync::{Disengage, SyncMode};
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
