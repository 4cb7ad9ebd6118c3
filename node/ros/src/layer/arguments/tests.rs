use super::*;

fn take(line: &str) -> Result<(RosArguments, Vec<String>), ArgumentError> {
    RosArguments::take(line.split_whitespace().map(str::to_owned))
}

fn node(line: &str) -> String {
    take(&format!("--ros-args {line}")).unwrap().0.node_name("lineshaft", "/cell").unwrap().to_string()
}

#[test]
fn ros_arguments_are_taken_and_the_rest_is_left() {
    let (taken, rest) = take("run cell.yaml --ros-args -r __node:=shaft --remap __ns:=/a -- --sim").unwrap();
    assert_eq!(taken.node_name("lineshaft", "/").unwrap().to_string(), "/a/shaft");
    assert_eq!(rest, ["run", "cell.yaml", "--sim"]);
    assert_eq!(take("run -r x").unwrap(), (RosArguments::default(), vec!["run".into(), "-r".into(), "x".into()]));
    assert_eq!(take("run --ros-args").unwrap(), (RosArguments::default(), vec!["run".into()]));
    assert_eq!(take("--ros-args -- a --ros-args --").unwrap(), (RosArguments::default(), vec!["a".into()]));
}

#[test]
fn first_matching_node_rule_is_used() {
    assert_eq!(node(""), "/cell/lineshaft");
    assert_eq!(node("-r __name:=a --ros-args -r __node:=b"), "/cell/a");
    assert_eq!(node("-r other:__node:=a -r lineshaft:__node:=b"), "/cell/b");
    assert_eq!(node("-r __ns:=/x/y"), "/x/y/lineshaft");
    // rcl matches the rule for the namespace with the new name.
    assert_eq!(node("-r __node:=b -r lineshaft:__ns:=/x -r b:__ns:=/y"), "/y/b");
    let bad = take("--ros-args -r __node:=a-b").unwrap().0.node_name("lineshaft", "/").unwrap_err();
    assert!(bad.to_string().contains("'-' is not allowed"), "{bad}");
}

#[test]
fn switches_and_levels_are_taken() {
    let (taken, _) = take(
        "--ros-args --log-level WARN --log-level lineshaft:=debug --disable-rosout-logs --disable-stdout-logs \
         --enable-external-lib-logs --disable-external-lib-logs -e /machines",
    )
    .unwrap();
    assert_eq!(taken.levels, [(String::new(), Level::Warn), ("lineshaft".to_owned(), Level::Debug)]);
    assert_eq!((taken.rosout_logs, taken.stdout_logs), (false, false));
    assert_eq!(taken.enclave.as_deref(), Some("/machines"));
    let (taken, _) = take("--ros-args --disable-rosout-logs --enable-rosout-logs --enable-stdout-logs").unwrap();
    assert_eq!(taken, RosArguments::default());
}

#[test]
fn last_of_several_values_is_used() {
    let folder = std::env::temp_dir().join(format!("lineshaft-arguments-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let file = folder.join("p.yaml");
    std::fs::write(&file, "/**:\n  ros__parameters: {a: 1, b: 1, c: 1}\n").unwrap();
    let line = format!("--ros-args -p a:=0 --params-file {} -p b:=2 -p other:c:=3 -p lineshaft:d:=4", file.display());
    let node = NodeName::new("/", "lineshaft").unwrap();
    let overrides = take(&line).unwrap().0.overrides(&node);
    let seen: Vec<(&str, i64)> =
        overrides.iter().map(|(name, given)| (name.as_str(), given.value.integer_value)).collect();
    assert_eq!(seen, [("a", 1), ("b", 2), ("c", 1), ("d", 4)]);
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn invalid_arguments_are_named() {
    let error = |line: &str| take(&format!("--ros-args {line}")).unwrap_err().to_string();
    assert!(error("--parms-file p.yaml").starts_with(r#"ROS argument "--parms-file" is not known"#));
    assert!(error("x").starts_with(r#"ROS argument "x" is not known"#));
    assert!(error("--log-config-file f").starts_with("ROS argument --log-config-file is not supported: "));
    assert!(error("--log-file-name f").starts_with("ROS argument --log-file-name is not supported: "));
    assert_eq!(error("-r __node=x"), r#"-r is followed by "__node=x"; [NODE:]FROM:=TO is needed"#);
    assert_eq!(error("--remap"), "--remap is not followed by anything, [NODE:]FROM:=TO is needed");
    assert_eq!(error("-p a"), r#"-p is followed by "a"; [NODE:]NAME:=VALUE is needed"#);
    assert!(error("-p a:=").ends_with("is needed: a parameter has no value here"));
    assert!(error("-p a:=[1,x]").contains("another type"));
    assert!(error("-p n*:a:=1").contains(r#""n*" is no word"#));
    assert!(error("-p :=1").contains(r#""" is no name of a parameter"#));
    assert!(error("--log-level loud").starts_with(r#"--log-level is followed by "loud"; [LOGGER:=]debug"#));
    assert!(error("--log-level").contains("is not followed by anything"));
    assert!(error("-e").contains("is not followed by anything"));
    let missing = error("--params-file /no/such/file.yaml");
    assert!(missing.starts_with("--params-file /no/such/file.yaml: "), "{missing}");
}
