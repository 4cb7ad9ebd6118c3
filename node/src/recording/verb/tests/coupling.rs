//! Tests the exact texts of couplings, of their phase shifts and of their ends.

use super::*;
use lineshaft_core::command::{CamIn, DisengageAt};
use lineshaft_core::request::PhaseRequest;
use lineshaft_core::sync::CamStart;
use lineshaft_core::sync::gear::Ratio;

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
