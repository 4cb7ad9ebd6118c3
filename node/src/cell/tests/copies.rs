//! Tests copies in speed control: key `quantity`.

use crate::cell::Cell;
use lineshaft_core::function::Quantity;

/// Reads a cell with a rotary and a linear axis, and these functions.
fn read(functions: &str) -> Result<Cell, String> {
    let axis = |kind: &str, address: u8, scale: &str, unit: &str| {
        format!(
            "{{type: {kind}, scale: {{increments: 36000, per: {scale}}}, drive: {{backend: plant, address: {address}, interface: position}}, \
             max_velocity: 10 {unit}/s, max_acceleration: 100 {unit}/s^2, sim: {{model: ideal}}}}"
        )
    };
    let (disc, slide) = (axis("rotary", 0, "360 deg", "rad"), axis("linear", 1, "1 m", "m"));
    let text = format!(
        "lineshaft: 1\ncycle: 1 ms\nbackends: {{plant: {{type: sim}}}}\nmemory: {{md: {{type: i32}}}}\n\
         axes: {{disc: {disc}, slide: {slide}}}\nfunctions: {{{functions}}}\n"
    );
    Cell::parse("c.yaml", text).map_err(|problems| problems.to_string())
}

/// Proves: AMK-GEN-16, AMK-GEN-18
#[test]
fn copies_have_the_quantity_given_in_the_cell() {
    for kind in ["dcopy", "ecopy"] {
        let quantity = |key: &str| {
            let cell = read(&format!("f: {{slot: 0, type: {kind}, source: md, sink: disc{key}}}")).unwrap();
            cell.machine.slots[0].quantity
        };
        assert_eq!(quantity(""), Quantity::Position);
        assert_eq!(quantity(", quantity: position"), Quantity::Position);
        assert_eq!(quantity(", quantity: speed"), Quantity::Speed);
    }
}

/// Proves: AMK-GEN-18
#[test]
fn copies_that_mistake_speeds_and_positions_are_refused() {
    let turn = "turn: {slot: 0, type: digdreh, sink: none}";
    let gear = "gear: {slot: 0, type: varsync, source: slide, sink: none}";
    let copy = "type: dcopy, source";
    for (functions, sentence) in [
        (
            format!("{turn}, f: {{slot: 1, {copy}: turn.sink, sink: disc}}"),
            "quantity is position; its source `turn.sink` is a speed",
        ),
        (
            format!(
                "{turn}, f: {{slot: 1, {copy}: turn.sink, sink: none}}, g: {{slot: 2, {copy}: f.sink, sink: disc}}"
            ),
            "quantity is position; its source `turn.sink` is a speed",
        ),
        (
            format!("{turn}, f: {{slot: 1, {copy}: turn.sink, sink: md}}, g: {{slot: 2, {copy}: f.sink, sink: disc}}"),
            "quantity is position; its source `turn.sink` is a speed",
        ),
        (
            format!("{turn}, f: {{slot: 1, type: ecopy, mode: 2, source: turn.sink, sink: disc}}"),
            "quantity is position; its source `turn.sink` is a speed",
        ),
        (
            format!("f: {{slot: 9, {copy}: turn.sink, sink: disc}}, turn: {{slot: 3, type: digdreh, sink: none}}"),
            "quantity is position; its source `turn.sink` is a speed",
        ),
        (
            format!("{gear}, f: {{slot: 1, {copy}: gear.sink, sink: disc, quantity: speed}}"),
            "quantity is speed; its source `gear.sink` is a position",
        ),
        (
            format!("f: {{slot: 1, {copy}: slide, sink: disc, quantity: speed}}"),
            "quantity is speed; its source `slide.command.position` is a position",
        ),
        (
            format!("f: {{slot: 1, {copy}: md, sink: slide, quantity: speed}}"),
            "type dcopy gives a speed in rpm; its sink `slide` is no rotary axis",
        ),
        (
            format!("f: {{slot: 1, {copy}: md, sink: disc, quantity: force}}"),
            "quantity is `force`; one of position, speed is allowed",
        ),
        (
            "f: {slot: 1, type: varsync, source: md, sink: disc, quantity: speed}".to_owned(),
            "unknown key `quantity` in function `f`",
        ),
    ] {
        let problems = read(&functions).unwrap_err();
        assert!(problems.contains(sentence) && problems.lines().count() == 1, "{functions}: {problems}");
    }
    for good in [
        format!("{turn}, f: {{slot: 1, {copy}: turn.sink, sink: disc, quantity: speed}}"),
        format!("{turn}, f: {{slot: 1, {copy}: turn.sink, sink: none, quantity: speed}}"),
        format!("{turn}, f: {{slot: 1, {copy}: turn.sink, sink: md}}"),
        format!("{gear}, f: {{slot: 1, {copy}: gear.sink, sink: disc}}"),
        format!("f: {{slot: 1, {copy}: md, sink: disc, quantity: speed}}"),
        // No axis is moved.
        format!("{turn}, f: {{slot: 1, {copy}: turn.sink, sink: none}}"),
        format!("{turn}, f: {{slot: 1, {copy}: turn.sink, sink: none}}, g: {{slot: 2, {copy}: f.sink, sink: md}}"),
        format!(
            "{turn}, f: {{slot: 1, {copy}: g.sink, sink: none}}, g: {{slot: 2, {copy}: f.sink, sink: none, quantity: speed}}"
        ),
        // Neither reads its source: E1 selects one of two values (AMK-ECOPY-03).
        format!("{turn}, f: {{slot: 1, type: ecopy, mode: 3, source: turn.sink, sink: disc}}"),
        format!(
            "{turn}, f: {{slot: 1, {copy}: turn.sink, sink: none}}, \
             g: {{slot: 2, type: ecopy, mode: 3, source: f.sink, sink: disc}}"
        ),
    ] {
        assert!(read(&good).is_ok(), "{good}: {:?}", read(&good).err());
    }
}
