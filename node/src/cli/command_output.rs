//! Output of a command: text, or with `--json` one JSON object (docs/json.md).
//!
//! Law      with `--json` standard output has one line with the object, and the command prints nothing on standard
//!          error
//! Writes   `format`, `command`, `exit_code`, `problems`, `errors`, `warnings` and `notes`, and the fields of the command
//! Refuses  nothing: characters that control a terminal are escaped

use super::{Exit, complain, say};
use crate::document::{Place, Problem, Problems};
use crate::progress::{MOMENT, Progress};
use crate::recording::clean::{clean, clean_lines, escape_json};
use crate::recording::run::Run;
use crate::scenario::Failure;
use serde_json::{Map, Value as Json, json};
use std::fmt::Display;

/// Version of the objects; it changes if a field is renamed or gets another meaning.
const FORMAT: u32 = 1;

/// Output of one command.
#[derive(Debug)]
pub(super) struct Output {
    command: &'static str,
    collected: Option<Collected>,
}

#[derive(Debug, Default)]
struct Collected {
    fields: Map<String, Json>,
    problems: Vec<Json>,
    errors: Vec<String>,
    warnings: Vec<String>,
    notes: Vec<String>,
}

impl Output {
    /// Creates the output of a command with that name.
    pub(super) fn new(command: &'static str, is_json: bool) -> Self {
        Self { command, collected: is_json.then(Collected::default) }
    }

    /// Whether the output is JSON.
    pub(super) fn is_json(&self) -> bool {
        self.collected.is_some()
    }

    /// Prints a text, unless the output is JSON.
    pub(super) fn say(&self, text: &dyn Display) {
        if !self.is_json() {
            say(&clean_lines(&text.to_string()));
        }
    }

    /// Sets a field of the object.
    pub(super) fn set(&mut self, field: &str, value: Json) {
        if let Some(collected) = &mut self.collected {
            collected.fields.insert(field.to_owned(), value);
        }
    }

    /// Prints an error.
    pub(super) fn complain(&mut self, error: &dyn Display) {
        match &mut self.collected {
            Some(collected) => collected.errors.push(error.to_string()),
            None => complain(error),
        }
    }

    /// Prints the problems of files, one per line.
    pub(super) fn problems(&mut self, problems: &Problems) {
        match &mut self.collected {
            Some(collected) => {
                collected.problems.extend(problems.sorted().iter().map(problem));
                collected.errors.extend(omitted(problems));
            }
            None => eprint!("{}", clean_lines(&problems.to_string())),
        }
    }

    /// Prints the problems of files as one error.
    pub(super) fn complain_of(&mut self, problems: &Problems) {
        if self.is_json() {
            self.problems(problems);
        } else {
            complain(&problems.to_string().trim_end());
        }
    }

    /// Prints a warning on standard error.
    pub(super) fn warn(&mut self, warning: &dyn Display) {
        match &mut self.collected {
            Some(collected) => collected.warnings.push(warning.to_string()),
            None => eprintln!("warning: {}", clean(&warning.to_string())),
        }
    }

    /// Prints a note on standard error.
    pub(super) fn note(&mut self, note: &dyn Display) {
        match &mut self.collected {
            Some(collected) => collected.notes.push(note.to_string()),
            None => eprintln!("note: {}", clean(&note.to_string())),
        }
    }

    /// Prints a line of the report that has no field of its own.
    pub(super) fn remark(&mut self, line: &str) {
        match &mut self.collected {
            Some(collected) => collected.notes.push(line.to_owned()),
            None => say(&clean(line)),
        }
    }

    /// Shows a progress bar while the messages of a run are read, until [`Run::end_progress`].
    pub(super) fn watch(&self, run: &mut Run) {
        if !self.is_json() {
            watch(run);
        }
    }

    /// Prints the object.
    pub(super) fn finish(self, exit: Exit) -> Exit {
        if let Some(object) = self.object(exit) {
            say(&escape_json(&object.to_string()));
        }
        exit
    }

    /// Returns the object, if the output is JSON.
    pub(super) fn object(self, exit: Exit) -> Option<Json> {
        let Collected { mut fields, problems, errors, warnings, notes } = self.collected?;
        let common = [
            ("format", json!(FORMAT)),
            ("command", json!(self.command)),
            ("exit_code", json!(exit.code())),
            ("problems", Json::Array(problems)),
            ("errors", json!(errors)),
            ("warnings", json!(warnings)),
            ("notes", json!(notes)),
        ];
        fields.extend(common.map(|(name, value)| (name.to_owned(), value)));
        Some(Json::Object(fields))
    }
}

/// Shows a progress bar while the messages of a run are read.
pub(super) fn watch(run: &mut Run) {
    let mut progress = Progress::new("bytes", MOMENT);
    run.set_progress(move |done, of| progress.set_with(done, Some(of), String::new));
}

/// Returns problems of files as objects.
pub(super) fn problems_json(problems: &Problems) -> Vec<Json> {
    problems.sorted().iter().map(problem).collect()
}

/// Returns failures at locations of a file as objects of the same form.
pub(super) fn failures_json(file: &str, failures: &[Failure]) -> Vec<Json> {
    failures.iter().map(|failure| object(file, failure.place, &failure.sentence, None)).collect()
}

fn problem(problem: &Problem) -> Json {
    object(&problem.file, problem.place, &problem.sentence, problem.hint.as_deref())
}

fn object(file: &str, Place { line, col }: Place, message: &str, hint: Option<&str>) -> Json {
    json!({"file": file, "line": line, "column": col, "message": message, "hint": hint})
}

/// Returns the message about problems that were only counted.
pub(super) fn omitted(problems: &Problems) -> Option<String> {
    match problems.count() - problems.sorted().len() {
        0 => None,
        more => Some(format!("{more} more problems")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn printed(output: Output, exit: Exit) -> Json {
        let text = escape_json(&output.object(exit).unwrap().to_string());
        assert!(!text.contains('\n'), "{text}");
        serde_json::from_str(&text).unwrap()
    }

    #[test]
    fn object_has_the_common_fields_of_every_command() {
        let object = printed(Output::new("check", true), Exit::Good);
        let expected = json!({
            "format": 1, "command": "check", "exit_code": 0, "problems": [], "errors": [], "warnings": [], "notes": []
        });
        assert_eq!(object, expected);
        assert_eq!(Output::new("check", false).object(Exit::Good), None);
    }

    #[test]
    fn problems_have_file_line_column_message_and_hint() {
        let problems = Problems::new("dir/cell \"1\".yaml");
        problems.push(Place { line: 7, col: 3 }, "unknown key `a\u{1b}b`", Some("did you mean `ab`?".to_owned()));
        problems.push(Place { line: 2, col: 1 }, "cycle is 0", None);
        let mut output = Output::new("check", true);
        output.problems(&problems);
        output.complain(&"disk full");
        output.warn(&"w");
        output.note(&"n");
        output.remark("line");
        output.set("cell", Json::Null);
        let object = printed(output, Exit::Usage);
        let file = "dir/cell \"1\".yaml";
        // Sorted by line and column, as in the text output.
        let expected = json!([
            {"file": file, "line": 2, "column": 1, "message": "cycle is 0", "hint": null},
            {"file": file, "line": 7, "column": 3, "message": "unknown key `a\u{1b}b`", "hint": "did you mean `ab`?"},
        ]);
        assert_eq!(object["problems"], expected);
        assert_eq!((&object["errors"], &object["warnings"]), (&json!(["disk full"]), &json!(["w"])));
        assert_eq!((&object["notes"], &object["exit_code"]), (&json!(["n", "line"]), &json!(2)));
        assert_eq!(object.get("cell"), Some(&Json::Null));
    }

    #[test]
    fn problems_beyond_those_that_are_kept_are_counted() {
        let problems = Problems::new("a.yaml");
        for line in 1..=1003 {
            problems.push(Place { line, col: 1 }, "wrong", None);
        }
        let mut output = Output::new("check", true);
        output.problems(&problems);
        let object = printed(output, Exit::Usage);
        assert_eq!(object["problems"].as_array().map(Vec::len), Some(1000));
        assert_eq!(object["errors"], json!(["3 more problems"]));
    }

    #[test]
    fn text_that_steers_a_terminal_is_escaped_and_read_back() {
        let mut output = Output::new("sim", true);
        let name = "\u{1b}[2J\u{9b}\u{202e}\u{2028}\u{fc}\u{1f600}\"\\";
        output.set("name", json!(name));
        let text = escape_json(&output.object(Exit::Good).unwrap().to_string());
        assert!(text.contains("\\u001b[2J\\u009b\\u202e\\u2028\u{fc}\u{1f600}\\\"\\\\"), "{text}");
        assert_eq!(serde_json::from_str::<Json>(&text).unwrap()["name"], json!(name));
    }
}
