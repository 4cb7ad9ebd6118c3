//! Tests section `programs`, and functions that run them.

use super::Cell;
use crate::program;
use lineshaft_core::function::Quantity;
use serde_json::json;

const FB10: &[u8] = include_bytes!("../../../../launch-configs/functions/programs/fb10.wasm");

/// Reads a cell with a program and this function, as from a recording.
fn read(function: &str) -> Result<Cell, String> {
    let text = format!(
        "lineshaft: 1\n\
         cycle: 2 ms\n\
         backends: {{plant: {{type: sim}}}}\n\
         io: {{e: {{type: di, backend: plant, address: 0}}}}\n\
         memory: {{md: {{type: i32}}, m: {{type: bit}}, r: {{type: f64}}}}\n\
         axes:\n\
         \x20 disc: {{type: rotary, unit: deg, scale: {{increments: 20000, per: 360 deg}}, drive: {{backend: plant, address: 0, interface: position}}, max_velocity: 3000 rpm, max_acceleration: 100000 deg/s^2, max_following_error: 20000 inc, sim: {{model: ideal}}}}\n\
         \x20 slide: {{type: linear, unit: mm, scale: {{increments: 1000, per: 1 mm}}, drive: {{backend: plant, address: 1, interface: position}}, max_velocity: 100 mm/s, max_acceleration: 1 m/s^2, max_following_error: 1 mm, sim: {{model: ideal}}}}\n\
         programs: {{fb10: {{wasm: fb10.wasm}}}}\n\
         functions: {{f: {{slot: 0, {function}}}}}\n"
    );
    let files = json!({"fb10.wasm": program::encode(FB10)}).to_string();
    Cell::parse_recorded("c.yaml", text, Some(&files)).map_err(|problems| problems.to_string())
}

/// Proves: AMK-APSF-40, AMK-APSF-42, AMK-APSF-44
#[test]
fn a_function_runs_a_program_by_its_name() {
    let cell = read(
        "type: apsf, program: fb10, source: disc.actual, sink: disc, quantity: speed, inputs: [e], outputs: [none, m], out_bits: 1, \
         parameter: [7, -8], fuel: 77, reads: [md, disc.command.velocity], writes: [r], cycle_factor: 2",
    )
    .unwrap();
    let slot = &cell.machine.slots[0];
    assert_eq!((slot.program, slot.fuel, slot.quantity), (Some(0), 77, Quantity::Speed));
    assert_eq!((&*slot.reads, &*slot.writes), (&["md".to_owned(), "disc.command.velocity".to_owned()][..], &[2][..]));
    assert_eq!(slot.values[..4], [1, 7, -8, 0]);
    let plain = read("type: apsf, program: fb10").unwrap();
    assert_eq!((plain.machine.slots[0].fuel, plain.machine.slots[0].quantity), (50_000, Quantity::Position));
}

/// Other data in the parameter set of the source controller is configured elsewhere or has no effect.
///
/// Proves: AMK-APSF-39, AMK-APSF-43
#[test]
fn invalid_programs_are_refused_at_their_places() {
    for (function, sentence) in [
        ("type: apsf", "function `f` has no program; type apsf runs one"),
        ("type: apsf, program: fb11", "program is `fb11`; no program has that name"),
        ("type: dcopy, source: md, sink: none, program: fb10", "unknown key `program`"),
        ("type: apsf, program: fb10, fuel: 0", "fuel is 0; 1..10000000 is allowed"),
        ("type: apsf, program: fb10, quantity: force", "quantity is `force`; one of position, speed is allowed"),
        ("type: apsf, program: fb10, reads: [nothing]", "reads[0] is `nothing`; no "),
        ("type: apsf, program: fb10, reads: [disc.nothing]", "reads[0] is `disc.nothing`; no signal has that name"),
        ("type: apsf, program: fb10, writes: [e]", "writes[0] is `e`"),
        ("type: apsf, program: fb10, writes: [md, md]", "what writes `md` is taken already, at 10:"),
        ("type: apsf, program: fb10, out_bits: 9", "out_bits is 9; 0..8 is allowed"),
        (
            "type: apsf, program: fb10, sink: slide, quantity: speed",
            "gives a speed in rpm; its sink `slide` is no rotary axis",
        ),
        ("type: apsf, program: fb10, sf_cycle: 4", "unknown key `sf_cycle`"),
        ("type: apsf, program: fb10, ba: 0", "unknown key `ba`"),
        ("type: apsf, program: fb10, fb_number: 10", "unknown key `fb_number`"),
    ] {
        let problems = read(function).unwrap_err();
        assert!(problems.contains(sentence), "{function}: {problems}");
    }
    let many = format!("type: apsf, program: fb10, reads: [{}]", ["md"; 17].join(", "));
    assert!(read(&many).unwrap_err().contains("reads has 17 entries; at most 16 are possible"));
    // A sink that is a linear axis gets positions.
    read("type: apsf, program: fb10, sink: slide").unwrap();
}
