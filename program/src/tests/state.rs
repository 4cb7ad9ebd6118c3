//! State is plain data: a copy, and a serialized and restored state, continue like the original.

use super::{FUEL, call, load, program};
use crate::{Image, Instance, Module};

/// Counts in a global and in its own part of the image, and outputs the product as sink; -(2^31) in each third call.
const COUNTS: &str = "(global $n (mut i32) (i32.const 3))
    (func (export \"cycle\")
      (global.set $n (i32.add (global.get $n) (i32.const 1)))
      (i64.store (i32.const 960) (i64.add (i64.load (i32.const 960)) (i64.load (i32.const 24))))
      (i64.store (i32.const 40) (i64.mul (i64.load (i32.const 960)) (i64.extend_i32_u (global.get $n)))))";

fn sink(instance: &mut Instance, module: &Module, source: i64) -> i64 {
    instance.image(module).set_source(source, 0);
    call(instance, module, FUEL).expect("it comes to its end");
    instance.image(module).sink()
}

#[test]
fn a_copy_goes_on_as_the_original_does() {
    let module = load(&program(COUNTS));
    let mut instance = Instance::new(&module, 2);
    // (0 + 7) * 4, (7 + 5) * 5
    assert_eq!([sink(&mut instance, &module, 7), sink(&mut instance, &module, 5)], [28, 60]);
    let mut copy = instance.clone();
    let written = postcard::to_allocvec(&instance).unwrap();
    let mut read: Instance = postcard::from_bytes(&written).unwrap();
    assert!(read == instance && read.belongs_to(&module));
    // Trailing zeros are not stored: the image is 960 bytes long.
    assert!(written.len() < 1000, "{}", written.len());
    let mut other = Instance::new(&module, 2);
    assert_no_alloc::assert_no_alloc(|| other.clone_from(&instance));
    for instance in [&mut instance, &mut copy, &mut read, &mut other] {
        assert_eq!(sink(instance, &module, 1), 13 * 6);
        assert!(instance.has_room(&module));
    }
}

#[test]
fn any_restored_state_is_handled() {
    let module = load(&program(COUNTS));
    let whole = postcard::to_allocvec(&Instance::new(&module, 1)).unwrap();
    let mut taken = 0;
    for at in 0..whole.len() {
        for byte in [0, 1, 0x80, 0xFF] {
            let mut broken = whole.clone();
            broken[at] = byte;
            if let Ok(mut read) = postcard::from_bytes::<Instance>(&broken)
                && read.belongs_to(&module)
            {
                taken += 1;
                let _ = call(&mut read, &module, FUEL);
            }
        }
    }
    assert!(taken > 0);
    // A global of 32 bits with more bits, a memory of another size, an overwritten size of the image.
    let other = load(
        "(module (memory 2) (global (export \"image\") i32 (i32.const 16)) (data (i32.const 16) \"\\b0\\03\") (func (export \"cycle\")))",
    );
    assert!(!Instance::new(&module, 2).belongs_to(&other));
}

#[test]
fn a_restart_forgets_all() {
    let module = load(&program(COUNTS));
    let mut instance = Instance::new(&module, 1);
    sink(&mut instance, &module, 7);
    assert_no_alloc::assert_no_alloc(|| instance.restart(&module));
    assert!(instance == Instance::new(&module, 1));
}

#[test]
fn an_exchange_keeps_the_programs_own_part_and_begins_all_else_anew() {
    let module = load(&program(COUNTS));
    // The same, but ten times the sum.
    let next = load(&program(&COUNTS.replace("(global.get $n))))", "(i32.const 10))))")));
    let mut instance = Instance::new(&module, 1);
    sink(&mut instance, &module, 7);
    assert!(assert_no_alloc::assert_no_alloc(|| instance.exchange((&next, &module), true)));
    assert_eq!(sink(&mut instance, &next, 1), 80);
    // A module with another length is rejected, and nothing changes.
    let longer = load(&program(COUNTS).replace("\\c0\\03", "\\c8\\03"));
    let before = instance.clone();
    assert!(!instance.exchange((&longer, &next), true) && instance == before);
}

/// A failed state may have been restored with any memory.
#[test]
fn exchange_of_instance_without_memory_restarts() {
    let module = load(&program(COUNTS));
    let mut instance = Instance::with_room(1);
    assert!(instance.exchange((&module, &module), false));
    assert!(instance == Instance::new(&module, 1));
}

#[test]
fn an_image_takes_what_it_has_places_for() {
    let mut bytes = vec![0; crate::SIZE];
    let mut image = Image::new(&mut bytes);
    for place in [crate::WORDS, usize::MAX] {
        image.set_read(place, u64::MAX);
        image.set_write(place, u64::MAX);
        image.set_parameter(place, -1);
        assert_eq!(image.write(place), 0);
    }
    assert!(bytes.iter().all(|byte| *byte == 0));
    let mut image = Image::new(&mut bytes);
    image.set_db((0..1000).map(|word| word + 1));
    image.set_db([7, 8].into_iter());
    assert_eq!(bytes[424..438], [2, 0, 0, 0, 0, 0, 0, 0, 7, 0, 8, 0, 0, 0]);
    assert!(bytes[438..].iter().all(|byte| *byte == 0));
}

#[test]
fn the_module_is_written_as_its_bytes() {
    let module = load(&program(COUNTS));
    let written = postcard::to_allocvec(&module).unwrap();
    assert_eq!(postcard::from_bytes::<Module>(&written).unwrap(), module);
    assert!(postcard::from_bytes::<Module>(&written[..20]).is_err());
}
