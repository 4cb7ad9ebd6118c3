//! Tests the installation: the Debian package with its systemd unit, the container, and completions.

use crate::support::machine::share;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the crate is in the workspace").to_owned()
}

fn read(path: &str) -> String {
    fs::read_to_string(root().join(path)).unwrap_or_else(|error| panic!("{path}: {error}"))
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn lineshaft(arguments: &[&str]) -> Output {
    let _machine = share();
    Command::new(env!("CARGO_BIN_EXE_lineshaft")).args(arguments).output().expect("the program starts")
}

/// Returns the assets of the Debian package: source relative to the folder of the crate, destination, mode. Each is a
/// line.
fn assets() -> Vec<[String; 3]> {
    let manifest = read("node/Cargo.toml");
    let (_, list) = manifest.split_once("\nassets = [\n").expect("the list of assets");
    let (list, _) = list.split_once("\n]").expect("the end of the list");
    list.lines()
        .map(|line| {
            let asset = line.trim().trim_end_matches(',');
            serde_json::from_str(asset).unwrap_or_else(|error| panic!("{asset}: {error}"))
        })
        .collect()
}

/// Returns the absolute paths of files that the package installs under a given name.
fn installed() -> Vec<String> {
    let place = |[source, destination, _]: [String; 3]| {
        let name = source.rsplit('/').next().unwrap_or_default();
        if destination.ends_with('/') { format!("/{destination}{name}") } else { format!("/{destination}") }
    };
    assets().into_iter().map(place).collect()
}

/// Returns the values of a key of the unit, in their order.
fn unit(key: &str) -> Vec<String> {
    let unit = read("packaging/lineshaft@.service");
    unit.lines().filter_map(|line| line.strip_prefix(key)?.strip_prefix('=')).map(str::to_owned).collect()
}

#[test]
fn each_asset_of_the_debian_package_exists_or_is_generated() {
    let (script, assets) = (read("packaging/deb"), assets());
    assert!(assets.len() > 10, "{assets:?}");
    for [source, destination, mode] in &assets {
        assert!(!destination.starts_with('/'), "{destination}: cargo-deb takes paths without the first slash");
        assert_eq!(mode.as_str(), if destination == "usr/bin/" { "755" } else { "644" }, "{destination}");
        if source == "target/release/lineshaft" {
            continue;
        }
        let source = source.strip_prefix("../").unwrap_or_else(|| panic!("{source} is not in the workspace"));
        if let Some(generated) = source.strip_prefix("target/package/") {
            let folder = generated.split('/').next().unwrap_or_default();
            assert!(script.contains(&format!("$generated/{folder}")), "packaging/deb does not make {generated}");
            continue;
        }
        // Up to a pattern.
        let fixed: PathBuf = source.split('/').take_while(|part| !part.contains('*')).collect();
        assert!(root().join(&fixed).exists(), "{source}");
    }
    assert!(script.contains("generated=target/package\n"), "{script}");
    for file in ["LICENSE", "packaging/debian/postinst", "packaging/debian/prerm", "packaging/debian/postrm"] {
        assert!(root().join(file).is_file(), "{file}");
    }
}

#[test]
fn the_unit_runs_the_installed_program_as_the_user_that_the_package_creates() {
    let installed = installed();
    let is_installed = |path: &str| installed.iter().any(|file| file == path);
    assert!(is_installed("/usr/lib/systemd/system/lineshaft@.service"), "{installed:?}");
    let [start]: [String; 1] = unit("ExecStart").try_into().expect("one command");
    let start: Vec<_> = start.split(' ').collect();
    assert_eq!(start, ["/usr/bin/lineshaft", "run", "/etc/lineshaft/%i.yaml", "$LINESHAFT_ARGS"]);
    assert!(is_installed(start[0]), "{installed:?}");
    assert_eq!(unit("EnvironmentFile"), ["-/etc/lineshaft/environment", "-/etc/lineshaft/%i.environment"]);
    assert!(is_installed("/etc/lineshaft/environment"), "{installed:?}");
    assert_eq!(unit("Environment"), ["LINESHAFT_ARGS=", "ROS_HOME=/var/lib/lineshaft"]);
    assert_eq!(unit("StateDirectory"), ["lineshaft"]);
    assert_eq!(unit("WorkingDirectory"), ["/var/lib/lineshaft"]);

    let [user]: [String; 1] = unit("User").try_into().expect("one user");
    let users = read("packaging/sysusers.conf");
    assert!(users.lines().any(|line| line.starts_with(&format!("u {user} ")) && line.ends_with(" /var/lib/lineshaft")));
    assert!(is_installed("/usr/lib/sysusers.d/lineshaft.conf"), "{installed:?}");
    assert!(read("packaging/debian/postinst").contains("systemd-sysusers"));

    let page = unit("Documentation").join(" ");
    let page = page.split_once("file:///usr/share/doc/lineshaft/").expect("a page of the manual").1;
    assert!(root().join(page).is_file(), "{page}");
}

#[test]
fn files_of_the_package_below_etc_are_its_configuration_files() {
    let manifest = read("node/Cargo.toml");
    let line = manifest.lines().find_map(|line| line.strip_prefix("conf-files = ")).expect("the key");
    let mut listed: Vec<String> = serde_json::from_str(line).expect("a list");
    let mut below: Vec<_> = installed().into_iter().filter(|path| path.starts_with("/etc/")).collect();
    listed.sort();
    below.sort();
    assert_eq!(listed, below);
}

/// The arguments in packaging/environment must be those of `run`.
#[test]
fn the_example_in_the_environment_file_is_accepted_by_run() {
    let environment = read("packaging/environment");
    let example = environment.lines().find_map(|line| line.strip_prefix("#LINESHAFT_ARGS=")).expect("an example");
    let mut arguments = vec!["run", "no_such_cell.yaml"];
    arguments.extend(example.split(' '));
    let said = text(&lineshaft(&arguments).stderr);
    assert!(said.contains("no_such_cell.yaml") && !said.contains("unexpected argument"), "{said}");
}

/// SIGTERM stops the axes: tests/ros_axis.rs. A second signal, such as that of an ExecStop, would end the program
/// immediately.
#[test]
fn the_unit_has_realtime_rights_and_leaves_the_axes_time_to_stop() {
    assert_eq!(unit("LimitMEMLOCK"), ["infinity"]);
    let [priority]: [String; 1] = unit("LimitRTPRIO").try_into().expect("one limit");
    // docs/realtime.md: the cycle thread has priority 80.
    assert!(priority.parse::<u8>().expect("a number") >= 80, "{priority}");
    assert_eq!((unit("KillSignal"), unit("KillMode")), (vec!["SIGTERM".to_owned()], vec!["mixed".to_owned()]));
    assert_eq!(unit("ExecStop"), [""; 0]);
    let [time]: [String; 1] = unit("TimeoutStopSec").try_into().expect("one time");
    // Three timeouts of 10 s each: command, standstill, power.
    assert!(time.parse::<u32>().expect("seconds") > 30, "{time}");
    assert_eq!(unit("Restart"), ["no"]);
}

/// Runs a script of the package on a system with systemd and returns its calls of systemctl and systemd-sysusers.
fn calls(script: &str, arguments: &[&str]) -> Vec<String> {
    let _machine = share();
    let system = tempfile::tempdir().expect("room for a temporary folder");
    fs::create_dir_all(system.path().join("run/systemd/system")).expect("the folder can be written");
    let stand_ins =
        "systemctl() { echo \"systemctl $*\"; }; systemd-sysusers() { echo \"systemd-sysusers ${@: -1}\"; }";
    let output = Command::new("bash")
        .args(["-c", &format!("{stand_ins}; . \"$0\"")])
        .arg(root().join("packaging/debian").join(script))
        .args(arguments)
        .env("DPKG_ROOT", system.path())
        .output()
        .expect("the tests need bash");
    assert!(output.status.success(), "{script} {arguments:?}: {}", text(&output.stderr));
    text(&output.stdout).lines().map(str::to_owned).collect()
}

#[test]
fn installing_and_upgrading_neither_start_nor_stop_a_machine() {
    let installed = ["systemd-sysusers lineshaft.conf", "systemctl daemon-reload"];
    assert_eq!(calls("postinst", &["configure"]), installed);
    assert_eq!(calls("postinst", &["configure", "0.1.0-1"]), installed);
    assert_eq!(calls("prerm", &["upgrade", "0.2.0-1"]), [""; 0]);
    assert_eq!(calls("postrm", &["upgrade", "0.2.0-1"]), [""; 0]);
    assert_eq!(calls("postrm", &["purge"]), [""; 0]);
}

#[test]
fn removing_the_package_stops_its_machines_first() {
    assert_eq!(calls("prerm", &["remove"]), ["systemctl stop lineshaft@*.service"]);
    assert_eq!(calls("postrm", &["remove"]), ["systemctl daemon-reload"]);
}

#[test]
fn the_container_copies_what_exists_and_all_crates() {
    let file = read("Containerfile");
    let copies: Vec<_> = file.lines().filter_map(|line| line.strip_prefix("COPY ")).collect();
    let (built, given): (Vec<_>, Vec<_>) = copies.into_iter().partition(|copy| copy.starts_with("--from="));
    assert_eq!(built, ["--from=builder /src/target/release/lineshaft /usr/bin/lineshaft"]);
    let mut copied = Vec::new();
    for copy in given {
        let paths: Vec<_> = copy.split(' ').collect();
        let (_, sources) = paths.split_last().expect("a destination");
        for source in sources {
            assert!(root().join(source).exists(), "COPY {copy}");
            copied.push((*source).to_owned());
        }
    }
    let manifest = read("Cargo.toml");
    let members = manifest.lines().find_map(|line| line.strip_prefix("members = ")).expect("the members");
    let members: Vec<String> = serde_json::from_str(members).expect("a list");
    for member in members {
        let folder = member.split('/').next().unwrap_or_default();
        assert!(copied.iter().any(|source| source == folder), "{folder} of {copied:?}");
    }
    assert!(file.contains(concat!(
        "FROM docker.io/library/rust:",
        env!("CARGO_PKG_RUST_VERSION"),
        "-bookworm AS builder\n"
    )));
    assert!(file.contains("\nUSER lineshaft\n") && file.contains("\nSTOPSIGNAL SIGTERM\n"), "{file}");
    assert!(file.ends_with("ENTRYPOINT [\"/usr/bin/lineshaft\"]\n"), "{file}");
}

#[test]
fn bash_completes_commands() {
    let folder = tempfile::tempdir().expect("room for a temporary folder");
    let script = lineshaft(&["completions", "bash"]);
    assert_eq!(script.status.code(), Some(0), "{}", text(&script.stderr));
    let file = folder.path().join("lineshaft");
    fs::write(&file, &script.stdout).expect("the folder can be written");
    let ask = ". \"$0\"; COMP_WORDS=(lineshaft si); COMP_CWORD=1; _lineshaft lineshaft si lineshaft; echo \"${COMPREPLY[*]}\"";
    let output = Command::new("bash").args(["-c", ask]).arg(&file).output().expect("the tests need bash");
    let (words, said) = (text(&output.stdout), text(&output.stderr));
    assert!(words.split_whitespace().any(|word| word == "sim"), "{words}{said}");
    assert!(words.split_whitespace().all(|word| word.starts_with("si")), "{words}{said}");
}
