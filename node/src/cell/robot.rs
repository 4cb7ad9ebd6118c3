//! Reads the robot description: a URDF file that `ros: {robot_description: FILE}` names.
//!
//! ROS tools get the file unchanged. It is checked for errors that would make them fail later: it must be XML, a URDF,
//! and expanded. Its joints are compared with the axes, which move them by name through joint_states.

use crate::document::{Place, Problems};
use lineshaft_core::config::{AxisConfig, MachineConfig};
use lineshaft_core::unit::{ScaleKind, excerpt};
use lineshaft_ros::layer::open_file;
use lineshaft_ros::surface::JointNames;
use roxmltree::{Document, Node, TextPos};
use std::collections::BTreeSet;
use std::io::Read;
use std::path::Path;

/// Maximum size of a file, in bytes: a description is text, and meshes are separate files.
const MAX_BYTES: usize = 1 << 20;
/// Relative difference of two limits that counts as rounding.
const ROUNDING: f64 = 1e-6;
/// Joint types of URDF, with their use of limits.
const TYPES: [(&str, Kind); 6] = [
    ("revolute", Kind::Revolute),
    ("continuous", Kind::Continuous),
    ("prismatic", Kind::Prismatic),
    ("fixed", Kind::Unmoved),
    ("floating", Kind::Unmoved),
    ("planar", Kind::Unmoved),
];

/// A valid robot description.
#[derive(Clone, Debug, PartialEq)]
pub struct Robot {
    /// Text of the file.
    pub text: String,
    joints: Vec<Joint>,
}

/// A joint that joint_states can move.
#[derive(Clone, Debug, PartialEq)]
struct Joint {
    name: String,
    kind: Kind,
    /// Minimum and maximum position, in m or rad.
    range: Option<[f64; 2]>,
    /// Maximum velocity, in m/s or rad/s.
    velocity: Option<f64>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Revolute,
    Continuous,
    Prismatic,
    /// Not movable by one number.
    Unmoved,
}

impl Robot {
    /// Reads a file.
    ///
    /// # Errors
    /// Returns the errors with line and column.
    pub(super) fn load(path: &Path) -> Result<Self, Problems> {
        let name = path.display().to_string();
        let failed = |sentence: String| {
            let problems = Problems::new(&name);
            problems.push(Place::START, sentence, None);
            Err(problems)
        };
        let mut bytes = Vec::new();
        match open_file(path).and_then(|file| file.take(MAX_BYTES as u64 + 1).read_to_end(&mut bytes)) {
            Err(error) => failed(format!("robot_description: cannot read the file: {error}")),
            Ok(length) if length > MAX_BYTES => failed(format!("the file is longer than {MAX_BYTES} bytes")),
            Ok(_) => match String::from_utf8(bytes) {
                Ok(text) => Self::parse(&name, text),
                Err(_) => failed("the file is not UTF-8 text".to_owned()),
            },
        }
    }

    /// Reads a text; `name` is the file name in problems.
    ///
    /// # Errors
    /// Returns the errors with line and column.
    pub(super) fn parse(name: &str, text: String) -> Result<Self, Problems> {
        let problems = Problems::new(name);
        let joints = match Document::parse(&text) {
            Ok(document) => Reader { document: &document, problems: &problems }.joints(),
            Err(roxmltree::Error::UnknownNamespace(prefix, at)) if prefix == "xacro" => {
                problems.push(place(at), XACRO, Some(expand(name)));
                Vec::new()
            }
            Err(error) => {
                let sentence = error.to_string();
                let sentence = sentence.strip_suffix(&format!(" at {}", error.pos())).unwrap_or(&sentence);
                problems.push(place(error.pos()), format!("not valid XML: {}", excerpt(sentence)), None);
                Vec::new()
            }
        };
        if problems.is_empty() { Ok(Self { text, joints }) } else { Err(problems) }
    }

    /// Returns a message for each mismatch of the description and the axes. None of them prevents the machine from
    /// running.
    pub fn warnings(&self, config: &MachineConfig, names: &JointNames) -> Vec<String> {
        self.joints.iter().flat_map(|joint| joint.warnings(config, names)).collect()
    }
}

const XACRO: &str = "the file is a xacro; a URDF is needed";

fn expand(name: &str) -> String {
    format!("`xacro {name} > robot.urdf` makes one")
}

fn place(at: TextPos) -> Place {
    Place { line: at.row as usize, col: at.col as usize }
}

/// Reads the XML tree of a file.
struct Reader<'a> {
    document: &'a Document<'a>,
    problems: &'a Problems,
}

impl Reader<'_> {
    fn refuse(&self, at: usize, sentence: String) {
        self.problems.push(place(self.document.text_pos_at(at)), sentence, None);
    }

    fn joints(&self) -> Vec<Joint> {
        let root = self.document.root_element();
        // An expanded file may still declare the namespace.
        let xacro = |node: &Node<'_, '_>| node.tag_name().namespace().is_some_and(|space| space.contains("xacro"));
        if let Some(node) = self.document.descendants().find(xacro) {
            self.refuse(node.range().start, XACRO.to_owned());
            return Vec::new();
        }
        if root.tag_name().name() != "robot" {
            let name = excerpt(root.tag_name().name());
            self.refuse(root.range().start, format!("the file begins with <{name}>; a URDF begins with <robot>"));
            return Vec::new();
        }
        let mut names = BTreeSet::new();
        let joints = root.children().filter(|node| node.has_tag_name("joint"));
        joints.filter_map(|node| self.joint(node, &mut names)).collect()
    }

    /// Returns a joint if it moves independently and by one number.
    fn joint(&self, node: Node<'_, '_>, names: &mut BTreeSet<String>) -> Option<Joint> {
        let start = node.range().start;
        let Some(name) = node.attribute("name").filter(|name| !name.is_empty()) else {
            self.refuse(start, "a joint has no name".to_owned());
            return None;
        };
        if !names.insert(name.to_owned()) {
            self.refuse(start, format!("two joints are called `{}`", excerpt(name)));
            return None;
        }
        let given = node.attribute("type").unwrap_or_default();
        let Some((_, kind)) = TYPES.into_iter().find(|(known, _)| *known == given) else {
            let allowed = TYPES.map(|(known, _)| known).join(", ");
            self.refuse(start, format!("joint {}: type is `{}`; {allowed} are allowed", excerpt(name), excerpt(given)));
            return None;
        };
        let child = |tag: &str| node.children().find(|node| node.has_tag_name(tag));
        if kind == Kind::Unmoved || child("mimic").is_some() {
            return None;
        }
        let limit = child("limit");
        let number = |attribute: &str| self.number(name, limit?, attribute);
        let velocity = number("velocity");
        if kind == Kind::Continuous {
            return Some(Joint { name: name.to_owned(), kind, range: None, velocity });
        }
        if limit.is_none() {
            let sentence = format!(
                "joint {}: a {given} joint needs <limit lower=.. upper=.. velocity=.. effort=../>",
                excerpt(name)
            );
            self.refuse(start, sentence);
        }
        let range = limit.map(|_| [number("lower").unwrap_or(0.0), number("upper").unwrap_or(0.0)]);
        Some(Joint { name: name.to_owned(), kind, range, velocity })
    }

    fn number(&self, joint: &str, node: Node<'_, '_>, attribute: &str) -> Option<f64> {
        let given = node.attribute_node(attribute)?;
        let number = given.value().trim().parse().ok().filter(|number: &f64| number.is_finite());
        if number.is_none() {
            let (joint, value) = (excerpt(joint), excerpt(given.value()));
            self.refuse(given.range().start, format!("joint {joint}: {attribute} is `{value}`; a number is expected"));
        }
        number
    }
}

impl Joint {
    fn warnings(&self, config: &MachineConfig, names: &JointNames) -> Vec<String> {
        let moved = names.find(&self.name).and_then(|axis| config.axes.get(usize::from(axis)));
        let Some(axis) = moved else {
            let renamed = names.different_names(config).find(|(object, _)| *object == self.name);
            let why = renamed.map_or("no axis has that name".to_owned(), |(axis, joint)| {
                format!("the joint name of axis {axis} is {joint}")
            });
            return vec![format!("robot_description: joint {}: {why}, so nothing moves it", excerpt(&self.name))];
        };
        let (name, of) = (&self.name, &axis.name);
        if axis.drive.is_none() {
            return vec![format!("robot_description: joint {name}: axis {of} is virtual: joint_states leave it out")];
        }
        let is_linear = axis.scale.kind() == ScaleKind::Linear;
        if is_linear != (self.kind == Kind::Prismatic) {
            let (joint, axis) = if is_linear { ("turns", "linear") } else { ("is prismatic", "rotary") };
            return vec![format!("robot_description: joint {name} {joint}, and axis {of} is {axis}")];
        }
        let mut warnings = Vec::new();
        let mut beyond = |what: &str, joint: f64, key: &str, axis: f64| {
            let begin = format!("robot_description: joint {name}: {what} is {joint}, and axis {of} has {key} {axis}");
            let end =
                if key == "max_velocity" { "take longer, or are refused (trajectory_limits)" } else { "are refused" };
            warnings.push(format!("{begin} in SI: plans between them {end}"));
        };
        let mut unlimited = Vec::new();
        if let Some([lower, upper]) = self.range {
            let [least, most] = positions(axis);
            let ends = [("lower", lower, "min_position", least, -1.0), ("upper", upper, "max_position", most, 1.0)];
            for (what, joint, key, limit, outwards) in ends {
                match limit {
                    Some(limit) if (joint - limit) * outwards > ROUNDING => beyond(what, joint, key, limit),
                    Some(limit) if (limit - joint) * outwards <= ROUNDING => {}
                    limit => {
                        let has = limit.map_or(format!("no {key}"), |limit| format!("{key} {limit} in SI"));
                        unlimited.push(format!(
                            "robot_description: joint {name}: {what} is {joint}, and axis {of} has {has}: the axis may go further than \
                             the joint"
                        ));
                    }
                }
            }
        }
        let most = axis.scale.rate_to_si(axis.parameters.max_velocity);
        if let Some(velocity) = self.velocity.filter(|velocity| *velocity > most * (1.0 + ROUNDING)) {
            beyond("velocity", velocity, "max_velocity", most);
        }
        warnings.append(&mut unlimited);
        warnings
    }
}

/// Returns the software limits, in m or rad.
fn positions(axis: &AxisConfig) -> [Option<f64>; 2] {
    let parameters = &axis.parameters;
    [parameters.min_position, parameters.max_position].map(|limit| Some(axis.scale.position_to_si(limit?, 0.0)))
}

#[cfg(test)]
mod tests {
    use super::super::Cell;
    use super::*;

    fn said(text: &str) -> String {
        Robot::parse("r.urdf", text.to_owned()).unwrap_err().to_string()
    }

    fn warnings(joints: &str) -> Vec<String> {
        let robot = Robot::parse("r.urdf", format!("<robot name='r'>{joints}</robot>")).unwrap();
        let cell = Cell::demo();
        robot.warnings(&cell.machine, &cell.joint_names)
    }

    #[test]
    fn the_demo_is_a_drawing_of_its_cell() {
        let cell = Cell::demo();
        let robot = cell.robot.unwrap();
        assert_eq!(robot.joints.iter().map(|joint| joint.name.as_str()).collect::<Vec<_>>(), ["x", "y", "turret"]);
        assert_eq!(robot.warnings(&cell.machine, &cell.joint_names), Vec::<String>::new());
        // The limits are equal to those of the cell, not just within them.
        let x = &cell.machine.axes[1];
        let [Some(least), Some(most)] = positions(x) else { panic!("x has limits") };
        let [lower, upper] = robot.joints[0].range.unwrap();
        assert!((lower - least).abs() < ROUNDING && (upper - most).abs() < ROUNDING);
    }

    #[test]
    fn what_is_no_urdf_is_refused_with_its_place() {
        assert_eq!(
            said("<robot name='r'>\n  <link></joint>\n</robot>"),
            "r.urdf:2:9: not valid XML: expected 'link' tag, not 'joint'\n"
        );
        assert!(said("").starts_with("r.urdf:1:1: not valid XML: "), "{}", said(""));
        assert_eq!(
            said("\n<sdf version='1.7'/>"),
            "r.urdf:2:1: the file begins with <sdf>; a URDF begins with <robot>\n"
        );
        assert!(said("<!DOCTYPE r [<!ENTITY a 'b'>]><robot/>").starts_with("r.urdf:1:1: not valid XML: "));
    }

    #[test]
    fn a_xacro_is_refused_and_its_traces_are_not() {
        let space = "xmlns:xacro='http://www.ros.org/wiki/xacro'";
        let sentence = "the file is a xacro; a URDF is needed";
        assert_eq!(
            said(&format!("<robot {space}>\n<xacro:property name='l' value='1'/></robot>")),
            format!("r.urdf:2:1: {sentence}\n")
        );
        let undeclared = said("<robot>\n<xacro:include filename='a'/></robot>");
        assert!(
            undeclared.starts_with(&format!("r.urdf:2:2: {sentence}, `xacro r.urdf > robot.urdf`")),
            "{undeclared}"
        );
        assert!(Robot::parse("r.urdf", format!("<robot {space}><link name='l'/></robot>")).is_ok());
    }

    #[test]
    fn joints_that_tools_would_refuse_are_refused_all_at_once() {
        let text = "<robot name='r'>
<joint type='fixed'/>
<joint name='a' type='prismatic'/>
<joint name='a' type='fixed'/>
<joint name='b' type='slider'/>
<joint name='c' type='revolute'><limit lower='${-pi}' upper='1e999' velocity='1'/></joint>
</robot>";
        assert_eq!(
            said(text),
            "r.urdf:2:1: a joint has no name\n\
             r.urdf:3:1: joint a: a prismatic joint needs <limit lower=.. upper=.. velocity=.. effort=../>\n\
             r.urdf:4:1: two joints are called `a`\n\
             r.urdf:5:1: joint b: type is `slider`; revolute, continuous, prismatic, fixed, floating, planar are allowed\n\
             r.urdf:6:40: joint c: lower is `${-pi}`; a number is expected\n\
             r.urdf:6:55: joint c: upper is `1e999`; a number is expected\n"
        );
    }

    #[test]
    fn joints_are_compared_with_the_axes_of_their_joint_names() {
        let limit = "<limit lower='-0.06' upper='0.85' velocity='1.2' effort='1'/>";
        let joints = format!(
            "<joint name='Slide_X' type='prismatic'>{limit}</joint><joint name='x' type='prismatic'>{limit}</joint>\
             <joint name='turret' type='prismatic'>{limit}</joint>"
        );
        let robot = Robot::parse("r.urdf", format!("<robot name='r'>{joints}</robot>")).unwrap();
        let text = Cell::demo().text.replacen("\n  x:\n", "\n  x:\n    joint: Slide_X\n", 1);
        let cell = Cell::parse("c", text).unwrap();
        assert_eq!(
            robot.warnings(&cell.machine, &cell.joint_names),
            [
                "robot_description: joint Slide_X: lower is -0.06, and axis x has min_position -0.05 in SI: plans between them \
                 are refused",
                "robot_description: joint x: the joint name of axis x is Slide_X, so nothing moves it",
                "robot_description: joint turret is prismatic, and axis turret is rotary",
            ]
        );
    }

    #[test]
    fn joints_that_do_not_match_the_axes_are_reported() {
        let limit = |lower: f64, upper: f64, velocity: f64| {
            format!("<limit lower='{lower}' upper='{upper}' velocity='{velocity}' effort='1'/>")
        };
        let joint =
            |name: &str, kind: &str, inside: &str| format!("<joint name='{name}' type='{kind}'>{inside}</joint>");
        assert_eq!(
            warnings(&joint("z", "continuous", "")),
            ["robot_description: joint z: no axis has that name, so nothing moves it"]
        );
        assert_eq!(
            warnings(&joint("line", "prismatic", &limit(0.0, 1.0, 1.0))),
            ["robot_description: joint line: axis line is virtual: joint_states leave it out"]
        );
        assert_eq!(
            warnings(&(joint("x", "continuous", "") + &joint("turret", "prismatic", &limit(0.0, 1.0, 1.0)))),
            [
                "robot_description: joint x turns, and axis x is linear",
                "robot_description: joint turret is prismatic, and axis turret is rotary"
            ]
        );
        // x: -0.05 m to 0.85 m, 1.2 m/s.
        assert_eq!(warnings(&joint("x", "prismatic", &limit(-0.05, 0.85, 1.2))), Vec::<String>::new());
        let told = warnings(&joint("x", "prismatic", &limit(-0.06, 0.86, 1.3)));
        let starts = ["lower is -0.06, and axis x has min_position -0.05", "upper is 0.86", "velocity is 1.3"];
        assert_eq!(told.len(), 3, "{told:?}");
        for (told, start) in told.iter().zip(starts) {
            assert!(told.starts_with(&format!("robot_description: joint x: {start}")), "{told}");
        }
        // The axis may have a larger range: the joint is narrower, or the axis has no limit.
        assert_eq!(
            warnings(&joint("x", "prismatic", &limit(-0.05, 0.8, 1.2))),
            [
                "robot_description: joint x: upper is 0.8, and axis x has max_position 0.85 in SI: the axis may go further than the joint"
            ]
        );
        let told = warnings(&joint("turret", "revolute", &limit(-3.0, 3.0, 1.0)));
        assert_eq!(
            told,
            [("lower", "-3", "min"), ("upper", "3", "max")].map(|(what, value, end)| format!(
                "robot_description: joint turret: {what} is {value}, and axis turret has no {end}_position: the axis may go further \
                 than the joint"
            ))
        );
        // None of these moves independently.
        let others =
            joint("a", "fixed", "") + &joint("b", "floating", "") + &joint("c", "revolute", "<mimic joint='x'/>");
        assert_eq!(warnings(&others), Vec::<String>::new());
        // A joint of a transmission is no joint of the robot.
        assert_eq!(warnings("<transmission><joint name='q'/></transmission>"), Vec::<String>::new());
    }
}
