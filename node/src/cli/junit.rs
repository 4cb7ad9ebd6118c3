//! Writes test results as JUnit XML, which Jenkins, GitLab and GitHub Actions read.
//!
//! Law      elements and attributes are those of the schema junit-10.xsd of the xunit plugin of Jenkins, the strictest
//!          of these readers, and `file` and `line` of test cases: GitLab and GitHub Actions link them, and some
//!          versions of the plugin support them
//! Refuses  nothing: characters that XML 1.0 does not allow are written as `\u{1b}`

use super::{Exit, command_output::Output};
use crate::recording::plot::replace;
use std::collections::HashMap;
use std::fmt::Write;
use std::path::Path;

/// Test cases of one scenario or of one comparison.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Suite {
    /// Name of the suite.
    pub(super) name: String,
    /// Names and values that a reader may show.
    pub(super) properties: Vec<(&'static str, String)>,
    /// Duration, in s.
    pub(super) seconds: f64,
    /// Group of the cases: a reader shows it as a class, with its dots as packages.
    pub(super) class: String,
    /// Cases in their order.
    pub(super) cases: Vec<Case>,
}

/// A test case.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Case {
    /// Name of the case; if several of a suite have the same name, the later ones get a number.
    pub(super) name: String,
    /// Location of the case, if it is in a text file.
    pub(super) source: Option<Source>,
    /// Result of the case.
    pub(super) outcome: Outcome,
}

/// Location of a test case.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Source {
    /// Path of the file, as given.
    pub(super) file: String,
    /// Line number from 1, if it is a single line.
    pub(super) line: Option<usize>,
}

/// Result of a test case.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Outcome {
    Passed,
    /// The case was skipped, with the reason.
    Skipped(String),
    /// The case failed, with a message, and file and line if known.
    Failed(String),
    /// The case could not run, with the reason.
    Error(String),
}

impl Suite {
    /// Returns a suite with one case that could not run.
    pub(super) fn not_run(reason: &str) -> Self {
        let case = Case { name: "scenarios".to_owned(), source: None, outcome: Outcome::Error(reason.to_owned()) };
        Self {
            name: "lineshaft".to_owned(),
            properties: Vec::new(),
            seconds: 0.0,
            class: "lineshaft".to_owned(),
            cases: vec![case],
        }
    }

    fn count(&self, is_it: impl Fn(&Outcome) -> bool) -> usize {
        self.cases.iter().filter(|case| is_it(&case.outcome)).count()
    }

    fn failures(&self) -> usize {
        self.count(|outcome| matches!(outcome, Outcome::Failed(_)))
    }

    fn errors(&self) -> usize {
        self.count(|outcome| matches!(outcome, Outcome::Error(_)))
    }
}

/// Writes the suites to a file, if one was given, replacing an existing file. If this fails, a successful command
/// fails.
pub(super) fn write(path: Option<&Path>, command: &str, suites: &[Suite], exit: Exit, output: &mut Output) -> Exit {
    let Some(path) = path else { return exit };
    let written = replace(path, xml(command, suites).as_bytes());
    match written {
        Ok(()) => exit,
        Err(error) => {
            output.complain(&format_args!("--junit: {error}"));
            if exit == Exit::Good { Exit::Failed } else { exit }
        }
    }
}

/// Converts a path to the class of its cases: `cells/press.scenario.yaml` to `cells.press`.
pub(super) fn class_of(path: &Path) -> String {
    let text = path.display().to_string();
    let text = text.strip_suffix(".yaml").unwrap_or(&text);
    let text = text.strip_suffix(".scenario").unwrap_or(text);
    let parts = text.split('/').filter(|part| !part.is_empty() && *part != ".");
    parts.map(|part| part.replace('.', "_")).collect::<Vec<_>>().join(".")
}

/// Returns the content of the file.
fn xml(command: &str, suites: &[Suite]) -> String {
    let sum = |of: fn(&Suite) -> usize| suites.iter().map(of).sum::<usize>();
    // The sum of an empty iterator is -0.
    let seconds = suites.iter().fold(0.0, |sum, suite| sum + suite.seconds);
    let mut text = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n".to_owned();
    push(
        &mut text,
        format_args!(
            "<testsuites name=\"{}\" tests=\"{}\" failures=\"{}\" errors=\"{}\" time=\"{seconds:.3}\">\n",
            escaped(command),
            sum(|suite| suite.cases.len()),
            sum(Suite::failures),
            sum(Suite::errors),
        ),
    );
    suites.iter().for_each(|suite| push_suite(&mut text, suite));
    text.push_str("</testsuites>\n");
    text
}

fn push_suite(text: &mut String, suite: &Suite) {
    push(
        text,
        format_args!(
            "  <testsuite name=\"{}\" tests=\"{}\" failures=\"{}\" errors=\"{}\" skipped=\"{}\" time=\"{:.3}\">\n",
            escaped(&suite.name),
            suite.cases.len(),
            suite.failures(),
            suite.errors(),
            suite.count(|outcome| matches!(outcome, Outcome::Skipped(_))),
            suite.seconds,
        ),
    );
    if !suite.properties.is_empty() {
        text.push_str("    <properties>\n");
        for (name, value) in &suite.properties {
            let value = escaped(value);
            push(text, format_args!("      <property name=\"{name}\" value=\"{value}\"/>\n"));
        }
        text.push_str("    </properties>\n");
    }
    let mut known: HashMap<&str, usize> = HashMap::new();
    for case in &suite.cases {
        let count = known.entry(&case.name).or_insert(0);
        *count += 1;
        let number = if *count > 1 { format!(" ({count})") } else { String::new() };
        let (class, name) = (escaped(&suite.class), escaped(&case.name));
        push(text, format_args!("    <testcase classname=\"{class}\" name=\"{name}{number}\""));
        push_source(text, case.source.as_ref());
        push_outcome(text, &case.outcome);
    }
    text.push_str("  </testsuite>\n");
}

/// Adds the attributes `file` and `line` of a test case.
fn push_source(text: &mut String, source: Option<&Source>) {
    let Some(Source { file, line }) = source else { return };
    push(text, format_args!(" file=\"{}\"", escaped(file)));
    if let Some(line) = line {
        push(text, format_args!(" line=\"{line}\""));
    }
}

/// Adds the rest of a test case, after its attributes.
fn push_outcome(text: &mut String, outcome: &Outcome) {
    let (element, said) = match outcome {
        Outcome::Passed => return text.push_str("/>\n"),
        Outcome::Skipped(why) => {
            let why = escaped(why);
            return push(text, format_args!(">\n      <skipped message=\"{why}\"/>\n    </testcase>\n"));
        }
        Outcome::Failed(said) => ("failure", said),
        Outcome::Error(said) => ("error", said),
    };
    let (first, all) = (escaped(said.lines().next().unwrap_or_default()), escaped(said));
    push(
        text,
        format_args!(">\n      <{element} message=\"{first}\" type=\"{element}\">{all}</{element}>\n    </testcase>\n"),
    );
}

fn push(text: &mut String, more: std::fmt::Arguments<'_>) {
    // Writing to a string cannot fail.
    let _ = text.write_fmt(more);
}

/// Escapes a text for an attribute or an element.
fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&apos;"),
            // In attributes, readers would replace the characters themselves by spaces.
            '\n' => escaped.push_str("&#10;"),
            '\t' => escaped.push_str("&#9;"),
            bad if bad.is_control() || matches!(bad, '\u{fffe}' | '\u{ffff}') => escaped.extend(bad.escape_default()),
            good => escaped.push(good),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;
    use roxmltree::{Document, Node};

    fn case(name: &str, outcome: Outcome) -> Case {
        Case { name: name.to_owned(), source: None, outcome }
    }

    fn at(file: &str, line: Option<usize>) -> Option<Source> {
        Some(Source { file: file.to_owned(), line })
    }

    fn named<'a, 'd>(node: Node<'a, 'd>, name: &'static str) -> Vec<Node<'a, 'd>> {
        node.children().filter(|child| child.has_tag_name(name)).collect()
    }

    /// Checks the attributes that junit-10.xsd allows and those that it requires.
    #[track_caller]
    fn assert_attributes(node: Node<'_, '_>, allowed: &[&str], required: &[&str]) {
        let names: Vec<&str> = node.attributes().map(|attribute| attribute.name()).collect();
        assert!(names.iter().all(|name| allowed.contains(name)), "{names:?}");
        assert!(required.iter().all(|name| names.contains(name)), "{names:?}");
    }

    #[test]
    fn junit_has_the_elements_and_counts_of_the_schema() {
        let suites = [
            Suite {
                name: "a.scenario.yaml".to_owned(),
                properties: vec![("scenario", "press".to_owned())],
                seconds: 1.5,
                class: "a".to_owned(),
                cases: vec![
                    Case { source: at("a & b/a.scenario.yaml", None), ..case("one", Outcome::Passed) },
                    Case {
                        source: at("a.scenario.yaml", Some(4)),
                        ..case("two", Outcome::Failed("a.scenario.yaml:4:5: x is 1\nmore".to_owned()))
                    },
                    case("two", Outcome::Skipped("step `s` never fired".to_owned())),
                ],
            },
            Suite {
                name: "b".to_owned(),
                cases: vec![case("load", Outcome::Error("b:1:1: bad".to_owned()))],
                ..Suite::default()
            },
        ];
        let text = xml("lineshaft sim", &suites);
        let document = Document::parse(&text).unwrap();
        let root = document.root_element();
        assert!(root.has_tag_name("testsuites"));
        assert_attributes(root, &["name", "time", "tests", "failures", "errors"], &[]);
        let attributes = ["name", "tests", "failures", "errors", "time"].map(|name| root.attribute(name).unwrap());
        assert_eq!(attributes, ["lineshaft sim", "4", "1", "1", "1.500"]);
        let suites = named(root, "testsuite");
        for suite in &suites {
            let required = ["name", "tests", "failures", "errors"];
            assert_attributes(*suite, &[&required[..], &["time", "skipped"][..]].concat(), &required);
            for case in named(*suite, "testcase") {
                assert_attributes(case, &["name", "classname", "time", "file", "line"], &["name"]);
            }
        }
        let counts = |suite: Node<'_, '_>| {
            ["tests", "failures", "errors", "skipped"].map(|name| suite.attribute(name).unwrap().to_owned())
        };
        assert_eq!(
            (counts(suites[0]), counts(suites[1])),
            (["3", "1", "0", "1"].map(str::to_owned), ["1", "0", "1", "0"].map(str::to_owned))
        );
        let cases = named(suites[0], "testcase");
        let names: Vec<_> =
            cases.iter().map(|case| (case.attribute("classname").unwrap(), case.attribute("name").unwrap())).collect();
        assert_eq!(names, [("a", "one"), ("a", "two"), ("a", "two (2)")]);
        let sources: Vec<_> = cases.iter().map(|case| (case.attribute("file"), case.attribute("line"))).collect();
        let second = (Some("a.scenario.yaml"), Some("4"));
        assert_eq!(sources, [(Some("a & b/a.scenario.yaml"), None), second, (None, None)]);
        let failure = named(cases[1], "failure")[0];
        assert_eq!(failure.attribute("message"), Some("a.scenario.yaml:4:5: x is 1"));
        assert_eq!(failure.text(), Some("a.scenario.yaml:4:5: x is 1\nmore"));
        assert_eq!(named(cases[2], "skipped")[0].attribute("message"), Some("step `s` never fired"));
        assert_eq!(named(named(suites[1], "testcase")[0], "error")[0].attribute("type"), Some("error"));
        let property = named(named(suites[0], "properties")[0], "property")[0];
        assert_eq!((property.attribute("name"), property.attribute("value")), (Some("scenario"), Some("press")));
    }

    #[test]
    fn junit_escapes_what_xml_does_not_have() {
        let nasty = "a <b> & \"c\" 'd' ]]> \t\n\r\u{0}\u{1b}\u{9b}\u{ffff}\u{fc}\u{1f600}";
        let suite = Suite {
            name: nasty.to_owned(),
            cases: vec![case(nasty, Outcome::Failed(nasty.to_owned()))],
            ..Suite::default()
        };
        let text = xml("x", &[suite]);
        let document = Document::parse(&text).unwrap_or_else(|error| panic!("{error}: {text}"));
        let read = "a <b> & \"c\" 'd' ]]> \t\n\\r\\u{0}\\u{1b}\\u{9b}\\u{ffff}\u{fc}\u{1f600}";
        let suite = named(document.root_element(), "testsuite")[0];
        assert_eq!(suite.attribute("name"), Some(read));
        let failure = named(named(suite, "testcase")[0], "failure")[0];
        assert_eq!(failure.text(), Some(read));
    }

    #[test]
    fn class_is_the_path_without_dots_of_its_own() {
        let class = |path: &str| class_of(Path::new(path));
        assert_eq!(class("./cells/press.scenario.yaml"), "cells.press");
        assert_eq!(class("/tmp/v1.2/s.yaml"), "tmp.v1_2.s");
        assert_eq!(class("../a.scenario.yaml"), "__.a");
    }
}
