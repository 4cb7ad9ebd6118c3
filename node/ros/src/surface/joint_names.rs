//! Joint names of the axes.
//!
//! Messages that other packages define name joints: `joint_states`, trajectories, `~/jog`, the robot description and the parameters
//! `constraints.<joint>.*`. Everything else names objects of the cell.

use lineshaft_core::config::MachineConfig;
use lineshaft_core::unit::excerpt;

/// Joint name of each axis, in file order. No axis has the joint name or the object name of another one as its joint name.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct JointNames(Vec<String>);

impl JointNames {
    /// Creates the names, one for each axis in file order.
    pub fn new(names: Vec<String>) -> Self {
        Self(names)
    }

    /// Returns the object names of the axes as joint names, for a cell without a key `joint`.
    pub fn of_objects(config: &MachineConfig) -> Self {
        Self(config.axes.iter().map(|axis| axis.name.clone()).collect())
    }

    /// Returns all joint names, in file order.
    pub fn iter(&self) -> impl Iterator<Item = &str> {
        self.0.iter().map(String::as_str)
    }

    /// Returns the joint name of an axis; empty if the axis does not exist.
    pub fn get(&self, axis: u16) -> &str {
        self.0.get(usize::from(axis)).map_or("", String::as_str)
    }

    /// Returns the index of the axis with this joint name.
    pub fn find(&self, joint: &str) -> Option<u16> {
        let place = self.0.iter().position(|known| known == joint)?;
        u16::try_from(place).ok()
    }

    /// Returns the object names of axes with a different joint name, with that joint name.
    pub fn different_names<'a>(&'a self, config: &'a MachineConfig) -> impl Iterator<Item = (&'a str, &'a str)> {
        let pairs = config.axes.iter().map(|axis| axis.name.as_str()).zip(self.iter());
        pairs.filter(|(object, joint)| object != joint)
    }

    /// Returns the object name of the axis with this joint name, which is in `field` of a message.
    ///
    /// # Errors
    /// No axis has the joint name; the message suggests the intended one, or lists all.
    pub fn object_name_of<'c>(&self, joint: &str, field: &str, config: &'c MachineConfig) -> Result<&'c str, String> {
        if let Some(axis) = self.find(joint).and_then(|axis| config.axes.get(usize::from(axis))) {
            return Ok(&axis.name);
        }
        let meant = self.different_names(config).find(|(object, _)| *object == joint);
        Err(meant.map_or_else(
            || format!("{field} has the joint `{}`; there are {}", excerpt(joint), self.0.join(", ")),
            |(axis, joint)| object_name_refusal(field, axis, joint),
        ))
    }
}

/// Adds the joint name to a message that starts with an axis, if it differs: `axis x (joint Shoulder_Pan): ..`.
pub(super) fn with_joint(sentence: String, axis: &str, joint: &str) -> String {
    match sentence.strip_prefix(axis) {
        Some(rest) if joint != axis => format!("axis {axis} (joint {joint}){rest}"),
        _ => sentence,
    }
}

/// Returns the message that a name in `field` is refused because it is the object name of an axis.
pub(super) fn object_name_refusal(field: &str, axis: &str, joint: &str) -> String {
    format!("{field} has `{axis}`, the object name of an axis; its joint name is `{joint}`")
}

#[cfg(test)]
mod tests {
    use super::super::parameters::fake;
    use super::*;
    use crate::surface::messages::{AxisView, axis_states, joint_states};
    use lineshaft_core::machine::Machine;

    #[test]
    fn without_joint_names_those_of_the_objects_count() {
        let config = fake::config();
        let names = JointNames::of_objects(&config);
        assert!(names.iter().eq(config.axes.iter().map(|axis| axis.name.as_str())));
        assert_eq!(names.different_names(&config).count(), 0);
        assert_eq!(names.object_name_of("x", "joint_names", &config), Ok("x"));
        let sentence = "joint_names has the joint `w`; there are line, x";
        assert_eq!(names.object_name_of("w", "joint_names", &config), Err(sentence.to_owned()));
    }

    #[test]
    fn joint_states_have_joint_names_and_axis_states_have_object_names() {
        let config = fake::config();
        let machine = Machine::new(config.clone()).expect("a sound machine");
        let views = AxisView::all(&config, machine.directory());
        let names = JointNames::new(["line", "left/arm_1"].map(str::to_owned).to_vec());
        assert_eq!(joint_states(&views, &names, machine.board(), 0).name, ["left/arm_1"], "line is virtual");
        let axes = axis_states(&views, machine.board(), 0, 0).axes;
        assert_eq!(axes.iter().map(|axis| axis.name.as_str()).collect::<Vec<_>>(), ["line", "x"]);
    }

    #[test]
    fn a_sentence_has_both_names_where_they_differ() {
        let of = |joint: &str| with_joint("x: done".to_owned(), "x", joint);
        assert_eq!((&*of("x"), &*of("Shoulder_Pan")), ("x: done", "axis x (joint Shoulder_Pan): done"));
        assert_eq!(with_joint("machine: done".to_owned(), "x", "Shoulder_Pan"), "machine: done");
    }

    #[test]
    fn a_joint_name_finds_its_axis_and_an_object_name_is_refused_with_the_right_one() {
        let config = fake::config();
        let names = JointNames::new(["line", "left/arm_1"].map(str::to_owned).to_vec());
        assert_eq!((names.find("left/arm_1"), names.find("x"), names.find("")), (Some(1), None, None));
        assert_eq!((names.get(1), names.get(2)), ("left/arm_1", ""));
        assert_eq!(names.object_name_of("left/arm_1", "joint_names", &config), Ok("x"));
        assert_eq!(names.object_name_of("line", "joint_names", &config), Ok("line"));
        let sentence = "joint_names has `x`, the object name of an axis; its joint name is `left/arm_1`";
        assert_eq!(names.object_name_of("x", "joint_names", &config), Err(sentence.to_owned()));
        assert!(names.different_names(&config).eq([("x", "left/arm_1")]));
    }
}
