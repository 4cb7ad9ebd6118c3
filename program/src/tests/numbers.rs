//! Arithmetic at its limits, with the numbers of the WebAssembly and IEEE 754 standards.

use super::sink_of;
use crate::Trap;
use proptest::prelude::*;

/// Returns the sink for an expression of i64.
fn whole(expression: &str) -> Result<i64, Trap> {
    sink_of(&format!("(i64.store (i32.const 40) {expression})"))
}

fn bits(expression: &str) -> i64 {
    whole(&format!("(i64.reinterpret_f64 {expression})")).expect("it comes to its end")
}

#[test]
fn whole_numbers_wrap_and_trap_at_their_edges() {
    const LEAST: &str = "(i64.const -9223372036854775808)";
    assert_eq!(whole(&format!("(i64.sub {LEAST} (i64.const 1))")), Ok(i64::MAX));
    assert_eq!(whole(&format!("(i64.div_s {LEAST} (i64.const -1))")), Err(Trap::IntegerOverflow));
    assert_eq!(whole(&format!("(i64.rem_s {LEAST} (i64.const -1))")), Ok(0));
    assert_eq!(whole("(i64.div_s (i64.const -7) (i64.const 2))"), Ok(-3));
    assert_eq!(whole("(i64.rem_s (i64.const -7) (i64.const 2))"), Ok(-1));
    assert_eq!(whole("(i64.div_u (i64.const -1) (i64.const 2))"), Ok(i64::MAX));
    for op in ["div_s", "div_u", "rem_s", "rem_u"] {
        assert_eq!(whole(&format!("(i64.{op} (i64.const 7) (i64.const 0))")), Err(Trap::DivisionByZero), "{op}");
        let short = format!("(i64.extend_i32_s (i32.{op} (i32.const 7) (i32.const 0)))");
        assert_eq!(whole(&short), Err(Trap::DivisionByZero), "{op}");
    }
    let short = "(i64.extend_i32_s (i32.div_s (i32.const -2147483648) (i32.const -1)))";
    assert_eq!(whole(short), Err(Trap::IntegerOverflow));
    // Shifts and rotations count modulo the width.
    assert_eq!(whole("(i64.shl (i64.const 1) (i64.const 65))"), Ok(2));
    assert_eq!(whole("(i64.extend_i32_u (i32.shr_u (i32.const -1) (i32.const 33)))"), Ok(0x7FFF_FFFF));
    assert_eq!(whole("(i64.extend_i32_u (i32.rotr (i32.const 1) (i32.const 33)))"), Ok(0x8000_0000));
    assert_eq!(whole("(i64.extend16_s (i64.const 0x18000))"), Ok(-32768));
    assert_eq!(whole("(i64.extend_i32_u (i32.extend8_s (i32.const 0x80)))"), Ok(0xFFFF_FF80));
}

#[test]
fn there_is_one_nan_and_bits_that_are_moved_stay() {
    const NAN: i64 = 0x7FF8_0000_0000_0000;
    assert_eq!(bits("(f64.div (f64.const 0) (f64.const 0))"), NAN);
    assert_eq!(bits("(f64.sqrt (f64.const -1))"), NAN);
    assert_eq!(bits("(f64.add (f64.const nan:0x4000000000001) (f64.const 1))"), NAN);
    assert_eq!(bits("(f64.min (f64.const -nan:0x4000000000001) (f64.const 1))"), NAN);
    assert_eq!(bits("(f64.promote_f32 (f32.const nan:0x200001))"), NAN);
    assert_eq!(bits("(f64.neg (f64.const nan:0x4000000000001))"), i64::MIN | 0x7FF4_0000_0000_0001);
    assert_eq!(bits("(f64.abs (f64.const -nan:0x4000000000001))"), 0x7FF4_0000_0000_0001);
    let demoted = "(i64.extend_i32_u (i32.reinterpret_f32 (f32.demote_f64 (f64.const -nan:0x4000000000001))))";
    assert_eq!(whole(demoted), Ok(0x7FC0_0000));
}

#[test]
fn zeros_have_signs() {
    let zero = |sign: &str| format!("(f64.const {sign}0)");
    assert_eq!(bits(&format!("(f64.min {} {})", zero(""), zero("-"))), i64::MIN);
    assert_eq!(bits(&format!("(f64.min {} {})", zero("-"), zero(""))), i64::MIN);
    assert_eq!(bits(&format!("(f64.max {} {})", zero("-"), zero(""))), 0);
    assert_eq!(bits(&format!("(f64.max {} {})", zero(""), zero("-"))), 0);
    assert_eq!(bits("(f64.nearest (f64.const -0.5))"), i64::MIN);
    assert_eq!(bits("(f64.nearest (f64.const 2.5))"), 2_f64.to_bits().cast_signed());
    assert_eq!(bits("(f64.copysign (f64.const 3) (f64.const -0))"), (-3_f64).to_bits().cast_signed());
}

#[test]
fn floats_become_whole_numbers_up_to_their_edges() {
    let cut = |kind: &str, value: &str| whole(&format!("(i64.{kind} (f64.const {value}))"));
    assert_eq!(cut("trunc_f64_s", "-9223372036854775808"), Ok(i64::MIN));
    assert_eq!(cut("trunc_f64_s", "-9223372036854777856"), Err(Trap::IntegerOverflow));
    assert_eq!(cut("trunc_f64_s", "9223372036854774784"), Ok(9_223_372_036_854_774_784));
    assert_eq!(cut("trunc_f64_s", "9223372036854775808"), Err(Trap::IntegerOverflow));
    assert_eq!(cut("trunc_f64_u", "-0.9"), Ok(0));
    assert_eq!(cut("trunc_f64_u", "-1"), Err(Trap::IntegerOverflow));
    assert_eq!(cut("trunc_f64_u", "18446744073709549568"), Ok(-2048));
    assert_eq!(cut("trunc_f64_s", "nan"), Err(Trap::NotANumber));
    assert_eq!(cut("trunc_sat_f64_s", "nan"), Ok(0));
    assert_eq!(cut("trunc_sat_f64_s", "1e30"), Ok(i64::MAX));
    assert_eq!(cut("trunc_sat_f64_u", "-1e30"), Ok(0));
    let short = |kind: &str, value: &str| whole(&format!("(i64.extend_i32_s (i32.{kind} (f64.const {value})))"));
    assert_eq!(short("trunc_f64_s", "2147483647.9"), Ok(2_147_483_647));
    assert_eq!(short("trunc_f64_s", "2147483648"), Err(Trap::IntegerOverflow));
    assert_eq!(short("trunc_f64_s", "-2147483648.9"), Ok(-2_147_483_648));
    assert_eq!(short("trunc_f64_s", "-2147483649"), Err(Trap::IntegerOverflow));
    assert_eq!(short("trunc_f64_u", "4294967295.9"), Ok(-1));
    assert_eq!(short("trunc_sat_f64_u", "1e10"), Ok(-1));
}

#[test]
fn access_beyond_memory_traps() {
    assert_eq!(whole("(i64.load (i32.const 65528))"), Ok(0));
    assert_eq!(whole("(i64.load (i32.const 65529))"), Err(Trap::MemoryOutOfBounds));
    assert_eq!(whole("(i64.load offset=4294967295 (i32.const -1))"), Err(Trap::MemoryOutOfBounds));
    assert_eq!(whole("(i64.load8_u (i32.const -1))"), Err(Trap::MemoryOutOfBounds));
    let copy = |to: i32, from: i32, length: i32| {
        sink_of(&format!("(memory.copy (i32.const {to}) (i32.const {from}) (i32.const {length}))"))
    };
    assert_eq!(copy(65536, 0, 0), Ok(0));
    assert_eq!(copy(65537, 0, 0), Err(Trap::MemoryOutOfBounds));
    assert_eq!(copy(2000, 65535, 2), Err(Trap::MemoryOutOfBounds));
    // 4 GiB cost more than the available fuel.
    assert_eq!(copy(2000, 3000, -1), Err(Trap::OutOfFuel));
    assert_eq!(whole("(i64.extend_i32_s (memory.grow (i32.const 1)))"), Ok(-1));
    assert_eq!(whole("(i64.extend_i32_s (memory.grow (i32.const 0)))"), Ok(1));
    assert_eq!(whole("(i64.extend_i32_s (memory.size))"), Ok(1));
}

/// Both branches of an `if` set the local that takes its result.
#[test]
fn joined_value_is_that_of_taken_branch() {
    for (condition, expected) in [(1, 5), (0, 6)] {
        let text = format!(
            "(local.set $b (i64.const 2)) (local.set $a (if (result i64) (i32.const {condition}) \
             (then (i64.add (local.get $b) (i64.const 3))) (else (i64.mul (local.get $b) (i64.const 3))))) \
             (i64.store (i32.const 40) (local.get $a))"
        );
        assert_eq!(sink_of(&text), Ok(expected));
    }
}

/// A branch keeps its result from above the operands that it drops.
#[test]
fn a_branch_takes_along_what_is_on_top() {
    for (condition, expected) in [(1, 9), (0, 1)] {
        let text = format!(
            "(i64.store (i32.const 40) (block (result i64) i64.const 5 i64.const 9 i32.const {condition} br_if 0 \
             drop drop i64.const 1))"
        );
        assert_eq!(sink_of(&text), Ok(expected));
    }
}

/// An overlapping copy copies the previous contents.
#[test]
fn copies_may_overlap() {
    let text = "(i64.store (i32.const 2000) (i64.const 0x0807060504030201)) \
                (memory.copy (i32.const 2001) (i32.const 2000) (i32.const 7)) (i64.store (i32.const 40) (i64.load (i32.const 2000)))";
    assert_eq!(sink_of(text), Ok(0x0706_0504_0302_0101));
}

proptest! {
    /// Pushed locals keep their values while the locals are set, wherever the operands are.
    #[test]
    fn an_operand_keeps_what_its_local_had(a in any::<i64>(), b in any::<i64>()) {
        let text = format!(
            "(local.set $a (i64.const {a})) (local.set $b (i64.const {b})) \
             (i64.store (i32.const 40) (i64.sub (local.get $a) (i64.mul (local.tee $a (local.get $b)) (local.get $a))))"
        );
        prop_assert_eq!(sink_of(&text), Ok(a.wrapping_sub(b.wrapping_mul(b))));
        let swap = format!(
            "(local.set $a (i64.const {a})) (local.set $b (i64.const {b})) \
             (local.get $a) (local.get $b) (local.set $a) (local.set $b) \
             (i64.store (i32.const 40) (i64.sub (local.get $a) (local.get $b)))"
        );
        prop_assert_eq!(sink_of(&swap), Ok(b.wrapping_sub(a)));
    }
}
