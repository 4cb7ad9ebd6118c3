use super::*;
use crate::command::{Engage, HomingMethod};
use crate::config::{EncoderConfig, SumConfig, TableConfig};
use crate::parameter::AxisParameters;
use crate::position::{Length, Position};
use crate::sync::gear::Ratio;
use crate::sync::{CamStart, SyncMode};
use crate::table::{Form, Table};
use crate::unit::{Fraction, Quantity, Unit};
use std::sync::Arc;

fn scale(increments: i128, unit: Unit) -> Scale {
    let per = Quantity::new(Fraction::from_integer(1), unit);
    Scale::new(Fraction::from_integer(increments), per).unwrap().with_unit(unit).unwrap()
}

fn config() -> MachineConfig {
    let axis = |name: &str, scale| AxisConfig::new(name.into(), scale, None, AxisParameters::new(1e6, 1e7));
    MachineConfig {
        cycle_ns: 1_000_000,
        encoders: vec![EncoderConfig {
            name: "belt".into(),
            form: crate::encoder::Form::Incremental(16),
            check: None,
            scale: scale(40, Unit::MILLIMETRE),
        }],
        axes: vec![axis("x", scale(1000, Unit::MILLIMETRE)), axis("turret", scale(100, Unit::DEGREE))],
        ..MachineConfig::default()
    }
}

fn to(axis: &str, units: Units, position: f64) -> MoveRequest {
    MoveRequest { axis: axis.into(), units, position: Amount::Number(position), ..MoveRequest::default() }
}

/// Proves: MACS-UNIT-05
#[test]
fn the_same_place_is_the_same_increment_in_every_unit() {
    let config = config();
    let target = |request| config.resolve_move(&request).unwrap().target.nearest;
    assert_eq!(target(to("x", Units::Si, 0.12)), 120_000);
    assert_eq!(target(to("x", Units::AxisUnit, 120.0)), 120_000);
    assert_eq!(target(to("x", Units::Increments, 120_000.0)), 120_000);
    assert_eq!(target(to("x", Units::Increments, -2.5)), -3);
    assert_eq!(target(to("turret", Units::Si, std::f64::consts::PI)), 18_000);
    assert_eq!(target(to("turret", Units::AxisUnit, 180.0)), 18_000);
    let quantity = Quantity::parse("12 cm", &config.axes[0].scale.dimensions(0)).unwrap();
    let request = MoveRequest { position: Amount::Quantity(quantity), ..to("x", Units::Increments, 0.0) };
    assert_eq!(target(request), 120_000);
}

#[test]
fn remainder_of_rounding_is_kept_and_not_rounded_again() {
    let scale = scale(1, Unit::METRE);
    let length = |text: &str| {
        let quantity = Quantity::parse(text, &scale.dimensions(0)).unwrap();
        Amount::Quantity(quantity).length(Units::Si, &scale).unwrap()
    };
    assert_eq!((length("2.5 m").nearest, length("2.5 m").rest), (3, Position::from_f64(-0.5)));
    assert_eq!((length("-2.5 m").nearest, length("-2.5 m").rest), (-3, Position::from_f64(0.5)));
    // Slightly below the half: 2^-32 cannot represent it, so the whole number must be kept.
    let below = length("2.499999999999999 m");
    assert_eq!((below.nearest, below.exact().nearest()), (2, 2));
}

#[test]
fn request_error_contains_allowed_values() {
    let config = config();
    let error = |request| config.resolve_move(&request).unwrap_err().to_string();
    assert_eq!(error(to("z", Units::Si, 0.0)), "no axis is called `z`; there are x, turret");
    assert!(error(to("x", Units::Si, f64::NAN)).starts_with("position: "));
    assert!(error(to("x", Units::Si, 1e300)).starts_with("position: "));
    let bad = |change: fn(&mut MoveRequest)| {
        let mut request = to("x", Units::Si, 0.0);
        change(&mut request);
        error(request)
    };
    assert!(bad(|r| r.mode = 9).starts_with("mode is 9; 0 ABSOLUTE"));
    assert!(bad(|r| r.buffer_mode = 200).starts_with("buffer_mode is 200"));
    assert!(bad(|r| r.direction = 4).starts_with("direction is 4"));
    assert!(bad(|r| r.rates.jerk = Amount::Number(f64::INFINITY)).starts_with("jerk: "));
    assert!(Units::from_number(3).is_err());
}

/// A value that would have no effect is refused; a field at its default is not.
#[test]
fn a_field_without_a_meaning_is_refused() {
    let mut config = config();
    config.axes[1].modulo = crate::modulo::Modulo::new(36_000, 1);
    let moved = |request: MoveRequest| config.resolve_move(&request).map(drop).map_err(|error| error.to_string());
    for direction in 1..=3 {
        let round = |axis| MoveRequest { direction, ..to(axis, Units::Si, 0.1) };
        let sentence = format!("direction is {direction}; 0 SHORTEST is allowed, as the axis has no modulo");
        assert_eq!(moved(round("x")), Err(sentence));
        assert_eq!(moved(round("turret")), Ok(()));
    }
    let at_speed = |position, units| MoveRequest {
        mode: 3,
        rates: Rates::numbers([0.1, 0.0, 0.0, 0.0]),
        ..to("x", units, position)
    };
    assert_eq!(moved(at_speed(0.0, Units::Si)), Ok(()));
    let sentence = "position is `10 mm`; 0 is allowed with mode VELOCITY, which has no target";
    assert_eq!(moved(at_speed(10.0, Units::AxisUnit)), Err(sentence.into()));
    let coupled = |mode, offset| {
        let offset = Amount::Number(offset);
        let request =
            SynchronizeRequest { axis: "x".into(), master: "belt".into(), mode, offset, ..Default::default() };
        config.resolve_synchronize(&request).map(drop).map_err(|error| error.to_string())
    };
    assert_eq!((coupled(0, 0.0), coupled(1, 0.005)), (Ok(()), Ok(())));
    let sentence = "offset is `0.005 m`; 0 is allowed with mode VELOCITY, which keeps no position";
    assert_eq!(coupled(0, 0.005), Err(sentence.into()));
    // Old bags contain such commands, whose fields had no effect in the machine.
    let recorded = MoveRequest { direction: 1, ..at_speed(10.0, Units::AxisUnit) };
    assert!(config.resolve_recorded_move(&recorded).is_ok());
}

/// A method that scheme CONFIGURED would ignore must not cause a motion of another method.
#[test]
fn a_method_of_homing_stands_with_its_scheme() {
    let config = config();
    let home = |scheme, method| {
        let resolved = config.resolve_home(&HomeRequest { axis: "x".into(), scheme, method });
        resolved.map(|home| home.method).map_err(|error| error.to_string())
    };
    assert_eq!(home(0, 0), Ok(HomingMethod::Configured));
    assert_eq!((home(1, 7), home(2, 0)), (Ok(HomingMethod::Cia402(7)), Ok(HomingMethod::Macs(0))));
    let sentence = "method is 7; 0 is allowed with scheme CONFIGURED; CIA402 and MACS take a number";
    assert_eq!(home(0, 7), Err(sentence.into()));
    assert!(home(3, 7).unwrap_err().starts_with("scheme is 3; "));
}

#[test]
fn leaders_are_found_by_their_names() {
    let mut config = config();
    assert!(config.find_leader("sum").is_err());
    let sum = |name: &str| SumConfig { name: name.into(), add: vec![Leader::Encoder(0)], subtract: vec![] };
    config.masters = vec![sum("other"), sum("sum")];
    assert_eq!(config.find_leader("sum"), Ok(Leader::Sum(1)));
    assert_eq!(config.find_leader("x"), Ok(Leader::AxisCommand(0)));
    assert_eq!(config.find_leader("turret.command"), Ok(Leader::AxisCommand(1)));
    assert_eq!(config.find_leader("x.actual"), Ok(Leader::AxisActual(0)));
    assert_eq!(config.find_leader("belt"), Ok(Leader::Encoder(0)));
    assert_eq!(config.find_leader("machine.vmaster"), Ok(Leader::Virtual));
    assert!(config.find_leader("machine.vmaster.position").is_err() && config.find_leader("machine").is_err());
    let error = config.find_leader("x.target").unwrap_err().to_string();
    assert_eq!(
        error,
        "`x.target` cannot lead; x, x.actual, turret, turret.actual, belt, other, sum, machine.vmaster can"
    );
}

#[test]
fn missing_feature_is_refused_by_name() {
    let config = config();
    let couple = SynchronizeRequest { axis: "x".into(), master: "belt".into(), mode: 1, ..Default::default() };
    let error = |request| config.resolve_synchronize(&request).unwrap_err().to_string();
    assert_eq!(config.resolve_synchronize(&couple).map(|found| found.leader), Ok(Some(Leader::Encoder(0))));
    let by_parameter = SynchronizeRequest { master: String::new(), ..couple.clone() };
    assert_eq!(config.resolve_synchronize(&by_parameter).map(|found| found.leader), Ok(None));
    let by_marks = SynchronizeRequest { mode: 2, ..couple.clone() };
    assert_eq!(config.resolve_synchronize(&by_marks).map(|found| found.mode), Ok(SyncMode::Marker));
    let offset = SynchronizeRequest { offset: Amount::Number(0.001), ..by_marks };
    for engage in [1, 2] {
        let waits = SynchronizeRequest { mode: 2, engage, event: "belt".into(), ..couple.clone() };
        assert!(error(waits).contains("in mode MARKER does not exist yet"));
    }
    assert!(error(offset).contains("0 is allowed with mode MARKER, where parameter syncposoffs"));
    assert!(error(SynchronizeRequest { disengage: 7, ..couple }).starts_with("disengage is 7"));
}

/// One of three inputs and outputs latches, `mark`; so do the belt and the turret.
fn with_latches() -> MachineConfig {
    use crate::config::IoConfig;
    let input = |name: &str, kind, latch| IoConfig { name: name.into(), kind, latch };
    let mut config = MachineConfig {
        io: vec![
            input("start", IoKind::DigitalInput, false),
            input("mark", IoKind::DigitalInput, true),
            input("lamp", IoKind::DigitalOutput, true),
        ],
        ..config()
    };
    config.axes[1].drive = Some(crate::drive::Capabilities::all(0));
    config
}

#[test]
fn a_gear_engages_at_a_pair_of_places_or_at_a_latch() {
    let mut config = with_latches();
    config.axes[1].modulo = crate::modulo::Modulo::new(1_001, 2);
    let couple = SynchronizeRequest { axis: "x".into(), master: "turret".into(), mode: 1, ..Default::default() };
    let of = |request: &SynchronizeRequest| {
        config.resolve_synchronize(request).map(|found| found.engage).map_err(|error| error.to_string())
    };
    let at = SynchronizeRequest {
        engage: 1,
        master_increments: -9,
        slave_increments: 7,
        start_distance_increments: 5,
        ..couple.clone()
    };
    let turn = config.axes[1].modulo;
    assert!(turn.is_some());
    assert_eq!(of(&at), Ok(Engage::InPosition { position: -9, turn, slave: 7, distance: 5 }));
    let by_velocity = SynchronizeRequest { mode: 0, slave_increments: 0, start_distance_increments: 0, ..at.clone() };
    assert_eq!(of(&by_velocity), Ok(Engage::AtPosition { position: -9, turn }));
    let refused = |request: SynchronizeRequest| of(&request).expect_err("refused");
    assert_eq!(
        refused(SynchronizeRequest { start_distance_increments: -5, ..at.clone() }),
        "start_distance_increments is -5; 0 to 2147483648 is allowed"
    );
    assert_eq!(
        refused(SynchronizeRequest { start_distance_increments: (1 << 31) + 1, ..at.clone() }),
        "start_distance_increments is 2147483649; 0 to 2147483648 is allowed"
    );
    for (field, request) in [
        ("master_increments", SynchronizeRequest { master_increments: i64::MIN, ..at.clone() }),
        ("slave_increments", SynchronizeRequest { slave_increments: 1 << 62, ..at.clone() }),
    ] {
        assert!(refused(request).starts_with(&format!("{field} is ")), "{field}");
    }
    let none = "0 is allowed with mode VELOCITY, which keeps no position";
    assert_eq!(
        refused(SynchronizeRequest { slave_increments: 7, ..by_velocity.clone() }),
        format!("slave_increments is 7; {none}")
    );
    assert_eq!(
        refused(SynchronizeRequest { start_distance_increments: 5, ..by_velocity }),
        format!("start_distance_increments is 5; {none}")
    );
    assert_eq!(
        refused(SynchronizeRequest { offset: Amount::Number(0.5), ..at.clone() }),
        "offset is `0.5 m`; 0 is allowed with engage AT_POSITION, whose slave_increments say where the slave is"
    );
    assert_eq!(
        refused(SynchronizeRequest { master: String::new(), ..at }),
        "engage is AT_POSITION; it needs the name of its master, whose position it is"
    );
    for (event, object) in [("mark", Object::Io(1)), ("belt", Object::Encoder(0)), ("turret", Object::Axis(1))] {
        for mode in [0, 1] {
            let request = SynchronizeRequest { engage: 2, event: event.into(), mode, ..couple.clone() };
            assert_eq!(of(&request), Ok(Engage::OnEvent(object)), "{event}");
            let by_parameter = SynchronizeRequest { master: String::new(), ..request };
            assert_eq!(of(&by_parameter), Ok(Engage::OnEvent(object)));
        }
    }
    for event in ["", "lamp"] {
        let unknown = refused(SynchronizeRequest { engage: 2, event: event.into(), ..couple.clone() });
        assert_eq!(unknown, config.find_latch(event).expect_err("unknown").to_string());
    }
}

#[test]
fn parameters_take_units_and_names() {
    use crate::parameter::Value;
    let config = config();
    let set = |name: &str, input| config.resolve_parameter(name, &input);
    let velocity = Quantity::parse("0.8 m/s", &config.axes[0].scale.dimensions(1)).unwrap();
    let change = set("x.max_velocity", ParameterInput::Quantity(velocity)).unwrap();
    assert_eq!((change.axis, change.value), (0, Value::Real(800_000.0)));
    assert_eq!(set("x.max_velocity", ParameterInput::Number(0.8)).unwrap(), change);
    let profile = set("turret.profile", ParameterInput::Text("jerk".into())).unwrap();
    assert_eq!(profile.value, Value::Int(2));
    assert_eq!(set("x.max_jerk", ParameterInput::Unset).unwrap().value, Value::Unset);
    let error = |name: &str, input| set(name, input).unwrap_err().to_string();
    assert_eq!(
        error("x.profile", ParameterInput::Unset),
        "x.profile is `null`; one of trapezoid, s_ramp, jerk is expected"
    );
    assert!(error("x.max_velocity", ParameterInput::Unset).contains("is `null`; a velocity such as"));
    assert!(error("x.max_velocty", ParameterInput::Number(1.0)).contains("no parameter is called `x.max_velocty`"));
    assert!(error("max_velocity", ParameterInput::Number(1.0)).contains("axis.key"));
    assert!(error("q.max_velocity", ParameterInput::Number(1.0)).contains("no axis is called `q`"));
    let text = error("x.profile", ParameterInput::Text("cubic".into()));
    assert_eq!(text, "x.profile is `cubic`; one of trapezoid, s_ramp, jerk is expected");
    assert!(error("x.error_reaction", ParameterInput::Number(1.5)).contains("a whole number, 0 to 5, is expected"));
    let wrong = Quantity::parse("3 mm", &config.axes[0].scale.dimensions(0)).unwrap();
    assert!(error("x.max_velocity", ParameterInput::Quantity(wrong)).starts_with("x.max_velocity: "));
}

#[test]
fn a_probe_is_a_search_with_an_end_in_the_same_units() {
    let config = with_latches();
    let request = |event: &str| ProbeRequest {
        search: MoveRequest { mode: 1, rates: Rates::numbers([2.0, 0.0, 0.0, 0.0]), ..to("x", Units::AxisUnit, 7.0) },
        event: event.into(),
        edge: 2,
        distance: Amount::Number(-0.5),
    };
    let probe = config.resolve_probe(&request("mark")).unwrap();
    assert_eq!((probe.axis, probe.relative, probe.source), (0, true, Object::Io(1)));
    assert_eq!((probe.target, probe.distance), (Length::whole(7_000), Length::whole(-500)));
    assert_eq!((probe.velocity, probe.edge), (2_000.0, ProbeEdge::Both));
    assert_eq!(config.resolve_probe(&request("belt")).unwrap().source, Object::Encoder(0));
    assert_eq!(config.resolve_probe(&request("turret")).unwrap().source, Object::Axis(1));
    for name in ["start", "lamp", "x", "", "machine"] {
        let error = config.resolve_probe(&request(name)).unwrap_err().to_string();
        assert_eq!(error, format!("`{name}` does not latch; mark, belt, turret can"));
    }
    let refused = |request: ProbeRequest| config.resolve_probe(&request).unwrap_err().to_string();
    for mode in [2, 3, 4] {
        let search = MoveRequest { mode, ..request("mark").search };
        assert_eq!(
            refused(ProbeRequest { search, ..request("mark") }),
            format!("mode is {mode}; 0 ABSOLUTE, 1 RELATIVE are allowed")
        );
    }
    let edge = ProbeRequest { edge: 4, ..request("mark") };
    assert_eq!(refused(edge), "edge is 4; 0 RISING, 1 FALLING, 2 BOTH, 3 INDEX are allowed");
    let search = MoveRequest { axis: "turret".into(), ..request("turret").search };
    let index = ProbeRequest { edge: 3, search, ..request("turret") };
    assert_eq!(config.resolve_probe(&index).map(|probe| probe.edge), Ok(ProbeEdge::Index));
    for event in ["mark", "belt", "turret"] {
        let edge = ProbeRequest { edge: 3, ..request(event) };
        assert_eq!(refused(edge), "edge is 3; INDEX is that of the axis itself, which event has to name");
    }
    for distance in [f64::NAN, f64::INFINITY, 1e300] {
        let distance = ProbeRequest { distance: Amount::Number(distance), ..request("mark") };
        assert!(refused(distance).starts_with("distance: "));
    }
}

/// A position is set by name: of an axis, of an encoder, of a master. A master has no SI unit; 0 needs no unit.
#[test]
fn a_position_is_set_of_an_axis_an_encoder_or_a_master() {
    use crate::command::{Action, MasterPosition, SetMasterPosition};
    use crate::request::{SetPositionRequest, Units};
    let config = config();
    let name = config.axes[0].name.clone();
    let ask = |axis: String, value: f64, units| {
        let request = SetPositionRequest { axis, position: Amount::Number(value), units, relative: false };
        config.resolve_set_position(&request)
    };
    let master = |value, units| match ask(format!("{name}.master"), value, units) {
        Ok(Action::SetMasterPosition(SetMasterPosition { axis: 0, position })) => Ok(position),
        Ok(other) => panic!("{other:?}"),
        Err(error) => Err(error.to_string()),
    };
    assert!(matches!(ask(name.clone(), 0.5, Units::Si), Ok(Action::SetPosition(_))));
    assert!(matches!(ask("belt".into(), 0.5, Units::Si), Ok(Action::SetEncoderPosition(_))));
    assert_eq!(master(0.0, Units::Si), Ok(MasterPosition::Increments(crate::position::Length::whole(0))));
    assert_eq!(master(-5.0, Units::Increments), Ok(MasterPosition::Increments(crate::position::Length::whole(-5))));
    assert_eq!(master(0.1, Units::AxisUnit), Ok(MasterPosition::Shown(0.1)));
    assert_eq!(master(1e-300, Units::AxisUnit), Ok(MasterPosition::Shown(0.0)));
    let refused = master(0.5, Units::Si).unwrap_err();
    assert!(refused.starts_with("units is 0; 1 AXIS_UNIT"), "{refused}");
    for wrong in [f64::NAN, f64::INFINITY, 1e300] {
        assert!(master(wrong, Units::AxisUnit).is_err(), "{wrong}");
    }
    assert!(ask("q.master".into(), 0.0, Units::Si).is_err());
}

#[test]
fn a_cam_takes_its_own_fields_and_no_others() {
    let mut config = config();
    let table = Arc::new(Table::new(Form::Xy, &[0, 10], &[0, 5]).unwrap());
    config.tables = vec![TableConfig { name: "knife".into(), table }];
    let cam = CamRequest { table: "knife".into(), start: 2, ..CamRequest::default() };
    let request =
        SynchronizeRequest { axis: "x".into(), master: "belt".into(), mode: 3, cam: cam.clone(), ..Default::default() };
    let found = config.resolve_synchronize(&request).unwrap().cam.unwrap();
    assert_eq!((found.table, found.start, found.master_scale), (0, CamStart::RampIn, Ratio::ONE));
    let error = |request: &SynchronizeRequest| config.resolve_synchronize(request).unwrap_err().to_string();
    let of_cam = |cam: CamRequest| error(&SynchronizeRequest { cam, ..request.clone() });
    assert!(of_cam(CamRequest { table: "spoon".into(), ..cam.clone() }).contains("`spoon`"));
    assert_eq!(
        of_cam(CamRequest { start: 3, ..cam.clone() }),
        "cam_start is 3; 0 ABSOLUTE, 1 RELATIVE, 2 RAMP_IN are allowed"
    );
    let nan = Amount::Number(f64::NAN);
    assert!(of_cam(CamRequest { master_offset: nan, ..cam.clone() }).starts_with("master_offset: "));
    assert_eq!(
        error(&SynchronizeRequest { numerator: 1, ..request.clone() }),
        "numerator is 1; 0 is allowed with mode CAM, which has master_scale and slave_scale"
    );
    let offset = Amount::Number(0.5);
    assert_eq!(
        error(&SynchronizeRequest { offset, ..request.clone() }),
        "offset is `0.5 m`; 0 is allowed with mode CAM, which has slave_offset"
    );
    let nameless = SynchronizeRequest { master: String::new(), ..request.clone() };
    assert!(config.resolve_synchronize(&nameless).is_ok());
    let shifted = CamRequest { master_offset: offset, ..cam.clone() };
    assert!(
        error(&SynchronizeRequest { cam: shifted, ..nameless }).starts_with("master_offset is given; 0 is allowed")
    );
    let position = SynchronizeRequest { mode: 1, ..request.clone() };
    assert_eq!(error(&position), "table is `knife`; it belongs to mode CAM; leave it out, or at 0");
    let scaled = CamRequest { slave_scale: Fraction::new(1, 2), ..CamRequest::default() };
    assert!(error(&SynchronizeRequest { cam: scaled, ..position }).starts_with("slave_scale is 0.5; it belongs"));
    // An offset of the leader is in its unit: 40 inc are 1 mm of the belt.
    let offset = CamRequest { master_offset: Amount::Number(0.001), ..cam };
    let found = config.resolve_synchronize(&SynchronizeRequest { cam: offset, ..request }).unwrap().cam.unwrap();
    assert_eq!(found.master_offset, Length::whole(config.encoders[0].scale.position_from_si(0.001).unwrap()));
}
