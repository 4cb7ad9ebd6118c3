//! Kinds of starters, with their files in launch-configs.
//!
//! A starter in launch-configs/new refers to itself by its kind, `gear.yaml`; in one that is based on another example,
//! the names of that example are replaced.

/// Files that `lineshaft new` writes for one kind.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StarterKind {
    /// Name of the kind.
    pub(crate) name: &'static str,
    /// One-line description.
    pub(crate) help: &'static str,
    /// Files: suffix after the name of the cell, and text. The cell is first, the scenario second.
    pub(crate) files: &'static [(&'static str, &'static str)],
    /// Texts in the files that name other files, and their replacements; `NAME` is the name of the cell.
    pub(super) replaced: &'static [(&'static str, &'static str)],
    /// Whether the cell has real drives, so that it is tested with `run --sim`.
    pub(crate) is_real: bool,
}

/// File name suffix of a cell.
pub(super) const CELL: &str = ".yaml";
/// File name suffix of a scenario.
pub(super) const SCENARIO: &str = ".scenario.yaml";

/// Text of a file of launch-configs.
macro_rules! example {
    ($path:literal) => {
        include_str!(concat!("../../../launch-configs/", $path))
    };
}

/// Returns a kind whose files are in launch-configs/new.
const fn simulated(
    name: &'static str,
    help: &'static str,
    files: &'static [(&'static str, &'static str)],
    replaced: &'static [(&'static str, &'static str)],
) -> StarterKind {
    StarterKind { name, help, files, replaced, is_real: false }
}

/// All kinds; the first one is the default.
pub(crate) static KINDS: [StarterKind; 9] = [
    simulated(
        "demo",
        "four simulated axes to try everything: a line shaft, two linear axes, a turntable",
        &[
            (CELL, example!("demo.yaml")),
            (SCENARIO, example!("new/demo.scenario.yaml")),
            (".urdf", example!("demo.urdf")),
        ],
        &[
            ("demo.scenario.yaml", "NAME.scenario.yaml"),
            ("demo.yaml", "NAME.yaml"),
            ("demo.mcap", "NAME.mcap"),
            ("demo.svg", "NAME.svg"),
            ("# robot_description: demo.urdf", "robot_description: NAME.urdf"),
        ],
    ),
    StarterKind {
        name: "can",
        help: "a CiA 402 drive on a CAN bus, rehearsed in simulation first",
        files: &[(CELL, example!("can/drive.yaml")), (SCENARIO, example!("can/first_move.scenario.yaml"))],
        replaced: &[
            ("launch-configs/can/drive.yaml", "NAME.yaml"),
            ("launch-configs/can/first_move.scenario.yaml", "NAME.scenario.yaml"),
        ],
        is_real: true,
    },
    simulated(
        "gantry",
        "an axis with two motors that homing squares",
        &[(CELL, example!("new/gantry.yaml")), (SCENARIO, example!("new/gantry.scenario.yaml"))],
        &[("gantry.scenario.yaml", "NAME.scenario.yaml"), ("gantry.yaml", "NAME.yaml")],
    ),
    simulated(
        "cam",
        "an electronic cam: a knife that runs with its web, with the table and its description",
        &[
            (CELL, example!("new/cam.yaml")),
            (SCENARIO, example!("new/cam.scenario.yaml")),
            (".table.yaml", example!("new/cam.table.yaml")),
            (".csv", example!("new/cam.csv")),
        ],
        &[
            ("cam.scenario.yaml", "NAME.scenario.yaml"),
            ("cam.table.yaml", "NAME.table.yaml"),
            ("cam.yaml", "NAME.yaml"),
            ("cam.csv", "NAME.csv"),
            ("cam.svg", "NAME.svg"),
        ],
    ),
    simulated(
        "gear",
        "a line shaft: two rollers follow a virtual axis by electronic gears",
        &[(CELL, example!("new/gear.yaml")), (SCENARIO, example!("new/gear.scenario.yaml"))],
        &[("gear.scenario.yaml", "NAME.scenario.yaml"), ("gear.yaml", "NAME.yaml")],
    ),
    simulated(
        "register",
        "print marks: labels that correct themselves from mark to mark",
        &[(CELL, example!("new/register.yaml")), (SCENARIO, example!("new/register.scenario.yaml"))],
        &[("register.scenario.yaml", "NAME.scenario.yaml"), ("register.yaml", "NAME.yaml")],
    ),
    simulated(
        "arm6",
        "an arm of six axes for MoveIt, with its URDF",
        &[
            (CELL, example!("arm6/arm6.yaml")),
            (SCENARIO, example!("new/arm6.scenario.yaml")),
            (".urdf", example!("arm6/arm6.urdf")),
        ],
        &[
            ("launch-configs/arm6/arm6.yaml", "NAME.yaml"),
            ("arm6.scenario.yaml", "NAME.scenario.yaml"),
            ("arm6.yaml", "NAME.yaml"),
            ("arm6.urdf", "NAME.urdf"),
        ],
    ),
    simulated(
        "function",
        "function slots: two rollers, one with a ratio that an input switches",
        &[(CELL, example!("new/function.yaml")), (SCENARIO, example!("new/function.scenario.yaml"))],
        &[("function.scenario.yaml", "NAME.scenario.yaml"), ("function.yaml", "NAME.yaml")],
    ),
    simulated(
        "winder",
        "a function slot with tables: a roll that follows the speed of its line",
        &[(CELL, example!("new/winder.yaml")), (SCENARIO, example!("new/winder.scenario.yaml"))],
        &[("winder.scenario.yaml", "NAME.scenario.yaml"), ("winder.yaml", "NAME.yaml")],
    ),
];

impl StarterKind {
    /// Returns the kind with that name, ignoring case.
    pub(crate) fn find(name: &str) -> Option<&'static Self> {
        KINDS.iter().find(|kind| kind.name.eq_ignore_ascii_case(name))
    }

    /// Returns a text of the kind for a cell with that name.
    pub(super) fn text_for(&self, text: &str, name: &str) -> String {
        // Replaces all names in one pass, so that an inserted name is not replaced again.
        let (mut made, mut rest) = (String::with_capacity(text.len()), text);
        let next = |rest: &str| {
            let found = self.replaced.iter().filter_map(|&(from, to)| Some((rest.find(from)?, from, to)));
            // Of names that begin at the same place, the longest one is replaced.
            found.min_by_key(|(at, from, _)| (*at, std::cmp::Reverse(from.len())))
        };
        while let Some((at, from, to)) = next(rest) {
            made.push_str(&rest[..at]);
            made.push_str(&to.replace("NAME", name));
            rest = &rest[at + from.len()..];
        }
        made + rest
    }
}
