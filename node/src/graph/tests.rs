//! Tests links, loops and the figure of small cells.

use super::links::{Port, ports};
use super::{draw, loops};
use crate::cell::Cell;
use lineshaft_core::config::MachineConfig;
use std::path::Path;

/// Returns a machine with axes x and y, an encoder, inputs, outputs and memory, and these functions.
fn machine(functions: &str) -> MachineConfig {
    let axis = |address: u8| {
        format!(
            "{{type: rotary, scale: {{increments: 36000, per: 360 deg}}, drive: {{backend: plant, address: {address}}}, \
             max_velocity: 90 deg/s, max_acceleration: 360 deg/s^2, sim: {{model: ideal}}}}"
        )
    };
    let text = format!(
        "lineshaft: 1\ncycle: 1 ms\nbackends: {{plant: {{type: sim}}}}\n\
         io: {{go: {{type: di, backend: plant, address: 0}}, lamp: {{type: do, backend: plant, address: 0}}, \
         back: {{type: di, output: lamp}}, volts: {{type: ao, backend: plant, address: 0}}}}\n\
         memory: {{feed: {{type: i32}}, copy: {{type: i32}}, flag: {{type: bit}}}}\n\
         encoders: {{belt: {{backend: plant, address: 0, type: linear, scale: {{increments: 1, per: 1 mm}}}}}}\n\
         tables: {{t: {{form: words, words: [2, 0, 0, 0, 100, 0, 0, 0]}}}}\n\
         axes: {{x: {}, y: {}}}\nfunctions:\n{functions}",
        axis(0),
        axis(1)
    );
    Cell::parse("c.yaml", text).unwrap_or_else(|problems| panic!("{problems}")).machine
}

/// Returns the ports of a slot: label, name, and whether the value is that of the last cycle.
fn said(machine: &MachineConfig, slot: u16) -> Vec<String> {
    let say = |port: Port| {
        let way = if port.is_output { "->" } else { "<-" };
        format!("{} {way} {}{}", port.label, port.name, if port.is_late { " (late)" } else { "" })
    };
    ports(machine, slot).into_iter().map(say).collect()
}

#[test]
fn slot_reads_values_of_earlier_slots_in_the_same_cycle() {
    let machine = machine(
        "  a: {slot: 3, type: varsync, source: belt, sink: feed, inputs: [go, {name: flag, inverted: true}], outputs: [lamp], \
         mode: 0}\n  \
         b: {slot: 5, type: varsync, source: a.sink, sink: x, mode: 3, word_addr: feed}\n  \
         c: {slot: 7, type: dcopy, source: x.actual, sink: volts}\n  \
         d: {slot: 8, type: ecopy, source: d.sink, sink: none, inputs: [flag], outputs: [flag]}\n  \
         e: {slot: 9, type: binea, source: machine.overruns, tables: [t], tracks: 1}\n",
    );
    assert_eq!(
        said(&machine, 0),
        ["source <- belt.position", "E1 <- go", "E2 <- not flag (late)", "sink -> feed", "A1 -> lamp"]
    );
    assert_eq!(said(&machine, 1), ["source <- a.sink", "word <- feed", "sink -> x"]);
    assert_eq!(said(&machine, 2), ["source <- x.actual.position", "sink -> volts"]);
    assert_eq!(said(&machine, 3), ["source <- d.sink (late)", "E1 <- flag (late)", "A1 -> flag"]);
    assert_eq!(said(&machine, 4), ["source <- machine.overruns (late)"]);
}

#[test]
fn what_a_higher_slot_writes_is_the_last_cycles() {
    let machine = machine(
        "  a: {slot: 0, type: dcopy, source: b.sink, sink: none}\n  \
         b: {slot: 1, type: dcopy, source: lamp, sink: feed}\n  \
         c: {slot: 2, type: ecopy, source: copy, sink: copy, inputs: [back], outputs: [lamp]}\n",
    );
    assert_eq!(said(&machine, 0), ["source <- b.sink (late)"]);
    assert_eq!(said(&machine, 1), ["source <- lamp (late)", "sink -> feed"]);
    assert_eq!(said(&machine, 2), ["source <- copy (late)", "E1 <- back", "sink -> copy", "A1 -> lamp"]);
}

#[test]
fn a_watch_reads_the_axes_of_its_set() {
    let machine = machine("  a: {slot: 0, type: sidiff, sink: feed, outputs: [lamp], aw_mask: 129, display_aw: 2}\n");
    // The cell has no eighth axis.
    assert_eq!(said(&machine, 0), ["AW1 <- x (late)", "AW2 <- y (late)", "sink -> feed", "A1 -> lamp"]);
}

/// A drive reports its position before the slots are executed; two words are two links.
#[test]
fn positions_that_are_watched_are_this_cycles_and_each_word_is_a_link() {
    let functions = "  a: {slot: 0, type: fgen, fct: 4, aw_mask: 2, cycle_increments: 1, accel: 1}\n  \
                     b: {slot: 1, type: fgen, aw_mask: 2, cycle_increments: 1, accel: 1}\n  \
                     c: {slot: 2, type: regl, source: feed, src1_addr: a.sink, src2_addr: c.sink, gain_v: 1}\n";
    let machine = machine(functions);
    assert_eq!(said(&machine, 0), ["AW2 <- y"]);
    assert_eq!(said(&machine, 1), [""; 0], "without bits 1 and 2 of fct it watches none");
    assert_eq!(said(&machine, 2), ["source <- feed", "word <- a.sink", "word <- c.sink (late)"]);
    // A generator that monitors the axis that it moves makes no loop.
    let moved = "  a: {slot: 0, type: fgen, sink: x, fct: 7, aw_mask: 1, cycle_increments: 1, accel: 1}\n";
    assert_eq!(loops(&self::machine(moved)), [""; 0]);
}

/// Each member is a separate link: an encoder has the value of this cycle, a command that of the last one. The signals
/// of a master are those of the last cycle.
#[test]
fn a_slot_that_reads_a_master_of_several_reads_its_members() {
    let machine = machine(
        "  a: {slot: 0, type: dcopy, source: all, sink: none}\n  \
         b: {slot: 1, type: varsync, source: all.velocity, sink: feed, mode: 3, word_addr: sum.position}\n\
         masters: {all: {add: [sum, a.sink], subtract: [x]}, sum: {subtract: [belt, y.actual]}}\n",
    );
    assert_eq!(
        said(&machine, 0),
        [
            "source <- all + sum - belt.position",
            "source <- all + sum - y.actual.position",
            "source <- all + a.sink (late)",
            "source <- all - x.command.position (late)"
        ]
    );
    let late = |label, name| format!("{label} <- {name} (late)");
    let (source, word) = (late("source", "all.velocity"), late("word", "sum.position"));
    assert_eq!(said(&machine, 1), [&*source, &*source, &*source, &*source, &*word, &*word, "sink -> feed"]);
    assert_eq!(loops(&machine), ["function a reads itself: a -> a; a sees a as of the cycle before"]);
    let figure = draw(&machine, "c").expect("functions");
    assert!(figure.contains("source all + sum - belt.position"), "{figure}");
}

#[test]
fn slot_that_reads_itself_is_reported_with_its_path() {
    let told = |functions: &str| loops(&machine(functions));
    let both = "  a: {slot: 0, type: dcopy, source: b.sink, sink: none}\n  b: {slot: 1, type: dcopy, source: feed, sink: copy}\n";
    assert_eq!(told(both), [""; 0]);
    assert_eq!(
        told(&both.replace("sink: none", "sink: feed")),
        ["function a reads itself: a -> feed -> b -> a; a sees b as of the cycle before"]
    );
    assert_eq!(
        told("  a: {slot: 0, type: dcopy, source: a.sink, sink: none}\n"),
        ["function a reads itself: a -> a; a sees a as of the cycle before"]
    );
    assert_eq!(
        told("  a: {slot: 0, type: varsync, source: x.actual, sink: x, mode: 0}\n"),
        ["function a reads itself: a -> x -> a; a sees x as its drive tells it"]
    );
    assert_eq!(
        told("  a: {slot: 0, type: dcopy, source: x.following_error, sink: x}\n"),
        ["function a reads itself: a -> x -> a; a sees x as of the cycle before"]
    );
    // Through an output that an input reads one cycle later.
    assert_eq!(
        told("  a: {slot: 0, type: ecopy, source: go, sink: feed, inputs: [back], outputs: [lamp]}\n"),
        ["function a reads itself: a -> lamp -> back -> a; back sees lamp as of the cycle before"]
    );
}

#[test]
fn each_loop_is_reported_once() {
    let machine = machine(
        "  a: {slot: 0, type: dcopy, source: c.sink, sink: none}\n  b: {slot: 1, type: dcopy, source: a.sink, sink: none}\n  \
         c: {slot: 2, type: dcopy, source: b.sink, sink: none}\n  d: {slot: 3, type: ecopy, source: c.sink, sink: none, \
         inputs: [flag], outputs: [flag]}\n",
    );
    assert_eq!(
        loops(&machine),
        [
            "function a reads itself: a -> b -> c -> a; a sees c as of the cycle before",
            "function d reads itself: d -> flag -> d; d sees flag as of the cycle before",
        ]
    );
}

/// A box or a text of a figure: x, y, width, height.
type Area = [f64; 4];

fn numbers<const N: usize>(line: &str, names: [&str; N]) -> [f64; N] {
    names.map(|name| {
        let (_, rest) = line.split_once(&format!(" {name}=\"")).unwrap_or_else(|| panic!("{name}: {line}"));
        rest.split('"').next().unwrap_or_default().parse().unwrap_or_else(|_| panic!("{name}: {line}"))
    })
}

fn frames(svg: &str) -> Vec<Area> {
    let frames = svg.lines().filter(|line| line.starts_with("<rect x="));
    frames.map(|line| numbers(line, ["x", "y", "width", "height"])).collect()
}

fn texts(svg: &str) -> Vec<(Area, String)> {
    let text = |line: &str| {
        let [x, y] = numbers(line, ["x", "y"]);
        let (_, text) = line.trim_end_matches("</text>").split_once('>').expect("a text");
        let width = 7.3 * text.chars().count() as f64;
        let x = if line.contains("text-anchor=\"end\"") { x - width } else { x };
        ([x, y - 10.0, width, 13.0], text.to_owned())
    };
    svg.lines().filter(|line| line.starts_with("<text ")).map(text).collect()
}

fn is_inside(inner: &Area, outer: &Area) -> bool {
    inner[0] >= outer[0]
        && inner[1] >= outer[1]
        && inner[0] + inner[2] <= outer[0] + outer[2]
        && inner[1] + inner[3] <= outer[1] + outer[3]
}

fn overlap(a: &Area, b: &Area) -> bool {
    a[0] < b[0] + b[2] && b[0] < a[0] + a[2] && a[1] < b[1] + b[3] && b[1] < a[1] + a[3]
}

const MANY: &str = "  ratio: {slot: 0, type: varsync, source: belt, sink: feed, inputs: [go, flag], outputs: [lamp], mode: 1}\n  \
                    second: {slot: 1, type: dcopy, source: feed, sink: x}\n  \
                    third: {slot: 2, type: dcopy, source: x.actual, sink: volts}\n  \
                    fourth: {slot: 9, type: ecopy, source: ratio.sink, sink: copy, inputs: [back], outputs: [flag]}\n  \
                    watch: {slot: 10, type: binea, source: second.sink, tables: [t], tracks: 1}\n";

#[test]
fn boxes_do_not_overlap_and_contain_their_texts() {
    let svg = draw(&machine(MANY), "c.yaml").expect("there are functions");
    let [width, height] = numbers(svg.lines().next().expect("a head"), ["width", "height"]);
    let (frames, texts) = (frames(&svg), texts(&svg));
    // 5 functions; belt, go; feed, x, lamp, volts, copy, flag, back; 5 of the legend.
    assert_eq!(frames.len(), 5 + 2 + 7 + 5);
    for (place, frame) in frames.iter().enumerate() {
        assert!(is_inside(frame, &[0.0, 0.0, width, height]), "{frame:?}");
        assert!(frames[place + 1..].iter().all(|other| !overlap(frame, other)), "{frame:?}");
    }
    for (area, text) in &texts {
        assert!(is_inside(area, &[0.0, 0.0, width, height]), "{text}");
        let touched = frames.iter().filter(|frame| overlap(area, frame));
        assert!(touched.clone().count() <= 1 && touched.clone().all(|frame| is_inside(area, frame)), "{text}");
        assert!(texts.iter().filter(|(other, _)| overlap(area, other)).count() == 1, "{text}");
    }
    for said in [
        "0 ratio: varsync",
        "10 watch: binea",
        "table t",
        "source belt.position",
        "sink x",
        "A1 flag",
        "di back",
        "belt",
    ] {
        assert!(texts.iter().any(|(_, text)| text == said), "{said}: {texts:?}");
    }
}

#[test]
fn links_meet_boxes_and_are_dashed_where_they_are_late() {
    let svg = draw(&machine(MANY), "c.yaml").expect("there are functions");
    let frames = frames(&svg);
    let links: Vec<&str> = svg.lines().filter(|line| line.contains("marker-end")).collect();
    // Ports: 5 + 2 + 2 + 4 + 1; the input that reads an output; 2 of the legend.
    assert_eq!(links.len(), 14 + 1 + 2, "{svg}");
    let at_edge = |x: f64, y: f64| {
        frames.iter().any(|[left, top, width, height]| {
            ((x - left).abs() < 0.2 || (x - left - width).abs() < 0.2) && (*top..=top + height).contains(&y)
        })
    };
    let (legend, drawn): (Vec<&str>, Vec<&str>) = links.iter().partition(|line| numbers_of(line)[0] == 24.0);
    assert_eq!(legend.len(), 1);
    for line in drawn.iter().filter(|line| numbers_of(line)[1] < numbers_of(legend[0])[1]) {
        let numbers = numbers_of(line);
        assert!(at_edge(numbers[0], numbers[1]) && at_edge(numbers[6], numbers[7]), "{line}");
    }
    // `flag` of a higher slot, the output that `back` reads, and the line of the legend.
    assert_eq!(links.iter().filter(|line| line.contains("stroke-dasharray")).count(), 2 + 1);
}

/// Returns the numbers of a path.
fn numbers_of(line: &str) -> Vec<f64> {
    let path = line.split('"').nth(1).unwrap_or_default();
    let numbers = path.split(|c: char| !c.is_ascii_digit() && c != '.' && c != '-').filter(|text| !text.is_empty());
    numbers.map(|text| text.parse().unwrap_or_else(|_| panic!("{text}: {line}"))).collect()
}

#[test]
fn a_cell_without_functions_has_no_figure() {
    let text = "lineshaft: 1\ncycle: 1 ms\naxes: {}\n";
    let cell = Cell::parse("c.yaml", text).unwrap_or_else(|problems| panic!("{problems}"));
    assert_eq!(draw(&cell.machine, "c.yaml"), None);
}

#[test]
fn a_title_is_a_text_and_no_markup() {
    let svg = draw(&machine(MANY), "a<b>&.yaml").expect("there are functions");
    assert!(svg.contains("<title>a&lt;b&gt;&amp;.yaml</title>"), "{svg}");
}

/// docs/images/function_graph.svg is the figure of an example. `LINESHAFT_RENEW=1 cargo test -p lineshaft --lib graph`
/// draws it again.
#[test]
fn the_figure_in_docs_is_the_one_that_the_program_draws() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let cell = Cell::load(&root.join("launch-configs/functions/09_order.yaml"))
        .unwrap_or_else(|problems| panic!("{problems}"));
    let (made, file) = (draw(&cell.machine, "09_order.yaml").unwrap(), root.join("docs/images/function_graph.svg"));
    if std::env::var_os("LINESHAFT_RENEW").is_some() {
        std::fs::write(&file, &made).unwrap();
        return;
    }
    let there = std::fs::read_to_string(&file).unwrap_or_default();
    assert!(there == made, "draw it anew: LINESHAFT_RENEW=1 cargo test -p lineshaft --lib graph");
}
