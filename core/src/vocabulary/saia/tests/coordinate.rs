//! The zero of the vocabulary and its break position after a change of coordinate: nothing moves.

use super::rig::{FAST, Rig, X};
use crate::command::{Action, HomeAxis, HomingMethod, SetPosition};
use crate::object::AxisSet;
use crate::position::Length;

fn set_position(rig: &mut Rig, position: i64) {
    rig.ask([Action::SetPosition(SetPosition { axis: X, position: Length::whole(position) })]).unwrap();
}

fn home(rig: &mut Rig) {
    rig.ask([Action::HomeAxis(HomeAxis { axis: X, method: HomingMethod::Cia402(35) })]).unwrap();
}

/// Counts come from edges, and there was none: position, break position and destination stay at their physical place.
///
/// Proves: SAIA-DET-14
#[test]
fn a_new_position_of_the_axis_leaves_those_of_the_vocabulary() {
    for (axis_is, set) in [(500_000, true), (-500_000, true), (0, false)] {
        for brake in [7000.0, 400.0] {
            let mut rig = Rig::holding();
            rig.does(&[("brkp", brake)], "fldbpa fressf");
            if set {
                set_position(&mut rig, axis_is)
            } else {
                home(&mut rig)
            };
            rig.run(3);
            assert_eq!((rig.int("x.actual.position"), rig.int("x.saia.position")), (axis_is, 1000));
            assert_eq!(rig.int("x.saia.brkpos"), 0, "{axis_is}: nothing has moved");
            let end: i64 = if brake > 1000.0 { 9000 } else { 0 };
            rig.does(&[("destp", end as f64)], "fldda fstart");
            rig.run_until("x.saia.brkpos", 1);
            let past = (rig.int("x.saia.position") - brake as i64) * (end - 1000).signum();
            assert!((0..=50).contains(&past), "{axis_is}: {past}");
            rig.run_until("x.saia.ondest", 1);
            assert_eq!(rig.int("x.command.position"), axis_is + end - 1000);
        }
    }
}

/// DET-13 does not shift the break register: it is a position in the new coordinate then.
///
/// Proves: SAIA-DET-13, SAIA-DET-14
#[test]
fn a_new_zero_passes_no_break_position() {
    let mut rig = Rig::holding();
    rig.does(&[("brkp", 400.0)], "fldbpa fressf");
    rig.does(&[], "fsetzp");
    rig.run(3);
    assert_eq!((rig.int("x.saia.position"), rig.int("x.saia.brkpos")), (0, 0));
    rig.does(&[("destp", 1000.0)], "fldda fstart");
    rig.run_until("x.saia.brkpos", 1);
    assert!((400..=450).contains(&rig.int("x.saia.position")));
    // At the break position the axis has reached it, as if it were loaded there.
    let mut rig = Rig::holding();
    rig.does(&[("brkp", 0.0)], "fldbpa fressf");
    rig.does(&[], "fsetzp");
    assert_eq!(rig.int("x.saia.brkpos"), 1);
}

/// If `enable` replaced axinit, the zero is that of the axis and follows it.
#[test]
fn shared_zero_follows_zero_of_axis() {
    for own in [false, true] {
        let mut rig = Rig::saia();
        rig.on();
        rig.does(FAST, "fldva fldbpa");
        rig.does(&[("destp", 1000.0), ("brkp", 300_000.0), ("stafrr", 0.0)], "fldda fldbpa fressf fstart");
        rig.run_until("x.saia.ondest", 1);
        if own {
            rig.does(&[], "fsetzp");
        }
        set_position(&mut rig, 500_000);
        rig.run(3);
        let here = if own { 0 } else { 500_000 };
        assert_eq!((rig.int("x.saia.position"), rig.int("x.saia.brkpos")), (here, 0), "{own}");
    }
}

/// A halt of the contract takes over the axis from the vocabulary.
#[test]
fn the_vocabulary_is_active_while_it_commands_the_axis() {
    let mut rig = Rig::holding();
    rig.does(&[("destp", 9000.0)], "fldda fstart");
    assert_eq!(rig.int("x.saia.active"), 1);
    rig.ask([Action::Halt(AxisSet::one(X))]).unwrap();
    rig.run(1);
    assert_eq!(rig.int("x.saia.active"), 0);
}
