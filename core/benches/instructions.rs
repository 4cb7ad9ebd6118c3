//! Instructions of a cycle, by the activity and the number of axes: a figure independent of the load of the host.
//!
//! `cargo bench -p lineshaft-core --bench instructions` runs itself under `valgrind --tool=callgrind`, which counts
//! only inside `Machine::cycle`, and fails if a figure is more than 5 % above the stored one (`instructions.txt`). It
//! measures 1 and 64 axes or slots; the argument `--all-sizes` (`-- --all-sizes` after the command) adds 512 axes and
//! 256 slots. `LINESHAFT_RENEW=1` measures all sizes and stores the figures instead. Two processes run at a time.

mod shop;

use lineshaft_core::axis::{Axis, HOT_BYTES};
use lineshaft_core::command::{Action, Commands, Move, MoveMode};
use lineshaft_core::drive::DriveState;
use lineshaft_core::function::TYPES;
use lineshaft_core::table::Interpolation;
use shop::{Loops, Shop, couple, goal, on_cam};
use std::collections::BTreeMap;
use std::error::Error;
use std::fmt::Write as _;
use std::process;
use std::sync::Mutex;
use std::sync::mpsc::{Sender, channel};
use std::thread;

/// Activity of the axes.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Case {
    /// Switched off.
    Disabled,
    /// On, and at rest.
    Rest,
    /// Moving to a position: accelerating in half of the cycles, at constant velocity in the other half.
    Moving,
    /// At a velocity without end.
    Velocity,
    /// Coupled 355 : 113 to a virtual axis, which is one of them; a single axis has it in addition.
    Geared,
    /// On a cam of 1,001 points of that virtual axis.
    Cam(Interpolation),
    /// At a velocity without end, with loops that are closed here.
    Loops(Loops),
}

impl Case {
    /// Returns the number of leading axes: they have no drive.
    fn leaders(self) -> u16 {
        u16::from(matches!(self, Self::Geared | Self::Cam(_)))
    }
}

const CASES: [(&str, Case); 7] = [
    ("disabled", Case::Disabled),
    ("rest", Case::Rest),
    ("moving", Case::Moving),
    ("velocity", Case::Velocity),
    ("geared", Case::Geared),
    ("on_cam", Case::Cam(Interpolation::Linear)),
    ("spline", Case::Cam(Interpolation::Quintic)),
];
/// Returns the cases of motions and of loops.
fn cases() -> impl Iterator<Item = (&'static str, Case)> {
    CASES.into_iter().chain(Loops::ALL.map(|(name, loops)| (name, Case::Loops(loops))))
}
const AXES: [u16; 3] = [1, 64, 512];
/// Slots that were never started.
const AT_REST: &str = "at_rest";
const SLOTS: [u16; 3] = [1, 64, 256];
/// Largest size measured without `--all-sizes`.
const LARGEST: u16 = 64;
/// Number of simultaneous processes.
const PROCESSES: usize = 2;
/// Cycles before the counted ones, after which commands have taken effect and no transient is left.
const SETTLING: usize = 10;
/// Number of counted cycles.
const CYCLES: usize = 40;
/// Environment variable of the counted process.
const COUNTED: &str = "LINESHAFT_COUNTED";
const STORED: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/benches/instructions.txt");

/// Returns a machine whose axes have the activity to be measured.
fn shop(case: Case, axes: u16) -> Shop {
    let leaders = case.leaders();
    let mut shop = Shop::new(leaders, axes.max(1 + leaders));
    match case {
        Case::Cam(interpolation) => shop = shop.with_cam(interpolation),
        Case::Loops(loops) => shop = shop.with_loops(loops),
        _ => {}
    }
    shop.switch(DriveState::SwitchOnDisabled);
    shop.cycle(Commands::default());
    if case != Case::Disabled {
        shop.enable();
        begin(&mut shop, case, leaders);
    }
    (0..SETTLING).for_each(|_| shop.cycle(Commands::default()));
    shop
}

fn begin(shop: &mut Shop, case: Case, first: u16) {
    let axes = shop.machine.config().axes.len() as u16;
    let action = |axis| match case {
        Case::Geared => couple(axis),
        Case::Cam(_) => on_cam(axis),
        Case::Velocity | Case::Loops(_) => Action::Move(goal(axis, MoveMode::Velocity, 0, 1e5)),
        _ => Action::Move(goal(axis, MoveMode::Absolute, 1_000_000_000, 1.5e5)),
    };
    if case != Case::Rest {
        let actions: Vec<_> = (first..axes).map(action).collect();
        shop.give(&actions);
    }
    // After all of them have coupled, and not faster than they can follow.
    if case.leaders() == 1 {
        let slow = Move { acceleration: 2e6, ..goal(0, MoveMode::Velocity, 0, 1e5) };
        shop.give(&[Action::Move(slow)]);
    }
}

/// Checks that the axes have the activity to be measured.
fn check(shop: &Shop, case: Case) {
    let machine = &shop.machine;
    let wanted = match case {
        Case::Disabled => "DISABLED",
        Case::Rest => "STANDSTILL",
        Case::Moving => "DISCRETE_MOTION",
        Case::Velocity | Case::Loops(_) => "CONTINUOUS_MOTION",
        Case::Geared | Case::Cam(_) => "SYNCHRONIZED_MOTION",
    };
    let place = lineshaft_core::state::AXIS_STATES.iter().position(|name| *name == wanted);
    let last = machine.config().axes.last().map(|axis| axis.name.as_str()).unwrap_or_default();
    let signal = machine.directory().find(&format!("{last}.state")).expect("the state of the last axis");
    assert_eq!(Some(machine.board().int(signal) as usize), place, "{case:?}");
    assert!(machine.events().is_empty(), "{case:?}: {:?}", machine.events());
}

/// Runs the counted cycles. Callgrind sets its counters to 0 on entry into this function, so the figure excludes the
/// set-up.
#[inline(never)]
fn counted_cycles(shop: &mut Shop) {
    (0..CYCLES).for_each(|_| shop.cycle(Commands::default()));
}

/// Runs the set-up and the counted cycles of axes.
fn run(case: Case, axes: u16) {
    let mut shop = shop(case, axes);
    counted_cycles(&mut shop);
    check(&shop, case);
}

/// Runs the set-up and the counted cycles of slots of a type, or of a type at rest.
fn run_slots(name: &str, slots: u16) {
    let named = shop::slots::named(name, slots, true);
    let runs = named.is_some();
    let mut shop = named.unwrap_or_else(|| shop::slots::slots(&TYPES[0], slots, false));
    (0..SETTLING).for_each(|_| shop.cycle(Commands::default()));
    counted_cycles(&mut shop);
    assert!(shop.machine.slots().iter().all(|slot| slot.is_active() == runs), "{name}");
}

/// Returns the instructions of the counted cycles of a process.
fn count(name: &str, axes: u16) -> Result<u64, String> {
    let program = std::env::current_exe().map_err(|error| error.to_string())?;
    let output = process::Command::new("valgrind")
        .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
        .arg("--toggle-collect=lineshaft_core::machine::Machine::cycle*")
        .arg("--zero-before=instructions::counted_cycles*")
        .arg(program)
        .env(COUNTED, format!("{name} {axes}"))
        .output()
        .map_err(|error| format!("valgrind, which counts, does not start ({error}): apt-get install valgrind"))?;
    let said = String::from_utf8_lossy(&output.stderr);
    let counted = said.lines().find_map(|line| line.split_once("Collected : ")?.1.trim().parse().ok());
    match counted {
        Some(counted) if output.status.success() && counted > 0 => Ok(counted),
        _ => Err(format!("valgrind has counted nothing of {name}, {axes} axes:\n{said}")),
    }
}

/// Returns the instructions per axis and cycle.
fn measure(name: &str, axes: u16) -> Result<u64, String> {
    let counted = count(name, axes)?;
    let leaders = cases().find(|(known, _)| *known == name).map_or(0, |(_, case)| case.leaders());
    let axes = axes.max(1 + leaders);
    Ok(counted / (CYCLES as u64 * u64::from(axes)))
}

/// Measures all rows, [`PROCESSES`] at a time. Calls `done` for each in their order.
fn measure_all(
    rows: &[(&'static str, u16)],
    mut done: impl FnMut(&'static str, u16, u64) -> Result<(), Box<dyn Error>>,
) -> Result<(), Box<dyn Error>> {
    let waiting = Mutex::new(rows.iter().enumerate());
    let (send, receive) = channel();
    let work = |send: Sender<_>| {
        let next = || waiting.lock().expect("no thread panics while it holds the lock").next();
        while let Some((place, &(name, axes))) = next() {
            if send.send((place, measure(name, axes))).is_err() {
                return;
            }
        }
    };
    thread::scope(|scope| {
        (0..PROCESSES).for_each(|_| {
            let send = send.clone();
            scope.spawn(move || work(send));
        });
        drop(send);
        // Dropped at the first error, so that the threads end with it.
        let receive = receive;
        let mut figures = BTreeMap::new();
        for (place, &(name, axes)) in rows.iter().enumerate() {
            while !figures.contains_key(&place) {
                let (measured, figure) = receive.recv()?;
                figures.insert(measured, figure?);
            }
            done(name, axes, figures[&place])?;
        }
        Ok(())
    })
}

/// Returns the stored figure of a line.
fn stored(text: &str, name: &str, axes: u16) -> Option<u64> {
    let parts = |line: &str| -> Option<u64> {
        let mut words = line.split_whitespace();
        let is_it = words.next() == Some(name) && words.next()?.parse() == Ok(axes);
        words.next().filter(|_| is_it)?.parse().ok()
    };
    text.lines().find_map(parts)
}

fn main() -> Result<(), Box<dyn Error>> {
    if let Ok(task) = std::env::var(COUNTED) {
        let words: Vec<_> = task.split_whitespace().collect();
        let [name, axes] = words[..] else { return Err("name, axes".into()) };
        let count = axes.parse()?;
        match cases().find(|(known, _)| *known == name) {
            Some((_, case)) => run(case, count),
            None => run_slots(name, count),
        }
        return Ok(());
    }
    let (hot, all) = (HOT_BYTES, size_of::<Axis>());
    println!("state of an axis: {hot} bytes that every cycle touches, {} more", all - hot);
    let before = std::fs::read_to_string(STORED).unwrap_or_default();
    let renews = std::env::var_os("LINESHAFT_RENEW").is_some();
    let has_all_sizes = renews || std::env::args().any(|argument| argument == "--all-sizes");
    let mut text = String::from(
        "# Instructions per axis or slot and cycle: what the axes do or the type of the slots, how many there are, callgrind's figure.\n",
    );
    let mut exceeded = 0;
    let of_axes = cases().flat_map(|(name, _)| AXES.map(|axes| (name, axes)));
    let of_slots = std::iter::once(AT_REST).chain(TYPES.iter().map(|row| row.name));
    let of_slots = of_slots.chain(shop::slots::PROGRAMS.iter().skip(1).map(|(name, _)| *name));
    let of_slots = of_slots.flat_map(|name| SLOTS.map(|slots| (name, slots)));
    let rows: Vec<_> = of_axes.chain(of_slots).filter(|&(_, size)| has_all_sizes || size <= LARGEST).collect();
    measure_all(&rows, |name, axes, figure| {
        writeln!(text, "{name:10} {axes:3} {figure:5}")?;
        let limit = stored(&before, name, axes);
        let is_too_much = limit.is_none_or(|limit| figure * 100 > limit * 105) && !renews;
        exceeded += usize::from(is_too_much);
        let note = match limit {
            Some(limit) if is_too_much => format!("more than 5 % above the stored {limit}"),
            Some(limit) => format!("stored {limit}"),
            None => "not stored".into(),
        };
        let what = if cases().any(|(known, _)| known == name) { "axis" } else { "slot" };
        println!("{name:8} {axes:3}: {figure:5} instructions per {what} and cycle ({note})");
        Ok(())
    })?;
    if renews {
        std::fs::write(STORED, text)?;
    }
    match exceeded {
        0 => Ok(()),
        _ => {
            Err(format!("{exceeded} figures exceed what is stored in {STORED}; LINESHAFT_RENEW=1 stores these").into())
        }
    }
}
