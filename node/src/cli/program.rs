//! `lineshaft program`: runs programs of slots without a machine.

use super::{Exit, complain, say, say_all};
use crate::program::{self, Language, Trial, TrialError};
use clap::{Args, Subcommand};
use lineshaft_core::config::{FUEL, MAX_FUEL};
use lineshaft_program::{Module, SIZE, WORDS};
use std::path::{Path, PathBuf};

/// What is done with a program.
#[derive(Debug, Subcommand)]
pub(super) enum ProgramCommand {
    /// Write a new program: a crate of Rust, or a file in C with its header
    #[command(
        after_help = "Rust: `rustup target add wasm32-unknown-unknown`, then `cargo build --release` in the folder. \
                            C: clang and lld, then `make`."
    )]
    New(NewArgs),
    /// Check a module: can a slot run it, and what does it need?
    #[command(after_help = "Exit codes: 0 good, 2 it is no program, and why.")]
    Check(CheckArgs),
    /// Try a program against rows of inputs
    #[command(after_help = RUN_HELP)]
    Run(TryArgs),
}

const RUN_HELP: &str = "\
The first row names columns: command, inputs, source, travel, read1 to read16, parameter1 to parameter16; each further row is one \
call. Without a column `command` the first call is START (1), the others have none (255). Sink and outputs go on from call to call. \
# begins a comment. Prints CSV: line, command, sink, outputs, fuel, and a column of each memory cell that --writes counts.

Exit codes: 0 all rows ran, 1 the program trapped or ran out of fuel, 2 bad usage, module or inputs.";

/// A new program.
#[derive(Debug, Args)]
pub(super) struct NewArgs {
    /// Folder that does not exist yet; its name is that of the program
    folder: PathBuf,
    /// Language
    #[arg(long, value_enum, default_value = "rust")]
    language: Language,
}

/// A module.
#[derive(Debug, Args)]
pub(super) struct CheckArgs {
    /// Module (.wasm)
    module: PathBuf,
}

/// A module and inputs.
#[derive(Debug, Args)]
pub(super) struct TryArgs {
    /// Module (.wasm)
    module: PathBuf,
    /// Inputs (.csv)
    inputs: PathBuf,
    /// Instructions of a call, at most
    #[arg(long, default_value_t = FUEL, value_parser = clap::value_parser!(u32).range(1..=i64::from(MAX_FUEL)))]
    fuel: u32,
    /// Time between two calls, as `call_ns` of the image has it: `1 ms`
    #[arg(long, default_value = "1 ms", value_parser = super::functions::call)]
    call: u64,
    /// Memory cells to print, the first ones of `writes`
    #[arg(long, default_value_t = 0, value_parser = clap::value_parser!(u8).range(0..=WORDS as i64))]
    writes: u8,
    /// The memory cells are reals
    #[arg(long)]
    real: bool,
}

pub(super) fn program(command: &ProgramCommand) -> Exit {
    match command {
        ProgramCommand::New(args) => new(args),
        ProgramCommand::Check(args) => check(args),
        ProgramCommand::Run(args) => run(args),
    }
}

fn new(args: &NewArgs) -> Exit {
    match program::write_template(&args.folder, args.language) {
        Ok(written) => {
            written.iter().for_each(|path| say(&path.display()));
            Exit::Good
        }
        Err(error) => {
            complain(&format!("{}: {error}", args.folder.display()));
            Exit::Usage
        }
    }
}

/// Loads the module of a file; prints an error and returns `None` if it is invalid.
fn load(path: &Path) -> Option<Module> {
    let read = program::load(path).and_then(|bytes| Module::load(&bytes).map_err(|refused| refused.to_string()));
    read.map_err(|sentence| complain(&format!("{}: {sentence}", path.display()))).ok()
}

fn check(args: &CheckArgs) -> Exit {
    let Some(module) = load(&args.module) else { return Exit::Usage };
    let image = module.image();
    let lines = [
        format!("bytes: {}", module.bytes().len()),
        format!("sha256: {}", crate::recording::sha256(module.bytes())),
        format!("memory: {} x 64 KiB", module.pages()),
        format!("image: at {}, {} bytes, {} of them its own", image.start, image.len(), image.len() - SIZE),
        format!("instructions: {}", module.instructions()),
    ];
    lines.iter().for_each(|line| say(line));
    Exit::Good
}

fn run(args: &TryArgs) -> Exit {
    let Some(module) = load(&args.module) else { return Exit::Usage };
    let text = match std::fs::read_to_string(&args.inputs) {
        Ok(text) => text,
        Err(error) => {
            complain(&format!("{}: {error}", args.inputs.display()));
            return Exit::Usage;
        }
    };
    let (writes, mut trap) = (usize::from(args.writes), None);
    let mut lines = "line,command,sink,outputs,fuel".to_owned();
    (1..=writes).for_each(|nth| lines += &format!(",write{nth}"));
    lines.push('\n');
    let mut trial = Trial::new(&module, args.fuel);
    let ran = trial.run(&text, args.call, |row| {
        if row.trap.is_some() {
            trap = row.trap.map(|trap| (row.line, trap));
            return;
        }
        lines += &format!("{},{},{},{},{}", row.line, row.command, row.sink, row.outputs, row.fuel);
        for word in row.writes.iter().take(writes) {
            lines +=
                &if args.real { format!(",{}", f64::from_bits(*word)) } else { format!(",{}", word.cast_signed()) };
        }
        lines.push('\n');
    });
    say_all(&lines);
    match (ran, trap) {
        (Err(TrialError { place, sentence }), _) => {
            eprintln!("{}:{}:{}: {sentence}", args.inputs.display(), place.line, place.col);
            Exit::Usage
        }
        (Ok(()), Some((line, trap))) => {
            eprintln!("{}:{line}: {trap}", args.inputs.display());
            Exit::Failed
        }
        (Ok(()), None) => Exit::Good,
    }
}
