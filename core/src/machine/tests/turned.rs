//! A reference that is reversed into a blocked direction: the previous motion does not continue.

use super::rig::{Rig, X, config};
use crate::code::Code;
use crate::command::Action;
use crate::config::MachineConfig;
use crate::drive::{Interface, inputs};
use crate::event::Kind;
use crate::parameter::{Change, Row, Value};
use crate::sim::{Fixtures, Model};
use crate::vocabulary::wf::{Jog, Mode, Request};

/// Returns a rig with x on its positive limit switch.
fn on_the_switch(config: MachineConfig) -> Rig {
    let mut rig = Rig::with(config, [Model::Ideal; 2]);
    rig.plant.drive(0).unwrap().install_fixtures(Fixtures { positive: Some(-1_000_000), ..Fixtures::default() });
    rig.enable();
    rig
}

/// Returns a rig with x that may only move forwards.
fn forwards() -> Rig {
    let mut config = config(0);
    config.axes[usize::from(X)].parameters.macs.revers = 2;
    Rig::with(config, [Model::Ideal; 2]).into_enabled()
}

impl Rig {
    fn into_enabled(mut self) -> Self {
        self.enable();
        self
    }
}

/// Sets parameters of the selector: speeds in inc/s, positions in inc.
fn set(rig: &mut Rig, values: &[(&str, i64)]) -> u64 {
    let change = |&(key, value): &(&str, i64)| {
        let (row, entry) = Row::find(&format!("amc.{key}")).expect("a key of the catalogue");
        let value = if entry.default == Value::Real(0.0) { Value::Real(value as f64) } else { Value::Int(value) };
        Change { axis: X, row, value }
    };
    rig.give(Action::SetParameters(values.iter().map(change).collect()))
}

fn refused(rig: &Rig, sequence: u64) -> Option<Code> {
    let refused = |event: &&crate::event::Event| event.kind == Kind::Refused && event.command == sequence;
    rig.events.iter().find(refused).map(|event| event.code)
}

fn warnings(rig: &Rig) -> Vec<Code> {
    rig.events.iter().filter(|event| event.kind == Kind::Warning).map(|event| event.code).collect()
}

/// Returns 34.007 as written, and as in force.
fn selected(rig: &Rig) -> (i64, i64) {
    (rig.machine.parameters(X).unwrap().vocabularies.amc.reference_select, rig.int("x.amc.select"))
}

/// Returns both blocked rigs, the direction that each of them leaves free, and the code of its refusals.
fn blocked_rigs() -> [(Rig, i64, Code); 2] {
    [(on_the_switch(config(0)), -1, Code::LIMIT_VIOLATION), (forwards(), 1, Code::REVERSE_FORBIDDEN)]
}

/// 50 mm/s with 1 m/s^2: the axis stops within 50 ms, with its reference still selected, and continues once that leads
/// back.
///
/// Proves: AMC-SEL-09, MACS-LIM-09, MACS-DIR-06
#[test]
fn a_speed_that_is_turned_to_where_the_axis_may_not_go_stops_it_and_stays_selected() {
    for (mut rig, open, code) in blocked_rigs() {
        set(&mut rig, &[("speed_reference", open * 50_000), ("reference_select", 2)]);
        rig.run(300);
        assert_eq!(rig.real("x.command.velocity"), open as f64 * 50_000.0, "{code:?}");
        rig.mirror();
        let turned = set(&mut rig, &[("speed_reference", -open * 50_000)]);
        assert!(rig.was_accepted(turned), "{code:?}");
        rig.run(50);
        assert_eq!((rig.real("x.command.velocity"), selected(&rig)), (0.0, (2, 2)), "{code:?}");
        rig.run(500);
        assert_eq!((rig.real("x.command.velocity"), rig.int("x.error")), (0.0, 0), "{code:?}");
        assert_eq!(warnings(&rig), [code], "it is told once");
        set(&mut rig, &[("speed_reference", open * 20_000)]);
        rig.run(100);
        assert_eq!((rig.real("x.command.velocity"), selected(&rig)), (open as f64 * 20_000.0, (2, 2)), "{code:?}");
    }
}

/// A selection that is known to be blocked before the cycle is refused as a whole, and the present one continues: for
/// the other references, whether written or triggered, and for the positions of a reference in force.
///
/// Proves: MACS-LIM-09, MACS-DIR-06
#[test]
fn a_selection_that_leads_where_the_axis_may_not_go_is_refused() {
    for (mut rig, open, code) in blocked_rigs() {
        let far = -open * 500_000;
        let still = set(&mut rig, &[("speed_reference", -open * 50_000), ("reference_select", 2)]);
        assert_eq!((refused(&rig, still), selected(&rig)), (Some(code), (0, 0)));
        set(&mut rig, &[("speed_reference", open * 50_000), ("reference_select", 2)]);
        rig.run(300);
        for values in [
            [("position_reference", far), ("reference_select", 1)],
            [("position_reference", far), ("reference_select", 6)],
            [("position_reference", far), ("reference_select_trigger", 1)],
        ] {
            let asked = set(&mut rig, &values);
            assert_eq!((refused(&rig, asked), selected(&rig)), (Some(code), (2, 2)), "{values:?}");
        }
        rig.run(10);
        assert_eq!(rig.real("x.command.velocity"), open as f64 * 50_000.0);
        set(&mut rig, &[("position_reference", -far), ("reference_select", 1)]);
        rig.run(10);
        let asked = set(&mut rig, &[("position_reference", far)]);
        assert_eq!((refused(&rig, asked), selected(&rig), warnings(&rig).len()), (Some(code), (1, 1), 0));
    }
}

/// The switch is reached in the same cycle as the change, which could not be known: the axis does not move on to the
/// previous position.
#[test]
fn a_place_that_is_barred_in_the_cycle_of_its_change_stops_the_axis() {
    let mut rig = Rig::enabled();
    set(&mut rig, &[("position_reference", -500_000), ("reference_select", 1)]);
    rig.run(300);
    rig.modify_inputs = |inputs| {
        for drive in &mut inputs.drive {
            drive.inputs |= inputs::POSITIVE_LIMIT;
        }
    };
    let asked = set(&mut rig, &[("position_reference", 500_000)]);
    assert_eq!((rig.was_accepted(asked), selected(&rig)), (true, (0, 0)));
    assert!(warnings(&rig).contains(&Code::LIMIT_VIOLATION));
    rig.run(101);
    assert_eq!((rig.real("x.command.velocity"), rig.state("x")), (0.0, "STANDSTILL"));
    // A reference that was not in force yet leaves everything unchanged.
    rig.modify_inputs = |_| ();
    set(&mut rig, &[("speed_reference", -50_000), ("reference_select", 2)]);
    rig.run(300);
    rig.modify_inputs = |inputs| {
        for drive in &mut inputs.drive {
            drive.inputs |= inputs::POSITIVE_LIMIT;
        }
    };
    set(&mut rig, &[("position_reference", 600_000), ("reference_select", 1)]);
    rig.run(300);
    assert_eq!((rig.real("x.command.velocity"), selected(&rig)), (-50_000.0, (2, 2)));
}

/// The newest velocity counts: if it is not followed, the previous one is not continued.
#[test]
fn a_stream_that_is_turned_to_where_the_axis_may_not_go_stops_it() {
    let limited = || {
        // It is at rest outside the limit, and moves back only a part of the distance.
        let mut config = config(0);
        config.axes[usize::from(X)].parameters.max_position = Some(-1_000);
        Rig::of(config).into_enabled()
    };
    let limit = (limited(), -1, Code::LIMIT_VIOLATION);
    for (mut rig, open, code) in blocked_rigs().into_iter().chain([limit]) {
        let open = open as f64;
        (0..45).for_each(|_| rig.stream(X, open * 20_000.0));
        assert_eq!((rig.real("x.command.velocity"), warnings(&rig).len()), (open * 20_000.0, 0), "{code:?}");
        // 20 mm/s with half of 1 m/s^2: 40 ms.
        (0..42).for_each(|_| rig.stream(X, -open * 20_000.0));
        assert_eq!(rig.real("x.command.velocity"), 0.0, "{code:?}");
        (0..300).for_each(|_| rig.stream(X, -open * 20_000.0));
        assert_eq!((rig.state("x"), warnings(&rig)), ("STANDSTILL", vec![code]), "it comes, and is told once");
        (0..60).for_each(|_| rig.stream(X, open * 20_000.0));
        assert_eq!(rig.real("x.command.velocity"), open * 20_000.0, "{code:?}");
    }
}

fn jog(rig: &mut Rig, jog: Jog) -> u64 {
    let request =
        Request { axis: X, mode: Some(Mode::Jog), jog: Some(jog), fixed_speed: Some(1), ..Request::default() };
    rig.give(Action::vocabulary(request))
}

/// JOG- was released: its speed is cut, whether JOG+ is followed or not.
///
/// Proves: WF-SET-02, MACS-LIM-09
#[test]
fn jog_reversed_towards_switch_cuts_previous_jog() {
    for interface in [Interface::OpenLoop, Interface::Position] {
        let mut config = config(0);
        config.axes[usize::from(X)].interface = interface;
        config.axes[usize::from(X)].parameters.vocabularies.wf.fixed_speed_1 = 20.0;
        let mut rig = on_the_switch(config);
        let still = jog(&mut rig, Jog::Plus);
        assert_eq!(refused(&rig, still), Some(Code::LIMIT_VIOLATION), "{interface:?}");
        jog(&mut rig, Jog::Minus);
        rig.run(200);
        assert_eq!(rig.real("x.command.velocity"), -20_000.0, "{interface:?}");
        rig.mirror();
        let turned = jog(&mut rig, Jog::Plus);
        assert!(rig.was_accepted(turned), "{interface:?}");
        // Open loop: cut in its cycle. Otherwise deceleration from 20 mm/s with 1 m/s^2.
        rig.run(if interface == Interface::OpenLoop { 0 } else { 20 });
        assert_eq!(rig.real("x.command.velocity"), 0.0, "{interface:?}");
        assert_eq!((warnings(&rig), rig.int("x.wf.q")), (vec![Code::LIMIT_VIOLATION], 0), "{interface:?}");
        rig.run(100);
        assert_eq!((rig.real("x.command.velocity"), rig.int("x.wf.state")), (0.0, 0), "{interface:?}");
        let again = jog(&mut rig, Jog::Plus);
        assert_eq!(refused(&rig, again), Some(Code::LIMIT_VIOLATION), "{interface:?}: it lets go of nothing");
        let back = jog(&mut rig, Jog::Minus);
        assert!(rig.was_accepted(back), "{interface:?}");
        rig.run(100);
        assert_eq!(rig.real("x.command.velocity"), -20_000.0, "{interface:?}");
    }
}
