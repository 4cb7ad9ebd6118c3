//! The data for colcon agrees with the files.

use std::fs;
use std::path::Path;

use crate::files::{OWN, read_all};
use crate::interface::{Element, Kind};

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn read(file: &str) -> String {
    fs::read_to_string(root().join(file)).expect("a file of this package")
}

#[test]
fn cmake_lists_exactly_the_files_that_are_there() {
    let cmake = read("CMakeLists.txt");
    let mut listed: Vec<&str> =
        cmake.lines().filter_map(|line| line.trim().strip_prefix('"')?.strip_suffix('"')).collect();
    let mut there = Vec::new();
    for kind in Kind::ALL {
        for entry in fs::read_dir(root().join(kind.name())).unwrap() {
            there.push(format!("{}/{}", kind.name(), entry.unwrap().file_name().to_str().unwrap()));
        }
    }
    listed.sort_unstable();
    there.sort_unstable();
    assert_eq!(listed, there);
    assert!(!there.is_empty());
}

#[test]
fn every_package_that_a_file_names_is_a_dependency() {
    let (cmake, package) = (read("CMakeLists.txt"), read("package.xml"));
    let mut needed = vec!["action_msgs", "builtin_interfaces"]; // of every action
    let interfaces = read_all(root()).unwrap();
    let own = interfaces.iter().filter(|interface| interface.package == OWN);
    for field in own.flat_map(|interface| &interface.sections).flat_map(|section| &section.fields) {
        if let Element::Message { package, .. } = &field.element
            && package != OWN
        {
            needed.push(package);
        }
    }
    needed.sort_unstable();
    needed.dedup();
    assert_eq!(needed, ["action_msgs", "builtin_interfaces", "rcl_interfaces", "std_msgs"]);
    let given = cmake.lines().find_map(|line| line.trim().strip_prefix("DEPENDENCIES ")).unwrap();
    assert_eq!(given.split_whitespace().collect::<Vec<_>>(), needed);
    for name in needed {
        assert!(cmake.contains(&format!("find_package({name} REQUIRED)")), "{name}");
        assert!(package.contains(&format!("<depend>{name}</depend>")), "{name}");
    }
}

#[test]
fn name_version_and_licence_are_those_of_the_crate() {
    let package = read("package.xml");
    for (tag, value) in [
        ("name", env!("CARGO_PKG_NAME")),
        ("version", env!("CARGO_PKG_VERSION")),
        ("license", env!("CARGO_PKG_LICENSE")),
        ("member_of_group", "rosidl_interface_packages"),
        ("build_type", "ament_cmake"),
    ] {
        assert!(package.contains(&format!("<{tag}>{value}</{tag}>")), "{tag} {value}");
    }
}
