//! General keys, and keys of the ROS 2 node.

use super::{BOOLEAN, FREQUENCY, LIST, MAP, RATE, TEXT, TIME, key};
use crate::reference::Key;
use crate::reference::Shape::{Choice, List};

pub(super) const GENERAL: &[Key] = &[
    key("lineshaft", &[Choice(&["1"])], ["", "required", "Version of the file format.", "lineshaft: 1"]).required(),
    key("cycle", TIME, ["125 us to 20 ms", "required", "Cycle time: everything happens in this step.", "cycle: 1 ms"])
        .required(),
    key(
        "safety",
        MAP,
        [
            "",
            "none",
            "Inputs that must read 1, else all axes stop. No safety function: wire the contact to STO as well.",
            "safety: {estop: estop_ok}",
        ],
    ),
    key(
        "safety.estop",
        TEXT,
        [
            "a di of `io`",
            "none",
            "Emergency stop contact: on 0 all axes stop and lose power. No safety function: wire the contact to STO as well.",
            "estop: estop_ok",
        ],
    ),
    key(
        "safety.interlock",
        TEXT,
        [
            "a di of `io`",
            "none",
            "Interlock contact: on 0 all axes stop and hold. No safety function: wire the contact to STO as well.",
            "interlock: door_closed",
        ],
    ),
    key(
        "machine",
        MAP,
        ["", "defaults", "Parameters of the machine; docs/parameters.md lists them.", "machine: {i_errclr: 1}"],
    ),
];

pub(super) const ROS: &[Key] = &[
    key("ros", MAP, ["", "defaults", "How the node appears in ROS 2.", "ros: {name: press}"]),
    key(
        "ros.name",
        TEXT,
        ["a letter or _, then letters, digits and _", "lineshaft", "Name of the node.", "name: press"],
    ),
    key(
        "ros.namespace",
        TEXT,
        ["/ or names that each follow a /", "/", "Namespace of the node.", "namespace: /cell_1"],
    ),
    key(
        "ros.joint_states_rate",
        FREQUENCY,
        [RATE, "100 Hz", "Messages per second on joint_states.", "joint_states_rate: 250"],
    ),
    key(
        "ros.axis_states_rate",
        FREQUENCY,
        [RATE, "100 Hz", "Messages per second on ~/axis_states.", "axis_states_rate: 50"],
    ),
    key(
        "ros.shaft_rate",
        FREQUENCY,
        ["0, or 1 Hz to 1000 Hz", "100 Hz", "Messages per second on ~/shaft; 0 publishes none.", "shaft_rate: 0"],
    ),
    key(
        "ros.autostart",
        BOOLEAN,
        ["", "true", "Whether the node becomes active without a request.", "autostart: false"],
    ),
    key(
        "ros.robot_description",
        TEXT,
        [
            "a file next to the cell",
            "none",
            "URDF file that is published on robot_description.",
            "robot_description: demo.urdf",
        ],
    ),
    key(
        "ros.record_topics",
        &[Choice(&["all", "none"]), List],
        ["", "all", "Topics of the node in a bag of `run --record`.", "record_topics: [/rosout, ~/errors]"],
    ),
    key("ros.record_topics[]", TEXT, ["a topic of the node that is not always recorded", "", "One topic.", ""]),
    key(
        "ros.controller_manager",
        TEXT,
        [
            "an absolute name",
            "none",
            "Name of a controller manager whose services the node offers.",
            "controller_manager: /controller_manager",
        ],
    ),
    key(
        "ros.interfaces",
        LIST,
        ["", "as the environment says", "Network interfaces that ROS 2 uses.", "interfaces: [eth0]"],
    ),
    key("ros.interfaces[]", TEXT, ["", "", "An interface by name or address.", ""]),
    key(
        "ros.on_loss",
        &[Choice(&["halt", "none"])],
        ["", "halt", "Reaction to a lost ROS side: all axes halt, or none does.", "on_loss: none"],
    ),
    key(
        "ros.loss_timeout",
        TIME,
        ["0.5 s to 5 s", "2 s", "Time without an answer after which the ROS side is lost.", "loss_timeout: 1 s"],
    ),
    key(
        "ros.request_timeout",
        TIME,
        ["0.1 s to 3600 s", "2 s", "Age up to which a request is carried out.", "request_timeout: 5 s"],
    ),
];
