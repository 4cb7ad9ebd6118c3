//! Any requests in any order, with the axis at any position.

use super::bench::{Bench, MAX_VELOCITY, MM, by, to};
use super::rig::Rig;
use crate::command::Action;
use crate::drive::Interface;
use crate::modulo::Modulo;
use crate::object::AxisSet;
use crate::position::{Length, Position};
use crate::vocabulary::wf::steps::Steps;
use crate::vocabulary::wf::{Block, Blocks, Jog, MODES, Mode, Request, Speed, State, Wf, WfSignal};
use proptest::prelude::*;

#[derive(Clone, Debug)]
enum TestEvent {
    Verb(Box<Request>),
    /// The axis is at this position in the next cycle (inc).
    At(i64),
    /// The axis keeps its speed for this number of cycles.
    Coast(u64),
    Wait(u64),
    Lost,
    Off(bool),
    Error(bool),
    Offset(i64),
}

fn mode() -> impl Strategy<Value = Mode> {
    let modes =
        [Mode::Mdi, Mode::Single, Mode::Automatic, Mode::Continuous, Mode::Continuous, Mode::Jog, Mode::ActualValue];
    prop::sample::select(modes.to_vec())
}

fn place() -> impl Strategy<Value = i64> {
    let edges = [0, 1, -1, i64::MAX, i64::MIN, Position::LIMIT, -Position::LIMIT];
    prop_oneof![12 => -400 * MM..400 * MM, 1 => prop::sample::select(edges.to_vec()), 1 => any::<i64>()]
}

fn block() -> impl Strategy<Value = Block> {
    let odd = [0.0, -1.0, 99.5, f64::INFINITY, 1e300];
    let value = prop_oneof![16 => (1..=99).prop_map(f64::from), 1 => prop::sample::select(odd.to_vec())];
    let velocity = prop_oneof![8 => 1000.0..MAX_VELOCITY, 1 => any::<f64>()];
    let speed = prop_oneof![3 => value.prop_map(Speed::Value), 1 => velocity.prop_map(Speed::Velocity)];
    let position = (place(), any::<u32>())
        .prop_map(|(place, rest)| Position::from_raw((i128::from(place) << 32) + i128::from(rest)));
    (position, speed, any::<bool>()).prop_map(|(position, speed, absolute)| Block { position, speed, absolute })
}

fn some<T: Strategy>(of: T) -> impl Strategy<Value = Option<T::Value>> {
    prop::option::weighted(0.3, of)
}

fn request() -> impl Strategy<Value = Request> {
    let jogs = prop::sample::select(&[Jog::None, Jog::Plus, Jog::Minus, Jog::Both][..]);
    let blocks = prop::collection::vec(block(), 0..6).prop_map(|blocks| Blocks::new(&blocks).expect("they fit"));
    let bits = (
        prop::bool::weighted(0.6),
        some(jogs),
        some(any::<bool>()),
        some(any::<u8>()),
        some(prop::bool::weighted(0.8)),
    );
    let parts = (some(mode()), some(blocks), some(0..8_u8), bits, some(place()), prop::bool::weighted(0.05));
    parts.prop_map(|(mode, blocks, block, (start, jog, cam, fixed_speed, enable), value, reset)| {
        let value = value.map(Length::whole);
        match reset {
            true => Request { reset, ..Request::default() },
            false => Request { axis: 0, mode, blocks, block, start, jog, cam, fixed_speed, enable, reset, value },
        }
    })
}

fn happening() -> impl Strategy<Value = TestEvent> {
    prop_oneof![
        10 => request().prop_map(|request| TestEvent::Verb(Box::new(request))),
        6 => place().prop_map(TestEvent::At),
        12 => (0..800_u64).prop_map(TestEvent::Coast),
        3 => (0..150_u64).prop_map(TestEvent::Wait),
        1 => Just(TestEvent::Lost),
        1 => any::<bool>().prop_map(TestEvent::Off),
        1 => any::<bool>().prop_map(TestEvent::Error),
        1 => place().prop_map(TestEvent::Offset),
    ]
}

impl Bench {
    fn happen(&mut self, happening: &TestEvent) {
        match happening {
            TestEvent::Verb(request) => {
                // A refused request changes nothing.
                let before = self.wf;
                if self.give(request).is_err() {
                    assert_eq!(format!("{:?}", self.wf), format!("{before:?}"));
                }
            }
            TestEvent::At(actual) => drop(self.at(*actual)),
            TestEvent::Coast(cycles) => {
                for _ in 0..*cycles {
                    let way = (self.velocity * self.cycle_ns as f64 / 1e9) as i64;
                    self.at(self.actual.wrapping_add(way));
                    self.check();
                }
            }
            TestEvent::Wait(cycles) => drop(self.wait(*cycles)),
            TestEvent::Lost => (self.owns, self.velocity) = (false, 0.0),
            TestEvent::Off(off) => (self.on, self.velocity) = (!off, if *off { 0.0 } else { self.velocity }),
            TestEvent::Error(error) => {
                (self.in_error, self.velocity) = (*error, if *error { 0.0 } else { self.velocity });
                if !*error {
                    self.wf.take_reset();
                }
            }
            TestEvent::Offset(offset) => {
                self.parameters.vocabularies.wf.zero_offset = (*offset).clamp(-MM * 1000, MM * 1000)
            }
        }
        self.wait(1);
    }

    /// Checks the conditions that hold after every cycle.
    fn check(&self) {
        let (state, speed, q, enable) = self.now();
        let runs = ["RUN", "STEP1", "STEP2", "STEP3"].contains(&state);
        assert_eq!((q == 1, enable == 1, speed > 0.0), (runs, runs, runs), "{state}");
        assert!(runs || (self.velocity == 0.0 && self.int(WfSignal::G) == 0), "{state}");
        assert!((0.0..=99.0).contains(&speed) && speed.fract() == 0.0);
        assert!(self.wf.is_sound());
        if runs && self.int(WfSignal::Mode) != Mode::Jog as i64 {
            // No slower step is reached: within the distances, speeds only decrease.
            let left = self.wf.set.nearest().saturating_sub(self.actual).saturating_mul(self.wf.direction.into());
            assert_eq!(Steps::of(&self.parameters).step_at(speed as i64, left), None, "{state} {speed} {left}");
        }
    }
}

fn bench(rotary: bool, limits: bool) -> Bench {
    let mut bench = Bench::new();
    bench.modulo = Modulo::new(200 * MM, 1).filter(|_| rotary);
    if limits {
        (bench.parameters.min_position, bench.parameters.max_position) = (Some(-300 * MM), Some(300 * MM));
    }
    bench
}

fn round_trip(wf: &Wf) -> Wf {
    let bytes = postcard::to_allocvec(wf).expect("bytes");
    postcard::from_bytes(&bytes).expect("a state")
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(500))]

    #[test]
    fn an_open_loop_axis_is_off_whenever_nothing_runs_and_only_slows_down_before_its_target(
        happenings in prop::collection::vec(happening(), 1..60), rotary: bool, limits: bool,
    ) {
        let mut bench = bench(rotary, limits);
        let mut other = self::bench(rotary, limits);
        for happening in &happenings {
            bench.happen(happening);
            bench.check();
            // A state that was saved and restored continues in the same way.
            other.wf = round_trip(&other.wf);
            other.happen(happening);
            prop_assert_eq!(bench.wf, other.wf);
            prop_assert_eq!(bench.velocity, other.velocity);
        }
    }

    #[test]
    fn no_state_that_was_changed_makes_a_cycle_panic(
        before in prop::collection::vec(happening(), 1..12),
        changes in prop::collection::vec((any::<usize>(), any::<u8>()), 1..4),
        after in prop::collection::vec(happening(), 1..12),
        closed: bool,
    ) {
        let mut bench = bench(false, true);
        before.iter().for_each(|happening| bench.happen(happening));
        let mut bytes = postcard::to_allocvec(&bench.wf).expect("bytes");
        for (place, byte) in changes {
            let place = place % bytes.len();
            bytes[place] = byte;
        }
        if let Ok(wf) = postcard::from_bytes::<Wf>(&bytes) && wf.is_sound() {
            bench.wf = wf;
            for happening in &after {
                match happening {
                    TestEvent::Verb(request) => bench.run_ignoring_result(closed, Some(request)),
                    TestEvent::At(actual) => {
                        bench.actual = *actual;
                        bench.run_ignoring_result(closed, None);
                    }
                    _ => bench.run_ignoring_result(closed, None),
                }
            }
        }
    }
}

impl Bench {
    /// Executes a request or a step, and ignores the result.
    fn run_ignoring_result(&mut self, closed: bool, request: Option<&Request>) {
        self.interface = if closed { Interface::Position } else { Interface::OpenLoop };
        self.owns = true;
        self.give_blindly(request);
    }
}

/// Action on a machine.
#[derive(Clone, Debug)]
enum MachineAction {
    Verb(Box<Request>),
    Cycles(u64),
    Halt,
    Enable,
    Mirror,
    Jump(i64),
}

fn chain() -> impl Strategy<Value = Request> {
    let block = (-300..300_i64, 1..=100_i32, any::<bool>());
    let block = block.prop_map(|(place, speed, absolute)| match absolute {
        true => to(place, speed.into()),
        false => by(place, speed.into()),
    });
    (prop::collection::vec(block, 1..=16), prop::bool::weighted(0.8)).prop_map(|(blocks, continuous)| {
        let mode = if continuous { Mode::Continuous } else { Mode::Automatic };
        Request { start: true, mode: Some(mode), blocks: Blocks::new(&blocks), ..Request::default() }
    })
}

fn deed() -> impl Strategy<Value = MachineAction> {
    prop_oneof![
        6 => chain().prop_map(|request| MachineAction::Verb(Box::new(request))),
        3 => request().prop_map(|request| MachineAction::Verb(Box::new(request))),
        8 => (0..3000_u64).prop_map(MachineAction::Cycles),
        1 => Just(MachineAction::Halt),
        1 => Just(MachineAction::Enable),
        1 => Just(MachineAction::Mirror),
        1 => (-2000..2000_i64).prop_map(MachineAction::Jump),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    /// On a whole machine, compared with a second one that is restored from its state.
    #[test]
    fn a_closed_loop_axis_keeps_the_speed_of_each_block_and_comes_to_rest(
        deeds in prop::collection::vec(deed(), 1..12)
    ) {
        let mut rig = Rig::wf();
        for deed in &deeds {
            match deed {
                MachineAction::Verb(request) => drop(rig.wf_verb(request)),
                MachineAction::Cycles(cycles) => (0..*cycles).for_each(|_| rig.run_watched()),
                MachineAction::Halt => drop(rig.act(Action::Halt(AxisSet::first(1)))),
                MachineAction::Enable => {
                    rig.act(Action::ResetErrors(AxisSet::first(1)));
                    rig.run(5000);
                    rig.act(Action::Enable(AxisSet::first(1)));
                }
                MachineAction::Mirror => rig.mirror(),
                MachineAction::Jump(by) => rig.plant.drive(0).expect("a drive").jump(*by),
            }
        }
        rig.wf_verb(&Request { enable: Some(false), ..Request::default() });
        rig.run(6000);
        prop_assert_eq!(rig.real("x.command.velocity"), 0.0);
        prop_assert!(["IDLE", "DONE", "ALARM"].contains(&rig.wf_state()), "{}", rig.wf_state());
    }
}

impl Rig {
    /// Executes a cycle in which no block exceeds its speed.
    fn run_watched(&mut self) {
        self.run(1);
        let block = self.int("x.wf.block");
        let chain = self.wf_state() == "RUN" && block > 0 && MODES[self.int("x.wf.mode") as usize] != "JOG";
        if chain && self.int("x.wf.active") == 1 {
            let most = self.real("x.wf.speed") / 100.0 * 500_000.0;
            let speed = self.real("x.command.velocity").abs();
            assert!(speed <= most * (1.0 + 1e-9) + 1e-3, "block {block}: {speed} instead of {most}");
        }
    }
}

/// The initial state, which the random tests above never restore: it must be valid.
#[test]
fn a_new_vocabulary_is_sound_and_idle() {
    let wf = Wf::default();
    assert!(wf.is_sound() && wf.state == State::Idle && round_trip(&wf) == wf);
}
