//! Every kind of error with every `error_reaction` and `endswmod`, compared with the table of docs/errors.md: the
//! expected reaction is read from the page text of the code.

use super::super::rig::{LINE, Rig, X, Y, at, config, couple, saia_verb, to};
use super::page::{ExpectedReaction, Page};
use super::{DOOR, ESTOP, Fault, Numbers, set, ways};
use crate::axis::Wired;
use crate::code::{Class, Code, DRIVE_FAULT};
use crate::command::Action;
use crate::config::{IoConfig, IoKind, MachineConfig};
use crate::drive::{Capabilities, Interface, STATUS_WARNING, control, inputs};
use crate::encoder::{Absolute, Form};
use crate::event::{Kind, Number};
use crate::object::{AxisSet, Leader, Object};
use crate::parameter::Value;
use crate::sim::{Model, TwoSpeed};
use crate::vocabulary::{self, Order, saia};
use std::collections::BTreeSet;

/// Defines the causes of errors, and a list of them.
macro_rules! error_causes {
    ($($way:ident),* $(,)?) => {
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
        enum Way {
            $($way),*
        }

        const ALL: &[Way] = &[$(Way::$way),*];
    };
}

error_causes! {
    Slip,
    OfOther,
    Alarm,
    Jump,
    LeaderLost,
    Homing,
    Switch,
    BothSwitches,
    IntoSwitch,
    Limit,
    LedIntoLimit,
    Cut,
    DriveFault,
    DriveLost,
    DriveOff,
    DriveSilent,
    Door,
    Estop,
    Command,
    OwnCommand,
    Skew,
}

use Way::*;

/// Returns the causes that an axis with this interface can have; `None` is a virtual axis.
fn causes_of(interface: Option<Interface>) -> &'static [Way] {
    match interface {
        Some(Interface::Position) => ALL,
        Some(Interface::Velocity) => &[Cut, Switch, DriveFault, DriveLost, Door, Estop],
        Some(_) => &[OfOther, Alarm, Jump, Switch, BothSwitches, Limit, DriveFault, DriveLost, Door, Estop],
        None => &[LeaderLost, Limit, LedIntoLimit, Door, Estop],
    }
}

/// One machine in which one error occurs.
struct Case {
    interface: Option<Interface>,
    way: Way,
    moving: bool,
    errcond: i64,
    endswmod: i64,
}

impl Case {
    fn axis(&self) -> (u16, &'static str) {
        if self.interface.is_none() { (LINE, "line") } else { (X, "x") }
    }

    fn text(&self) -> String {
        let Case { interface, way, moving, errcond, endswmod } = self;
        format!("{way:?} of {interface:?}, moving {moving}, error_reaction {errcond}, endswmod {endswmod}")
    }

    /// Returns the place by which the page distinguishes cases.
    fn place(&self) -> &'static str {
        match self.interface {
            Some(interface) if interface.closes_loop_here() => "loop closed here",
            _ => "loop in the drive",
        }
    }

    fn rig(&self) -> Rig {
        let mut config = config(0);
        let io = |name: &str, kind| IoConfig { name: name.into(), kind, latch: false };
        config.io = [("estop", IoKind::DigitalInput), ("door", IoKind::DigitalInput)].map(|(n, k)| io(n, k)).into();
        config.io.extend(["error", "hold"].map(|name| io(name, IoKind::DigitalOutput)));
        config.safety = crate::axis::Safety { estop: Some(ESTOP as u32), interlock: Some(DOOR as u32) };
        config.global.parameters.o_error = 1;
        let mut models = [Model::Ideal; 3];
        self.shape(&mut config, &mut models);
        let count = config.count_drives();
        let mut rig = Rig::with(config, models.into_iter().take(count));
        rig.plant.set_digital(ESTOP, true);
        rig.plant.set_digital(DOOR, true);
        if self.way == IntoSwitch {
            rig.plant.drive(0).unwrap().set_stuck_inputs(inputs::POSITIVE_LIMIT, inputs::POSITIVE_LIMIT);
        }
        rig.run(1);
        rig.enable();
        rig
    }

    fn shape(&self, config: &mut MachineConfig, models: &mut [Model; 3]) {
        let (axis, _) = self.axis();
        let axis = &mut config.axes[usize::from(axis)];
        let p = &mut axis.parameters;
        (p.error_reaction, p.supervision.endswmod, p.outputs.brake) = (self.errcond, self.endswmod, 2);
        axis.interface = self.interface.unwrap_or(axis.interface);
        if self.way == Cut {
            axis.wired = Wired::Drive(Form::Absolute(Absolute::single_turn(1 << 20)));
        }
        if self.way == Skew {
            axis.second = Some(Capabilities::all(0));
            (p.gantry.max_skew, p.gantry.skew_reaction) = (Some(200), self.errcond);
        }
        if self.way == Jump {
            p.encoder.max_jump = Some(150);
        }
        match self.interface {
            Some(Interface::Velocity) => p.max_following_error = 20_000,
            Some(Interface::OpenLoop) => {
                models[0] = Model::TwoSpeed(TwoSpeed::new(50_000_000, 20_000_000, 1_000_000).unwrap());
                if self.way == Limit {
                    p.max_position = Some(10_000);
                }
            }
            _ => {}
        }
        if self.way == OfOther {
            config.axes[2].parameters.supervision.following_error_stops_all = 1;
        }
    }

    /// Returns true if the error can occur on an axis at rest.
    fn comes_at_rest(&self) -> bool {
        let has_own_motion = matches!(self.way, LeaderLost | Homing | IntoSwitch | Limit | LedIntoLimit);
        // A contact has nothing to stop on a virtual axis at rest.
        !has_own_motion && self.interface.is_some()
    }

    fn begin(&self, rig: &mut Rig) {
        let (axis, name) = self.axis();
        match self.way {
            // These cases have a motion of their own.
            Homing | Limit | LedIntoLimit | IntoSwitch => return,
            LeaderLost => {
                rig.give(Action::Synchronize(couple(axis, Leader::AxisActual(Y), 1, 1)));
                rig.give(Action::Move(at(Y, 50_000.0)));
            }
            _ if !self.moving => {}
            _ if self.interface == Some(Interface::OpenLoop) => {
                rig.order(X, Order::Speed { velocity: 50_000.0 }).unwrap()
            }
            _ => drop(rig.give(Action::Move(at(axis, 50_000.0)))),
        }
        rig.run(150);
        let moves = self.moving || self.way == LeaderLost;
        let speed = if moves { 50_000.0 } else { 0.0 };
        assert_eq!(rig.real(&format!("{name}.command.velocity")), speed, "{}", self.text());
    }

    /// Causes the error and runs its cycle. Returns the expected code.
    fn cause_error(&self, rig: &mut Rig) -> Code {
        let (axis, name) = self.axis();
        let mut numbers = Numbers(3);
        let drive = rig.plant.drive(0).unwrap();
        let code = match self.way {
            Slip => {
                drive.jump(5_000);
                Code::FOLLOWING_ERROR
            }
            Jump => {
                drive.jump(300);
                Code::ENCODER_JUMP
            }
            Skew => {
                // Above twice max_skew the power is removed with any reaction.
                rig.plant.drive(2).unwrap().jump(300);
                Code::SKEW
            }
            Switch => {
                drive.set_stuck_inputs(inputs::POSITIVE_LIMIT, inputs::POSITIVE_LIMIT);
                Code::HARDWARE_LIMIT_POSITIVE
            }
            BothSwitches => {
                let both = inputs::POSITIVE_LIMIT | inputs::NEGATIVE_LIMIT;
                drive.set_stuck_inputs(both, both);
                Code::BOTH_LIMIT_SWITCHES
            }
            Cut => {
                drive.cut_encoder();
                Code::ENCODER_INVALID
            }
            DriveFault => {
                drive.inject_fault(0x8611);
                Code::drive_fault(0x8611)
            }
            DriveLost => {
                drive.disconnect();
                Code::DRIVE_LOST
            }
            DriveOff => {
                // State switched on only: the enable input of the drive was removed.
                rig.modify_inputs = |inputs| inputs.drive[0].status = 0x23 | inputs.drive[0].status & STATUS_WARNING;
                Code::DRIVE_DISABLED
            }
            DriveSilent => {
                rig.modify_inputs = |inputs| inputs.drive[0].fresh = false;
                rig.run(10);
                Code::DRIVE_STALE
            }
            OfOther => {
                rig.plant.drive(1).unwrap().jump(5_000);
                Code::STOPPED_WITH_OTHER
            }
            LeaderLost => {
                rig.plant.drive(1).unwrap().disconnect();
                Code::LEADER_LOST
            }
            Door => {
                rig.plant.set_digital(DOOR, false);
                Code::INTERLOCK
            }
            Estop => {
                rig.plant.set_digital(ESTOP, false);
                Code::EMERGENCY_STOP
            }
            Alarm => {
                let (found, allowed) = (Number::Position(7), Number::Position(5));
                let code = Code::WF_FOLLOWING_ERROR_IN_TRAVEL;
                rig.order(X, Order::Fail { code, found, allowed }).unwrap();
                code
            }
            Command | OwnCommand => {
                // The verb of the rig starts with registers; the velocity or the start is refused.
                set(rig, "saia.command_error", 2);
                let own = self.way == OwnCommand;
                if own {
                    set(rig, "max_position", rig.int("x.command.position") + 40_000);
                }
                let (load, code) = match own {
                    true => (saia::Command::LoadDestination, Code::ABOVE_MAX_POSITION),
                    false => (saia::Command::LoadVelocity, Code::SAIA_VELOCITY_OUT_OF_RANGE),
                };
                let Action::Vocabulary(vocabulary::Request::Saia(request)) = saia_verb(&[load, saia::Command::Start])
                else {
                    unreachable!()
                };
                let veloc = Value::Int(if own { 20_000 } else { -1 });
                rig.give(Action::vocabulary(request.with(saia::Register::Veloc, veloc)));
                return code;
            }
            Homing => return ways::fail_to_home(rig, &mut numbers, Fault::StuckSwitch),
            Limit | LedIntoLimit if self.interface == Some(Interface::Position) => {
                let fault = if self.way == Limit { Fault::VelocityIntoLimit } else { Fault::LedIntoLimit };
                return ways::run_into_limit(rig, &mut numbers, fault);
            }
            Limit | LedIntoLimit | IntoSwitch => {
                if self.interface.is_none() {
                    let row = crate::parameter::Row::find("max_position").unwrap().0;
                    let change = crate::parameter::Change { axis, row, value: Value::Int(10_000) };
                    rig.give(Action::SetParameters([change].into()));
                }
                match self.way {
                    _ if self.interface == Some(Interface::OpenLoop) => {
                        rig.order(X, Order::Speed { velocity: 50_000.0 }).unwrap();
                    }
                    Limit => drop(rig.give(Action::Move(at(axis, 50_000.0)))),
                    way => {
                        let other = if way == IntoSwitch { LINE } else { Y };
                        let leader = if way == IntoSwitch { Leader::AxisCommand(LINE) } else { Leader::AxisActual(Y) };
                        rig.give(Action::Synchronize(couple(axis, leader, 1, 1)));
                        rig.give(Action::Move(at(other, 50_000.0)));
                    }
                }
                while rig.int(&format!("{name}.error")) == 0 {
                    rig.run(1);
                }
                return if self.way == IntoSwitch { Code::LIMIT_VIOLATION } else { Code::SOFTWARE_LIMIT_POSITIVE };
            }
        };
        rig.run(1);
        code
    }

    /// Returns the state of the axis in the keywords of the page, except for its motion.
    fn shown(&self, rig: &Rig) -> BTreeSet<String> {
        let (axis, name) = self.axis();
        let mut shown = BTreeSet::new();
        if axis == X {
            let power = match rig.outputs().drive[0].control {
                control::DISABLE_VOLTAGE => "no power",
                control::QUICK_STOP => "quick stop",
                control::ENABLE => "power",
                word => panic!("{}: {word:#x}", self.text()),
            };
            shown.insert(power.to_owned());
            assert_eq!(rig.int("x.enabled") == 1, power == "power", "{}", self.text());
        }
        let brake = rig.int("hold") == 1;
        assert_eq!(rig.int(&format!("{name}.brake")) == 1, brake, "{}", self.text());
        if brake {
            shown.insert("brake".to_owned());
        }
        shown
    }

    /// Returns the keywords of the page in the form of [`shown`](Self::shown).
    fn expected(&self, words: &BTreeSet<String>) -> BTreeSet<String> {
        let on =
            |word: &String| if ["stops", "goes on"].contains(&word.as_str()) { "power".into() } else { word.clone() };
        let all = words.iter().map(on);
        all.filter(|word| self.interface.is_some() || word == "brake").collect()
    }

    /// Returns the commanded speed.
    fn speed(&self, rig: &Rig) -> f64 {
        rig.real(&format!("{}.command.velocity", self.axis().1)).abs()
    }

    fn walk(&self, page: &Page) -> Code {
        let (axis, name) = self.axis();
        let text = self.text();
        let mut rig = self.rig();
        self.begin(&mut rig);
        rig.events.clear();
        assert_eq!((rig.int(&format!("{name}.error")), rig.int("error")), (0, 0), "{text}");
        let code = self.cause_error(&mut rig);
        // A refusal by Lineshaft has no reaction of its own.
        let listed = if self.way == OwnCommand { Code::SAIA_VELOCITY_OUT_OF_RANGE } else { code };
        let deed = page.expected_reaction(listed, self.place(), self.errcond, self.endswmod);
        let text = format!("{text}, {}: {deed:?}", code.0);
        let error = i64::from(code.0);
        assert_eq!((rig.int(&format!("{name}.error")), rig.int("error")), (error, 1), "{text}");
        let has = |words: &BTreeSet<String>, word: &str| words.contains(word);
        let goes_on = has(&deed.at_once, "goes on");
        let stops = has(&deed.at_once, "stops") || self.interface.is_none() && !goes_on;
        let begins = self.speed(&rig);
        if stops && begins == 0.0 {
            // A stop that ends in its first cycle has also executed the following action.
            let done = [&deed.at_once, &deed.at_rest].map(|words| self.expected(words));
            assert!(done.contains(&self.shown(&rig)), "{text}: {:?}", self.shown(&rig));
        } else {
            let expected = self.expected(&deed.at_once);
            assert_eq!(
                self.shown(&rig),
                if stops && self.interface.is_none() { BTreeSet::new() } else { expected },
                "{text}"
            );
        }
        // The stop of a homing phase is tested together with homing.
        let slack = if self.way == Homing { 1e6 } else { 1.0 };
        let mut before = begins;
        for _ in 0..120 {
            rig.run(1);
            let now = self.speed(&rig);
            match () {
                () if goes_on => assert!(now == begins || before == 0.0, "{text}: {before} to {now}"),
                () if !stops => assert_eq!(now, 0.0, "{text}"),
                // At a software limit the deceleration may be lower, to end at the limit.
                () if matches!(self.way, Limit | LedIntoLimit) => {
                    assert!(now <= before + 1.0, "{text}: {before} to {now}")
                }
                () => {
                    let next = (before - 1_000.0).max(0.0);
                    assert!((now - next).abs() <= slack, "{text}: {before} to {now} is no stop with 1 inc/ms^2");
                }
            }
            before = now;
        }
        rig.run(60);
        for _ in 0..5_000 {
            // A drive that follows a velocity comes to rest after its command.
            if self.interface == Some(Interface::Velocity) && self.shown(&rig) != self.expected(&deed.at_rest) {
                rig.run(1);
            }
        }
        assert!(goes_on || self.speed(&rig) == 0.0, "{text}: it stands");
        assert_eq!(self.shown(&rig), self.expected(&deed.at_rest), "{text}, at rest");
        let told = rig.events.iter().filter(|event| event.source == Object::Axis(axis) && event.kind == Kind::Error);
        assert_eq!(told.map(|event| event.code).collect::<Vec<_>>(), [code], "{text}: told once");
        assert_eq!(rig.state(name) == "ERROR_STOP", deed.locks, "{text}");
        self.check_reset(&mut rig, deed, &text);
        code
    }

    /// Checks that commands are refused exactly if the axis is locked, and that the reset releases it.
    fn check_reset(&self, rig: &mut Rig, deed: &ExpectedReaction, text: &str) {
        let (axis, name) = self.axis();
        let enable = rig.give(Action::Enable(AxisSet::one(axis)));
        rig.run(1);
        let answers = rig.events.iter().filter(|event| event.command == enable && event.kind == Kind::Refused);
        let refused: Vec<_> = answers.map(|event| event.code).collect();
        assert_eq!(refused, if deed.locks { vec![Code::IN_ERROR] } else { vec![] }, "{text}");
        if self.interface != Some(Interface::OpenLoop) {
            let away = rig.give(Action::Move(at(axis, -10_000.0)));
            let accepted = rig.events.iter().any(|event| event.command == away && event.kind == Kind::Accepted);
            assert_eq!(accepted, !deed.locks, "{text}");
            rig.give(Action::Halt(AxisSet::one(axis)));
        }
        if self.way == Cut {
            // The line stays cut.
            return;
        }
        let error = rig.int(&format!("{name}.error"));
        rig.modify_inputs = |_| {};
        let all = inputs::POSITIVE_LIMIT | inputs::NEGATIVE_LIMIT | inputs::HOME;
        for place in [0, 1] {
            let drive = rig.plant.drive(place).unwrap();
            drive.set_stuck_inputs(all, 0);
            drive.reconnect();
        }
        if self.way == Skew {
            let skew = rig.int("x.skew");
            rig.plant.drive(2).unwrap().jump(-skew);
        }
        rig.plant.set_digital(ESTOP, true);
        rig.plant.set_digital(DOOR, true);
        rig.give(Action::Halt(AxisSet::first(3)));
        rig.run(150);
        assert_eq!(rig.int("error"), 1, "{text}: it stays until it is reset");
        let reset = rig.give(Action::ResetErrors(AxisSet::first(3)));
        rig.run(10);
        assert!(rig.done(reset).iter().all(|done| done.code.is_none()), "{text}");
        assert_eq!((rig.int(&format!("{name}.error")), rig.int("error")), (0, 0), "{text}");
        let powered = deed.at_rest.contains("power") || deed.at_rest.contains("goes on") || axis == LINE;
        assert_eq!(rig.state(name), if powered { "STANDSTILL" } else { "DISABLED" }, "{text}: reset");
        // MACS-IO-05: only a program opens the brake.
        assert_eq!(rig.int("hold") == 1, deed.at_rest.contains("brake"), "{text}: reset");
        rig.give(Action::Enable(AxisSet::first(3)));
        rig.run(40);
        assert_eq!((rig.state(name), rig.int("error")), ("STANDSTILL", 0), "{text}: enabled again");
        if self.interface.is_some_and(|interface| interface != Interface::OpenLoop) {
            // Away from the limit at which the axis has stopped.
            let way = if error == i64::from(Code::SOFTWARE_LIMIT_NEGATIVE.0) { 10 } else { -10 };
            let place = rig.int("x.command.position") + way;
            rig.give(Action::Move(to(X, place)));
            rig.run(50);
            assert_eq!(rig.int("x.command.position"), place, "{text}: it moves again");
        }
    }
}

/// Every row of the page with every value of both parameters, in motion and at rest.
///
/// Proves: MACS-ERR-02, MACS-LIM-08, MACS-IO-07
#[test]
fn every_error_has_the_documented_reaction() {
    let page = Page::read();
    let interfaces = [Some(Interface::Position), Some(Interface::Velocity), Some(Interface::OpenLoop), None];
    let (mut walked, mut count, mut failed) = (BTreeSet::new(), 0, Vec::new());
    for interface in interfaces {
        for &way in causes_of(interface) {
            for (moving, errcond, endswmod) in [true, false]
                .into_iter()
                .flat_map(|moving| (0..6).flat_map(move |errcond| [0, 1].map(|endswmod| (moving, errcond, endswmod))))
            {
                let case = Case { interface, way, moving, errcond, endswmod };
                if !moving && !case.comes_at_rest() {
                    continue;
                }
                let Ok(code) = std::panic::catch_unwind(|| case.walk(&page)) else {
                    failed.push(case.text());
                    continue;
                };
                count += 1;
                walked.extend(page.rows_of(code).iter().map(|row| row.0.clone()));
            }
        }
    }
    println!("{count} errors, each as the page says");
    assert!(failed.is_empty(), "{} fail:\n{}", failed.len(), failed.join("\n"));
    let all: BTreeSet<_> = page.rows.iter().map(|row| row.0.clone()).collect();
    assert_eq!(walked, all, "a row was not walked");
}

#[test]
fn the_page_has_a_row_for_every_code_that_is_an_error() {
    let page = Page::read();
    for row in Code::rows().filter(|row| !row.code.is_none()).chain([&DRIVE_FAULT]) {
        let is_error = row.class != Class::NoError;
        assert_eq!(!page.says[&row.code.0].is_empty(), is_error, "{}", row.name);
        assert_eq!(!page.rows_of(row.code).is_empty(), is_error, "{}", row.name);
        for errcond in if is_error { 0..6 } else { 0..0 } {
            for (place, endswmod) in [("loop in the drive", 0), ("loop closed here", 1)] {
                page.expected_reaction(row.code, place, errcond, endswmod);
            }
        }
    }
}
