//! Taking commands and setpoints, and passing complete cycles to the recorder, neither allocates nor frees memory in
//! the cycle thread, whether the recorder is fast enough or not; a counting allocator checks it.

use assert_no_alloc::{AllocDisabler, assert_no_alloc, violation_count};
use lineshaft::cell::Cell;
use lineshaft::recording::CycleTime;
use lineshaft::run::frames::{Taken, frames};
use lineshaft::run::histogram::Histogram;
use lineshaft::run::lanes::lanes;
use lineshaft::run::trials::trials;
use lineshaft::tune::{Bounds, Ended, Setting, Trial};
use lineshaft_core::command::{Action, Command, Commands, Setpoint, Setpoints, Source};
use lineshaft_core::drive::Backend;
use lineshaft_core::machine::Machine;
use lineshaft_core::object::AxisSet;
use lineshaft_core::parameter::{Change, Value};

#[global_allocator]
static ALLOCATOR: AllocDisabler = AllocDisabler;

/// Two commands with heap data, freed by the receiver of frames, in every fifth cycle.
fn commands(cycle: u64) -> Vec<Command> {
    let change = Change { axis: 1, row: 2, value: Value::Real(5e4) };
    let actions = match cycle % 5 {
        0 => vec![Action::SetParameters(Box::new([change])), Action::Refuse("not like this".into())],
        1 => vec![Action::Enable(AxisSet::first(4))],
        _ => Vec::new(),
    };
    let command = |(number, action)| Command { sequence: number, source: Source::Ros, action };
    (2 * cycle + 1..).zip(actions).map(command).collect()
}

#[test]
fn no_cycle_takes_or_gives_back_memory_for_the_recorder() {
    let cell = Cell::demo();
    let mut plant = cell.plant();
    let mut machine = Machine::new(cell.machine).unwrap();
    let (mut sender, mut receiver, mut spent) = frames(&machine);
    let (mut inputs, mut outputs) = (machine.inputs(), machine.outputs());
    let ((commander, mut lanes), mut taken) = (lanes(4), Taken::default());
    let lateness = Histogram::default();
    for cycle in 0..10_000 {
        for Command { source, action, .. } in commands(cycle) {
            commander.submit(source, action).unwrap();
        }
        if cycle % 3 == 0 {
            let mut set = Setpoints { source: Source::Ros, ..Setpoints::none(4) };
            set.axes[1 + cycle as usize % 2] = Some(Setpoint { velocity: 1e4, duration: None });
            commander.stream(&set).unwrap();
        }
        inputs.cycle = cycle;
        plant.read(&mut inputs);
        assert_no_alloc(|| {
            lanes.take();
            sender.before(&machine);
            machine.cycle(&inputs, lanes.commands(), &mut outputs);
            let (stream, commands) = lanes.drain();
            sender.send(CycleTime::same(cycle), &inputs, &machine, stream, commands);
            lateness.record(cycle * cycle);
        });
        assert_eq!(violation_count(), 0, "in cycle {cycle}");
        plant.write(&outputs);
        spent.free();
        // From cycle 5000 to the end of 7500 the recorder is stopped.
        if !(5000..7500).contains(&cycle) {
            while let Some(head) = receiver.take(&mut taken) {
                head.state.into_iter().for_each(|state| receiver.give_back(state));
            }
        }
    }
    assert_eq!(receiver.lost(), 501, "of 2501 cycles without the recorder 2000 fit");
}

/// From the cycle that begins it to the one that returns it.
#[test]
fn a_trial_takes_no_memory_in_the_cycle_thread() {
    let cell = Cell::parse("torque.yaml", include_str!("../../launch-configs/torque.yaml")).unwrap();
    let mut plant = cell.plant();
    let mut machine = Machine::new(cell.machine).unwrap();
    let config = machine.config();
    let setting = Setting::of(config, "x", |place| config.axes[place].power_on(), &Bounds::default()).unwrap();
    let trial = Trial::new(setting, Source::Ros, config, machine.directory()).unwrap();
    let ((desk, mut slot), (commander, mut lanes)) = (trials(), lanes(1));
    let numbers = commander.numbers();
    let (mut inputs, mut outputs) = (machine.inputs(), machine.outputs());
    let mut begun = Some(trial);
    let mut back = None;
    for cycle in 0..40_000 {
        if cycle == 10 {
            back = begun.take().map(|trial| desk.begin(trial).expect("the first one").1);
        }
        inputs.begin(cycle, 0);
        plant.read(&mut inputs);
        assert_no_alloc(|| {
            let command = slot.before(&machine, &[], true, &numbers);
            lanes.add(Commands::queue(command.as_slice()));
            machine.cycle(&inputs, lanes.commands(), &mut outputs);
            lanes.drain().1.for_each(drop);
        });
        assert_eq!(violation_count(), 0, "in cycle {cycle}");
        plant.write(&outputs);
    }
    desk.collect();
    let trial = back.expect("it was begun").try_recv().expect("it is over");
    assert_eq!(trial.ended(), Some(Ended::Done));
}
