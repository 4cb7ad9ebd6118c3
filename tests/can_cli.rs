//! Tests `lineshaft can` on the command line, with independent CANopen drives.

use crate::support::can::CanDrives;
use rustix::process::{Pid, Signal, kill_process};
use std::io::{BufRead, BufReader, Lines, Read};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdout, Command, Output, Stdio};
use std::time::{Duration, Instant};

/// Much longer than any command takes.
const LONG: Duration = Duration::from_secs(60);

fn program(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_lineshaft"));
    command.arg("can").args(arguments);
    command
}

/// Output and exit code of a command.
struct Said {
    code: i32,
    out: String,
    errors: String,
}

impl From<Output> for Said {
    fn from(output: Output) -> Self {
        let text = |bytes: &[u8]| String::from_utf8(bytes.to_vec()).expect("text");
        let code = output.status.code().expect("it ended by itself");
        Self { code, out: text(&output.stdout), errors: text(&output.stderr) }
    }
}

impl Said {
    /// Checks that it was successful; returns the output.
    #[track_caller]
    fn good(self) -> String {
        assert_eq!((self.code, self.errors.as_str()), (0, ""), "{}", self.out);
        self.out
    }

    /// Checks that it failed with this code and this message, and printed nothing else.
    #[track_caller]
    fn refused(&self, code: i32, sentence: &str) {
        assert_eq!(self.code, code, "{}{}", self.out, self.errors);
        assert!(self.errors.contains(sentence), "`{sentence}` is not in {}", self.errors);
        assert_eq!(self.out, "");
    }
}

/// Runs a command that needs no bus.
fn run(arguments: &[&str]) -> Said {
    program(arguments).output().expect("the program starts").into()
}

/// Runs a command on the bus of the drives.
fn on(drives: &CanDrives, arguments: &[&str]) -> Said {
    run(&[arguments, &["--bus", &drives.address().to_string()]].concat())
}

fn eds() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../launch-configs/can/cia402_sim.eds")
}

/// Writes the EDS as a configuration, with values after the heads of their sections; returns its path.
fn dcf(folder: &Path, values: &[(&str, &str)]) -> String {
    let mut text = std::fs::read_to_string(eds()).expect("the EDS of the drives");
    for (section, value) in values {
        let head = format!("[{section}]\n");
        assert!(text.contains(&head), "the EDS has no {section}");
        text = text.replacen(&head, &format!("{head}ParameterValue={value}\n"), 1);
    }
    let path = folder.join("drive.dcf");
    std::fs::write(&path, text).expect("room in the folder");
    path.to_str().expect("a path of text").to_owned()
}

#[test]
fn scan_lists_devices_and_ends_with_1_on_an_empty_bus() {
    let drives = CanDrives::boot("1-3,64");
    on(&drives, &["sdo", "write", "3", "1017", "20", "--type", "u16"]).good();
    let began = Instant::now();
    let table = on(&drives, &["scan"]).good();
    let took = began.elapsed();
    // 127 nodes one after the other would take a minute.
    assert!(took < Duration::from_secs(20), "{took:?}");
    let rows: Vec<Vec<&str>> = table.lines().map(|line| line.split_whitespace().collect()).collect();
    let row =
        |node, state, serial| vec![node, state, "402", "0000FFFFh", "40200001h", "00010000h", serial, "cia402-sim"];
    assert_eq!(rows[0], ["node", "state", "profile", "vendor", "product", "revision", "serial", "name"]);
    assert_eq!(rows[1], row("1", "-", "00005001h"));
    assert_eq!(rows[3], row("3", "pre-operational", "00005003h"));
    assert_eq!((rows[4].clone(), rows.len()), (row("64", "-", "00005040h"), 5));

    let one = on(&drives, &["scan", "--from", "2", "--to", "2"]).good();
    assert_eq!(one.lines().count(), 2, "{one}");
    let object = |arguments: &[&str]| {
        let said = on(&drives, &[arguments, &["--json"]].concat());
        assert_eq!((said.errors.as_str(), said.out.matches('\n').count()), ("", 1), "{}", said.out);
        let object: serde_json::Value = serde_json::from_str(&said.out).expect("one object");
        (said.code, object)
    };
    let (code, found) = object(&["scan", "--from", "3", "--to", "3"]);
    let node = serde_json::json!({
        "node": 3, "answers": true, "nmt_state": "pre-operational", "device_type": 0x0002_0192, "profile": 402,
        "vendor": 0xFFFF, "product_code": 0x4020_0001, "revision": 0x0001_0000, "serial": 0x5003, "name": "cia402-sim"
    });
    assert_eq!(
        (code, &found["nodes"], &found["command"]),
        (0, &serde_json::json!([node]), &serde_json::json!("can scan"))
    );
    let (code, none) = object(&["scan", "--from", "100", "--to", "127"]);
    assert_eq!((code, &none["nodes"]), (1, &serde_json::json!([])));
    assert_eq!(
        (&none["errors"], &none["exit_code"]),
        (&serde_json::json!(["no node has answered"]), &serde_json::json!(1))
    );
    on(&drives, &["scan", "--from", "100", "--to", "127"]).refused(1, "error: no node has answered\n");
    on(&drives, &["scan", "--from", "5", "--to", "4"]).refused(2, "--from 5 is behind --to 4; 1 to 4 is allowed");
}

/// A stopped node answers no request, but its heartbeat is received.
#[test]
fn a_stopped_node_is_found_by_its_heartbeat() {
    let drives = CanDrives::boot("7");
    on(&drives, &["sdo", "write", "7", "1017", "50", "--type", "u16"]).good();
    on(&drives, &["nmt", "7", "stop"]).good();
    let table = on(&drives, &["scan", "--from", "1", "--to", "10"]).good();
    let row: Vec<_> = table.lines().nth(1).expect("a row").split_whitespace().collect();
    assert_eq!(row, ["7", "stopped", "-", "-", "-", "-", "-", "-", "(no", "answer)"]);
}

#[test]
fn device_identity_is_shown() {
    let mut drives = CanDrives::boot("3");
    drives.tell("fault 3 0x7121");
    on(&drives, &["sdo", "write", "3", "1017", "50", "--type", "u16"]).good();
    let eds = eds();
    let eds = eds.to_str().unwrap();
    let told = on(&drives, &["info", "3", "--eds", eds]).good();
    let has = |name: &str, value: &str| {
        let line = told.lines().find(|line| line.starts_with(&format!("{name}  "))).unwrap_or_else(|| panic!("{told}"));
        assert!(line.ends_with(&format!("  {value}")), "{line}");
    };
    assert!(told.starts_with("node 3\n"), "{told}");
    has("name", "cia402-sim");
    has("hardware", "HW 0.1");
    has("software", "cia402-sim 0.1.0");
    has("device type", "00020192h, profile 402");
    has("serial number", "00005003h");
    has("NMT state", "pre-operational");
    has("error history", "7121h motor blocked");
    has("drive", "fault (6041h is 0218h)");
    has("supported modes", "pp, vl, pv, tq, hm, ip, csp, csv, cst");
    has("mode", "none");
    has("error code", "7121h motor blocked");
    has("position", "0 (6064h, units of the drive)");
    has("digital inputs", "00000004h (home)");
    has("position encoder resolution", "10000 / 1 (608Fh)");
    let said = on(&drives, &["info", "3", "--eds", eds, "--json"]).good();
    let object: serde_json::Value = serde_json::from_str(&said).expect("one object");
    let (device, drive, pdo) = (&object["device"], &object["drive"], &object["pdos"][0]);
    let read =
        |object: &serde_json::Value, field: &str| object[field].as_i64().unwrap_or_else(|| panic!("{field}: {object}"));
    assert_eq!((device["name"].as_str(), device["nmt_state"].as_str()), (Some("cia402-sim"), Some("pre-operational")));
    assert_eq!((read(device, "node"), read(device, "device_type"), read(device, "serial")), (3, 0x0002_0192, 0x5003));
    assert_eq!((read(device, "heartbeat_ms"), device["error_history"][0].as_i64()), (50, Some(0x7121)));
    assert_eq!(
        (drive["state"].as_str(), read(drive, "status_word"), read(drive, "error_code")),
        (Some("fault"), 0x0218, 0x7121)
    );
    assert_eq!((read(drive, "position"), read(drive, "digital_inputs")), (0, 4));
    let factor = drive["factors"].as_array().expect("factors").iter().find(|factor| factor["index"] == 0x608F);
    assert_eq!(factor.map(|factor| &factor["values"]), Some(&serde_json::json!([10_000, 1])));
    assert_eq!((pdo["direction"].as_str(), read(pdo, "number"), read(pdo, "cob_id")), (Some("receive"), 1, 0x203));
    assert_eq!((read(&pdo["mapped"][0], "index"), pdo["mapped"][0]["name"].as_str()), (0x6040, Some("Controlword")));
    let pdos = on(&drives, &["pdo", "3", "--eds", eds]).good();
    assert!(told.ends_with(&pdos), "{told}{pdos}");
    let lines: Vec<Vec<&str>> = pdos.lines().map(|line| line.split_whitespace().collect()).collect();
    assert_eq!(lines[1], ["RPDO", "1", "203h", "yes", "255", "(event)", "6040h:00", "Controlword,", "16", "bits"]);
    assert!(pdos.contains("6064h:00 Position actual value, 32 bits"), "{pdos}");
    on(&drives, &["info", "4"]).refused(1, "error: node 4: 1000h:00: the device has not answered for 500 ms");
    on(&drives, &["pdo", "4", "--timeout", "50 ms"])
        .refused(1, "node 4: 1400h:01: the device has not answered for 50 ms");
}

#[test]
fn objects_are_read_by_number_and_by_name() {
    let mut drives = CanDrives::boot("3");
    drives.tell("move 3 1234");
    let eds = eds();
    let eds = ["--eds", eds.to_str().unwrap()];
    let read = |more: &[&str]| on(&drives, &[&["sdo", "read", "3"], more].concat());
    let zeros = "6085h:00 = 80 84 1E 00 (2000000)\n";
    for object in ["6085", "0x6085", "6085:00", "6085h:0"] {
        assert_eq!(read(&[object]).good(), zeros);
    }
    assert_eq!(read(&["6064", "--type", "i32"]).good(), "6064h:00 = 1234 (INTEGER32)\n");
    let named = [&["position ACTUAL value"], &eds[..]].concat();
    assert_eq!(read(&named).good(), "6064h:00 Position actual value = 1234 (INTEGER32)\n");
    let speed = read(&[&["Homing speeds.Speed during search for switch"], &eds[..]].concat()).good();
    assert_eq!(speed, "6099h:01 Homing speeds.Speed during search for switch = 50000, C350h (UNSIGNED32)\n");
    assert_eq!(read(&["1008"]).good(), "1008h:00 = 63 69 61 34 30 32 2D 73 69 6D (\"cia402-sim\")\n");
    assert_eq!(read(&["1008", "--type", "string"]).good(), "1008h:00 = \"cia402-sim\" (VISIBLE_STRING)\n");

    read(&["5FFF"]).refused(1, "node 3: 5FFFh:00: the device refuses: the object does not exist (06020000h)");
    read(&["1018:9"]).refused(1, "the subindex does not exist (06090011h)");
    read(&["6064", "--type", "i8"])
        .refused(1, "6064h:00: INTEGER8 has 1 bytes, not 4: node 3 has answered D2 04 00 00");
    read(&[&["6064", "--type", "u32"], &eds[..]].concat())
        .refused(2, "6064h:00 Position actual value is INTEGER32 by the EDS, not UNSIGNED32; leave the type out");
    read(&[&["Position actual valeu"], &eds[..]].concat())
        .refused(2, "no object has the name \"Position actual valeu\"; \"Position actual value\" is like it");
    read(&["Statusword"])
        .refused(2, "\"Statusword\" is no object; allowed are an index like 6064 or 0x6064 (1000 to FFFF)");
    on(&drives, &["sdo", "read", "9", "6064", "--timeout", "0.1"])
        .refused(1, "node 9: 6064h:00: the device has not answered for 100 ms");
}

#[test]
fn objects_are_written_where_they_may_be() {
    let mut drives = CanDrives::boot("3");
    let eds = eds();
    let eds = ["--eds", eds.to_str().unwrap()];
    let write = |drives: &CanDrives, more: &[&str]| on(drives, &[&["sdo", "write", "3"], more].concat());
    assert_eq!(write(&drives, &["607A", "-5", "--type", "i32"]).good(), "607Ah:00 is -5 now\n");
    assert_eq!(drives.tell("get 3 0x607A 0")["value"], -5);
    let said = write(&drives, &[&["Profile velocity", "0x4E20"], &eds[..]].concat()).good();
    assert_eq!(said, "6081h:00 Profile velocity is 0x4E20 now\n");
    assert_eq!(drives.tell("get 3 0x6081 0")["value"], 20_000);

    let before = drives.tell("stats")["rx"].as_u64();
    write(&drives, &["6081", "1"]).refused(2, "the type of 6081h:00 is not known: give it (bool, u8, u16, u32, ");
    write(&drives, &[&["Statusword", "1"], &eds[..]].concat())
        .refused(2, "6041h:00 Statusword cannot be written: its access is ro by the EDS");
    write(&drives, &[&["6060", "200"], &eds[..]].concat())
        .refused(2, "6060h:00 Modes of operation: 200 is not within -128 and 127, as INTEGER8 is");
    write(&drives, &["6060", "010", "--type", "i8"]).refused(2, "begins with 0: write a decimal number without it");
    assert_eq!(drives.tell("stats")["rx"].as_u64(), before, "nothing was sent");

    write(&drives, &["6041", "1", "--type", "u16"])
        .refused(1, "node 3: 6041h:00: the device refuses: the object can only be read (06010002h)");
    drives.tell("sdo_abort 3 0x6081 0 0x06090031");
    write(&drives, &["6081", "1", "--type", "u32"]).refused(1, "the value is too high (06090031h)");
}

/// In blocks, and with a drive without block transfer.
#[test]
fn files_are_brought_into_domains_and_back() {
    let mut drives = CanDrives::boot("3");
    let folder = tempfile::tempdir().unwrap();
    let (there, back) = (folder.path().join("there"), folder.path().join("back"));
    for (knows_blocks, length) in [(1, 20_000_usize), (0, 3_000)] {
        drives.tell(&format!("sdo_block 3 {knows_blocks}"));
        let bytes: Vec<u8> = (0..length).map(|at| (at * 7 + at / 256) as u8).collect();
        std::fs::write(&there, &bytes).unwrap();
        let said = on(&drives, &["sdo", "write", "3", "2100", "--file", there.to_str().unwrap()]).good();
        assert!(said.starts_with(&format!("2100h:00 is {length} bytes of ")), "{said}");
        let said = on(&drives, &["sdo", "read", "3", "2100", "--file", back.to_str().unwrap()]).good();
        assert!(said.starts_with(&format!("2100h:00: {length} bytes to ")), "{said}");
        assert!(std::fs::read(&back).unwrap() == bytes);
    }
    let none = folder.path().join("none");
    on(&drives, &["sdo", "write", "3", "2100", "--file", none.to_str().unwrap()]).refused(2, "cannot be read: ");
    let none = folder.path().join("no/where");
    on(&drives, &["sdo", "read", "3", "2100", "--file", none.to_str().unwrap()]).refused(2, "cannot be written: ");
}

#[test]
fn states_are_changed_and_a_reset_is_waited_for() {
    let mut drives = CanDrives::boot("1-2");
    assert_eq!(on(&drives, &["nmt", "2", "start"]).good(), "node 2: start is sent\n");
    let state = |drives: &mut CanDrives, node: u8| drives.tell(&format!("state {node}"))["nmt"].to_string();
    let (one, two) = (state(&mut drives, 1), state(&mut drives, 2));
    assert_ne!(one, two, "only node 2 was started");
    assert_eq!(on(&drives, &["nmt", "all", "start"]).good(), "all nodes: start is sent\n");
    assert_eq!(state(&mut drives, 1), two);
    assert_eq!(on(&drives, &["nmt", "all", "pre-operational"]).good(), "all nodes: pre-operational is sent\n");
    assert_eq!(state(&mut drives, 2), one);
    for command in ["reset-node", "reset-communication"] {
        let said = on(&drives, &["nmt", "2", command]).good();
        assert!(said.starts_with(&format!("node 2: {command} is sent\nnode 2: it has booted after ")), "{said}");
    }
    let said = on(&drives, &["nmt", "9", "reset-node"]);
    assert_eq!((said.code, said.out.as_str()), (1, "node 9: reset-node is sent\n"));
    assert_eq!(said.errors, "error: node 9: no boot-up message has come within 1 s\n");
}

/// A running monitor, killed with the test.
struct Monitor {
    child: Child,
    /// `None` after the reader was closed.
    lines: Option<Lines<BufReader<ChildStdout>>>,
}

impl Monitor {
    fn start(arguments: &[&str]) -> Self {
        let mut command = program(&[&["monitor"], arguments].concat());
        let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the program starts");
        let lines = BufReader::new(child.stdout.take().expect("it is piped")).lines();
        Self { child, lines: Some(lines) }
    }

    /// Returns the next line that ends with these words.
    #[track_caller]
    fn line(&mut self, words: &str) -> String {
        let all = self.lines.iter_mut().flatten().map(|line| line.expect("text"));
        let found = all.take(10_000).find(|line| line.ends_with(words));
        found.unwrap_or_else(|| panic!("no line ends with `{words}`"))
    }

    /// Ends it with the signal of Ctrl-C; returns its remaining output.
    fn interrupt(mut self) -> Vec<String> {
        kill_process(Pid::from_child(&self.child), Signal::INT).expect("it runs");
        let rest = self.lines.iter_mut().flatten().map(|line| line.expect("text")).collect();
        self.ends_well();
        rest
    }

    /// Checks that it ends by itself, with code 0 and without an error message.
    fn ends_well(&mut self) {
        let began = Instant::now();
        while self.child.try_wait().expect("a child of ours").is_none() {
            assert!(began.elapsed() < LONG, "it still runs");
            std::thread::sleep(Duration::from_millis(5));
        }
        let mut errors = String::new();
        self.child.stderr.take().expect("it is piped").read_to_string(&mut errors).expect("text");
        assert_eq!((self.child.wait().expect("a child of ours").code(), errors), (Some(0), String::new()));
    }
}

impl Drop for Monitor {
    fn drop(&mut self) {
        // Both fail if it has ended, which is fine.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

#[test]
fn frames_are_shown_until_ctrl_c_or_a_closed_pipe() {
    let mut drives = CanDrives::boot("3-4");
    for node in ["3", "4"] {
        on(&drives, &["sdo", "write", node, "1017", "10", "--type", "u16"]).good();
    }
    on(&drives, &["nmt", "all", "start"]).good();
    let eds = eds();
    let bus = drives.address().to_string();
    let mut monitor = Monitor::start(&["--bus", &bus, "--node", "3", "--eds", eds.to_str().unwrap()]);
    let first = monitor.line("node 3 is operational");
    let columns: Vec<_> = first.split_whitespace().take(3).collect();
    let (seconds, digits) = columns[0].split_once('.').expect("a fraction");
    assert!(seconds.parse::<u32>().is_ok() && digits.len() == 6, "{first}");
    assert_eq!(columns[1..], ["703", "05"]);
    drives.tell("emcy 4 0x2310 0x03");
    drives.tell("emcy 3 0x8611 0x21 0102030405");
    let emergency = monitor.line("01 02 03 04 05");
    let words =
        "083  11 86 21 01 02 03 04 05  EMCY of node 3: 8611h following error, error register 21h (generic, profile), ";
    assert!(emergency.contains(words), "{emergency}");
    drives.tell("move 3 -77");
    let told = monitor.line("6064h:00 Position actual value -77");
    assert!(told.contains("TPDO 3 of node 3: 6041h:00 Statusword 0250h (switch on disabled), "), "{told}");
    let rest = monitor.interrupt();
    assert!(rest.iter().all(|line| !line.contains("node 4") && line.len() > 40), "{rest:?}");

    // A reader that reads only the first line, like `head -1`.
    let mut monitor = Monitor::start(&["--bus", &bus]);
    monitor.line("");
    monitor.lines = None;
    monitor.ends_well();

    let all = on(&drives, &["monitor", "--for", "300 ms"]).good();
    assert!(all.contains("node 3 is operational") && all.contains("node 4 is operational"), "{all}");
}

#[test]
fn a_configuration_is_brought_in_where_it_differs() {
    let mut drives = CanDrives::boot("3");
    let folder = tempfile::tempdir().unwrap();
    let values = [
        ("6081", "30000"),
        ("6083", "500000"),
        ("1003sub0", "0"),
        ("1011sub1", "0x64616F6C"),
        ("6040", "15"),
        ("607A", "12345"),
        ("60FEsub1", "0x10000"),
        ("60FF", "777"),
        ("1800sub1", "$NODEID+0x180"),
        ("1800sub2", "1"),
        ("1A00sub0", "2"),
        ("1A00sub1", "0x60640020"),
        ("1A00sub2", "0x60410010"),
    ];
    let file = dcf(folder.path(), &values);
    let configure =
        |drives: &CanDrives, more: &[&str]| on(drives, &[&["configure", "3", "--dcf", &file], more].concat());
    let said = configure(&drives, &["--store"]).good();
    let expected = "node 3: 5 of 7 objects differed and were written: 6081h:00, 1800h:02, 1A00h:00, 1A00h:01, 1A00h:02\n\
                    node 3: left out, as objects that act: 1003h:00, 1011h:01, 6040h:00; as setpoints: 607Ah:00, 60FEh:01, 60FFh:00\n\
                    node 3: it has stored them\n";
    assert_eq!(said, expected);
    assert_eq!(drives.tell("get 3 0x6081 0")["value"], 30_000);
    assert_eq!(drives.tell("get 3 0x1A00 2")["value"], 0x6041_0010);
    assert_eq!(drives.tell("get 3 0x6040 0")["value"], 0);
    assert_ne!(drives.tell("get 3 0x607A 0")["value"], 12_345);
    assert_eq!(drives.tell("get 3 0x60FE 1")["value"], 0);
    assert_eq!(drives.tell("get 3 0x60FF 0")["value"], 0);
    let pdos = on(&drives, &["pdo", "3"]).good();
    assert!(pdos.contains("TPDO 1  183h    yes    1 (each sync)  6064h:00, 32 bits\n"), "{pdos}");
    assert!(configure(&drives, &[]).good().starts_with("node 3: 0 of 7 objects differed and were written\n"));

    drives.tell("sdo_abort 3 0x1010 1 0x08000020");
    let said = configure(&drives, &["--store"]);
    assert_eq!(said.code, 1);
    assert_eq!(said.errors, "error: node 3: 1010h:01: the device refuses: the data cannot be stored (08000020h)\n");

    let said = on(&drives, &["configure", "3", "--dcf", eds().to_str().unwrap()]);
    said.refused(2, "configures nothing: no object that can be written has a ParameterValue");
    for word in ["6", "7", "15"] {
        on(&drives, &["sdo", "write", "3", "6040", word, "--type", "u16"]).good();
    }
    configure(&drives, &[]).refused(1, "node 3 is operation enabled (6041h is 0237h); switch it off first");
    on(&drives, &["configure", "4", "--dcf", &file]).refused(1, "node 4: 1018h:01: the device has not answered");

    let other = std::fs::read_to_string(&file).unwrap().replacen("VendorNumber=", "VendorNumber=0x22 ;", 1);
    std::fs::write(&file, other).unwrap();
    configure(&drives, &[])
        .refused(1, "node 3 is another device: its vendor (1018h:01) is 0000FFFFh, the file is for 00000022h");
}

/// The line of `check` for a device whose DCF was written by a tool of its manufacturer.
#[test]
fn check_names_what_is_left_out_of_a_configuration() {
    let folder = tempfile::tempdir().unwrap();
    dcf(folder.path(), &[("1010sub1", "0x65766173"), ("6081", "30000"), ("607A", "5"), ("60FF", "7")]);
    let cell = "lineshaft: 1\ncycle: 10 ms\nbackends:\n  \
         bus0: {type: can, transport: 'socketcan:can0', bitrate: 1000000}\naxes:\n  \
         x: {type: linear, drive: {backend: bus0, node: 3, interface: position, eds: drive.dcf}, scale: {increments: 1000, \
         per: 1 mm}, max_velocity: 1 m/s, max_acceleration: 1 m/s^2}\n";
    let path = folder.path().join("cell.yaml");
    std::fs::write(&path, cell).unwrap();
    let mut check = Command::new(env!("CARGO_BIN_EXE_lineshaft"));
    let said = Said::from(check.arg("check").arg(&path).output().expect("the program starts"));
    assert_eq!(said.code, 0, "{}", said.errors);
    let line = "backend bus0: node 3 (x): left out of its DCF, as objects that act: 1010h:01; as setpoints: 607Ah:00, 60FFh:00\n";
    assert_eq!(said.out.matches(line).count(), 1, "{}", said.out);
}

/// Transport, bit rate, timeout and names come from the cell.
#[test]
fn bus_options_are_taken_from_the_cell() {
    let mut drives = CanDrives::boot("3");
    let folder = tempfile::tempdir().unwrap();
    std::fs::copy(eds(), folder.path().join("drive.eds")).unwrap();
    let address = drives.address().to_string();
    let cell = format!(
        "lineshaft: 1\ncycle: 10 ms\nbackends:\n  \
         bus0: {{type: can, transport: '{address}', bitrate: 1000000, sdo_timeout: 200 ms}}\n  \
         bus1: {{type: can, transport: 'slcan-tcp:127.0.0.1:1', bitrate: 500000}}\naxes:\n  \
         x: {{type: linear, drive: {{backend: bus0, node: 3, interface: position, eds: drive.eds}}, scale: {{increments: 1000, \
         per: 1 mm}}, max_velocity: 1 m/s, max_acceleration: 1 m/s^2}}\n"
    );
    let path = folder.path().join("cell.yaml");
    std::fs::write(&path, cell).unwrap();
    let path = path.to_str().unwrap();
    let by = |more: &[&str]| run(&[more, &["--cell", path]].concat());
    let read = by(&["sdo", "read", "3", "Profile velocity", "--backend", "bus0"]).good();
    assert_eq!(read, "6081h:00 Profile velocity = 100000, 186A0h (UNSIGNED32)\n");
    by(&["sdo", "read", "4", "6064", "--backend", "bus0"]).refused(1, "has not answered for 200 ms");
    by(&["scan"]).refused(2, "cell.yaml has several backends on CAN; name one by --backend: bus0, bus1");
    by(&["scan", "--backend", "bus2"]).refused(2, "has no backend \"bus2\" on CAN; bus0, bus1 is allowed");
    by(&["scan", "--backend", "bus1"]).refused(1, "slcan-tcp:127.0.0.1:1 cannot be opened: ");
    // The master maps three objects into TPDO 1, the EDS has one.
    let values =
        [("1A00sub0", "3"), ("1A00sub1", "0x60410010"), ("1A00sub2", "0x60640020"), ("1A00sub3", "0x60610008")];
    let file = dcf(folder.path(), &values);
    by(&["configure", "3", "--dcf", &file, "--backend", "bus0"]).good();
    by(&["sdo", "write", "3", "Producer heartbeat time", "10", "--backend", "bus0"]).good();
    by(&["nmt", "3", "start", "--backend", "bus0"]).good();
    let mut monitor = Monitor::start(&["--cell", path, "--backend", "bus0"]);
    monitor.line("node 3 is operational");
    drives.tell("move 3 -77");
    let words = "6064h:00 Position actual value -77, 6061h:00 Modes of operation display 0";
    let told = monitor.line(words);
    assert!(told.contains("TPDO 1 of node 3: 6041h:00 Statusword 0250h (switch on disabled), "), "{told}");
    monitor.interrupt();
    std::fs::remove_file(folder.path().join("drive.eds")).unwrap();
    by(&["scan", "--backend", "bus0"]).refused(2, "/drive.eds` cannot be read: ");
}

/// These drives have no LSS, so there is no answer; the tests of the protocol cover answers.
#[test]
fn devices_without_lss_do_not_answer_it() {
    let drives = CanDrives::boot("3");
    on(&drives, &["lss", "scan"]).refused(1, "error: no device without a node id has answered\n");
    let identity = ["--vendor", "0x22", "--product", "1", "--revision", "2", "--serial", "3"];
    let sentence = "no device answers to vendor 00000022h, product 00000001h, revision 00000002h, serial 00000003h";
    for words in [&["lss", "set-id", "5"][..], &["lss", "bit-rate", "500000"], &["lss", "store"]] {
        on(&drives, &[words, &identity].concat()).refused(1, sentence);
    }
}

/// A device of another make without a node ID is found by its identity, gets one, and answers with it; it keeps the ID,
/// and cannot change its bit rate.
#[test]
fn a_device_without_a_node_id_gets_one() {
    let device = CanDrives::boot_device(NO_NODE);
    let found = on(&device, &["lss", "scan"]).good();
    assert_eq!(found, "--vendor 0x0000FFFF --product 0x40200001 --revision 0x00010001 --serial 0x8000000B\n");
    let identity: Vec<&str> = found.split_whitespace().collect();
    let other = [&identity[..7], &["12"]].concat();
    on(&device, &[&["lss", "set-id", "5"][..], &other].concat()).refused(1, "no device answers to vendor 0000FFFFh");
    on(&device, &["scan", "--from", "5", "--to", "5"]).refused(1, "error: no node has answered\n");
    on(&device, &[&["lss", "set-id", "5"][..], &identity].concat()).good();
    let table = on(&device, &["scan", "--from", "4", "--to", "6"]).good();
    let row: Vec<_> = table.lines().nth(1).expect("a row").split_whitespace().collect();
    assert_eq!((row[0], &row[6..], table.lines().count()), ("5", &["8000000Bh", "durand", "device"][..], 2), "{table}");
    on(&device, &["lss", "scan"]).refused(1, "error: no device without a node id has answered\n");
    on(&device, &[&["lss", "store"][..], &identity].concat()).good();
    on(&device, &[&["lss", "bit-rate", "500000"][..], &identity].concat())
        .refused(1, "the device does not know this bit rate");
}

/// Value of an unconfigured node ID (CiA 305).
const NO_NODE: u8 = 255;

#[test]
fn invalid_arguments_are_refused_before_a_bus_is_opened() {
    run(&["scna"]).refused(2, "a similar subcommand exists: 'scan'");
    run(&["scan"]).refused(2, "--bus <ADDRESS>");
    run(&["scan", "--bus", "can0"])
        .refused(2, "'can0' is no CAN bus; allowed are slcan:/dev/ttyACM0, slcan-tcp:HOST:PORT");
    run(&["scan", "--bus", "slcan-tcp:host:0"]).refused(2, "allowed is slcan-tcp:HOST:PORT with a port of 1 to 65535");
    run(&["scan", "--bus", "socketcan:can0", "--bitrate", "2000000"])
        .refused(2, "\"2000000\" is no bit rate; 10000 to 1000000 bit/s is allowed");
    run(&["scan", "--bus", "slcan:/dev/ttyACM99", "--bitrate", "83300"])
        .refused(2, "adapters do not know the bit rate 83300 bit/s; they know 10000, 20000, ");
    run(&["scan", "--bus", "slcan-tcp:127.0.0.1:1", "--serial-baudrate", "921600"])
        .refused(2, "--serial-baudrate is for a serial line, --bus slcan:PATH, not for slcan-tcp:127.0.0.1:1");
    run(&["scan", "--bus", "slcan:/dev/ttyACM99"]).refused(1, "there is no such device; plug the adapter in");
    run(&["scan", "--bus", "slcan-tcp:127.0.0.1:1"]).refused(1, "the adapter cannot be reached: Connection refused");
    run(&["info", "0", "--bus", "socketcan:can0"]).refused(2, "\"0\" is no node; 1 to 127 is allowed");
    run(&["nmt", "3", "rest-node", "--bus", "socketcan:can0"]).refused(2, "a similar value exists: 'reset-node'");
    run(&["sdo", "read", "3", "6064", "--bus", "socketcan:can0", "--eds", "none.eds"])
        .refused(2, "--eds `none.eds` cannot be read: ");
    run(&["scan", "--cell", "none.yaml"]).refused(2, "none.yaml");
    let folder = tempfile::tempdir().unwrap();
    let configure = |values: &[(&str, &str)]| {
        let file = dcf(folder.path(), values);
        run(&["configure", "3", "--dcf", &file, "--bus", "slcan-tcp:127.0.0.1:1"])
    };
    configure(&[("6081", "-1"), ("6083", "5")])
        .refused(2, "[6081] ParameterValue=-1: -1 is not within 0 and 4294967295, as UNSIGNED32 is");
    // A value that is never written is no error: the bus is opened.
    let said = configure(&[("6041", "x"), ("6083", "5")]);
    said.refused(1, "the adapter cannot be reached: Connection refused");
    said.refused(1, "warning: --dcf `");
    said.refused(
        1,
        "[6041] ParameterValue=x: \"x\" is no number: decimal (12), hexadecimal (0x0C) or octal (014); passed over\n",
    );
    run(&["scan", "--bus", "socketcan:can0", "--timeout", "1 ms"]).refused(2, "1 ms is not allowed; 10 ms to 60 s is");
}
