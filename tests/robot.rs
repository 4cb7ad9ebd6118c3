//! Tests `robot_description`: RViz and robot_state_publisher receive the URDF of the cell, even if they start late.

use crate::support::{domain::Domain, peer::Peer, program::Program};
use serde_json::Value;
use std::path::Path;
use std::thread;
use std::time::Duration;

fn launch_configs(file: &str) -> String {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../launch-configs");
    std::fs::read_to_string(folder.join(file)).expect("a file of the project")
}

fn description(peer: &mut Peer) -> String {
    let seen = peer.run("latched-text /robot_description");
    seen["text"].as_str().expect("a text").to_owned()
}

/// Returns the elements and attributes of a URDF.
fn elements(urdf: &str) -> Vec<String> {
    let document = roxmltree::Document::parse(urdf).expect("XML");
    let mut all = Vec::new();
    for node in document.descendants().filter(roxmltree::Node::is_element) {
        all.push(node.tag_name().name().to_owned());
        all.extend(node.attributes().map(|attribute| format!("{}={}", attribute.name(), attribute.value())));
    }
    all
}

/// Returns the attribute `name` of each joint that is not fixed.
fn joints(urdf: &str) -> Vec<String> {
    let document = roxmltree::Document::parse(urdf).expect("XML");
    let joints = document.root_element().children().filter(|node| node.has_tag_name("joint"));
    joints
        .filter(|node| node.attribute("type") != Some("fixed"))
        .map(|node| node.attribute("name").expect("every joint has one").to_owned())
        .collect()
}

#[test]
fn late_subscribers_receive_the_robot_description() {
    let domain = Domain::take();
    let _program = Program::start(&["run"], &domain);
    let mut first = Peer::cyclone(&domain);
    let urdf = description(&mut first);
    assert_eq!(elements(&urdf), elements(&launch_configs("demo.urdf")));
    assert!(!urdf.contains("<!--") && !urdf.contains('\n'), "`ros2 param load` reads it as YAML: {urdf}");
    // Longer than the DDS library keeps samples that it may discard.
    thread::sleep(Duration::from_secs(5));
    let mut late = Peer::cyclone(&domain);
    assert_eq!(description(&mut late), urdf);
    assert_eq!(description(&mut first), urdf, "for a second subscription of the same program, too");
    // The names in joint_states are the movable joints of the URDF.
    let seen = late.run("joint-states --count 1 --seconds 5");
    let moved: Vec<&str> = seen["last"]["name"].as_array().unwrap().iter().filter_map(Value::as_str).collect();
    assert_eq!(moved, joints(&urdf));
}

#[test]
fn large_description_is_received_completely() {
    let folder = tempfile::tempdir().unwrap();
    let cell = launch_configs("demo.yaml").replacen("# robot_description: demo.urdf", "robot_description: big.urdf", 1);
    std::fs::write(folder.path().join("cell.yaml"), cell).unwrap();
    let filler: String = (0..7000).map(|i| format!("<material name=\"one of many: \u{e4}, {i}\"/>\n")).collect();
    let urdf = launch_configs("demo.urdf").replacen("</robot>", &format!("{filler}</robot>"), 1);
    assert!(urdf.len() > 250_000);
    std::fs::write(folder.path().join("big.urdf"), &urdf).unwrap();

    let domain = Domain::take();
    let cell = folder.path().join("cell.yaml");
    let _program = Program::start(&["run", cell.to_str().unwrap()], &domain);
    let mut peer = Peer::cyclone(&domain);
    let described = description(&mut peer);
    assert!(elements(&described) == elements(&urdf));
    let mut late = Peer::cyclone(&domain);
    assert!(description(&mut late) == described);
}

#[test]
fn without_a_description_there_is_no_such_topic() {
    let folder = tempfile::tempdir().unwrap();
    let cell = folder.path().join("cell.yaml");
    std::fs::write(&cell, launch_configs("demo.yaml")).unwrap();
    let domain = Domain::take();
    let _program = Program::start(&["run", cell.to_str().unwrap()], &domain);
    let mut peer = Peer::cyclone(&domain);
    peer.run("axis-states /lineshaft");
    assert!(peer.fails("latched-text /robot_description").contains("nobody publishes /robot_description"));
}
