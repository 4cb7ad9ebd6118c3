//! Type hashes, compared with those of ROS 2.

use crate::action::{MoveAxis, MoveAxisFeedback, MoveAxisGoal};
use crate::files::OWN;
use crate::foreign::action_msgs::srv::CancelGoal;
use crate::foreign::sensor_msgs::msg::JointState;
use crate::foreign::std_srvs::srv::{Trigger, TriggerRequest, TriggerResponse};
use crate::srv::{SetPosition, SetPositionRequest, SetPositionResponse};
use crate::{Action, GetResult, Message, SendGoal, Service, TYPE_HASHES};

/// Names and hashes, with their source.
const KNOWN: &str = include_str!("hashes.txt");

fn computed(name: &str) -> &'static str {
    let found = TYPE_HASHES.iter().find(|(known, _)| *known == name);
    found.unwrap_or_else(|| panic!("{name} has no hash")).1
}

fn known() -> Vec<(&'static str, &'static str)> {
    let lines = KNOWN.lines().filter(|line| !line.starts_with('#'));
    lines.map(|line| line.split_once(' ').expect("name and hash")).collect()
}

#[test]
fn type_hashes_of_other_packages_are_those_of_ros_2() {
    let known = known();
    for (name, hash) in &known {
        assert_eq!(computed(name), *hash, "{name}");
    }
    // An event has a hash too, which is part of the hash of its service.
    let foreign = TYPE_HASHES.iter().map(|(name, _)| *name).filter(|name| !name.starts_with(OWN));
    let missing: Vec<_> =
        foreign.filter(|name| !name.ends_with("_Event") && known.iter().all(|(known, _)| known != name)).collect();
    assert_eq!(missing, [""; 0], "add the hash of ROS 2 to hashes.txt");
}

#[test]
fn messages_services_and_actions_carry_their_hashes() {
    // `ros2 topic info -v /joint_states` of ROS 2 Jazzy prints it.
    assert_eq!(JointState::HASH, "RIHS01_a13ee3a330e346c9d87b5aa18d24e11690752bd33a0350f11c5882bc9179260e");
    // Part of the key of rmw_zenoh.
    assert_eq!(Trigger::HASH, "RIHS01_eeff2cd6fa5ad9d27cdf4dec64818317839b62f212a91e6b5304b634b2062c5f");
    assert_eq!(CancelGoal::HASH, "RIHS01_573d8b0a534451d7bc2ac8c5ffde8ac14b8593b7001175d0cd6516dcbeb8689a");
    assert_eq!((Trigger::REQUEST_HASH, Trigger::RESPONSE_HASH), (TriggerRequest::HASH, TriggerResponse::HASH));
    assert_eq!(SetPosition::REQUEST_HASH, SetPositionRequest::HASH);
    assert_eq!(SetPosition::RESPONSE_HASH, SetPositionResponse::HASH);
    let action = "lineshaft_msgs/action/MoveAxis";
    for (hash, part) in [
        (MoveAxis::HASH, ""),
        (MoveAxisGoal::HASH, "_Goal"),
        (MoveAxisFeedback::HASH, "_Feedback"),
        (MoveAxis::FEEDBACK_MESSAGE_HASH, "_FeedbackMessage"),
        (SendGoal::<MoveAxis>::HASH, "_SendGoal"),
        (SendGoal::<MoveAxis>::REQUEST_HASH, "_SendGoal_Request"),
        (SendGoal::<MoveAxis>::RESPONSE_HASH, "_SendGoal_Response"),
        (GetResult::<MoveAxis>::HASH, "_GetResult"),
        (GetResult::<MoveAxis>::REQUEST_HASH, "_GetResult_Request"),
        (GetResult::<MoveAxis>::RESPONSE_HASH, "_GetResult_Response"),
    ] {
        assert_eq!(hash, computed(&format!("{action}{part}")), "{part}");
    }
}

#[test]
fn no_two_types_have_the_same_hash() {
    let mut all: Vec<_> = TYPE_HASHES.iter().map(|(_, hash)| hash).collect();
    all.sort_unstable();
    all.dedup();
    assert_eq!(all.len(), TYPE_HASHES.len());
    assert!(all.iter().all(|hash| hash.len() == 71 && hash.starts_with("RIHS01_")));
}
