//! Axes that one action and one topic move.

use crate::surface::group::{Group, TrajectorySettings};
use crate::surface::joint_names::{JointNames, with_joint};
use crate::surface::messages::AxisView;
use crate::surface::table::Row;
use lineshaft_core::config::MachineConfig;
use lineshaft_core::event::Event;
use lineshaft_core::object::Object;
use lineshaft_core::signal::Directory;
use lineshaft_core::text;

/// Axes of a group, in its order.
#[derive(Clone, Debug)]
pub(in crate::surface) struct Joints {
    /// Name of the group; `None`: all axes with a drive.
    group: Option<String>,
    /// Indices in the cell.
    pub axes: Vec<u16>,
    /// Joint names.
    pub names: Vec<String>,
    /// Object names.
    pub objects: Vec<String>,
    /// Signals.
    pub views: Vec<AxisView>,
    /// Trajectory settings of the cell.
    pub usual: TrajectorySettings,
}

impl Joints {
    /// Returns one for each group; without groups one for all axes with a drive, if there are any.
    pub(in crate::surface) fn all(
        config: &MachineConfig,
        joints: &JointNames,
        directory: &Directory,
        groups: &[Group],
    ) -> Vec<Self> {
        let views = AxisView::all(config, directory);
        let of = |group: Option<&Group>, axes: &[u16]| Self {
            group: group.map(|group| group.name.clone()),
            usual: group.map(|group| group.trajectories).unwrap_or_default(),
            axes: axes.to_vec(),
            names: axes.iter().map(|&axis| joints.get(axis).to_owned()).collect(),
            objects: axes.iter().map(|&axis| config.name(Object::Axis(axis)).to_owned()).collect(),
            views: axes.iter().filter_map(|&axis| views.get(usize::from(axis)).cloned()).collect(),
        };
        if !groups.is_empty() {
            return groups.iter().map(|group| of(Some(group), &group.axes)).collect();
        }
        let driven = config.axes.iter().enumerate().filter(|(_, axis)| axis.drive.is_some());
        let driven: Vec<u16> = driven.map(|(place, _)| place as u16).collect();
        if driven.is_empty() { Vec::new() } else { vec![of(None, &driven)] }
    }

    /// Returns the name of the group; `None`: all axes with a drive.
    pub(in crate::surface) fn group(&self) -> Option<&str> {
        self.group.as_deref()
    }

    /// Returns the prefix of the names of action and topic, in a node with this full name: `/lineshaft`, `/lineshaft/arm`.
    pub(in crate::surface) fn prefix(&self, node: &str) -> String {
        self.group.as_ref().map_or_else(|| node.to_owned(), |group| format!("{node}/{group}"))
    }

    /// Returns the name of a row of the table for these axes: `~/follow_joint_trajectory`, `~/arm/follow_joint_trajectory`.
    pub(super) fn name_of(&self, row: &Row) -> String {
        match (&self.group, row.name.strip_prefix("~/")) {
            (Some(group), Some(name)) => format!("~/{group}/{name}"),
            _ => row.name.to_owned(),
        }
    }

    /// Returns the name of a node parameter for these axes: `trajectory_limits.margin`, `arm.trajectory_limits.margin`.
    pub(super) fn parameter(&self, name: &str) -> String {
        match &self.group {
            Some(group) => format!("{group}.{name}"),
            None => name.to_owned(),
        }
    }

    /// Returns the same joints as a group with this name.
    #[cfg(test)]
    pub(super) fn of_group(self, name: &str, usual: TrajectorySettings) -> Self {
        Self { group: Some(name.to_owned()), usual, ..self }
    }

    /// Returns the joint name of the axis with this object name, if the two differ.
    pub(super) fn joint_name_of(&self, object: &str) -> Option<&str> {
        let place = self.objects.iter().position(|known| known == object)?;
        self.names.get(place).map(String::as_str).filter(|joint| *joint != object)
    }

    /// Returns the message of the machine about the end of a goal. An axis with a separate joint name has both names in it.
    pub(super) fn sentence(&self, event: &Event, config: &MachineConfig) -> String {
        let sentence = text::message(event, config);
        let object = config.name(event.source);
        with_joint(sentence, object, self.joint_name_of(object).unwrap_or(object))
    }

    /// Returns the index of a joint in the group.
    pub(super) fn place(&self, name: &str) -> Option<usize> {
        self.names.iter().position(|joint| joint == name)
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{config, joint_names, joints_called};
    use super::*;
    use crate::surface::table;
    use lineshaft_core::code::Code;
    use lineshaft_core::event::{Kind, Severity};
    use lineshaft_core::machine::Machine;

    fn all(groups: &[Group]) -> Vec<Joints> {
        let config = config();
        let machine = Machine::new(config.clone()).expect("a sound machine");
        Joints::all(&config, &joint_names(), machine.directory(), groups)
    }

    #[test]
    fn without_groups_all_axes_with_a_drive_have_one_action() {
        let all = all(&[]);
        assert_eq!(all.len(), 1);
        assert_eq!(all[0].names, ["x", "y"], "line is virtual");
        assert_eq!(all[0].axes, [1, 2]);
        assert_eq!(all[0].name_of(&table::FOLLOW_JOINT_TRAJECTORY.0), "~/follow_joint_trajectory");
    }

    /// Returns other joint names for line, x and y.
    fn renamed() -> JointNames {
        JointNames::new(["line", "Shoulder_Pan", "left/arm_1"].map(str::to_owned).to_vec())
    }

    #[test]
    fn joints_have_the_joint_names_of_their_axes() {
        let config = config();
        let machine = Machine::new(config.clone()).expect("a sound machine");
        let (name, axes, trajectories) = ("arm".to_owned(), vec![2, 1], TrajectorySettings::default());
        let groups = [Group { name, axes, trajectories, gripper: None }];
        let joints = Joints::all(&config, &renamed(), machine.directory(), &groups).remove(0);
        assert_eq!(
            (&joints.names[..], &joints.objects[..]),
            (&["left/arm_1", "Shoulder_Pan"].map(str::to_owned)[..], &["y", "x"].map(str::to_owned)[..])
        );
        assert_eq!((joints.place("Shoulder_Pan"), joints.place("x")), (Some(1), None));
        assert_eq!(
            (joints.joint_name_of("x"), joints.joint_name_of("line"), joints.joint_name_of("left/arm_1")),
            (Some("Shoulder_Pan"), None, None)
        );
    }

    #[test]
    fn the_sentence_of_an_end_has_both_names_where_they_differ() {
        let event = |source| Event::new(Severity::Warn, Kind::Done, source, Code::REPLACED);
        let config = config();
        let (plain, both) = (joints_called(&joint_names()), joints_called(&renamed()));
        for (source, is_both) in [(Object::Axis(1), true), (Object::Axis(0), false), (Object::Machine, false)] {
            let usual = text::message(&event(source), &config);
            assert_eq!(plain.sentence(&event(source), &config), usual);
            let expected = if is_both { usual.replacen("x: ", "axis x (joint Shoulder_Pan): ", 1) } else { usual };
            assert_eq!(both.sentence(&event(source), &config), expected);
        }
    }

    #[test]
    fn each_group_has_its_own_in_its_order() {
        let group = |name: &str, axes: &[u16]| Group {
            name: name.to_owned(),
            axes: axes.to_vec(),
            trajectories: TrajectorySettings::default(),
            gripper: None,
        };
        let all = all(&[group("arm", &[2, 1]), group("hand", &[1])]);
        assert_eq!(all.iter().map(|joints| joints.names.clone()).collect::<Vec<_>>(), [vec!["y", "x"], vec!["x"]]);
        assert_eq!(all[0].name_of(&table::FOLLOW_JOINT_TRAJECTORY.0), "~/arm/follow_joint_trajectory");
        assert_eq!(all[1].name_of(&table::JOINT_TRAJECTORY.0), "~/hand/joint_trajectory");
        assert_eq!((all[0].place("x"), all[1].place("y")), (Some(1), None));
        assert_eq!(all[0].parameter("trajectory_limits.margin"), "arm.trajectory_limits.margin");
    }
}
