//! Tests frames of a bus: in /diagnostics, in the bags of the flight recorder, in recordings, and printed again.

use crate::support::bag_check::bag_check;
use crate::support::can::CanDrives;
use crate::support::can_cell::{CanCell, axis};
use crate::support::domain::Domain;
use crate::support::peer::Peer;
use crate::support::program::Program;
use std::fs;
use std::process::Command;
use std::thread;
use std::time::Duration;

/// Runs `lineshaft`; returns exit code, standard output and standard error.
fn lineshaft(args: &[&str]) -> (Option<i32>, String, String) {
    let program = Command::new(env!("CARGO_BIN_EXE_lineshaft")).args(args).output().expect("it starts");
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (program.status.code(), text(&program.stdout), text(&program.stderr))
}

/// Returns the lines of `can dump`, each in its columns: time (s), bus, direction, identifier, the rest.
fn dumped(args: &[&str]) -> Vec<(f64, String, String, String, String)> {
    let (code, out, complaints) = lineshaft(&[&["can", "dump"], args].concat());
    assert_eq!((code, complaints.as_str()), (Some(0), ""));
    let columns = |line: &str| {
        let mut columns = line.split_whitespace().map(str::to_owned);
        let mut next = || columns.next().unwrap_or_else(|| panic!("a column is missing: {line}"));
        let time = next().parse().unwrap_or_else(|error| panic!("{line}: {error}"));
        (time, next(), next(), next(), columns.collect::<Vec<_>>().join(" "))
    };
    out.lines().map(columns).collect()
}

/// A drive fails in motion. The recording has each frame of the bus, as counted by the drives; so does the bag of the
/// flight recorder, which can be replayed like any other. A recording without the request for frames has none.
#[test]
fn frames_of_a_fault_are_kept() {
    let mut drives = CanDrives::boot("1-2");
    let axes = [axis("x", 1, "", ""), axis("y", 2, "", "")].concat();
    let cell = CanCell::new(&drives.address().to_string(), "10 ms", &axes);
    let (recorded, flights, yaml) = (cell.path("recorded"), cell.path("flights"), cell.path("cell.yaml"));
    let options = ["--record", &recorded, "--record-frames", "--flight-folder", &flights];
    let scenario = "scenario: fault
for: 5 s
steps:
  - {when: {signal: x.drive_state, is: SWITCH_ON_DISABLED}, do: {enable: {axes: [x]}}}
  - {when: {signal: x.state, is: STANDSTILL}, do: {move_axis: {axis: x, mode: velocity, velocity: 10 mm/s}}}
expect:
  - {event: {kind: error, source: x, code: 0x18611}, count: 1}
";
    let run = cell.run_with(scenario, &options);
    run.until(&mut drives, 1, "it moves", |shown| shown.velocity == 10_000);
    thread::sleep(Duration::from_secs(1));
    drives.tell("fault 1 0x8611");
    run.passes();

    let frames = dumped(&[&recorded, "--cell", &yaml]);
    let count = |way: &str, id: &str| {
        frames.iter().filter(|(_, _, of, at, _)| (of.as_str(), at.as_str()) == (way, id)).count() as u64
    };
    let shown = drives.shown(1);
    assert_eq!(count("sent", "080"), shown.counter("sync"), "each SYNC, and no other");
    // The last ones may be sent after the end of reception.
    let (told, heard) = (shown.counter("tpdo"), count("received", "181"));
    assert!(heard <= told && heard + 5 >= told, "{heard} of {told} TPDOs of node 1");
    assert!(frames.windows(2).all(|pair| pair[0].0 <= pair[1].0), "in the order of their times");
    assert!(frames.first().is_some_and(|first| first.0 < 0.0), "the configuration comes before the first cycle");
    let last = frames.iter().rfind(|(.., id, _)| id == "181").map(|(.., words)| words.clone()).unwrap_or_default();
    assert!(last.contains(&format!("6064h:00 Position actual value {},", shown.position)), "{last}, {shown:?}");

    let bags: Vec<_> =
        fs::read_dir(&flights).expect("the folder is there").flatten().map(|entry| entry.path()).collect();
    let [bag] = bags.as_slice() else { panic!("one fault, one bag: {bags:?}") };
    let bag = bag.to_str().expect("a path of text");
    let of_node = dumped(&[bag, "--cell", &yaml, "--bus", "bus0", "--node", "1"]);
    let emergency = of_node.iter().position(|(_, _, way, id, words)| {
        way == "received" && id == "081" && words.contains("EMCY of node 1: 8611h following error")
    });
    let emergency = emergency.expect("the emergency message of the fault");
    assert!(of_node.iter().all(|(_, _, _, id, _)| id != "080" && id != "182"), "of node 1 alone");
    let asked =
        |frames: &[(f64, String, String, String, String)]| frames.iter().filter(|frame| frame.3 == "201").count();
    assert!(
        asked(&of_node[..emergency]) > 90 && asked(&of_node[emergency..]) > 90,
        "a second before, and the aftermath"
    );
    let (code, told, complaints) = lineshaft(&["replay", bag]);
    assert!(code == Some(0) && told.contains("no difference"), "{told}{complaints}");
    // Independent readers count the same frames.
    let counts = bag_check(["rosbags", bag])["counts"].clone();
    let all = dumped(&[bag, "--cell", &yaml]);
    for way in ["sent", "received"] {
        let ours = all.iter().filter(|frame| frame.2 == way).count();
        assert_eq!(counts[format!("/lineshaft/can/bus0/{way}")], ours, "{way}");
    }

    // The cell in the bag names an EDS that does not exist here.
    let (code, out, note) = lineshaft(&["can", "dump", bag]);
    assert_eq!(code, Some(0));
    assert!(
        out.contains("RPDO 1 of node 1\n") && note.starts_with("note: what PDOs carry is not told; --cell"),
        "{note}"
    );
    let (code, _, complaints) = lineshaft(&["can", "dump", bag, "--cell", &yaml, "--bus", "bus1"]);
    assert_eq!(code, Some(2));
    assert!(complaints.ends_with("has no frames of bus \"bus1\"; bus0 is allowed\n"), "{complaints}");
    let (plain, short) = (cell.path("plain"), "scenario: short\nfor: 1 s\n");
    cell.run_with(short, &["--record", &plain]).passes();
    let (code, out, complaints) = lineshaft(&["can", "dump", &plain, "--cell", &yaml]);
    assert_eq!((code, out.as_str()), (Some(2), ""));
    let topics =
        "topics ../can/BUS/sent and ../received of can_msgs/msg/Frame; its topics are /diagnostics, /joint_states, ";
    assert!(complaints.contains("it has no frames of CAN") && complaints.contains(topics), "{complaints}");
}

/// Two drives, 100 cycles per second: SYNC and an RPDO for each, a TPDO of each, and heartbeats.
#[test]
fn diagnostics_show_bus_load() {
    let drives = CanDrives::boot("1-2");
    let cell =
        CanCell::new(&drives.address().to_string(), "10 ms", &[axis("x", 1, "", ""), axis("y", 2, "", "")].concat());
    let domain = Domain::take();
    let mut cyclone = Peer::cyclone(&domain);
    let args = ["run", &cell.path("cell.yaml"), "--store", "none", "--flight-recorder", "0"];
    let mut program = Program::start(&args, &domain);
    cyclone.run("diagnostics /lineshaft --seconds 60 --until machine=0");
    let seen = cyclone.run("diagnostics /lineshaft --seconds 5");
    let values = &seen["last"]["lineshaft: backend bus0"]["values"];
    let value = |key: &str| values[key].as_str().unwrap_or_else(|| panic!("{key}? {values}")).to_owned();
    assert_eq!(value("NMT states"), "node 1 (x): operational, node 2 (y): operational");
    assert_eq!((value("controller"), value("frames missing in recordings")), ("active".to_owned(), "0".to_owned()));
    let number = |text: &str| text.split(' ').next().and_then(|word| word.parse::<f64>().ok());
    let (frames, measured) = (number(&value("frames")), number(&value("load, measured")));
    let (Some(frames), Some(measured)) = (frames, measured) else { panic!("{values}") };
    assert!((250.0..1000.0).contains(&frames), "{values}");
    // At 1 Mbit/s: frames have 47 to 135 bits.
    let bits = measured * 1e4 / frames;
    assert!((47.0..=135.0).contains(&bits), "{bits} bits a frame: {values}");
    // SYNC, and for each drive 7 bytes in both directions, at most 55 + 4 * 125 bits in 10 ms.
    assert_eq!(value("load, computed"), "5.5 % at most, the frames of each cycle alone");
    program.end();
}
