//! `lineshaft check`.

mod args;
mod coasting;
mod functions;
mod homing;
mod marks;
mod names;

pub(super) use self::args::CheckArgs;

use super::Exit;
use super::command_output::Output;
use crate::cell::{Cell, DeviceFindings};
use crate::document::Problems;
use crate::graph;
use crate::recording::plot::{Target, replace};
use crate::scenario::{Scenario, other_cell};
use lineshaft_core::config::{AxisConfig, MachineConfig, SinkConfig, SlotConfig, SourceConfig};
use lineshaft_core::drive::Interface;
use lineshaft_core::function::Quantity;
use lineshaft_core::machine::Machine;
use lineshaft_core::parameter::AxisParameters;
use lineshaft_core::regulator::Law;
use lineshaft_core::unit::{ScaleKind, number_to_text};
use serde_json::{Value as Json, json};
use std::path::Path;

pub(super) fn check(args: &CheckArgs) -> Exit {
    let mut output = Output::new("check", args.json);
    for field in ["cell", "scenario", "graph"] {
        output.set(field, Json::Null);
    }
    let exit = match judge(args, &mut output) {
        Ok(()) => Exit::Good,
        Err(wrong) => {
            match &wrong {
                Wrong::Problems(problems) => output.problems(problems),
                Wrong::Machine(sentence) if output.is_json() => output.complain(sentence),
                Wrong::Machine(sentence) => eprintln!("{sentence}"),
                Wrong::Figure(sentence) => output.complain(sentence),
            }
            Exit::Usage
        }
    };
    output.finish(exit)
}

/// Reason why a check failed.
enum Wrong {
    Problems(Problems),
    /// An error of the machine, which has no location in the file because no single key is wrong.
    Machine(String),
    Figure(String),
}

impl From<Problems> for Wrong {
    fn from(problems: Problems) -> Self {
        Self::Problems(problems)
    }
}

fn judge(args: &CheckArgs, output: &mut Output) -> Result<(), Wrong> {
    let file = args.cell.display();
    let cell = Cell::load_within(&args.cell, args.preset.map(Into::into))?;
    let machine = Machine::new(cell.machine.clone()).map_err(|error| Wrong::Machine(format!("{file}: {error}")))?;
    let (problems, idle) = functions::judge(&file.to_string(), &cell, &machine);
    if !problems.is_empty() {
        return Err(problems.into());
    }
    let DeviceFindings { remarks, warnings: of_devices } = cell.device_findings(Some(&args.cell))?;
    output.say(&format_args!("{file}: good: {}", summary(&cell)));
    output.set("cell", object(&cell, &file.to_string()));
    if let Some(line) = joint_names(&cell) {
        output.say(&line);
    }
    for line in remarks.into_iter().chain(coasting::note(&cell.machine)) {
        output.remark(&line);
    }
    for warning in warnings(&cell).into_iter().chain(idle).chain(of_devices) {
        output.warn(&warning);
    }
    if let Some(path) = &args.graph {
        draw(&cell, &args.cell, path).map_err(Wrong::Figure)?;
        output.say(&path.display());
        output.set("graph", json!(path.display().to_string()));
    }
    let Some(path) = &args.scenario else { return Ok(()) };
    if let Some(note) = other_cell(path, Some(&args.cell)) {
        output.note(&note);
    }
    let scenario = Scenario::load(path, &cell)?;
    let (path, name, cycles) = (path.display(), scenario.name(), scenario.cycles());
    output.say(&format_args!("{path}: good: {name}, {cycles} cycles"));
    output.set("scenario", json!({"file": path.to_string(), "name": name, "cycles": cycles}));
    Ok(())
}

/// Draws the functions of a cell.
fn draw(cell: &Cell, name: &Path, path: &Path) -> Result<(), String> {
    if Target::of(path).ok() != Some(Target::Svg) {
        return Err(format!("the figure {} has to end with .svg", path.display()));
    }
    let title = name.file_name().unwrap_or(name.as_os_str()).to_string_lossy();
    let figure = graph::draw(&cell.machine, &title).ok_or("the cell has no functions that could be drawn")?;
    replace(path, figure.as_bytes()).map_err(|error| error.to_string())
}

/// Describes a cell as a JSON object.
fn object(cell: &Cell, file: &str) -> Json {
    let machine = &cell.machine;
    let joints = cell.joint_names.different_names(machine).map(|(axis, joint)| (axis.to_owned(), json!(joint)));
    json!({
        "file": file,
        "cycle_ns": machine.cycle_ns,
        "axes": machine.axes.len(),
        "encoders": machine.encoders.len(),
        "inputs_and_outputs": machine.io.len(),
        "memory_cells": machine.memory.len(),
        "functions": machine.slots.len(),
        "masters": machine.masters.len(),
        "tables": machine.tables.len(),
        "joint_names": joints.collect::<Json>(),
    })
}

/// Returns the axes whose joint names differ from their own names; `None` if there are none.
fn joint_names(cell: &Cell) -> Option<String> {
    let renamed = cell.joint_names.different_names(&cell.machine).map(|(axis, joint)| format!("{axis} is {joint}"));
    let renamed: Vec<String> = renamed.collect();
    (!renamed.is_empty()).then(|| format!("joint names: {}", renamed.join(", ")))
}

/// Returns warnings: settings that are valid but probably not intended.
pub(super) fn warnings(cell: &Cell) -> Vec<String> {
    let mut warnings = cell.robot.as_ref().map_or(Vec::new(), |robot| robot.warnings(&cell.machine, &cell.joint_names));
    warnings.extend(cell.bare_numbers.iter().cloned());
    warnings.extend(names::judge(cell));
    warnings.extend(cell.machine.unlimited_searches().map(|axis| {
        let name = &axis.name;
        format!(
            "{name}: without its switch homing goes on for ever; \
             give homing.max_distance, min_position and max_position, or homing.max_time"
        )
    }));
    let coasts = |axis: &&AxisConfig| axis.brake.is_some() && matches!(axis.parameters.error_reaction, 0 | 1);
    warnings.extend(cell.machine.axes.iter().filter(coasts).map(|axis| {
        let (name, reaction) = (&axis.name, axis.parameters.error_reaction);
        format!(
            "{name}: error_reaction {reaction} takes the power before the brake has closed, and a hanging load drops; \
             2 and 3 stop and hold first"
        )
    }));
    warnings.extend(one_edge_for_two(cell));
    warnings.extend(crossed_switches(cell));
    warnings.extend(cell.machine.axes.iter().flat_map(|axis| virtual_limits(axis, cell)));
    warnings.extend(cell.machine.axes.iter().filter_map(idle_gains));
    warnings.extend(cell.machine.axes.iter().flat_map(idle_loops));
    warnings.extend(cell.machine.slots.iter().filter_map(|slot| stepped_position(slot, &cell.machine)));
    warnings.extend(homing::judge(cell));
    warnings.extend(marks::judge(&cell.machine));
    warnings.extend(graph::loops(&cell.machine));
    warnings
}

/// Returns a warning about gains of the SAIA module whose controller commands no drive: it runs in addition to the loop
/// of the axis (SAIA-EXT-06).
fn idle_gains(axis: &AxisConfig) -> Option<String> {
    let p = &axis.parameters.vocabularies.saia;
    let gains = [("saia.kprop", p.kprop), ("saia.kint", p.kint), ("saia.kder", p.kder)];
    let given: Vec<String> =
        gains.iter().filter(|(_, gain)| *gain != 0).map(|(key, gain)| format!("{key} {gain}")).collect();
    let closes_here = axis.drive.is_some() && axis.interface.closes_loop_here() && axis.law != Law::Integer;
    (closes_here && !given.is_empty()).then(|| {
        format!(
            "{}: no drive hears {}: with regulator {} the axis closes its loop with a gain of its own, and the \
             regulator of the module only shows in saia.output and saia.integral",
            axis.name,
            given.join(", "),
            axis.law.name()
        )
    })
}

/// Returns a warning about a copy whose values move a rotary axis as positions, in one step; they may be meant as a
/// speed (AMK-GEN-18).
fn stepped_position(slot: &SlotConfig, machine: &MachineConfig) -> Option<String> {
    let SinkConfig::Axis(place) = slot.sink else { return None };
    let axis = machine.axes.get(usize::from(place)).filter(|axis| axis.scale.kind() == ScaleKind::Rotary)?;
    let has_values = slot.kind.copies_values(&slot.values, matches!(slot.source, SourceConfig::Signal(_)));
    let (name, axis) = (&slot.name, &axis.name);
    (has_values && slot.quantity == Quantity::Position).then(|| {
        format!(
            "function {name}: its values are positions of {axis} in increments, and the axis makes each step of them in one cycle; \
             `quantity: speed` makes them speeds in 0.0001 rpm"
        )
    })
}

/// Returns warnings about gains of loops that do not exist (MACS-AMP-01), a maximum of currents that nothing limits
/// (MACS-AMP-08), and a limit that every current exceeds.
fn idle_loops(axis: &AxisConfig) -> impl Iterator<Item = String> {
    let name = &axis.name;
    let is_torque = axis.drive.is_some() && axis.interface.takes_effort();
    let is_voltage = axis.drive.is_some() && axis.interface == Interface::Voltage;
    let (p, stage) = (&axis.parameters.amplifier, &axis.parameters.power_stage);
    let (usual, usual_stage) = {
        let parameters = AxisParameters::new(1.0, 1.0);
        (parameters.amplifier, parameters.power_stage)
    };
    let gains = [
        ("velkprop", p.proportional, usual.proportional),
        ("velkint", p.integral, usual.integral),
        ("velkilim", p.limit, usual.limit),
    ];
    let idle = gains.into_iter().filter(move |(_, value, usual)| is_torque && !p.has_velocity_loop() && value != usual);
    let idle = idle.map(move |(key, value, _)| {
        let mode = p.mode;
        format!("{name}: {key} is {value} and does nothing: with ampmode {mode} the axis has no velocity loop")
    });
    let of_currents = [
        ("curkprop", stage.proportional, usual_stage.proportional),
        ("curkint", stage.integral, usual_stage.integral),
        ("curkilim", stage.limit, usual_stage.limit),
        ("ampmaxcur", p.max_current, usual.max_current),
    ];
    let is_without = is_voltage && !p.has_current_loop();
    let of_currents = of_currents.into_iter().filter(move |(_, value, usual)| is_without && value != usual);
    let full = stage.full_current.filter(|_| is_without).map(|full| ("full_current", number_to_text(full)));
    let of_currents =
        of_currents.map(|(key, value, _)| (key, value.to_string())).chain(full).map(move |(key, value)| {
            let mode = p.mode;
            format!("{name}: {key} is {value} and does nothing: with ampmode {mode} nothing limits the current")
        });
    let is_tight = is_torque && p.heat_time > 0 && p.heat_limit == 0;
    let tight =
        is_tight.then(|| format!("{name}: i2tlimit is 0: with i2tftime {} any current is error 99", p.heat_time));
    let encoder = idle_encoder(axis).filter(|_| is_torque);
    idle.chain(encoder).chain(of_currents).chain(tight)
}

/// Returns a warning about an encoder of a velocity loop that does not exist, or one that is described but not selected
/// (MACS-AMP-06).
fn idle_encoder(axis: &AxisConfig) -> Option<String> {
    let p = &axis.parameters.amplifier;
    let name = &axis.name;
    if p.encoder.is_separate() {
        return (!p.has_velocity_loop()).then(|| {
            format!(
                "{name}: ampencno is {} and does nothing: with ampmode {} the axis has no velocity loop",
                p.encoder.number, p.mode
            )
        });
    }
    let given = [("ampencres", p.encoder.resolution, -1), ("ampencrpm", p.encoder.rpm, 0)];
    let (key, value, _) = given.into_iter().find(|(_, value, usual)| value != usual)?;
    Some(format!("{name}: {key} is {value} and does nothing: ampencno is -1, the encoder of the position loop"))
}

/// Returns warnings about limit switches that are outputs of the machine (MACS-LIM-07).
fn virtual_limits(axis: &AxisConfig, cell: &Cell) -> impl Iterator<Item = String> {
    let assigned = axis.parameters.assigned;
    let machine = &cell.machine;
    [("i_poslimitsw", assigned.poslimitsw), ("i_neglimitsw", assigned.neglimitsw)].into_iter().filter_map(
        move |(key, number)| {
            let place = usize::try_from(number.unsigned_abs()).ok()?.checked_sub(1)?;
            let read = machine.global.virtual_inputs.iter().find(|read| read.input == place)?;
            let output = machine.io.get(usize::from(read.output)).map_or("", |io| io.name.as_str());
            Some(format!(
                "{}: {key} {number} reads output `{output}` and no terminal: it acts a cycle later, and only as long as this \
                 program does; a limit switch that protects has a wire",
                axis.name
            ))
        },
    )
}

/// Returns a warning about an edge that stops the axes and, if they are at rest, unlocks them.
fn one_edge_for_two(cell: &Cell) -> Option<String> {
    let machine = &cell.machine.global.parameters;
    let number = machine.i_break;
    (number != 0 && machine.i_continue == number).then(|| {
        format!(
            "i_break and i_continue name the same edge of input {}: after a stop the next one unlocks the axes; \
             {} is its other edge",
            number.unsigned_abs(),
            number.saturating_neg()
        )
    })
}

/// Returns warnings about simulated limit switches that are both actuated at all or almost all positions of the axis.
fn crossed_switches(cell: &Cell) -> Vec<String> {
    let axes = cell.machine.axes.iter().filter(|axis| axis.drive.is_some()).zip(&cell.mechanics);
    let crossed = axes.filter(|(_, mechanics)| {
        let fixtures = &mechanics.fixtures;
        fixtures.positive.zip(fixtures.negative).is_some_and(|(positive, negative)| positive <= negative)
    });
    let told = crossed.map(|(axis, _)| {
        format!(
            "{}: the simulated positive_limit_switch, actuated at rising counts from `at` on, is not above the \
             negative one, actuated up to its `at`; the axis never stands between them",
            axis.name
        )
    });
    told.collect()
}

/// Returns a short summary of a cell.
pub(super) fn summary(cell: &Cell) -> String {
    let machine = &cell.machine;
    let counts = [
        (machine.axes.len(), "axis", "axes"),
        (machine.encoders.len(), "encoder", "encoders"),
        (machine.io.len(), "input or output", "inputs and outputs"),
        (machine.memory.len(), "memory cell", "memory cells"),
        (machine.slots.len(), "function", "functions"),
        (machine.masters.len(), "master", "masters"),
        (machine.tables.len(), "table", "tables"),
    ];
    let counts = counts.iter().filter(|(count, ..)| *count > 0);
    let counts: Vec<String> =
        counts.map(|(count, one, many)| format!("{count} {}", if *count == 1 { one } else { many })).collect();
    let counts = if counts.is_empty() { vec!["no axes".to_owned()] } else { counts };
    format!("{}; cycle {} ms", counts.join(", "), machine.cycle_ns as f64 / 1e6)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the warnings about an axis with these keys, which has all switches.
    fn warned(keys: &str) -> Vec<String> {
        let switches = "home_switch: {from: 1 m, to: 2 m}, negative_limit_switch: {at: -1 m}, positive_limit_switch: {at: 3 m}, \
                        index: {every: 10 mm}";
        warned_with(switches, keys)
    }

    /// Returns the same with these keys in `sim`.
    fn warned_with(fixtures: &str, keys: &str) -> Vec<String> {
        let text = format!(
            "lineshaft: 1\ncycle: 1 ms\nbackends: {{plant: {{type: sim}}}}\nio: {{b: {{type: do, backend: plant, address: 0}}, \
             r: {{type: di, backend: plant, address: 0}}}}\n\
             axes: {{x: {{drive: {{backend: plant, address: 0, interface: position}}, max_velocity: 1 m/s, \
             max_acceleration: 1 m/s^2, sim: {{model: ideal, {fixtures}}}, {keys}}}}}\n"
        );
        warnings(&Cell::parse("c.yaml", text).unwrap_or_else(|problems| panic!("{problems}")))
    }

    const MM: &str = "type: linear, scale: {increments: 1000, per: 1 mm}";

    #[test]
    fn a_search_without_an_end_is_warned_of() {
        let expected = "x: without its switch homing goes on for ever; \
                        give homing.max_distance, min_position and max_position, or homing.max_time";
        for keys in
            ["homing: {method: 7}", "homing: {method: 1}, max_position: 1 m", "homing: {home_type: 0}, i_refswitch: 1"]
        {
            assert_eq!(warned(&format!("{MM}, {keys}")), [expected], "{keys}");
        }
        for keys in [
            "homing: {method: 33}",
            "homing: {method: 35}",
            "homing: {method: 7, max_distance: 1 m}",
            "homing: {method: 7, max_time: 30 s}",
            "homing: {method: 7}, min_position: 0 m, max_position: 1 m",
            "unit: mm",
        ] {
            assert_eq!(warned(&format!("{MM}, {keys}")), [""; 0], "{keys}");
        }
    }

    #[test]
    fn homing_that_ends_outside_the_software_limits_is_warned_of() {
        let limits = "min_position: -50 mm, max_position: 850 mm";
        let warned = |homing: &str| warned(&format!("{MM}, unit: mm, {limits}, i_refswitch: 1, homing: {{{homing}}}"));
        let told = |rest: &str, limit: &str| {
            format!(
                "x: homing ends at about {rest}, which {limit}: the axis is then outside its software limits; \
                 change homing.offset or the limit"
            )
        };
        assert_eq!(warned("method: 1, offset: 55 mm"), [told("-55 mm", "is below min_position -50 mm")]);
        assert_eq!(warned("method: 35, offset: -900 mm"), [told("900 mm", "exceeds max_position 850 mm")]);
        for good in
            ["method: 1, offset: 50 mm", "method: 35, offset: -850 mm", "method: 1", "home_type: 0, home_offset: 90000"]
        {
            assert_eq!(warned(good), [""; 0], "{good}");
        }
    }

    #[test]
    fn homing_that_is_refused_is_warned_of() {
        let expected = "x: homing has no method: a home command that names none is refused (10302); give homing.method";
        for keys in ["velocity: 10 mm/s, index_velocity: 1 mm/s", "offset: 5 mm", "home_vel: 10"] {
            assert_eq!(warned(&format!("{MM}, homing: {{{keys}}}")), [expected], "{keys}");
        }
        for keys in ["required: true", "index_distance: 5 mm", "max_distance: 1 m", "home_type: 2, max_distance: 1 m"] {
            assert_eq!(warned(&format!("{MM}, i_refswitch: 1, homing: {{{keys}}}")), [""; 0], "{keys}");
        }
        assert_eq!(
            warned(&format!("{MM}, homing: {{home_type: 2, max_distance: 1 m}}")),
            [
                "x: home_type 2 needs an input for the reference switch: a home command is refused (10305); give i_refswitch"
            ]
        );
    }

    #[test]
    fn homing_to_a_switch_or_an_index_that_is_not_simulated_is_warned_of() {
        let warned = |fixtures: &str, homing: &str| {
            warned_with(fixtures, &format!("{MM}, homing: {{max_distance: 1 m, {homing}}}"))
        };
        let told =
            |method: i64, what: &str, why: &str| format!("x: homing.method {method} does not find {what}: {why}");
        let none = |key: &str| format!("the simulated axis has none; give sim.{key}");
        let switches = [
            (24, "reference", "home_switch"),
            (17, "negative limit", "negative_limit_switch"),
            (18, "positive limit", "positive_limit_switch"),
        ];
        for (method, switch, key) in switches {
            let expected = told(method, &format!("the {switch} switch"), &none(key));
            assert_eq!(warned("start: 0 m", &format!("method: {method}")), [expected]);
        }
        let index = |method: i64| told(method, "an index pulse", &none("index"));
        assert_eq!(warned("start: 0 m", "method: 33"), [index(33)]);
        let switch = told(7, "the reference switch", &none("home_switch"));
        assert_eq!(warned("start: 0 m", "method: 7"), [switch, index(7)]);
        // A switch that is wired to an input does not read at the drive.
        let wired = "home_switch: {from: 0 m, to: 1 m, input: r}";
        let why = "sim.home_switch is wired to an input that the axis does not read; give i_refswitch";
        assert_eq!(warned(wired, "method: 24"), [told(24, "the reference switch", why)]);
        let read = warned_with(wired, &format!("{MM}, i_refswitch: 1, homing: {{max_distance: 1 m, method: 24}}"));
        assert_eq!(read, [""; 0]);
        assert_eq!(warned("start: 0 m", "method: 35"), [""; 0]);
    }

    #[test]
    fn number_without_a_unit_is_warned_of() {
        let told = warned(&format!("{MM}, unit: mm, max_position: 850, min_position: 0"));
        let end = "max_position: 850 is 850 m; write 850 mm if that is meant";
        assert!(told.len() == 1 && told[0].starts_with("c.yaml:5:") && told[0].ends_with(end), "{told:?}");
    }

    /// Proves: MACS-I2T-04
    #[test]
    fn a_velocity_loop_that_there_is_not_and_a_limit_of_no_current_are_warned_of() {
        let warned = |keys: &str| {
            let text = format!(
                "lineshaft: 1\ncycle: 1 ms\nbackends: {{plant: {{type: sim}}}}\n\
                 axes: {{x: {{drive: {{backend: plant, address: 0, interface: torque, regulator: pid}}, max_velocity: 1 m/s, {MM}, \
                 max_acceleration: 1 m/s^2, max_effort: 1000, torque_constant: 100, kder: 5, {keys}, \
                 sim: {{model: motor, inertia: 1e-4, rated_torque: 1 Nm, counts_per_turn: 4000}}}}}}\n"
            );
            warnings(&Cell::parse("c.yaml", text).unwrap())
        };
        assert_eq!(warned("velkprop: 900"), [""; 0]);
        let expected = ["x: velkprop is 900 and does nothing: with ampmode 2 the axis has no velocity loop"];
        assert_eq!(warned("velkprop: 900, ampmode: 2"), expected);
        let expected = ["x: ampencno is 1 and does nothing: with ampmode 2 the axis has no velocity loop"];
        assert_eq!(warned("ampencno: 1, ampencres: 4000, ampmode: 2"), expected);
        assert_eq!(warned("ampencno: 1, ampencres: 4000"), [""; 0]);
        for keys in ["ampencres: 4000", "ampencrpm: 4000"] {
            let key = &keys[..9];
            let told = format!("x: {key} is 4000 and does nothing: ampencno is -1, the encoder of the position loop");
            assert_eq!(warned(keys), [told]);
        }
        assert_eq!(warned("i2tftime: 500"), ["x: i2tlimit is 0: with i2tftime 500 any current is error 99"]);
        assert_eq!(warned("i2tftime: 500, i2tlimit: 4000"), [""; 0]);
    }

    /// Proves: MACS-AMP-08
    #[test]
    fn a_cap_of_currents_that_nothing_limits_is_warned_of() {
        let warned = |keys: &str| {
            let text = format!(
                "lineshaft: 1\ncycle: 1 ms\nbackends: {{plant: {{type: sim}}}}\n\
                 axes: {{x: {{drive: {{backend: plant, address: 0, interface: voltage, regulator: pid}}, max_velocity: 1 m/s, {MM}, \
                 max_acceleration: 1 m/s^2, max_effort: 1000, torque_constant: 25, {keys}, \
                 sim: {{model: motor, inertia: 1e-4, voltage: 48 V, resistance: 1.2 Ohm, torque_constant: 0.4 Nm/A, \
                 counts_per_turn: 4000}}}}}}\n"
            );
            warnings(&Cell::parse("c.yaml", text).unwrap())
        };
        assert_eq!(warned("full_current: 10, ampmaxcur: 4000, curkprop: 900"), [""; 0]);
        assert_eq!(warned("ampmode: 1"), [""; 0]);
        assert_eq!(
            warned("ampmode: 1, ampmaxcur: 4000"),
            ["x: ampmaxcur is 4000 and does nothing: with ampmode 1 nothing limits the current"]
        );
        assert_eq!(
            warned("ampmode: 3, velkint: 7, curkint: 3, full_current: 2.5"),
            [
                "x: velkint is 7 and does nothing: with ampmode 3 the axis has no velocity loop",
                "x: curkint is 3 and does nothing: with ampmode 3 nothing limits the current",
                "x: full_current is 2.5 and does nothing: with ampmode 3 nothing limits the current",
            ]
        );
    }

    #[test]
    fn gains_that_command_nothing_are_warned_of() {
        let warned = |interface: &str, saia: &str| {
            let text = format!(
                "lineshaft: 1\ncycle: 1 ms\nbackends: {{plant: {{type: sim}}}}\n\
                 axes: {{x: {{drive: {{backend: plant, address: 0, interface: {interface}}}, max_velocity: 1 m/s, {MM}, \
                 max_acceleration: 1 m/s^2, saia: {{{saia}}}}}}}\n"
            );
            warnings(&Cell::parse("c.yaml", text).unwrap())
        };
        let told = |gains: &str| {
            format!(
                "x: no drive hears {gains}: with regulator proportional the axis closes its loop with a gain of its own, and \
                 the regulator of the module only shows in saia.output and saia.integral"
            )
        };
        assert_eq!(warned("velocity", "kprop: 20, kder: -1"), [told("saia.kprop 20, saia.kder -1")]);
        assert_eq!(warned("velocity", "kint: 3"), [told("saia.kint 3")]);
        for (interface, saia) in
            [("velocity", "kprop: 0, kint: 0, kder: 0"), ("velocity", ""), ("position", "kprop: 20")]
        {
            assert_eq!(warned(interface, saia), [""; 0], "{interface} {saia}");
        }
    }

    #[test]
    fn a_brake_that_closes_too_late_is_warned_of() {
        for (reaction, count) in [(0, 1), (1, 1), (2, 0), (3, 0), (4, 0), (5, 0)] {
            let told = warned(&format!("{MM}, brake: {{output: b}}, error_reaction: {reaction}"));
            assert_eq!(told.len(), count, "{reaction}");
            let begin = format!("x: error_reaction {reaction} takes the power before the brake has closed");
            assert!(told.iter().all(|told| told.starts_with(&begin)), "{told:?}");
        }
        assert_eq!(warned(&format!("{MM}, error_reaction: 0")), [""; 0]);
    }

    #[test]
    fn limit_switches_in_crossed_order_are_warned_of() {
        let warned = |negative: i64, positive: i64| {
            let sim = format!("{{at: {negative} mm}}, positive_limit_switch: {{at: {positive} mm}}");
            let text = format!(
                "lineshaft: 1\ncycle: 1 ms\nbackends: {{plant: {{type: sim}}}}\n\
                 axes: {{v: {{type: linear, drive: virtual, scale: {{increments: 1, per: 1 mm}}, max_velocity: 1 m/s, \
                 max_acceleration: 1 m/s^2}}, x: {{type: linear, scale: {{increments: 1000, per: 1 mm}}, \
                 drive: {{backend: plant, address: 0, interface: position}}, max_velocity: 1 m/s, \
                 max_acceleration: 1 m/s^2, sim: {{model: ideal, negative_limit_switch: {sim}}}}}}}\n"
            );
            warnings(&Cell::parse("c.yaml", text).unwrap())
        };
        let crossed = |told: Vec<String>| {
            assert_eq!(told.len(), 1);
            assert!(told[0].starts_with("x: the simulated positive_limit_switch"), "{told:?}");
        };
        crossed(warned(10, -10));
        crossed(warned(10, 10));
        assert_eq!(warned(-10, 10), [""; 0]);
    }

    /// Proves: MACS-LIM-07
    #[test]
    fn a_limit_switch_without_a_wire_is_warned_of() {
        let warned = |keys: &str| {
            let text = format!(
                "lineshaft: 1\ncycle: 1 ms\nbackends: {{plant: {{type: sim}}}}\n\
                 io: {{a: {{type: di, backend: plant, address: 0}}, v: {{type: di, output: b}}, \
                 b: {{type: do, backend: plant, address: 0}}}}\n\
                 axes: {{x: {{drive: {{backend: plant, address: 0, interface: position}}, max_velocity: 1 m/s, \
                 max_acceleration: 1 m/s^2, sim: {{model: ideal}}, {MM}, {keys}}}}}\n"
            );
            warnings(&Cell::parse("c.yaml", text).unwrap())
        };
        let told = |key: &str| {
            format!(
                "x: {key} reads output `b` and no terminal: it acts a cycle later, and only as long as this program does; \
                 a limit switch that protects has a wire"
            )
        };
        assert_eq!(warned("i_poslimitsw: 1, i_neglimitsw: -1, i_refswitch: 2"), [""; 0]);
        let both = warned("i_poslimitsw: 2, i_neglimitsw: -2");
        assert_eq!(both, [told("i_poslimitsw 2"), told("i_neglimitsw -2")]);
    }

    /// Proves: AMK-GEN-18
    #[test]
    fn copy_of_values_onto_a_rotary_axis_without_quantity_is_warned_of() {
        let warned = |axis: &str, function: &str| {
            let text = format!(
                "lineshaft: 1\ncycle: 1 ms\nbackends: {{plant: {{type: sim}}}}\nmemory: {{d: {{type: i32}}}}\n\
                 axes: {{x: {{drive: {{backend: plant, address: 0, interface: position}}, max_velocity: {axis}, \
                 sim: {{model: ideal}}}}}}\nfunctions: {{f: {{slot: 0, sink: x, {function}}}}}\n"
            );
            warnings(&Cell::parse("c.yaml", text).unwrap())
        };
        let rotary = "1 rad/s, max_acceleration: 1 rad/s^2, type: rotary, scale: {increments: 3600, per: 360 deg}";
        let told = "function f: its values are positions of x in increments, and the axis makes each step of them in one cycle; \
                    `quantity: speed` makes them speeds in 0.0001 rpm";
        for function in ["type: ecopy, mode: 3, value_e1_1: 400", "type: ecopy, source: d", "type: dcopy, source: d"] {
            assert_eq!(warned(rotary, function), [told], "{function}");
            assert_eq!(warned(rotary, &format!("{function}, quantity: speed")), [""; 0], "{function}");
            let linear = format!("1 m/s, max_acceleration: 1 m/s^2, {MM}");
            assert_eq!(warned(&linear, function), [""; 0], "{function}");
        }
        for function in ["type: dcopy, source: d, mode: 1", "type: ecopy, source: machine.vmaster"] {
            assert_eq!(warned(rotary, function), [""; 0], "{function}");
        }
    }

    #[test]
    fn one_edge_that_stops_and_unlocks_is_warned_of() {
        let warned = |keys: &str| {
            let text = format!(
                "lineshaft: 1\ncycle: 1 ms\nbackends: {{plant: {{type: sim}}}}\nmachine: {{{keys}}}\n\
                 io: {{a: {{type: di, backend: plant, address: 0}}, b: {{type: di, backend: plant, address: 1}}}}\naxes: {{}}\n"
            );
            warnings(&Cell::parse("c.yaml", text).unwrap())
        };
        let behind = "after a stop the next one unlocks the axes";
        for (number, input, other) in [(-2, 2, 2), (1, 1, -1)] {
            let same = "i_break and i_continue name the same edge of input";
            assert_eq!(
                warned(&format!("i_break: {number}, i_continue: {number}")),
                [format!("{same} {input}: {behind}; {other} is its other edge")]
            );
        }
        for keys in ["i_break: 1, i_continue: -1", "i_break: 1, i_continue: 2", "i_continue: 0, i_break: 0"] {
            assert_eq!(warned(keys), [""; 0], "{keys}");
        }
    }
}
