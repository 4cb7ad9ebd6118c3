//! `lineshaft state`: prints the axes as `~/axis_states` reports them.

use super::info::{AxisInfo, AxisInfos};
use super::output::{DEFAULT, in_unit, is_screen, position_text, print, short, si_unit, with_commands};
use super::session::{Session, axis_states, own_end};
use super::stop::Stop;
use super::{Failure, Options};
use crate::recording::clean::{clean, escape_json};
use lineshaft_core::code::Code;
use lineshaft_msgs::msg::{AxisState, AxisStates};
use serde_json::{Value, json};
use std::fmt::Write;
use std::time::Duration;
use tokio::time::{Instant, MissedTickBehavior, interval};

/// Time between two prints of `--watch`.
const PERIOD: Duration = Duration::from_millis(200);

/// Format of the states.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct StateForm {
    /// Whether the states are printed repeatedly until a signal is received.
    pub(crate) is_watch: bool,
    /// Whether they are printed as JSON, one object for each message.
    pub(crate) is_json: bool,
}

/// Prints the states of all axes.
///
/// # Errors
/// Returns an error if the node publishes no states.
pub(crate) async fn state(options: &Options, form: StateForm) -> Result<(), Failure> {
    let session = Session::open(options).await?;
    let mut states = axis_states(&session)?;
    let mut newest = session.first_states(&mut states).await?;
    let infos = infos(&session, &newest).await?;
    let mut stop = Stop::listen()?;
    let mut ticks = interval(PERIOD);
    ticks.set_missed_tick_behavior(MissedTickBehavior::Skip);
    let gone = session.gone();
    tokio::pin!(gone);
    let (mut lines, mut heard) = (0, Instant::now());
    loop {
        tokio::select! {
            message = states.next() => {
                newest = message.ok_or_else(own_end)?;
                heard = Instant::now();
            }
            failure = &mut gone => return Err(failure),
            () = stop.requested() => return Ok(()),
            _ = ticks.tick() => {
                if heard.elapsed() >= session.timeout() {
                    return Err(session.no_states().await);
                }
                let text = text(session.target(), &newest, &infos, form);
                // The cursor returns to the first line of the previous table.
                let is_next = lines > 0 && !form.is_json && is_screen();
                let back = if is_next { format!("\x1b[{lines}A\x1b[J") } else { String::new() };
                lines = text.lines().count();
                if !print(&format!("{back}{text}")) || !form.is_watch {
                    return Ok(());
                }
            }
        }
    }
}

async fn infos(session: &Session, states: &AxisStates) -> Result<Vec<AxisInfo>, Failure> {
    let mut infos = AxisInfos::open(session)?;
    let mut all = Vec::new();
    for axis in &states.axes {
        all.push(infos.find(session, &axis.name).await?.unwrap_or_default());
    }
    Ok(all)
}

fn text(node: &str, states: &AxisStates, infos: &[AxisInfo], form: StateForm) -> String {
    match form {
        StateForm { is_json: true, is_watch: true } => escape_json(&json_of(node, states, infos).to_string()),
        StateForm { is_json: true, is_watch: false } => {
            let text = format!("{:#}", json_of(node, states, infos));
            text.lines().map(escape_json).collect::<Vec<_>>().join("\n")
        }
        // The reader may expect the default node.
        StateForm { is_json: false, .. } if node != DEFAULT => {
            format!("node {}\n{}", clean(node), table(node, states, infos))
        }
        StateForm { is_json: false, .. } => table(node, states, infos),
    }
}

/// Returns the name of a state in AxisState.msg.
fn state_name(state: u8) -> &'static str {
    match state {
        AxisState::DISABLED => "DISABLED",
        AxisState::STANDSTILL => "STANDSTILL",
        AxisState::DISCRETE_MOTION => "DISCRETE_MOTION",
        AxisState::CONTINUOUS_MOTION => "CONTINUOUS_MOTION",
        AxisState::HOMING => "HOMING",
        AxisState::SYNCHRONIZED_MOTION => "SYNCHRONIZED_MOTION",
        AxisState::STOPPING => "STOPPING",
        AxisState::ERROR_STOP => "ERROR_STOP",
        _ => "unknown",
    }
}

/// Returns a line for each axis, with columns of equal width, then a line for each error.
fn table(node: &str, states: &AxisStates, infos: &[AxisInfo]) -> String {
    let header = ["axis", "state", "enabled", "homed", "position", "velocity", "error"].map(str::to_owned);
    let rows = states.axes.iter().zip(infos).map(|(axis, info)| row(axis, *info));
    let rows: Vec<[String; 7]> = std::iter::once(header).chain(rows).collect();
    let mut widths = [0; 7];
    for row in &rows {
        for (width, cell) in widths.iter_mut().zip(row) {
            *width = (*width).max(cell.chars().count());
        }
    }
    let line = |row: &[String; 7]| {
        let cells: Vec<_> = row.iter().zip(widths).map(|(cell, width)| format!("{cell:width$}")).collect();
        cells.join("  ").trim_end().to_owned()
    };
    let errors = states.axes.iter().filter_map(|axis| error_line(axis, node));
    rows.iter().map(line).chain(errors).collect::<Vec<_>>().join("\n")
}

fn row(axis: &AxisState, AxisInfo { kind, unit }: AxisInfo) -> [String; 7] {
    let yes_no = |is: bool| (if is { "yes" } else { "no" }).to_owned();
    [
        clean(&axis.name).into_owned(),
        state_name(axis.state).to_owned(),
        yes_no(axis.enabled),
        yes_no(axis.homed),
        position_text(axis.position, kind, unit),
        format!("{} {}", short(axis.velocity), si_unit(kind, 1)).trim_end().to_owned(),
        axis.error_code.to_string(),
    ]
}

/// Returns the error of an axis with its cause and remedy, if it has one.
pub(super) fn error_line(axis: &AxisState, node: &str) -> Option<String> {
    if axis.error_code == 0 {
        return None;
    }
    let name = clean(&axis.name);
    let mut line = format!("{name}: error {}", axis.error_code);
    if let Some(row) = Code(axis.error_code).row() {
        let remedy = with_commands(&format!("{} {}", row.cause, row.remedy), &[&*name], node);
        // Writing to a string cannot fail.
        let _ = write!(line, " {}: {remedy}", row.name);
    }
    Some(line)
}

fn json_of(node: &str, states: &AxisStates, infos: &[AxisInfo]) -> Value {
    let axes: Vec<_> = states.axes.iter().zip(infos).map(|(axis, info)| json_of_axis(axis, *info)).collect();
    let stamp = &states.header.stamp;
    json!({
        "node": node,
        "cycle": states.cycle,
        "stamp": {"sec": stamp.sec, "nanosec": stamp.nanosec},
        "axes": axes,
    })
}

fn json_of_axis(axis: &AxisState, AxisInfo { kind, unit }: AxisInfo) -> Value {
    json!({
        "name": axis.name,
        "state": state_name(axis.state),
        "enabled": axis.enabled,
        "homed": axis.homed,
        "in_position": axis.in_position,
        "position": axis.position,
        "position_increments": axis.position_increments,
        "position_in_unit": in_unit(axis.position, kind, unit),
        "velocity": axis.velocity,
        "unit": si_unit(kind, 0),
        "following_error": axis.following_error,
        "error_code": axis.error_code,
        "error": Code(axis.error_code).row().filter(|_| axis.error_code != 0).map(|row| row.name),
        "warning": axis.warning,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use lineshaft_core::unit::{ScaleKind, Unit};

    fn states() -> (AxisStates, Vec<AxisInfo>) {
        let axis =
            |name: &str, state, position| AxisState { name: name.to_owned(), state, position, ..AxisState::default() };
        let x = AxisState { enabled: true, homed: true, velocity: 0.2, ..axis("x", AxisState::DISCRETE_MOTION, 0.05) };
        let failed = AxisState { error_code: 10202, ..axis("turret", AxisState::ERROR_STOP, 0.0) };
        let infos = vec![
            AxisInfo { kind: Some(ScaleKind::Linear), unit: Some(Unit::MILLIMETRE) },
            AxisInfo { kind: Some(ScaleKind::Rotary), unit: Some(Unit::RADIAN) },
        ];
        (AxisStates { cycle: 7, axes: vec![x, failed], ..AxisStates::default() }, infos)
    }

    #[test]
    fn table_has_a_line_for_each_axis_and_for_each_error() {
        let (states, infos) = states();
        let text = table(DEFAULT, &states, &infos);
        let lines: Vec<_> = text.lines().collect();
        assert_eq!(lines.len(), 4);
        assert_eq!(lines[0], "axis    state            enabled  homed  position        velocity  error");
        assert_eq!(lines[1], "x       DISCRETE_MOTION  yes      yes    0.05 m (50 mm)  0.2 m/s   0");
        assert_eq!(lines[2], "turret  ERROR_STOP       no       no     0 rad           0 rad/s   10202");
        assert!(lines[3].starts_with("turret: error 10202 "), "{}", lines[3]);
    }

    #[test]
    fn table_of_another_node_begins_with_its_name() {
        let (states, infos) = states();
        let form = StateForm { is_watch: false, is_json: false };
        assert!(text("/lineshaft", &states, &infos, form).starts_with("axis  "));
        assert!(text("/second", &states, &infos, form).starts_with("node /second\naxis  "));
    }

    #[test]
    fn remedies_name_the_command_that_resets_errors() {
        for row in Code::rows().filter(|row| !row.code.is_none()) {
            let axis = AxisState { name: "x".to_owned(), error_code: row.code.0, ..AxisState::default() };
            let line = error_line(&axis, DEFAULT).unwrap();
            assert!(!line.contains("reset_errors"), "{line}");
        }
        let drive = AxisState { name: "x".to_owned(), error_code: 10204, ..AxisState::default() };
        assert!(error_line(&drive, DEFAULT).unwrap().ends_with(" Remove the cause, then `lineshaft reset x`."));
        let second = error_line(&drive, "/second").unwrap();
        assert!(second.ends_with(" Remove the cause, then `lineshaft reset x --node /second`."), "{second}");
    }

    #[test]
    fn json_has_numbers_in_si_and_names_of_the_interface() {
        let (states, infos) = states();
        let value = json_of("/lineshaft", &states, &infos);
        assert_eq!((&value["node"], &value["cycle"]), (&json!("/lineshaft"), &json!(7)));
        let (x, turret) = (&value["axes"][0], &value["axes"][1]);
        assert_eq!((&x["name"], &x["state"], &x["position"]), (&json!("x"), &json!("DISCRETE_MOTION"), &json!(0.05)));
        assert_eq!((&x["unit"], &x["position_in_unit"], &x["error"]), (&json!("m"), &json!("50 mm"), &Value::Null));
        assert_eq!((&turret["error_code"], &turret["position_in_unit"]), (&json!(10202), &Value::Null));
        assert!(turret["error"].is_string());
    }
}
