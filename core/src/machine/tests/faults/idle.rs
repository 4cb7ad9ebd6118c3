//! Drives that fail while their axis is off.

use super::super::rig::{Rig, X};
use crate::code::Code;
use crate::command::Action;
use crate::event::{Event, Kind, Severity};
use crate::object::{AxisSet, Object};

fn warnings(rig: &Rig) -> Vec<Event> {
    let of_x = |event: &&Event| event.kind == Kind::Warning && event.source == Object::Axis(X);
    rig.events.iter().filter(of_x).copied().collect()
}

/// Such a failure stops nothing and is not an error, but it is reported in its cycle, once; the next enable ends in the
/// error.
#[test]
fn drive_fault_while_axis_is_off_is_reported() {
    for (fails, code) in [
        ((|rig: &mut Rig| rig.plant.drive(0).unwrap().inject_fault(0x7305)) as fn(&mut Rig), Code::drive_fault(0x7305)),
        (|rig| rig.plant.drive(0).unwrap().disconnect(), Code::DRIVE_LOST),
    ] {
        let mut rig = Rig::new();
        rig.run(20);
        assert_eq!(warnings(&rig).len(), 0);
        fails(&mut rig);
        rig.run(1);
        let told = warnings(&rig);
        assert_eq!((told.len(), told[0].code, told[0].severity), (1, code, Severity::Warn));
        rig.run(3_000);
        assert_eq!((warnings(&rig).len(), rig.int("x.error"), rig.state("x")), (1, 0, "DISABLED"));
        let enabled = rig.give(Action::Enable(AxisSet::one(X)));
        rig.run(10);
        assert_eq!((rig.done(enabled)[0].code, rig.int("x.error")), (code, code.0.into()));
        assert_eq!(warnings(&rig).len(), 1, "from here on it is an error, told as such");
    }
}

/// A failure that appears and disappears does not flood the subscribers.
#[test]
fn intermittent_drive_fault_is_reported_once_a_second() {
    let mut rig = Rig::new();
    rig.run(20);
    for _ in 0..100 {
        rig.plant.drive(0).unwrap().inject_fault(0x7305);
        rig.run(20);
        rig.give(Action::ResetErrors(AxisSet::one(X)));
        rig.run(20);
    }
    let told = warnings(&rig).len();
    assert!((3..=5).contains(&told), "{told} in 4 s");
}
