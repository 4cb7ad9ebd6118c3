//! The interface files against the contract: names, order, types and constants, listed here a second time.

mod foreign;
mod own;

use std::path::Path;

use crate::action::{HomeAxisFeedback, HomeAxisGoal, MoveAxisGoal, ProbeAxisFeedback, ProbeAxisGoal};
use crate::action::{SynchronizeFeedback, SynchronizeGoal};
use crate::files::{OWN, read_all};
use crate::foreign::action_msgs::msg::GoalStatus;
use crate::foreign::action_msgs::srv::CancelGoalResponse;
use crate::foreign::controller_manager_msgs::srv::SwitchControllerRequest;
use crate::foreign::rcl_interfaces::msg::{Log, ParameterType};
use crate::foreign::rcl_interfaces::srv::ListParametersRequest;
use crate::interface::{Field, Interface, Section};
use crate::msg::{AxisState, CycleInputs, Event};
use crate::srv::{CommandFunctionRequest, ExportParametersRequest, ResetParametersRequest};
use foreign::FOREIGN_INTERFACES;
use own::OWN_INTERFACES;

fn interfaces() -> Vec<Interface> {
    read_all(Path::new(env!("CARGO_MANIFEST_DIR"))).expect("every file parses")
}

/// Returns `type name` or `type NAME=value`, constants first, one list per part.
fn declared(interface: &Interface) -> Vec<Vec<String>> {
    let part = |section: &Section| {
        let constants = section.constants.iter().map(|c| format!("{} {}={}", c.primitive.name, c.name, c.value));
        let fields = section.fields.iter().map(|field: &Field| format!("{} {}", field.type_text(), field.name));
        constants.chain(fields).collect()
    };
    interface.sections.iter().map(part).collect()
}

fn expected(packed: &str) -> Vec<Vec<String>> {
    let mut parts = vec![Vec::new()];
    for line in packed.lines().map(str::trim) {
        match line.split_once(' ') {
            None => parts.push(Vec::new()),
            Some((kind, names)) => {
                let last = parts.last_mut().expect("there is a first part");
                last.extend(names.split(' ').map(|name| format!("{kind} {name}")));
            }
        }
    }
    parts
}

#[test]
fn own_files_are_those_of_the_contract_to_the_letter() {
    let interfaces = interfaces();
    let own: Vec<&Interface> = interfaces.iter().filter(|interface| interface.package == OWN).collect();
    for (path, packed) in OWN_INTERFACES {
        let found = own.iter().find(|i| format!("{}/{}", i.kind.name(), i.name) == path);
        assert_eq!(declared(found.expect(path)), expected(packed), "{path}");
    }
    assert_eq!(own.len(), OWN_INTERFACES.len(), "an interface that the contract does not have");
}

#[test]
fn foreign_files_have_the_layout_that_the_wire_needs() {
    let interfaces = interfaces();
    for (package, path, packed) in FOREIGN_INTERFACES {
        let found = interfaces.iter().find(|i| i.package == package && format!("{}/{}", i.kind.name(), i.name) == path);
        assert_eq!(declared(found.expect(path)), expected(packed), "{package}/{path}");
    }
}

#[test]
fn a_goal_of_move_axis_has_its_fields_in_order() {
    let interfaces = interfaces();
    let move_axis = interfaces.iter().find(|interface| interface.name == "MoveAxis").unwrap();
    let fields: Vec<String> =
        move_axis.sections[0].fields.iter().map(|field| format!("{} {}", field.type_text(), field.name)).collect();
    let written = [
        "string axis",
        "uint8 mode",
        "uint8 units",
        "float64 position",
        "float64 velocity",
        "float64 acceleration",
        "float64 deceleration",
        "float64 jerk",
        "uint8 buffer_mode",
        "uint8 direction",
    ];
    assert_eq!(fields, written);
}

macro_rules! constants {
    ($number:ty: $($of:ident { $($name:ident = $value:literal),* })*) => {
        $($(assert_eq!(<$of>::$name, $value as $number, "{}", stringify!($of::$name));)*)*
    };
}

#[test]
fn every_constant_has_its_value() {
    constants! { u8:
        AxisState {
            DISABLED = 0, STANDSTILL = 1, DISCRETE_MOTION = 2, CONTINUOUS_MOTION = 3, HOMING = 4,
            SYNCHRONIZED_MOTION = 5, STOPPING = 6, ERROR_STOP = 7
        }
        Event { INFO = 0, WARN = 1, ERROR = 2 }
        CycleInputs { FALLING = 0, RISING = 1, ACTIVE = 0, PASSIVE = 1, OFF = 2 }
        MoveAxisGoal {
            ABSOLUTE = 0, RELATIVE = 1, ADDITIVE = 2, VELOCITY = 3, SUPERIMPOSED = 4, SI = 0, AXIS_UNIT = 1,
            INCREMENTS = 2, ABORTING = 0, BUFFERED = 1, BLENDING_LOW = 2, BLENDING_PREVIOUS = 3, BLENDING_NEXT = 4,
            BLENDING_HIGH = 5, SHORTEST = 0, POSITIVE = 1, NEGATIVE = 2, CURRENT = 3
        }
        ProbeAxisGoal {
            ABSOLUTE = 0, RELATIVE = 1, SI = 0, AXIS_UNIT = 1, INCREMENTS = 2, RISING = 0, FALLING = 1, BOTH = 2
        }
        ProbeAxisFeedback { SEARCHING = 0, PROBED = 1 }
        HomeAxisGoal { CONFIGURED = 0, CIA402 = 1, MACS = 2 }
        HomeAxisFeedback {
            SEARCH_SWITCH = 1, LEAVE_SWITCH = 2, SEARCH_INDEX = 3, MOVE_TO_OFFSET = 4, IN_DRIVE = 5
        }
        SynchronizeGoal {
            VELOCITY = 0, POSITION = 1, MARKER = 2, CAM = 3, CAM_MASTER_MARKER = 4, CAM_SLAVE_MARKER = 5,
            IMMEDIATELY = 0, AT_POSITION = 1, ON_EVENT = 2, STOP = 0, KEEP_VELOCITY = 1, ABSOLUTE = 0, RELATIVE = 1, RAMP_IN = 2
        }
        SynchronizeFeedback { WAITING = 0, CATCHING_UP = 1, SYNCHRONIZED = 2 }
        CommandFunctionRequest { RESET = 0, START = 1, VALUE_NEW = 5, READ_VALUE = 6 }
        ResetParametersRequest { USER = 0, INIT = 1 }
        ExportParametersRequest { ALL = 0, NOT_DEFAULT = 1, NOT_CELL = 2, NOT_SAVED = 3 }
        Log { DEBUG = 10, INFO = 20, WARN = 30, ERROR = 40, FATAL = 50 }
        ParameterType {
            PARAMETER_NOT_SET = 0, PARAMETER_BOOL = 1, PARAMETER_INTEGER = 2, PARAMETER_DOUBLE = 3,
            PARAMETER_STRING = 4, PARAMETER_BYTE_ARRAY = 5, PARAMETER_BOOL_ARRAY = 6, PARAMETER_INTEGER_ARRAY = 7,
            PARAMETER_DOUBLE_ARRAY = 8, PARAMETER_STRING_ARRAY = 9
        }
    }
    constants! { i8:
        GoalStatus {
            STATUS_UNKNOWN = 0, STATUS_ACCEPTED = 1, STATUS_EXECUTING = 2, STATUS_CANCELING = 3, STATUS_SUCCEEDED = 4,
            STATUS_CANCELED = 5, STATUS_ABORTED = 6
        }
        CancelGoalResponse {
            ERROR_NONE = 0, ERROR_REJECTED = 1, ERROR_UNKNOWN_GOAL_ID = 2, ERROR_GOAL_TERMINATED = 3
        }
    }
    constants! { i32: SwitchControllerRequest { BEST_EFFORT = 1, STRICT = 2, AUTO = 3, FORCE_AUTO = 4 } }
    constants! { u64: ListParametersRequest { DEPTH_RECURSIVE = 0 } }
}
