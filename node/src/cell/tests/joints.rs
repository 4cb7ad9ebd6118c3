//! Tests key `joint` of an axis.

use super::axes::axis;
use super::{HEAD, assert_said, good, said};

/// Returns an axis on one line.
fn line(name: &str, address: u8, joint: &str) -> String {
    format!(
        "  {name}: {{{joint}drive: {{backend: plant, address: {address}}}, type: linear, \
         scale: {{increments: 1000, per: 1 mm}}, max_velocity: 1 m/s, max_acceleration: 1}}\n"
    )
}

fn two(first: &str, second: &str) -> String {
    format!("{HEAD}axes:\n{}{}", line("a", 0, first), line("b", 1, second))
}

#[test]
fn without_the_key_the_joint_name_is_the_object_name() {
    let cell = good(&two("", ""));
    assert!(cell.joint_names.iter().eq(["a", "b"]));
    assert_eq!(cell.joint_names.different_names(&cell.machine).count(), 0);
}

#[test]
fn names_of_ros_robots_are_allowed() {
    let longest = "J".repeat(64);
    // The length counts characters, not bytes.
    let umlauts = "\u{fc}".repeat(64);
    for joint in ["Shoulder_Pan", "left/arm_1", "J1", "7", "joint 1", "Arm.J1", "\u{30eb}", &longest, &umlauts] {
        let cell = good(&axis(&[("joint", &format!("\"{joint}\""))]));
        assert!(cell.joint_names.iter().eq([joint]));
        assert_eq!(cell.machine.axes[0].name, "x", "the object name stays");
    }
    let cell = good(&two("", "joint: b, "));
    assert!(cell.joint_names.iter().eq(["a", "b"]), "its own name");
    let cell = good(&two("joint: J1, ", "joint: j1, "));
    assert!(cell.joint_names.iter().eq(["J1", "j1"]), "capitals tell names apart");
    // It may be the name of another kind of object.
    let cell = good(&two("joint: plant, ", ""));
    assert!(cell.joint_names.iter().eq(["plant", "b"]));
}

#[test]
fn what_is_no_joint_name_is_refused() {
    let longer = format!("\"{}\"", "J".repeat(65));
    let shown = format!("`{}..`", "J".repeat(60));
    for (joint, shown) in [
        ("\"\"", "``"),
        ("\" J1\"", "` J1`"),
        ("\"J1 \"", "`J1 `"),
        ("\"J1\\u00a0\"", "`J1\u{a0}`"),
        ("\"J\\t1\"", "`J\\t1`"),
        ("\"J\\n1\"", "`J\\n1`"),
        ("\"J\\0\"", "`J\\u{0}`"),
        ("\"J\\u2028J\"", "`J\\u{2028}J`"),
        (longer.as_str(), shown.as_str()),
    ] {
        let allowed = "1 to 64 characters are allowed, without control characters, and without white space at the ends";
        assert_eq!(said(&axis(&[("joint", joint)])), format!("8:12: joint is {shown}; {allowed}"), "{joint}");
    }
    assert_eq!(said(&axis(&[("joint", "[J1]")])), "8:12: joint is a list; a text is expected");
    assert_eq!(said(&axis(&[("joint", "")])), "8:10: joint has no value; a text is expected");
    assert_eq!(said(&axis(&[("joints", "J1")])), "8:5: unknown key `joints` in axis `x`, did you mean `joint`?");
}

#[test]
fn both_names_are_unique_over_all_axes() {
    let end = "; each axis needs a joint name of its own";
    // `a` is in line 7, `b` in line 8; the keys begin after `  a: {`.
    assert_said(
        &two("joint: J1, ", "joint: ^J1, "),
        &format!("joint of axis `b` is `J1`, which is the joint of axis `a` already, at 7:14{end}"),
    );
    assert_said(
        &two("", "joint: ^a, "),
        &format!("joint of axis `b` is `a`, which is the name of axis `a`, at 7:3{end}"),
    );
    assert_said(
        &two("joint: ^b, ", ""),
        &format!("joint of axis `a` is `b`, which is the name of axis `b`, at 8:3{end}"),
    );
    // Even if that axis has its own joint name.
    assert_said(
        &two("joint: ^b, ", "joint: J1, "),
        &format!("joint of axis `a` is `b`, which is the name of axis `b`, at 8:3{end}"),
    );
    let swapped = said(&two("joint: b, ", "joint: a, "));
    assert_eq!(swapped.lines().count(), 2, "{swapped}");
}
