//! Random programs have the same results as in another interpreter, do not allocate, and end within their fuel.

use super::{FUEL, bytes};
use crate::module::{Module, PAGE};
use crate::run::{self, Stack};
use crate::trap::Trap;
use assert_no_alloc::assert_no_alloc;
use wasm_smith::{Config, Module as Random};
use wasmi::{Engine, Linker, Store, StoreLimits, StoreLimitsBuilder};

/// Number of programs.
const PROGRAMS: u64 = 10_000;

fn config(has_bulk: bool) -> Config {
    Config {
        exports: Some(
            wat::parse_str(
                "(module (memory (export \"memory\") 1) (func (export \"cycle\")) (func (export \"other\")))",
            )
            .expect("a module"),
        ),
        allow_start_export: false,
        bulk_memory_enabled: has_bulk,
        reference_types_enabled: has_bulk,
        canonicalize_nans: true,
        exceptions_enabled: false,
        gc_enabled: false,
        simd_enabled: false,
        relaxed_simd_enabled: false,
        tail_call_enabled: false,
        threads_enabled: false,
        memory64_enabled: false,
        wide_arithmetic_enabled: false,
        extended_const_enabled: false,
        compact_imports_enabled: false,
        max_imports: 0,
        // The memory of the exports is the only one.
        max_memories: 0,
        max_memory32_bytes: 2 * PAGE as u64,
        max_table_elements: 100,
        max_instructions: 400,
        ..Config::default()
    }
}

/// Returns a random program that ends.
fn random(seed: u64, has_bulk: bool) -> Option<Vec<u8>> {
    let bytes = bytes(seed, 2000);
    let mut random = Random::new(config(has_bulk), &mut arbitrary::Unstructured::new(&bytes)).ok()?;
    random.ensure_termination(1000).ok()?;
    Some(random.to_bytes())
}

/// Result of a call.
#[derive(Debug, PartialEq)]
enum End {
    Done,
    Trapped,
    /// The stacks of the two interpreters have different sizes.
    Overflowed,
    Spent,
}

/// Returns the memory after each of two calls of each function; `None` if the module cannot be instantiated.
fn reference(wasm: &[u8], pages: usize) -> Option<Vec<(End, Vec<u8>)>> {
    let engine = Engine::default();
    let module = wasmi::Module::new(&engine, wasm).ok()?;
    let limits: StoreLimits = StoreLimitsBuilder::new().memory_size(pages * PAGE).build();
    let mut store = Store::new(&engine, limits);
    store.limiter(|limits| limits);
    let instance = Linker::new(&engine).instantiate_and_start(&mut store, &module).ok()?;
    let memory = instance.get_memory(&store, "memory").expect("it is exported");
    let mut ends = Vec::new();
    for name in ["cycle", "other", "cycle", "other"] {
        let function = instance.get_typed_func::<(), ()>(&store, name).expect("it is exported");
        let end = match function.call(&mut store, ()) {
            Ok(()) => End::Done,
            Err(error) if error.as_trap_code() == Some(wasmi::TrapCode::StackOverflow) => End::Overflowed,
            Err(_) => End::Trapped,
        };
        ends.push((end, memory.data(&store).to_vec()));
    }
    Some(ends)
}

/// Proves: AMK-APSF-15
#[test]
fn random_programs_do_what_another_interpreter_does() {
    let (mut compared, mut traps, mut refused) = (0, 0, 0);
    for seed in 0..PROGRAMS {
        let has_bulk = seed % 4 == 0;
        let Some(wasm) = random(seed, has_bulk) else { continue };
        let (mut module, exports) = match Module::read(&wasm) {
            Ok(read) => read,
            Err(refusal) => {
                // Modules that change tables are rejected, and so are modules that cannot be instantiated: the other
                // interpreter cannot either.
                refused += 1;
                assert!(has_bulk || reference(&wasm, 2).is_none(), "seed {seed}: {refusal}");
                continue;
            }
        };
        let Some(expected) = reference(&wasm, module.pages) else { continue };
        let mut memory = vec![0; module.pages * PAGE];
        module.fill(&mut memory);
        let mut globals: Vec<u64> = module.globals.iter().map(|(value, _)| *value).collect();
        let mut stack = Stack::default();
        for (name, (end, after)) in ["cycle", "other", "cycle", "other"].iter().zip(expected) {
            module.entry = exports[*name].1;
            let mut fuel = FUEL;
            let result = assert_no_alloc(|| run::call(&module, &mut memory, &mut globals, &mut stack, &mut fuel));
            let mine = match result {
                Ok(()) => End::Done,
                Err(Trap::StackOverflow) => End::Overflowed,
                Err(Trap::OutOfFuel) => End::Spent,
                Err(_) => End::Trapped,
            };
            if [&mine, &end].into_iter().any(|end| matches!(end, End::Overflowed | End::Spent)) {
                break;
            }
            assert_eq!(mine, end, "seed {seed}, {name}: {result:?}");
            assert!(memory == after, "seed {seed}, {name}: memory differs");
            compared += 1;
            traps += u32::from(end == End::Trapped);
        }
    }
    assert!(compared > 2 * PROGRAMS && traps > 1000, "{compared} calls, {traps} traps, {refused} refused");
}
