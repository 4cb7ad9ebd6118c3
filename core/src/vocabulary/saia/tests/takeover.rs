//! The vocabulary alone, on a test axis: its behaviour when another owner takes over the axis.

use super::super::{Commands, Phase, Request, Saia};
use super::rig::{FAST, Rig, X, flag};
use crate::code::Code;
use crate::command::Action;
use crate::drive::Interface;
use crate::encoder::Lead;
use crate::event::Refusal;
use crate::object::{AxisSet, Object};
use crate::parameter::AxisParameters;
use crate::position::Position;
use crate::profile::Motion;
use crate::sync::Leads;
use crate::vocabulary::{LatchView, Order, View};

/// An axis whose state the test sets.
pub(super) struct Bench {
    pub parameters: AxisParameters,
    pub cycle: u64,
    pub owns: bool,
    pub on: bool,
    pub in_error: bool,
    pub rests: bool,
    pub command: Motion,
    pub actual: i64,
    pub following_error: i64,
    pub latches: Vec<LatchView>,
    pub index: Option<Position>,
    pub interface: Option<Interface>,
    leads: Leads,
}

impl Bench {
    pub(super) fn of(rig: &Rig) -> Self {
        Self {
            parameters: *rig.machine.parameters(X).unwrap(),
            cycle: 100,
            owns: true,
            on: true,
            in_error: false,
            rests: false,
            command: Motion::default(),
            actual: 0,
            following_error: 0,
            latches: Vec::new(),
            index: None,
            interface: Some(Interface::Position),
            leads: Leads::default(),
        }
    }

    pub(super) fn new() -> Self {
        Self::of(&Rig::ready(FAST))
    }

    pub(super) fn view(&self) -> View<'_> {
        let position = Position::whole(self.actual);
        View {
            object: Object::Axis(X),
            cycle: self.cycle,
            cycle_ns: 1_000_000,
            owns: self.owns,
            owned: false,
            free: self.on && !self.in_error,
            on: self.on,
            closing: false,
            locked: self.in_error,
            in_error: self.in_error,
            error: Code::NONE,
            contact: Code::NONE,
            homing: false,
            search_speed: 0.0,
            homed: false,
            command: self.command,
            present: self.command,
            rests: self.rests,
            idle: self.rests,
            has_end: false,
            target: self.command.position,
            actual: Lead { position, valid: true, uneven: 1.0, ..Lead::default() },
            following_error: self.following_error,
            at_limit: false,
            modulo: None,
            unit: 1000.0,
            interface: self.interface,
            closes_loop: false,
            wiring: crate::vocabulary::Wiring::default(),
            parameters: &self.parameters,
            leads: &self.leads,
            latches: &self.latches,
            index: self.index,
        }
    }

    /// Executes commands without errors. Returns their order.
    pub(super) fn run(&self, saia: &mut Saia, names: &str) -> Option<Order> {
        let commands = Commands::from_iter(names.split_whitespace().map(flag));
        saia.run(&Request { commands, ..Request::default() }, &self.view(), None).unwrap().order
    }

    /// Executes the next cycle.
    pub(super) fn step(&mut self, saia: &mut Saia) -> Option<Order> {
        self.cycle += 1;
        saia.step(&self.view())
    }

    /// Returns a state in POS.
    pub(super) fn moving_state(&self) -> Saia {
        let mut saia = Saia::default();
        self.run(&mut saia, "axinit");
        let order = self.run(&mut saia, "fldda fstart");
        assert!(matches!(order, Some(Order::Position { .. })), "{order:?}");
        saia
    }
}

#[test]
fn vocabulary_yields_to_new_owner_of_axis() {
    for (on, phase) in [(true, Phase::Hold), (false, Phase::Off)] {
        for names in ["", "fforw", "fselom fstart"] {
            let mut bench = Bench::new();
            let mut saia = bench.moving_state();
            bench.parameters.vocabularies.saia.mcw = 0x1C1B;
            bench.run(&mut saia, names);
            (bench.owns, bench.on) = (false, on);
            for _ in 0..3 {
                assert_eq!(bench.step(&mut saia), None);
                assert_eq!((saia.phase, saia.flags.on_dest, saia.profile_done), (phase, true, true));
            }
        }
    }
}

/// Enabled by the command of the contract, the axis holds: the controller is on, and a start finds it on.
#[test]
fn an_axis_that_is_enabled_by_others_is_in_hold() {
    let mut rig = Rig::ready(FAST);
    rig.on();
    assert_eq!((rig.saia_state(), rig.int("x.saia.regulator_off"), rig.int("x.enabled")), ("HOLD", 0, 1));
    rig.does(&[("destp", 100.0)], "fldda fstart");
    rig.run(2);
    assert!(rig.real("x.command.velocity") > 0.0);
}

/// Disabled by that command in motion, the profile ends; only a start switches the drive on again.
#[test]
fn an_axis_that_is_disabled_by_others_is_off() {
    let mut rig = Rig::moving();
    rig.ask([Action::Disable(AxisSet::one(X))]).unwrap();
    rig.run(100);
    assert_eq!((rig.saia_state(), rig.int("x.saia.ondest"), rig.int("x.enabled")), ("OFF", 1, 0));
    rig.run(100);
    assert_eq!(rig.int("x.enabled"), 0);
    rig.does(&[], "fstart");
    rig.run_until("x.saia.ondest", 1);
    assert_eq!(rig.int("x.command.position"), 100_000);
}

#[test]
fn an_error_of_the_axis_ends_a_start_that_waits() {
    let mut bench = Bench::new();
    bench.on = false;
    let mut saia = Saia::default();
    bench.run(&mut saia, "axinit");
    bench.cycle += 1;
    assert_eq!(bench.run(&mut saia, "fldda fstart"), Some(Order::SwitchOn));
    assert_eq!((bench.step(&mut saia), saia.phase), (None, Phase::Position));
    bench.in_error = true;
    assert_eq!((bench.step(&mut saia), saia.phase, saia.flags.on_dest), (None, Phase::Off, true));
    bench.in_error = false;
    bench.on = true;
    assert_eq!((bench.step(&mut saia), saia.phase), (None, Phase::Hold));
    bench.in_error = true;
    let commands = Commands::from_iter([flag("fstart")]);
    let refusal = saia.run(&Request { commands, ..Request::default() }, &bench.view(), None).unwrap_err();
    assert_eq!(refusal.code, Code::IN_ERROR);
}

/// FSM-12 with a start in the same request: off for a cycle, on, and only then the motion.
#[test]
fn a_motor_that_goes_off_and_starts_in_one_verb_is_off_in_between() {
    let mut bench = Bench::new();
    let mut saia = bench.moving_state();
    assert_eq!(bench.run(&mut saia, "fldaa fstart"), Some(Order::SwitchOff));
    bench.on = false;
    assert_eq!(saia.step(&bench.view()), None);
    assert_eq!(bench.step(&mut saia), Some(Order::SwitchOn));
    for _ in 0..5 {
        assert_eq!(bench.step(&mut saia), None);
    }
    bench.on = true;
    bench.rests = true;
    assert!(matches!(bench.step(&mut saia), Some(Order::Position { .. })));
    assert!(!saia.flags.on_dest);
}

#[test]
fn a_stop_while_the_drive_switches_on_ends_the_start() {
    for mcw in [0x21B, 0x41B] {
        let mut bench = Bench::new();
        bench.parameters.vocabularies.saia.mcw = mcw;
        bench.on = false;
        let mut saia = Saia::default();
        bench.run(&mut saia, "axinit");
        bench.cycle += 1;
        bench.run(&mut saia, "fldda fstart");
        bench.step(&mut saia);
        assert_eq!(bench.run(&mut saia, "fstop"), None);
        for on in [false, false, true, true] {
            bench.on = on;
            bench.rests = true;
            assert_eq!((bench.step(&mut saia), saia.phase, saia.flags.on_dest), (None, Phase::Hold, true));
        }
    }
}

#[test]
fn stop_also_stops_motion_of_other_command() {
    let mut bench = Bench::new();
    let mut saia = bench.moving_state();
    bench.owns = false;
    bench.step(&mut saia);
    bench.parameters.vocabularies.saia.mcw = 0x41B;
    assert!(matches!(bench.run(&mut saia, "fstop"), Some(Order::Stop { .. })));
    assert_eq!(saia.phase, Phase::Ramp);
    bench.parameters.vocabularies.saia.mcw = 0x21B;
    assert_eq!(bench.run(&mut saia, "fstop"), Some(Order::HoldActualPosition));
    assert_eq!(saia.phase, Phase::Hold);
    // A step waits until the axis is at rest.
    let commands = Commands::from_iter([flag("fsstepf")]);
    let refusal = saia.run(&Request { commands, ..Request::default() }, &bench.view(), None).unwrap_err();
    assert_eq!(refusal.code, Code::SAIA_STEP_IN_MOTION);
}

#[test]
fn a_start_that_the_axis_cannot_do_once_it_is_on_is_a_command_error() {
    let mut bench = Bench::new();
    let mut saia = bench.moving_state();
    saia.order_failed(Refusal::new(Code::QUICK_STOPPED, Object::Axis(X)));
    assert_eq!((saia.phase, saia.flags.on_dest, saia.errors.count), (Phase::Hold, true, 1));
    bench.rests = true;
    assert_eq!(bench.step(&mut saia), None);
}

/// FStop in HOLD leads to RAMP without registers of a start: such a state is valid.
#[test]
fn every_reachable_state_is_valid() {
    let mut bench = Bench::new();
    bench.parameters.vocabularies.saia.mcw = 0x41B;
    let mut saia = Saia::default();
    assert!(saia.is_sound());
    bench.run(&mut saia, "axinit");
    assert!(saia.is_sound());
    bench.step(&mut saia);
    assert_eq!(saia.phase, Phase::Hold, "switched on by somebody else");
    bench.run(&mut saia, "fstop");
    assert_eq!(saia.phase, Phase::Ramp);
    assert!(saia.is_sound());
    let moving = bench.moving_state();
    assert!(moving.is_sound());
    assert!(!Saia { working: Default::default(), ..moving }.is_sound());
    assert!(!Saia { sample_rest: u64::MAX, ..moving }.is_sound());
    assert!(!Saia { error_limit: -1, ..moving }.is_sound());
}
