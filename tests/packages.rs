//! Tests the files for colcon, ROS 2 and its tools: package.xml, CMakeLists.txt, the launch file; as far as possible
//! without ROS 2.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the crate is in the workspace").to_owned()
}

fn read(path: &str) -> String {
    fs::read_to_string(root().join(path)).unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// Returns the texts of all elements of that name in package.xml of `folder`.
fn tags(folder: &str, tag: &str) -> Vec<String> {
    let text = read(&format!("{folder}/package.xml"));
    let document = roxmltree::Document::parse(&text).expect("XML");
    let found = document.descendants().filter(|node| node.has_tag_name(tag));
    found.map(|node| node.text().unwrap_or_default().to_owned()).collect()
}

#[test]
fn the_package_is_called_and_versioned_like_the_program() {
    for (folder, name) in [("node", env!("CARGO_PKG_NAME")), ("msg", "lineshaft_msgs")] {
        assert_eq!(tags(folder, "name"), [name]);
        assert_eq!(tags(folder, "version"), [env!("CARGO_PKG_VERSION")], "{folder}");
        assert_eq!(tags(folder, "license"), [env!("CARGO_PKG_LICENSE")], "{folder}");
        assert_eq!(tags(folder, "build_type"), ["ament_cmake"], "{folder}");
        assert!(read(&format!("{folder}/CMakeLists.txt")).contains(&format!("project({name}")), "{folder}");
    }
    assert!(tags("node", "exec_depend").contains(&"lineshaft_msgs".to_owned()));
}

/// Launch files, as installed by CMake.
const LAUNCH_FILES: [&str; 2] = ["launch-configs/demo.launch.py", "launch-configs/arm6/arm6.launch.py"];

/// Python packages that the launch files import, and packages whose nodes they start.
#[test]
fn what_the_launch_files_need_is_a_dependency() {
    let launch = LAUNCH_FILES.map(read).concat();
    let imported = launch.lines().filter_map(|line| {
        line.strip_prefix("from ").or_else(|| line.strip_prefix("import "))?.split([' ', '.']).next()
    });
    let started = launch.split("package=\"").skip(1).filter_map(|rest| rest.split('"').next());
    let own = ["importlib", "pathlib", "lineshaft"];
    let needed: BTreeSet<_> = imported.chain(started).filter(|name| !own.contains(name)).map(str::to_owned).collect();
    assert!(needed.contains("rviz2") && needed.len() > 4, "{needed:?}");
    let given: BTreeSet<_> = tags("node", "exec_depend").into_iter().collect();
    assert!(needed.is_subset(&given), "{needed:?} of {given:?}");
}

/// Returns README and the pages of docs.
fn pages() -> String {
    let docs = fs::read_dir(root().join("docs")).expect("docs");
    let pages = docs
        .map(|entry| entry.expect("an entry").path())
        .filter(|path| path.extension().is_some_and(|end| end == "md"));
    let pages = pages.map(|path| fs::read_to_string(path).expect("a page"));
    pages.chain([read("README.md")]).collect()
}

/// Packages of the `ros2` commands in the documentation, and of all interfaces that it names as `PACKAGE/Type` or
/// `PACKAGE/srv/Type`.
#[test]
fn what_the_documentation_uses_is_a_dependency() {
    let pages = pages();
    let is_of_name = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let mut needed = BTreeSet::new();
    for rest in pages.split("ros2 ").skip(1) {
        let verb: String = rest.chars().take_while(|&c| is_of_name(c)).collect();
        let is_command = [format!("`ros2 {verb}"), format!("    ros2 {verb} ")].iter().any(|text| pages.contains(text));
        if !verb.is_empty() && is_command {
            // It has no package of its own.
            needed.insert(if verb == "daemon" { "ros2cli".to_owned() } else { format!("ros2{verb}") });
        }
    }
    for (before, after) in pages.match_indices('/').map(|(place, _)| pages.split_at(place)) {
        let package = before.rsplit(|c| !is_of_name(c)).next().unwrap_or_default();
        let after = ["/msg/", "/srv/", "/action/", "/"]
            .into_iter()
            .find_map(|kind| after.strip_prefix(kind))
            .unwrap_or_default();
        let is_package = ["_msgs", "_srvs", "_interfaces"].into_iter().any(|end| package.ends_with(end));
        if is_package && after.starts_with(|c: char| c.is_ascii_uppercase()) {
            needed.insert(package.to_owned());
        }
    }
    // Users of ros2_control and MoveIt have these packages: the cell offers the services of the former, plans come from
    // the latter.
    for other in ["ros2control", "moveit_msgs"] {
        assert!(needed.remove(other), "{other} is not documented any more");
    }
    for expected in
        ["ros2action", "ros2launch", "ros2topic", "control_msgs", "sensor_msgs", "trajectory_msgs", "std_srvs"]
    {
        assert!(needed.contains(expected), "{expected}: {needed:?}");
    }
    let given: BTreeSet<_> = tags("node", "exec_depend").into_iter().collect();
    let missing: Vec<_> = needed.difference(&given).collect();
    assert!(missing.is_empty(), "package.xml lacks {missing:?}");
}

#[test]
fn what_cmake_installs_is_there() {
    let cmake = read("node/CMakeLists.txt");
    let installs: Vec<_> = cmake.lines().filter(|line| line.starts_with("install(")).collect();
    let files: Vec<_> =
        installs.iter().filter_map(|line| line.split_once("\"${WORKSPACE}/")?.1.split('"').next()).collect();
    assert_eq!(files, [&LAUNCH_FILES[..], &["launch-configs", "LICENSE"]].concat());
    for file in files {
        assert!(root().join(file).exists(), "{file}");
    }
    // The installed program is the one that is built.
    assert!(
        installs.contains(&"install(PROGRAMS \"${CARGO_TARGET}/release/lineshaft\" DESTINATION lib/${PROJECT_NAME})")
    );
    for part in ["--release", "--locked", "--package lineshaft", "--bin lineshaft"] {
        assert!(cmake.contains(part), "{part}");
    }
}

/// colcon finds the two packages; crates, which one of its extensions would find too, are excluded.
#[test]
fn colcon_finds_two_packages() {
    let (mut packages, mut open) = (Vec::new(), vec![root()]);
    while let Some(folder) = open.pop() {
        if folder.join("COLCON_IGNORE").exists() {
            continue;
        }
        let is_package = folder.join("package.xml").exists();
        if is_package {
            packages.push(folder.strip_prefix(root()).unwrap().to_owned());
        }
        assert!(
            is_package || folder == root() || !folder.join("Cargo.toml").exists(),
            "{}: a COLCON_IGNORE is missing",
            folder.display()
        );
        for entry in fs::read_dir(&folder).unwrap() {
            let path = entry.unwrap().path();
            let name = path.file_name().unwrap().to_str().unwrap().to_owned();
            if path.is_dir()
                && !name.starts_with('.')
                && !["target", "build", "install", "log"].contains(&name.as_str())
            {
                open.push(path);
            }
        }
    }
    packages.sort();
    assert_eq!(packages, [Path::new("msg"), Path::new("node")]);
}

/// Runs a launch file as if it were installed.
fn launch_file(file: &str, share: &Path, arguments: &[&str]) -> Output {
    launch_with(&[], file, share, arguments)
}

/// Does the same with options of the stand-in.
fn launch_with(options: &[&str], file: &str, share: &Path, arguments: &[&str]) -> Output {
    let _machine = crate::support::machine::share();
    Command::new("python3")
        .arg(root().join("tests/launch/stand_in.py"))
        .args(options)
        .arg(root().join(file))
        .arg(share)
        .args(arguments)
        .output()
        .expect("the tests need python3")
}

/// Runs the launch file of the demo.
fn launch(share: &Path, arguments: &[&str]) -> Output {
    launch_file(LAUNCH_FILES[0], share, arguments)
}

/// Returns the nodes that it starts.
fn nodes(share: &Path, arguments: &[&str]) -> Vec<serde_json::Value> {
    nodes_of(launch(share, arguments))
}

fn nodes_of(output: Output) -> Vec<serde_json::Value> {
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("what the stand-in prints")
}

fn command(node: &serde_json::Value) -> Vec<&str> {
    node["command"].as_array().into_iter().flatten().filter_map(serde_json::Value::as_str).collect()
}

#[test]
fn the_launch_file_starts_what_its_arguments_say() {
    let share = Path::new("/nowhere");
    let all = nodes(share, &[]);
    assert_eq!(all.len(), 1);
    assert_eq!(command(&all[0]), ["lineshaft/lineshaft", "run", "--ros-args"]);
    let given =
        ["cell:=/c.yaml", "sim:=true", "record:=/r", "name:=shaft", "namespace:=/press", "params_file:=/p.yaml"];
    let all = nodes(share, &given);
    assert_eq!(
        command(&all[0]).join(" "),
        "lineshaft/lineshaft run /c.yaml --sim --record /r --ros-args -r __node:=shaft -r __ns:=/press --params-file /p.yaml"
    );
}

/// Returns the message with which a launch file refuses its arguments.
fn refused(output: &Output) -> String {
    assert!(!output.status.success(), "{}", String::from_utf8_lossy(&output.stdout));
    String::from_utf8_lossy(&output.stderr).trim_end().to_owned()
}

#[test]
fn other_spellings_of_launch_arguments_do_the_same() {
    let share = Path::new("/nowhere");
    let all = nodes(share, &["simulation:=true", "recording:=/r", "parameters:=/p.yaml"]);
    let expected = "lineshaft/lineshaft run --sim --record /r --ros-args --params-file /p.yaml";
    assert_eq!(command(&all[0]).join(" "), expected);
    // The conditions of launch accept these, too.
    for value in ["TRUE", "True", "1"] {
        let all = nodes(share, &[&format!("sim:={value}")]);
        assert_eq!(command(&all[0]), ["lineshaft/lineshaft", "run", "--sim", "--ros-args"], "{value}");
    }
    for given in [&["sim:=0"][..], &["simulation:=False"], &["sim:=false", "simulation:=0"]] {
        assert_eq!(command(&nodes(share, given)[0]), ["lineshaft/lineshaft", "run", "--ros-args"], "{given:?}");
    }
    // Arguments that launch and launch_ros read themselves.
    assert_eq!(nodes(share, &["launch-prefix:=gdb -ex run --args", "emulate_tty:=true"]).len(), 1);
}

#[test]
fn unknown_launch_arguments_are_refused() {
    let share = Path::new("/nowhere");
    let names = "cell, namespace, name, params_file, record, urdf, sim, robot_state_publisher (also simulation, recording, parameters)";
    for (given, near) in [
        ("simulate:=true", " (did you mean sim?)"),
        ("SIM:=true", " (did you mean sim?)"),
        ("params:=/p.yaml", " (did you mean params_file?)"),
        ("cel:=/c.yaml", " (did you mean cell?)"),
        ("zz:=1", ""),
    ] {
        let name = given.split(":=").next().unwrap();
        let expected = format!("demo.launch.py: argument {name} is unknown{near}, allowed are {names}");
        assert_eq!(refused(&launch(share, &["cell:=/c.yaml", given])), expected);
    }
    assert_eq!(
        refused(&launch_file(LAUNCH_FILES[1], share, &["parameters:=/p.yaml"])),
        "arm6.launch.py: argument parameters is unknown, allowed are cell, urdf, record, sim, rviz (also simulation, recording)"
    );
    for wrong in ["sim:=yes", "simulation:=yes", "sim:=", "robot_state_publisher:=on"] {
        let said = refused(&launch(share, &[wrong]));
        assert!(said.ends_with("must be true or false"), "{wrong}: {said}");
    }
    assert_eq!(
        refused(&launch(share, &["sim:=false", "simulation:=true"])),
        "demo.launch.py: sim is 'false' and simulation is 'true': give one of them"
    );
}

/// A launch file of a machine has its own arguments, which an included launch file sees.
#[test]
fn an_including_launch_file_has_arguments_of_its_own() {
    let share = Path::new("/nowhere");
    let included = |given: &[&str]| launch_with(&["--included"], LAUNCH_FILES[0], share, given);
    let run = |given: &[&str]| command(&nodes_of(included(given))[0]).join(" ");
    assert_eq!(run(&["robot:=3", "use_sim_time:=true"]), "lineshaft/lineshaft run --ros-args");
    assert_eq!(run(&["robot:=3", "simulation:=True"]), "lineshaft/lineshaft run --sim --ros-args");
    assert_eq!(run(&["simulate:=true", "sim:=false"]), "lineshaft/lineshaft run --ros-args");
    assert_eq!(
        refused(&included(&["robot:=3", "simulate:=true"])),
        "demo.launch.py: simulate is unknown and resembles sim, which is missing: give sim:=true or sim:=false"
    );
}

#[test]
fn robot_state_publisher_gets_the_demo_or_the_given_urdf() {
    let folder = tempfile::tempdir().unwrap();
    let installed = folder.path().join("lineshaft/launch-configs");
    fs::create_dir_all(&installed).unwrap();
    let demo = read("launch-configs/demo.urdf");
    fs::write(installed.join("demo.urdf"), &demo).unwrap();
    let own = folder.path().join("own.urdf");
    fs::write(&own, "<robot name='own'/>").unwrap();

    let all = nodes(folder.path(), &["robot_state_publisher:=true", "namespace:=/press"]);
    assert_eq!(all.len(), 2);
    assert_eq!(command(&all[1]), ["robot_state_publisher/robot_state_publisher", "--ros-args", "-r", "__ns:=/press"]);
    assert_eq!(all[1]["parameters"]["robot_description"], demo);
    let urdf = format!("urdf:={}", own.display());
    let all = nodes(folder.path(), &["robot_state_publisher:=true", &urdf]);
    assert_eq!(all[1]["parameters"]["robot_description"], "<robot name='own'/>");
}

#[test]
fn the_arm_is_launched_with_its_cell_its_urdf_and_rviz() {
    let folder = tempfile::tempdir().unwrap();
    let installed = folder.path().join("lineshaft/launch-configs/arm6");
    fs::create_dir_all(&installed).unwrap();
    let urdf = read("launch-configs/arm6/arm6.urdf");
    fs::write(installed.join("arm6.urdf"), &urdf).unwrap();
    let own = folder.path().join("own.urdf");
    fs::write(&own, "<robot name='own'/>").unwrap();
    let run = |arguments: &[&str]| nodes_of(launch_file(LAUNCH_FILES[1], folder.path(), arguments));

    let all = run(&[]);
    let share = installed.display();
    let lines: Vec<String> = all.iter().map(|node| command(node).join(" ")).collect();
    assert_eq!(
        lines,
        [
            format!("lineshaft/lineshaft run {share}/arm6.yaml --sim --ros-args"),
            "robot_state_publisher/robot_state_publisher --ros-args".to_owned(),
            format!("rviz2/rviz2 -d {share}/arm6.rviz --ros-args"),
        ]
    );
    assert_eq!(all[1]["parameters"]["robot_description"], urdf);
    let urdf = format!("urdf:={}", own.display());
    let all = run(&["cell:=/c.yaml", &urdf, "sim:=false", "rviz:=false", "record:=/r"]);
    assert_eq!(command(&all[0]).join(" "), "lineshaft/lineshaft run /c.yaml --record /r --ros-args");
    assert_eq!((all.len(), &all[1]["parameters"]["robot_description"]), (2, &"<robot name='own'/>".into()));
    for file in ["arm6.yaml", "arm6.rviz", "joint_limits.yaml", "moveit_controllers.yaml"] {
        assert!(root().join("launch-configs/arm6").join(file).exists(), "{file}");
    }
    // The frame and the topic that RViz shows.
    let rviz = read("launch-configs/arm6/arm6.rviz");
    assert!(rviz.contains("Fixed Frame: base_link") && rviz.contains("Value: /robot_description"), "{rviz}");
}
