//! Tests that explanations have the texts of the tables, and that everything in the tables can be explained.

use super::explain;
use crate::cell::Cell;
use crate::scenario::VERBS;
use lineshaft_core::code::Code;
use lineshaft_core::function::TYPES;
use lineshaft_core::parameter::{ROWS as PARAMETERS, Word};
use lineshaft_core::signal::sysvar::{Address, SYSTEM_VARIABLES};
use lineshaft_msgs::INTERFACES;
use lineshaft_ros::surface::table::{PARAMETERS as ROS_PARAMETERS, ROWS as ENDPOINTS};
use std::path::Path;

/// Returns an explanation without wrapped lines.
fn said(name: &str) -> String {
    explain(name, 10_000).unwrap_or_else(|sentence| panic!("{sentence}"))
}

#[track_caller]
fn has(name: &str, lines: &[&str]) {
    let text = said(name);
    for line in lines {
        assert!(text.lines().any(|known| known == *line), "{line:?} is missing in\n{text}");
    }
}

#[test]
fn a_code_is_explained_by_number_and_by_name() {
    let lines = [
        "code 10205 ENABLE_TIMEOUT: an error of an axis",
        "  message       the drive was not enabled in time",
        "  reaction      drive off",
        "  source        Lineshaft: failed",
        "  documented    docs/errors.md",
    ];
    for name in ["10205", "E10205", "e10205", "code 10205", " 10205 ", "0x27DD", "ENABLE_TIMEOUT", "enable_timeout"] {
        has(name, &lines);
    }
    has("10201", &["  message       following error <asked> exceeds max_following_error <limit>"]);
    has("10201", &["  reaction      as error_reaction says; with following_error_stops_all all axes"]);
    has("6", &["code 6 HOMING_REQUIRED: a refusal, the end of a goal, a warning or a notice", "  source        MACS"]);
    has(
        "0x18611",
        &["code 99857 DRIVE_FAULT: an error of an axis", "  object        603Fh is 8611h", "  source        Drives"],
    );
    has("131071", &["  object        603Fh is FFFFh"]);
    // Format of drive manuals: object 603Fh, with the text of CiA 402.
    for name in ["8611h", "0x8611", "0X8611", "8611H"] {
        has(
            name,
            &[
                "code 99857 DRIVE_FAULT: an error of an axis",
                "  object        603Fh is 8611h",
                "  CiA 402       following error",
            ],
        );
    }
    has("2310h", &["  CiA 402       over-current at the output"]);
    // An own code with that number is first; `each` and `beach` are no numbers.
    has("0x27DD", &["code 10205 ENABLE_TIMEOUT: an error of an axis"]);
    assert!(["each", "beach", "0000h", "18611h", "0xA00"].iter().all(|name| explain(name, 80).is_err()));
    has("0", &["code 0 NONE: no error"]);
    for none in ["777", "131072", "+10205", "-1", "E", "0x", "4294967296"] {
        assert!(explain(none, 80).is_err(), "{none}");
    }
}

#[test]
fn object_of_a_drive_is_explained_by_index_and_by_name() {
    let lines = ["60FDh: an object of CiA 402", "  name          Digital inputs", "  documented    docs/can.md"];
    for name in ["60FDh", "0x60FD", "60FD", "60fdh:00", "Digital inputs", "digital inputs"] {
        has(name, &lines);
        assert!(!said(name).contains("DRIVE_FAULT"), "{}", said(name));
    }
    has("6060h", &["6060h: an object of CiA 402", "  name          Modes of operation"]);
    has("603Fh", &["603Fh: an object of CiA 402", "  name          Error code"]);
    has("6200h", &["6200h: an object of CiA 401", "  CiA 402       device software"]);
    has("1A02h", &["1A02h: an object of CiA 301", "  name          TPDO mapping parameter"]);
    // Both an object and an error code.
    has("1018h", &["1018h: an object of CiA 301", "code 69656 DRIVE_FAULT: an error of an axis"]);
    has("6320h", &["6320h: an object of a device profile", "  CiA 402       parameter error"]);
    // As a code it is still that of a fault.
    has("0x160FD", &["code 90365 DRIVE_FAULT: an error of an axis", "  object        603Fh is 60FDh"]);
}

#[test]
fn a_parameter_is_explained_with_its_range_and_requirement() {
    let lines = [
        "syncready: a parameter",
        "  source        MACS SYNCREADY, no. 56",
        "  range         0 to 10000",
        "  default       1",
        "  requirements  MACS-MARK-20",
        "  documented    docs/parameters.md",
    ];
    for name in ["syncready", "SYNCREADY", "x.syncready"] {
        has(name, &lines);
    }
    has("x.homing.velocity", &["homing.velocity: a parameter"]);
    has("MD18", &["MD18: a word of Siemens WF 725", "  here          MD18 of Siemens WF 725 is modulo"]);
    has("x.md1", &["MD1: a word of Siemens WF 725", "wf.md1: a parameter"]);
}

#[test]
fn keys_of_contacts_warn_that_they_are_no_safety_function() {
    for name in ["safety", "safety.estop", "estop", "safety.interlock", "interlock"] {
        let text = said(name);
        assert!(text.contains("No safety function: wire the contact to STO as well."), "{name}: {text}");
    }
}

#[test]
fn key_modulo_says_that_positions_are_unwrapped() {
    assert!(said("modulo").contains("Shown positions are unwrapped"), "{}", said("modulo"));
}

#[test]
fn a_signal_is_explained_by_its_name_in_any_cell() {
    let lines = [
        "AXIS.actual.position: a signal of an axis",
        "  what          actual position",
        "  type          whole number",
        "  unit          inc",
    ];
    for name in ["x.actual.position", "actual.position", "*.actual.position", "AXIS.actual.position"] {
        has(name, &lines);
    }
    has("x.actual.count", &["  scenarios     section drive of a scenario may replace it"]);
    has("portal.skew", &["AXIS.skew: a signal of an axis with two drives"]);
    has("belt.count", &["ENCODER.count: a signal of an entry of encoders"]);
    has("store.valid", &["MASTER.valid: a signal of an entry of masters"]);
    has("wind.limit.ratio_max", &["FUNCTION.limit.ratio_max: a signal of a function slot of type dfkt"]);
    has("machine.state", &["machine.state: a signal of the machine", "  values        0 INACTIVE, 1 ACTIVE, 2 ERROR"]);
    // `machine` names one object, any other name any object.
    assert!(!said("machine.state").contains("AXIS.state") && !said("x.state").contains("machine.state"));
    assert!(said("state").contains("AXIS.state: ") && said("state").contains("machine.state: "));
    has(
        "INACTIVE",
        &["INACTIVE: a value of a signal", "  what          value 0 of machine.state, state of the machine"],
    );
    let variable = ["PFG_COMMANDPOS: a system variable of MACS", "  here          signal AXIS.command.position"];
    has("PFG_COMMANDPOS", &variable);
    has("SYSVAR 4311", &variable);
}

#[test]
fn a_function_type_and_its_field_are_explained() {
    has("varsync", &["  documented    docs/functions.md#varsync"]);
    assert!(said("VARSYNC").starts_with("function type varsync: "));
    let lines = [
        "m1: a field of function type varsync",
        "  range         -32768 to 32767",
        "  unit          0.0001",
        "  default       0",
        "  effective     from START on",
        "  requirement   AMK-VARSYNC-04",
    ];
    for name in ["varsync.m1", "m1", "ratio.m1"] {
        has(name, &lines);
    }
    has("binea.mode[3]", &["mode: a field of function type binea", "  values        8, [0] to [7]"]);
    has("override_addr", &["override_addr: a key of function type fgen"]);
    // A field that several types have is explained for each of them.
    let modes = said("mode");
    assert!(modes.contains("function type varsync\n") && modes.contains("function type binea\n"), "{modes}");
    assert!(!said("varsync.mode").contains("function type binea\n"));
}

#[test]
fn a_verb_is_explained_together_with_the_action_of_its_name() {
    let lines = [
        "move_axis: a verb of scenarios",
        "  what          a command in do of a step: do: {move_axis: {..}}",
        "  in ROS        action ~/move_axis, type lineshaft_msgs/action/MoveAxis",
        "  documented    docs/contract.md, section 5",
        "Goal",
        "  documented    docs/interfaces.md",
    ];
    has("move_axis", &lines);
    assert!(!said("inject").contains("  in ROS"));
}

#[test]
fn a_ros_interface_is_explained_with_what_uses_its_type() {
    has("~/enable", &["Request", "  documented    docs/interfaces.md"]);
    has(
        "JointState",
        &[
            "sensor_msgs/msg/JointState: a type of ROS interfaces",
            "  used by       joint_states",
            "  fields        ros2 interface show sensor_msgs/msg/JointState",
        ],
    );
    has("lineshaft_msgs/MoveAxis", &["  used by       ~/move_axis"]);
    has("angle_wraparound", &["angle_wraparound: a ROS parameter of the node", "  type          bool"]);
}

#[test]
fn field_of_a_ros_interface_is_explained_with_its_type() {
    let lines = [
        "buffer_mode: a field of ROS interfaces",
        "  what          How it joins the running motion: ABORTING.. BLENDING_HIGH.",
        "  type          uint8",
        "  in            MoveAxis (goal)",
        "  documented    docs/interfaces.md; lineshaft interfaces MoveAxis lists all fields and constants",
    ];
    for name in [
        "buffer_mode",
        "MoveAxis.buffer_mode",
        "moveaxis.buffer_mode",
        "MoveAxis.Goal.buffer_mode",
        "lineshaft_msgs/MoveAxis.buffer_mode",
        "lineshaft_msgs/action/MoveAxis.buffer_mode",
        "move_axis.buffer_mode",
        "~/move_axis.buffer_mode",
    ] {
        has(name, &lines);
    }
    for (of, field) in [
        ("Synchronize", "engage"),
        ("MoveAxis", "direction"),
        ("Synchronize", "master_increments"),
        ("AxisState", "error_code"),
        ("gear_out", "disengage"),
    ] {
        let line = format!("{field}: a field of ROS interfaces");
        has(field, &[line.as_str()]);
        has(&format!("{of}.{field}"), &[line.as_str()]);
    }
    // A field of another type, or of an axis, is none.
    assert!(explain("MoveAxis.engage", 80).is_err() && explain("x.buffer_mode", 80).is_err());
    let sentence = explain("MoveAxis.bufer_mode", 80).unwrap_err();
    assert!(sentence.contains("`MoveAxis.buffer_mode`"), "{sentence}");
}

#[test]
fn every_field_of_a_ros_interface_can_be_explained() {
    let plain = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ").replace('`', "");
    for interface in INTERFACES {
        for field in interface.sections.iter().flat_map(|part| part.fields) {
            let text = said(&format!("{}.{}", interface.name, field.name));
            assert!(text.contains(&format!("{}: a field of ROS interfaces\n", field.name)), "{text}");
            assert!(text.contains(&plain(field.doc)) && text.contains(field.kind), "{text}");
        }
    }
}

#[test]
fn terms_and_outputs_of_plcopen_are_explained() {
    has("AXIS_REF", &["AXIS_REF: a term of PLCs", "  here          name of the axis in the cell, such as x"]);
    has("BufferMode", &["BufferMode: a state, an input or an output of PLCopen"]);
    has("InVelocity", &["  here          in_velocity in ~/axis_states, signal x.in_velocity"]);
    for name in ["InGear", "InSync", "Active", "Busy"] {
        has(name, &[format!("{name}: a state, an input or an output of PLCopen").as_str()]);
    }
    for name in ["MC_HomeDirect", "MC_StepLimitSwitch", "MC_StepAbsoluteSwitch", "MC_FinishHoming"] {
        has(name, &[format!("{name}: a function block of PLCopen (Part 5, homing)").as_str()]);
    }
}

#[test]
fn a_function_block_of_plcopen_is_explained_with_request_verb_and_command() {
    for name in ["MC_MoveAbsolute", "mc_moveabsolute", "MoveAbsolute"] {
        has(
            name,
            &[
                "MC_MoveAbsolute: a function block of PLCopen (Part 1, motion)",
                "  here          ~/move_axis, field mode",
                "  verb          move_axis",
                "  command       lineshaft move, with --relative",
                "  documented    docs/from-plc.md",
            ],
        );
    }
    for name in [
        "MC_GearIn",
        "MC_Home",
        "MC_Stop",
        "MC_Halt",
        "MC_CamIn",
        "MC_TouchProbe",
        "MC_SetPosition",
        "MC_Reset",
        "MC_Power",
        "MC_ReadStatus",
    ] {
        assert!(said(name).contains(&format!("{name}: a function block of PLCopen")), "{name}");
    }
    has("MC_PhasingAbsolute", &["  here          no equivalent: a phase shift is relative"]);
    for name in ["MC_GearOut", "MC_CamOut"] {
        assert!(said(name).contains("The behaviour of PLCopen is disengage: keep_velocity"), "{}", said(name));
    }
    let sentence = explain("MC_MoveAbsolut", 80).unwrap_err();
    assert!(sentence.starts_with("`MC_MoveAbsolut` is unknown; did you mean `MC_MoveAbsolute`"), "{sentence}");
}

#[test]
fn a_command_is_explained_with_its_verb() {
    let lines = [
        "move: a command to a node that runs",
        "  in ROS        ~/move_axis",
        "  verb          move_axis",
        "move_axis: a verb of scenarios",
    ];
    has("move", &lines);
    has("home", &["home_axis: a verb of scenarios"]);
    assert_eq!(said("enable").matches("enable: a verb of scenarios\n").count(), 1);
}

#[test]
fn a_value_is_explained_by_its_name() {
    has(
        "DISCRETE_MOTION",
        &["DISCRETE_MOTION: a value of a signal", "DISCRETE_MOTION: a constant of lineshaft_msgs/AxisState"],
    );
    has("ERROR_STOP", &["ERROR_STOP: a constant of lineshaft_msgs/AxisState", "  value         7"]);
    has("at_position", &["AT_POSITION: a constant of lineshaft_msgs/Synchronize", "  value         1"]);
    has("second_order", &["second_order: a value that keys take"]);
    assert!(said("second_order").contains("axes.*.sim.model of a cell"), "{}", said("second_order"));
    assert!(said("trapezoid").contains("  parameters    profile\n"), "{}", said("trapezoid"));
    for name in ["cyclic_position", "csp", "Cyclic Synchronous Position"] {
        has(name, &["csp: a mode of operation of CiA 402", "  here          drive: {interface: position}"]);
    }
    let sentence = explain("DISCRET_MOTION", 80).unwrap_err();
    assert!(sentence.contains("`DISCRETE_MOTION`"), "{sentence}");
}

#[test]
fn an_unknown_name_gets_the_names_that_are_most_like_it() {
    let sentence = |name: &str| explain(name, 80).unwrap_err();
    assert!(sentence("max_velocty").starts_with("`max_velocty` is unknown; did you mean `max_velocity`"));
    assert!(sentence("ENABLE_TIMEOUTS").contains("`ENABLE_TIMEOUT`"));
    assert!(
        sentence("x.actual.postion").contains("did you mean")
            && sentence("x.actual.postion").contains("actual.position`")
    );
    assert!(sentence("varsinc").contains("`varsync`") && sentence("move_axes").contains("`move_axis`"));
    assert_eq!(
        sentence("zzzzzzzz"),
        "`zzzzzzzz` is unknown; a code, an object of CANopen, a parameter, a key, a signal, a value, a type of functions or its field, a \
         verb, a command, a ROS interface or its field, a function block or a term of PLCopen is expected"
    );
    let long = "m".repeat(100_000);
    assert!(sentence(&long).len() < 300 && sentence("").starts_with("`` is unknown"));
}

/// Every entry of the tables has an explanation, which contains its texts.
#[test]
fn every_code_and_parameter_can_be_explained() {
    for row in Code::rows() {
        let plain = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ").replace('`', "");
        for name in [row.code.0.to_string(), format!("E{}", row.code.0), row.name.to_owned()] {
            let text = said(&name);
            assert!(text.contains(&format!("code {} {}: ", row.code.0, row.name)), "{name}: {text}");
            assert!(text.contains(&plain(row.cause)) && text.contains(&plain(row.remedy)), "{name}: {text}");
        }
    }
    for row in PARAMETERS {
        let text = said(row.key);
        let plain = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(text.contains(&format!("{}: a parameter\n", row.key)), "{text}");
        assert!(text.contains(&plain(row.description)) && text.contains(&plain(row.source)), "{text}");
        assert!(said(&format!("some_axis.{}", row.key)).contains(&format!("{}: a parameter\n", row.key)), "{text}");
    }
    for word in Word::all() {
        said(word.name);
    }
}

#[test]
fn every_function_type_and_every_field_can_be_explained() {
    for row in TYPES {
        assert!(said(row.name).contains(&format!("function type {}: {}\n", row.name, row.help)), "{}", row.name);
        for field in row.fields {
            let text = said(&format!("{}.{}", row.name, field.name));
            assert!(text.contains(&format!("{}: a field of function type {}\n", field.name, row.name)), "{text}");
            assert!(text.contains(field.source) && text.contains(&format!("{} to {}", field.min, field.max)), "{text}");
        }
        for shown in row.shows {
            assert!(said(shown.name).contains(shown.help), "{} {}", row.name, shown.name);
        }
        for word in row.words {
            said(word);
        }
    }
}

#[test]
fn every_interface_and_every_verb_can_be_explained() {
    for row in ENDPOINTS {
        assert!(said(row.name).contains(row.name), "{}", row.name);
        assert!(said(row.interface).contains(row.interface), "{}", row.interface);
    }
    for interface in INTERFACES {
        assert!(said(interface.name).contains(interface.name), "{}", interface.name);
    }
    for row in ROS_PARAMETERS {
        assert!(said(row.name).contains(&format!("{}: a ROS parameter of the node\n", row.name)), "{}", row.name);
    }
    let contract = std::fs::read_to_string(docs("contract.md")).unwrap();
    for verb in VERBS.iter() {
        assert!(said(verb).contains(&format!("{verb}: a verb of scenarios\n")), "{verb}");
        assert!(contract.contains(verb), "{verb} is not in docs/contract.md");
    }
}

/// Signals of the example cells, with axes of all kinds and most types of function slots.
#[test]
fn every_signal_of_the_examples_can_be_explained() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../launch-configs");
    for name in ["demo.yaml", "masters.yaml", "shaft/04_gantry.yaml", "functions/12_winder.yaml", "functions.yaml"] {
        let cell = Cell::load(&folder.join(name)).unwrap_or_else(|problems| panic!("{problems}"));
        for (_, entry) in cell.machine.directory().iter().filter(|(_, entry)| entry.name.contains('.')) {
            assert!(said(&entry.name).contains(entry.help), "{name}: {}", entry.name);
        }
    }
    for variable in SYSTEM_VARIABLES {
        if let Address::Number(number) = variable.address {
            assert!(said(&format!("SYSVAR {number}")).contains(variable.meaning), "{number}");
        }
        if !variable.name.is_empty() {
            assert!(said(variable.name).contains(variable.meaning), "{}", variable.name);
        }
    }
}

/// The pages that explanations refer to must exist.
#[test]
fn the_pages_that_are_named_exist() {
    for page in [
        "can.md",
        "errors.md",
        "keys.md",
        "parameters.md",
        "functions.md",
        "interfaces.md",
        "motion.md",
        "contract.md",
        "from-plc.md",
        "without-ros.md",
    ] {
        assert!(docs(page).is_file(), "{page}");
    }
    let functions = std::fs::read_to_string(docs("functions.md")).unwrap();
    for row in TYPES {
        assert!(functions.contains(&format!("\n### {}\n", row.name)), "{}", row.name);
    }
}

#[test]
fn a_narrow_terminal_gets_more_lines() {
    for name in ["10205", "actual.position", "varsync.m1", "move_axis"] {
        let facts = explain(name, 60).unwrap();
        let section = facts.lines().take_while(|line| !line.is_empty());
        assert!(section.skip(1).all(|line| line.chars().count() <= 60), "{facts}");
    }
}

fn docs(page: &str) -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs").join(page)
}
