//! The cycle neither allocates nor frees memory in any case: an allocator checks this.

#[path = "no_alloc/actions.rs"]
mod actions;
#[path = "no_alloc/cell.rs"]
mod cell;

use actions::{KINDS, Numbers, action, command, kind, leaving, open, run, trajectory};
use assert_no_alloc::{AllocDisabler, assert_no_alloc, violation_count};
use cell::{absolute, analog, config, long_table, models, slots, table, wild};
use lineshaft_core::code::Code;
use lineshaft_core::command::{
    Action, Command, CommandFunction, Commands, HomeAxis, HomingMethod, SetPosition, Setpoint, Setpoints, Source,
};
use lineshaft_core::config::{MachineConfig, TableConfig};
use lineshaft_core::drive::{Backend, Edge, EncoderInput, Latch};
use lineshaft_core::event::{Event, Kind};
use lineshaft_core::function::{self, Order, TYPES};
use lineshaft_core::machine::Machine;
use lineshaft_core::object::{AxisSet, Object};
use lineshaft_core::parameter::{Change, Layer, Row, Value};
use lineshaft_core::position::Length;
use lineshaft_core::sim::{Fixtures, Index, Plant};
use lineshaft_core::table::{Form as Numbering, MAX_NUMBERS, Table};
use std::collections::BTreeMap;
use std::sync::Arc;

#[global_allocator]
static ALLOCATOR: AllocDisabler = AllocDisabler;

const AXES: u16 = 8;

/// Numbers of commands given and accepted, by kind of action.
#[derive(Default)]
struct Tally(BTreeMap<&'static str, [usize; 2]>);

impl Tally {
    fn count(&mut self, commands: &[Command], events: &[Event]) {
        for Command { sequence, action, .. } in commands {
            let [given, accepted] = self.0.entry(kind(action)).or_default();
            *given += 1;
            *accepted +=
                events.iter().filter(|event| event.kind == Kind::Accepted && event.command == *sequence).count();
        }
    }

    /// Checks that each kind was given and accepted. An invalid request is refused, and a note is answered by its
    /// warning.
    fn is_whole(&self) {
        for kind in KINDS {
            let [given, accepted] = self.0.get(kind).copied().unwrap_or_default();
            let is_answered = accepted > 0 || ["Refuse", "Note"].contains(kind);
            assert!(given > 0 && is_answered, "{kind} was given {given} times and accepted {accepted} times");
        }
    }
}

/// Returns the actual positions of all axes, in file order.
fn actual_positions(machine: &Machine) -> [f64; AXES as usize] {
    std::array::from_fn(|axis| {
        let directory = machine.directory();
        let signal = directory.find(&format!("a{axis}.actual.position")).expect("a signal of each axis");
        machine.board().value(signal, directory.entry(signal).kind).to_f64()
    })
}

#[test]
fn no_cycle_takes_or_gives_back_memory() {
    assert_eq!(cycles_take_and_give_back_no_memory(config()), 0);
}

#[test]
fn no_cycle_of_absolute_encoders_takes_or_gives_back_memory() {
    assert!(cycles_take_and_give_back_no_memory(absolute()) > 0);
}

#[test]
fn no_cycle_of_a_drive_behind_a_voltage_takes_or_gives_back_memory() {
    assert_eq!(cycles_take_and_give_back_no_memory(analog()), 0);
}

/// Runs a cell with random commands and inputs. Returns the number of encoder values that were replaced.
fn cycles_take_and_give_back_no_memory(config: MachineConfig) -> usize {
    let models = models();
    let mut plant = Plant::new(&config, &models);
    let index = Some(Index { every: 2_000, at: 300 });
    let fixtures = Fixtures { index, home: Some((2_000, 4_000)), ..Fixtures::default() };
    (0..7).for_each(|drive| plant.drive(drive).expect("a drive of each axis but the first").install_fixtures(fixtures));
    let mut machine = Machine::new(config).expect("a legal machine");
    let (mut inputs, mut outputs) = (machine.inputs(), machine.outputs());
    let mut kept = machine.state().clone();
    // Orders of functions use their own random numbers, so that the other ones do not depend on them.
    let (mut numbers, mut orders, mut goals, mut openings) = (Numbers(7), Numbers(11), Numbers(13), Numbers(17));
    let mut stream = Setpoints::none(usize::from(AXES));
    let (mut sequence, mut count, mut events, mut marks) = (0, 0_i64, 0, 0);
    // Kept, as their sender does, for as long as the machine may have them.
    let (mut trajectories, mut tables, mut programs, mut runs) = (Vec::new(), Vec::new(), Vec::new(), 0);
    let mut tally = Tally::default();
    let mut started = [0; TYPES.len()];
    let (mut positions, mut moved) = (actual_positions(&machine), [0; AXES as usize]);
    let mut substituted = 0;
    for cycle in 0..40_000_u64 {
        // From time to time all axes and the power are switched off; there are no other commands then.
        let pause = (cycle % 4_000).checked_sub(3_000).filter(|pause| *pause < 500);
        let all = AxisSet::first(usize::from(AXES));
        let planned = match pause {
            Some(0 | 300) => Some(Action::ResetErrors(all)),
            Some(50 | 400) => Some(Action::Disable(all)),
            Some(480) => Some(Action::PowerCycle),
            _ => None,
        };
        let by_chance = if pause.is_some() { 0 } else { numbers.below(40).saturating_sub(37) };
        let actions = (0..by_chance).map(|_| action(&mut numbers, sequence)).collect::<Vec<_>>();
        let mut commands: Vec<Command> = (sequence + 1..)
            .zip(planned.into_iter().chain(actions))
            .map(|(sequence, action)| Command { sequence, source: Source::Scenario, action })
            .collect();
        sequence += commands.len() as u64;
        if pause.is_none() && numbers.below(40) == 0 {
            let trajectory = trajectory(&mut numbers);
            trajectories.push(Arc::clone(&trajectory));
            sequence += 1;
            commands.push(Command { sequence, source: Source::Scenario, action: Action::Trajectory(trajectory) });
        }
        if pause.is_none() && orders.below(25) == 0 {
            sequence += 1;
            commands.push(Command { sequence, source: Source::Scenario, action: command(&mut orders) });
        }
        if pause.is_none() && goals.below(40) == 0 {
            sequence += 1;
            commands.push(Command { sequence, source: Source::Scenario, action: run(&mut goals) });
        }
        if pause.is_none() && openings.below(60) == 0 {
            sequence += 1;
            commands.push(Command { sequence, source: Source::Scenario, action: open(&mut openings) });
        }
        // A coupling is left as soon as it is requested, because later it has usually ended.
        let coupled = commands.iter().find_map(|command| match &command.action {
            Action::Synchronize(request) => Some(request.axis),
            _ => None,
        });
        if let Some(axis) = coupled {
            sequence += 1;
            let action = Action::GearOut(leaving(axis, cycle.cast_signed()));
            commands.push(Command { sequence, source: Source::Scenario, action });
        }
        if pause.is_none() && orders.below(60) == 0 {
            let table = table(2 + orders.below(5) as i64);
            tables.push(Arc::clone(&table));
            sequence += 1;
            let action = Action::LoadTable { index: 0, table };
            commands.push(Command { sequence, source: Source::Scenario, action });
        }
        if pause.is_none() && orders.below(200) == 0 {
            let module = wild();
            programs.push(Arc::clone(&module));
            sequence += 1;
            let action = Action::LoadProgram { index: 0, module, keeps: orders.below(2) == 0 };
            commands.push(Command { sequence, source: Source::Scenario, action });
        }
        if numbers.below(500) == 0
            && let Some(drive) = plant.drive(numbers.below(7) as usize)
        {
            drive.inject_fault(0x1234);
        }
        if numbers.below(700) == 0
            && let Some(drive) = plant.drive(numbers.below(7) as usize)
        {
            // Limit switches change.
            drive.set_stuck_inputs(3, numbers.below(16).saturating_sub(12) as u32);
        }
        if numbers.below(600) == 0
            && let Some(drive) = plant.drive(numbers.below(7) as usize)
        {
            // Some values of its encoder are bad.
            drive.invert_bits(1 << numbers.below(16), numbers.below(5) as u32);
        }
        // The emergency stop is pressed from time to time.
        plant.set_digital(0, numbers.below(3_000) != 0);
        stream.axes[3] = (cycle % 4_000 < 1_000).then_some(Setpoint { velocity: 1_000.0, duration: None });
        inputs.begin(cycle, 0);
        if numbers.below(200) == 0 {
            plant.set_digital(0, numbers.below(2) == 0);
        }
        plant.set_analog(0, numbers.below(10) as f64);
        assert_no_alloc(|| plant.read(&mut inputs));
        count += 20;
        inputs.encoder[0] =
            EncoderInput { count: count & 0xFFFF, epoch: 0, valid: numbers.below(900) != 0, index: None };
        inputs.missed = u32::from(cycle.is_multiple_of(777));
        inputs.add_latch(Latch {
            object: Object::Axis(numbers.below(8) as u16),
            edge: Edge::Rising,
            age_ns: Some(1),
            position: None,
        });
        assert_no_alloc(|| {
            let commands = Commands { stop: &[], queue: &commands, stream: Some(&stream) };
            machine.cycle(&inputs, commands, &mut outputs);
            plant.write(&outputs);
            kept.clone_from(machine.state());
        });
        assert_eq!(violation_count(), 0, "in cycle {cycle}");
        tally.count(&commands, machine.events());
        for (starts, slot) in started.iter_mut().zip(machine.slots()) {
            *starts += usize::from(slot.is_active());
        }
        let before = std::mem::replace(&mut positions, actual_positions(&machine));
        for (cycles, (was, is)) in moved.iter_mut().zip(before.iter().zip(&positions)) {
            *cycles += u32::from(was != is);
        }
        substituted += machine.events().iter().filter(|event| event.code == Code::ENCODER_SUBSTITUTED).count();
        events += machine.events().len();
        let begins = |event: &Event| {
            event.kind == Kind::Accepted
                && commands
                    .iter()
                    .any(|command| command.sequence == event.command && matches!(command.action, Action::Trajectory(_)))
        };
        runs += machine.events().iter().filter(|event| begins(event)).count();
        marks += machine.events().iter().filter(|event| event.kind == Kind::Mark).count();
    }
    assert!(events > 20_000, "a run in which little happens proves little: {events} events");
    assert!(marks > 5, "{marks} marks were found");
    assert!(runs > 10, "{runs} trajectories ran");
    assert!(moved.iter().all(|cycles| *cycles > 500), "cycles in which each axis moved: {moved:?}");
    tally.is_whole();
    drop(machine);
    drop(kept);
    assert!(trajectories.iter().all(|trajectory| Arc::strong_count(trajectory) == 1));
    assert!(tables.iter().all(|table| Arc::strong_count(table) == 1));
    assert!(programs.iter().all(|program| Arc::strong_count(program) == 1));
    assert!(started.iter().all(|starts| *starts > 0), "STARTs of each type: {started:?}");
    substituted
}

/// The check works: an allocation in the cycle is detected.
#[test]
fn allocation_counter_detects_an_allocation() {
    let before = violation_count();
    let bytes = assert_no_alloc(|| std::hint::black_box(vec![1_u8; 16]));
    assert!(violation_count() > before, "{} bytes were taken unseen", bytes.len());
}

/// Layers and the power change at rest, too.
#[test]
fn no_change_of_a_layer_takes_or_gives_back_memory() {
    let config = config();
    let models = models();
    let mut plant = Plant::new(&config, &models);
    let mut machine = Machine::new(config).unwrap();
    let (mut inputs, mut outputs) = (machine.inputs(), machine.outputs());
    let mut image = machine.parameter_image();
    let axes = AxisSet::first(usize::from(AXES));
    let loaded = table(5);
    let actions = [
        Action::SetParameters(Box::new([Change {
            axis: 3,
            row: Row::find("default_velocity").expect("a key of the catalogue").0,
            value: Value::Real(5e4),
        }])),
        Action::SaveParameters(axes),
        Action::CommandFunction(CommandFunction { slot: 0, order: Order::Stage, values: Box::new([(0, 1)]) }),
        Action::LoadTable { index: 0, table: Arc::clone(&loaded) },
        Action::ResetParameters { axes, layer: Layer::Init },
        Action::ResetParameters { axes, layer: Layer::User },
        Action::PowerCycle,
        Action::DeleteParameters(axes),
    ];
    for (sequence, action) in (1..).zip(actions) {
        let commands = [Command { sequence, source: Source::Scenario, action }];
        assert_no_alloc(|| {
            inputs.begin(0, 0);
            plant.read(&mut inputs);
            machine.cycle(&inputs, Commands::queue(&commands), &mut outputs);
            machine.copy_parameters(&mut image);
            plant.write(&outputs);
        });
        assert_eq!(violation_count(), 0, "{:?}", commands[0].action);
        assert!(machine.events().iter().any(|event| event.kind == Kind::Accepted), "{:?}", commands[0].action);
    }
}

#[test]
fn homing_takes_no_memory() {
    let config = config();
    let models = models();
    let mut plant = Plant::new(&config, &models);
    let index = Some(Index { every: 2_000, at: 300 });
    let fixtures = Fixtures { index, home: Some((2_000, 4_000)), positive: Some(30_000), ..Fixtures::default() };
    plant.drive(1).unwrap().install_fixtures(fixtures);
    // The contact of the emergency stop is closed.
    plant.set_digital(0, true);
    let mut machine = Machine::new(config).unwrap();
    let (mut inputs, mut outputs) = (machine.inputs(), machine.outputs());
    let mut homed = Vec::new();
    let home = |method| Action::HomeAxis(HomeAxis { axis: 2, method: HomingMethod::Cia402(method) });
    let row = |key| Row::find(key).expect("a key of the catalogue").0;
    let set = |key, value| Action::SetParameters(Box::new([Change { axis: 2, row: row(key), value }]));
    let position = Length::whole(10_000);
    let actions = [
        Action::Enable(AxisSet::one(2)),
        home(8),
        home(2),
        home(30),
        home(35),
        Action::SetPosition(SetPosition { axis: 2, position }),
        set("homing.in_drive", Value::Int(1)),
        home(10),
        set("homing.in_drive", Value::Int(0)),
        set("homing.index_distance", Value::Int(5)),
        home(33),
    ];
    for (sequence, action) in (1_u64..).zip(actions) {
        let mut commands = vec![Command { sequence, source: Source::Scenario, action }];
        for _ in 0..10_000 {
            assert_no_alloc(|| {
                inputs.begin(machine.next_cycle(), 0);
                plant.read(&mut inputs);
                machine.cycle(&inputs, Commands::queue(&commands), &mut outputs);
                plant.write(&outputs);
            });
            homed.extend(machine.events().iter().filter(|event| event.kind == Kind::Homed).map(|event| event.cycle));
            commands.clear();
        }
    }
    assert_eq!((violation_count(), homed.len()), (0, 6));
}

/// A table is passed by its pointer, whatever its length: its numbers are neither copied nor freed in the cycle.
#[test]
fn a_million_points_change_hands_without_memory() {
    let numbers: Vec<i64> = (0..MAX_NUMBERS as i64).collect();
    let points = |form, x: &[i64]| Arc::new(Table::new(form, x, &numbers).expect("as many as a table may have"));
    let tables = [table(1), points(Numbering::Y, &[]), points(Numbering::Xy, &numbers)];
    let tables = ["w", "y", "xy"].iter().zip(tables).map(|(name, table)| TableConfig { name: (*name).into(), table });
    // A cam reads the words, and gets new ones while it runs.
    let place = slots().iter().position(|slot| slot.kind == function::Kind::Cam).expect("one of each type");
    let slots = vec![slots().swap_remove(place)];
    let mut config = MachineConfig { tables: tables.collect(), slots, masters: Vec::new(), ..config() };
    config.axes.iter_mut().for_each(|axis| axis.pitch_error = None);
    let mut machine = Machine::new(config).expect("a sound machine");
    let (mut inputs, mut outputs) = (machine.inputs(), machine.outputs());
    let mut kept = machine.state().clone();
    let start = CommandFunction { slot: 0, order: Order::Start, values: Box::new([]) };
    let commands = [Command { sequence: 1, source: Source::Ros, action: Action::CommandFunction(start) }];
    machine.cycle(&inputs, Commands::queue(&commands), &mut outputs);
    // The sender of tables keeps them as long as the machine may have them.
    let mut given = Vec::new();
    for turn in 1..4 {
        let loaded = [long_table(turn, MAX_NUMBERS), points(Numbering::Y, &[]), points(Numbering::Xy, &numbers)];
        let action = |(index, table): (u16, &Arc<Table>)| Action::LoadTable { index, table: Arc::clone(table) };
        let commands: Vec<Command> =
            (0..).zip(&loaded).map(action).map(|action| Command { sequence: 2, source: Source::Ros, action }).collect();
        inputs.begin(turn.unsigned_abs(), 0);
        assert_no_alloc(|| {
            machine.cycle(&inputs, Commands::queue(&commands), &mut outputs);
            kept.clone_from(machine.state());
        });
        assert_eq!(violation_count(), 0, "in cycle {turn}");
        assert!(machine.slots()[0].is_active(), "the cam runs");
        assert!(machine.tables().iter().zip(&loaded).all(|(now, given)| Arc::ptr_eq(now, given)), "in cycle {turn}");
        given.push(loaded);
    }
}
