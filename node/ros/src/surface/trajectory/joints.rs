//! The axes that one action and one topic move.

use crate::surface::group::{Group, TrajectorySettings};
use crate::surface::messages::AxisView;
use crate::surface::table::Row;
use lineshaft_core::config::MachineConfig;
use lineshaft_core::signal::Directory;

/// The axes of a group, in its order.
#[derive(Clone, Debug)]
pub(super) struct Joints {
    /// Name of the group; none: all axes that have a drive.
    group: Option<String>,
    /// Their places in the cell.
    pub axes: Vec<u16>,
    /// Their names.
    pub names: Vec<String>,
    /// Their signals.
    pub views: Vec<AxisView>,
    /// How their trajectories are taken, by the cell.
    pub usual: TrajectorySettings,
}

impl Joints {
    /// One for each group; without groups one for all axes that have a drive, if there are any.
    pub(super) fn all(config: &MachineConfig, directory: &Directory, groups: &[Group]) -> Vec<Self> {
        let views = AxisView::all(config, directory);
        let of = |group: Option<&Group>, axes: &[u16]| Self {
            group: group.map(|group| group.name.clone()),
            usual: group.map(|group| group.trajectories).unwrap_or_default(),
            axes: axes.to_vec(),
            names: axes.iter().filter_map(|&axis| Some(config.axes.get(usize::from(axis))?.name.clone())).collect(),
            views: axes.iter().filter_map(|&axis| views.get(usize::from(axis)).cloned()).collect(),
        };
        if !groups.is_empty() {
            return groups.iter().map(|group| of(Some(group), &group.axes)).collect();
        }
        let driven = config.axes.iter().enumerate().filter(|(_, axis)| axis.drive.is_some());
        let driven: Vec<u16> = driven.map(|(place, _)| place as u16).collect();
        if driven.is_empty() { Vec::new() } else { vec![of(None, &driven)] }
    }

    /// What a row of the table is called for these axes: `~/follow_joint_trajectory`, `~/arm/follow_joint_trajectory`.
    pub(super) fn name_of(&self, row: &Row) -> String {
        match (&self.group, row.name.strip_prefix("~/")) {
            (Some(group), Some(name)) => format!("~/{group}/{name}"),
            _ => row.name.to_owned(),
        }
    }

    /// What a parameter of the node is called for these axes: `trajectory_limits.margin`, `arm.trajectory_limits.margin`.
    pub(super) fn parameter(&self, name: &str) -> String {
        match &self.group {
            Some(group) => format!("{group}.{name}"),
            None => name.to_owned(),
        }
    }

    /// The same joints as a group of that name.
    #[cfg(test)]
    pub(super) fn of_group(self, name: &str, usual: TrajectorySettings) -> Self {
        Self { group: Some(name.to_owned()), usual, ..self }
    }

    /// Place of a joint among them.
    pub(super) fn place(&self, name: &str) -> Option<usize> {
        self.names.iter().position(|joint| joint == name)
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::config;
    use super::*;
    use crate::surface::table;
    use lineshaft_core::machine::Machine;

    fn all(groups: &[Group]) -> Vec<Joints> {
        let config = config();
        let machine = Machine::new(config.clone()).expect("a sound machine");
        Joints::all(&config, machine.directory(), groups)
    }

    #[test]
    fn without_groups_all_axes_with_a_drive_have_one_action() {
        let all = all(&[]);
        assert_eq!(all.len(), 1);
        assert_eq!(all[0].names, ["x", "y"], "line is virtual");
        assert_eq!(all[0].axes, [1, 2]);
        assert_eq!(all[0].name_of(&table::FOLLOW_JOINT_TRAJECTORY.0), "~/follow_joint_trajectory");
    }

    #[test]
    fn each_group_has_its_own_in_its_order() {
        let group = |name: &str, axes: &[u16]| Group {
            name: name.to_owned(),
            axes: axes.to_vec(),
            trajectories: TrajectorySettings::default(),
        };
        let all = all(&[group("arm", &[2, 1]), group("hand", &[1])]);
        assert_eq!(all.iter().map(|joints| joints.names.clone()).collect::<Vec<_>>(), [vec!["y", "x"], vec!["x"]]);
        assert_eq!(all[0].name_of(&table::FOLLOW_JOINT_TRAJECTORY.0), "~/arm/follow_joint_trajectory");
        assert_eq!(all[1].name_of(&table::JOINT_TRAJECTORY.0), "~/hand/joint_trajectory");
        assert_eq!((all[0].place("x"), all[1].place("y")), (Some(1), None));
        assert_eq!(all[0].parameter("trajectory_limits.margin"), "arm.trajectory_limits.margin");
    }
}
