//! Phase shifts of slave and master, in motion.

use super::rig::{LINE, Rig, X, Y, at, cam, cases, config, couple, parameters, scale, to};
use crate::code::Code;
use crate::command::{Action, CamIn, Move, Phase, PhaseShift, PhaseSide, Synchronize};
use crate::config::{MachineConfig, SumConfig, TableConfig};
use crate::event::Kind;
use crate::object::{AxisSet, Leader};
use crate::position::{Length, Position};
use crate::request::{Amount, PhaseRequest};
use crate::sync::SyncMode;
use crate::sync::gear::{Gear, Ratio};
use crate::sync::{CamStart, Disengage};
use crate::table::{CamSetting, Form, Table};
use crate::unit::{Dimension, Quantity, Scale};
use proptest::prelude::*;
use std::sync::Arc;

const TO_LINE: Leader = Leader::AxisCommand(LINE);

fn amount(shift: Length, velocity: f64, acceleration: f64) -> PhaseShift {
    PhaseShift { shift, velocity, acceleration }
}

fn slave(shift: PhaseShift) -> Action {
    Action::Phase(Phase { axis: X, side: PhaseSide::Slave(shift) })
}

fn master(shift: PhaseShift) -> Action {
    let side = PhaseSide::Master { given: [Amount::default(); 3], by_scale: [(scale(), shift)].into() };
    Action::Phase(Phase { axis: X, side })
}

fn place(rig: &Rig, axis: u16) -> Position {
    rig.machine.state.leads.get(Leader::AxisCommand(axis)).position
}

/// Returns a rig with the line at 20 mm/s, followed by x with 355 : 113.
fn geared() -> Rig {
    let mut rig = Rig::enabled();
    rig.give(Action::Synchronize(couple(X, TO_LINE, 355, 113)));
    rig.run(2);
    rig.give(Action::Move(Move { acceleration: 2e5, ..at(LINE, 20_000.0) }));
    rig.run(300);
    rig
}

/// 7/3 inc of the slave are not a whole number of increments, and are kept.
#[test]
fn a_shift_of_the_slave_stays_to_2_to_the_minus_32() {
    let mut rig = geared();
    let shift = Length { nearest: 2, rest: Position::from_raw(1_431_655_765) };
    let goal = rig.give(slave(amount(shift, 1_000.0, 10_000.0)));
    rig.run(1);
    assert!(rig.real("x.phase.slave") > 0.99, "{}", rig.real("x.phase.slave"));
    rig.run(200);
    assert_eq!((rig.done(goal)[0].code, rig.real("x.phase.slave"), rig.int("x.sync.error")), (Code::NONE, 0.0, 0));
    let exact = (place(&rig, LINE).raw() * 355).div_euclid(113) + shift.exact().raw();
    assert_eq!((place(&rig, X).raw(), rig.state("x")), (exact, "SYNCHRONIZED_MOTION"));
}

/// The gear handles a shifted master like any master: slave = floor(355 (master + shift) / 113).
#[test]
fn a_shift_of_the_master_is_motion_of_the_master() {
    let mut rig = geared();
    let k = rig.machine.next_cycle();
    // 5 mm/s and 50 mm/s^2 at the master: 0.1 s of acceleration, 0.1 s at 5 inc per cycle, 0.1 s of deceleration.
    let goal = rig.give(master(amount(Length::whole(-1_000), 5_000.0, 50_000.0)));
    rig.run(50);
    assert!((rig.real("x.command.velocity") - (20_000.0 - 2_500.0) * 355.0 / 113.0).abs() < 1.0);
    assert_eq!((rig.int("x.sync.error"), rig.int("x.in_sync")), (0, 1));
    rig.run(60);
    let left = rig.real("x.phase.master");
    rig.run(250);
    assert!((0.6..0.8).contains(&left), "{left}");
    // 1000 inc at 5 inc per cycle are 200 cycles, plus one ramp of 100; the rounding remainder takes one cycle.
    let done = rig.done(goal)[0];
    assert_eq!((done.code, rig.real("x.phase.master")), (Code::NONE, 0.0));
    assert!((k + 299..=k + 301).contains(&done.cycle), "{} from {k}", done.cycle);
    let exact = ((place(&rig, LINE) - Position::whole(1_000)).raw() * 355).div_euclid(113);
    assert_eq!(place(&rig, X).raw(), exact);
}

#[test]
fn rates_left_out_are_the_defaults_of_the_axis_through_its_gear() {
    let mut rig = Rig::enabled();
    rig.give(Action::Synchronize(couple(X, TO_LINE, 5, 1)));
    rig.give(master(amount(Length::whole(100_000), 0.0, 0.0)));
    rig.run(400);
    // 50 mm/s, half of max_velocity.
    assert!((rig.real("x.command.velocity") - 50_000.0).abs() < 1e-6, "{}", rig.real("x.command.velocity"));
    rig.run(10_000);
    assert_eq!((rig.int("x.command.position"), rig.real("x.command.velocity")), (500_000, 0.0));
}

#[test]
fn a_cam_goes_where_a_shifted_master_leads_it() {
    let knife = Table::new(Form::Xy, &[0, 8_000, 16_000, 20_000], &[0, 4_000, 4_000, 6_000]).expect("points");
    let mut config = config(0);
    config.tables = vec![TableConfig { name: "knife".into(), table: Arc::new(knife.with_cam(CamSetting::default())) }];
    let mut rig = Rig::of(config);
    rig.enable();
    let cam = cam(0, CamStart::Relative);
    rig.give(Action::Synchronize(Synchronize { cam: Some(cam), ..couple(X, TO_LINE, 0, 0) }));
    let none = rig.give(master(amount(Length::whole(24_000), 0.0, 100_000.0)));
    assert!(rig.refusal(none).starts_with("x: a phase shift of the master of a cam needs its velocity"));
    let goal = rig.give(master(amount(Length::whole(24_000), 20_000.0, 100_000.0)));
    rig.run(3_000);
    // A period of 6000, and half of the rise of the next one.
    assert_eq!((rig.done(goal)[0].code, rig.int("x.command.position")), (Code::NONE, 8_000));
    // Back over the end of a period, while the line moves in the same direction.
    rig.give(Action::Move(Move { velocity: 10_000.0, acceleration: 1e5, deceleration: 1e5, ..to(LINE, 4_000) }));
    rig.give(master(amount(Length::whole(-12_000), 20_000.0, 100_000.0)));
    rig.run(3_000);
    // 24000 + 4000 - 12000 = 16000
    assert_eq!((rig.int("x.command.position"), rig.int("x.sync.error")), (4_000, 0));
}

/// The sum of a belt and the line leads a cam, and is shifted: 1000 + 300 - 200, divided by two.
#[test]
fn a_sum_leads_a_cam_and_is_shifted() {
    let half = Table::new(Form::Xy, &[0, 4_000], &[0, 2_000]).expect("points").with_cam(CamSetting::default());
    let sum = SumConfig { name: "sum".into(), add: vec![TO_LINE], subtract: vec![Leader::Encoder(0)] };
    let tables = vec![TableConfig { name: "half".into(), table: Arc::new(half) }];
    let mut rig = Rig::of(MachineConfig { tables, masters: vec![sum], ..config(0) });
    rig.enable();
    let cam = cam(0, CamStart::Relative);
    rig.give(Action::Synchronize(Synchronize { cam: Some(cam), ..couple(X, Leader::Sum(0), 0, 0) }));
    rig.give(Action::Move(to(LINE, 1_000)));
    for _ in 0..200 {
        rig.plant.jump_encoder(0, 1);
        rig.run(2);
    }
    let goal = rig.give(master(amount(Length::whole(300), 1_000.0, 10_000.0)));
    rig.run(1_000);
    assert_eq!((rig.done(goal)[0].code, rig.int("x.command.position"), rig.int("x.sync.error")), (Code::NONE, 550, 0));
}

#[test]
fn a_new_shift_takes_the_place_of_one_that_moves() {
    for side in [slave, master] {
        let mut rig = Rig::enabled();
        rig.give(Action::Synchronize(couple(X, TO_LINE, 1, 1)));
        let first = rig.give(side(amount(Length::whole(10_000), 10_000.0, 100_000.0)));
        rig.run(499);
        let second = rig.give(side(amount(Length::whole(-500), 10_000.0, 100_000.0)));
        // 0.1 s of acceleration, 0.4 s at 10 inc per cycle.
        let from = rig.int("x.command.position");
        assert!((4_490..=4_510).contains(&from), "{from}");
        rig.run(2_000);
        assert_eq!((rig.done(first)[0].code, rig.done(second)[0].code), (Code::REPLACED, Code::NONE));
        assert!((rig.int("x.command.position") - (from - 500)).abs() <= 10, "{}", rig.int("x.command.position"));
        assert_eq!((rig.int("x.sync.error"), rig.state("x")), (0, "SYNCHRONIZED_MOTION"));
    }
}

/// A shift that replaces an active one may use the velocity of that one; an active shift of the slave reduces it.
#[test]
fn replacing_shift_may_use_velocity_of_replaced_shift() {
    let mut rig = Rig::enabled();
    rig.give(Action::Synchronize(couple(X, TO_LINE, 2, 1)));
    let shift = amount(Length::whole(10_000), 30_000.0, 300_000.0);
    let first = rig.give(master(shift));
    rig.run(200);
    assert!((rig.real("x.command.velocity") - 60_000.0).abs() < 1e-6);
    let second = rig.give(master(PhaseShift { velocity: 45_000.0, ..shift }));
    assert!(rig.was_accepted(second));
    rig.run(2);
    assert_eq!(rig.done(first)[0].code, Code::REPLACED);
    rig.run(3_000);
    rig.give(slave(amount(Length::whole(20_000), 40_000.0, 200_000.0)));
    let third = rig.give(master(PhaseShift { velocity: 31_000.0, ..shift }));
    assert_eq!(rig.refusal(third), "x: velocity 62 mm/s is more than the motion under way leaves: 60 mm/s");
    let slow = rig.give(master(PhaseShift { velocity: 1e-7, ..shift }));
    assert_eq!(rig.answer(slow).expect_err("refused").code, Code::RATE_TOO_LOW);
}

/// The master of a cam must not move by more than its length in a cycle; if it finally does, the shift is still
/// answered.
#[test]
fn a_shift_is_answered_though_its_last_cycle_fails() {
    let half = Table::new(Form::Xy, &[0, 100], &[0, 50]).expect("points").with_cam(CamSetting::default());
    let tables = vec![TableConfig { name: "half".into(), table: Arc::new(half) }];
    let mut rig = Rig::of(MachineConfig { tables, ..config(0) });
    rig.enable();
    let cam = cam(0, CamStart::Relative);
    rig.give(Action::Synchronize(Synchronize { cam: Some(cam), ..couple(X, Leader::Encoder(0), 0, 0) }));
    let fast = rig.give(master(amount(Length::whole(50), 200_000.0, 1e12)));
    let sentence =
        "x: the shift moves the master by 200 increments in a cycle; 100 is followed at most, with what it runs itself";
    assert_eq!(rig.refusal(fast), sentence);
    // A third of the table is 33.3 inc of the belt.
    let turned = CamIn { master_scale: Ratio::new(3, 1).expect("a ratio"), ..cam };
    rig.give(Action::Synchronize(Synchronize { cam: Some(turned), ..couple(X, Leader::Encoder(0), 0, 0) }));
    let fast = rig.give(master(amount(Length::whole(9), 33_500.0, 1e6)));
    assert!(rig.refusal(fast).contains("by 33.5 increments in a cycle; 33.333"), "{}", rig.refusal(fast));
    let borne = rig.give(master(amount(Length::whole(9), 33_300.0, 1e6)));
    assert!(rig.was_accepted(borne));
    rig.run(100);
    rig.give(Action::Synchronize(Synchronize { cam: Some(cam), ..couple(X, Leader::Encoder(0), 0, 0) }));
    let goal = rig.give(master(amount(Length::whole(50), 60_000.0, 1e12)));
    // 50 inc of the shift and 60 inc of the belt in one cycle.
    rig.plant.jump_encoder(0, 60);
    rig.run(5);
    assert_eq!((rig.done(goal).len(), rig.int("x.error")), (1, i64::from(Code::CAM_MASTER_TOO_FAST.0)));
}

#[test]
fn a_cancelled_shift_slows_down_and_stays_where_it_is() {
    for side in [slave, master] {
        let mut rig = Rig::enabled();
        let coupling = rig.give(Action::Synchronize(couple(X, TO_LINE, 1, 1)));
        let goal = rig.give(side(amount(Length::whole(10_000), 10_000.0, 100_000.0)));
        rig.run(299);
        assert!(rig.real("x.phase.slave") + rig.real("x.phase.master") > 0.5);
        let cancel = rig.give(Action::Cancel { goal });
        assert!(rig.was_accepted(cancel));
        assert_eq!((rig.real("x.phase.slave"), rig.real("x.phase.master")), (0.0, 0.0), "nothing is to come");
        rig.run(500);
        // 500 + 200 cycles at 10, and 500 of deceleration.
        assert!((2_980..=3_020).contains(&rig.int("x.command.position")), "{}", rig.int("x.command.position"));
        assert_eq!((rig.done(goal)[0].code, rig.done(coupling).len()), (Code::CANCELLED, 0));
        assert_eq!((rig.int("x.sync.error"), rig.real("x.command.velocity")), (0, 0.0));
    }
}

/// Both sides, and the coupling: the end of each goal is reported once.
#[test]
fn a_shift_ends_with_its_coupling() {
    let shift = amount(Length::whole(10_000), 10_000.0, 100_000.0);
    for (action, code) in [
        (Action::Halt(AxisSet::one(X)), Code::HALTED),
        (Action::QuickStop(AxisSet::one(X)), Code::QUICK_STOP),
        (Action::Disable(AxisSet::one(X)), Code::DISABLED),
        (Action::Move(to(X, 0)), Code::REPLACED),
        (Action::Synchronize(couple(X, Leader::Encoder(0), 1, 1)), Code::REPLACED),
        (Action::Cancel { goal: 2 }, Code::CANCELLED),
    ] {
        let mut rig = Rig::enabled();
        let coupling = rig.give(Action::Synchronize(couple(X, TO_LINE, 1, 1)));
        assert_eq!(coupling, 2);
        let goals = [rig.give(slave(shift)), rig.give(master(shift))];
        rig.run(200);
        rig.give(action.clone());
        rig.run(1_000);
        for goal in goals {
            assert_eq!(rig.done(goal).iter().map(|done| done.code).collect::<Vec<_>>(), [code], "{action:?}");
        }
    }
}

#[test]
fn what_cannot_be_shifted_is_refused() {
    let shift = amount(Length::whole(100), 1_000.0, 10_000.0);
    let no_coupling = "x: the axis is not coupled by position; a phase shift needs a leader, in mode POSITION or CAM";
    let mut rig = Rig::enabled();
    for side in [slave, master] {
        let goal = rig.give(side(shift));
        assert_eq!(rig.refusal(goal), no_coupling);
    }
    rig.give(Action::Synchronize(Synchronize { mode: SyncMode::Velocity, ..couple(X, TO_LINE, 1, 1) }));
    for side in [slave, master] {
        let goal = rig.give(side(shift));
        assert_eq!(rig.refusal(goal), no_coupling);
    }
    rig.give(Action::Synchronize(couple(X, TO_LINE, 2, 1)));
    rig.give(Action::Move(Move { velocity: 10_000.0, ..at(LINE, 10_000.0) }));
    rig.run(200);
    // 40.1 mm/s are 80.2 at the slave, which already has 20.
    let fast = rig.give(master(PhaseShift { velocity: 40_100.0, ..shift }));
    assert_eq!(rig.refusal(fast), "x: velocity 80.2 mm/s is more than the motion under way leaves: 80 mm/s");
    let steep = rig.give(master(PhaseShift { acceleration: 600_000.0, ..shift }));
    assert_eq!(
        rig.refusal(steep),
        "x: acceleration or deceleration 1200 mm/s^2 is more than the motion under way leaves: 1000 mm/s^2"
    );
    rig.give(Action::Disable(AxisSet::one(X)));
    for side in [slave, master] {
        let goal = rig.give(side(shift));
        assert_eq!(rig.answer(goal).expect_err("refused").code, Code::NOT_ENABLED);
    }
    rig.run(100);
    rig.give(Action::Enable(AxisSet::one(X)));
    rig.run(100);
    rig.give(Action::Synchronize(couple(X, TO_LINE, 2, 1)));
    for bad in [f64::NAN, -1.0, f64::INFINITY] {
        for side in [slave, master] {
            let goal = rig.give(side(PhaseShift { velocity: bad, ..shift }));
            assert!(rig.answer(goal).is_err(), "{bad}");
        }
    }
    let by_scale = [(Scale::increments(), shift)].into();
    let side = PhaseSide::Master { given: [Amount::default(); 3], by_scale };
    let goal = rig.give(Action::Phase(Phase { axis: X, side }));
    let unit = "x: the shift has units that the leader of the axis has not; side MASTER is in those of the leader";
    assert_eq!(rig.refusal(goal), unit);
    assert_eq!((rig.real("x.phase.slave"), rig.real("x.phase.master")), (0.0, 0.0));
    let nobody = Phase { axis: 99, side: PhaseSide::Slave(shift) };
    let goal = rig.give(Action::Phase(nobody));
    assert!(rig.answer(goal).is_err());
    let goal = rig.give(Action::Phase(Phase { axis: Y, side: PhaseSide::Slave(shift) }));
    assert!(rig.refusal(goal).starts_with("y: the axis is not coupled"));
}

/// 1.5 mm are 1500 inc of the axis, but 1.5 inc of a leader without units; an angle converts to neither.
#[test]
fn amounts_are_made_increments_of_each_scale_that_leads() {
    let config = config(0);
    let quantity = |text, dimension| Amount::Quantity(Quantity::parse(text, &[dimension]).expect("a quantity"));
    let request = PhaseRequest {
        axis: "x".into(),
        side: 1,
        shift: quantity("1.5 mm", Dimension::Length(0)),
        velocity: quantity("20 inc/s", Dimension::Increments(1)),
        acceleration: Amount::Number(0.25),
    };
    let phase = config.resolve_phase(&request).expect("a phase");
    let PhaseSide::Master { by_scale, .. } = &phase.side else { panic!("{phase:?}") };
    assert_eq!(by_scale.len(), 2);
    assert_eq!(by_scale[0], (scale(), amount(Length::whole(1_500), 20.0, 250_000.0)));
    let own = config.resolve_phase(&PhaseRequest { side: 0, ..request.clone() }).expect("a phase");
    assert_eq!(own.side, PhaseSide::Slave(amount(Length::whole(1_500), 20.0, 250_000.0)));
    let refused = |request: PhaseRequest| config.resolve_phase(&request).expect_err("refused").to_string();
    let angle = quantity("90 deg", Dimension::Angle(0));
    let sentence = "shift: `90 deg` is an angle; a length such as `90 mm` is expected";
    assert_eq!(refused(PhaseRequest { shift: angle, ..request.clone() }), sentence);
    assert_eq!(refused(PhaseRequest { shift: angle, side: 0, ..request.clone() }), sentence);
    assert_eq!(refused(PhaseRequest { side: 2, ..request.clone() }), "side is 2; 0 SLAVE, 1 MASTER are allowed");
    assert!(refused(PhaseRequest { velocity: Amount::Number(f64::NAN), ..request.clone() }).starts_with("velocity: "));
    for side in [0, 1] {
        assert_eq!(
            refused(PhaseRequest { acceleration: Amount::Number(-0.5), side, ..request.clone() }),
            "acceleration is `-0.5 m/s^2`; a finite number that is not negative is allowed; 0 stands for the default"
        );
    }
}

proptest! {
    #![proptest_config(cases(40))]

    /// Shifts of both sides, with any motion of the leader: the slave is at the position given by gear and shifts, and
    /// within its limits.
    #[test]
    fn shifts_add_up_exactly(
        numerator in prop_oneof![-400_i64..-1, 1_i64..400],
        denominator in 100_i64..400,
        shifts in prop::collection::vec((any::<bool>(), -(1_i128 << 44)..(1_i128 << 44), 300.0..3_000.0_f64), 1..5),
        speeds in prop::collection::vec(-8_000.0..8_000.0_f64, 5),
    ) {
        let mut rig = Rig::enabled();
        let ratio = Ratio::new(numerator, denominator).expect("not 0");
        rig.give(Action::Synchronize(couple(X, TO_LINE, numerator, denominator)));
        let (mut of_master, mut of_slave) = (Position::ZERO, Position::ZERO);
        for ((is_master, raw, velocity), speed) in shifts.into_iter().zip(speeds) {
            rig.give(Action::Move(Move { acceleration: 1e5, deceleration: 1e5, ..at(LINE, speed) }));
            let exact = Position::from_raw(raw);
            let shift = Length { nearest: exact.nearest(), rest: exact - Position::whole(exact.nearest()) };
            let shift = amount(shift, velocity, 20_000.0);
            let goal = rig.give(if is_master { master(shift) } else { slave(shift) });
            prop_assert_eq!(rig.answer(goal), Ok(()));
            for _ in 0..30_000 {
                if !rig.done(goal).is_empty() { break }
                rig.run(50);
            }
            prop_assert_eq!(rig.done(goal)[0].code, Code::NONE);
            *(if is_master { &mut of_master } else { &mut of_slave }) += exact;
            rig.run(100);
            let exact = Gear::new(ratio).step(place(&rig, LINE) + of_master) + of_slave;
            prop_assert_eq!(place(&rig, X), exact);
            prop_assert_eq!(rig.int("x.sync.error"), 0);
        }
        let warnings: Vec<_> = rig.events.iter().filter(|event| event.kind == Kind::Warning).collect();
        prop_assert!(warnings.is_empty(), "{:?}", warnings);
    }
}

/// A leader that a shift moves into a limit of the slave stops the slave there, like any leader.
#[test]
fn a_shift_does_not_lead_beyond_a_limit() {
    let mut config = config(0);
    let limits = crate::parameter::AxisParameters { max_position: Some(3_000), ..parameters() };
    config.axes[usize::from(X)].parameters = limits;
    for side in [slave, master] {
        let mut rig = Rig::of(config.clone());
        rig.enable();
        rig.give(Action::Synchronize(Synchronize { disengage: Disengage::Stop, ..couple(X, TO_LINE, 1, 1) }));
        let goal = rig.give(side(amount(Length::whole(5_000), 10_000.0, 100_000.0)));
        rig.run(3_000);
        assert!(rig.int("x.command.position") <= 3_000, "{}", rig.int("x.command.position"));
        assert!(rig.was_accepted(goal) && rig.int("x.command.position") >= 2_900);
        assert_eq!((rig.done(goal).len(), rig.state("x")), (1, "ERROR_STOP"));
    }
}
