//! APSF: a user program in a slot.
//!
//! Law      one call with command 1 at START, with 255 in each cycle, and with 0 at RESET. Values that the program does
//!          not write stay unchanged. The state of the program survives RESET; a program that failed is initialized
//!          again at the next START
//! Reads    source, inputs, signals that the cell names, parameters, a table at START
//! Writes   the sink, the number of outputs given by `out_bits`, memory cells that the cell names
//! Refuses  a table with more words than the image holds; in the cycle, a trap or too little fuel ends the program
//! Source   AMK-APSF-01 to -46, A-32 to -36

use crate::code::Code;
use crate::function::field::width;
use crate::function::guest::*;
use crate::table::Form;
use lineshaft_program::{Command, DB_WORDS, Image, Instance, Module, PARAMETERS, Trap};
use serde::{Deserialize, Serialize};

/// Fields of the parameter set.
pub(super) const FIELDS: &[Field] = &[
    Field::new("out_bits", 0, 8, "", "outputs that the program writes, A1 first", "AMK-APSF-42"),
    Field::new(
        "parameter",
        i32::MIN as i64,
        i32::MAX as i64,
        "",
        "what the program finds in `parameters` of its image from START on",
        "AMK-APSF-13",
    )
    .list(PARAMETERS),
];

const OUT_BITS: usize = place(FIELDS, "out_bits");
const PARAMETER: usize = place(FIELDS, "parameter");
const _: () = assert!(PARAMETER + PARAMETERS == width(FIELDS));

/// Memory pages that are reserved for later programs; more if the first program has more.
const ROOM: usize = 4;

/// State of the function.
#[derive(Debug, Serialize, Deserialize)]
pub(in crate::function) struct Apsf {
    instance: Instance,
    /// Outputs that the program writes, fixed at START.
    outputs: u8,
    /// Whether the program failed; the next START initializes it again.
    has_failed: bool,
    /// Whether an exchange initialized the program: the next call passes command START.
    was_initialized: bool,
    /// Instructions of the last call.
    used: [i64; 1],
}

impl Apsf {
    fn call(&mut self, seen: &CallInputs<'_>, outputs: u8, command: Command) -> Outcome {
        // A slot of this type has a module.
        let Some(host) = seen.host else { return Outcome::default() };
        let mut image = self.instance.image(host.module);
        image.set_command(command);
        image.set_inputs(seen.inputs);
        image.set_outputs(outputs);
        image.set_source(seen.source.value, seen.source.travel);
        image.set_sink(seen.sink);
        image.set_call_ns(seen.call_ns);
        for (place, word) in host.reads.iter().enumerate() {
            image.set_read(place, word.bits(host.board));
        }
        for (place, cell) in host.writes.iter().enumerate() {
            image.set_write(place, cell.bits(host.board));
        }
        let result = self.instance.call(host.module, host.fuel);
        let image = self.instance.image(host.module);
        let is_finite = |(place, cell): (usize, &OutputCell)| cell.can_hold(image.write(place));
        let (used, failed) = match result {
            Ok(used) if host.writes.iter().enumerate().all(is_finite) => (used, None),
            Ok(used) => (used, Some(Code::AMK_NOT_FINITE)),
            Err((trap, used)) => (used, Some(code(trap))),
        };
        self.used = [used.into()];
        self.has_failed = failed.is_some();
        Outcome { sink: image.sink(), outputs: image.outputs(), writes: self.outputs, failed, ..Outcome::default() }
    }
}

impl Clone for Apsf {
    fn clone(&self) -> Self {
        Self { instance: self.instance.clone(), ..*self }
    }

    /// Does not allocate if both functions belong to the same machine.
    fn clone_from(&mut self, other: &Self) {
        // Lists every field, so that the compiler reports a new one.
        let Self { instance, outputs, has_failed, was_initialized: begins, used } = other;
        self.instance.clone_from(instance);
        (self.outputs, self.has_failed, self.was_initialized, self.used) = (*outputs, *has_failed, *begins, *used);
    }
}

/// Sets the table of the image; a table of form words holds numbers below 2^16.
fn set_db(image: &mut Image<'_>, words: &[i64]) {
    // The casts keep the low 16 bits; a table of words has no others.
    image.set_db(words.iter().map(|word| *word as u16));
}

impl SlotType for Apsf {
    const DESCRIPTION: Description = Description {
        chooses_quantity: true,
        moves_axes: true,
        inputs: 8,
        outputs: 8,
        tables: 1,
        shows: &[Shown::number("fuel", "instructions that the last call of its program took")],
        runs_program: true,
        ..Description::of(Kind::Apsf, "apsf", "runs a program of yours, a WebAssembly module", FIELDS)
    };

    fn new(setup: &SlotSetup<'_>) -> Self {
        let instance = setup.module.map_or_else(|| Instance::with_room(ROOM), |module| Instance::new(module, ROOM));
        Self { instance, outputs: 0, has_failed: false, was_initialized: false, used: [0] }
    }

    fn is_set_up_as(&self, other: &Self) -> bool {
        self.room() == other.room()
    }

    fn check(&self, words: Words<'_>, setting: &Setting<'_>) -> Result<(), Fault> {
        let is_kept = setting.occasion == Occasion::Kept && setting.runs;
        if is_kept && self.outputs != outputs(words, setting.first_output) {
            return Err(Fault::new(Code::BAD_REQUEST));
        }
        let (first, most) = (i64::from(setting.first_output), LINES as i64);
        if words.get(OUT_BITS) > most - first {
            let fault = Fault::new(Code::AMK_OUTPUTS_BEHIND).of(number(FIELDS, "out_bits"));
            return Err(fault.with(words.get(OUT_BITS), most - first));
        }
        let Some(table) = setting.tables[0] else { return Ok(()) };
        if table.form() != Form::Words {
            return Err(Fault::new(Code::AMK_TABLE_FORM));
        }
        if table.y().len() > DB_WORDS {
            return Err(Fault::new(Code::AMK_DB_LONG).with(table.y().len() as i64, DB_WORDS as i64));
        }
        Ok(())
    }

    fn start(&mut self, words: Words<'_>, seen: &CallInputs<'_>) -> Outcome {
        let Some(host) = seen.host else { return Outcome::default() };
        if self.has_failed {
            self.instance.restart(host.module);
        }
        self.was_initialized = false;
        self.outputs = outputs(words, host.first_output);
        let mut image = self.instance.image(host.module);
        for place in 0..PARAMETERS {
            image.set_parameter(place, words.get(PARAMETER + place));
        }
        set_db(&mut image, seen.tables.get(0).map_or(&[], |table| table.y()));
        self.call(seen, seen.outputs, Command::Start)
    }

    fn step(&mut self, seen: &CallInputs<'_>) -> Outcome {
        let command = if std::mem::take(&mut self.was_initialized) { Command::Start } else { Command::None };
        self.call(seen, seen.outputs, command)
    }

    fn leave(&mut self, seen: &CallInputs<'_>) -> Option<Outcome> {
        Some(self.call(seen, seen.outputs, Command::Reset))
    }

    fn shown(&self) -> &[i64] {
        &self.used
    }

    fn room(&self) -> usize {
        self.instance.room()
    }

    fn word(&mut self, module: &Module, place: usize) -> u64 {
        self.instance.image(module).write(place)
    }

    fn exchange(&mut self, (module, before): (&Module, &Module), keeps: bool) -> bool {
        // The state of a failed program is not kept.
        let keeps = keeps && !self.has_failed;
        if !self.instance.exchange((module, before), keeps) {
            return false;
        }
        self.was_initialized = !keeps;
        self.has_failed = false;
        true
    }

    fn belongs_to(&self, module: &Module, runs: bool) -> bool {
        self.instance.has_room(module) && (self.has_failed && !runs || self.instance.belongs_to(module))
    }
}

/// Returns the outputs that a parameter set lets the program write: `out_bits` of them, from the first one
/// (AMK-APSF-11).
fn outputs(words: Words<'_>, first: u8) -> u8 {
    let count = words.get(OUT_BITS).clamp(0, 8);
    (((1_u16 << count) - 1) << first.min(7)) as u8
}

/// Returns the error code of a trap.
fn code(trap: Trap) -> Code {
    match trap {
        Trap::OutOfFuel => Code::AMK_OUT_OF_FUEL,
        Trap::StackOverflow => Code::AMK_STACK,
        Trap::Unreachable => Code::AMK_UNREACHABLE,
        Trap::MemoryOutOfBounds => Code::AMK_MEMORY_BOUNDS,
        Trap::NoFunction | Trap::SignatureMismatch => Code::AMK_NO_FUNCTION,
        Trap::DivisionByZero => Code::AMK_DIVISION_BY_ZERO,
        Trap::IntegerOverflow => Code::AMK_INTEGER_OVERFLOW,
        Trap::NotANumber => Code::AMK_NOT_A_NUMBER,
        Trap::ImageOverwritten => Code::AMK_IMAGE,
    }
}

#[cfg(test)]
mod tests;
