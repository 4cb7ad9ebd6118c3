use super::*;
use crate::cell::Cell;
use lineshaft_can::Monitoring;
use lineshaft_cia402::config::{AnalogTerminal, Encoder};
use lineshaft_core::drive::Terminal;

const HEAD: &str = "lineshaft: 1\ncycle: CYCLE\nbackends:\n  bus0: {type: can, BUS}\naxes:\n";

fn axis(name: &str, drive: &str) -> String {
    format!(
        "  {name}: {{type: linear, scale: {{increments: 10000, per: 10 mm}}, drive: {{backend: bus0, {drive}}},\n    \
         max_velocity: 1 m/s, max_acceleration: 1 m/s^2}}\n"
    )
}

fn cell(cycle: &str, bus: &str, drives: &[String]) -> Cell {
    let axes: String = drives.iter().enumerate().map(|(at, drive)| axis(&format!("x{at}"), drive)).collect();
    let text = HEAD.replace("CYCLE", cycle).replace("BUS", bus) + &axes;
    Cell::parse("c.yaml", text).unwrap_or_else(|problems| panic!("{problems}"))
}

/// Path of the cell file, in the folder that has the EDS of the CAN tests.
fn file() -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../launch-configs/can/c.yaml")
}

fn refused(cell: &Cell) -> String {
    let problems = cell.on_can().buses(Some(&file())).expect_err("it has a problem").to_string();
    problems.replace(&file().display().to_string(), "c.yaml").trim_end().to_owned()
}

const BUS: &str = "transport: 'slcan:/dev/ttyACM0', bitrate: 1000000";

#[test]
fn rates_of_a_serial_adapter_reach_its_bus() {
    let rates = |bus: &str| {
        let buses = cell("4 ms", bus, &["node: 3".to_owned()]).on_can().buses(Some(&file())).unwrap();
        (buses[0].bit_rate, buses[0].serial_baudrate)
    };
    let line = "transport: 'slcan:/dev/ttyUSB0', bitrate: 800000";
    assert_eq!(rates(line), (Some(800_000), None));
    assert_eq!(rates(&format!("{line}, serial_baudrate: 921600")), (Some(800_000), Some(921_600)));
    // Any bit rate is allowed for a Linux interface.
    assert_eq!(rates("transport: 'socketcan:can0', bitrate: 750000"), (Some(750_000), None));
}

/// Bits of a frame with 7 bytes: 47 + 56 + 89 / 4 = 125. SYNC and two frames for each drive.
///
/// Proves: MACS-CAN-16
#[test]
fn a_cycle_that_does_not_fit_the_bit_rate_is_refused_with_the_sum() {
    let drives: Vec<_> = (1..=4).map(|node| format!("node: {node}")).collect();
    let sentence = "c.yaml:4:9: backend bus0: what each cycle carries does not fit: 9 frames of 1055 bits take 1055 us at 1000000 bit/s, \
                    the cycle is 1000 us; a cycle of 1.1 ms fits, or fewer devices on this bus";
    assert_eq!(refused(&cell("1 ms", BUS, &drives)), sentence);
    let fits = cell("2 ms", BUS, &drives).on_can().buses(None).unwrap();
    let load = "backend bus0: 9 frames of 1055 bits at most in each cycle of 2000 us: 53 % of 1000000 bit/s";
    assert_eq!(load_of(&fits[0]).as_deref(), Some(load));
    // The bit rate of a Linux interface is unknown unless the cell gives it.
    let unknown = cell("1 ms", "transport: 'socketcan:can0'", &drives).on_can().buses(None).unwrap();
    assert_eq!(load_of(&unknown[0]), None);
}

#[test]
fn cycle_that_drives_cannot_represent_is_refused() {
    let sentence = "c.yaml:4:9: backend bus0: a cycle of 1001 us cannot be told to drives (60C2h); 1 to 255 times 1, 10, 100 us or 1 ms is \
                    allowed";
    assert_eq!(refused(&cell("1001 us", BUS, &["node: 1".to_owned()])), sentence);
}

#[test]
fn a_drive_with_the_node_of_the_master_is_refused() {
    let sentence = "c.yaml:4:9: backend bus0: node 127 (x0) has the node id of the master";
    assert_eq!(refused(&cell("4 ms", BUS, &["node: 127".to_owned()])), sentence);
    let other = format!("{BUS}, master: {{node: 1}}");
    assert!(cell("4 ms", &other, &["node: 127".to_owned()]).on_can().buses(None).is_ok());
    let none = format!("{BUS}, master: none");
    assert_eq!(cell("4 ms", &none, &["node: 127".to_owned()]).on_can().buses(None).unwrap()[0].master, None);
}

/// Vendor and product are those of the file unless the cell gives others; digital inputs and error code are mapped.
#[test]
fn drive_description_comes_from_eds_and_cell() {
    let drive = "node: 3, eds: cia402_sim.eds, identity: {product: 7, serial: 9}, feed: 20 mm, heartbeat: 50 ms, \
                 velocity_factor: {numerator: 60, denominator: 10000}, startup: [{index: 0x2080, sub: 1, value: -5, type: i16}]";
    let cell = cell("4 ms", BUS, &[drive.to_owned()]);
    let buses = cell.on_can().buses(Some(&file())).unwrap();
    let [drive] = buses[0].devices.as_slice() else { panic!("one drive") };
    let identity = Identity { vendor: Some(0xFFFF), product: Some(7), revision: None, serial: Some(9) };
    let as_drive = drive.drive().unwrap();
    assert_eq!((drive.identity, as_drive.counts_per_shaft_revolution), (identity, Some((20_000, 1))));
    assert_eq!(drive.watching, Monitoring::Heartbeat { time_ns: 150_000_000 });
    assert_eq!(as_drive.velocity.to_drive(10_000.0), 60);
    let [write] = drive.startup.as_slice() else { panic!("{:?}", drive.startup) };
    assert_eq!((write.object.to_string(), write.data.as_slice()), ("2080h:01".to_owned(), [0xFB, 0xFF].as_slice()));
    assert_eq!(drive.layout.told.len(), 2);
}

/// Returns a folder with a configuration, and the path of a cell in it.
fn with_file(text: &str) -> (tempfile::TempDir, std::path::PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("x.dcf"), text).unwrap();
    let cell = folder.path().join("c.yaml");
    (folder, cell)
}

/// Values that a tool of the manufacturer may have read from a running drive. All of them are writable. The mask of the
/// outputs (60FEh:02) and manufacturer-specific objects are configuration; the master writes 1017h; values in the cell
/// are kept.
#[test]
fn configuration_omits_actions_and_setpoints() {
    let mut text = std::fs::read_to_string(file().with_file_name("cia402_sim.eds")).unwrap();
    for (section, value) in [
        ("1003sub0", "0"),
        ("1010sub1", "0x65766173"),
        ("1011sub1", "0x64616F6C"),
        ("1017", "50"),
        ("2001", "text"),
        ("6040", "15"),
        ("6071", "100"),
        ("607A", "77"),
        ("6081", "30000"),
        ("60FEsub1", "1"),
        ("60FEsub2", "0x10000"),
        ("60FF", "88"),
    ] {
        let head = format!("[{section}]\n");
        assert!(text.contains(&head), "{section}");
        text = text.replacen(&head, &format!("{head}ParameterValue={value}\n"), 1);
    }
    let (_folder, at) = with_file(&text);
    let drive = "node: 3, eds: x.dcf, startup: [{index: 0x60FF, value: 5, type: i32}]";
    let buses = cell("4 ms", BUS, &[drive.to_owned()]).on_can().buses(Some(&at)).unwrap();
    let told: Vec<_> = buses[0].devices[0].startup.iter().map(|write| write.object.to_string()).collect();
    assert_eq!(told, ["2001h:00", "6081h:00", "60FEh:02", "60FFh:00"]);
    let line = "backend bus0: node 3 (x0): left out of its DCF, as objects that act: 1003h:00, 1010h:01, 1011h:01, 6040h:00; \
                as setpoints: 6071h:00, 607Ah:00, 60FEh:01";
    assert_eq!(left_out_of(&buses[0]), [line]);
    // Without values there is no line.
    let plain = cell("4 ms", BUS, &["node: 3, eds: cia402_sim.eds".to_owned()]).on_can().buses(Some(&file())).unwrap();
    assert_eq!(left_out_of(&plain[0]), [""; 0]);
}

/// A drive need not be able to map 6060h and 6061h (CiA 402-2).
#[test]
fn mode_by_sdo_is_reported_in_one_line() {
    let eds = std::fs::read_to_string(file().with_file_name("cia402_sim.eds")).unwrap();
    let lines = |unmappable: &[&str]| {
        let mut text = eds.clone();
        for section in unmappable {
            let at = text.find(&format!("[{section}]\n")).unwrap();
            text = format!("{}{}", &text[..at], text[at..].replacen("PDOMapping=0x1", "PDOMapping=0", 1));
        }
        let (_folder, at) = with_file(&text);
        let buses = cell("4 ms", BUS, &["node: 3, eds: x.dcf".to_owned()]).on_can().buses(Some(&at)).unwrap();
        mode_by_sdo_of(&buses[0])
    };
    assert_eq!(lines(&[]), [""; 0]);
    let cases: [(&[&str], &str); 3] = [
        (&["6060", "6061"], "6060h and 6061h are in no PDO: the mode goes by SDO"),
        (&["6060"], "6060h is in no PDO: the mode is written by SDO"),
        (&["6061"], "6061h is in no PDO: the mode is read by SDO"),
    ];
    for (unmappable, sentence) in cases {
        assert_eq!(lines(unmappable), [format!("backend bus0: node 3 (x0): {sentence}")]);
    }
}

/// Outputs (6200h) of a module are left out; the fault behaviour of outputs (6206h) and a filter are written. The
/// filter is 6003h, which is the preset in encoders.
#[test]
fn configuration_of_a_module_omits_its_outputs() {
    let object = |index: &str| format!("[{index}]\nDataType=5\nAccessType=rw\nParameterValue=1\n");
    let text = "[DeviceInfo]\n".to_owned() + &["6003", "6200", "6206", "6411"].map(object).concat();
    let (_folder, at) = with_file(&text);
    let io = "io:\n  s: {type: di, backend: bus0, node: 10, address: 0}\n";
    let buses = with_sections(", nodes: [{node: 10, eds: x.dcf}]", io).on_can().buses(Some(&at)).unwrap();
    let [_, module] = buses[0].devices.as_slice() else { panic!("{:?}", buses[0].devices) };
    let told: Vec<_> = module.startup.iter().map(|write| write.object.to_string()).collect();
    assert_eq!(told, ["6003h:00", "6206h:00"]);
    let line = "backend bus0: node 10 (module): left out of its DCF, as setpoints: 6200h:00, 6411h:00";
    assert_eq!(left_out_of(&buses[0]), [line]);
}

/// The sign of a drive type selects its supervision; an AKD uses 1/1000 rpm of its shaft: 10 mm, 10,000 increments.
///
/// Proves: MACS-CAN-01, MACS-CAN-12
#[test]
fn a_drive_by_number_has_its_watch_and_its_units() {
    let device = |drive: &str| {
        let cell = cell("4 ms", BUS, &[format!("node: 3, interface: velocity, {drive}")]);
        assert!(!cell.machine.axes[0].drive.unwrap().homes, "it stays in its mode");
        cell.on_can().buses(None).unwrap().remove(0).devices.remove(0)
    };
    let guarding = |ms: u64, life_factor| Monitoring::Guarding { guard_ns: ms * 1_000_000, life_factor };
    assert_eq!(device("drivetype: 2").watching, guarding(100, 3));
    assert_eq!(device("drivetype: 2, guarding: {time: 50 ms, factor: 2}").watching, guarding(50, 2));
    assert_eq!(device("drivetype: -4").watching, Monitoring::None);
    let akd = device("drivetype: -13, feed: 10 mm");
    assert_eq!(akd.drive().unwrap().velocity.to_drive(500_000.0), 3_000_000);
}

#[test]
fn a_file_that_is_not_there_is_named() {
    let cell = cell("4 ms", BUS, &["node: 3, eds: none.eds".to_owned()]);
    let said = refused(&cell);
    assert!(said.starts_with("c.yaml:6:99: eds ") && said.contains("none.eds` cannot be read: "), "{said}");
}

/// 21 s, 65535 ms and one hour, as in docs/can.md.
#[test]
fn times_of_a_bus_reach_the_ends_of_their_ranges() {
    let bus = format!("{BUS}, time: 3600 s, master: {{heartbeat: 21 s}}");
    let drives = ["node: 1, heartbeat: 21 s", "node: 2, guarding: {time: 65535 ms, factor: 1}"].map(str::to_owned);
    let cell = cell("4 ms", &bus, &drives);
    let described = cell.backends[0].bus.as_ref().expect("a bus");
    assert_eq!(described.time_ns, Some(3_600_000_000_000));
    assert_eq!(described.master.as_ref().map(|master| master.heartbeat_ns), Some(21_000_000_000));
    let watching: Vec<_> = cell.on_can().drives().flatten().map(|drive| drive.device.watching).collect();
    let guarding = Monitoring::Guarding { guard_ns: 65_535_000_000, life_factor: 1 };
    assert_eq!(watching, [Monitoring::Heartbeat { time_ns: 63_000_000_000 }, guarding]);
}

#[test]
fn keys_of_buses_and_drives_have_ranges() {
    let said = |bus: &str, drive: &str| {
        let text = HEAD.replace("CYCLE", "4 ms").replace("BUS", bus) + &axis("x", drive);
        let said = Cell::parse("c.yaml", text).expect_err("it has a problem").to_string();
        said.lines().next().unwrap_or_default().split_once(": ").unwrap_or_default().1.to_owned()
    };
    for (bus, sentence) in [
        ("transport: 'slcan:/dev/ttyACM0'", "missing key `bitrate` in backend `bus0`"),
        (
            "transport: 'udp:239.74.163.2:43113', bitrate: 500000",
            "bitrate is for a bus; datagrams have none, leave it out",
        ),
        (
            "transport: 'slcan:/dev/ttyACM0', bitrate: 750000",
            "bitrate is 750000; an slcan adapter knows 10000, 20000, 50000, 100000, 125000, 250000, 500000, 800000, 1000000 \
             bit/s",
        ),
        (
            "transport: 'slcan:/dev/ttyACM0', bitrate: 800000, serial_baudrate: 115201",
            "serial_baudrate is 115201; 9600, 19200, 38400, 57600, 115200, 230400, 460800, 500000, 576000, 921600, 1000000, \
             1152000, 1500000, 2000000, 2500000, 3000000, 4000000 bit/s are allowed",
        ),
        (
            "transport: 'slcan-tcp:127.0.0.1:3333', bitrate: 800000, serial_baudrate: 115200",
            "serial_baudrate is for a serial line, transport slcan:PATH, leave it out",
        ),
        ("transport: 'socketcan:can0', sync_counter: 241", "sync_counter is 241; 2..240 is allowed"),
        (
            "transport: 'socketcan:can0', time: 50 ms",
            "time is `50 ms`; 100 ms to 3600000 ms in whole milliseconds is allowed",
        ),
        (
            "transport: 'socketcan:can0', sdo_timeout: 5 ms",
            "sdo_timeout is `5 ms`; 10 ms to 10000 ms in whole milliseconds is allowed",
        ),
        (
            "transport: 'socketcan:can0', master: {heartbeat: 1.5 ms}",
            "heartbeat is `1.5 ms`; 1 ms to 21000 ms in whole milliseconds is allowed",
        ),
    ] {
        assert_eq!(said(bus, "node: 1"), sentence);
    }
    for (drive, sentence) in [
        (
            "node: 1, heartbeat: 50 ms, guarding: {time: 50 ms, factor: 3}",
            "heartbeat and guarding exclude each other, leave one of them out",
        ),
        ("node: 1, guarding: {time: 50 ms, factor: 0}", "factor is 0; 1..255 is allowed"),
        ("node: 1, identity: {vendor: 0x1FFFFFFFF}", "vendor is 8589934591; 0..4294967295 is allowed"),
        ("node: 1, velocity_factor: {numerator: 0, denominator: 1}", "numerator is 0; 1..4294967295 is allowed"),
        ("node: 1, startup: [{index: 0x2080, value: 256, type: u8}]", "value is 256; 0..255 is allowed"),
        ("node: 1, startup: [{index: 0x2080, value: -129, type: i8}]", "value is -129; -128..127 is allowed"),
        (
            "node: 1, startup: [{index: 0x6060, value: 1, type: i8}]",
            "object 6060h is not for startup: the interface of the drive says what it holds",
        ),
        ("node: 1, probe_1: up", "probe_1 is `up`; one of rising, falling, both, index is allowed"),
        (
            "node: 1, probe_1: both, probe_2: rising",
            "probe_1 and probe_2: one of them may catch edges, and one the index",
        ),
        ("node: 1, feed: 1 rev", "feed: `1 rev` is an angle; a length such as `1 mm` is expected"),
        ("node: 1, missed_cycles: 0", "missed_cycles is 0; 1..1000 is allowed"),
        ("node: 1, missed_pdo: guess", "missed_pdo is `guess`; one of hold, extrapolate is allowed"),
        ("node: 1, rated_effort: 2 Nm", "rated_effort: `2 Nm` is a torque; a force such as `2 N` is expected"),
        (
            "node: 1, interface: torque, rated_effort: 2 N",
            "rated_effort is not for interface torque, whose efforts are per mille of the rated torque, leave it out",
        ),
        ("node: 1, interface: torque, mode: csv", "mode is csv; with interface torque tq, cst is allowed"),
        ("node: 1, mode: csv", "mode is csv; with interface position pp, ip, csp is allowed"),
        ("node: 1, interface: velocity, mode: vl", "mode is vl; with interface velocity pv, csv is allowed"),
        (
            "node: 1, interface: velocity, drivetype: 14",
            "drivetype is 14; -2, -3, -4, -11, -13, 2, 3, 4, 11, 13 are allowed",
        ),
        (
            "node: 1, interface: velocity, drivetype: -110",
            "drivetype -110 does not exist here: nothing here writes a control word that the axis leaves alone",
        ),
        ("node: 1, drivetype: 2", "drivetype 2 is commanded by a velocity: it needs interface velocity"),
        (
            "node: 1, interface: velocity, drivetype: 13",
            "drivetype 13 has velocities in 1/1000 rpm: it needs feed, or velocity_factor",
        ),
        (
            "node: 1, interface: velocity, drivetype: 2, heartbeat: 50 ms",
            "drivetype 2: its sign says how it is watched; heartbeat is not for it",
        ),
        (
            "node: 1, interface: velocity, drivetype: -2, guarding: {time: 50 ms, factor: 3}",
            "drivetype -2 is without guarding; key guarding is for a positive one",
        ),
    ] {
        assert_eq!(said(BUS, drive), sentence);
    }
}

#[test]
fn probes_need_a_dictionary() {
    let drive = "node: 1, probe_1: rising".to_owned();
    let cell = cell("4 ms", BUS, &[drive]);
    assert!(cell.machine.axes[0].drive.is_some_and(|offers| offers.latches));
    let sentence =
        "drive of axis `x0`: probes need 60BAh:00 in a PDO; the drive has no dictionary (key eds) that maps it";
    assert!(refused(&cell).ends_with(sentence));
}

/// Returns a cell with a drive at node 1 and with `sections`; `bus` has additional keys of its bus.
fn with_sections(bus: &str, sections: &str) -> Cell {
    let text = HEAD.replace("CYCLE", "4 ms").replace("BUS", &format!("{BUS}{bus}")) + &axis("x", "node: 1");
    let text = text.replace("axes:", &format!("{sections}axes:"));
    Cell::parse("c.yaml", text).unwrap_or_else(|problems| panic!("{problems}"))
}

/// Indices are those of the machine, by kind; a node that is no drive is a module or an encoder, with a heartbeat of
/// 100 ms.
#[test]
fn terminals_stand_at_their_devices() {
    let sections = "io:
  s: {type: di, backend: bus0, node: 10, address: 63}
  v: {type: di, output: o}
  p: {type: di, backend: bus0, node: 1, address: 31}
  a: {type: ai, backend: bus0, node: 10, address: 11, full_scale: 500 mV}
  o: {type: do, backend: bus0, node: 1, address: 0}
encoders:
  e: {backend: bus0, node: 12, steps: 4096, type: rotary, scale: {increments: 4096, per: 1 rev}}
  d: {backend: bus0, node: 1, type: rotary, scale: {increments: 4096, per: 1 rev}}
";
    let buses = with_sections(", nodes: [{node: 12, heartbeat: none}]", sections).on_can().buses(None).unwrap();
    let [drive, module, encoder] = buses[0].devices.as_slice() else { panic!("{:?}", buses[0].devices) };
    let at = |place, address| Terminal { place, address };
    let of_drive = Terminals {
        digital_inputs: vec![at(2, 31)],
        digital_outputs: vec![at(0, 0)],
        encoders: vec![Encoder { place: 1, is_absolute: false }],
        ..Terminals::default()
    };
    assert_eq!((drive.to_string(), &drive.terminals), ("node 1 (x)".to_owned(), &of_drive));
    let of_module = Terminals {
        digital_inputs: vec![at(0, 63)],
        analog_inputs: vec![AnalogTerminal { terminal: at(0, 11), volts_at_full_scale: 0.5 }],
        ..Terminals::default()
    };
    assert_eq!((module.to_string(), &module.terminals), ("node 10 (module)".to_owned(), &of_module));
    assert_eq!(module.watching, Monitoring::Heartbeat { time_ns: 300_000_000 });
    let of_encoder = vec![Encoder { place: 0, is_absolute: true }];
    assert_eq!((encoder.to_string(), &encoder.terminals.encoders), ("node 12 (encoder)".to_owned(), &of_encoder));
    assert_eq!(encoder.watching, Monitoring::None);
}

#[test]
fn full_scale_of_an_analog_output_is_its_range() {
    let sections = "io:
  a: {type: ao, backend: bus0, node: 10, address: 0, full_scale: 500 mV}
  b: {type: ao, backend: bus0, node: 10, address: 1}
";
    let machine = with_sections("", sections).machine;
    assert_eq!((machine.full_scale(0), machine.full_scale(1)), (0.5, 10.0));
    let refused = |given: &[(&str, f64)]| machine.resolve_set_output(given).unwrap_err().to_string();
    assert_eq!(refused(&[("a", 0.6)]), "a is `0.6`; -0.5 V to 0.5 V is expected");
    assert_eq!(refused(&[("b", 12.0)]), "b is `12`; -10 V to 10 V is expected");
}

#[test]
fn terminals_that_a_device_has_not_are_refused() {
    let io = |of: &str| format!("io:\n  s: {{{of}, backend: bus0, node: 10, address: 12}}\n");
    let encoder = "encoders:\n  e: {backend: bus0, node: 10, type: rotary, scale: {increments: 4096, per: 1 rev}}\n";
    for (bus, sections, sentence) in [
        ("", io("type: ai"), "io `s`: address is 12; node 10 is a module, 0 to 11 is allowed"),
        ("", io("type: ao").replace("10", "1"), "io `s` is analog; node 1 is a drive, of which digital ones are taken"),
        (
            "",
            io("type: do").replace("10", "1").replace("12", "32"),
            "io `s`: address is 32; node 1 is a drive, 0 to 31 is allowed",
        ),
        (
            "",
            io("type: di") + encoder,
            "`e`: node 10 has entries of io and of encoders; a module or an encoder is allowed",
        ),
        (", nodes: [{node: 9}]", io("type: di"), "node 9 of nodes: no entry of io or encoders is there"),
        (
            ", nodes: [{node: 1}]",
            String::new(),
            "node 1 of nodes is the drive of axis `x`; what is said of it stands there",
        ),
        ("", io("type: di").replace("10", "127"), "backend bus0: node 127 (module) has the node id of the master"),
    ] {
        let problem = refused(&with_sections(bus, &sections));
        assert!(problem.ends_with(sentence), "{problem}");
    }
}

/// The cells in the examples folder.
#[test]
fn the_example_cells_make_buses() {
    let folder = file().parent().unwrap().to_owned();
    let cells = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let is_cell = |path: &std::path::PathBuf| {
        let name = path.to_string_lossy();
        name.ends_with(".yaml") && !name.ends_with(".scenario.yaml")
    };
    let cells: Vec<_> = cells.filter(is_cell).collect();
    assert!(cells.len() >= 4, "{cells:?}");
    for path in cells {
        let cell = Cell::load(&path).unwrap_or_else(|problems| panic!("{problems}"));
        assert_eq!(
            cell.on_can().buses(Some(&path)).map(|buses| buses.len()).map_err(|problems| problems.to_string()),
            Ok(1)
        );
    }
}

/// Returns a folder with the changed EDS of the simulated drive as `drive.eds`, and the path of a cell next to it.
fn beside(changes: &[(&str, &str)]) -> (tempfile::TempDir, std::path::PathBuf) {
    let mut text = std::fs::read_to_string(file().with_file_name("cia402_sim.eds")).unwrap();
    for (from, to) in changes {
        assert!(text.contains(from), "{from}");
        text = text.replacen(from, to, 1);
    }
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("drive.eds"), text).unwrap();
    let path = folder.path().join("c.yaml");
    (folder, path)
}

/// Returns the warnings about drives with this file, each after the name of the file.
fn warned(changes: &[(&str, &str)], bus: &str, drives: &[&str]) -> Vec<String> {
    let (_folder, path) = beside(changes);
    let drives: Vec<_> = drives.iter().map(|drive| format!("{drive}, eds: drive.eds")).collect();
    let (_, warnings) =
        cell("4 ms", bus, &drives).on_can().buses_and_warnings(Some(&path)).unwrap_or_else(|error| panic!("{error}"));
    warnings.iter().map(|warning| warning.split_once("drive.eds`: ").expect("the file").1.to_owned()).collect()
}

/// Returns the reason why a drive with this file is refused.
fn refused_by_file(changes: &[(&str, &str)], bus: &str, drive: &str) -> String {
    let (_folder, path) = beside(changes);
    let drive = format!("{drive}, eds: drive.eds");
    let problems = cell("4 ms", bus, &[drive]).on_can().buses(Some(&path)).expect_err("it has a problem");
    problems.to_string().split_once("drive.eds`: ").expect("the file").1.trim_end().to_owned()
}

#[test]
fn a_file_with_an_unreadable_value_of_the_configuration_is_refused() {
    let said = refused_by_file(&[("[6081]\n", "[6081]\nParameterValue=-1\n")], BUS, "node: 3");
    assert!(said.ends_with("[6081] ParameterValue=-1: -1 is not within 0 and 4294967295, as UNSIGNED32 is"), "{said}");
}

/// A warning about a file that two drives share is given once.
#[test]
fn ignored_parts_of_a_file_are_reported_once() {
    let warnings = warned(&[("[6041]\n", "[6041]\nParameterValue=x\n")], BUS, &["node: 3", "node: 4"]);
    let [warning] = warnings.as_slice() else { panic!("{warnings:?}") };
    let sentence =
        "[6041] ParameterValue=x: \"x\" is no number: decimal (12), hexadecimal (0x0C) or octal (014); passed over";
    assert!(warning.starts_with("line ") && warning.ends_with(sentence), "{warning}");
    assert_eq!(warned(&[], BUS, &["node: 3"]), [""; 0]);
}

/// 2000h to 5FFFh are manufacturer-specific (CiA 301). The file has 2000h as UNSIGNED32, 2010h as INTEGER16.
#[test]
fn values_of_unused_objects_of_the_manufacturer_are_counted() {
    let changes = [
        ("[2000]\n", "[2000]\nLowLimit=x\nHighLimit=y\n"),
        ("[2010]\n", "[2010]\nParameterValue=70000\n"),
        ("[6041]\n", "[6041]\nParameterValue=x\n"),
    ];
    let said = warned(&changes, BUS, &["node: 3"]);
    let [status, value, limits] = said.as_slice() else { panic!("{said:?}") };
    assert!(status.starts_with("line ") && status.contains("[6041] ParameterValue=x: "), "{status}");
    // A single one is not counted but reported.
    let end = "[2010] ParameterValue=70000: 70000 is not within -32768 and 32767, as INTEGER16 is; passed over";
    assert!(value.starts_with("line ") && value.ends_with(end), "{value}");
    let (begin, end) = (
        "2 limits of objects of the manufacturer passed over, the first in line ",
        ": [2000] LowLimit=x: \"x\" is no number: decimal (12), hexadecimal (0x0C) or octal (014)",
    );
    assert!(limits.starts_with(begin) && limits.ends_with(end), "{limits}");
    // An object that `startup` writes is in use.
    let said = warned(&changes, BUS, &["node: 3, startup: [{index: 0x2000, value: 5, type: u32}]"]);
    assert_eq!(said.iter().filter(|said| said.starts_with("line ")).count(), 4, "{said:?}");
}

/// 185h is pp, pv, csp, csv. A default of 0 means unknown.
#[test]
fn mode_that_the_file_does_not_offer_is_refused() {
    let at =
        "[6502]\nParameterName=Supported drive modes\nObjectType=0x7\nDataType=0x0007\nAccessType=ro\nDefaultValue=";
    let (from, to) = (format!("{at}0x3EF"), format!("{at}0x185"));
    let said = refused_by_file(&[(from.as_str(), to.as_str())], BUS, "node: 3, mode: ip");
    let sentence = "node 3 (x0): 6502h:00 is 00000185h by the file (pp, pv, csp, csv): mode 7 (ip) is missing; offered are, with its \
                    interface, mode: pp or csp; if the drive offers it all the same, delete the DefaultValue of 6502h in the file: the drive \
                    is asked when it starts";
    assert_eq!(said, sentence);
    assert_eq!(warned(&[(from.as_str(), to.as_str())], BUS, &["node: 3"]), [""; 0]);
}

/// The file of a drive, for a node with an input of `io`.
#[test]
fn file_of_another_profile_is_refused_for_a_module() {
    let (_folder, path) = beside(&[]);
    let io = "io:\n  s: {type: di, backend: bus0, node: 10, address: 5}\n";
    let cell = with_sections(", nodes: [{node: 10, eds: drive.eds}]", io);
    let said = cell.on_can().buses(Some(&path)).expect_err("it has a problem").to_string();
    let sentence = "drive.eds`: node 10 (module): 1000h:00 is 00020192h by the file, profile 402; entries of io need profile 401 (module)";
    assert!(said.contains(sentence), "{said}");
}

/// A DCF for 500 kbit/s at a bus of 1 Mbit/s; the EDS has 125, 250, 500 and 1000 kbit/s.
#[test]
fn bit_rate_of_the_configuration_is_compared_with_that_of_the_backend() {
    let own = [("[Comments]\n", "[DeviceComissioning]\nBaudrate=500\n[Comments]\n")];
    let sentence = "node 3 (x0): Baudrate is 500 kbit/s in [DeviceComissioning] of the file; bitrate of the backend is 1000000 bit/s";
    assert_eq!(refused_by_file(&own, BUS, "node: 3"), sentence);
    let half = BUS.replace("1000000", "500000");
    assert_eq!(warned(&own, &half, &["node: 3"]), [""; 0]);
    let odd = BUS.replace("1000000", "800000");
    let sentence = "node 3 (x0): [DeviceInfo] of the file has the bit rates 125, 250, 500, 1000 kbit/s; bitrate of the backend is 800000 bit/s";
    assert_eq!(warned(&[], &odd, &["node: 3"]), [sentence]);
}

/// Returns the warnings about inputs of drives that are not read, or the problems of the cell.
fn unread(cell: &Cell) -> Result<Vec<String>, String> {
    let named = |text: &str| text.replace(&file().display().to_string(), "c.yaml").trim_end().to_owned();
    let buses = cell.on_can().buses(Some(&file())).unwrap_or_else(|problems| panic!("{problems}"));
    match cell.on_can().unread(&buses, Some(&file())) {
        Ok(warnings) => Ok(warnings.iter().map(|warning| named(warning)).collect()),
        Err(problems) => Err(named(&problems.to_string())),
    }
}

/// Returns a cell with this drive, these keys of its axis, and a section `io`.
fn with_keys(drive: &str, keys: &str, io: &str) -> Cell {
    let axis = axis("x0", drive).replace("max_acceleration: 1 m/s^2}", &format!("max_acceleration: 1 m/s^2{keys}}}"));
    let text = HEAD.replace("CYCLE", "4 ms").replace("BUS", BUS).replace("axes:\n", &format!("{io}axes:\n")) + &axis;
    Cell::parse("c.yaml", text).unwrap_or_else(|problems| panic!("{problems}"))
}

const WITHOUT_EDS: &str = "the cell names no EDS or DCF file of it; give `eds`, or an entry of io of type di at this node, which maps 60FDh; or";

/// 60FDh is mapped by the file of the drive or by an entry of `io` at the drive. An axis with inputs for both limit
/// switches needs no others, and an axis with a modulo needs none.
#[test]
fn limit_switches_that_are_not_read_are_warned_of_by_name_and_place() {
    let told = |line: u8, switches: &str, keys: &str| {
        Ok(vec![format!(
            "c.yaml:{line}:69: x0: switches at the drive (node 3) are not read, so {switches} there cannot stop the axis: {WITHOUT_EDS} assign \
             inputs with {keys}"
        )])
    };
    let io = |node: u8| {
        format!(
            "io:\n  a: {{type: di, backend: bus0, node: {node}, address: 0}}\n  b: {{type: di, backend: bus0, node: {node}, address: 1}}\n"
        )
    };
    let both = ("limit switches", "i_poslimitsw and i_neglimitsw");
    assert_eq!(unread(&with_keys("node: 3", "", "")), told(6, both.0, both.1));
    assert_eq!(unread(&with_keys("node: 3, eds: cia402_sim.eds", "", "")), Ok(vec![]));
    assert_eq!(unread(&with_keys("node: 3", "", &io(3))), Ok(vec![]), "io maps 60FDh");
    // Inputs of a module are not those of the drive, unless they are assigned.
    let at_module = |keys: &str| unread(&with_keys("node: 3", keys, &io(10)));
    assert_eq!(at_module(""), told(9, both.0, both.1));
    assert_eq!(at_module(", i_poslimitsw: 1"), told(9, "the negative limit switch", "i_neglimitsw"));
    assert_eq!(at_module(", i_neglimitsw: -2"), told(9, "the positive limit switch", "i_poslimitsw"));
    assert_eq!(at_module(", i_poslimitsw: 1, i_neglimitsw: -2"), Ok(vec![]));
    let by_number = unread(&with_keys("node: 3, interface: velocity, drivetype: 2", "", "")).unwrap();
    let why = "cannot stop the axis: key `drivetype` fixes the process data; assign inputs with";
    assert!(by_number.len() == 1 && by_number[0].contains(why), "{by_number:?}");
    let rotary = HEAD.replace("CYCLE", "4 ms").replace("BUS", BUS)
        + "  x0: {type: rotary, modulo: 360 deg, scale: {increments: 10000, per: 360 deg}, drive: {backend: bus0, node: 3},\n    \
           max_velocity: 1 rad/s, max_acceleration: 1 rad/s^2}\n";
    let rotary = Cell::parse("c.yaml", rotary).unwrap_or_else(|problems| panic!("{problems}"));
    assert_eq!(unread(&rotary), Ok(vec![]));
}

#[test]
fn file_that_does_not_map_60fdh_is_named_in_the_warning() {
    let eds = std::fs::read_to_string(file().with_file_name("cia402_sim.eds")).unwrap();
    let at = eds.find("[60FD]\n").unwrap();
    let text = format!("{}{}", &eds[..at], eds[at..].replacen("PDOMapping=0x1", "PDOMapping=0", 1));
    let (_folder, at) = with_file(&text);
    let cell = cell("4 ms", BUS, &["node: 3, eds: x.dcf".to_owned()]);
    let buses = cell.on_can().buses(Some(&at)).unwrap();
    let warnings = cell.on_can().unread(&buses, Some(&at)).unwrap();
    let why = "cannot stop the axis: eds `x.dcf` does not let 60FDh be mapped; correct 60FDh in that file; or assign inputs with";
    assert!(warnings.len() == 1 && warnings[0].contains(why), "{warnings:?}");
}

/// CiA 402 methods that use limit switches, the reference switch or the index. With homing in the drive none of them is
/// read here.
#[test]
fn homing_by_a_switch_or_an_index_that_is_not_read_is_refused() {
    let of =
        |drive: &str, homing: &str| unread(&with_keys(drive, &format!(", homing: {{{homing}}}"), "")).map(|_| "good");
    let needs = |method: u8, switch: &str, key: &str| {
        Err(format!(
            "c.yaml:6:69: x0: homing.method {method} needs the {switch}, and switches at the drive (node 3) are not read: {WITHOUT_EDS} assign an \
             input with {key}"
        ))
    };
    assert_eq!(of("node: 3", "method: 17"), needs(17, "negative limit switch", "i_neglimitsw"));
    assert_eq!(of("node: 3", "method: 18"), needs(18, "positive limit switch", "i_poslimitsw"));
    assert_eq!(of("node: 3", "method: 24"), needs(24, "reference switch", "i_refswitch"));
    let index = "c.yaml:6:69: x0: homing.method 33 needs the index pulse, and index pulses of the drive (node 3) are not read; give it `probe_1: \
                 index` or `probe_2: index`, or choose a method without index, or homing.in_drive";
    assert_eq!(of("node: 3", "method: 33"), Err(index.to_owned()));
    let eds = "node: 3, eds: cia402_sim.eds";
    assert_eq!(of(eds, "method: 33"), Err(index.to_owned()));
    for (drive, homing) in [
        ("node: 3", "method: 35"),
        ("node: 3", "method: 1, in_drive: true"),
        (eds, "method: 17"),
        ("node: 3, eds: cia402_sim.eds, probe_2: index", "method: 1"),
    ] {
        assert_eq!(of(drive, homing), Ok("good"), "{drive}: {homing}");
    }
}

/// The machine refuses such a homing too, from the cell alone, because recordings are replayed without the files of the
/// drives.
#[test]
fn machine_knows_the_axes_whose_drives_show_no_inputs() {
    let without = |drive: &str, io: &str| with_keys(drive, "", io).machine.global.without_inputs;
    let x = vec![lineshaft_core::object::Object::Axis(0)];
    assert_eq!(without("node: 3", ""), x);
    assert_eq!(without("node: 3, interface: velocity, drivetype: -2", ""), x);
    assert_eq!(without("node: 3, eds: none.eds", ""), vec![]);
    assert_eq!(without("node: 3", "io:\n  a: {type: di, backend: bus0, node: 3, address: 0}\n"), vec![]);
    assert_eq!(without("node: 3", "io:\n  a: {type: do, backend: bus0, node: 3, address: 0}\n"), x);
    assert_eq!(without("node: 3", "io:\n  a: {type: di, backend: bus0, node: 10, address: 0}\n"), x);
}
