//! Formats findings for a terminal.
//!
//! Law      a block for the model, one for the loops before and after, one for the gains; then warnings. Columns are as
//!          wide as their widest entry; each number has its unit, in increments and in the unit of the axis
//! Reads    findings
//! Writes   lines in ASCII
//! Refuses  nothing
//!
//! A deviation counts as large if it exceeds a tenth of the value and also the resolution of a loop: a tenth of a
//! cycle, or two hundredths of the full output.

use super::findings::{Answer, Findings, Subject, stiffness};
use lineshaft_tune::{Dynamics, Margins, Move};
use std::fmt::Write as _;

/// Explained fraction, in %, below which a model is weak.
const WELL_EXPLAINED: f64 = 95.0;

/// Maximum deviation as a fraction of the value.
const MOST_DEVIATION: f64 = 0.1;

/// Resolution of a loop: fraction of a cycle, fraction of the full output.
const TELLS: (f64, f64) = (0.1, 0.02);

const TIME_CONSTANT: &str = "time constant";
const DELAY: &str = "delay";

/// A value of the model.
struct Figure {
    name: &'static str,
    value: f64,
    deviation: f64,
    /// Unit; for a position or its derivatives, the power of seconds by which it is divided.
    unit: Unit,
    /// Deviation below which it does not matter.
    tells: f64,
}

#[derive(Clone, Copy)]
enum Unit {
    /// Divided by this power of seconds.
    Rate(u32),
    Other(&'static str),
    /// Time, shown in ms.
    Time,
}

impl Findings {
    /// Returns the warnings, one sentence each.
    pub fn warnings(&self) -> Vec<String> {
        let mut said = Vec::new();
        let explained = self.identified.explained;
        if explained < WELL_EXPLAINED {
            said.push(format!(
                "The model explains {explained:.0} % of the motion; below {WELL_EXPLAINED:.0} % gains that follow from it are doubtful."
            ));
        }
        let figures = self.figures();
        let vague = |figure: &&Figure| figure.part() > MOST_DEVIATION && figure.deviation > figure.tells;
        // One can replace the other, because the loops depend on their sum.
        let lags = [TIME_CONSTANT, DELAY];
        let are_one = figures.iter().filter(|figure| lags.contains(&figure.name)).filter(vague).count() == lags.len();
        if are_one {
            let sum: f64 = figures.iter().filter(|figure| lags.contains(&figure.name)).map(|figure| figure.value).sum();
            said.push(format!(
                "Time constant and delay cannot be told apart; together they are {} ms.",
                rounded(1000.0 * sum, 3)
            ));
        }
        for figure in figures.iter().filter(vague) {
            if !(are_one && lags.contains(&figure.name)) {
                said.push(format!(
                    "The {} is known to {:.0} % only; a longer excitation, or one with more way, tells it better.",
                    figure.name,
                    100.0 * figure.part().min(9.99)
                ));
            }
        }
        match &self.before {
            Ok(before) if !before.is_stable() => {
                said.push("With the gains that are set the model is unstable.".to_owned());
            }
            Ok(_) => {}
            Err(sentence) => said.push(format!("The loops that are set cannot be shown: {sentence}.")),
        }
        if let Err(sentence) = &self.after {
            said.push(format!("There are no gains: {sentence}."));
        }
        said.extend(self.of_play());
        said
    }

    /// Returns warnings about backlash and a given inertia ratio.
    fn of_play(&self) -> Vec<String> {
        let Dynamics::Effort { acceleration, coulomb, .. } = self.identified.model.dynamics else { return Vec::new() };
        let ratio = self.wish.inertia_ratio;
        if ratio == 0.0 {
            let hint = "Where there is play, tell the inertia of the load by the motor's: --inertia-ratio, or inertia_ratio of ~/tune.";
            return if self.is_misfit { vec![hint.to_owned()] } else { Vec::new() };
        }
        let shows = if self.is_misfit { "play, or what else the model does not know" } else { "no play" };
        let mut said = vec![
            format!(
                "The load was told to have {} times the inertia of the motor; the record shows {shows}.",
                short(ratio)
            ),
            "Margins are the worse ones of the whole inertia and of the motor alone; all else is that of the whole."
                .to_owned(),
        ];
        let (model, designed) = (&self.identified.model, self.identified.for_design(ratio));
        if designed.delay > model.delay + TELLS.0 * model.cycle {
            let delay = rounded(1000.0 * designed.delay, 3);
            said.push(format!("Play hides a part of the delay, which counts as {delay} ms."));
        }
        if let Ok(after) = &self.after {
            let held = coulomb / acceleration / stiffness(&after.loops);
            if held > self.subject.window {
                let held = self.subject.place(held.round());
                said.push(format!(
                    "Dry friction holds it up to {held} from its target until an integral part has overcome it."
                ));
            }
        }
        said
    }

    /// Returns the report.
    pub fn text(&self) -> String {
        let subject = &self.subject;
        let mut text = format!("axis {}", subject.axis);
        if subject.has_unit() {
            let _ = write!(text, ", {} inc in 1 {}", short(subject.increments), subject.unit);
        }
        let _ = writeln!(
            text,
            "\n\nmodel of a drive of {}, which explains {} % of the motion:",
            self.takes(),
            share(self.identified.explained)
        );
        text += &table(&self.figures().iter().map(|figure| figure.row(subject)).collect::<Vec<_>>());
        let _ = writeln!(text, "\nloops:");
        text += &table(&self.loops());
        if !self.gains.is_empty() {
            let _ = writeln!(text, "\ngains:");
            text += &table(&self.gain_rows());
        }
        for sentence in self.warnings() {
            let _ = write!(text, "\n{sentence}");
        }
        if !text.ends_with('\n') {
            text.push('\n');
        }
        text
    }

    fn takes(&self) -> &'static str {
        match self.identified.model.dynamics {
            Dynamics::Velocity { .. } => "velocities",
            Dynamics::Effort { .. } => "efforts",
        }
    }

    fn figures(&self) -> Vec<Figure> {
        let (model, deviation) = (&self.identified.model, &self.identified.deviation);
        let (of_cycle, of_output) = (TELLS.0 * model.cycle, TELLS.1);
        let figure = |name, value, deviation, unit, tells| Figure { name, value, deviation, unit, tells };
        let mut figures = match model.dynamics {
            Dynamics::Velocity { gain, time_constant, offset } => vec![
                figure("velocity at full command", gain, deviation.gain, Unit::Rate(1), 0.0),
                figure("velocity at no command", offset, deviation.offset, Unit::Rate(1), of_output * gain),
                figure(TIME_CONSTANT, time_constant, deviation.time_constant, Unit::Time, of_cycle),
            ],
            Dynamics::Effort { acceleration, viscous, coulomb, load, .. } => {
                let tells = of_output * acceleration;
                let by_velocity = tells / self.wish.max_velocity;
                vec![
                    figure("acceleration at full command", acceleration, deviation.gain, Unit::Rate(2), 0.0),
                    figure("viscous friction", viscous, deviation.viscous, Unit::Other("1/s"), by_velocity),
                    figure("Coulomb friction", coulomb, deviation.coulomb, Unit::Rate(2), tells),
                    figure("load", load, deviation.load, Unit::Rate(2), tells),
                ]
            }
        };
        figures.push(figure(DELAY, model.delay, deviation.delay, Unit::Time, of_cycle));
        if let Dynamics::Effort { resonance: Some(r), .. } = model.dynamics {
            figures.extend([
                figure("resonance", r.frequency, deviation.frequency, Unit::Other("Hz"), 0.0),
                figure("its damping", r.damping, deviation.damping, Unit::Other(""), 0.0),
                figure(
                    "inertia of the load by the motor's",
                    r.inertia_ratio,
                    deviation.inertia_ratio,
                    Unit::Other(""),
                    0.0,
                ),
            ]);
        }
        figures
    }

    fn loops(&self) -> Vec<Vec<String>> {
        let sides = [self.before.as_ref().ok(), self.after.as_ref().ok()];
        let row = |name: String, of: &dyn Fn(&Answer) -> String| {
            let of = |side: Option<&Answer>| side.map_or_else(|| "-".to_owned(), of);
            vec![name, of(sides[0]), of(sides[1])]
        };
        let mut rows = vec![vec![String::new(), "before".to_owned(), "after".to_owned()]];
        rows.extend(margin_rows("position loop", &row, &|answer| Some(answer.margins)));
        if sides.iter().flatten().any(|side| side.velocity.is_some()) {
            rows.extend(margin_rows("velocity loop", &row, &|answer| answer.velocity_margins));
        }
        let subject = &self.subject;
        let window = subject.place(subject.window);
        rows.push(vec![format!("step of {}", subject.place(self.step.distance()))]);
        rows.push(row("  overshoot".to_owned(), &|answer| percent(answer.step.figures.overshoot)));
        let of_step = subject.place(subject.step_window(&self.step));
        rows.push(row(format!("  within {of_step} after"), &|answer| settled(answer.step.figures.settling)));
        let at = match self.to {
            Move::Trapezoid { velocity, .. } => format!(" at {}", subject.rate(velocity, 1)),
            Move::Step { .. } => String::new(),
        };
        rows.push(vec![format!("move of {}{at}", subject.place(self.to.distance()))]);
        let error = |answer: &Answer| format!("{} inc", rounded(answer.moved.figures.following_error, 3));
        rows.push(row("  following error".to_owned(), &error));
        rows.push(row(format!("  within {window} after"), &|answer| settled(answer.moved.figures.settling)));
        rows
    }

    fn gain_rows(&self) -> Vec<Vec<String>> {
        let unit = |key: &str| {
            if key == "timer" {
                " ms"
            } else if key.ends_with("kv") {
                " 1/s"
            } else {
                ""
            }
        };
        let mut rows = vec![vec![String::new(), "before".to_owned(), "after".to_owned()]];
        rows.extend(self.gains.iter().map(|gain| {
            let old = gain.old.map_or_else(|| "-".to_owned(), |old| format!("{}{}", short(old), unit(gain.key)));
            let new = format!("{}{}", gain.written(), unit(gain.key));
            let same = if gain.changes() { "" } else { "as it is" };
            vec![format!("  {}", gain.key), old, new, same.to_owned()]
        }));
        rows
    }
}

type Row<'r> = &'r dyn Fn(String, &dyn Fn(&Answer) -> String) -> Vec<String>;

fn margin_rows(name: &str, row: Row<'_>, of: &dyn Fn(&Answer) -> Option<Margins>) -> Vec<Vec<String>> {
    let of = |answer: &Answer, text: &dyn Fn(&Margins) -> String| {
        of(answer).map_or_else(
            || "-".to_owned(),
            |margins| if margins.is_stable() { text(&margins) } else { "unstable".to_owned() },
        )
    };
    vec![
        vec![name.to_owned()],
        row("  crossover".to_owned(), &|answer| of(answer, &|margins| frequency(margins.crossover))),
        row("  phase margin".to_owned(), &|answer| of(answer, &|margins| format!("{:.0} deg", margins.phase))),
        row("  gain margin".to_owned(), &|answer| of(answer, &|margins| decibel(margins.gain))),
    ]
}

impl Figure {
    /// Returns the deviation as a fraction of the value.
    fn part(&self) -> f64 {
        self.deviation / self.value.abs()
    }

    /// Whether the value matters and may be ten times as large.
    fn is_unknown(&self) -> bool {
        self.part() > 10.0 && self.deviation > 10.0 * self.tells
    }

    fn row(&self, subject: &Subject) -> Vec<String> {
        let (own, in_unit) = match self.unit {
            Unit::Rate(order) => (subject.counted(self.value, order), subject.in_unit(self.value, order)),
            Unit::Other(unit) => (with_unit(self.value, unit), String::new()),
            Unit::Time => (format!("{} ms", short(1000.0 * self.value)), String::new()),
        };
        let deviation = match self.unit {
            Unit::Rate(order) => format!("{} inc{}", rounded(self.deviation, 2), Subject::by(order)),
            Unit::Other(unit) => format!("{} {unit}", rounded(self.deviation, 2)).trim_end().to_owned(),
            Unit::Time => format!("{} ms", rounded(1000.0 * self.deviation, 2)),
        };
        let deviation = if self.is_unknown() { "not known".to_owned() } else { format!("+-{deviation}") };
        let mut row = vec![format!("  {}", self.name), own, deviation];
        if subject.has_unit() {
            row.push(in_unit);
        }
        row
    }
}

impl Subject {
    pub(super) fn has_unit(&self) -> bool {
        self.unit != "inc"
    }

    /// Returns `s`, `s^2` and so on.
    fn by(order: u32) -> String {
        match order {
            0 => String::new(),
            1 => "/s".to_owned(),
            order => format!("/s^{order}"),
        }
    }

    fn counted(&self, value: f64, order: u32) -> String {
        format!("{} inc{}", short(value), Self::by(order))
    }

    /// Formats a value in the unit of the axis; a fraction of a unit, such as 0.1 mm, is a factor.
    fn in_unit(&self, value: f64, order: u32) -> String {
        let times = if self.unit.starts_with(|c: char| c.is_ascii_digit()) { "* " } else { "" };
        format!("{} {times}{}{}", short(value / self.increments), self.unit, Self::by(order))
    }

    /// Formats a distance: in increments if it is a few of them, otherwise in the unit.
    pub(super) fn place(&self, increments: f64) -> String {
        if !self.has_unit() || increments.abs() < 1000.0 {
            self.counted(increments, 0)
        } else {
            self.in_unit(increments, 0)
        }
    }

    pub(super) fn rate(&self, value: f64, order: u32) -> String {
        if self.has_unit() { self.in_unit(value, order) } else { self.counted(value, order) }
    }
}

/// Formats rows with aligned columns: the first one left, the others right.
fn table(rows: &[Vec<String>]) -> String {
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    // A row with a single entry is a heading, which does not affect the widths.
    let entries = || rows.iter().filter(|row| row.len() > 1);
    let width = |column: usize| entries().filter_map(|row| row.get(column)).map(|text| text.chars().count()).max();
    let widths: Vec<usize> = (0..columns).map(|column| width(column).unwrap_or(0)).collect();
    let mut text = String::new();
    for row in rows {
        let mut line = String::from("  ");
        for (column, entry) in row.iter().enumerate() {
            let width = widths.get(column).copied().unwrap_or(0);
            let _ = if column == 0 { write!(line, "{entry:<width$}") } else { write!(line, "  {entry:>width$}") };
        }
        text += line.trim_end();
        text.push('\n');
    }
    text
}

fn with_unit(value: f64, unit: &str) -> String {
    format!("{} {unit}", short(value)).trim_end().to_owned()
}

fn percent(value: f64) -> String {
    format!("{value:.0} %")
}

fn settled(time: Option<f64>) -> String {
    time.map_or_else(|| "not reached".to_owned(), |time| format!("{} ms", rounded(1000.0 * time, 3)))
}

pub(super) fn frequency(value: f64) -> String {
    if value > 0.0 { format!("{} Hz", rounded(value, 3)) } else { "none".to_owned() }
}

pub(super) fn decibel(value: f64) -> String {
    if value.is_finite() { format!("{value:.1} dB") } else { "without end".to_owned() }
}

/// Formats the explained fraction, in %; a value rounded to 100 would seem complete.
pub(super) fn share(explained: f64) -> String {
    if explained > 99.99 { "more than 99.99".to_owned() } else { short(explained) }
}

/// Formats a number with four digits.
fn short(value: f64) -> String {
    rounded(value, 4)
}

/// Formats a number with this number of digits, integers with all of theirs; very large and very small ones with a
/// power of ten.
pub(super) fn rounded(value: f64, digits: i32) -> String {
    let size = value.abs();
    if size == 0.0 || !value.is_finite() {
        return if value == 0.0 { "0".to_owned() } else { value.to_string() };
    }
    if !(1e-4..1e9).contains(&size) {
        return format!("{value:.*e}", (digits - 1).max(0) as usize);
    }
    let behind = (digits - 1 - size.log10().floor() as i32).max(0) as usize;
    let text = format!("{value:.behind$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

#[cfg(test)]
mod tests;
