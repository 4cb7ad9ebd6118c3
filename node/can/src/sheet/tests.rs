use super::*;
use crate::config::Role;
use crate::layout::Layout;
use crate::{Monitoring, NodeId, eds};
use lineshaft_cia402::config::{AnalogTerminal, Terminals, Write};
use lineshaft_cia402::mapping::Extras;
use lineshaft_cia402::mode::DriveMode;
use lineshaft_core::drive::Terminal;

const OWN: &str = include_str!("../../../../launch-configs/can/cia402_sim.eds");

/// Homing is done in the drive.
const HOMES: Requirements = Requirements { bit_rate: None, homes: true };

/// Returns the file of the simulated drive with another value of a key in some sections.
fn changed(changes: &[(&str, &str, &str)]) -> Dictionary {
    let mut text = OWN.to_owned();
    for (section, key, value) in changes {
        let at = text.find(&format!("[{section}]\n")).expect("the section");
        let begin = at + text[at..].find(&format!("\n{key}=")).expect("the key") + 1;
        let end = begin + text[begin..].find('\n').expect("the end of the line");
        text.replace_range(begin..end, &format!("{key}={value}"));
    }
    eds::parse(text.as_bytes(), Some(3)).expect("a good file")
}

fn node() -> NodeId {
    NodeId::new(3).expect("1 to 127")
}

fn drive(mode: DriveMode) -> DeviceConfig {
    let mut device = DeviceConfig::plain_drive(0, node(), Monitoring::None);
    if let Role::Drive(drive) = &mut device.role {
        drive.mode = mode;
    }
    device
}

fn of(errors: &[&str], warnings: &[&str]) -> Findings {
    let owned = |sentences: &[&str]| sentences.iter().map(|sentence| (*sentence).to_owned()).collect();
    Findings { errors: owned(errors), warnings: owned(warnings) }
}

/// Bits 0, 2, 7, 8 of 185h are modes 1, 3, 8, 9 (CiA 402-2); bit 5 is homing.
#[test]
fn mode_that_the_file_does_not_offer_is_an_error() {
    let known = changed(&[("6502", "DefaultValue", "0x185")]);
    assert_eq!(compare(&drive(DriveMode::Csp), Requirements::default(), &known), Findings::default());
    let said = "node 3 (x0): 6502h:00 is 00000185h by the file (pp, pv, csp, csv)";
    let cure = "if the drive offers it all the same, delete the DefaultValue of 6502h in the file: the drive is asked when it starts";
    for (mode, missing) in [
        (DriveMode::Cst, "mode 10 (cst) is missing; no other mode of its interface is offered"),
        (DriveMode::Ip, "mode 7 (ip) is missing; offered are, with its interface, mode: pp or csp"),
    ] {
        let sentence = format!("{said}: {missing}; {cure}");
        assert_eq!(compare(&drive(mode), Requirements::default(), &known), of(&[&sentence], &[]));
    }
    // As the message recommends.
    let deleted = OWN.replacen("DefaultValue=0x3EF\n", "", 1);
    assert_ne!(deleted, OWN);
    let deleted = eds::parse(deleted.as_bytes(), Some(3)).expect("a good file");
    assert_eq!(compare(&drive(DriveMode::Cst), Requirements::default(), &deleted), Findings::default());
    let with_homing = changed(&[("6502", "DefaultValue", "0x1A5")]);
    assert_eq!(compare(&drive(DriveMode::Csp), HOMES, &with_homing), Findings::default());
}

/// Bit 5 of 6502h is homing (CiA 402-2). It is wrong in some files; a ParameterValue was read from the drive itself.
#[test]
fn homing_that_the_file_does_not_offer_is_a_warning_if_its_method_can_be_written() {
    let modes = ("6502", "DefaultValue", "0x185");
    let sentence = "node 3 (x0): 6502h:00 is 00000185h by the file (pp, pv, csp, csv): mode 6 (hm) is missing, and homing.in_drive is true";
    let homing = |known: &Dictionary| compare(&drive(DriveMode::Csp), HOMES, known);
    let warning = format!("{sentence}; 6098h:00 of the file can be written all the same");
    assert_eq!(homing(&changed(&[modes])), of(&[], &[&warning]));
    for access in ["ro", "const"] {
        let read_only =
            format!("node 3 (x0): 6098h:00 has access {access} by the file; it is written for key homing.in_drive");
        let known = changed(&[modes, ("6098", "AccessType", access)]);
        assert_eq!(homing(&known), of(&[sentence, &read_only], &[]));
    }
    let parsed = |text: &str| eds::parse(text.as_bytes(), Some(3)).expect("a good file");
    let lacking = OWN.replacen("[6098]\n", "[2F98]\n", 1).replacen("DefaultValue=0x3EF\n", "DefaultValue=0x185\n", 1);
    let missing = "node 3 (x0): 6098h:00 is missing in the file; key homing.in_drive needs it";
    assert_eq!(homing(&parsed(&lacking)), of(&[sentence], &[missing]));
    let configured = OWN.replacen("[6502]\n", "[6502]\nParameterValue=0x185\n", 1);
    assert_eq!(homing(&parsed(&configured)), of(&[sentence], &[]));
}

#[test]
fn missing_or_zero_supported_modes_are_not_compared() {
    for value in ["0", "", "0xFFFFFFFF"] {
        let known = changed(&[("6502", "DefaultValue", value)]);
        assert_eq!(compare(&drive(DriveMode::Cst), HOMES, &known), Findings::default(), "{value}");
    }
}

/// Control word 16 bits, position 32 bits (CiA 402-2). Signedness makes no difference on the bus; REAL32 has the same length but another
/// encoding.
#[test]
fn mapped_object_of_another_length_or_kind_is_an_error() {
    for (section, data_type, sentence) in [
        ("6064", "0x0008", "6064h:00 is REAL32 by the file; an integer of 32 bits is mapped to a PDO (key interface)"),
        (
            "6041",
            "0x0005",
            "6041h:00 is UNSIGNED8 by the file; an integer of 16 bits is mapped to a PDO (key interface)",
        ),
        (
            "607A",
            "0x0003",
            "607Ah:00 is INTEGER16 by the file; an integer of 32 bits is mapped to a PDO (key interface)",
        ),
        ("6040", "0x0001", "6040h:00 is BOOLEAN by the file; an integer of 16 bits is mapped to a PDO (key interface)"),
    ] {
        let known = changed(&[(section, "DataType", data_type)]);
        let sentence = format!("node 3 (x0): {sentence}");
        assert_eq!(compare(&drive(DriveMode::Csp), Requirements::default(), &known), of(&[&sentence], &[]));
    }
    for (section, data_type) in [("6064", "0x0007"), ("6041", "0x0003"), ("6060", "0x0005"), ("607A", "0x0080")] {
        let known = changed(&[(section, "DataType", data_type), (section, "DefaultValue", "")]);
        assert_eq!(compare(&drive(DriveMode::Csp), Requirements::default(), &known), Findings::default(), "{section}");
    }
}

/// Objects that a device receives must be writable, those that it sends readable; rwr and rww refer to the other direction (CiA 306-1).
#[test]
fn mapped_object_without_the_access_is_an_error() {
    let found = |section, access| {
        let known = changed(&[(section, "AccessType", access)]);
        compare(&drive(DriveMode::Csp), Requirements::default(), &known)
    };
    let said = |object: &str, access: &str, way: &str| {
        format!("node 3 (x0): {object} has access {access} by the file; the device {way} it in a PDO (key interface)")
    };
    assert_eq!(found("6040", "ro"), of(&[&said("6040h:00", "ro", "receives")], &[]));
    assert_eq!(found("607A", "const"), of(&[&said("607Ah:00", "const", "receives")], &[]));
    assert_eq!(found("6064", "wo"), of(&[&said("6064h:00", "wo", "sends")], &[]));
    assert_eq!(found("607A", "rwr"), of(&[], &[&said("607Ah:00", "rwr", "receives")]));
    assert_eq!(found("6061", "rww"), of(&[], &[&said("6061h:00", "rww", "sends")]));
    for (section, access) in [("6040", "rw"), ("6040", "wo"), ("6041", "rw"), ("6041", "rwr"), ("6041", "const")] {
        assert_eq!(found(section, access), Findings::default(), "{section} {access}");
    }
}

fn terminal(address: u16) -> Terminal {
    Terminal { place: 0, address }
}

/// Returns a module with a digital input and an analog output at these addresses.
fn module(input: Option<u16>, output: Option<u16>) -> DeviceConfig {
    let analog = |address| AnalogTerminal { terminal: terminal(address), volts_at_full_scale: 10.0 };
    let terminals = Terminals {
        digital_inputs: input.map(terminal).into_iter().collect(),
        analog_outputs: output.map(analog).into_iter().collect(),
        ..Terminals::default()
    };
    let layout = Layout::module(node(), &terminals).expect("there is room");
    DeviceConfig { layout, terminals, role: Role::Module, ..drive(DriveMode::Csp) }
}

/// Returns a file with these sections.
fn file(sections: &str) -> Dictionary {
    eds::parse(format!("[DeviceInfo]\n{sections}").as_bytes(), Some(3)).expect("a good file")
}

/// Returns the section of an object: index, or index and subindex, with its keys.
fn section(name: &str, data_type: u16, access: &str, default: &str, is_mappable: bool) -> String {
    let mapping = u8::from(is_mappable);
    format!(
        "[{name}]\nParameterName=a\nDataType={data_type}\nAccessType={access}\nDefaultValue={default}\nPDOMapping={mapping}\n"
    )
}

/// Returns 8 inputs in 6000h:01 (CiA 401-1); `mapping` is PDOMapping.
fn inputs(is_mappable: bool) -> String {
    let head = "[6000]\nParameterName=a\nObjectType=8\nSubNumber=2\n".to_owned();
    head + &section("6000sub0", 5, "ro", "1", false) + &section("6000sub1", 5, "ro", "", is_mappable)
}

/// Returns PDO 1 with 6000h:01, 8 bits.
fn pdo_of_inputs() -> String {
    "[1800]\nParameterName=a\nObjectType=9\nSubNumber=1\n".to_owned()
        + &section("1800sub1", 7, "rw", "$NODEID+0x180", false)
        + "[1A00]\nParameterName=a\nObjectType=9\nSubNumber=2\n"
        + &section("1A00sub0", 5, "rw", "1", false)
        + &section("1A00sub1", 7, "rw", "0x60000108", false)
}

#[test]
fn object_that_cannot_be_mapped_is_an_error_unless_the_file_maps_it_itself() {
    let pdo = pdo_of_inputs();
    let of_input = |sections: String| compare(&module(Some(5), None), Requirements::default(), &file(&sections));
    let sentence = "node 3 (module): 6000h:01 cannot be mapped to a PDO by the file: its PDOMapping is not 1 (key io)";
    let itself = format!("{sentence}; PDO 1 of the file carries it all the same");
    assert_eq!(of_input(inputs(false) + &pdo), of(&[], &[&itself]));
    let other = pdo.replace("0x60000108", "0x60000208");
    assert_eq!(of_input(inputs(false) + &other), of(&[sentence], &[]));
    assert_eq!(of_input(inputs(true) + &pdo), Findings::default());
}

/// Returns the file of the simulated drive in which an object has another index, so that this one is missing.
fn without(index: &str) -> Dictionary {
    let (from, to) = (format!("[{index}"), format!("[2F{}", &index[2..]));
    assert!(OWN.contains(&from) && !OWN.contains(&to), "{index}");
    eds::parse(OWN.replace(&from, &to).as_bytes(), Some(3)).expect("a good file")
}

/// Addresses 8 to 15 are bits of 6000h:02 (CiA 401-1). A count that is 0 or missing gives no information.
#[test]
fn io_beyond_the_inputs_of_the_file_is_an_error() {
    let of_input =
        |address, sections: String| compare(&module(Some(address), None), Requirements::default(), &file(&sections));
    let sections = inputs(true) + &pdo_of_inputs();
    assert_eq!(of_input(7, sections.clone()), Findings::default());
    let beyond = "node 3 (module): 6000h:02 does not exist by the file, whose 6000h:00 is 1; entries of io from address 8 on need it";
    for address in [8, 60] {
        assert_eq!(of_input(address, sections.clone()), of(&[beyond], &[]), "{address}");
    }
    let unsaid = sections.replacen("DefaultValue=1\n", "DefaultValue=0\n", 1);
    let missing = "node 3 (module): 6000h:02 is missing in the file; entries of io from address 8 on need it";
    assert_eq!(of_input(8, unsaid), of(&[], &[missing]));
}

/// Channels 0 to 2 of analog outputs are 6411h:01 to 03, from RPDO 2 (CiA 401-1); the position of an encoder is in TPDO 2 (CiA 406).
#[test]
fn missing_objects_of_file_are_warnings() {
    let known = file(&(inputs(true) + &pdo_of_inputs()));
    let found = compare(&module(None, Some(2)), Requirements::default(), &known);
    let [object, pdo] = [
        "node 3 (module): 6411h:01 is missing in the file; entries of io from address 0 on need it",
        "node 3 (module): 1401h is missing in the file; RPDO 2, which the cell needs, has it",
    ];
    assert_eq!(found, of(&[], &[object, pdo]));
    let layout = Layout::encoder(node()).expect("there is room");
    let encoder = DeviceConfig { layout, role: Role::Encoder, ..drive(DriveMode::Csp) };
    let [object, pdo] = [
        "node 3 (encoder): 6004h:00 is missing in the file; key encoders needs it",
        "node 3 (encoder): 1801h is missing in the file; TPDO 2, which the cell needs, has it",
    ];
    assert_eq!(compare(&encoder, Requirements::default(), &known), of(&[], &[object, pdo]));
    let compact = "CompactPDO=3\n".to_owned() + &inputs(true) + &pdo_of_inputs();
    assert_eq!(compare(&encoder, Requirements::default(), &file(&compact)), of(&[], &[object]));
}

#[test]
fn object_written_for_key_must_exist_and_be_writable() {
    let heartbeat = DeviceConfig { watching: Monitoring::Heartbeat { time_ns: 300_000_000 }, ..drive(DriveMode::Csp) };
    let guarding = DeviceConfig {
        watching: Monitoring::Guarding { guard_ns: 100_000_000, life_factor: 3 },
        ..drive(DriveMode::Csp)
    };
    let plain = drive(DriveMode::Csp);
    for (device, needs, index, object, key) in [
        (&heartbeat, Requirements::default(), "1017", "1017h:00", "heartbeat"),
        (&guarding, Requirements::default(), "100D", "100Dh:00", "guarding"),
        (&plain, HOMES, "6098", "6098h:00", "homing.in_drive"),
        (&plain, HOMES, "609A", "609Ah:00", "homing.in_drive"),
    ] {
        let missing = format!("node 3 (x0): {object} is missing in the file; key {key} needs it");
        assert_eq!(compare(device, needs, &without(index)), of(&[], &[&missing]));
        let read_only = changed(&[(index, "AccessType", "ro")]);
        let wrong = format!("node 3 (x0): {object} has access ro by the file; it is written for key {key}");
        assert_eq!(compare(device, needs, &read_only), of(&[&wrong], &[]));
        assert_eq!(compare(device, needs, &changed(&[])), Findings::default());
    }
    let factors = "node 3 (x0): 6092h:01 and 608Fh:01 are missing in the file; key feed is compared with one of them";
    let mut measured = drive(DriveMode::Csp);
    if let Role::Drive(drive) = &mut measured.role {
        drive.counts_per_shaft_revolution = Some((10_000, 1));
    }
    assert_eq!(compare(&measured, Requirements::default(), &without("608F")), of(&[], &[factors]));
    assert_eq!(compare(&measured, Requirements::default(), &changed(&[])), Findings::default());
}

/// Returns the drive in mode csp, with the PDOs that are planned from this file.
fn planned(known: &Dictionary) -> DeviceConfig {
    let layout = Layout::plan(node(), DriveMode::Csp, Extras::default(), &Terminals::default(), Some(known));
    DeviceConfig { layout: layout.expect("it maps what it needs"), ..drive(DriveMode::Csp) }
}

/// 60FDh is UNSIGNED32, 603Fh is UNSIGNED16 (CiA 402-2). Without entries of `io` no cell needs them; with one, 60FDh is required.
#[test]
fn optional_object_of_another_type_or_access_is_a_warning_unless_the_cell_needs_it() {
    let found = |known: &Dictionary| compare(&planned(known), Requirements::default(), known);
    for (section, key, value, sentence) in [
        (
            "60FD",
            "DataType",
            "0x0006",
            "60FDh:00 is UNSIGNED16 by the file, not an integer of 32 bits: it is not mapped to a PDO; the switches of the drive are not read",
        ),
        (
            "60FD",
            "AccessType",
            "wo",
            "60FDh:00 has access wo by the file: it is not mapped to a PDO; the switches of the drive are not read",
        ),
        (
            "603F",
            "DataType",
            "0x0007",
            "603Fh:00 is UNSIGNED32 by the file, not an integer of 16 bits: it is not mapped to a PDO",
        ),
        ("603F", "AccessType", "wo", "603Fh:00 has access wo by the file: it is not mapped to a PDO"),
    ] {
        let sentence = format!("node 3 (x0): {sentence}");
        assert_eq!(found(&changed(&[(section, key, value)])), of(&[], &[&sentence]));
    }
    let known = changed(&[("60FD", "DataType", "0x0006")]);
    let terminals = Terminals { digital_inputs: vec![terminal(16)], ..Terminals::default() };
    let layout = Layout::plan(node(), DriveMode::Csp, Extras::default(), &terminals, Some(&known));
    let device = DeviceConfig { layout: layout.expect("it maps it"), terminals, ..drive(DriveMode::Csp) };
    let sentence = "node 3 (x0): 60FDh:00 is UNSIGNED16 by the file; an integer of 32 bits is mapped to a PDO (key io)";
    assert_eq!(compare(&device, Requirements::default(), &known), of(&[sentence], &[]));
    assert_eq!(found(&changed(&[])), Findings::default());
}

/// Mapping of 6060h and 6061h is optional (CiA 402-2). By SDO, 6060h is written and 6061h is read; both are INTEGER8.
#[test]
fn mode_exchanged_by_sdo_is_compared_with_file() {
    let found = |known: &Dictionary| compare(&planned(known), Requirements::default(), known);
    let unmappable = |section, key, value| changed(&[(section, "PDOMapping", "0"), (section, key, value)]);
    for (section, access) in [("6060", "rw"), ("6060", "wo"), ("6061", "ro"), ("6061", "rw")] {
        assert_eq!(found(&unmappable(section, "AccessType", access)), Findings::default(), "{section} {access}");
    }
    for (section, key, value, sentence) in [
        ("6060", "AccessType", "ro", "6060h:00 has access ro by the file; it is written for key interface"),
        ("6061", "AccessType", "wo", "6061h:00 has access wo by the file; it is read for key interface"),
        (
            "6060",
            "DataType",
            "0x0003",
            "6060h:00 is INTEGER16 by the file; an integer of 8 bits is written by SDO (key interface)",
        ),
        (
            "6061",
            "DataType",
            "0x0003",
            "6061h:00 is INTEGER16 by the file; an integer of 8 bits is read by SDO (key interface)",
        ),
    ] {
        let sentence = format!("node 3 (x0): {sentence}");
        assert_eq!(found(&unmappable(section, key, value)), of(&[&sentence], &[]));
    }
    for index in ["6060", "6061"] {
        let missing = format!("node 3 (x0): {index}h:00 is missing in the file; key interface needs it");
        assert_eq!(found(&without(index)), of(&[], &[&missing]));
    }
}

/// The lower half of 1000h is the profile: 192h is 402, 191h is 401 (CiA 301).
#[test]
fn device_of_another_profile_is_an_error() {
    let found =
        |value| compare(&drive(DriveMode::Csp), Requirements::default(), &changed(&[("1000", "DefaultValue", value)]));
    let of_drive = |device_type, profile| {
        format!(
            "node 3 (x0): 1000h:00 is {device_type} by the file, profile {profile}; entries of axes need profile 402 (drive)"
        )
    };
    // The file contains control word and status word, so the profile is read from the device itself.
    let asked = "; the file has 6040h and 6041h: the device is asked when it starts";
    for (value, device_type, profile) in
        [("0x00030191", "00030191h", "401"), ("0x811", "00000811h", "0811h"), ("0x190", "00000190h", "0190h")]
    {
        assert_eq!(found(value), of(&[], &[&(of_drive(device_type, profile) + asked)]));
    }
    for value in ["0x00FF0192", "0", "", "0x00020000"] {
        assert_eq!(found(value), Findings::default(), "{value}");
    }
    for lacking in ["[6040]", "[6041]"] {
        let text = OWN.replacen("DefaultValue=0x20192\n", "DefaultValue=0x811\n", 1).replacen(lacking, "[2F40]", 1);
        let known = eds::parse(text.as_bytes(), Some(3)).expect("a good file");
        let found = compare(&drive(DriveMode::Csp), Requirements::default(), &known);
        assert_eq!(found.errors, [of_drive("00000811h", "0811h")], "{lacking}");
    }
    let known = |value| file(&(section("1000", 7, "ro", value, false) + &inputs(true) + &pdo_of_inputs()));
    let sentence =
        "node 3 (module): 1000h:00 is 00020192h by the file, profile 402; entries of io need profile 401 (module)";
    assert_eq!(compare(&module(Some(0), None), Requirements::default(), &known("0x00020192")), of(&[sentence], &[]));
    assert_eq!(compare(&module(Some(0), None), Requirements::default(), &known("0x00030191")), Findings::default());
}

/// The file has 125, 250, 500, 1000 kbit/s. A Baudrate of 0 gives no information; a file contains the integer part of 83.3 kbit/s.
#[test]
fn bit_rate_is_compared_with_that_of_the_configuration() {
    let found = |baudrate: &str, bit_rate| {
        let text = format!("{OWN}\n[DeviceComissioning]\nNodeID=3\nBaudrate={baudrate}\n");
        let known = eds::parse(text.as_bytes(), Some(3)).expect("a good file");
        compare(&drive(DriveMode::Csp), Requirements { bit_rate, homes: false }, &known)
    };
    let error = "node 3 (x0): Baudrate is 500 kbit/s in [DeviceComissioning] of the file; bitrate of the backend is 1000000 bit/s";
    assert_eq!(found("500", Some(1_000_000)), of(&[error], &[]));
    for (baudrate, bit_rate) in [("500", Some(500_000)), ("0", Some(500_000)), ("", Some(125_000)), ("500", None)] {
        assert_eq!(found(baudrate, bit_rate), Findings::default(), "{baudrate}");
    }
    let warning = "node 3 (x0): [DeviceInfo] of the file has the bit rates 125, 250, 500, 1000 kbit/s; bitrate of the backend is 83300 bit/s";
    assert_eq!(found("83", Some(83_300)), of(&[], &[warning]));
    // The device does not support the Baudrate of its configuration.
    let denied = |own: u16| {
        format!(
            "node 3 (x0): Baudrate is {own} kbit/s in [DeviceComissioning] of the file; bitrate of the backend is 1000000 bit/s; \
             [DeviceInfo] denies that Baudrate"
        )
    };
    assert_eq!(found("20", Some(1_000_000)), of(&[], &[&denied(20)]));
    let own = |rates: &str| {
        let sections = section("1000", 7, "ro", "0x00020192", false) + "[DeviceComissioning]\nBaudrate=500\n";
        let known = file(&(rates.to_owned() + &sections));
        let device = DeviceConfig { role: Role::Module, ..drive(DriveMode::Csp) };
        let Findings { errors, warnings } =
            compare(&device, Requirements { bit_rate: Some(1_000_000), homes: false }, &known);
        let count = |sentences: Vec<String>| sentences.iter().filter(|said| said.contains("Baudrate is 500")).count();
        (count(errors), count(warnings))
    };
    for rates in ["BaudRate_500=0\n", "BaudRate_500=0\nBaudRate_125=0\n", "BaudRate_1000=1\n"] {
        assert_eq!(own(rates), (0, 1), "{rates}");
    }
    for rates in ["", "BaudRate_125=0\n", "BaudRate_500=1\n", "BaudRate_500=x\n"] {
        assert_eq!(own(rates), (1, 0), "{rates}");
    }
}

/// 6081h is UNSIGNED32, 6041h is the read-only status word.
#[test]
fn startup_is_compared_with_the_objects_of_the_file() {
    let found = |index, bytes: usize| {
        let startup = vec![Write { object: Object { index, sub: 0 }, data: vec![0; bytes] }];
        compare(&DeviceConfig { startup, ..drive(DriveMode::Csp) }, Requirements::default(), &changed(&[]))
    };
    assert_eq!(found(0x6081, 4), Findings::default());
    let length = "node 3 (x0): 6081h:00 is UNSIGNED32 by the file, 4 bytes; key startup writes 2";
    assert_eq!(found(0x6081, 2), of(&[length], &[]));
    let access = "node 3 (x0): 6041h:00 has access ro by the file; it is written for key startup";
    assert_eq!(found(0x6041, 2), of(&[access], &[]));
    let missing = "node 3 (x0): 2F00h:00 is missing in the file; key startup needs it";
    assert_eq!(found(0x2F00, 4), of(&[], &[missing]));
}
