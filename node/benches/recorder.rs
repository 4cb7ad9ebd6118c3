//! Measures the time that the recorder needs in the cycle thread: 64 moving axes, one cycle every 200 us.
//!
//! `cargo bench -p lineshaft --bench recorder`: the cycle alone, then with the transfer of complete cycles to the
//! recorder thread, which keeps the last 10 s (flight recorder) or also writes a bag. Only the time in the cycle thread
//! is measured.

use criterion::{Criterion, criterion_group, criterion_main};
use lineshaft::cell::Cell;
use lineshaft::recording::CycleTime;
use lineshaft::recording::bag::{Bag, BagOptions, Subject};
use lineshaft::recording::encoder::Encoder;
use lineshaft::run::bridge::Handle;
use lineshaft::run::flight::{Flight, folder::FlightFolder};
use lineshaft::run::frames::{FrameSender, frames};
use lineshaft::run::lanes::lanes;
use lineshaft::run::recorder::Recorder;
use lineshaft::run::trials::trials;
use lineshaft_core::command::{Action, BufferMode, Command, Commands, Move, MoveMode, Source};
use lineshaft_core::drive::{Backend, Inputs, Outputs};
use lineshaft_core::machine::Machine;
use lineshaft_core::modulo::Direction;
use lineshaft_core::object::AxisSet;
use lineshaft_core::parameter::ParameterImage;
use lineshaft_core::position::Length;
use lineshaft_core::sim::Plant;
use lineshaft_ros::surface::host::Snapshot;
use std::fmt::Write;
use std::hint::black_box;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::channel;
use std::time::{Duration, Instant};

const AXES: u16 = 64;
/// Five times as fast as the cycle of the cell, and still slow enough for the recorder.
const PERIOD: Duration = Duration::from_micros(200);

fn cell() -> Cell {
    let mut text = "lineshaft: 1\ncycle: 1 ms\nbackends: {plant: {type: sim}}\naxes:\n".to_owned();
    for axis in 0..AXES {
        let limits = "max_velocity: 1 m/s, max_acceleration: 5 m/s^2";
        let drive = format!("drive: {{backend: plant, address: {axis}, interface: position}}");
        let scale = "scale: {increments: 100000, per: 10 mm}";
        let line = format!("  a{axis}: {{type: linear, {scale}, {drive}, {limits}, sim: {{model: ideal}}}}\n");
        text.write_str(&line).expect("writing to a string does not fail");
    }
    Cell::parse("bench.yaml", text).expect("a good cell")
}

/// A machine with all axes in motion.
struct Rig {
    machine: Machine,
    plant: Plant,
    inputs: Inputs,
    outputs: Outputs,
}

impl Rig {
    fn new(cell: &Cell) -> Self {
        let machine = Machine::new(cell.machine.clone()).expect("a good cell");
        let (inputs, outputs) = (machine.inputs(), machine.outputs());
        let mut rig = Self { plant: cell.plant(), machine, inputs, outputs };
        rig.give(vec![Action::Enable(AxisSet::first(usize::from(AXES)))]);
        (0..50).for_each(|_| {
            rig.cycle(&[], None);
        });
        let run = |axis| {
            Action::Move(Move {
                axis,
                mode: MoveMode::Velocity,
                target: Length::default(),
                velocity: 100_000.0 + f64::from(axis),
                acceleration: 0.0,
                deceleration: 0.0,
                jerk: 0.0,
                direction: Direction::Shortest,
                buffer_mode: BufferMode::Aborting,
            })
        };
        rig.give((0..AXES).map(run).collect());
        rig
    }

    fn give(&mut self, actions: Vec<Action>) {
        let command = |(number, action)| Command { sequence: number, source: Source::Cli, action };
        let commands: Vec<Command> = (1..).zip(actions).map(command).collect();
        self.cycle(&commands, None);
    }

    /// Runs a cycle and returns the time that it took in the cycle thread.
    fn cycle(&mut self, commands: &[Command], frames: Option<&mut FrameSender>) -> Duration {
        self.inputs.begin(self.machine.next_cycle(), 0);
        self.plant.read(&mut self.inputs);
        let start = Instant::now();
        if let Some(frames) = frames {
            frames.before(&self.machine);
            self.machine.cycle(&self.inputs, Commands::queue(commands), &mut self.outputs);
            let time = CycleTime::same(self.inputs.cycle * 1_000_000);
            frames.send(time, &self.inputs, &self.machine, None, std::iter::empty());
        } else {
            self.machine.cycle(&self.inputs, Commands::queue(commands), &mut self.outputs);
        }
        let taken = start.elapsed();
        self.plant.write(black_box(&self.outputs));
        taken
    }

    /// Runs `count` cycles at their deadlines.
    fn run(&mut self, count: u64, mut frames: Option<&mut FrameSender>) -> Duration {
        let (start, mut total) = (Instant::now(), Duration::ZERO);
        for beat in 0..count {
            while start.elapsed() < PERIOD * beat as u32 {
                std::hint::spin_loop();
            }
            total += self.cycle(&[], frames.as_deref_mut());
        }
        total
    }
}

/// Measures with a recorder that runs as in `lineshaft run`.
fn recorded(c: &mut Criterion, name: &str, with_bag: bool) {
    let cell = cell();
    let mut rig = Rig::new(&cell);
    let (machine, folder) = (&rig.machine, tempfile::tempdir().expect("a folder for temporary files"));
    let (mut sender, receiver, _spent) = frames(machine);
    let (config, directory) = (machine.config().clone(), machine.directory().clone());
    let encoder = Encoder::new(&cell, &config, &directory);
    let ((commander, _lanes), (ask, asked)) = (lanes(machine.config().axes.len()), channel());
    let handle = Arc::new(Handle::new(
        config,
        directory,
        commander,
        trials().0,
        ask,
        triple_buffer::triple_buffer(&Snapshot::default()).1,
        ParameterImage::default(),
    ));
    let subject = Arc::new(Subject::new(&cell, &cell.ros.node_name()));
    let options = BagOptions { path: folder.path().join("bag"), ..BagOptions::default() };
    let bag = with_bag.then(|| Bag::create(&options, Subject::clone(&subject)).expect("a new bag"));
    let flight =
        (Flight::new(10_000_000_000), FlightFolder::create(folder.path().join("flight"), 1).expect("a folder"));
    let recorder = Recorder::new(handle, receiver, encoder, subject, asked, bag, Some(flight));
    let stop = Arc::new(AtomicBool::new(false));
    let end = Arc::clone(&stop);
    let thread = std::thread::spawn(move || recorder.run(&end));
    c.bench_function(name, |b| b.iter_custom(|count| rig.run(count, Some(&mut sender))));
    stop.store(true, Ordering::Relaxed);
    assert!(thread.join().is_ok(), "the recorder failed");
}

fn costs(c: &mut Criterion) {
    let mut rig = Rig::new(&cell());
    c.bench_function("64 axes, recorder off", |b| b.iter_custom(|count| rig.run(count, None)));
    recorded(c, "64 axes, flight recorder", false);
    recorded(c, "64 axes, flight recorder and bag", true);
}

criterion_group!(benches, costs);
criterion_main!(benches);
