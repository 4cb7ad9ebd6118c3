//! Tests every type of function slot, commanded by a client on Cyclone DDS and by one on Fast DDS; tables and
//! parameters from Fast DDS.

use crate::support::{domain::Domain, peer::Peer, program::Program};
use serde_json::{Value, json};
use tempfile::TempDir;

const OUT_OF_RANGE: u32 = 3004;
const STARTED: &str = "it is started already; RESET comes first";
const NO_VALUE_NEW: &str = "its type has no VALUE_NEW; values count from START on";
const AT_REST: &str = "it is in RESET; VALUE_NEW needs a function that is started";

/// One function of each type; none of them moves anything.
const CELL: &str = "
lineshaft: 1
cycle: 1 ms
backends: {plant: {type: sim}}
io:
  go: {type: di, backend: plant, address: 0}
  fast: {type: do, backend: plant, address: 0}
memory: {given: {type: i32, initial: 7}, copied: {type: i32}, chosen: {type: i32}, shown: {type: i32}, measured: {type: i32}}
encoders:
  belt: {backend: plant, address: 0, type: linear, scale: {increments: 1000, per: 1 mm}}
tables:
  limits: {form: words, words: [100, 0, 0, 1, 0, 1]}
  segments: {form: words, words: [3, 0, 0, 0, 500, 0, 5, 0, 1000, 0, 2, 0]} # bits 101 up to 500, 010 up to 1000
  rise: {form: y, points: [0, 500, 1000]}
  nose: # on from 0 to 9000 and from 500 to 1000
    form: words
    words: [0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0,
            0, 0, 9000, 0, 500, 0, 1000, 0]
axes:
  x:
    {type: rotary, scale: {increments: 36000, per: 360 deg}, drive: {backend: plant, address: 0}, max_velocity: 90 deg/s,
     max_acceleration: 360 deg/s^2, sim: {model: ideal}}
functions:
  copy: {slot: 0, type: dcopy, source: given, sink: copied, mode: 1}
  choose: {slot: 1, type: ecopy, sink: chosen, inputs: [go]}
  watch: {slot: 2, type: sidiff, sink: shown, tables: [limits]}
  gear: {slot: 3, type: varsync, source: belt, sink: x, inputs: [{name: go, inverted: true}], outputs: [fast]}
  fan: {slot: 4, type: digdreh, sink: none}
  gaps: {slot: 5, type: imes, source: belt, sink: measured}
  switch: {slot: 6, type: binea, source: belt, ba: 1, tracks: 1, tables: [segments]}
  cams: {slot: 7, type: cam, source: belt, ba: 1, tables: [nose]}
  cut: {slot: 8, type: fipw, source: belt, inputs: [go], tables: [rise], mode: 26, table_count: 1, mult: 1, increments_per_rev: 1000}
  index: {slot: 9, type: fipz, inputs: [go], tables: [rise], mode: 16, table_count: 1, mult: 1}
  track: {slot: 10, type: xfipw, source: belt, tables: [rise], ba: 2, tables_total: 1, mult: 1, incr_per_rev: 1000}
  follow:
    {slot: 11, type: dfkt, source: given, mult: 1, div: 1, in_final: 2000, out_max: 4000, out_min: -4000, ratio_max: 9, ratio_min: -9,
     ratio_div: 1}
  made: {slot: 12, type: fgen, sink: none, inputs: [go], fct: 1, cycle_time: 1000, cycle_increments: 500, accel: 1000}
  moved:
    {slot: 14, type: epos, inputs: [go], travel: 100, velocity: 1000000, acceleration: 200000, stop_decel: 800000, drive_resolution: 20000}
  held: {slot: 13, type: regl, source: given, source_assess: 2, y_max: 1000, gain_v: -3, switch_mask: 2}
";

/// Commands of a type with their results.
struct Case {
    function: &'static str,
    kind: &'static str,
    /// Fields of START, and values in force after it.
    start: (&'static str, Value),
    /// A value that is refused, and the message.
    bad: (&'static str, &'static str),
    /// Sink and outputs after START.
    shows: (i64, u8),
    /// Fields of VALUE_NEW, values in force after it, sink and outputs. `None` for a type without VALUE_NEW.
    renew: Option<(&'static str, Value, (i64, u8))>,
    /// Outputs at rest.
    rest: u8,
}

fn cases() -> [Case; 14] {
    [
        Case {
            function: "copy",
            kind: "dcopy",
            start: ("mode=0", json!({"mode": 0})),
            bad: ("mode=2", "mode is 2; 0 to 1 is allowed"),
            shows: (7, 0),
            renew: None,
            rest: 0,
        },
        Case {
            function: "choose",
            kind: "ecopy",
            start: ("mode=3 value_e1_0=100", json!({"mode": 3, "value_e1_0": 100, "value_e1_1": 0})),
            bad: ("value_e1_1=-2147483649", "value_e1_1 is -2147483649; -2147483648 to 2147483647 is allowed"),
            shows: (100, 0),
            // The mode takes effect at the next START.
            renew: Some(("value_e1_0=-7 mode=0", json!({"mode": 3, "value_e1_0": -7}), (-7, 0))),
            rest: 0,
        },
        Case {
            function: "watch",
            kind: "sidiff",
            start: ("aw_mask=1 mean_n=2", json!({"aw_mask": 1, "display_aw": 0, "mean_n": 2, "agreements": 5})),
            bad: ("display_aw=9", "display_aw is 9; 0 to 8 is allowed"),
            shows: (0, 0),
            renew: Some(("agreements=20 mode=1", json!({"mode": 0, "agreements": 20, "mean_n": 2}), (0, 0))),
            rest: 0,
        },
        Case {
            function: "gear",
            kind: "varsync",
            start: ("m1=5000 m2=-10000", json!({"mode": 0, "m1": 5000, "m2": -10000})),
            bad: ("m8=40000", "m8 is 40000; -32768 to 32767 is allowed (unit: 0.0001)"),
            shows: (0, 1),
            renew: None,
            rest: 0,
        },
        Case {
            function: "fan",
            kind: "digdreh",
            start: ("speed=10000000", json!({"speed": 10_000_000, "mode": 0})),
            bad: ("speed=2147483648", "speed is 2147483648; -2147483648 to 2147483647 is allowed (unit: 0.0001 rpm)"),
            shows: (0, 1),
            renew: None,
            rest: 1,
        },
        Case {
            function: "gaps",
            kind: "imes",
            start: ("ba=8 spacing=10000", json!({"ba": 8, "spacing": 10_000, "window": 0, "blocked": 0})),
            bad: ("window=-1", "window is -1; 0 to 1073741823 is allowed (unit: inc)"),
            shows: (0, 0),
            renew: Some(("window=2000 ba=0", json!({"ba": 8, "spacing": 10_000, "window": 2000}), (0, 0))),
            rest: 0,
        },
        Case {
            function: "switch",
            kind: "binea",
            start: ("tracks=3 mode=[0,1]", json!({"tracks": 3, "mode": [0, 1, 0, 0, 0, 0, 0, 0]})),
            bad: ("mode=[0,0,64]", "mode[2] is 64; 0 to 63 is allowed (unit: bits)"),
            shows: (0, 0b111),
            renew: Some(("feedback_offset=600 tracks=1", json!({"feedback_offset": 600, "tracks": 3}), (0, 0b000))),
            rest: 0,
        },
        Case {
            function: "cams",
            kind: "cam",
            start: ("modulo=36000 cams=[1,1]", json!({"modulo": 36_000, "cams": [1, 1, 0, 0, 0, 0, 0, 0]})),
            bad: ("cams=[0,1001]", "cams[1] is 1001; 0 to 1000 is allowed"),
            shows: (0, 0b01),
            renew: None,
            rest: 0,
        },
        Case {
            function: "cut",
            kind: "fipw",
            start: ("sak=5", json!({"mode": 26, "sak": 5, "increments_per_rev": 1000})),
            bad: ("div_exp=16", "div_exp is 16; 0 to 15 is allowed"),
            shows: (0, 1),
            renew: None,
            rest: 1,
        },
        Case {
            function: "index",
            kind: "fipz",
            start: ("cycle_time=[200]", json!({"mode": 16, "cycle_time": [200, 0, 0, 0, 0, 0, 0, 0]})),
            bad: ("mult=0", "mult is 0; 1 to 32767 is allowed"),
            shows: (0, 1),
            renew: None,
            rest: 1,
        },
        Case {
            function: "follow",
            kind: "dfkt",
            start: ("mult=3", json!({"ba": 0, "mult": 3, "div": 1})),
            bad: ("cont_high=2", "cont_high is 2; 0 to 1 is allowed"),
            shows: (21, 0),
            // RESET sets a speed to 0, and so does this.
            renew: Some(("mult=0 ba=2", json!({"ba": 0, "mult": 0}), (0, 0))),
            rest: 0,
        },
        Case {
            function: "made",
            kind: "fgen",
            start: ("cycle_time=2000 pos_limit=[5]", json!({"cycle_time": 2000, "pos_limit": [5, 0, 0, 0, 0, 0, 0]})),
            bad: ("accel=0", "accel is 0; 1 to 500000000 is allowed (unit: inc/s^2)"),
            shows: (0, 1),
            // The length of a sequence takes effect at the next START.
            renew: Some(("ba=2 cycle_increments=9", json!({"ba": 2, "cycle_increments": 500}), (0, 1))),
            rest: 1,
        },
        Case {
            function: "moved",
            kind: "epos",
            start: ("travel=-5 ba=8", json!({"travel": -5, "ba": 8, "stop_decel": 800_000})),
            bad: ("acceleration=0", "acceleration is 0; 1 to 100000000 is allowed (unit: 0.001 rev/s^2)"),
            shows: (0, 1),
            // The mode takes effect at the next START.
            renew: Some(("travel=7 ba=0", json!({"ba": 8, "travel": 7}), (0, 1))),
            rest: 1,
        },
        Case {
            function: "held",
            kind: "regl",
            start: ("kp=256", json!({"ba": 0, "kp": 256, "gain_v": -3})),
            bad: ("kp=16384", "kp is 16384; 0 to 16383 is allowed (unit: 1/256)"),
            shows: (21, 0),
            // RESET sets a speed to 0, and so does this.
            renew: Some(("ba=4 i_max=9", json!({"ba": 4, "i_max": 0}), (0, 1))),
            rest: 0,
        },
    ]
}

struct Bench {
    /// Client that sends commands.
    peer: Peer,
    /// Client that observes.
    cyclone: Peer,
    _program: Program,
    _folder: TempDir,
}

impl Bench {
    fn start(peer: fn(&Domain) -> Peer) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let cell = folder.path().join("cell.yaml");
        std::fs::write(&cell, CELL).expect("the folder was just made");
        let domain = Domain::take();
        let mut cyclone = Peer::cyclone(&domain);
        let cell = cell.to_str().expect("a path of text");
        let program = Program::start(&["run", cell, "--store", "none", "--flight-recorder", "0"], &domain);
        cyclone.run("functions /lineshaft");
        // A Fast DDS participant that starts together with the program may miss its topics.
        let peer = peer(&domain);
        Self { peer, cyclone, _program: program, _folder: folder }
    }

    /// Returns the values in force after a command.
    #[track_caller]
    fn order(&mut self, function: &str, order: &str) -> Value {
        self.peer.run(&format!("function /lineshaft {function} {order}"))["active"].clone()
    }

    #[track_caller]
    fn refused(&mut self, function: &str, order: &str, sentence: &str) {
        let said = self.peer.fails(&format!("function /lineshaft {function} {order}"));
        assert_eq!(said, format!("{function}: {sentence}"), "{order}");
    }

    /// Returns the staged values of the given fields.
    #[track_caller]
    fn staged(&mut self, function: &str, words: &str) -> Value {
        let names =
            words.split(' ').filter_map(|word| word.split_once('=')).map(|(field, _)| format!("{function}.{field}"));
        let names = names.collect::<Vec<_>>().join(" ");
        self.peer.run(&format!("params /lineshaft get {names}"))["get"].clone()
    }

    /// Waits until `~/functions` has these values, because a message may be in transit during the change; then both
    /// clients must see them.
    #[track_caller]
    fn shows(&mut self, function: &str, expected: &Value) {
        let mut seen = Value::Null;
        for _ in 0..20 {
            seen = self.cyclone.run("functions /lineshaft")["functions"][function].clone();
            if holds(&seen, expected) {
                let other = self.peer.run("functions /lineshaft")["functions"][function].clone();
                assert_eq!(other, seen, "{function}");
                return;
            }
        }
        panic!("{function} should show {expected}: {seen}");
    }
}

/// Whether it has all expected values.
fn holds(seen: &Value, expected: &Value) -> bool {
    expected.as_object().expect("an object").iter().all(|(key, value)| seen[key] == *value)
}

/// Returns the words without that for the field of `other`, because a set has each field once.
fn without(words: &str, other: &str) -> String {
    let field = |word: &'_ str| word.split('=').next().map(str::to_owned);
    words.split(' ').filter(|word| field(word) != field(other)).collect::<Vec<_>>().join(" ")
}

fn is_commanded(bench: &mut Bench, case: &Case) {
    let Case { function, kind, start: (start, active), bad: (bad, sentence), shows, renew, rest } = case;
    let state = |is_active: bool, code: u32, (sink, outputs): (i64, u8)| json!({"type": kind, "active": is_active, "error_code": code, "sink": sink, "outputs": outputs});
    // One wrong value: no part of the command is executed, and nothing is staged.
    let (before, staged) = (bench.order(function, "read_value"), bench.staged(function, start));
    bench.refused(function, &format!("start {} {bad}", without(start, bad)), sentence);
    bench.shows(function, &json!({"active": false, "error_code": OUT_OF_RANGE}));
    assert_eq!(bench.order(function, "read_value"), before, "{function}");
    assert_eq!(bench.staged(function, start), staged, "{function}");
    let at_rest = if renew.is_some() { AT_REST } else { NO_VALUE_NEW };
    bench.refused(function, "value_new", at_rest);

    let mut in_force = bench.order(function, &format!("start {start}"));
    assert!(holds(&in_force, active), "{function}: {in_force}");
    assert_ne!(in_force, before, "{function}");
    bench.shows(function, &state(true, 0, *shows));
    bench.refused(function, "start", STARTED);

    let mut shown = *shows;
    if let Some((words, renewed, then)) = renew {
        bench.refused(function, &format!("value_new {} {bad}", without(words, bad)), sentence);
        assert_eq!(bench.order(function, "read_value"), in_force, "{function}");
        in_force = bench.order(function, &format!("value_new {words}"));
        assert!(holds(&in_force, renewed), "{function}: {in_force}");
        shown = *then;
    } else {
        bench.refused(function, &format!("value_new {start}"), NO_VALUE_NEW);
    }
    // READ_VALUE changes nothing, and clears the error of the refused command.
    assert_eq!(bench.order(function, "read_value"), in_force, "{function}");
    bench.shows(function, &state(true, 0, shown));
    bench.order(function, "reset");
    bench.shows(function, &state(false, 0, (shown.0, *rest)));
    assert_eq!(bench.order(function, "read_value"), in_force, "{function}");
}

fn every_type_is_commanded(peer: fn(&Domain) -> Peer) {
    let mut bench = Bench::start(peer);
    for case in cases() {
        is_commanded(&mut bench, &case);
    }
}

/// READ_VALUE of this type reads a value, and only at rest.
fn a_place_is_read(peer: fn(&Domain) -> Peer) {
    let mut bench = Bench::start(peer);
    assert_eq!(bench.order("track", "read_value master_offset=250")["output_value"], 250);
    bench.refused("track", "read_value master_offset=-50 corr_weight=256", "corr_weight is 256; 0 to 255 is allowed");
    bench.refused("track", "start stop_angle=1", "stop_angle: 1 has no meaning in mode 2");
    assert_eq!(bench.order("track", "read_value")["master_offset"], 250, "what is refused is not staged");
    let in_force = bench.order("track", "start master_offset=0");
    assert_eq!((&in_force["master_offset"], &in_force["ba"]), (&json!(0), &json!(2)));
    bench.refused("track", "read_value", STARTED);
    bench.refused("track", "start", STARTED);
    assert_eq!(bench.order("track", "value_new corr_every=3 ba=26")["corr_every"], 3);
    bench.order("track", "reset");
    bench.shows("track", &json!({"type": "xfipw", "active": false, "error_code": 0}));
}

#[test]
fn a_place_is_read_from_cyclone_dds() {
    a_place_is_read(Peer::cyclone);
}

#[test]
fn a_place_is_read_from_fast_dds() {
    a_place_is_read(Peer::fastdds);
}

/// Proves: AMK-CMD-03, AMK-CMD-08, AMK-CMD-09, AMK-CMD-10, AMK-CMD-11, AMK-CMD-12, AMK-CMD-13
#[test]
fn every_type_is_commanded_from_cyclone_dds() {
    every_type_is_commanded(Peer::cyclone);
}

#[test]
fn every_type_is_commanded_from_fast_dds() {
    every_type_is_commanded(Peer::fastdds);
}

#[test]
fn tables_are_loaded_and_read_from_fast_dds() {
    let mut bench = Bench::start(Peer::fastdds);
    let table = |bench: &mut Bench| {
        let seen = bench.peer.run("get-table /lineshaft segments");
        (seen["form"].clone(), seen["x"].clone(), seen["y"].clone())
    };
    let numbers = json!([3, 0, 0, 0, 500, 0, 5, 0, 1000, 0, 2, 0]);
    assert_eq!(table(&mut bench), (json!("words"), json!([]), numbers.clone()));
    let load = "load-table /lineshaft segments --y 3,0,0,0,500,0,2,0,1000,0,-1,-32768";
    bench.order("switch", "start tracks=3");
    bench.shows("switch", &json!({"outputs": 0b101}));
    let sentence = "segments: function switch is started and reads it; type binea takes no new numbers before RESET";
    assert_eq!(bench.peer.fails(load), sentence);
    for (request, sentence) in [
        ("segment --y 1", "no table is called `segment`; limits, segments, rise, nose are known"),
        ("segments", "segments: a table has 0 numbers; 1 to 1000000 are possible"),
        ("segments --y 0,65536", "segments: word 1 is 65536; -32768 to 65535 is possible"),
        ("segments --x 1 --y 1", "segments: a table of form words has 1 places in x; it takes none"),
    ] {
        assert_eq!(bench.peer.fails(&format!("load-table /lineshaft {request}")), sentence, "{request}");
    }
    assert_eq!(table(&mut bench).2, numbers, "refused changes nothing");
    bench.order("switch", "reset");
    bench.peer.run(load);
    assert_eq!(table(&mut bench).2, json!([3, 0, 0, 0, 500, 0, 2, 0, 1000, 0, -1, -32768]));
    bench.order("switch", "start");
    bench.shows("switch", &json!({"outputs": 0b010}));
    // A cam continues with its new numbers.
    bench.order("cams", "start modulo=36000 cams=[2]");
    bench.shows("cams", &json!({"outputs": 1}));
    let nose = format!("{},9000,0,18000,0,500,0,1000,0", vec!["0"; 32].join(","));
    bench.peer.run(&format!("load-table /lineshaft nose --y {nose}"));
    bench.shows("cams", &json!({"outputs": 0, "active": true}));
    // Longer than a few datagrams, in both directions.
    assert_eq!(bench.peer.run("load-long-table /lineshaft limits")["count"], 65_536);
}

#[test]
fn fields_are_parameters_from_fast_dds() {
    let mut bench = Bench::start(Peer::fastdds);
    let get = |bench: &mut Bench, names: &str| bench.peer.run(&format!("params /lineshaft get {names}"))["get"].clone();
    let structure = "cams.slot cams.type cams.source cams.sink cams.cycle_factor";
    assert_eq!(get(&mut bench, structure), json!([7, "cam", "belt.position", "none", 1]));
    assert_eq!(get(&mut bench, "gear.m1 gear.m9"), json!([]), "one is not there");
    let together = |bench: &mut Bench, values: &str| {
        let seen = bench.peer.run(&format!("params /lineshaft set_atomically {values}"));
        let result = &seen["set_atomically"]["result"];
        (result["successful"].clone(), result["reason"].as_str().expect("a reason").to_owned())
    };
    assert_eq!(together(&mut bench, "cams.cams=[3,2] cams.modulo=100"), (json!(true), String::new()));
    let staged = json!([[3, 2, 0, 0, 0, 0, 0, 0], 100]);
    assert_eq!(get(&mut bench, "cams.cams cams.modulo"), staged);
    for (values, sentence) in [
        ("cams.modulo=5 cams.cams=[1,2,1001]", "cams: cams[2] is 1001; 0 to 1000 is allowed"),
        ("cams.modulo=5 cams.cams=[0,0,0,0,0,0,0,0,0]", "cams: 9 values for cams; 1 to 8 are possible"),
        (
            "cams.modulo=5 gear.m1=1",
            "cams.modulo and gear.m1 cannot be set together; a function's values are a set of their own",
        ),
        ("cams.modulo=5 cams.nodulo=5", "parameter `cams.nodulo` has not been declared"),
        ("cams.slot=3", "cams.slot is read-only: part of the cell: changes with the file and a new start"),
    ] {
        assert_eq!(together(&mut bench, values), (json!(false), sentence.to_owned()), "{values}");
    }
    assert_eq!(get(&mut bench, "cams.cams cams.modulo"), staged, "refused changes nothing");
    let seen = bench.peer.run("params /lineshaft set gear.m1=4 gear.m2=70000 choose.mode=1.0");
    let results = seen["set"]["results"].as_array().expect("results");
    let done: Vec<_> = results.iter().map(|one| one["successful"].clone()).collect();
    assert_eq!(done, [true, false, true].map(Value::from), "{results:?}");
    let sentence = "gear: m2 is 70000; -32768 to 32767 is allowed (unit: 0.0001)";
    assert_eq!(results[1]["reason"], sentence);
    // Staged values are in force after START.
    assert_eq!(bench.order("gear", "read_value")["m1"], 0);
    assert_eq!(bench.order("gear", "start")["m1"], 4);
    assert_eq!(get(&mut bench, "gear.m1 choose.mode"), json!([4, 1]));
    let seen = bench.peer.run("params /lineshaft describe gear.m1 cams.cams");
    let [_, ratio, cams] = seen.all() else { panic!("{seen:?}") };
    let range = |seen: &Value| ["type", "low", "high", "step"].map(|key| seen[key].clone());
    assert_eq!(range(ratio), [2, -32_768, 32_767, 1].map(Value::from));
    assert_eq!(range(cams), [7, 0, 1000, 1].map(Value::from));
}
