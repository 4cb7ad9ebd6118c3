//! User programs in slots: commands, outputs, exchange, and the reaction of their axis to a failure.

use super::*;
use crate::config::ProgramConfig;
use crate::function::Quantity as Carries;
use lineshaft_program::Module;

/// A program that traps, exhausts its fuel or counts, as its source defines.
pub(super) const WILD: &str = include_str!("../../../../tests/programs/wild.wat");

const FB10: &[u8] = include_bytes!("../../../../../launch-configs/functions/programs/fb10.wasm");

pub(super) fn module(text: &str) -> Arc<Module> {
    Arc::new(Module::load(&wat::parse_str(text).expect("a module")).expect("it is taken"))
}

/// Returns a module with 16 bytes of data and this function body, with local `$n` (i64).
fn body(text: &str) -> Arc<Module> {
    module(&format!(
        "(module (memory 1) (global (export \"image\") i32 (i32.const 16)) (data (i32.const 16) \"\\c0\\03\") \
         (func (export \"cycle\") (local $n i64) {text}))"
    ))
}

/// Returns a cell whose first slot runs the module; e1 is its first input, the lamp its first output.
fn runs(module: &Arc<Module>, change: impl FnOnce(&mut SlotConfig)) -> MachineConfig {
    let mut slot = slot("p", 0, Type::Apsf);
    slot.program = Some(0);
    slot.source = SourceConfig::Signal("d".into());
    slot.inputs[0] = Some(Line { object: Object::Io(0), inverted: false });
    slot.outputs[0] = Some(Line { object: Object::Io(1), inverted: false });
    change(&mut slot);
    let programs = vec![ProgramConfig { name: "prog".into(), module: Arc::clone(module) }];
    MachineConfig { programs, ..cell(vec![slot]) }
}

fn load(module: &Arc<Module>, keeps: bool) -> Action {
    Action::LoadProgram { index: 0, module: Arc::clone(module), keeps }
}

/// Proves: AMK-APSF-46, AMK-APSF-O3, AMK-APSF-01, AMK-APSF-30, AMK-APSF-31, AMK-APSF-32, AMK-APSF-33, AMK-APSF-34, AMK-APSF-35, AMK-APSF-36
#[test]
fn fb10_makes_a_speed_of_a_foreign_encoder() {
    let fb10 = Arc::new(Module::load(FB10).expect("it is taken"));
    let mut rig = Rig::of(runs(&fb10, |slot| {
        (slot.sink, slot.source_width) = (SinkConfig::Memory(2), Width::W16);
        slot.quantity = Carries::Speed;
    }));
    rig.modify_inputs = |inputs| inputs.digital[0] = 1;
    rig.give(Action::set_memory(2, 4711.0));
    rig.give(Action::set_memory(1, 32_700.0));
    // Command k is 1, then 255: the travel since the previous call.
    let started = rig.give(order(0, Order::Start));
    assert!(rig.was_accepted(started), "{}", rig.refusal(started));
    assert_eq!((rig.int("p.sink"), rig.int("l")), (0, 0));
    rig.give(Action::set_memory(1, 32_760.0));
    assert_eq!((rig.int("p.sink"), rig.int("l")), (60 * 15_000, 60 * 15_000));
    rig.run(1);
    assert_eq!(rig.int("l"), 0);
    // 16 bits wrap: from 32760 to -32736 are 40.
    rig.give(Action::set_memory(1, -32_736.0));
    assert_eq!(rig.int("l"), 40 * 15_000);
    rig.give(Action::set_memory(1, -32_800.0));
    assert_eq!(rig.int("l"), -64 * 15_000);
    // Without its enable the speed is 0, and the next travel counts from the present encoder value.
    rig.modify_inputs = |inputs| inputs.digital[0] = 0;
    rig.give(Action::set_memory(1, 100.0));
    assert_eq!(rig.int("l"), 0);
    rig.modify_inputs = |inputs| inputs.digital[0] = 1;
    rig.give(Action::set_memory(1, 101.0));
    assert_eq!(rig.int("l"), 15_000);
    rig.give(Action::set_memory(1, 301.0));
    rig.give(order(0, Order::Reset));
    assert_eq!((rig.int("l"), rig.int("p.active"), rig.int("p.fuel")), (0, 0, 0));
}

/// Sink := 1000 * command + number of calls.
const TELLS: &str = "(i64.store (i32.const 960) (i64.add (i64.load (i32.const 960)) (i64.const 1)))
    (i64.store (i32.const 40) (i64.add (i64.mul (i64.load8_u (i32.const 20)) (i64.const 1000)) (i64.load (i32.const 960))))
    (i32.store8 (i32.const 22) (i32.load8_u (i32.const 20)))";

/// Proves: AMK-APSF-O3, AMK-APSF-14, AMK-APSF-37, AMK-APSF-38, AMK-APSF-45
#[test]
fn the_program_is_called_once_with_each_command() {
    let mut rig = Rig::of(runs(&body(TELLS), |slot| {
        (slot.sink, slot.values[0]) = (SinkConfig::Memory(2), 1);
    }));
    rig.run(3);
    assert_eq!(rig.int("l"), 0);
    // k: 1, k+1 and k+2: 255, k+3: 0, k+4: none.
    rig.give(order(0, Order::Start));
    assert_eq!((rig.int("l"), rig.int("lamp")), (1001, 1));
    rig.run(1);
    assert_eq!(rig.int("l"), 255_002);
    rig.run(1);
    assert_eq!(rig.int("l"), 255_003);
    rig.give(order(0, Order::Reset));
    // The last values remain (A-33): command 0 cleared A1.
    assert_eq!((rig.int("l"), rig.int("lamp"), rig.int("p.active")), (4, 0, 0));
    rig.run(5);
    assert_eq!(rig.int("l"), 4);
    let renewed = rig.give(order(0, Order::ValueNew));
    assert_eq!(rig.answer(renewed).map_err(|event| event.code), Err(Code::FUNCTION_NO_VALUE_NEW));
    // Every third cycle has a call.
    let mut rig = Rig::of(runs(&body(TELLS), |slot| {
        (slot.sink, slot.factor) = (SinkConfig::Memory(2), 3);
    }));
    rig.give(order(0, Order::Start));
    let calls: Vec<i64> = (0..7)
        .map(|_| {
            rig.run(1);
            rig.int("l") % 1000
        })
        .collect();
    assert_eq!(calls, [1, 1, 2, 2, 2, 3, 3]);
}

/// Cells := (d + 1, d > 0, d / 2.0) of the inputs: d, r and the state of e1.
const CELLS: &str = "(local.set $n (i64.load (i32.const 56)))
    (i64.store (i32.const 184) (i64.add (local.get $n) (i64.const 1)))
    (i64.store (i32.const 192) (i64.extend_i32_u (i64.gt_s (local.get $n) (i64.const 0))))
    (f64.store (i32.const 200) (f64.add (f64.load (i32.const 64)) (f64.div (f64.convert_i64_s (local.get $n)) (f64.const 2))))
    (i64.store (i32.const 40) (i64.load (i32.const 72)))";

/// Proves: AMK-APSF-03, AMK-APSF-16
#[test]
fn signals_are_read_and_memory_cells_written_by_their_names() {
    let with = |writes: Vec<u16>| {
        runs(&body(CELLS), |slot| {
            slot.reads = ["d", "y.command.velocity", "e1"].map(String::from).into();
            slot.writes = writes;
        })
    };
    let mut rig = Rig::of(with(vec![0, 4, 3]));
    rig.modify_inputs = |inputs| inputs.digital[0] = 1;
    rig.enable();
    rig.give(Action::Move(at(Y, 10_000.0)));
    rig.run_to("y.command.velocity", 10_000.0);
    rig.give(Action::set_memory(1, 40_000.0));
    rig.give(order(0, Order::Start));
    // A word of 16 bits holds the low bits: 40001 - 65536.
    assert_eq!((rig.int("w"), rig.int("bit"), rig.real("r"), rig.int("p.sink")), (-25_535, 1, 30_000.0, 1));
    rig.give(Action::set_memory(1, -4.0));
    assert_eq!((rig.int("w"), rig.int("bit"), rig.real("r")), (-3, 0, 9998.0));
    // No other function may write them.
    let mut twice = with(vec![2]);
    let copied = copy("c", 7, SourceConfig::Signal("d".into()), SinkConfig::Memory(2));
    twice.slots.push(copied);
    assert!(crate::machine::Machine::new(twice).is_err());
}

#[test]
fn nan_output_fails_before_anything_is_written() {
    let text =
        "(i64.store (i32.const 184) (i64.const 5)) (f64.store (i32.const 192) (f64.div (f64.const 0) (f64.const 0)))";
    let mut rig = Rig::of(runs(&body(text), |slot| slot.writes = vec![0, 3]));
    rig.give(order(0, Order::Start));
    assert_eq!((rig.int("w"), rig.real("r"), rig.int("p.active")), (0, 0.0, 0));
    assert_eq!(rig.int("p.error"), i64::from(Code::AMK_NOT_FINITE.0));
}

/// The sink advances by 20 in each call until d is 7: then the program loops forever. A1 is on.
const RUNS_ON: &str = "(i32.store8 (i32.const 22) (i32.const 1))
    (i64.store (i32.const 40) (i64.add (i64.load (i32.const 40)) (i64.const 20)))
    (if (i64.eq (i64.load (i32.const 24)) (i64.const 7)) (then (loop $l (br $l))))";

/// Proves: AMK-APSF-15, AMK-APSF-44
#[test]
fn the_axis_of_a_program_that_fails_stops_in_that_cycle_with_its_error() {
    let mut rig = Rig::of(runs(&body(RUNS_ON), |slot| {
        (slot.sink, slot.values[0], slot.fuel) = (SinkConfig::Axis(X), 1, 500);
    }));
    rig.enable();
    rig.give(order(0, Order::Start));
    rig.run(50);
    assert_eq!((rig.real("x.command.velocity"), rig.int("lamp"), rig.state("x")), (20_000.0, 1, "SYNCHRONIZED_MOTION"));
    rig.mirror();
    let before = rig.int("x.command.position");
    rig.give(Action::set_memory(1, 7.0));
    assert_eq!((rig.int("x.command.position"), rig.real("x.command.velocity")), (before, 0.0));
    assert_eq!((rig.int("lamp"), rig.int("p.active")), (0, 0));
    let code = Code::AMK_OUT_OF_FUEL;
    assert_eq!((rig.int("p.error"), rig.int("x.error"), rig.state("x")), (code.0.into(), code.0.into(), "ERROR_STOP"));
    let told: Vec<_> = rig.events.iter().filter(|event| event.kind == Kind::Error).collect();
    assert_eq!(told.len(), 2);
    assert_eq!((told[0].source, told[0].code), (Object::Function(0), code));
    assert_eq!((told[1].source, told[1].code), (Object::Axis(X), code));
    for (event, name) in told.into_iter().zip(["p", "x"]) {
        let sentence = crate::text::message(event, rig.machine.config());
        assert_eq!(sentence, format!("{name}: the program took more than 500 instructions in a call"));
    }
    rig.run(100);
    assert_eq!(rig.int("x.command.position"), before);
    // After the reset of the error the program starts again.
    rig.give(Action::set_memory(1, 0.0));
    rig.give(Action::ResetErrors(AxisSet::one(X)));
    let started = rig.give(order(0, Order::Start));
    assert!(rig.was_accepted(started), "{}", rig.refusal(started));
    rig.run(1);
    assert_eq!((rig.int("p.error"), rig.int("x.command.position")), (0, before + 20));
}

#[test]
fn the_axis_of_a_speed_brakes_where_the_program_fails() {
    let text = "(i64.store (i32.const 40) (i64.const 100000))
        (if (i64.eq (i64.load (i32.const 24)) (i64.const 7)) (then unreachable))";
    let mut rig = Rig::of(runs(&body(text), |slot| {
        (slot.sink, slot.quantity) = (SinkConfig::Axis(DISC), Carries::Speed);
    }));
    rig.enable();
    rig.give(order(0, Order::Start));
    // 10 rpm are 6000 inc/s.
    rig.run_to("disc.command.velocity", 6000.0);
    rig.give(Action::set_memory(1, 7.0));
    assert_eq!((rig.int("p.sink"), rig.int("disc.error")), (0, Code::AMK_UNREACHABLE.0.into()));
    rig.run(1);
    assert!(rig.real("disc.command.velocity") < 6000.0);
    rig.run(200);
    assert_eq!((rig.real("disc.command.velocity"), rig.state("disc")), (0.0, "ERROR_STOP"));
}

#[test]
fn a_start_that_fails_leaves_everything_where_it_is() {
    let text = "(i64.store (i32.const 40) (i64.const 999)) unreachable";
    let mut rig = Rig::of(runs(&body(text), |slot| slot.sink = SinkConfig::Axis(X)));
    rig.enable();
    rig.give(Action::Move(to(X, 500)));
    rig.run(400);
    rig.give(order(0, Order::Start));
    rig.run(3);
    assert_eq!((rig.int("x.command.position"), rig.int("p.sink"), rig.int("p.active")), (500, 500, 0));
    // The program never controlled the axis, which has no error and is free.
    assert_eq!((rig.int("x.error"), rig.int("p.error")), (0, Code::AMK_UNREACHABLE.0.into()));
    let moved = rig.give(Action::Move(to(X, 600)));
    assert!(rig.was_accepted(moved));
}

#[test]
fn an_exchange_in_motion_keeps_the_state_or_begins_anew() {
    let mut rig = Rig::of(runs(&body(TELLS), |slot| slot.sink = SinkConfig::Memory(2)));
    rig.give(order(0, Order::Start));
    rig.run(9);
    assert_eq!(rig.int("l"), 255_010);
    rig.mirror();
    let tens = body(&TELLS.replace("(i64.const 1))", "(i64.const 10))"));
    let exchanged = rig.give(load(&tens, true));
    assert!(rig.was_accepted(exchanged));
    assert_eq!(rig.int("l"), 255_020);
    let anew = rig.give(load(&tens, false));
    assert!(rig.was_accepted(anew));
    assert_eq!(rig.int("l"), 1010, "it is told to begin");
    // The first program is in force again after the power cycle.
    rig.run(1);
    rig.give(Action::PowerCycle);
    rig.give(order(0, Order::Start));
    assert_eq!(rig.int("l"), 1001);
}

#[test]
fn an_exchange_that_cannot_be_is_refused_and_changes_nothing() {
    let mut rig = Rig::of(runs(&body(TELLS), |slot| slot.sink = SinkConfig::Memory(2)));
    rig.give(order(0, Order::Start));
    let longer = module(
        "(module (memory 1) (global (export \"image\") i32 (i32.const 16)) (data (i32.const 16) \"\\c8\\03\") (func (export \"cycle\")))",
    );
    let large = module(
        "(module (memory 5) (global (export \"image\") i32 (i32.const 16)) (data (i32.const 16) \"\\c0\\03\") (func (export \"cycle\")))",
    );
    let refused = rig.give(load(&longer, true));
    assert_eq!(
        rig.refusal(refused),
        "prog: its image has 968 bytes, that of the program which runs has 960: its state cannot be kept"
    );
    let refused = rig.give(load(&large, false));
    assert_eq!(rig.refusal(refused), "prog: it needs 5 pages of memory; its functions have room for 4");
    let none = rig.give(Action::LoadProgram { index: 1, module: Arc::clone(&longer), keeps: false });
    assert!(rig.answer(none).is_err());
    assert_eq!(rig.int("l"), 255_004);
    let taken = rig.give(load(&longer, false));
    assert!(rig.was_accepted(taken));
}

/// Floats, loops and traps: the same bytes in each run, and from each state.
#[test]
fn a_wild_program_is_the_same_in_each_run() {
    let run = || {
        let mut rig = Rig::of(runs(&module(WILD), |slot| {
            (slot.values[0], slot.fuel, slot.writes) = (1, 5000, vec![2]);
        }));
        rig.give(order(0, Order::Start));
        let mut failed = 0;
        for value in 0..400_i32 {
            if value % 100 == 50 {
                rig.mirror();
            }
            rig.give(Action::set_memory(1, f64::from(value * 7)));
            if rig.int("p.active") == 0 {
                failed += 1;
                rig.give(order(0, Order::Start));
            }
        }
        assert!(failed > 3, "{failed}");
        postcard::to_allocvec(rig.machine.state()).unwrap()
    };
    assert!(run() == run());
}

#[test]
fn a_slot_has_a_program_and_no_other_type_has_one() {
    let config = runs(&body(TELLS), |_| {});
    let broken = |change: fn(&mut MachineConfig)| {
        let mut config = config.clone();
        change(&mut config);
        crate::machine::Machine::new(config).err().map(|error| error.to_string())
    };
    assert_eq!(broken(|_| {}), None);
    let says = |change| broken(change).unwrap_or_default();
    assert!(says(|config| config.slots[0].program = None).contains("program is nothing that it can use"));
    assert!(says(|config| config.slots[0].program = Some(1)).contains("program is nothing that it can use"));
    let other = |config: &mut MachineConfig| {
        let copied = copy("c", 0, SourceConfig::Signal("d".into()), SinkConfig::Memory(2));
        config.slots = vec![SlotConfig { program: Some(0), ..copied }];
    };
    assert!(says(other).contains("program is nothing that it can use"));
    assert!(says(|config| config.slots[0].fuel = 0).contains("fuel is nothing that it can use"));
    assert!(says(|config| config.slots[0].fuel = 10_000_001).contains("fuel is nothing that it can use"));
    assert!(says(|config| config.slots[0].reads = vec!["nothing".into()]).contains("reads is nothing that it can use"));
    assert!(says(|config| config.slots[0].reads = vec!["d".into(); 17]).contains("reads is nothing that it can use"));
    assert!(says(|config| config.slots[0].writes = vec![9]).contains("writes is nothing that it can use"));
    assert!(says(|config| config.slots[0].writes = vec![1, 1]).contains("written by something else"));
}

/// The position of an axis is not used as a speed.
#[test]
fn a_speed_begins_at_0_wherever_its_axis_stands() {
    let mut rig = Rig::of(runs(&body(""), |slot| {
        (slot.sink, slot.quantity) = (SinkConfig::Axis(DISC), Carries::Speed);
    }));
    rig.enable();
    rig.give(Action::Move(to(DISC, 30_000)));
    rig.run(3000);
    rig.give(order(0, Order::Start));
    rig.run(100);
    assert_eq!((rig.int("p.sink"), rig.int("disc.command.position")), (0, 30_000));
}

/// Sink := 1000 * command + source.
const SOURCES: &str = "(i64.store (i32.const 40)
    (i64.add (i64.mul (i64.load8_u (i32.const 20)) (i64.const 1000)) (i64.load (i32.const 24))))";

/// Proves: AMK-APSF-04, AMK-APSF-14
#[test]
fn the_call_of_reset_sees_its_cycle_and_is_never_left_out() {
    let mut rig = Rig::of(runs(&body(SOURCES), |slot| slot.sink = SinkConfig::Memory(2)));
    rig.give(order(0, Order::Start));
    rig.give(Action::set_memory(1, 100.0));
    assert_eq!(rig.int("l"), 255_100);
    rig.give_all(vec![Action::set_memory(1, 110.0), order(0, Order::Reset)]);
    assert_eq!(rig.int("l"), 110);
    // RESET and START in one cycle: 0, then 1.
    let mut rig = Rig::of(runs(&body(TELLS), |slot| slot.sink = SinkConfig::Memory(2)));
    rig.give(order(0, Order::Start));
    rig.run(1);
    assert_eq!(rig.int("l"), 255_002);
    rig.mirror();
    rig.give_all(vec![order(0, Order::Reset), order(0, Order::Start)]);
    assert_eq!((rig.int("l"), rig.int("p.active")), (1004, 1), "the call of RESET was the third");
    rig.run(1);
    assert_eq!(rig.int("l"), 255_005);
    rig.give_all(vec![order(0, Order::Reset), order(0, Order::Start), order(0, Order::Reset)]);
    assert_eq!((rig.int("l"), rig.int("p.active")), (6, 0));
}
