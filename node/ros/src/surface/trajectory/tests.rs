//! A small machine for tests: line is virtual, x and y have a drive; 1000 inc/mm, 1 m/s, 5 m/s^2.

use super::action::feedback;
use super::joints::Joints;
use super::*;
use crate::surface::JointNames;
use crate::surface::host::Snapshot;
use lineshaft_core::config::{AxisConfig, MachineConfig};
use lineshaft_core::machine::Machine;
use lineshaft_core::parameter::AxisParameters;
use lineshaft_core::request::{PointRequest, TrajectoryRequest};
use lineshaft_core::unit::{Fraction, Quantity, Scale, Unit};

pub(in crate::surface) fn config() -> MachineConfig {
    let per = Quantity::new(Fraction::from_integer(1), Unit::MILLIMETRE);
    let scale = Scale::new(Fraction::from_integer(1000), per).and_then(|scale| scale.with_unit(Unit::MILLIMETRE));
    let scale = scale.expect("a sound scale");
    let parameters = AxisParameters::new(1_000_000.0, 5_000_000.0);
    let axis = |name: &str, drive: Option<u32>| {
        AxisConfig::new(name.to_owned(), scale, drive.map(lineshaft_core::drive::Capabilities::all), parameters)
    };
    MachineConfig {
        cycle_ns: 1_000_000,
        axes: vec![axis("line", None), axis("x", Some(0)), axis("y", Some(1))],
        ..MachineConfig::default()
    }
}

/// Returns the object names as joint names.
pub(in crate::surface) fn joint_names() -> JointNames {
    JointNames::of_objects(&config())
}

/// Returns the axes with a drive.
pub(super) fn joints() -> Joints {
    joints_called(&joint_names())
}

/// Returns the axes with a drive, with these joint names.
pub(super) fn joints_called(names: &JointNames) -> Joints {
    let config = config();
    let machine = Machine::new(config.clone()).expect("a sound machine");
    Joints::all(&config, names, machine.directory(), &[]).remove(0)
}

#[test]
fn start_of_trajectory_is_independent_of_read_time() {
    let rest = PointRequest { positions: vec![0.0], ..PointRequest::default() };
    let request = TrajectoryRequest { axes: vec!["x".to_owned()], points: vec![rest], ..TrajectoryRequest::default() };
    let trajectory = config().resolve_trajectory(&request).expect("a sound request");
    let started = |stamp_ns| PreparedTrajectory { trajectory: trajectory.clone(), stamp_ns };
    assert_eq!(started(Some(7_000)).begin(4_000).start_ns(), 3_000);
    assert_eq!(started(Some(7_000)).begin(9_000).start_ns(), -2_000, "it has begun before");
    assert_eq!(started(None).begin(9_000).start_ns(), 0, "without a stamp it begins now");
    assert_eq!(started(Some(i64::MIN)).begin(i64::MAX).start_ns(), i64::MIN, "nothing wraps");
}

#[test]
fn feedback_has_the_joints_of_the_group_and_the_time_of_the_cycle() {
    let machine = Machine::new(config()).expect("a sound machine");
    let snapshot = Snapshot { cycle: 1, stamp_ns: 0, board: machine.board().clone() };
    let shown = feedback(&joints(), &snapshot, 12_000_000_034);
    assert_eq!((shown.header.stamp.sec, shown.header.stamp.nanosec), (12, 34));
    assert_eq!(shown.joint_names, ["x", "y"]);
    for point in [&shown.desired, &shown.actual, &shown.error] {
        assert_eq!((point.positions.len(), point.velocities.len()), (2, 2));
    }
    assert_eq!(shown.desired.accelerations.len(), 2);
    let state = controller_state::message(&joints(), &snapshot, 12_000_000_034);
    assert_eq!((state.header, state.joint_names, state.speed_scaling_factor), (shown.header, shown.joint_names, 1.0));
    assert_eq!((state.reference, state.feedback, state.error), (shown.desired.clone(), shown.actual, shown.error));
    assert_eq!(state.output, shown.desired, "nothing lags");
}
