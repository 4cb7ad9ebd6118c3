use super::*;
use crate::function::program::Host;
use crate::function::trial::{at_rest, set, setting, tab0};
use crate::signal::Board;
use crate::table::Table;
use std::sync::Arc;

/// A module whose image has `own` bytes of its own at address 16.
fn module(own: u32, rest: &str) -> Module {
    let size: String =
        (lineshaft_program::SIZE as u32 + own).to_le_bytes().map(|byte| format!("\\{byte:02x}")).concat();
    let text = format!(
        "(module (memory 1) (global (export \"image\") i32 (i32.const 16)) (data (i32.const 16) \"{size}\") {rest})"
    );
    Module::load(&wat::parse_str(text).expect("a module")).expect("it is taken")
}

/// A program with its image and memory.
struct Trial {
    module: Module,
    function: Apsf,
    board: Board,
    fuel: u32,
    first: u8,
    sink: i64,
    outputs: u8,
}

impl Trial {
    fn new(rest: &str) -> Self {
        let module = module(16, rest);
        let function = Apsf::new(&SlotSetup { module: Some(&module), ..SlotSetup::default() });
        let board = Board::new(&crate::signal::Directory::default());
        Self { module, function, board, fuel: 1000, first: 0, sink: 0, outputs: 0 }
    }

    fn call(&mut self, source: i64, inputs: u8, act: impl FnOnce(&mut Apsf, &CallInputs<'_>) -> Outcome) -> Outcome {
        let host = Host {
            module: &self.module,
            fuel: self.fuel,
            board: &self.board,
            reads: &[],
            writes: &[],
            first_output: self.first,
        };
        let seen = CallInputs {
            source: crate::function::program::SourceValue { value: source, ..Default::default() },
            inputs,
            sink: self.sink,
            outputs: self.outputs,
            host: Some(host),
            ..at_rest()
        };
        let outcome = act(&mut self.function, &seen);
        if outcome.failed.is_none() {
            self.sink = outcome.sink;
            self.outputs = self.outputs & !outcome.writes | outcome.outputs & outcome.writes;
        }
        outcome
    }

    fn start(&mut self, values: &[(&str, i64)], source: i64) -> Outcome {
        let values = set(FIELDS, values);
        self.call(source, 1, |function, seen| function.start(Words(&values), seen))
    }

    fn step(&mut self, source: i64) -> Outcome {
        self.call(source, 1, |function, seen| function.step(seen))
    }

    fn leave(&mut self, source: i64) -> Outcome {
        self.call(source, 1, |function, seen| function.leave(seen).expect("it has a call of RESET"))
    }
}

/// Sink := 1000 * command + 10 * inputs + outputs.
const TELLS: &str = "(func (export \"cycle\")
    (i64.store (i32.const 40) (i64.add (i64.add
        (i64.mul (i64.load8_u (i32.const 20)) (i64.const 1000))
        (i64.mul (i64.load8_u (i32.const 21)) (i64.const 10)))
        (i64.load8_u (i32.const 22)))))";

/// Proves: AMK-APSF-04, AMK-APSF-06, AMK-APSF-07, AMK-APSF-14, AMK-APSF-45
#[test]
fn a_command_is_shown_in_one_call() {
    let mut trial = Trial::new(TELLS);
    trial.outputs = 4;
    assert_eq!(trial.start(&[], 0).sink, 1014);
    assert_eq!([trial.step(0).sink, trial.step(0).sink], [255_014, 255_014]);
    assert_eq!(trial.leave(0).sink, 14);
}

/// Proves: AMK-APSF-08, AMK-APSF-09, AMK-APSF-10, AMK-APSF-12
#[test]
fn a_program_that_writes_nothing_leaves_all_as_it_is() {
    let mut trial = Trial::new("(func (export \"cycle\"))");
    (trial.sink, trial.outputs) = (-77, 0xA5);
    let outcome = trial.start(&[("out_bits", 8)], 5);
    assert_eq!((outcome.sink, outcome.outputs, outcome.writes), (-77, 0xA5, 0xFF));
    let outcome = trial.step(6);
    assert_eq!((outcome.sink, outcome.outputs), (-77, 0xA5));
    // One instruction.
    assert_eq!(trial.function.shown(), [1]);
}

/// Proves: AMK-APSF-11, AMK-APSF-42, AMK-APSF-O1
#[test]
fn outputs_are_copied_from_the_first_one_on() {
    // AB 216 := the lowest byte of the source.
    let mut trial = Trial::new("(func (export \"cycle\") (i32.store8 (i32.const 22) (i32.load8_u (i32.const 24))))");
    trial.first = 3;
    let outcome = trial.start(&[("out_bits", 3)], 0xFF);
    assert_eq!((outcome.writes, trial.outputs), (0x38, 0x38));
    trial.outputs = 0xC7;
    trial.step(0x10);
    assert_eq!(trial.outputs, 0xD7);
    trial.step(0);
    assert_eq!(trial.outputs, 0xC7);
}

/// Proves: AMK-APSF-05
#[test]
fn a_source_is_as_wide_as_it_is() {
    let mut trial = Trial::new("(func (export \"cycle\") (i64.store (i32.const 40) (i64.load (i32.const 24))))");
    for value in [0, -1, i64::from(i32::MIN), i64::MAX, i64::MIN] {
        trial.start(&[], value);
        assert_eq!(trial.sink, value);
    }
}

#[test]
fn outputs_behind_the_last_are_refused() {
    let trial = Trial::new(TELLS);
    let check = |first, bits| {
        let values = set(FIELDS, &[("out_bits", bits)]);
        let setting = Setting { first_output: first, ..setting(1_000_000, [None; 8]) };
        trial.function.check(Words(&values), &setting)
    };
    assert_eq!([check(0, 8), check(3, 5), check(7, 1), check(7, 0)], [Ok(()); 4]);
    let fault = check(3, 6).unwrap_err();
    assert_eq!(
        (fault.code, fault.field, fault.asked),
        (Code::AMK_OUTPUTS_BEHIND, Some(0), crate::event::Number::Count(6))
    );
    assert_eq!(check(7, 2).unwrap_err().limit, crate::event::Number::Count(1));
}

/// Sink := the number of words, word 1, word 2 and parameter[2], in decimal places.
const READS: &str = "(func (export \"cycle\")
    (i64.store (i32.const 40) (i64.add
        (i64.add (i64.mul (i64.load32_u (i32.const 440)) (i64.const 1000000)) (i64.mul (i64.load16_u (i32.const 450)) (i64.const 10000)))
        (i64.add (i64.mul (i64.load16_u (i32.const 452)) (i64.const 100)) (i64.load (i32.const 328)))))
    (i32.store16 (i32.const 450) (i32.const 99)))";

/// Proves: AMK-APSF-13, AMK-APSF-41
#[test]
fn a_table_and_parameters_are_there_from_start_on() {
    let table = Arc::new(Table::new(Form::Words, &[], &[7, 12, 34]).unwrap());
    let mut trial = Trial::new(READS);
    let values = set(FIELDS, &[("parameter", 5)]);
    let start = |trial: &mut Trial, tables: crate::function::program::Tables<'_>| {
        trial.call(0, 0, |function, seen| function.start(Words(&values), &CallInputs { tables, ..*seen })).sink
    };
    assert_eq!(start(&mut trial, tab0(&table)), 3_123_405);
    // Words that the program writes there stay until the next START.
    assert_eq!(trial.step(0).sink, 3_993_405);
    assert_eq!(start(&mut trial, tab0(&table)), 3_123_405);
    assert_eq!(start(&mut trial, crate::function::trial::NO_TABLES), 5);
    let long = Table::new(Form::Words, &[], &[1; 257]).unwrap();
    let most = Table::new(Form::Words, &[], &[1; 256]).unwrap();
    let points = Table::new(Form::Y, &[], &[1, 2]).unwrap();
    let mut tables = [None; 8];
    for (table, code) in [(&most, None), (&long, Some(Code::AMK_DB_LONG)), (&points, Some(Code::AMK_TABLE_FORM))] {
        tables[0] = Some(table);
        let fault = trial.function.check(Words(&values), &setting(1_000_000, tables)).err();
        assert_eq!(fault.map(|fault| fault.code), code);
    }
}

/// Each call causes another trap, selected by the source; otherwise the sink is 9.
const TRAPS: &str = "(table 2 funcref) (type $f (func)) (type $g (func (param i32))) (elem (i32.const 1) $deep)
    (func $deep (call $deep))
    (func (export \"cycle\") (local $n i64)
        (local.set $n (i64.load (i32.const 24)))
        (if (i64.eq (local.get $n) (i64.const 1)) (then (loop $l (br $l))))
        (if (i64.eq (local.get $n) (i64.const 2)) (then (call $deep)))
        (if (i64.eq (local.get $n) (i64.const 3)) (then unreachable))
        (if (i64.eq (local.get $n) (i64.const 4)) (then (i64.store (i32.const 65530) (local.get $n))))
        (if (i64.eq (local.get $n) (i64.const 5)) (then (call_indirect (type $f) (i32.const 0))))
        (if (i64.eq (local.get $n) (i64.const 6)) (then (call_indirect (type $g) (i32.const 0) (i32.const 1))))
        (if (i64.eq (local.get $n) (i64.const 7)) (then (drop (i64.div_s (local.get $n) (i64.const 0)))))
        (if (i64.eq (local.get $n) (i64.const 8)) (then (drop (i64.trunc_f64_s (f64.const 1e30)))))
        (if (i64.eq (local.get $n) (i64.const 9)) (then (drop (i64.trunc_f64_s (f64.const nan)))))
        (if (i64.eq (local.get $n) (i64.const 10)) (then (i32.store (i32.const 16) (i32.const 5))))
        (i64.store (i32.const 40) (i64.const 9)))";

#[test]
fn each_trap_has_its_code_and_the_next_start_begins_anew() {
    let codes = [
        Code::AMK_OUT_OF_FUEL,
        Code::AMK_STACK,
        Code::AMK_UNREACHABLE,
        Code::AMK_MEMORY_BOUNDS,
        Code::AMK_NO_FUNCTION,
        Code::AMK_NO_FUNCTION,
        Code::AMK_DIVISION_BY_ZERO,
        Code::AMK_INTEGER_OVERFLOW,
        Code::AMK_NOT_A_NUMBER,
        Code::AMK_IMAGE,
    ];
    let mut trial = Trial::new(TRAPS);
    for (source, code) in (1..).zip(codes) {
        for at_start in [true, false] {
            let fresh = trial.start(&[], 0);
            assert_eq!((fresh.failed, fresh.sink), (None, 9), "before {source}");
            let outcome = if at_start { trial.start(&[], source) } else { trial.step(source) };
            assert_eq!(outcome.failed, Some(code), "{source}");
            assert!(trial.function.has_failed && trial.function.belongs_to(&trial.module, false));
            // A program that runs has not failed; memory beyond the reserved room would have to be allocated.
            assert!(source != 10 || !trial.function.belongs_to(&trial.module, true));
        }
    }
}

/// Counts its calls in its own part of the memory and outputs the count.
const COUNTS: &str = "(func (export \"cycle\")
    (i64.store (i32.const 960) (i64.add (i64.load (i32.const 960)) (i64.const 1)))
    (i64.store (i32.const 40) (i64.load (i32.const 960))))";

#[test]
fn state_outlives_reset_but_no_failure() {
    let mut trial = Trial::new(COUNTS);
    assert_eq!(
        [trial.start(&[], 0).sink, trial.step(0).sink, trial.leave(0).sink, trial.start(&[], 0).sink],
        [1, 2, 3, 4]
    );
    trial.fuel = 3;
    assert_eq!(trial.step(0).failed, Some(Code::AMK_OUT_OF_FUEL));
    trial.fuel = 1000;
    assert_eq!(trial.start(&[], 0).sink, 1);
}

#[test]
fn an_exchange_keeps_or_begins_and_tells_the_program_so() {
    let mut trial = Trial::new(COUNTS);
    trial.start(&[], 0);
    // The same in steps of ten, plus command * 1000.
    let tens = COUNTS.replace("(i64.const 1)", "(i64.const 10)").replace(
        "(i64.store (i32.const 40) (i64.load (i32.const 960)))",
        "(i64.store (i32.const 40) (i64.add (i64.load (i32.const 960)) (i64.mul (i64.load8_u (i32.const 20)) (i64.const 1000))))",
    );
    let next = module(16, &tens);
    let before = std::mem::replace(&mut trial.module, next);
    assert!(trial.function.exchange((&trial.module, &before), true));
    assert_eq!(trial.step(0).sink, 255_011);
    let again = trial.module.clone();
    assert!(trial.function.exchange((&trial.module, &again), false));
    assert_eq!([trial.step(0).sink, trial.step(0).sink], [1010, 255_020]);
    let longer = module(24, &tens);
    assert!(!trial.function.exchange((&longer, &again), true));
    assert_eq!(trial.step(0).sink, 255_030);
}

#[test]
fn a_state_that_was_read_belongs_to_its_set_and_module() {
    let mut trial = Trial::new(COUNTS);
    trial.start(&[("out_bits", 3)], 0);
    let is_kept = |bits: i64| {
        let words = set(FIELDS, &[("out_bits", bits)]);
        let setting = Setting { occasion: Occasion::Kept, runs: true, ..setting(1_000_000, [None; 8]) };
        trial.function.check(Words(&words), &setting).is_ok()
    };
    assert!(is_kept(3) && !is_kept(2));
    assert!(trial.function.belongs_to(&trial.module, true));
    let two_pages = "(module (memory 2) (global (export \"image\") i32 (i32.const 16)) (data (i32.const 16) \"\\b0\\03\") (func (export \"cycle\")))";
    assert!(!trial.function.belongs_to(&Module::load(&wat::parse_str(two_pages).unwrap()).unwrap(), true));
}
