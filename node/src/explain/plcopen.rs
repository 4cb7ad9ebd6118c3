//! Explains function blocks, inputs, outputs and terms of PLCopen and of PLCs by their equivalents. docs/from-plc.md has
//! the same tables; a test ensures this.
//!
//! Source   PLCopen Technical Committee 2, function blocks for motion control: part 1 (version 2.0), part 4, coordinated
//!          motion, and part 5, homing procedures

use super::section;

/// Common prefix of all these names.
const PREFIX: &str = "MC_";

/// Blocks with the same equivalent.
struct Block {
    /// Names of the blocks.
    names: &'static [&'static str],
    /// The service, action, topic, parameter or key, or `no equivalent` with the alternative; empty: none.
    here: &'static str,
    /// Verb of a scenario, or signal; empty: none.
    verb: &'static str,
    /// Command of the program; empty: none.
    command: &'static str,
}

const fn block(names: &'static [&'static str], here: &'static str, verb: &'static str, command: &'static str) -> Block {
    Block { names, here, verb, command }
}

/// A part of the standard, and its blocks.
struct Part {
    /// Heading of its table.
    name: &'static str,
    /// Blocks in the order of the table.
    blocks: &'static [Block],
}

/// All parts, in the order of the page.
static PARTS: [Part; 5] = [
    Part { name: "Part 1, administrative", blocks: ADMINISTRATIVE },
    Part { name: "Part 1, motion", blocks: MOTION },
    Part { name: "Part 4, administrative", blocks: GROUPS },
    Part { name: "Part 4, motion", blocks: COORDINATED },
    Part { name: "Part 5, homing", blocks: HOMING },
];

/// Terms with the same equivalent: their names, and the equivalent.
type Term = (&'static [&'static str], &'static str);

/// A table of terms. The page in docs is made of it by a test.
#[cfg_attr(not(test), expect(dead_code, reason = "only the page has marks and headings"))]
struct Glossary {
    /// Name of its marks on the page.
    mark: &'static str,
    /// Heading of its first column.
    heading: &'static str,
    /// Kind of its terms.
    kind: &'static str,
    terms: &'static [Term],
}

/// All tables of terms, in the order of the page.
static GLOSSARIES: [Glossary; 2] = [
    Glossary { mark: "terms", heading: "PLC", kind: "a term of PLCs", terms: TERMS },
    Glossary { mark: "outputs", heading: "PLCopen", kind: "a state, an input or an output of PLCopen", terms: OUTPUTS },
];

const TERMS: &[Term] = &[
    (&["AXIS_REF"], "name of the axis in the cell, such as `x`"),
    (&["axis configuration"], "the cell, a YAML file; each setting is a **key**"),
    (&["cycle time of the task"], "`cycle` of the cell"),
    (&["scaling"], "`scale`: encoder increments per distance or angle"),
    (&["modulo axis"], "`modulo`; positions are shown unwrapped, signal `x.modulo.position` is within the turn"),
    (&["software limits"], "`min_position`, `max_position`"),
    (&["monitoring of the following error", "lag"], "`max_following_error`, `following_error_time`"),
    (&["target position window"], "`in_position_window`"),
    (&["virtual axis", "master"], "axis with `drive: virtual`; the leader of a gear or cam is its `master`"),
    (&["function block that is done at once"], "ROS **service**: one request, one answer"),
    (&["function block with Busy and Done"], "ROS **action**: a **goal**, feedback, a result; it can be cancelled"),
    (&["cyclic status data"], "ROS **topic**: messages at a fixed rate or on change"),
    (
        &["command in a test sequence"],
        "**verb** of a scenario; verbs have the names and fields of services and actions",
    ),
    (&["online value"], "**signal**, such as `x.actual.position`; `lineshaft signals CELL` lists them"),
];

const OUTPUTS: &[Term] = &[
    (&["axis states"], "the same: `STANDSTILL`, `DISCRETE_MOTION`, .., `ERROR_STOP` in `~/axis_states`"),
    (&["BufferMode"], "`buffer_mode`: ABORTING, BUFFERED, BLENDING_LOW, _PREVIOUS, _NEXT, _HIGH"),
    (&["Direction"], "`direction` of modulo axes"),
    (&["Velocity", "Acceleration", "Deceleration", "Jerk"], "fields of the goal; 0 means the default of the axis"),
    (&["Execute"], "the goal or the request is sent"),
    (&["Busy"], "the goal is accepted and has no result yet"),
    (
        &["Active"],
        "the goal moves the axis. One that waits (`buffer_mode`) starts when the goal before it ends; a coupling reports its start in \
         the feedback `phase` of `~/synchronize`",
    ),
    (&["Done"], "the goal ends SUCCEEDED"),
    (&["InVelocity"], "`in_velocity` in `~/axis_states`, signal `x.in_velocity`"),
    (
        &["InGear", "InSync"],
        "`in_sync` in `~/axis_states`, signal `x.in_sync`; feedback `phase` SYNCHRONIZED of `~/synchronize`",
    ),
    (
        &["CommandAborted", "Error", "ErrorID"],
        "the goal ends ABORTED; `code` and `message` of the result give the reason. An invalid goal is rejected; the reason is on \
         `/rosout`",
    ),
];

const ADMINISTRATIVE: &[Block] = &[
    block(&["MC_Power"], "`~/enable`, `~/disable`", "`enable`, `disable`", "`lineshaft enable`, `disable`"),
    block(
        &["MC_ReadStatus", "MC_ReadMotionState", "MC_ReadAxisInfo"],
        "`~/axis_states`",
        "signal `x.state` and others",
        "`lineshaft state`",
    ),
    block(
        &["MC_ReadAxisError"],
        "`~/axis_states`, field `error_code`; `~/errors`",
        "signal `x.error`",
        "`lineshaft state`",
    ),
    block(&["MC_Reset"], "`~/reset_errors`", "`reset_errors`", "`lineshaft reset`"),
    block(
        &["MC_ReadParameter", "MC_ReadBoolParameter", "MC_WriteParameter", "MC_WriteBoolParameter"],
        "ROS parameters `x.<key>`",
        "`set_parameters`",
        "",
    ),
    block(&["MC_ReadDigitalInput", "MC_ReadDigitalOutput"], "", "signal of the input or output", ""),
    block(&["MC_WriteDigitalOutput"], "`~/set_output`", "`set_output`", ""),
    block(&["MC_ReadAnalogInput"], "", "signal of the input", ""),
    block(
        &["MC_ReadActualPosition"],
        "`~/axis_states`, `joint_states`",
        "signal `x.actual.position`",
        "`lineshaft state`",
    ),
    block(
        &["MC_ReadActualVelocity"],
        "`~/axis_states`, `joint_states`",
        "signal `x.actual.velocity`",
        "`lineshaft state`",
    ),
    block(&["MC_ReadActualTorque"], "`joint_states`, field `effort`", "signal `x.actual.effort`", ""),
    block(&["MC_SetPosition"], "`~/set_position`, `~/set_position_relative`", "`set_position`", ""),
    block(
        &["MC_SetOverride"],
        "`velocity_override`, a share of `max_velocity`: it limits faster goals, and is no factor",
        "`set_parameters`",
        "",
    ),
    block(
        &["MC_TouchProbe", "MC_AbortTrigger"],
        "`~/touch_probe`, `~/abort_trigger`; with a move after the edge `~/probe_axis`",
        "`touch_probe`, `abort_trigger`, `probe_axis`",
        "",
    ),
    block(&["MC_DigitalCamSwitch"], "function slot of type `cam`", "`run_function`, `command_function`", ""),
    block(&["MC_CamTableSelect"], "`~/synchronize`, field `table`; `~/load_table`", "`synchronize`, `load_table`", ""),
];

const MOTION: &[Block] = &[
    block(&["MC_Home"], "`~/home_axis`, `~/home`", "`home_axis`", "`lineshaft home`"),
    block(&["MC_Stop"], "`~/quick_stop`; locks until `~/reset_errors`", "`quick_stop`", ""),
    block(&["MC_Halt"], "`~/halt`", "`halt`", "`lineshaft halt`"),
    block(
        &["MC_MoveAbsolute", "MC_MoveRelative"],
        "`~/move_axis`, field `mode`",
        "`move_axis`",
        "`lineshaft move`, with `--relative`",
    ),
    block(
        &["MC_MoveAdditive", "MC_MoveSuperimposed", "MC_MoveVelocity"],
        "`~/move_axis`, field `mode`; velocities that change in each cycle: `~/setpoints`",
        "`move_axis`, `setpoints`",
        "`lineshaft jog`, for a velocity",
    ),
    block(&["MC_HaltSuperimposed"], "cancel of the superimposed goal", "`cancel`", ""),
    block(
        &["MC_MoveContinuousAbsolute", "MC_MoveContinuousRelative"],
        "no equivalent: a goal ends at rest, or blends into the next one (`buffer_mode`)",
        "",
        "",
    ),
    block(
        &["MC_TorqueControl"],
        "no equivalent: `interface: torque` closes all loops here; `out_an` is for commissioning",
        "`out_an`",
        "",
    ),
    block(&["MC_PositionProfile"], "`~/follow_joint_trajectory`", "`follow_joint_trajectory`", ""),
    block(
        &["MC_VelocityProfile", "MC_AccelerationProfile"],
        "no equivalent: `~/setpoints` takes velocities, one after the other",
        "`setpoints`",
        "",
    ),
    block(
        &["MC_GearIn"],
        "`~/synchronize`, modes VELOCITY, POSITION; the ratio is increments of the axis per increments of the leader",
        "`synchronize`",
        "",
    ),
    block(
        &["MC_GearInPos"],
        "`~/synchronize`, `engage` AT_POSITION; `master_increments`, `slave_increments`, `start_distance_increments` are \
         MasterSyncPosition, SlaveSyncPosition, MasterStartDistance",
        "`synchronize`",
        "",
    ),
    block(&["MC_CamIn"], "`~/synchronize`, mode CAM, `table`", "`synchronize`", ""),
    block(
        &["MC_GearOut", "MC_CamOut"],
        "`~/gear_out`, or cancel of the goal; the axis stops (default STOP). The behaviour of PLCopen is `disengage: keep_velocity`, \
         for cancel in the goal",
        "`gear_out`, `cancel`",
        "",
    ),
    block(&["MC_PhasingRelative"], "`~/phase`, side MASTER", "`phase`", ""),
    block(&["MC_PhasingAbsolute"], "no equivalent: a phase shift is relative", "", ""),
    block(&["MC_CombineAxes"], "section `masters` of the cell", "", ""),
];

const GROUPS: &[Block] = &[
    block(
        &["MC_AddAxisToGroup", "MC_RemoveAxisFromGroup", "MC_UngroupAllAxes", "MC_GroupReadConfiguration"],
        "section `groups` of the cell; a group does not change while the node runs",
        "",
        "",
    ),
    block(
        &["MC_GroupEnable", "MC_GroupDisable"],
        "`~/enable`, `~/disable` with the names of the axes",
        "`enable`, `disable`",
        "`lineshaft enable`, `disable`",
    ),
    block(&["MC_GroupHome"], "`~/home` with the names of the axes", "`home_axis`", "`lineshaft home`"),
    block(&["MC_GroupReset"], "`~/reset_errors` with the names of the axes", "`reset_errors`", "`lineshaft reset`"),
    block(&["MC_GroupSetPosition"], "`~/set_position` of each axis", "`set_position`", ""),
    block(
        &["MC_GroupReadActualPosition", "MC_GroupReadActualVelocity"],
        "`joint_states`; the position of the tool: `/tf` of a robot_state_publisher",
        "",
        "`lineshaft state`",
    ),
    block(&["MC_GroupReadActualAcceleration"], "no equivalent", "", ""),
    block(&["MC_GroupReadStatus", "MC_GroupReadError"], "`~/axis_states`, of each axis", "", "`lineshaft state`"),
    block(&["MC_GroupSetOverride"], "no equivalent: `velocity_override` does not apply to trajectories", "", ""),
    block(
        &[
            "MC_SetKinTransform",
            "MC_SetCartesianTransform",
            "MC_SetCoordinateTransform",
            "MC_ReadKinTransform",
            "MC_ReadCartesianTransform",
            "MC_ReadCoordinateTransform",
        ],
        "no equivalent: kinematics and frames are in the URDF and in the planner, such as MoveIt",
        "",
        "",
    ),
    block(&["MC_PathSelect"], "no equivalent: a trajectory is in the goal, or in a file of a scenario", "", ""),
    block(
        &["MC_SetDynCoordTransform", "MC_TrackConveyorBelt", "MC_TrackRotaryTable"],
        "no equivalent: single axes follow a belt by `~/synchronize`",
        "",
        "",
    ),
];

const COORDINATED: &[Block] = &[
    block(&["MC_GroupStop"], "`~/quick_stop` with the names of the axes", "`quick_stop`", ""),
    block(
        &["MC_GroupHalt"],
        "`~/halt` with the names of the axes, or cancel of the trajectory",
        "`halt`, `cancel`",
        "`lineshaft halt`",
    ),
    block(
        &["MC_GroupInterrupt", "MC_GroupContinue"],
        "no equivalent: send the rest of the trajectory as a new goal",
        "",
        "",
    ),
    block(
        &["MC_MoveDirectAbsolute", "MC_MovePath"],
        "`~/follow_joint_trajectory`: points with positions and times",
        "`follow_joint_trajectory`",
        "",
    ),
    block(&["MC_MoveDirectRelative"], "no equivalent: the points of a trajectory are absolute", "", ""),
    block(
        &["MC_MoveLinearAbsolute", "MC_MoveLinearRelative", "MC_MoveCircularAbsolute", "MC_MoveCircularRelative"],
        "no equivalent: a planner, such as MoveIt, plans the path; `~/follow_joint_trajectory` runs it",
        "",
        "",
    ),
    block(&["MC_SyncAxisToGroup", "MC_SyncGroupToAxis"], "no equivalent: a leader is an axis or an encoder", "", ""),
];

const HOMING: &[Block] = &[
    block(
        &["MC_StepAbsoluteSwitch"],
        "`homing.method` 19 to 30 of the axis, with the index pulse 3 to 14; `~/home_axis` runs all steps",
        "`home_axis`",
        "`lineshaft home`",
    ),
    block(
        &["MC_StepLimitSwitch"],
        "`homing.method` 17, 18 of the axis, with the index pulse 1, 2; `~/home_axis` runs all steps",
        "`home_axis`",
        "`lineshaft home`",
    ),
    block(
        &["MC_StepReferencePulse"],
        "`homing.method` 33, 34 of the axis, after a switch 1 to 14; `~/home_axis` runs all steps",
        "`home_axis`",
        "`lineshaft home`",
    ),
    block(&["MC_StepBlock"], "no equivalent: no method searches for a mechanical stop", "", ""),
    block(&["MC_StepDistanceCoded"], "no equivalent: distance-coded index pulses are not evaluated", "", ""),
    block(
        &["MC_HomeDirect"],
        "`homing.method` 35 of the axis and `~/home_axis`: the reference is the actual position; `~/set_position` changes a position \
         without homing",
        "`home_axis`, `set_position`",
        "`lineshaft home`",
    ),
    block(&["MC_HomeAbsolute"], "no equivalent: the zero of an absolute encoder is fixed, without homing", "", ""),
    block(
        &["MC_FinishHoming"],
        "no equivalent: `~/home_axis` contains all steps; a motion after it is `~/move_axis`",
        "`move_axis`",
        "",
    ),
    block(
        &["MC_StepReferenceFlyingSwitch", "MC_StepReferenceFlyingRefPulse"],
        "no equivalent: `~/touch_probe` latches a position in motion, `~/set_position_relative` corrects the position",
        "`touch_probe`, `set_position`",
        "",
    ),
    block(&["MC_AbortPassiveHoming"], "no equivalent: `~/abort_trigger` ends a touch probe", "`abort_trigger`", ""),
];

pub(super) fn sections(name: &str, width: usize) -> Vec<String> {
    let is_called = |known: &str| {
        let bare = known.strip_prefix(PREFIX).unwrap_or(known);
        known.eq_ignore_ascii_case(name) || bare.eq_ignore_ascii_case(name)
    };
    let mut sections = Vec::new();
    for part in &PARTS {
        for block in part.blocks {
            let found = block.names.iter().copied().filter(|known| is_called(known));
            sections.extend(found.map(|known| text(known, part, block, width)));
        }
    }
    for glossary in &GLOSSARIES {
        for (names, here) in glossary.terms {
            let found = names.iter().filter(|known| known.eq_ignore_ascii_case(name));
            sections.extend(found.map(|known| term_text(known, glossary.kind, here, width)));
        }
    }
    sections
}

pub(super) fn names() -> Vec<String> {
    let blocks = PARTS.iter().flat_map(|part| part.blocks);
    let terms = GLOSSARIES.iter().flat_map(|glossary| glossary.terms).flat_map(|(names, _)| *names);
    blocks.flat_map(|block| block.names).chain(terms).map(|name| (*name).to_owned()).collect()
}

fn text(name: &str, part: &Part, block: &Block, width: usize) -> String {
    let facts: [(&str, &str); 4] =
        [("here", block.here), ("verb", block.verb), ("command", block.command), ("documented", "docs/from-plc.md")];
    section(&format!("{name}: a function block of PLCopen ({})", part.name), &facts, width)
}

/// Returns the verbs that do the same as the blocks of that name, with or without its prefix.
pub(super) fn equivalents(is_called: impl Fn(&str) -> bool) -> impl Iterator<Item = &'static str> {
    let is_called = move |known: &str| is_called(known) || known.strip_prefix(PREFIX).is_some_and(&is_called);
    let blocks = PARTS.iter().flat_map(|part| part.blocks);
    let found = blocks.filter(move |block| block.names.iter().any(|known| is_called(known)));
    // Verbs are in backticks; a signal may be among them.
    let quoted = found.flat_map(|block| block.verb.split('`').skip(1).step_by(2));
    quoted.filter(|verb| crate::scenario::VERBS.contains(verb))
}

fn term_text(name: &str, kind: &str, here: &str, width: usize) -> String {
    // Bold text of the page.
    let here = here.replace("**", "");
    section(&format!("{name}: {kind}"), &[("here", here.as_str()), ("documented", "docs/from-plc.md")], width)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::interfaces::replaced;
    use crate::scenario::VERBS;
    use lineshaft_ros::surface::table::ROWS;
    use std::collections::HashSet;

    /// Returns a table of terms.
    fn glossary(glossary: &Glossary) -> String {
        let mut text = format!("| {} | Lineshaft |\n| --- | --- |\n", glossary.heading);
        for (names, here) in glossary.terms {
            text += &format!("| {} | {here} |\n", names.join(", "));
        }
        text
    }

    /// Returns the page with regenerated tables.
    fn renewed(page: &str) -> String {
        let page = replaced(page, "blocks", &markdown()).unwrap();
        GLOSSARIES.iter().fold(page, |page, table| replaced(&page, table.mark, &glossary(table)).unwrap())
    }

    /// Returns the tables of function blocks.
    fn markdown() -> String {
        let mut text = String::new();
        for part in &PARTS {
            if !text.is_empty() {
                text.push('\n');
            }
            text += &format!("### {}\n\n| PLCopen | service, action or parameter | verb | command |\n", part.name);
            text += "| --- | --- | --- | --- |\n";
            for Block { names, here, verb, command } in part.blocks {
                text += &format!("| {} | {here} | {verb} | {command} |\n", names.join(", "));
            }
        }
        text
    }

    #[test]
    fn the_page_in_docs_has_the_same_table() {
        crate::page::check("from-plc.md", "plcopen", renewed);
    }

    /// Returns the parts in backticks.
    fn quoted(text: &str) -> impl Iterator<Item = &str> {
        text.split('`').skip(1).step_by(2)
    }

    #[test]
    fn each_block_names_what_exists_and_is_there_once() {
        let mut names = HashSet::new();
        for block in PARTS.iter().flat_map(|part| part.blocks) {
            assert!(!block.here.is_empty() || !block.verb.is_empty(), "{:?}", block.names);
            for name in block.names {
                assert!(name.starts_with(PREFIX) && names.insert(*name), "{name}");
            }
            for own in quoted(block.here).filter(|word| word.starts_with("~/")) {
                assert!(ROWS.iter().any(|row| row.name == own), "{:?}: {own}", block.names);
            }
            for word in quoted(block.verb) {
                let is_signal = word.starts_with("x.") && super::super::explain(word, 80).is_ok();
                assert!(is_signal || VERBS.contains(&word), "{:?}: {word}", block.names);
            }
        }
        assert!(names.len() > 60, "{}", names.len());
    }

    #[test]
    fn each_term_names_what_exists_and_is_there_once() {
        let mut known = HashSet::new();
        for (names, here) in GLOSSARIES.iter().flat_map(|table| table.terms) {
            for name in *names {
                assert!(known.insert(*name), "{name}");
                let text = super::super::explain(name, 10_000).unwrap();
                let here = here.replace(['`', '*'], "");
                assert!(text.contains(&format!("  here          {here}\n")), "{name}: {text}");
            }
            for word in quoted(here) {
                assert!(!word.starts_with("~/") || ROWS.iter().any(|row| row.name == word), "{names:?}: {word}");
                assert!(!word.starts_with("x.") || super::super::explain(word, 80).is_ok(), "{names:?}: {word}");
            }
        }
    }
}
