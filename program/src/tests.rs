//! Tests of whole modules: rejected ones, comparison with another interpreter, broken ones.

mod mutated;
mod numbers;
mod refused;
mod same;
mod state;

use crate::{Command, Instance, Module, SIZE};
use assert_no_alloc::{AllocDisabler, assert_no_alloc};

#[global_allocator]
static ALLOCATOR: AllocDisabler = AllocDisabler;

/// Fuel of a call in these tests.
const FUEL: u32 = 200_000;

/// Returns a module with an image at 16 of the default size, and `rest`.
fn program(rest: &str) -> String {
    let size: String = (SIZE as u32 + 16).to_le_bytes().iter().map(|byte| format!("\\{byte:02x}")).collect();
    format!(
        "(module (memory (export \"memory\") 1) (global (export \"image\") i32 (i32.const 16)) (data (i32.const 16) \"{size}\") {rest})"
    )
}

fn load(text: &str) -> Module {
    Module::load(&wat::parse_str(text).expect("a module")).expect("it is taken")
}

/// Executes a call that must not allocate.
fn call(instance: &mut Instance, module: &Module, fuel: u32) -> Result<u32, (crate::Trap, u32)> {
    assert_no_alloc(|| instance.call(module, fuel))
}

/// Returns the sink after a call of a body that may use locals `a` and `b` (i64).
fn sink_of(body: &str) -> Result<i64, crate::Trap> {
    let text = program(&format!("(func (export \"cycle\") (local $a i64) (local $b i64) {body})"));
    let module = load(&text);
    let mut instance = Instance::new(&module, 1);
    instance.image(&module).set_command(Command::None);
    call(&mut instance, &module, FUEL).map_err(|(trap, _)| trap)?;
    Ok(instance.image(&module).sink())
}

/// Returns pseudo-random bytes that are the same in each run.
fn bytes(seed: u64, count: usize) -> Vec<u8> {
    let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
    let mut next = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 56) as u8
    };
    (0..count).map(|_| next()).collect()
}
