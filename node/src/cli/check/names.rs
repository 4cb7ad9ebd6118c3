//! Finds names that YAML 1.1 reads as another value than a text: `on` is true there. PyYAML and the tools of ROS, which
//! use it, read YAML 1.1; cells are YAML 1.2.
//!
//! Law      `y` and `n` are not among them: PyYAML reads them as texts, and `y` is the usual name of an axis

use crate::cell::Cell;

/// Names that YAML 1.1 reads as true, false or null.
const VALUES: [(&str, &str); 7] = [
    ("on", "true"),
    ("yes", "true"),
    ("true", "true"),
    ("off", "false"),
    ("no", "false"),
    ("false", "false"),
    ("null", "no value"),
];

/// Returns one warning for each such name.
pub(super) fn judge(cell: &Cell) -> Vec<String> {
    let machine = &cell.machine;
    let axes = machine.axes.iter().map(|axis| ("axis", axis.name.as_str()));
    let joints = cell.joint_names.different_names(machine).map(|(_, joint)| ("joint", joint));
    let io = machine.io.iter().map(|io| ("input or output", io.name.as_str()));
    let memory = machine.memory.iter().map(|memory| ("memory cell", memory.name.as_str()));
    let encoders = machine.encoders.iter().map(|encoder| ("encoder", encoder.name.as_str()));
    let tables = machine.tables.iter().map(|table| ("table", table.name.as_str()));
    let programs = machine.programs.iter().map(|program| ("program", program.name.as_str()));
    let functions = machine.slots.iter().map(|slot| ("function", slot.name.as_str()));
    let masters = machine.masters.iter().map(|master| ("master", master.name.as_str()));
    let groups = cell.groups.iter().map(|group| ("group", group.name.as_str()));
    let backends = cell.backends.iter().map(|backend| ("backend", backend.name.as_str()));
    let names = axes.chain(joints).chain(io).chain(memory).chain(encoders).chain(tables).chain(programs);
    let names = names.chain(functions).chain(masters).chain(groups).chain(backends);
    names.filter_map(|(what, name)| warning(what, name)).collect()
}

fn warning(what: &str, name: &str) -> Option<String> {
    let (_, value) = VALUES.iter().find(|(word, _)| name.eq_ignore_ascii_case(word))?;
    Some(format!("{what} {name}: PyYAML and tools of ROS read the name without quotes as {value}; choose another name"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_that_are_values_in_yaml_1_1_are_warned_of() {
        let axis = "type: linear, drive: virtual, scale: {increments: 1000, per: 1 mm}, max_velocity: 1 m/s, max_acceleration: 1 m/s^2";
        let driven = axis.replace("virtual", "{backend: plant, address: 0, interface: position}");
        let text = format!(
            "lineshaft: 1\ncycle: 1 ms\nbackends: {{plant: {{type: sim}}}}\nmemory: {{yes: {{type: bit}}, n: {{type: bit}}}}\naxes:\n  on: {{{axis}}}\n  \
             y: {{joint: \"Null\", {driven}}}\ngroups: {{off: [y]}}\n"
        );
        let cell = Cell::parse("c.yaml", text).unwrap_or_else(|problems| panic!("{problems}"));
        let warned = |what: &str, value: &str| {
            format!("{what}: PyYAML and tools of ROS read the name without quotes as {value}; choose another name")
        };
        let expected = [
            warned("axis on", "true"),
            warned("joint Null", "no value"),
            warned("memory cell yes", "true"),
            warned("group off", "false"),
        ];
        assert_eq!(judge(&cell), expected);
        assert_eq!(judge(&Cell::demo()), [""; 0]);
    }
}
