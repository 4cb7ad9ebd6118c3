use super::*;

fn node(full: &str) -> NodeName {
    let (namespace, name) = full.rsplit_once('/').unwrap();
    NodeName::new(if namespace.is_empty() { "/" } else { namespace }, name).unwrap()
}

/// Returns the names that a file gives to a node.
fn names(text: &str, full: &str) -> Vec<String> {
    let overrides = Overrides::of(&read("p.yaml", text).unwrap(), &node(full));
    overrides.iter().map(|(name, _)| name.clone()).collect()
}

#[test]
fn patterns_fit_as_in_rclcpp() {
    for (pattern, full, is_for) in [
        ("/**", "/lineshaft", true),
        ("/**", "/a/b/lineshaft", true),
        ("/*", "/lineshaft", true),
        ("/*", "/a/lineshaft", false),
        ("/*/lineshaft", "/a/lineshaft", true),
        ("/*/lineshaft", "/lineshaft", false),
        ("/*/lineshaft", "/a/b/lineshaft", false),
        ("/**/lineshaft", "/lineshaft", true),
        ("/**/lineshaft", "/a/b/lineshaft", true),
        ("/**/lineshaft", "/a/b/other", false),
        ("/a/**", "/a/b/lineshaft", true),
        ("/a/**", "/b/lineshaft", false),
        ("lineshaft", "/lineshaft", true),
        ("lineshaft", "/a/lineshaft", false),
        ("/lineshaft", "/lineshaft", true),
        ("a/lineshaft", "/a/lineshaft", true),
        ("/linesh", "/lineshaft", false),
    ] {
        assert_eq!(Pattern::parse(pattern).unwrap().fits(&node(full)), is_for, "{pattern} {full}");
    }
    for bad in ["", "/", "a//b", "a*", "/a b", "***"] {
        assert!(Pattern::parse(bad).is_err(), "{bad}");
    }
}

#[test]
fn nested_keys_are_dotted_names() {
    let text = "\
lineshaft:
  ros__parameters:
    use_sim_time: true
    x: {max_velocity: 0.5, saia: {kprop: 3}}
    y.max_velocity: 1
    qos_overrides:
      /joint_states: {publisher: {depth: 1}}
";
    let expected = [
        "qos_overrides./joint_states.publisher.depth",
        "use_sim_time",
        "x.max_velocity",
        "x.saia.kprop",
        "y.max_velocity",
    ];
    assert_eq!(names(text, "/lineshaft"), expected);
    assert!(names(text, "/other").is_empty());
}

#[test]
fn namespaces_may_be_nested_or_written_out() {
    for text in [
        "/a/b/lineshaft: {ros__parameters: {p: 1}}",
        "a: {b: {lineshaft: {ros__parameters: {p: 1}}}}",
        "/a: {b/lineshaft: {ros__parameters: {p: 1}}}",
        "/a: {/**: {ros__parameters: {p: 1}}}",
    ] {
        assert_eq!(names(text, "/a/b/lineshaft"), ["p"], "{text}");
        assert!(names(text, "/lineshaft").is_empty(), "{text}");
    }
}

#[test]
fn later_values_win_and_what_was_meant_for_a_node_has_to_be_there() {
    let text =
        "/**: {ros__parameters: {p: 1, q: 1}}\n/lineshaft: {ros__parameters: {p: 2}}\n'*': {ros__parameters: {p: 3}}\n";
    let mut overrides = Overrides::of(&read("p.yaml", text).unwrap(), &node("/lineshaft"));
    let refused = overrides.check_unused().unwrap_err();
    assert!(refused.starts_with("p.yaml:3:25: no parameter is called `p`; "), "{refused}");
    assert!(!refused.contains("`q`"), "{refused}");
    assert_eq!(overrides.take("p").unwrap().value.integer_value, 3);
    assert_eq!(overrides.check_unused(), Ok(vec!["p.yaml:1:31: no parameter is called `q`".to_owned()]));
}

#[test]
fn what_is_no_file_of_parameters_is_refused_with_its_place() {
    for (text, sentence) in [
        ("", "p.yaml:1:1: names of nodes with ros__parameters below them are expected here"),
        ("lineshaft: 1", "p.yaml:1:12: names of nodes"),
        ("ros__parameters: {a: 1}", "p.yaml:1:1: ros__parameters stands below no node"),
        ("n: {ros__parameters: 1}", "p.yaml:1:22: parameters are expected here"),
        ("n:\n  ros__parameters:\n    a: [1, x]\n", "p.yaml:3:12: x is of another type"),
        ("n:\n  ros__parameters:\n    a:\n", "p.yaml:3:6: a parameter has no value here"),
        ("n: {ros__parameters: {a: 1, a: 2}}", "p.yaml:1:29: duplicate key `a`"),
        ("n-x: {ros__parameters: {a: 1}}", "p.yaml:1:7: \"/n-x\" is no name of a node"),
        ("a: [", "p.yaml:"),
    ] {
        let error = read("p.yaml", text).unwrap_err();
        assert!(error.starts_with(sentence), "{text}: {error}");
    }
}
