//! Passes a trial into the cycle thread and back.
//!
//! Law      one trial at a time. It is passed in by one ring buffer and back by another, so that the cycle thread
//!          neither allocates nor frees; its command is the last one of its cycle. If a cycle has no room for the
//!          command, or cycles end, the trial ends
//! Reads    the inputs of the trial, and whether it was cancelled
//! Writes   commands, the displayed progress
//! Refuses  a second trial at the same time

use super::lanes::Numbers;
use crate::tune::{Doing, Stop, Trial};
use lineshaft_core::command::{Action, Command};
use lineshaft_core::machine::Machine;
use lineshaft_ros::surface::host::{TuningPhase, TuningWatch};
use rtrb::{Consumer, Producer, RingBuffer};
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use tokio::sync::oneshot;

/// Steps of the displayed progress.
const STEPS: f64 = 1000.0;
/// Factor for a number that contains progress and phase.
const PHASES: u32 = 8;

/// Progress of a trial: written by the cycle thread, read by other threads.
#[derive(Debug, Default)]
pub struct Watch {
    /// Progress and phase, in one atomic so that they are consistent.
    shown: AtomicU32,
    is_cancelled: AtomicBool,
}

impl Watch {
    fn show(&self, (doing, progress): (Doing, f64)) {
        let phase = match doing {
            Doing::Enabling => TuningPhase::Enabling,
            Doing::Exciting => TuningPhase::Exciting,
            Doing::Disabling => TuningPhase::Disabling,
            Doing::Nothing => TuningPhase::Designing,
        };
        let steps = (progress.clamp(0.0, 1.0) * STEPS) as u32;
        self.shown.store(steps * PHASES + phase as u32, Ordering::Relaxed);
    }
}

impl TuningWatch for Watch {
    fn progress(&self) -> (TuningPhase, f64) {
        let shown = self.shown.load(Ordering::Relaxed);
        let phase = [TuningPhase::Exciting, TuningPhase::Disabling, TuningPhase::Designing];
        let phase = phase.into_iter().find(|&phase| phase as u32 == shown % PHASES);
        (phase.unwrap_or(TuningPhase::Enabling), f64::from(shown / PHASES) / STEPS)
    }

    fn cancel(&self) {
        self.is_cancelled.store(true, Ordering::Relaxed);
    }
}

/// A trial with its progress.
#[derive(Debug)]
struct RunningTrial {
    trial: Trial,
    watch: Arc<Watch>,
}

/// End at which trials are begun and collected.
#[derive(Debug)]
pub struct TrialSender(Mutex<TrialChannel>);

#[derive(Debug)]
struct TrialChannel {
    to: Producer<Box<RunningTrial>>,
    from: Consumer<Box<RunningTrial>>,
    /// Index of its axis, and the receiver of the current trial.
    waiting: Option<(u16, oneshot::Sender<Trial>)>,
}

/// End in the cycle thread.
#[derive(Debug)]
pub struct TrialSlot {
    coming: Consumer<Box<RunningTrial>>,
    going: Producer<Box<RunningTrial>>,
    tried: Option<Box<RunningTrial>>,
}

/// Creates both ends.
pub fn trials() -> (TrialSender, TrialSlot) {
    let ((to, coming), (going, from)) = (RingBuffer::new(1), RingBuffer::new(1));
    (TrialSender(Mutex::new(TrialChannel { to, from, waiting: None })), TrialSlot { coming, going, tried: None })
}

impl TrialSender {
    fn desk(&self) -> MutexGuard<'_, TrialChannel> {
        // Between two complete steps the rings are valid.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Returns the index of the axis that is being tuned, if any.
    pub fn busy(&self) -> Option<u16> {
        self.desk().waiting.as_ref().map(|(axis, _)| *axis)
    }

    /// Begins a trial; it is returned at its end.
    ///
    /// # Errors
    /// Returns the index of the axis of another trial, if one is running.
    pub fn begin(&self, trial: Trial) -> Result<(Arc<Watch>, oneshot::Receiver<Trial>), u16> {
        let mut desk = self.desk();
        if let Some((axis, _)) = desk.waiting {
            return Err(axis);
        }
        let watch = Arc::<Watch>::default();
        let (axis, (answer, answered)) = (trial.setting().axis, oneshot::channel());
        // No trial is running, so the ring is empty.
        let pushed = desk.to.push(Box::new(RunningTrial { trial, watch: Arc::clone(&watch) }));
        if pushed.is_ok() {
            desk.waiting = Some((axis, answer));
        }
        Ok((watch, answered))
    }

    /// Passes a finished trial to its receiver.
    pub fn collect(&self) {
        let mut desk = self.desk();
        let Ok(tried) = desk.from.pop() else { return };
        if let Some((_, answer)) = desk.waiting.take() {
            // The receiver may have gone.
            let _ = answer.send(tried.trial);
        }
    }
}

impl TrialSlot {
    /// Whether there is a trial, running or to begin.
    pub fn is_busy(&self) -> bool {
        self.tried.is_some() || !self.coming.is_empty()
    }

    /// Returns the command of the trial for this cycle, in addition to these stops; `has_room`: the cycle has room for
    /// a command.
    pub fn before(
        &mut self,
        machine: &Machine,
        stops: &[Command],
        has_room: bool,
        numbers: &Numbers,
    ) -> Option<Command> {
        if self.tried.is_none() {
            self.tried = self.coming.pop().ok();
        }
        let RunningTrial { trial, watch } = &mut **self.tried.as_mut()?;
        let axis = trial.setting().axis;
        // For an axis at standstill, or while it is being switched on, a halt has no visible effect.
        if stops.iter().any(|command| stops_axis(&command.action, axis)) {
            trial.stop(Stop::Halt);
        }
        if watch.is_cancelled.load(Ordering::Relaxed) {
            trial.stop(Stop::Cancel);
        }
        // A skipped cycle would be missing in the record.
        if !has_room {
            trial.stop(Stop::NoRoom);
        }
        let command = if has_room { trial.before(machine, || numbers.reserve(1) + 1) } else { None };
        watch.show(trial.progress());
        if trial.ended().is_some() {
            self.give_back();
        }
        command
    }

    /// Ends the trial because no more cycles run, whether it has begun or not.
    pub fn give_up(&mut self) {
        if self.tried.is_none() {
            self.tried = self.coming.pop().ok();
        }
        if let Some(tried) = &mut self.tried {
            tried.trial.give_up();
            self.give_back();
        }
    }

    fn give_back(&mut self) {
        if let Some(tried) = self.tried.take()
            && let Err(rtrb::PushError::Full(tried)) = self.going.push(tried)
        {
            // The ring has room for it once the previous trial was collected.
            self.tried = Some(tried);
        }
    }
}

fn stops_axis(action: &Action, axis: u16) -> bool {
    match action {
        Action::Halt(axes) | Action::QuickStop(axes) | Action::Disable(axes) => axes.contains(axis),
        other => other.stops(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cell::Cell;
    use crate::run::lanes::lanes;
    use crate::tune::{Bounds, Ended, Setting};
    use lineshaft_core::command::{Action, Commands, Source};
    use lineshaft_core::drive::{Backend, DriveState};
    use lineshaft_core::object::AxisSet;
    use lineshaft_core::request::SynchronizeRequest;
    use lineshaft_core::sim::Plant;

    const CELL: &str = include_str!("../../../launch-configs/torque.yaml");

    /// A machine with its trial slot.
    struct Rig {
        machine: Machine,
        plant: Plant,
        slot: TrialSlot,
        desk: TrialSender,
        numbers: Numbers,
        actions: Vec<Action>,
    }

    impl Rig {
        fn new() -> Self {
            Self::of(CELL)
        }

        fn of(cell: &str) -> Self {
            let cell = Cell::parse("torque.yaml", cell).unwrap_or_else(|problems| panic!("{problems}"));
            let plant = cell.plant();
            let machine = Machine::new(cell.machine).expect("a machine");
            let (desk, slot) = trials();
            Self { machine, plant, slot, desk, numbers: lanes(1).0.numbers(), actions: Vec::new() }
        }

        fn trial(&self) -> Trial {
            let config = self.machine.config();
            let setting = Setting::of(config, "x", |place| config.axes[place].power_on(), &Bounds::default());
            Trial::new(setting.expect("fit"), Source::Ros, config, self.machine.directory()).expect("a trial")
        }

        fn run(&mut self, cycles: usize, has_room: bool) {
            self.run_with(cycles, has_room, &[]);
        }

        /// Runs cycles, each with these stops.
        fn run_with(&mut self, cycles: usize, has_room: bool, stops: &[Command]) {
            let (mut inputs, mut outputs) = (self.machine.inputs(), self.machine.outputs());
            for _ in 0..cycles {
                inputs.begin(self.machine.next_cycle(), 0);
                let command = self.slot.before(&self.machine, stops, has_room, &self.numbers);
                self.actions.extend(command.iter().map(|command| command.action.clone()));
                self.plant.read(&mut inputs);
                let commands = Commands { stop: stops, ..Commands::queue(command.as_slice()) };
                self.machine.cycle(&inputs, commands, &mut outputs);
                self.plant.write(&outputs);
                self.desk.collect();
            }
        }

        /// Sends commands to the axis directly.
        fn command(&mut self, actions: &[Action]) {
            let (mut inputs, mut outputs) = (self.machine.inputs(), self.machine.outputs());
            inputs.begin(self.machine.next_cycle(), 0);
            self.plant.read(&mut inputs);
            let commands: Vec<_> = actions.iter().map(|action| self.numbered(action.clone())).collect();
            self.machine.cycle(&inputs, Commands::queue(&commands), &mut outputs);
            self.plant.write(&outputs);
        }

        fn numbered(&self, action: Action) -> Command {
            Command { sequence: self.numbers.reserve(1) + 1, source: Source::Ros, action }
        }

        fn bit(&self, name: &str) -> bool {
            self.machine.board().bit(self.machine.directory().find(name).expect("a signal"))
        }

        /// Whether the drive has no power.
        fn is_off(&self) -> bool {
            let state = self.machine.directory().find("x.drive_state").expect("a signal");
            !self.bit("x.enabled") && self.machine.board().int(state) == DriveState::SwitchOnDisabled as i64
        }
    }

    #[test]
    fn one_trial_at_a_time_is_returned_with_its_record() {
        let mut rig = Rig::new();
        rig.run(10, true);
        let (watch, mut back) = rig.desk.begin(rig.trial()).expect("the first one");
        assert_eq!(watch.progress(), (TuningPhase::Enabling, 0.0));
        assert_eq!(rig.desk.begin(rig.trial()).err(), Some(0), "one at a time");
        rig.run(2000, true);
        let (phase, begun) = watch.progress();
        assert_eq!(phase, TuningPhase::Exciting);
        rig.run(4000, true);
        assert!(begun < watch.progress().1, "{begun}");
        rig.run(30_000, true);
        let trial = back.try_recv().expect("it is over");
        assert_eq!((trial.ended(), watch.progress()), (Some(Ended::Done), (TuningPhase::Designing, 1.0)));
        assert!(trial.record().commands.len() > 6000, "{}", trial.record().commands.len());
        assert!(rig.is_off() && !rig.slot.is_busy());
        assert!(rig.desk.begin(rig.trial()).is_ok(), "the next one");
    }

    #[test]
    fn who_cancels_it_finds_the_axis_off() {
        let mut rig = Rig::new();
        rig.run(10, true);
        let (watch, mut back) = rig.desk.begin(rig.trial()).expect("the first one");
        rig.run(3000, true);
        assert!(rig.bit("x.enabled"));
        watch.cancel();
        rig.run(3000, true);
        assert_eq!(back.try_recv().expect("it is over").ended(), Some(Ended::Stopped(Stop::Cancel)));
        assert!(rig.is_off());
        assert_eq!(rig.actions.last(), Some(&Action::Disable(AxisSet::one(0))));
        // A trial that is cancelled before it begins moves nothing.
        let (watch, mut back) = rig.desk.begin(rig.trial()).expect("the next one");
        watch.cancel();
        rig.actions.clear();
        rig.run(10, true);
        assert_eq!(back.try_recv().expect("it is over").ended(), Some(Ended::Stopped(Stop::Cancel)));
        assert_eq!(rig.actions, []);
    }

    /// With a slow brake it takes many cycles to switch on the axis, during which its state is that of a disabled one.
    #[test]
    fn stop_while_enabling_disables_the_axis() {
        let cell =
            CELL.replace("    sim:\n", "    brake: {output: b, release_delay: 20 ms, engage_delay: 20 ms}\n    sim:\n");
        let cell = cell.replace("axes:\n", "io: {b: {type: do, backend: plant, address: 0}}\naxes:\n");
        for cycle in 0..80 {
            let mut rig = Rig::of(&cell);
            rig.run(10, true);
            let (watch, mut back) = rig.desk.begin(rig.trial()).expect("the first one");
            rig.run(cycle, true);
            watch.cancel();
            rig.run(400, true);
            assert_eq!(back.try_recv().expect("it is over").ended(), Some(Ended::Stopped(Stop::Cancel)), "{cycle}");
            assert!(rig.is_off(), "{cycle}");

            for stop in [Action::Halt, Action::QuickStop, Action::Disable] {
                let mut rig = Rig::of(&cell);
                rig.run(10, true);
                let (_, mut back) = rig.desk.begin(rig.trial()).expect("the first one");
                rig.run(cycle, true);
                let stops = [rig.numbered(stop(AxisSet::one(0)))];
                rig.run_with(1, true, &stops);
                rig.run(400, true);
                assert_eq!(back.try_recv().expect("it is over").ended(), Some(Ended::Stopped(Stop::Halt)), "{cycle}");
                assert!(rig.is_off(), "{cycle}");
            }
        }
    }

    /// Stops of another axis have no effect; an axis that is on already is stopped even in the cycle in which its loop
    /// would open.
    #[test]
    fn a_stop_of_its_own_axis_alone_ends_it() {
        let mut rig = Rig::new();
        rig.run(10, true);
        let (_, mut back) = rig.desk.begin(rig.trial()).expect("the first one");
        let other = [rig.numbered(Action::Halt(AxisSet::one(1)))];
        rig.run_with(3000, true, &other);
        assert!(back.try_recv().is_err() && rig.bit("x.enabled"));
        for cycle in 0..4 {
            let mut rig = Rig::new();
            rig.run(10, true);
            rig.command(&[Action::Enable(AxisSet::one(0))]);
            rig.run(50, true);
            assert!(rig.bit("x.enabled"));
            let (_, mut back) = rig.desk.begin(rig.trial()).expect("the first one");
            rig.run(cycle, true);
            let stops = [rig.numbered(Action::Halt(AxisSet::one(0)))];
            rig.run_with(1, true, &stops);
            rig.run(400, true);
            assert_eq!(back.try_recv().expect("it is over").ended(), Some(Ended::Stopped(Stop::Halt)), "{cycle}");
        }
    }

    #[test]
    fn an_axis_that_leads_others_is_not_shaken() {
        let follower = "  y: {type: rotary, drive: virtual, scale: {increments: 65536, per: 1 rev}, max_velocity: 50 rev/s, max_acceleration: 400 rev/s^2}\n";
        let mut rig = Rig::of(&(CELL.to_owned() + follower));
        rig.run(10, true);
        let couple = rig.machine.config().resolve_synchronize(&SynchronizeRequest {
            axis: "y".to_owned(),
            master: "x.actual".to_owned(),
            mode: 1,
            numerator: 1,
            denominator: 1,
            ..SynchronizeRequest::default()
        });
        rig.command(&[Action::Synchronize(couple.expect("a coupling"))]);
        rig.run(10, true);
        let (_, mut back) = rig.desk.begin(rig.trial()).expect("the first one");
        rig.actions.clear();
        rig.run(5, true);
        assert_eq!(back.try_recv().expect("it is over").ended(), Some(Ended::Leads(1)));
        assert_eq!(rig.actions, []);
    }

    #[test]
    fn without_room_for_its_command_it_ends() {
        let mut rig = Rig::new();
        rig.run(10, true);
        let (_, mut back) = rig.desk.begin(rig.trial()).expect("the first one");
        rig.run(3000, true);
        rig.run(1, false);
        rig.run(3000, true);
        assert_eq!(back.try_recv().expect("it is over").ended(), Some(Ended::Stopped(Stop::NoRoom)));
        assert!(rig.is_off());
    }

    #[test]
    fn trial_is_returned_when_the_cycles_end() {
        for cycles in [0, 100, 3000] {
            let mut rig = Rig::new();
            rig.run(10, true);
            let (_, mut back) = rig.desk.begin(rig.trial()).expect("nothing is under way");
            rig.run(cycles, true);
            rig.slot.give_up();
            rig.desk.collect();
            assert_eq!(back.try_recv().expect("it is over").ended(), Some(Ended::Stopped(Stop::NoCycles)), "{cycles}");
            assert!(!rig.slot.is_busy());
        }
    }
}
