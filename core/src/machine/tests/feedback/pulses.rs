//! Counting of pulses between two marks (WF alarm 8).

use super::super::rig::{Rig, X, Y, at, couple, to};
use super::{error, set, velocity_config};
use crate::axis::Wired;
use crate::code::Code;
use crate::command::{Action, HomeAxis, HomingMethod};
use crate::encoder::PulseCheck;
use crate::event::Kind;
use crate::object::Leader;
use crate::sim::{Fixtures, Index};
use crate::vocabulary::wf::Request;

/// 4 x 25 increments between marks; the tolerance is the counts of 1 ms at the maximum speed plus 4.
fn monitored() -> Rig {
    let mut config = velocity_config();
    let p = &mut config.axes[1].parameters;
    (p.encoder.monitored, p.encoder.pulses_or_step, p.max_velocity) = (1, 250, 20_000.0);
    let mut rig = Rig::of(config);
    rig.plant
        .drive(0)
        .unwrap()
        .install_fixtures(Fixtures { index: Some(Index { every: 1_000, at: 100 }), ..Fixtures::default() });
    rig.enable();
    rig.give(Action::Move(at(X, 10_000.0)));
    rig.run(500);
    rig
}

/// Homed by its index the axis rests on a mark. It moves away by less than a revolution and returns, from either side:
/// no pulse is missing. Then pulses are missing, and this is reported.
///
/// Proves: WF-MON-02
#[test]
fn an_axis_that_rests_on_its_mark_goes_back_and_forth() {
    let mut config = velocity_config();
    let p = &mut config.axes[1].parameters;
    (p.encoder.monitored, p.encoder.pulses_or_step, p.max_velocity) = (1, 250, 20_000.0);
    let mut rig = Rig::of(config);
    rig.plant
        .drive(0)
        .unwrap()
        .install_fixtures(Fixtures { index: Some(Index { every: 1_000, at: 100 }), ..Fixtures::default() });
    rig.enable();
    let home = rig.give(Action::HomeAxis(HomeAxis { axis: X, method: HomingMethod::Cia402(34) }));
    rig.run(3_000);
    assert_eq!((rig.done(home)[0].code, rig.int("x.homed")), (Code::NONE, 1));
    rig.mirror();
    for target in
        [-400, 0, 400, 0, -1, 0, 1, 0, -1, 1, 0, -2_500, 1_000, 999, 1_000, 1_001, 999, -1_000, -1_500, -1_000, 0]
    {
        rig.give(Action::Move(to(X, target)));
        rig.run(1_200);
        assert_eq!((rig.int("x.actual.position"), error(&rig)), (target, 0));
    }
    rig.plant.drive(0).unwrap().jump(-25);
    rig.run(100);
    rig.give(Action::Move(to(X, -400)));
    rig.run(300);
    rig.give(Action::Move(to(X, 400)));
    rig.run(300);
    assert_eq!(error(&rig), i64::from(Code::WF_PULSES.0));
}

/// Proves: WF-MON-02, WF-MON-06, WF-MON-07, WF-MD-16, WF-MD-18
#[test]
fn pulses_that_are_too_many_or_missing_are_alarm_8_at_the_next_mark() {
    for (slips, alarm) in [([24, -24], false), ([25, 0], true), ([-25, 0], true), ([13, 12], true)] {
        let mut rig = monitored();
        for slip in slips {
            rig.plant.drive(0).unwrap().jump(slip);
            rig.run(250);
        }
        let code = if alarm { i64::from(Code::WF_PULSES.0) } else { 0 };
        assert_eq!(error(&rig), code, "{slips:?}");
        if alarm {
            assert_eq!((rig.state("x"), rig.int("x.enabled"), rig.int("x.wf.alarm")), ("ERROR_STOP", 0, 8));
            let event = rig.events.iter().find(|event| event.kind == Kind::Error).expect("an error");
            let sentence = crate::text::message(event, rig.machine.config());
            assert!(sentence.starts_with("x: alarm 8: pulses of the encoder are missing or too many: "), "{sentence}");
            assert!(sentence.ends_with(" since the index, beyond 0.024 mm"), "{sentence}");
            // The reset bit acknowledges the alarm, and the supervision starts again.
            let axis = X;
            rig.give(Action::vocabulary(Request { axis, reset: true, ..Request::default() }));
            rig.run(2);
            assert_eq!((error(&rig), rig.int("x.wf.alarm"), rig.state("x")), (0, 0, "DISABLED"));
        }
    }
}

/// Proves: WF-MON-02
#[test]
fn a_mark_that_stays_away_is_alarm_8_as_soon_as_it_is_overdue() {
    let mut rig = monitored();
    let mark = rig.int("x.index.position");
    rig.plant.drive(0).unwrap().lose_index();
    while error(&rig) == 0 {
        rig.run(1);
        assert!(rig.int("x.actual.position") < mark + 1_000 + 24 + 20, "overdue");
    }
    assert_eq!(error(&rig), i64::from(Code::WF_PULSES.0));
    // Not selected, so not supervised.
    let mut rig = monitored();
    set(&mut rig, &[("wf.md41", 0)]);
    rig.plant.drive(0).unwrap().lose_index();
    rig.run(1_000);
    assert_eq!(error(&rig), 0);
}

/// The same for an entry of section `encoders`: its followers stop, and so does an axis that reads it.
///
/// Proves: WF-MON-02
#[test]
fn pulses_of_a_leading_encoder_are_monitored() {
    let mut config = velocity_config();
    config.encoders[0].check = Some(PulseCheck { every: 1_000, tolerance: 8 });
    config.axes[1].wired = Wired::Encoder(0);
    let mut rig = Rig::of(config);
    rig.enable();
    rig.give(Action::Synchronize(couple(Y, Leader::Encoder(0), 1, 1)));
    rig.give(Action::Move(at(X, 10_000.0)));
    rig.run(500);
    rig.plant.slip_encoder(0, 8);
    rig.run(200);
    assert_eq!((error(&rig), rig.int("belt.error")), (0, 0));
    rig.plant.slip_encoder(0, 1);
    rig.run(100);
    let told = rig.events.iter().filter(|event| event.code == Code::WF_PULSES).count();
    assert_eq!((told, error(&rig)), (1, i64::from(Code::ENCODER_INVALID.0)));
    assert_eq!(rig.int("y.error"), i64::from(Code::LEADER_LOST.0));
}
