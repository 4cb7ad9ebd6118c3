//! Draws docs/images/tune_plants.svg and generates its table: six plants with different difficulties, a step before and
//! after.

use super::*;
use crate::cell::Cell;
use crate::tune::{Bounds, Ended, Setting, Subject, try_simulated};
use lineshaft_tune::Margins;
use std::fmt::Write as _;

/// 2e-4 kg m^2 and 2 Nm with a delay of 0.25 ms, kv in series with a velocity loop, both with the defaults of a new
/// controller.
fn cell(counts: u32, plant: &str, keys: &str) -> Cell {
    let text = format!(
        "lineshaft: 1\ncycle: 1 ms\nbackends: {{plant: {{type: sim}}}}\naxes:\n  x:\n    type: rotary\n    unit: rev\n    \
         scale: {{increments: {counts}, per: 1 rev}}\n    drive: {{backend: plant, address: 0, interface: torque}}\n    max_velocity: 45 rev/s\n    \
         max_acceleration: 100 rev/s^2\n    max_following_error: 2 rev\n    max_effort: 1000\n{keys}    sim:\n      model: motor\n      \
         inertia: 2e-4 kg*m^2\n      rated_torque: 2 Nm\n      max_torque: 2 Nm\n      dead_time: 250 us\n      viscous_friction: 2e-3 Nm*s/rad\n      \
         counts_per_turn: {counts} inc\n{plant}"
    );
    Cell::parse("cell.yaml", text).unwrap_or_else(|problems| panic!("{problems}"))
}

fn found(cell: &Cell, inertia_ratio: Option<f64>) -> Findings {
    let (config, bounds) = (&cell.machine, Bounds { effort: Some(0.5), inertia_ratio, ..Bounds::default() });
    let setting = Setting::of(config, "x", |place| config.axes[place].power_on(), &bounds).expect("an axis");
    let (ended, record) = try_simulated(cell, setting, None, |_| {}).expect("a trial");
    assert_eq!(ended, Ended::Done);
    let subject = Subject::of(&config.axes[0], &config.axes[0].power_on());
    Findings::find(subject, &record, &setting.wish, &setting.before).expect("a model")
}

/// Returns for each plant: name in figure and table, counts of the encoder, plant, keys of the loops, given inertia
/// ratio.
fn plants() -> [(&'static str, u32, &'static str, &'static str, Option<f64>); 6] {
    // In Hz: 10 ms, and 5 ms for the coarse encoder.
    let (slow, slower) = (
        "    velocity_loop: {estimator: filtered, bandwidth: 32}\n",
        "    velocity_loop: {estimator: filtered, bandwidth: 16}\n",
    );
    [
        ("inertia 1:1", 8192, "      inertia_ratio: 1\n      coulomb_friction: 0.06 Nm\n", "", None),
        ("inertia 1:30", 8192, "      inertia_ratio: 30\n      coulomb_friction: 0.06 Nm\n", "", None),
        ("friction, 25 %", 8192, "      inertia_ratio: 5\n      coulomb_friction: 0.5 Nm\n", "", None),
        (
            "elastic, 60 Hz",
            8192,
            "      inertia_ratio: 3\n      coulomb_friction: 0.06 Nm\n      stiffness: 21.3 Nm/rad\n      coupling_damping: 3.4e-3 Nm*s/rad\n",
            slower,
            None,
        ),
        (
            "backlash, 1:3",
            8192,
            "      inertia_ratio: 3\n      coulomb_friction: 0.02 Nm\n      stiffness: 133 Nm/rad\n      coupling_damping: 8.5e-3 Nm*s/rad\n      backlash: 0.5 deg\n",
            "",
            Some(3.0),
        ),
        ("500 inc/turn", 500, "      inertia_ratio: 5\n      coulomb_friction: 0.06 Nm\n", slow, None),
    ]
}

#[test]
fn the_figure_of_six_plants_is_drawn_by_the_program() {
    let mut panels = Vec::new();
    let mut rows = String::new();
    for (name, counts, plant, keys, ratio) in plants() {
        let found = found(&cell(counts, plant, keys), ratio);
        let (before, after) = (found.before.as_ref().expect("loops"), found.after.as_ref().expect("gains"));
        let panel = step(&found, &[("before", LineStyle::Old, before), ("after", LineStyle::New, after)]);
        panels.push(Panel { up: Axis { label: format!("{name} (inc)"), ..panel.up }, height: 130.0, ..panel });
        let told = |answer: &Answer| {
            let settled = answer.step.figures.settling;
            let settled = settled.map_or_else(|| "not".to_owned(), |time| format!("{:.0} ms", 1000.0 * time));
            format!("{:.0} %, {settled}", answer.step.figures.overshoot)
        };
        let Margins { phase, gain, .. } = after.margins;
        let gains: Vec<String> = found.gains.iter().map(|gain| format!("{} {}", gain.key, gain.written())).collect();
        let (before, after, gains) = (told(before), told(after), gains.join(", "));
        let size = found.step.distance();
        let _ =
            writeln!(rows, "| {name} | {size:.0} inc | {before} | {after} | {phase:.0} deg, {gain:.0} dB | {gains} |");
    }
    let chart = Chart { title: "six axes: a step before and after".to_owned(), panels, width: WIDTH };
    let made = String::from_utf8(draw_chart(&chart, Target::Svg).expect("a figure")).expect("text");
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/images/tune_plants.svg");
    if std::env::var_os("LINESHAFT_RENEW").is_some() {
        std::fs::write(&path, &made).expect("written");
    }
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/loops.md");
    let page = std::fs::read_to_string(page).expect("the page");
    assert!(page.contains(&rows), "put it there:\n{rows}");
    let there = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(there == made, "draw it anew: LINESHAFT_RENEW=1 cargo test -p lineshaft --lib tune");
}
