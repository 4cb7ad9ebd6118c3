//! Compares control loops of the core with an independent calculation: `peers/loops.py` has the plant by scipy, and the
//! control laws of the documents. It gets the command of each cycle and no measured values of the program.

use crate::support::machine::share;
use crate::support::setup;
use serde_json::{Value, json};
use std::io::Write as _;
use std::path::Path;
use std::process::{Command, Stdio};

/// Commands of a test: a step within two cycles, one that saturates, a velocity, a sinusoid.
fn scenario([step, large, run, back]: [&str; 4], amplitude: f64) -> String {
    let mut text = format!(
        "scenario: loops\nfor: 5 s\n\
         trace: [x.enabled, x.command.position, x.command.fraction, x.command.velocity, x.command.acceleration, x.actual.count, \
         x.output.effort, x.output.velocity, x.error]\n\
         steps:\n  - {{at: 0, do: {{enable: {{axes: [x]}}}}}}\n  - {{at: 100, do: {{move_axis: {{axis: x, {step}}}}}}}\n  \
         - {{at: 1000, do: {{move_axis: {{axis: x, {large}}}}}}}\n  - {{at: 2000, do: {{move_axis: {{axis: x, mode: velocity, {run}}}}}}}\n  \
         - {{at: 2600, do: {{move_axis: {{axis: x, position: 0 inc, {back}}}}}}}\n  - at: 3700\n    do:\n      follow_joint_trajectory:\n        joints: [x]\n        units: increments\n        points:\n"
    );
    // Three periods of 0.4 s, on a cosine from standstill.
    let w = std::f64::consts::TAU / 0.4;
    for point in 1..=60 {
        let t = f64::from(point) * 0.02;
        let (position, velocity) = (amplitude * (1.0 - (w * t).cos()), amplitude * w * (w * t).sin());
        text += &format!("          - {{time: {t:.2} s, positions: [{position:.6}], velocities: [{velocity:.6}]}}\n");
    }
    text
}

/// Returns one column of a table with a header.
fn column(text: &str, name: &str) -> Vec<f64> {
    let mut lines = text.lines();
    let head: Vec<_> = lines.next().expect("a head").split(',').collect();
    let place =
        head.iter().position(|column| *column == name).unwrap_or_else(|| panic!("no column {name} in {head:?}"));
    lines.map(|line| line.split(',').nth(place).and_then(|word| word.parse().ok()).expect("a number")).collect()
}

/// Runs a cell, and compares it with the independent calculation. `output` is the signal of the drive command; `within`
/// are the permitted differences: of the position in counts, and of the output as a fraction of its maximum.
fn agrees(cell: &str, scenario: &str, output: &str, within: (f64, f64), mut question: Value) {
    let _machine = share();
    let folder = tempfile::tempdir().expect("a folder");
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).expect("it is written");
    write("cell.yaml", cell);
    write("scenario.yaml", scenario);
    let run = Command::new(env!("CARGO_BIN_EXE_lineshaft"))
        .args(["sim", "cell.yaml", "--scenario", "scenario.yaml", "--csv", "run.csv"])
        .current_dir(folder.path())
        .output()
        .expect("the program was built");
    assert!(run.status.success(), "{}{}", String::from_utf8_lossy(&run.stdout), String::from_utf8_lossy(&run.stderr));
    let text = std::fs::read_to_string(folder.path().join("run.csv")).expect("the table");
    let of = |name: &str| column(&text, name);
    let first = of("x.enabled").iter().position(|on| *on == 1.0).expect("it came on");
    assert!(of("x.error").iter().all(|code| *code == 0.0), "an error");
    let [position, fraction, velocity, acceleration] =
        ["position", "fraction", "velocity", "acceleration"].map(|part| of(&format!("x.command.{part}")));
    let (counts, outputs) = (of("x.actual.count"), of(output));
    let command: Vec<_> =
        (first..position.len()).map(|k| json!([position[k] + fraction[k], velocity[k], acceleration[k]])).collect();
    question["command"] = command.into();
    let answer = asked(&question);
    let numbers = |name: &str| -> Vec<f64> { serde_json::from_value(answer[name].clone()).expect("numbers") };
    let largest = outputs.iter().fold(0.0_f64, |most, output| most.max(output.abs()));
    let moved = counts.iter().fold(0.0_f64, |most, count| most.max(count.abs()));
    assert!(largest > 0.0 && moved > 1000.0, "it has hardly moved: {moved}");
    for (k, (count, asked)) in numbers("counts").into_iter().zip(numbers("outputs")).enumerate() {
        let (seen, given) = (counts[first + k], outputs[first + k]);
        let cycle = first + k;
        assert!((seen - count).abs() <= within.0, "cycle {cycle}: the axis counts {seen}, beside it {count}");
        assert!((given - asked).abs() <= within.1 * largest, "cycle {cycle}: {output} is {given}, beside it {asked}");
    }
}

fn asked(question: &Value) -> Value {
    let script: &Path = &setup::sources().join("loops.py");
    let mut command = Command::new(setup::python());
    command.arg("-B").arg(script).stdin(Stdio::piped()).stdout(Stdio::piped());
    let mut child = command.spawn().expect("the interpreter was just found");
    child.stdin.take().expect("it is a pipe").write_all(question.to_string().as_bytes()).expect("the script reads it");
    let output = child.wait_with_output().expect("it was started");
    assert!(output.status.success(), "loops.py ended with {}", output.status);
    serde_json::from_slice(&output.stdout).expect("an answer in JSON")
}

/// Position and velocity loop with a motor: its command and its position, cycle by cycle.
///
/// Proves: MACS-REG-12, MACS-AMP-01, MACS-AMP-04
#[test]
fn the_cascade_on_a_motor_is_the_computed_one() {
    let cell = "lineshaft: 1\ncycle: 1 ms\nbackends: {plant: {type: sim}}\naxes:\n  x:\n    type: rotary\n    unit: rev\n    \
         scale: {increments: 20000, per: 1 rev}\n    drive: {backend: plant, address: 0, interface: torque, regulator: pid}\n    \
         max_velocity: 1000000 inc/s\n    max_acceleration: 500000000 inc/s^2\n    max_following_error: 100000 inc\n    \
         in_position_window: 10 inc\n    max_effort: 2000\n    kprop: 2\n    kder: 3\n    kint: 0\n    ffvel: 900\n    ffacc: 500\n    \
         velkprop: 940\n    velkint: 23\n    velkilim: 4000\n    sim: {model: motor, inertia: 2e-4 kg*m^2, load_inertia: 6e-4 kg*m^2, \
         rated_torque: 2 Nm, max_torque: 6 Nm, viscous_friction: 2e-3 Nm*s/rad, counts_per_turn: 20000 inc}\n";
    let rates = "acceleration: 400000000 inc/s^2, deceleration: 400000000 inc/s^2";
    let moves = [
        &format!("position: 400 inc, velocity: 400000 inc/s, {rates}"),
        &format!("position: 20000 inc, velocity: 1000000 inc/s, {rates}"),
        "velocity: 60000 inc/s, acceleration: 1000000 inc/s^2",
        "velocity: 200000 inc/s, acceleration: 2000000 inc/s^2, deceleration: 2000000 inc/s^2",
    ];
    let scenario = scenario(moves, 3000.0);
    let question = json!({
        "cycle": 1e-3, "period": 1, "max_velocity": 1e6, "max_acceleration": 5e8, "max_effort": 2000.0,
        "gains": {"kprop": 2, "kder": 3, "kint": 0, "kilim": 1000, "bandwidth": 1000, "ffvel": 900, "ffacc": 500,
                  "velkprop": 940, "velkint": 23, "velkilim": 4000},
        "plant": {"kind": "motor", "inertia": 8e-4, "viscous": 2e-3, "counts_per_turn": 20000.0, "rated_torque": 2.0, "max_torque": 6.0},
    });
    agrees(cell, &scenario, "x.output.effort", (0.0, 1e-9), question);
}

/// The four structures of a power stage with a winding, whose current, velocity and position scipy discretises: the
/// command of the stage and the position of the axis, cycle by cycle. AMPMAXCUR is reached in the modes that have it.
///
/// Proves: MACS-AMP-01, MACS-AMP-07, MACS-AMP-08, MACS-REG-12
#[test]
fn the_structures_of_a_power_stage_are_the_computed_ones() {
    for (mode, kprop, kder, ffvel, ffacc) in
        [(0, 60, 0, 1000, 0), (1, 60, 0, 900, 0), (2, 300, 6000, 0, 0), (3, 60, 60, 833, 0)]
    {
        let cell = format!(
            "lineshaft: 1\ncycle: 1 ms\nbackends: {{plant: {{type: sim}}}}\naxes:\n  x:\n    type: rotary\n    unit: rev\n    \
             scale: {{increments: 20000, per: 1 rev}}\n    drive: {{backend: plant, address: 0, interface: voltage, regulator: pid}}\n    \
             max_velocity: 300000 inc/s\n    max_acceleration: 50000000 inc/s^2\n    max_following_error: 1000000 inc\n    \
             in_position_window: 10 inc\n    max_effort: 1000\n    torque_constant: 25\n    full_current: 10\n    ampmode: {mode}\n    \
             ampmaxcur: 6000\n    curkprop: 1389\n    curkint: 142\n    curkilim: 5000\n    kprop: {kprop}\n    kder: {kder}\n    \
             kint: 0\n    ffvel: {ffvel}\n    ffacc: {ffacc}\n    velkprop: 500\n    velkint: 10\n    velkilim: 4000\n    \
             sim: {{model: motor, inertia: 5e-4 kg*m^2, voltage: 48 V, resistance: 1.2 Ohm, inductance: 3 mH, \
             torque_constant: 0.4 Nm/A, back_emf: 0.4 V*s/rad, viscous_friction: 1e-3 Nm*s/rad, counts_per_turn: 20000 inc}}\n"
        );
        let rates = "acceleration: 30000000 inc/s^2, deceleration: 30000000 inc/s^2";
        let moves = [
            &format!("position: 400 inc, velocity: 200000 inc/s, {rates}"),
            &format!("position: 20000 inc, velocity: 300000 inc/s, {rates}"),
            "velocity: 60000 inc/s, acceleration: 1000000 inc/s^2",
            "velocity: 200000 inc/s, acceleration: 2000000 inc/s^2, deceleration: 2000000 inc/s^2",
        ];
        let question = json!({
            "cycle": 1e-3, "period": 1, "max_velocity": 3e5, "max_acceleration": 5e7, "max_effort": 1000.0,
            "ampmode": mode, "full_current": 10.0, "ampmaxcur": 6000.0,
            "gains": {"kprop": kprop, "kder": kder, "kint": 0, "kilim": 1000, "bandwidth": 1000, "ffvel": ffvel, "ffacc": ffacc,
                      "velkprop": 500, "velkint": 10, "velkilim": 4000, "curkprop": 1389, "curkint": 142, "curkilim": 5000},
            "plant": {"kind": "winding", "inertia": 5e-4, "viscous": 1e-3, "counts_per_turn": 20000.0, "voltage": 48.0,
                      "resistance": 1.2, "inductance": 3e-3, "torque_constant": 0.4, "back_emf": 0.4},
        });
        agrees(&cell, &scenario(moves, 3000.0), "x.output.effort", (0.0, 1e-9), question);
    }
}

/// The PID with a drive that lags behind its velocity, every other cycle, with an integral part that reaches its limit.
///
/// Proves: MACS-REG-01, MACS-REG-04, MACS-REG-05, MACS-REG-08, MACS-REG-12
#[test]
fn the_pid_on_a_drive_of_velocities_is_the_computed_one() {
    let cell = "lineshaft: 1\ncycle: 1 ms\nbackends: {plant: {type: sim}}\naxes:\n  x:\n    type: rotary\n    unit: rev\n    \
         scale: {increments: 2000, per: 1 rev}\n    drive: {backend: plant, address: 0, interface: velocity, regulator: pid}\n    \
         max_velocity: 100000 inc/s\n    max_acceleration: 50000000 inc/s^2\n    max_following_error: 20000 inc\n    \
         in_position_window: 10 inc\n    kprop: 30\n    kder: 15\n    kint: 1\n    kilim: 2000\n    bandwidth: 900\n    ffvel: 700\n    \
         ffacc: 300\n    timer: 2\n    sim: {model: velocity, time_constant: 4 ms}\n";
    let rates = "acceleration: 40000000 inc/s^2, deceleration: 40000000 inc/s^2";
    let moves = [
        &format!("position: 40 inc, velocity: 40000 inc/s, {rates}"),
        &format!("position: 4000 inc, velocity: 100000 inc/s, {rates}"),
        "velocity: 30000 inc/s, acceleration: 1000000 inc/s^2",
        "velocity: 60000 inc/s, acceleration: 2000000 inc/s^2, deceleration: 2000000 inc/s^2",
    ];
    let scenario = scenario(moves, 300.0);
    let question = json!({
        "cycle": 1e-3, "period": 2, "max_velocity": 1e5, "max_acceleration": 5e7, "max_effort": 0.0,
        "gains": {"kprop": 30, "kder": 15, "kint": 1, "kilim": 2000, "bandwidth": 900, "ffvel": 700, "ffacc": 300},
        "plant": {"kind": "lag", "time_constant": 4e-3},
    });
    // The simulated drive rounds its velocity to 2^-32 inc/s, so that a count may be earlier or later: (30 + 2 * 15) /
    // 60000 of the output.
    agrees(cell, &scenario, "x.output.velocity", (1.0, 1.1e-3), question);
}
