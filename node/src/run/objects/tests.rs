use super::*;
use crate::cell::Cell;
use crate::run::can::CanObjects;
use lineshaft_can::master::{CanService, MOST_WAITING};
use std::path::Path;

/// Returns the access to launch-configs/can/mixed.yaml, whose bus is not served: x is node 1, y node 2, z is simulated.
fn desk() -> (ObjectAccess, CanService) {
    desk_of("mixed.yaml")
}

fn desk_of(name: &str) -> (ObjectAccess, CanService) {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../launch-configs/can").join(name);
    let cell = Cell::load(&file).expect("it has no errors");
    let bus = cell.on_can().buses(Some(&file)).expect("its files have none").remove(0);
    let sheets = cell.on_can().dictionaries(&bus.name, &file).expect("the same files");
    let (_, service) = lineshaft_can::master::bus(bus.clone());
    let objects = CanObjects::new(&bus, service.objects(), sheets);
    (ObjectAccess::new(Vec::new()).with_bus(Arc::new(objects)), service)
}

/// Parses `axis backend node object type`; `-` is an empty text.
fn request(words: &str, value: &str) -> SdoWriteRequest {
    let words: Vec<_> = words.split(' ').map(|word| if word == "-" { "" } else { word }).collect();
    let [axis, backend, node, object, kind] = words[..] else { panic!("{words:?}") };
    let [axis, backend, object, kind] = [axis, backend, object, kind].map(|word| word.replace('_', " "));
    let node = node.parse().expect("a number");
    SdoWriteRequest { axis, backend, node, object, r#type: kind, value: value.to_owned() }
}

fn read(words: &str) -> SdoReadRequest {
    let SdoWriteRequest { axis, backend, node, object, r#type, .. } = request(words, "");
    SdoReadRequest { axis, backend, node, object, r#type }
}

#[test]
fn invalid_request_is_refused_before_device_access() {
    let (desk, _service) = desk();
    let mut refused: Vec<(String, String)> = Vec::new();
    for (words, sentence) in [
        ("- - 0 6064 -", "node is 0; 1 to 127 is allowed, or 0 and the name of an axis"),
        ("- - 128 6064 -", "node is 128; 1 to 127 is allowed, or 0 and the name of an axis"),
        ("x - 1 6064 -", "axis is \"x\" and node is 1; give one of them, the node then as 0"),
        ("z - 0 6064 -", "no axis with a drive on CAN is called \"z\""),
        ("- plant 1 6064 -", "no backend on CAN is called \"plant\"; there are bus0"),
        ("x plant 0 6064 -", "no backend on CAN is called \"plant\"; there are bus0"),
        ("- - 127 6064 -", "bus0: node 127 is this program, which has no objects"),
        ("x - 0 Statuswort -", "bus0: node 1 (x): no object has the name \"Statuswort\""),
        (
            "- - 9 Statusword -",
            "bus0: node 9: \"Statusword\" is no object; allowed are an index like 6064 or 0x6064 (1000 to FFFF), index and subindex like 6099:01 \
             (00 to FF), both hexadecimal; a name needs an EDS",
        ),
        (
            "x - 0 6064 int32",
            "type is \"int32\"; bool, u8, u16, u32, u64, i8, i16, i32, i64, f32, f64, string, bytes, domain are allowed, or nothing",
        ),
        (
            "x - 0 6064 u32",
            "bus0: node 1 (x): 6064h:00 Position actual value is INTEGER32 by the EDS, not UNSIGNED32; leave the type out",
        ),
    ] {
        refused.push((desk.read(&read(words)).err().unwrap_or_default(), sentence.to_owned()));
    }
    for (words, value, sentence) in [
        (
            "x - 0 Controlword -",
            "15",
            "bus0: node 1 (x): 6040h:00 Controlword is not for ~/sdo_write: the axis says what it holds",
        ),
        (
            "- - 2 0x1017 u16",
            "0",
            "bus0: node 2 (y): 1017h:00 Producer heartbeat time is not for ~/sdo_write: key heartbeat says what it holds",
        ),
        (
            "x - 0 Statusword -",
            "1",
            "bus0: node 1 (x): 6041h:00 Statusword cannot be written: its access is ro by the EDS",
        ),
        (
            "x - 0 6060 -",
            "8",
            "bus0: node 1 (x): 6060h:00 Modes of operation is not for ~/sdo_write: the interface of the drive says what it holds",
        ),
        (
            "x - 0 6098 -",
            "200",
            "bus0: node 1 (x): 6098h:00 Homing method: 200 is not within -128 and 127, as INTEGER8 is",
        ),
        (
            "- - 9 6098 -",
            "1",
            "bus0: node 9: the type of 6098h:00 is not known: give it (bool, u8, u16, u32, u64, i8, i16, i32, i64, f32, f64, string, bytes, \
             domain), or an EDS that has the object",
        ),
        (
            "- - 9 2100 domain",
            &"0A ".repeat(890),
            "bus0: node 9: 2100h:00: the value has 890 bytes; 889 at most are allowed",
        ),
        ("- - 9 2100 domain", &"0".repeat(4097), "value is 4097 bytes long; 4096 are allowed"),
    ] {
        refused.push((desk.write(&request(words, value)).err().unwrap_or_default(), sentence.to_owned()));
    }
    let long = SdoReadRequest { object: "y".repeat(257), ..read("x - 0 - -") };
    refused.push((desk.read(&long).err().unwrap_or_default(), "object is 257 bytes long; 256 are allowed".to_owned()));
    for (said, expected) in refused {
        assert_eq!(said, expected);
    }
    // None of the refused requests was queued.
    for _ in 0..MOST_WAITING {
        assert!(desk.read(&read("- bus0 9 6064 i32")).is_ok());
    }
    let full = desk.write(&request("x - 0 Target_position -", "5")).err();
    assert_eq!(full.as_deref(), Some("bus0: node 1 (x): 16 requests wait for the bus already; try again"));
}

#[test]
fn a_simulated_bus_has_no_objects() {
    let desk = ObjectAccess::new(vec!["bus0".to_owned()]);
    let sentence = "backend bus0 is simulated: it has no bus and no objects";
    for words in ["x - 0 6064 -", "- - 1 6064 -", "- bus0 1 6064 -", "x bus0 0 6064 -"] {
        assert_eq!(desk.read(&read(words)).err().as_deref(), Some(sentence), "{words}");
    }
    assert_eq!(ObjectAccess::default().read(&read("x - 0 6064 -")).err().as_deref(), Some(NO_BUS));
    assert_eq!(ObjectAccess::default().read(&read("- - 1 6064 -")).err().as_deref(), Some(NO_BUS));
}

#[test]
fn timeout_is_reported_and_an_ending_bus_answers() {
    let (mut desk, service) = desk();
    desk.patience = Duration::from_millis(20);
    let runtime = tokio::runtime::Builder::new_current_thread().enable_time().build().expect("a runtime");
    let late = desk.write(&request("x - 0 6085 -", "5")).expect("it is allowed");
    let late = runtime.block_on(late).message;
    assert_eq!(late, "bus0: node 1 (x): the bus had no time for it within 0.02 s; nothing was done");
    desk.patience = PATIENCE;
    let open = desk.read(&read("x - 0 6085 -")).expect("it is allowed");
    drop(service);
    assert_eq!(runtime.block_on(open).message, "bus0: node 1 (x): the machine has stopped");
    let gone = desk.read(&read("x - 0 6085 -")).err();
    assert_eq!(gone.as_deref(), Some("bus0: node 1 (x): the bus is closed"));
}

/// Outputs of a module belong to the cell in every state; its other objects may be written if the cell does not set
/// them.
#[test]
fn outputs_of_a_module_are_not_for_the_service() {
    let (desk, _service) = desk_of("terminals.yaml");
    let said = |words: &str| desk.write(&request(words, "1")).err();
    let sentence =
        "bus0: node 10 (module): 6200h:01 is not for ~/sdo_write: an output or input of the cell says what it holds";
    assert_eq!(said("- - 10 6200:01 u8").as_deref(), Some(sentence));
    let heartbeat = "bus0: node 10 (module): 1017h:00 is not for ~/sdo_write: key heartbeat says what it holds";
    assert_eq!(said("- - 10 1017 u16").as_deref(), Some(heartbeat));
    assert_eq!(said("- - 10 6206:01 u8"), None, "its error mode");
}
