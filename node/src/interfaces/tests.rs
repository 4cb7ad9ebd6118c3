//! Tests the descriptions of interfaces.

use super::{details, listing, markdown, meant, qos_text, renewed};
use lineshaft_msgs::INTERFACES;
use lineshaft_ros::layer::Qos;
use lineshaft_ros::surface::table::{PARAMETERS, ROWS};

/// The blocks of docs/interfaces.md must be the generated ones.
/// `LINESHAFT_RENEW=1 cargo test -p lineshaft --lib interfaces` regenerates them.
#[test]
fn the_page_in_docs_holds_what_the_program_makes() {
    crate::page::check("interfaces.md", "interfaces", |page| renewed(page).unwrap());
}

#[test]
fn text_around_the_blocks_is_unchanged() {
    let page = "# Title\n\n<!-- begin endpoints: by the program -->\nold\n<!-- end endpoints -->\n\nprose\n\
                <!-- begin parameters -->\n<!-- end parameters -->\n<!-- begin types -->\n\n<!-- end types -->\nlast\n";
    let made = renewed(page).unwrap();
    assert!(made.starts_with("# Title\n\n<!-- begin endpoints: by the program -->\n\n| kind | name |"), "{made}");
    assert!(made.contains("\n<!-- end endpoints -->\n\nprose\n<!-- begin parameters -->\n\n| names |"), "{made}");
    assert!(made.ends_with("\n<!-- end types -->\nlast\n") && !made.contains("\nold\n"), "{made}");
    assert_eq!(renewed(&made).as_ref(), Ok(&made));
    for (mark, name) in [("<!-- begin types -->", "begin types"), ("<!-- end parameters -->", "begin parameters")] {
        let error = renewed(&page.replace(mark, "")).unwrap_err();
        assert!(error.contains(name), "{error}");
    }
}

#[test]
fn page_has_all_interfaces_and_valid_tables() {
    let page = markdown();
    let lines = |start: &str| page.lines().filter(|line| line.starts_with(start)).count();
    for row in ROWS {
        assert_eq!(page.lines().filter(|line| line.contains(&format!(" | `{}` | ", row.name))).count(), 1, "{row:?}");
    }
    for row in PARAMETERS {
        assert_eq!(lines(&format!("| `{}` | {}", row.name, row.kind)), 1, "{row:?}");
    }
    for interface in INTERFACES {
        let heading = format!("### {}", interface.name);
        assert_eq!(page.lines().filter(|line| *line == heading).count(), 1, "{heading}");
        for section in interface.sections {
            for field in section.fields {
                assert!(lines(&format!("| `{}` | `{}` |", field.name, field.kind)) > 0, "{field:?}");
            }
            for constant in section.constants {
                assert!(lines(&format!("| `{}` | {} |", constant.name, constant.value)) > 0, "{constant:?}");
            }
        }
    }
    let mut columns = 0;
    for line in page.lines() {
        let bars = line.replace("\\|", "").matches('|').count();
        columns = if columns == 0 { bars } else { columns };
        assert!(bars == if line.starts_with('|') { columns } else { 0 }, "{line}");
        columns = if line.starts_with('|') { columns } else { 0 };
    }
}

#[test]
fn qos_is_shown_in_ros_2_terms() {
    assert_eq!(qos_text(Qos::STREAM), "reliable, volatile, 10");
    assert_eq!(qos_text(Qos::CLOCK), "best effort, volatile, 1");
    assert_eq!(qos_text(Qos::ROSOUT), "reliable, transient local, 1000, lifespan 10 s");
}

#[test]
fn the_list_has_every_name_and_keeps_to_its_width() {
    for width in [80, 120] {
        let text = listing(width);
        for row in ROWS {
            assert!(text.lines().any(|line| line.split_whitespace().nth(1) == Some(row.name)), "{row:?}");
        }
        assert!(text.lines().all(|line| line.chars().count() <= width), "{text}");
    }
}

#[test]
fn details_are_found_by_type_and_by_name() {
    let text = details("moveaxis", 80).unwrap();
    assert!(text.starts_with("lineshaft_msgs/action/MoveAxis\n\nGoal\n"), "{text}");
    assert!(
        text.contains("  float64 jerk\n        Jerk [units/s^3], > 0, 0 = default_jerk; for profile jerk.\n"),
        "{text}"
    );
    assert!(text.contains("  uint8 SUPERIMPOSED=4\n"), "{text}");
    for name in ["lineshaft_msgs/MoveAxis", "lineshaft_msgs/action/MoveAxis"] {
        assert_eq!(details(name, 80).as_ref(), Some(&text));
    }
    let text = details("~/move_axis", 80).unwrap();
    assert!(text.starts_with("action  ~/move_axis  lineshaft_msgs/MoveAxis\n") && text.contains("\n\nlineshaft_msgs/"));
    for name in ["move_axis", "/lineshaft/move_axis", "/cell/shaft/move_axis"] {
        assert_eq!(details(name, 80).as_ref(), Some(&text));
    }
    assert_eq!(details("a/move_axis", 80), None);
    assert_eq!((meant("MoveAxs"), meant("~/mov_axis"), meant("furlong")), (Some("MoveAxis"), Some("move_axis"), None));
    assert_eq!(details("remove_axis", 80), None);
    let text = details("joint_states", 80).unwrap();
    assert!(text.ends_with("`ros2 interface show sensor_msgs/msg/JointState`\n"), "{text}");
    let text = details("switch_controller", 80).unwrap();
    assert!(text.contains("`ros2 interface show controller_manager_msgs/srv/SwitchController`\n"), "{text}");
    assert_eq!(details("/controller_manager/switch_controller", 80), Some(text));
    assert_eq!(details("nothing", 80), None);
    assert_eq!(details("other_msgs/MoveAxis", 80), None);
}
