use super::*;
use lineshaft_core::command::Setpoint;
use lineshaft_core::config::AxisConfig;
use lineshaft_core::parameter::AxisParameters;
use lineshaft_core::unit::{Fraction, Quantity, Scale, Unit};
use lineshaft_msgs::foreign::std_msgs::msg::Header;
use proptest::prelude::*;

/// Returns a machine with x and y: 1000 inc/mm, 100 mm/s, 100 ms; y with 20 ms.
fn machine() -> (MachineConfig, ParameterImage) {
    let per = Quantity::new(Fraction::from_integer(1), Unit::MILLIMETRE);
    let scale = Scale::new(Fraction::from_integer(1000), per).unwrap().with_unit(Unit::MILLIMETRE).unwrap();
    let parameters = AxisParameters::new(100_000.0, 1e6);
    let quick = AxisParameters { setpoint_timeout: 20_000_000, ..parameters };
    let axis = |name: &str, parameters| AxisConfig::new(name.into(), scale, None, parameters);
    let axes = vec![axis("x", parameters), axis("y", quick)];
    let config = MachineConfig { cycle_ns: 1_000_000, axes, ..MachineConfig::default() };
    (config, ParameterImage { version: 1, effective: vec![parameters, quick], ..ParameterImage::default() })
}

fn joint_jog(names: &[&str], velocities: &[f64]) -> JointJog {
    let joint_names = names.iter().map(|&name| name.to_owned()).collect();
    JointJog { joint_names, velocities: velocities.to_vec(), ..JointJog::default() }
}

/// Reads a jog for a machine without separate joint names.
fn jog(message: JointJog) -> Result<Asked, String> {
    let (config, _) = machine();
    super::jog(message, &JointNames::of_objects(&config), &config)
}

fn setpoints(message: msg::Setpoints) -> Result<Asked, String> {
    super::setpoints(message, &JointNames::default(), &machine().0)
}

fn judged(asked: Result<Asked, String>, age: i128) -> Result<Setpoints, String> {
    let shown = JointNames::of_objects(&machine().0);
    judged_as(&shown, asked, age)
}

/// Checks setpoints; messages give these names to axes.
fn judged_as(shown: &JointNames, asked: Result<Asked, String>, age: i128) -> Result<Setpoints, String> {
    let (config, image) = machine();
    let (_, requests) = asked?;
    let set = config.resolve_setpoints(Source::Ros, Units::Si, &requests).map_err(|error| error.to_string())?;
    check(&set, &config, shown, &image, age).map(|()| set)
}

#[test]
fn a_jog_in_metres_per_second_for_a_while() {
    let set = judged(jog(JointJog { duration: 0.25, ..joint_jog(&["y", "x"], &[-0.1, 0.02]) }), 0).unwrap();
    let setpoint = |velocity, duration| Some(Setpoint { velocity, duration });
    assert_eq!(set.axes, [setpoint(20_000.0, Some(250_000_000)), setpoint(-100_000.0, Some(250_000_000))]);
    let set = judged(jog(joint_jog(&["x"], &[0.0])), 0).unwrap();
    assert_eq!(set.axes, [setpoint(0.0, None), None]);
    // Nearly zero, but not unlimited; and longer than any time.
    for (duration, ns) in [(1e-12, 1), (1e300, i64::MAX as u64)] {
        let set = judged(jog(JointJog { duration, ..joint_jog(&["x"], &[0.01]) }), 0).unwrap();
        assert_eq!(set.axes[0].unwrap().duration, Some(ns));
    }
}

#[test]
fn setpoints_equal_jog_with_object_names() {
    let message = msg::Setpoints { axes: vec!["y".to_owned()], velocities: vec![0.05], ..msg::Setpoints::default() };
    let set = judged(setpoints(message), 0).unwrap();
    assert_eq!(set.axes, [None, Some(Setpoint { velocity: 50_000.0, duration: None })]);
    let message = msg::Setpoints { axes: vec!["y".to_owned()], ..msg::Setpoints::default() };
    let sentence = "velocities has 0 entries; 1 are expected, one for each of axes";
    assert_eq!(judged(setpoints(message), 0).unwrap_err(), sentence);
}

#[test]
fn invalid_message_is_refused_as_a_whole() {
    let with = |change: fn(&mut JointJog)| {
        let mut message = joint_jog(&["x", "y"], &[0.01, 0.01]);
        change(&mut message);
        judged(jog(message), 0).unwrap_err()
    };
    for (sentence, part) in [
        (with(|m| m.displacements = vec![1.0]), "displacements has 1 entries; none is allowed, give velocities"),
        (with(|m| m.velocities = vec![1.0]), "velocities has 1 entries; 2 are expected, one for each of joint_names"),
        (with(|m| *m = JointJog::default()), "no axis is named"),
        (with(|m| m.joint_names[1] = "x".into()), "joint_names has the joint `x` twice; once is expected"),
        // Names without a velocity are counted, but not compared with each other.
        (
            with(|m| *m = joint_jog(&["x", "x"], &[0.01])),
            "velocities has 1 entries; 2 are expected, one for each of joint_names",
        ),
        (with(|m| m.joint_names[1] = "w".into()), "joint_names has the joint `w`; there are x, y"),
        (with(|m| m.velocities[1] = f64::NAN), "velocity of `y` is NaN; a finite number within +-1e38 is expected"),
        (with(|m| m.velocities[0] = f64::INFINITY), "velocity of `x` is inf; a finite number"),
        (with(|m| m.velocities[0] = 1e60), "velocity of `x` is 1e60; a finite number"),
        (
            with(|m| m.velocities[1] = -0.100001),
            "velocity -0.100001 m/s (-100.001 mm/s) of y exceeds max_velocity 0.1 m/s (100 mm/s)",
        ),
        (with(|m| m.duration = -1.0), "duration is -1 s; 0 (until the next message) or more is allowed"),
        (with(|m| m.duration = f64::NAN), "duration is NaN s"),
        (with(|m| m.duration = f64::INFINITY), "duration is inf s"),
    ] {
        assert!(sentence.contains(part), "{sentence}: {part}");
    }
}

#[test]
fn a_jog_names_joints_and_setpoints_name_objects() {
    let (config, _) = machine();
    let names = JointNames::new(["Shoulder_Pan", "left/arm_1"].map(str::to_owned).to_vec());
    let jog = |joints: &[&str]| super::jog(joint_jog(joints, &vec![0.02; joints.len()]), &names, &config);
    let set = judged(jog(&["left/arm_1"]), 0).unwrap();
    assert_eq!(set.axes, [None, Some(Setpoint { velocity: 20_000.0, duration: None })]);
    for (joint, sentence) in [
        ("y", "joint_names has `y`, the object name of an axis; its joint name is `left/arm_1`"),
        ("left", "joint_names has the joint `left`; there are Shoulder_Pan, left/arm_1"),
    ] {
        assert_eq!(judged(jog(&["Shoulder_Pan", joint]), 0).unwrap_err(), sentence);
    }
    // The answer contains the name of the message, and enough digits to show the difference.
    let fast = judged_as(&names, super::jog(joint_jog(&["left/arm_1"], &[0.100_000_000_1]), &names, &config), 0);
    let sentence = "velocity 0.1000000001 m/s (100.0000001 mm/s) of left/arm_1 exceeds max_velocity 0.1 m/s (100 mm/s)";
    assert_eq!(fast.unwrap_err(), sentence);
    let old = judged_as(&names, jog(&["left/arm_1"]), 21_000_000).unwrap_err();
    assert!(old.contains("setpoint_timeout 20 ms of left/arm_1 is allowed"), "{old}");
    for (velocities, sentence) in [
        ([0.01, f64::NAN], "velocity of `left/arm_1` is NaN; a finite number within +-1e38 is expected"),
        ([0.01, 0.01], "joint_names has the joint `left/arm_1` twice; once is expected"),
    ] {
        assert_eq!(super::jog(joint_jog(&["left/arm_1"; 2], &velocities), &names, &config).unwrap_err(), sentence);
    }
    let setpoints = |axis: &str| {
        let message = msg::Setpoints { axes: vec![axis.to_owned()], velocities: vec![0.05], ..Default::default() };
        judged(super::setpoints(message, &names, &config), 0)
    };
    assert!(setpoints("y").is_ok());
    assert_eq!(setpoints("left/arm_1").unwrap_err(), "no axis is called `left/arm_1`; there are x, y");
}

/// 150 deg/s are 2.6179939 rad/s, but 2.617994 in a URDF. Here 0.1 m/s.
#[test]
fn rounded_velocity_above_limit_is_limited() {
    let (config, image) = machine();
    for (velocity, limited) in
        [(0.100_000_9, 100_000.0), (-0.100_000_9, -100_000.0), (0.1, 100_000.0), (0.05, 50_000.0)]
    {
        let (_, requests) = jog(joint_jog(&["x"], &[velocity])).expect("a good message");
        let mut set = config.resolve_setpoints(Source::Ros, Units::Si, &requests).expect("a good request");
        limit(&mut set, &config, &image);
        assert_eq!(set.axes[0].map(|setpoint| setpoint.velocity), Some(limited), "{velocity}");
        assert!(check(&set, &config, &JointNames::of_objects(&config), &image, 0).is_ok());
    }
    let (_, requests) = jog(joint_jog(&["x"], &[0.100_001_1])).expect("a good message");
    let mut set = config.resolve_setpoints(Source::Ros, Units::Si, &requests).expect("a good request");
    limit(&mut set, &config, &image);
    assert!(check(&set, &config, &JointNames::of_objects(&config), &image, 0).is_err());
}

#[test]
fn message_older_than_setpoint_timeout_is_refused() {
    let both = || jog(joint_jog(&["x", "y"], &[0.01, 0.01]));
    let only_x = || jog(joint_jog(&["x"], &[0.01]));
    assert!(judged(both(), 20_000_000).is_ok() && judged(only_x(), 100_000_000).is_ok());
    let sentence = "the message is 21 ms old by its stamp; setpoint_timeout 20 ms of y is allowed, or a stamp of 0";
    assert_eq!(judged(both(), 21_000_000).unwrap_err(), sentence);
    assert!(judged(only_x(), 100_000_001).is_err());
    let (now, time) = (Time { sec: 10, nanosec: 5 }, |sec, nanosec| Time { sec, nanosec });
    assert_eq!(age_ns(&time(0, 0), &now), 0, "a stamp of 0 is none");
    assert_eq!(age_ns(&time(9, 999_999_999), &now), 6);
    assert!(age_ns(&time(11, 0), &now) < 0, "from the future");
    assert_eq!(age_ns(&time(i32::MIN, u32::MAX), &time(i32::MAX, u32::MAX)), (1 << 32) * 1_000_000_000 - 1_000_000_000);
}

#[test]
fn refusals_are_reported_once_per_second_with_count() {
    let (mut refusals, start) = (RefusalLimit::default(), Instant::now());
    assert_eq!(refusals.say(start).as_deref(), Some(""));
    assert!((1..100).all(|ms| refusals.say(start + Duration::from_millis(ms)).is_none()));
    assert_eq!(refusals.say(start + REFUSAL_PERIOD).as_deref(), Some(" (99 messages before it were refused too)"));
    assert_eq!(refusals.say(start + REFUSAL_PERIOD * 2).as_deref(), Some(""));
}

proptest! {
    /// With any message, only numbers within the limits reach the machine.
    #[test]
    fn only_allowed_velocities_of_known_axes_are_accepted(
        names in prop::collection::vec(prop::sample::select(vec!["x", "y", "w", ""]), 0..4),
        velocities in prop::collection::vec(prop_oneof![any::<f64>(), -0.11..0.11_f64], 0..4),
        displacements in prop::collection::vec(any::<f64>(), 0..2),
        duration in prop_oneof![any::<f64>(), 0.0..1.0_f64],
        stamp in any::<(i32, u32)>(),
    ) {
        let header = Header { stamp: Time { sec: stamp.0, nanosec: stamp.1 }, ..Header::default() };
        let message = JointJog { header, displacements, duration, ..joint_jog(&names, &velocities) };
        if let Ok(set) = judged(jog(message), 0) {
            prop_assert!(!set.is_empty());
            prop_assert!(set.axes.iter().flatten().all(|setpoint| setpoint.velocity.abs() <= 100_000.0));
            prop_assert_eq!(set.axes.iter().flatten().count(), names.len());
        }
    }
}
