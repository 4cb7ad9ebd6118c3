//! Outputs that several functions share.

use super::super::rig::{X, Y, at, to};
use super::{ready, set, with_io};
use crate::command::Action;
use crate::object::AxisSet;
use crate::parameter::MACHINE;

/// One output for several: it is active while one of them is, whichever ends first, and whatever another one lets go.
///
/// Proves: MACS-IO-06, MACS-IO-07
#[test]
fn functions_that_share_an_output_show_that_one_of_them_is_active() {
    for (output, on) in [(2, 1), (-2, 0)] {
        let mut cell = with_io();
        cell.axes[1].parameters.outputs.axmove = output;
        cell.axes[2].parameters.outputs.axmove = output;
        let mut rig = ready(cell);
        assert_eq!(rig.int("q"), 1 - on);
        rig.give(Action::Move(at(X, 1_000.0)));
        rig.give(Action::Move(to(Y, 1_000)));
        assert_eq!(rig.int("q"), on);
        rig.run_until("y.state", 1);
        assert_eq!((rig.state("x"), rig.int("q")), ("CONTINUOUS_MOTION", on), "x still moves");
        rig.give(set(Y, "o_axmove", 0));
        assert_eq!(rig.int("q"), on);
        rig.give(set(MACHINE, "o_error", output));
        assert_eq!(rig.int("q"), on, "no error, and x still moves");
        rig.give(Action::Halt(AxisSet::first(3)));
        rig.run(500);
        assert_eq!(rig.int("q"), 1 - on);
        rig.plant.drive(0).unwrap().jump(500_000);
        rig.run(500);
        assert_eq!((rig.state("x"), rig.int("q")), ("ERROR_STOP", on));
        rig.give(set(X, "o_axmove", 0));
        assert_eq!(rig.int("q"), on);
        rig.give(set(MACHINE, "o_error", 0));
        assert_eq!(rig.int("q"), 1 - on);
    }
}
