//! Tests printed marks that an input detects in the simulation.

use super::*;
use lineshaft_core::position::Position;
use lineshaft_core::sim::{Carrier, Marks, Stretch};

/// Returns a cell whose second input has these keys; `other` is a second simulation.
fn cell(keys: &str) -> String {
    format!(
        "lineshaft: 1\ncycle: 1 ms\nbackends: {{p: {{type: sim}}, other: {{type: sim}}}}\nio:\n  gate: {{type: di, backend: p, address: 0}}\n  \
         product: {{{keys}}}\nencoders:\n  belt: {{backend: p, address: 0, type: linear, scale: {{increments: 15, per: 4 mm}}}}\n  \
         far: {{backend: other, address: 0, type: linear, scale: {{increments: 10, per: 1 mm}}}}\naxes:\n  line: {{type: linear, drive: virtual, \
         scale: {{increments: 10, per: 1 mm}}, max_velocity: 1 m/s, max_acceleration: 1 m/s^2}}\n  roll: {{type: rotary, drive: {{backend: p, \
         address: 3}}, scale: {{increments: 3600, per: 360 deg}}, max_velocity: 1 rev/s, max_acceleration: 1 rev/s^2, sim: {{model: ideal, \
         home_switch: {{from: 0 deg, to: 5 deg, input: gate}}}}}}\n"
    )
}

fn input(marks: &str) -> String {
    cell(&format!("type: di, backend: p, address: 1, latch: true, sim: {{marks: {{{marks}}}}}"))
}

/// 3.75 inc per mm: 100 mm are 375 inc, 0.2 mm are 0.75 inc.
#[test]
fn marks_are_in_units_of_their_way() {
    let all = "of: belt, every: 100 mm, first: -50 mm, stretch: 0.1 %, stretch_period: 200, lost: 2 %, extra: 0.01, jitter: 0.2 mm, width: 1 inc, seed: 7";
    let read = good(&input(all));
    let expected = CellMarks {
        input: 1,
        carrier: Carrier::Encoder(0),
        marks: Marks {
            every: Position::whole(375),
            first: Position::from_f64(-187.5),
            width: Position::whole(1),
            jitter: Position::from_f64(0.75),
            stretch: Some(Stretch { share: 0.001, period: 200 }),
            missing_share: 0.02,
            extra: 0.01,
            seed: 7,
        },
    };
    assert_eq!(read.marks, [expected]);
    let bare = Marks { every: Position::whole(900), ..Marks::default() };
    let expected = CellMarks { input: 1, carrier: Carrier::Drive(0), marks: bare };
    assert_eq!(good(&input("of: roll, every: 90 deg")).marks, [expected]);
    assert_eq!(good(&cell("type: di, backend: p, address: 1")).marks, []);
}

/// The belt moves 75 inc in a cycle: the mark at 50 inc passes, and the level of a mark 40 inc long is active.
#[test]
fn the_plant_of_a_cell_has_its_marks() {
    use lineshaft_core::drive::{Backend as _, Edge};
    use lineshaft_core::object::Object;
    let read = good(&input("of: belt, every: 100 inc, first: 50 inc, width: 40 inc"));
    let mut plant = read.plant();
    let mut inputs = Machine::new(read.machine.clone()).unwrap().inputs();
    plant.read(&mut inputs);
    plant.jump_encoder(0, 75);
    inputs.begin(1, 0);
    plant.read(&mut inputs);
    let [latch] = inputs.latch[..] else { panic!("{:?}", inputs.latch) };
    assert_eq!((latch.object, latch.edge, latch.age_ns), (Object::Io(1), Edge::Rising, Some(333_333)));
    assert!(inputs.digital(1));
    // Other backends have no marks.
    let mut other = read.plant_of(|backend| backend.name == "other");
    other.read(&mut inputs);
    other.jump_encoder(0, 75);
    inputs.begin(2, 0);
    other.read(&mut inputs);
    assert_eq!(inputs.latch, []);
}

#[test]
fn marks_that_cannot_be_are_refused() {
    for (keys, expected) in [
        ("every: 1 mm", "6:73: missing key `of` in marks"),
        ("of: belt", "6:73: missing key `every` in marks"),
        ("of: blt, every: 1 mm", "6:78: of is `blt`; no encoder, axis has that name, did you mean `belt`?"),
        ("of: product, every: 1 mm", "6:78: of is `product`, which is an input or output; encoder, axis is allowed"),
        (
            "of: line, every: 1 mm",
            "6:78: of is `line`, which is virtual; an encoder or an axis with a drive is allowed",
        ),
        ("of: far, every: 1 mm", "6:78: of is `far`, which is on backend `other`; one on `p` is allowed"),
        ("of: belt, every: 0 mm", "6:91: every is `0 mm`; a value above 0 is allowed"),
        ("of: belt, every: -1 mm", "6:91: every is `-1 mm`; a value above 0 is allowed"),
        (
            "of: belt, every: 0.1 mm",
            "6:91: every is `0.1 mm`, which is less than an increment; 1 inc and above is allowed",
        ),
        ("of: belt, every: 1 s", "6:91: every: `1 s` is a time; a length such as `1 mm` is expected"),
        ("of: belt, every: 10 mm, lost: 101 %", "6:104: lost is `101 %`; 0 %..100 % is allowed"),
        ("of: belt, every: 10 mm, extra: -1 %", "6:105: extra is `-1 %`; 0 %..100 % is allowed"),
        ("of: belt, every: 10 mm, stretch: 2, stretch_period: 9", "6:107: stretch is `2`; 0 %..100 % is allowed"),
        (
            "of: belt, every: 10 mm, stretch: 2 %",
            "6:107: stretch needs stretch_period, the marks until the web is the same again",
        ),
        (
            "of: belt, every: 10 mm, stretch_period: 9",
            "6:114: stretch_period is for marks with a stretch, leave it out",
        ),
        (
            "of: belt, every: 10 mm, stretch: 2 %, stretch_period: 1",
            "6:128: stretch_period is 1; 2..1000000 is allowed",
        ),
        ("of: belt, every: 10 mm, width: 5 mm", "6:105: width is `5 mm`; less than half of every, `10 mm`, is allowed"),
        ("of: belt, every: 10 mm, width: -5 mm", "6:105: width is `-5 mm`; 0 and above is allowed"),
        ("of: belt, every: 10 mm, seed: -1", "6:104: seed is -1; 0..18446744073709551615 is allowed"),
        ("of: belt, every: 10 mm, widht: 1 mm", "6:98: unknown key `widht` in marks, did you mean `width`?"),
    ] {
        assert_eq!(said(&input(keys)), expected, "{keys}");
    }
    let overlap =
        "6:73: marks could overlap; width and jitter together less than half of every without its stretch are allowed";
    for keys in ["width: 2 mm, jitter: 3 mm", "width: 2 mm, stretch: 60 %, stretch_period: 9", "jitter: 5 mm"] {
        assert_eq!(said(&input(&format!("of: belt, every: 10 mm, {keys}"))), overlap, "{keys}");
    }
}

#[test]
fn inputs_that_see_no_marks_are_refused() {
    let sim = "sim: {marks: {of: belt, every: 10 mm}}";
    for (keys, expected) in [
        (
            format!("type: di, backend: p, address: 1, {sim}"),
            "6:52: marks are for an input with latch: true; this one latches nothing",
        ),
        (format!("type: ai, backend: p, address: 1, {sim}"), "6:52: sim is for type di; this one is ai, leave it out"),
        (format!("type: di, output: lamp, {sim}"), "6:42: sim is for an input on a backend of type sim, leave it out"),
        (
            "type: di, backend: p, address: 1, latch: true, sim: {mark: {of: belt}}".to_owned(),
            "6:66: unknown key `mark` in sim, did you mean `marks`?",
        ),
    ] {
        let lamp = "  lamp: {type: do, backend: p, address: 0}\nencoders:";
        assert_eq!(said(&cell(&keys).replace("encoders:", lamp)), expected, "{keys}");
    }
    let shared = input("of: belt, every: 10 mm").replace("input: gate", "input: product");
    let sentence = "6:65: marks are for an input of their own; a switch of an axis is wired to this one";
    assert_eq!(said(&shared), sentence);
    let on_can = input("of: belt, every: 10 mm")
        .replace("p: {type: sim}", "p: {type: sim}, bus0: {type: can, transport: 'socketcan:can0'}");
    let on_can = on_can.replace("backend: p, address: 1, latch: true", "backend: bus0, node: 5, address: 1");
    assert_eq!(said(&on_can), "6:64: sim is for an input on a backend of type sim, leave it out");
}
