//! Tests section `masters`.

use super::sections::three_axes;
use super::{assert_said, good, said};
use lineshaft_core::config::SourceConfig;
use lineshaft_core::machine::Machine;
use lineshaft_core::object::Leader;

/// Returns a cell with a belt and two functions, whose slots are in reverse order; masters begin in line 13.
fn with(functions: &str, masters: &str) -> String {
    let belt = "encoders: {belt: {backend: plant, address: 0, type: linear, scale: {increments: 1, per: 1 mm}}}\n";
    three_axes(&format!("{belt}functions: {{{functions}}}\nmasters:\n{masters}"))
}

fn cell(masters: &str) -> String {
    let function = |name, slot| format!("{name}: {{slot: {slot}, type: dcopy, source: x, sink: none}}");
    with(&format!("{}, {}", function("f", 3), function("g", 1)), masters)
}

#[test]
fn members_are_resolved() {
    let cell = good(&cell(
        "  sum: {add: [belt, x.actual, other], subtract: [turret, f.sink, g.sink, machine.vmaster]}\n  other: {subtract: [line.command]}\n",
    ));
    let [sum, other] = cell.machine.masters.as_slice() else { panic!("two masters") };
    assert_eq!((sum.name.as_str(), other.name.as_str()), ("sum", "other"));
    assert_eq!(sum.add, [Leader::Encoder(0), Leader::AxisActual(1), Leader::Sum(1)]);
    // Sinks have indices in the order of the slots.
    assert_eq!(sum.subtract, [Leader::AxisCommand(2), Leader::Sink(1), Leader::Sink(0), Leader::Virtual]);
    assert_eq!((other.add.len(), other.subtract.as_slice()), (0, &[Leader::AxisCommand(0)][..]));
    let signals = cell.machine.directory();
    let of_sum: Vec<_> =
        signals.iter().map(|(_, entry)| entry.name.as_str()).filter(|name| name.starts_with("sum.")).collect();
    assert_eq!(of_sum, ["sum.position", "sum.velocity", "sum.valid", "sum.fraction"]);
    assert!(Machine::new(cell.machine).is_ok());
}

#[test]
fn invalid_masters_are_refused_at_their_places() {
    for (text, sentence) in [
        (
            "{add: [x, ^bolt]}",
            "add[1] is `bolt`; no axis, encoder, function, master has that name, did you mean `belt`?",
        ),
        ("{add: [^plant]}", "add[0] is `plant`, which is a backend; axis, encoder, function, master is allowed"),
        ("{subtract: [^x.target]}", "subtract[0] is `x.target`; `x`, `x.command` or `x.actual` is allowed"),
        (
            "{add: [^machine.vmaste]}",
            "add[0] is `machine`; no axis, encoder, function, master has that name, there are line, x, turret, belt, f, g, sum",
        ),
        ("{add: [^belt.velocity]}", "add[0] is `belt.velocity`; `belt` is allowed"),
        ("{add: [^f]}", "add[0] is `f`; `f.sink` is allowed"),
        ("{add: [belt, x, ^belt]}", "`belt` is a member already, at 13:15; a member stands once"),
        ("{add: [x], subtract: [^x.command]}", "`x.command` is a member already, at 13:15; a member stands once"),
        ("^{}", "master `sum` adds up nothing; names of one leader or more are expected in add or subtract"),
        (
            "^{add: [], subtract: []}",
            "master `sum` adds up nothing; names of one leader or more are expected in add or subtract",
        ),
        ("{add: ^belt}", "add is `belt`; a list is expected"),
        ("^[belt]", "sum is a list; a mapping is expected"),
        ("{add: [belt], ^substract: [x]}", "unknown key `substract` in master `sum`, did you mean `subtract`?"),
        ("{add: [^sum]}", "masters are members of each other in a loop: sum -> sum"),
    ] {
        assert_said(&cell(&format!("  sum: {text}\n")), sentence);
    }
    assert_said(
        &cell("  a: {add: [c]}\n  b: {subtract: [a, belt]}\n  c: {add: [x, ^b]}\n"),
        "masters are members of each other in a loop: c -> a -> b -> c",
    );
}

/// Tests each limit: `x` in 17 masters would be 17 members; the n-th master of two earlier ones has more than 64
/// leaders.
#[test]
fn there_is_room_for_so_many() {
    let masters = |count: usize, text: &dyn Fn(usize) -> String| -> String {
        (0..count).map(|nth| format!("  m{nth}: {{add: [{}]}}\n", text(nth))).collect()
    };
    let belts = |count| masters(count, &|_| "belt".to_owned());
    good(&cell(&belts(64)));
    assert_eq!(said(&cell(&belts(65))), "77:3: 65 entries exceed the maximum of this section, 64");
    let of = |count: usize| {
        let names: Vec<_> = (0..count).map(|nth| format!("m{nth}")).collect();
        format!("{}  all: {{add: [{}]}}\n", belts(count), names.join(", "))
    };
    good(&cell(&of(16)));
    assert_said(&cell(&of(17).replace(", m16]", ", ^m16]")), "master `all` has 17 members; at most 16 are possible");
    // 2, 4, 6, 10, 16, 26, 42, 68, 110 leaders.
    let doubled = masters(9, &|nth| match nth {
        0 => "x, belt".to_owned(),
        1 => "m0, line, turret".to_owned(),
        nth => format!("m{}, m{}", nth - 1, nth - 2),
    });
    let marked = doubled.replace("  m7:", "  ^m7:");
    assert_said(&cell(&marked), "master `m7` has more than 64 leaders, itself and through other masters");
}

#[test]
fn names_are_unique_in_all_sections() {
    assert_said(&cell("  ^belt: {add: [x]}\n"), "`belt` is an encoder already, at 10:12; a name stands once");
    assert!(said(&cell("  Sum: {add: [x]}\n")).starts_with("13:3: "));
}

#[test]
fn functions_and_selectors_read_masters() {
    let masters = "  sum: {add: [belt, x]}\n";
    let function = |source: &str| format!("f: {{slot: 0, type: dcopy, source: {source}, sink: none}}");
    for source in ["sum", "sum.position"] {
        let cell = good(&with(&function(source), masters));
        assert_eq!(cell.machine.slots[0].source, SourceConfig::Lead(Leader::Sum(0)), "{source}");
    }
    let cell = good(&with(&function("sum.velocity"), masters));
    assert_eq!(cell.machine.slots[0].source, SourceConfig::Signal("sum.velocity".into()));
    let unknown = said(&with(&function("sum.speed"), masters));
    assert!(unknown.contains("no signal has that name"), "{unknown}");
    for source in ["machine.vmaster", "machine.vmaster.position"] {
        let cell = good(&with(&function(source), masters));
        assert_eq!(cell.machine.slots[0].source, SourceConfig::Lead(Leader::Virtual), "{source}");
    }
    let selector = |master: &str| cell_of_selectors(&[("x", master)]);
    assert_eq!(good(&selector("machine.vmaster")).machine.axes[1].vocabularies.amc.master, Some(Leader::Virtual));
    assert_eq!(good(&selector("sum")).machine.axes[1].vocabularies.amc.master, Some(Leader::Sum(0)));
    let refused = said(&selector("sum.position"));
    assert!(refused.ends_with(": master is `sum.position`; `sum` is allowed"), "{refused}");
}

/// Returns a cell with axes x and turret and these masters of their selectors; `sum` has the actual position of x,
/// `all` its command through `part` and f.
fn cell_of_selectors(selectors: &[(&str, &str)]) -> String {
    let masters = "  sum: {add: [belt, x.actual]}\n  all: {subtract: [part, belt]}\n  part: {add: [f.sink]}\n";
    let mut text = with("f: {slot: 0, type: dcopy, source: x, sink: none}", masters);
    for (axis, master) in selectors {
        let (before, behind) = text.split_once(&format!("  {axis}: {{")).expect("the axis");
        let (keys, rest) = behind.split_once("}\n").expect("its end");
        text = format!("{before}  {axis}: {{{keys}, amc: {{master: {master}}}}}\n{rest}");
    }
    text
}

#[test]
fn loops_through_masters_are_refused() {
    // Through a sum of a function that reads x: x -> turret -> x, and x itself.
    let looped = said(&cell_of_selectors(&[("x", "turret"), ("turret", "all")]));
    let sentence = "reference selectors follow each other's axes in a loop: turret -> x -> turret, follow `x.actual`";
    assert!(looped.ends_with(sentence), "{looped}");
    assert!(said(&cell_of_selectors(&[("x", "all")])).contains("in a loop: x -> x"));
    for good_ones in [[("x", "turret"), ("turret", "sum")], [("x", "sum"), ("turret", "all")]] {
        let cell = good(&cell_of_selectors(&good_ones));
        assert!(Machine::new(cell.machine).is_ok());
    }
    // Functions: turret reads x through a sum, and with the second one x follows turret.
    let functions = |source: &str| {
        let slot = |name, slot, source: &str, sink| {
            format!("{name}: {{slot: {slot}, type: varsync, source: {source}, sink: {sink}}}")
        };
        with(
            &format!("{}, {}", slot("f", 0, source, "turret"), slot("g", 1, "turret", "x")),
            "  sum: {add: [belt], subtract: [x]}\n  act: {add: [x.actual]}\n",
        )
    };
    let looped = said(&functions("sum"));
    assert!(looped.contains("axes follow each other's commands in a loop: x -> turret -> x"), "{looped}");
    good(&functions("act"));
}
