//! Tests of switching without a machine, and of the lists.

use super::lists::{self, Hardware};
use super::plan::Plan;
use super::switches::Controllers;
use crate::surface::host::SubmitError;
use crate::surface::trajectory::Joints;
use crate::surface::trajectory::tests::{config, joint_names};
use crate::surface::{Group, JointNames, TrajectorySettings};
use lineshaft_core::machine::Machine;
use lineshaft_core::object::AxisSet;
use lineshaft_msgs::foreign::controller_manager_msgs::srv::SwitchControllerRequest as Asked;
use lineshaft_msgs::foreign::lifecycle_msgs::msg::State;
use std::cell::RefCell;

const MANAGER: Option<&str> = Some("/lineshaft/controller_manager");

/// Returns the controllers of a machine with axes line, x and y, for these groups.
fn controllers(manager: Option<&str>, groups: &[(&str, &[u16])]) -> Controllers {
    let group = |&(name, axes): &(&str, &[u16])| Group {
        name: name.to_owned(),
        axes: axes.to_vec(),
        trajectories: TrajectorySettings::default(),
        gripper: None,
    };
    let groups: Vec<_> = groups.iter().map(group).collect();
    let machine = Machine::new(config()).expect("a sound machine");
    let joints = Joints::all(&config(), &joint_names(), machine.directory(), &groups);
    Controllers::new(manager, "lineshaft", joints)
}

/// Group arm has y and x, hand has x.
fn arm_and_hand() -> Controllers {
    controllers(MANAGER, &[("arm", &[2, 1]), ("hand", &[1])])
}

fn request(activate: &[&str], deactivate: &[&str], strictness: i32) -> Asked {
    let names = |names: &[&str]| names.iter().map(|&name| name.to_owned()).collect();
    Asked {
        activate_controllers: names(activate),
        deactivate_controllers: names(deactivate),
        strictness,
        ..Asked::default()
    }
}

/// Commands that a switch has sent to the machine.
type Given = Vec<String>;

/// Executes a request, with a machine that accepts all commands.
fn switch(all: &Controllers, asked: &Asked) -> Result<(String, Given), String> {
    let plan = Plan::of(all.all(), asked)?;
    let given = RefCell::new(Vec::new());
    let cancel = |goal: u64| {
        given.borrow_mut().push(format!("cancel {goal}"));
        Ok(0)
    };
    let halt = |axes: AxisSet| {
        given.borrow_mut().push(format!("halt {:?}", axes.iter().collect::<Vec<_>>()));
        Ok(())
    };
    all.switch(&plan, cancel, halt).expect("it takes all");
    Ok((plan.summary(all.all()), given.take()))
}

fn said(all: &Controllers, asked: &Asked) -> String {
    match switch(all, asked) {
        Ok((summary, _)) => summary,
        Err(sentence) => sentence,
    }
}

#[test]
fn inactive_group_refuses_trajectories_and_names_the_command_that_activates_it() {
    let all = arm_and_hand();
    assert_eq!(all.while_active(0, || 7, |_| Some(7)), Ok(7));
    switch(&all, &request(&[], &["arm"], Asked::STRICT)).unwrap();
    let sentence = "group arm is inactive; activate it first (`ros2 control switch_controllers -c \
                    /lineshaft/controller_manager --activate arm`)";
    assert_eq!(all.check(0), Err(sentence.to_owned()));
    let handed_over = || panic!("nothing is handed over");
    assert_eq!(all.while_active(0, handed_over, |()| None), Err(sentence.to_owned()));
    assert_eq!((all.check(1), all.active()), (Ok(()), vec![false, true]), "the other group stays active");
    switch(&all, &request(&["arm"], &[], Asked::STRICT)).unwrap();
    assert_eq!((all.check(0), all.active()), (Ok(()), vec![true, true]));
    assert_eq!(all.while_active(0, || 8, |_| Some(8)), Ok(8));
}

#[test]
fn deactivation_halts_the_axes_of_the_active_groups_once() {
    let all = arm_and_hand();
    let off = request(&[], &["hand", "arm"], Asked::STRICT);
    assert_eq!(
        switch(&all, &off),
        Ok(("controllers hand, arm are inactive".to_owned(), vec!["halt [1, 2]".to_owned()]))
    );
    // A controller that is already in the requested state is not an error.
    assert_eq!(switch(&all, &off).unwrap().1, Given::new());
    let on = request(&["hand"], &["arm"], Asked::STRICT);
    let summary = "controller hand is active; controller arm is inactive".to_owned();
    assert_eq!(switch(&all, &on), Ok((summary, Given::new())), "activation moves nothing");
    assert_eq!(all.active(), [false, true]);
}

#[test]
fn waiting_trajectory_is_cancelled_because_halt_overtakes_it() {
    let all = arm_and_hand();
    for number in [3, 4] {
        all.while_active(0, || (), |()| Some(number)).unwrap();
    }
    // The read trajectory is not the newest one.
    all.record_read(0, 3);
    let off = request(&[], &["arm"], Asked::STRICT);
    assert_eq!(switch(&all, &off).unwrap().1, ["cancel 4", "halt [1, 2]"]);
    switch(&all, &request(&["arm"], &[], Asked::STRICT)).unwrap();
    all.record_read(0, 4);
    assert_eq!(switch(&all, &off).unwrap().1, ["halt [1, 2]"]);
}

#[test]
fn a_machine_that_takes_no_more_commands_leaves_all_as_it_was() {
    let all = arm_and_hand();
    let plan = Plan::of(all.all(), &request(&["hand"], &["arm"], Asked::STRICT)).unwrap();
    let full = |_| Err::<(), _>(SubmitError::Full);
    assert_eq!(all.switch(&plan, Ok, full), Err(SubmitError::Full));
    assert_eq!(all.active(), [true, true]);
    // Without cycles there is no motion to be halted.
    assert_eq!(all.switch(&plan, Ok, |_| Err::<(), _>(SubmitError::Unconfigured)), Ok(None));
    assert_eq!(all.active(), [false, true]);
}

#[test]
fn unknown_names_are_refused_by_strict_and_skipped_by_best_effort() {
    let all = arm_and_hand();
    let unknown = "deactivate_controllers: controller `leg` is unknown, known are arm, hand";
    for asked in [
        request(&["hand"], &["arm", "leg"], Asked::STRICT),
        request(&["hand"], &["leg"], Asked::STRICT),
        // The list contains only unknown names.
        request(&["hand"], &["leg"], Asked::BEST_EFFORT),
    ] {
        assert_eq!(switch(&all, &asked), Err(unknown.to_owned()), "{asked:?}");
        assert_eq!(all.active(), [true, true]);
    }
    for strictness in [0, Asked::BEST_EFFORT, Asked::AUTO, Asked::FORCE_AUTO] {
        let asked = request(&["hand", "hand"], &["leg", "arm"], strictness);
        let summary = "controller hand is active; controller arm is inactive; skipped because unknown: leg";
        assert_eq!(said(&all, &asked), summary, "{strictness}");
    }
    let none = controllers(MANAGER, &[]);
    assert_eq!(
        said(&none, &request(&["arm"], &[], 0)),
        "activate_controllers: controller `arm` is unknown, known are lineshaft"
    );
}

#[test]
fn invalid_switch_request_is_refused() {
    let all = arm_and_hand();
    for strictness in [Asked::BEST_EFFORT, Asked::STRICT] {
        let both = request(&["hand", "arm"], &["arm"], strictness);
        let sentence =
            "controller arm is in activate_controllers and in deactivate_controllers; one of them is allowed";
        assert_eq!(switch(&all, &both), Err(sentence.to_owned()));
    }
    for strictness in [-1, 5, i32::MIN] {
        let sentence = said(&all, &request(&["arm"], &[], strictness));
        let allowed = "BEST_EFFORT (1), STRICT (2), AUTO (3), FORCE_AUTO (4) or 0 is allowed";
        assert_eq!(sentence, format!("strictness is {strictness}; {allowed}"));
    }
    assert_eq!(said(&all, &request(&[], &[], Asked::STRICT)), "no controller was named");
    assert_eq!(all.active(), [true, true]);
    // No content of a request makes the message long.
    let long = "n".repeat(100_000);
    assert!(said(&all, &request(&[&long], &[], Asked::STRICT)).len() < crate::fuzz::LONGEST_SENTENCE);
    let many = vec![long.as_str(); 100];
    let some = [&many[..], &["arm"]].concat();
    assert!(said(&all, &request(&some, &[], Asked::BEST_EFFORT)).len() < crate::fuzz::LONGEST_SENTENCE);
}

#[test]
fn controllers_are_listed_with_their_interfaces() {
    let all = arm_and_hand();
    switch(&all, &request(&[], &["hand"], Asked::STRICT)).unwrap();
    let [arm, hand] = lists::controllers(&all, 1000).try_into().expect("two");
    assert_eq!((arm.name.as_str(), arm.state.as_str(), arm.update_rate), ("arm", "active", 1000));
    assert_eq!(arm.r#type, "joint_trajectory_controller/JointTrajectoryController");
    assert_eq!(arm.claimed_interfaces, ["y/position", "x/position"], "in the order of the group");
    assert_eq!(arm.required_command_interfaces, arm.claimed_interfaces);
    assert_eq!(arm.required_state_interfaces, ["y/position", "y/velocity", "x/position", "x/velocity"]);
    assert!(!arm.is_async && !arm.is_chainable && !arm.is_chained && arm.chain_connections.is_empty());
    assert_eq!((hand.state.as_str(), hand.claimed_interfaces.len()), ("inactive", 0));
    assert_eq!(hand.required_command_interfaces, ["x/position"]);
}

#[test]
fn without_groups_one_controller_has_the_name_of_the_node() {
    let all = controllers(MANAGER, &[]);
    let one = lists::controllers(&all, 1000);
    assert_eq!((one.len(), one[0].name.as_str()), (1, "lineshaft"));
    assert_eq!(one[0].claimed_interfaces, ["x/position", "y/position"]);
    switch(&all, &request(&[], &["lineshaft"], Asked::STRICT)).unwrap();
    assert!(all.check(0).unwrap_err().starts_with("controller lineshaft is inactive; activate it first"));
}

#[test]
fn hardware_is_one_component_of_all_axes_with_a_drive() {
    let all = controllers(MANAGER, &[("hand", &[1])]);
    let names = JointNames::new(["line", "Shoulder_Pan", "y"].map(str::to_owned).to_vec());
    let hardware = Hardware::of(&config(), &names, "lineshaft");
    assert_eq!(hardware.rate(), 1000, "1 ms");
    let state = |id| State { id, label: String::new() };
    let shown = hardware.component(&all, state(3));
    assert_eq!(
        (shown.name.as_str(), shown.r#type.as_str(), shown.state.id, shown.rw_rate),
        ("lineshaft", "system", 3, 1000)
    );
    let of = |shown: &[lineshaft_msgs::foreign::controller_manager_msgs::msg::HardwareInterface]| {
        shown.iter().map(|one| (one.name.clone(), one.is_available, one.is_claimed)).collect::<Vec<_>>()
    };
    let named = |name: &str, is_claimed| (name.to_owned(), true, is_claimed);
    // Joint names of the controllers are the object names here.
    assert_eq!(of(&shown.command_interfaces), [named("Shoulder_Pan/position", false), named("y/position", false)]);
    let states = ["Shoulder_Pan/position", "Shoulder_Pan/velocity", "y/position", "y/velocity"];
    assert_eq!(of(&shown.state_interfaces), states.map(|name| named(name, false)));

    let hardware = Hardware::of(&config(), &joint_names(), "lineshaft");
    let claimed = |all: &Controllers| of(&hardware.component(all, state(3)).command_interfaces);
    assert_eq!(claimed(&all), [named("x/position", true), named("y/position", false)]);
    switch(&all, &request(&[], &["hand"], Asked::STRICT)).unwrap();
    assert_eq!(claimed(&all), [named("x/position", false), named("y/position", false)]);
    for (id, is_available) in [(0, false), (1, false), (2, true), (4, false), (10, false)] {
        let shown = hardware.component(&all, state(id));
        assert!(shown.command_interfaces.iter().all(|one| one.is_available == is_available), "{id}");
    }
}
