//! Broken modules are loaded or rejected; loaded ones stay within their fuel.

use super::{bytes, call, load, program};
use crate::{Instance, Module};

/// Number of modules.
const MODULES: u64 = 10_000;

/// A program with most of the features.
fn rich() -> Vec<u8> {
    let text = program(
        "(type $f (func (param i32 i64) (result i64)))
         (table 4 funcref) (elem (i32.const 1) $add $sum)
         (global $count (mut i64) (i64.const 5))
         (func $add (type $f) (i64.add (i64.extend_i32_u (local.get 0)) (local.get 1)))
         (func $sum (type $f) (local $i i32)
           (loop $again
             (local.set 1 (i64.add (local.get 1) (i64.load (i32.add (i32.const 56) (i32.shl (local.get $i) (i32.const 3))))))
             (br_if $again (i32.lt_u (local.tee $i (i32.add (local.get $i) (i32.const 1))) (i32.const 16))))
           (local.get 1))
         (func (export \"cycle\") (local $x f64)
           (block $out
             (block $one (block $two (br_table $one $two $out (i32.load8_u (i32.const 20)))) (br $out))
             (global.set $count (call_indirect (type $f) (i32.const 7) (global.get $count) (i32.const 2))))
           (local.set $x (f64.sqrt (f64.convert_i64_s (i64.load (i32.const 24)))))
           (i64.store (i32.const 40) (i64.trunc_sat_f64_s (f64.mul (local.get $x) (f64.const 1.5))))
           (if (i32.eqz (i32.load8_u (i32.const 21))) (then (memory.fill (i32.const 2000) (i32.const 7) (i32.const 64)))
             (else (memory.copy (i32.const 3000) (i32.const 2000) (i32.const 64))))
           (call_indirect (type $f) (i32.const 3) (i64.const 4) (i32.const 1)) (drop))",
    );
    let bytes = wat::parse_str(text).expect("a module");
    Module::load(&bytes).expect("it is taken");
    bytes
}

/// Proves: AMK-APSF-15
#[test]
fn a_broken_module_is_refused_or_stays_within_its_fuel() {
    let whole = rich();
    let (mut taken, mut refused) = (0, 0);
    for seed in 0..MODULES {
        let random = bytes(seed, 16);
        let mut broken = whole.clone();
        let place = |at: usize| usize::from(u16::from_le_bytes([random[at], random[at + 1]])) % whole.len();
        for nth in 0..1 + usize::from(random[0] % 3) {
            broken[place(1 + 3 * nth)] = random[3 + 3 * nth];
        }
        if random[15].is_multiple_of(16) {
            broken.truncate(place(12));
        }
        match Module::load(&broken) {
            Err(refusal) => {
                refused += 1;
                let sentence = refusal.to_string();
                assert!(!sentence.is_empty() && !sentence.ends_with('.'), "{sentence}");
            }
            Ok(module) => {
                taken += 1;
                let mut instance = Instance::new(&module, 16);
                for command in [1, 0] {
                    instance.image(&module).set_inputs(command);
                    let used = match call(&mut instance, &module, 5000) {
                        Ok(used) | Err((_, used)) => used,
                    };
                    assert!(used <= 5000);
                }
            }
        }
    }
    assert!(taken > 1000 && refused > 1000, "{taken} were taken, {refused} refused");
}

#[test]
fn a_loop_without_end_takes_its_fuel_and_no_more() {
    let module = load(&program("(func (export \"cycle\") (loop $again (br $again)))"));
    let mut instance = Instance::new(&module, 1);
    assert_eq!(call(&mut instance, &module, 1234), Err((crate::Trap::OutOfFuel, 1234)));
}

/// Moving a MiB costs as many instructions as can be executed in the same time.
#[test]
fn moving_memory_costs_by_its_length() {
    let module =
        load(&program("(func (export \"cycle\") (memory.fill (i32.const 0) (i32.const 0) (i32.const 65536)))"));
    let mut instance = Instance::new(&module, 1);
    // 65536 / 32 and five instructions: three constants, the fill, the return. It overwrites the size of its image.
    assert_eq!(call(&mut instance, &module, 5000), Err((crate::Trap::ImageOverwritten, 2053)));
    let mut instance = Instance::new(&module, 1);
    assert_eq!(call(&mut instance, &module, 2000), Err((crate::Trap::OutOfFuel, 2000)));
}

/// 4096 locals are 32 KiB that are set to 0.
#[test]
fn large_frames_cost_by_their_size() {
    let locals = "i64 ".repeat(4000);
    let module = load(&program(&format!("(func (export \"cycle\") (local {locals}))")));
    let mut instance = Instance::new(&module, 1);
    assert_eq!(call(&mut instance, &module, 5000), Ok(1001));
}

#[test]
fn calls_that_go_too_deep_trap() {
    let module = load(&program("(func $again (export \"cycle\") (call $again))"));
    let mut instance = Instance::new(&module, 1);
    let (trap, used) = call(&mut instance, &module, 5000).unwrap_err();
    assert_eq!((trap, used), (crate::Trap::StackOverflow, 257));
}
