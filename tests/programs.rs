//! Tests WebAssembly programs of users: `lineshaft program` on the command line, and their replacement by a client on
//! Cyclone DDS.

use crate::support::machine::share;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use crate::support::{domain::Domain, peer::Peer, program::Program};
use serde_json::{Value, json};

const CELL: &str = "\
lineshaft: 1
cycle: 1 ms
memory:
  md: {type: i32}
  en: {type: bit}
  lamp: {type: bit}
programs:
  copy: {wasm: copy.wasm}
functions:
  copied: {slot: 0, type: apsf, program: copy, source: md, inputs: [en], outputs: [lamp], out_bits: 1}
axes: {}
";

fn root(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(path)
}

/// A folder with a cell and modules, used as the working folder.
struct Bench(tempfile::TempDir);

impl Bench {
    fn new() -> Self {
        let bench = Self(tempfile::tempdir().expect("a folder"));
        bench.write("cell.yaml", CELL.as_bytes());
        for (from, to) in [
            ("program/tests/modules/template.wasm", "copy.wasm"),
            ("launch-configs/functions/programs/fb10.wasm", "fb10.wasm"),
            ("launch-configs/functions/programs/fir.wasm", "fir.wasm"),
        ] {
            std::fs::copy(root(from), bench.path(to)).expect("a module");
        }
        bench
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn write(&self, name: &str, bytes: &[u8]) {
        std::fs::write(self.path(name), bytes).expect("written");
    }

    fn run(&self, line: &str) -> Output {
        let _machine = share();
        let mut command = Command::new(env!("CARGO_BIN_EXE_lineshaft"));
        command.args(line.split_whitespace()).current_dir(self.0.path()).output().expect("it runs")
    }

    /// Returns exit code, standard output and standard error.
    fn run_to_end(&self, line: &str) -> (i32, String, String) {
        let Output { status, stdout, stderr } = self.run(line);
        let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("text");
        (status.code().unwrap_or(-1), text(stdout), text(stderr))
    }
}

/// Proves: AMK-APSF-46
#[test]
fn a_program_is_checked_and_tried_at_the_prompt() {
    let bench = Bench::new();
    let (code, out, _) = bench.run_to_end("program check fb10.wasm");
    assert_eq!(code, 0);
    assert!(out.contains("memory: 1 x 64 KiB") && out.contains("952 bytes, 8 of them its own"), "{out}");
    bench.write("in.csv", b"inputs,source\n1,100\n1,110\n1,90\n");
    let (code, out, _) = bench.run_to_end("program run fb10.wasm in.csv");
    let sinks: Vec<_> = out.lines().skip(1).filter_map(|line| line.split(',').nth(2)).collect();
    assert_eq!((code, sinks), (0, vec!["0", "150000", "-300000"]));
    let (code, out, err) = bench.run_to_end("program run fb10.wasm in.csv --fuel 5");
    assert_eq!((code, &*out, &*err), (1, "line,command,sink,outputs,fuel\n", "in.csv:2: it used up its fuel\n"));
    bench.write("bad.csv", b"inputs,source\n1,x\n");
    let (code, _, err) = bench.run_to_end("program run fb10.wasm bad.csv");
    let least = "-9223372036854775808 to 9223372036854775807";
    assert_eq!((code, err), (2, format!("bad.csv:2:3: `x` is no whole number from {least}\n")));
    let (code, _, err) = bench.run_to_end("program check cell.yaml");
    assert_eq!(
        (code, &*err),
        (2, "error: cell.yaml: it is no WebAssembly: its first four bytes are others than \\0asm\n")
    );
    let (code, out, _) = bench.run_to_end("program new speed");
    assert_eq!((code, out.lines().count()), (0, 5));
    let (code, _, err) = bench.run_to_end("program new speed");
    assert_eq!((code, &*err), (2, "error: speed: it exists already; nothing was written\n"));
}

#[test]
fn program_errors_are_reported_at_their_place_in_the_cell() {
    let bench = Bench::new();
    assert_eq!(bench.run_to_end("check cell.yaml").0, 0);
    bench.write("copy.wasm", b"\0asm\x01\0\0\0");
    let (code, _, err) = bench.run_to_end("check cell.yaml");
    assert_eq!((code, &*err), (2, "cell.yaml:8:16: `copy.wasm`: it exports no function `cycle`\n"));
    std::fs::remove_file(bench.path("copy.wasm")).expect("it is there");
    let (code, _, err) = bench.run_to_end("check cell.yaml");
    assert_eq!(code, 2);
    assert!(err.starts_with("cell.yaml:8:16: cannot read `copy.wasm`: No such file"), "{err}");
}

/// A filter with floating-point numbers and loops, a program that panics, and a program that is replaced while it runs.
const RUN: &str = "\
scenario: run
cycles: 600
drive:
  - {signal: md, at: 0, ramp: {from: 0, per_cycle: 13, until: 7000}, then: hold}
  - {signal: en, at: 0, values: [1], then: hold}
steps:
  - {at: 5, do: {command_function: {function: copied, command: start}}}
  - {at: 5, do: {command_function: {function: mean, command: start}}}
  - {at: 5, do: {command_function: {function: bits, command: start}}}
  - {at: 300, do: {load_program: {program: copy, wasm: fb10.wasm, state: keep}}}
expect:
  - {signal: bits.error, at: end, is: 3093}
  - {signal: mean.active, at: end, is: 1}
";

#[test]
fn a_run_is_the_same_bytes_twice_and_in_its_replay() {
    let bench = Bench::new();
    let more = "\
programs:
  fir: {wasm: fir.wasm}
  ab216: {wasm: ab216.wasm}
  copy:";
    let functions = "\
functions:
  mean: {slot: 1, type: apsf, program: fir, source: md}
  bits: {slot: 2, type: apsf, program: ab216, source: md}
";
    let cell = CELL.replace("programs:\n  copy:", more).replace("functions:\n", functions);
    bench.write("cell.yaml", cell.as_bytes());
    bench.write("run.yaml", RUN.as_bytes());
    std::fs::copy(root("launch-configs/functions/programs/ab216.wasm"), bench.path("ab216.wasm")).expect("a module");
    let runs = ["a.mcap", "b.mcap"].map(|name| {
        let (code, out, err) = bench.run_to_end(&format!("sim cell.yaml --scenario run.yaml --record {name}"));
        assert_eq!(code, 0, "{out}{err}");
        std::fs::read(bench.path(name)).expect("a bag")
    });
    let [first, second] = &runs;
    assert!(first == second, "two runs of one scenario differ");
    for name in ["copy.wasm", "fb10.wasm", "fir.wasm", "ab216.wasm"] {
        std::fs::remove_file(bench.path(name)).expect("it is there");
    }
    let (code, out, err) = bench.run_to_end("replay a.mcap");
    assert_eq!(code, 0, "the modules are in the bag: {out}{err}");
    let (_, out, _) = bench.run_to_end("bag info a.mcap");
    assert!(out.contains("program_sha256.fir: "), "{out}");
}

#[test]
fn a_client_exchanges_a_program_that_runs() {
    let bench = Bench::new();
    let domain = Domain::take();
    let mut cyclone = Peer::cyclone(&domain);
    let cell = bench.path("cell.yaml");
    let args = ["run", cell.to_str().expect("text"), "--store", "none", "--flight-recorder", "0"];
    let _program = Program::start(&args, &domain);
    let function = |cyclone: &mut Peer| -> Value { cyclone.run("functions /lineshaft")["functions"]["copied"].clone() };
    cyclone.run("function /lineshaft copied start");
    cyclone.run("set-memory /lineshaft en=1 md=100");
    assert_eq!((&function(&mut cyclone)["sink"], &function(&mut cyclone)["outputs"]), (&json!(100), &json!(1)));
    let load = |name: &str, module: &str, state: &str| {
        format!("load-program /lineshaft {name} {} {state}", bench.path(module).display())
    };
    bench.write("none.wasm", b"");
    for (request, sentence) in [
        (load("copies", "fb10.wasm", "keep"), "no program is called `copies`; copy are known"),
        (load("copy", "none.wasm", "keep"), "copy: it is no WebAssembly: its first four bytes are others than \\0asm"),
        (
            load("copy", "fir.wasm", "keep"),
            "copy: its image has 2560 bytes, that of the program which runs has 952: its state cannot be kept",
        ),
    ] {
        assert_eq!(cyclone.fails(&request), sentence);
    }
    assert_eq!(function(&mut cyclone)["sink"], 100, "refused changes nothing");
    // The new program returns the movement of the source since the last call: 0.
    cyclone.run(&load("copy", "fb10.wasm", "keep"));
    assert_eq!((&function(&mut cyclone)["sink"], &function(&mut cyclone)["active"]), (&json!(0), &json!(true)));
    cyclone.run(&load("copy", "fir.wasm", "reset"));
    assert_eq!(function(&mut cyclone)["active"], true);
}
