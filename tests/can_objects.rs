//! Tests `~/sdo_read` and `~/sdo_write` from a client on Cyclone DDS, with drives of another make.

use crate::support::can::CanDrives;
use crate::support::can_cell::{CanCell, CanRun, axis};
use crate::support::domain::Domain;
use crate::support::peer::Peer;
use serde_json::Value;

const SCENARIO: &str = "scenario: s\nfor: 600 s\nsteps: []\n";
/// Log line when a drive is ready.
const READY: &str = ": ready after";

struct Node {
    cyclone: Peer,
    run: CanRun,
    _cell: CanCell,
}

impl Node {
    fn start(address: &str, options: &[&str]) -> Self {
        let axes = [axis("x", 1, "", ""), axis("y", 2, "", "")].concat();
        let (cell, domain) = (CanCell::new(address, "10 ms", &axes), Domain::take());
        let mut cyclone = Peer::cyclone(&domain);
        let run = cell.run_in(&domain, SCENARIO, options);
        cyclone.run("events /lineshaft");
        Self { cyclone, run, _cell: cell }
    }

    #[track_caller]
    fn read(&mut self, words: &str) -> [Value; 3] {
        let seen = self.cyclone.run(&format!("sdo-read /lineshaft {words}"));
        ["value", "type", "data"].map(|key| seen[key].clone())
    }

    #[track_caller]
    fn write(&mut self, words: &str) {
        self.cyclone.run(&format!("sdo-write /lineshaft {words}"));
    }

    #[track_caller]
    fn refuses(&mut self, words: &str, sentence: &str) {
        assert_eq!(self.cyclone.fails(&format!("sdo-{words}")), sentence, "{words}");
    }
}

/// By name and by index, of drives of the cell and of any other node, while an axis moves.
#[test]
fn objects_are_read_and_written_while_cycles_run() {
    let mut drives = CanDrives::boot("1-3");
    let mut node = Node::start(&drives.address().to_string(), &[]);
    node.run.wait_for_log(2, READY);
    node.cyclone.run("axes /lineshaft enable");
    let goal = node.cyclone.run("move /lineshaft --axis y --mode velocity --velocity 0.01");
    let goal = goal["goal"].as_str().expect("a goal").to_owned();

    let known = node.read("--axis x --object position ACTUAL value");
    assert_eq!(known, ["0", "i32", "00000000"]);
    assert_eq!(node.read("--backend bus0 --device 1 --object 0x6099:1"), ["50000", "u32", "50c30000"]);
    assert_eq!(node.read("--device 3 --object 6085h:00"), ["", "", "80841e00"], "nobody says what it is");
    assert_eq!(node.read("--device 3 --object 1008 --type string"), ["cia402-sim", "string", "6369613430322d73696d"]);

    node.write("--axis x --object Quick stop deceleration --value 0x4E20");
    assert_eq!(drives.tell("get 1 0x6085 0")["value"], 20_000);
    assert_eq!(node.read("--axis x --object 6085"), ["20000", "u32", "204e0000"]);
    node.write("--device 3 --object 607A --type i32 --value -5");
    assert_eq!(drives.tell("get 3 0x607A 0")["value"], -5);
    let text = "x".repeat(889);
    node.write(&format!("--axis x --object 2001 --value {text}"));
    assert_eq!(node.read("--axis x --object 2001")[0], text.as_str());
    node.run.program.wait_for_log("bus0: node 1 (x): 6085h:00 Quick stop deceleration was written");

    let seen = node.cyclone.run("axis-states /lineshaft");
    assert_eq!(seen["axes"]["y"]["state"], "CONTINUOUS_MOTION", "{seen:?}");
    node.cyclone.run(&format!("cancel /lineshaft move_axis {goal}"));
    node.run.program.end();
}

/// Mapped objects while the drive is enabled, objects that the master writes, types, limits, devices that are absent or
/// refuse.
#[test]
fn what_must_not_be_is_refused_in_a_sentence_and_changes_nothing() {
    let mut drives = CanDrives::boot("1-2");
    let mut node = Node::start(&drives.address().to_string(), &[]);
    node.run.wait_for_log(2, READY);
    let target = "write /lineshaft --axis x --object Target position --value 77";
    node.cyclone.run(&format!("sdo-{target}"));
    node.cyclone.run("axes /lineshaft enable");
    node.refuses(
        target,
        "bus0: node 1 (x): 607Ah:00 is mapped in a PDO and the drive is under power (operation enabled); switch the axis off first",
    );
    node.cyclone.run("axes /lineshaft disable");
    node.run.until(&mut drives, 1, "off", |shown| shown.is_off());
    node.cyclone.run(&format!("sdo-{target}"));

    let owned = "bus0: node 1 (x): 6040h:00 Controlword is not for ~/sdo_write: the axis says what it holds";
    node.refuses("write /lineshaft --device 1 --object Controlword --value 15", owned);
    node.refuses(
        "write /lineshaft --axis x --object Homing method --value 200",
        "bus0: node 1 (x): 6098h:00 Homing method: 200 is not within -128 and 127, as INTEGER8 is",
    );
    node.refuses(
        "read /lineshaft --axis x --object 6064 --type u8",
        "bus0: node 1 (x): 6064h:00 Position actual value is INTEGER32 by the EDS, not UNSIGNED8; leave the type out",
    );
    let seen = node.cyclone.run("events /lineshaft --seconds 0.3");
    let refused = seen.all().iter().filter(|one| one["message"]["kind"] == "refused").count();
    assert_eq!(refused, 3, "what no device was asked for is an event: {seen:?}");

    node.refuses(
        "read /lineshaft --device 9 --object 1000 --type u32",
        "bus0: node 9: 1000h:00: the device has not answered for 500 ms",
    );
    node.refuses(
        "read /lineshaft --axis x --object 5FFF",
        "bus0: node 1 (x): 5FFFh:00: the device refuses: the object does not exist (06020000h)",
    );
    drives.tell("sdo_abort 1 0x6085 0 0x06090031");
    node.refuses(
        "write /lineshaft --axis x --object 6085 --value 1",
        "bus0: node 1 (x): 6085h:00: the device refuses: the value is too high (06090031h)",
    );
    assert_eq!(node.read("--axis y --object 6085")[0], "2000000", "the others have their answers all the same");

    // The cable is pulled: each request gets an answer.
    drives.kill();
    node.run.wait_for_log(1, "the way to the bus is lost");
    let lost = node.cyclone.fails("sdo-read /lineshaft --axis x --object 6064");
    assert!(lost.starts_with("bus0: node 1 (x): the way to the bus is lost: "), "{lost}");
    node.run.program.interrupt();
}

#[test]
fn a_rehearsal_has_no_objects() {
    let mut node = Node::start("slcan-tcp:127.0.0.1:1", &["--sim"]);
    for words in ["read /lineshaft --axis x --object 6064", "write /lineshaft --device 1 --object 6085 --value 1"] {
        node.refuses(words, "backend bus0 is simulated: it has no bus and no objects");
    }
    node.run.program.end();
}
