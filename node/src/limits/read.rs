//! Reads a file of limits.

use super::{POSITIONS, RATES, joint_name, limit, value_of};
use crate::cell::{Cell, contradictions};
use crate::cell_file::Setting;
use crate::document::{Document, Map, Problems, Value};
use crate::scenario::{did_you_mean, nearest};
use lineshaft_core::config::{AxisConfig, max_of_row};
use lineshaft_core::parameter::{self, AxisParameters, ConvertError, Refused, Row};
use lineshaft_core::text::refused_text;
use lineshaft_core::unit::{Scale, UnitError, excerpt};

/// Scaling factors for plans, which only MoveIt uses.
const SCALING: [&str; 2] = ["default_velocity_scaling_factor", "default_acceleration_scaling_factor"];
/// Relative difference of two limits that counts as rounding, mainly of pi.
const ROUNDING: f64 = 1e-12;
/// Limits that some programs write into this file, and that neither MoveIt nor an axis uses.
const OTHERS: [&str; 2] = ["has_effort_limits", "max_effort"];

/// Returns the parameters that a file of limits changes, for the axes with these indices.
///
/// # Errors
/// Returns all errors of the file, with line and column.
pub fn read_limits(document: Document, cell: &Cell, places: &[usize]) -> Result<Vec<Setting>, Problems> {
    let settings = document.root("the file of joint limits").and_then(|root| Reader { cell, places }.read(&root));
    match settings {
        Some(settings) if document.problems().is_empty() => Ok(settings),
        _ => Err(document.into_problems()),
    }
}

struct Reader<'c> {
    cell: &'c Cell,
    places: &'c [usize],
}

impl<'c> Reader<'c> {
    fn read(&self, root: &Value<'_>) -> Option<Vec<Setting>> {
        let mut map = root.map("the file of joint limits")?;
        // MoveIt has the limits there if they are parameters of a node.
        if let Some(section) = map.optional("robot_description_planning") {
            map.finish();
            return self.section(section.map("robot_description_planning")?);
        }
        self.section(map)
    }

    fn section(&self, mut map: Map<'_>) -> Option<Vec<Setting>> {
        let joints = map.required("joint_limits");
        map.allow(&SCALING);
        map.finish();
        let mut settings = Vec::new();
        for (name, value) in joints?.entries()? {
            let Some((name, axis)) = self.axis(&name) else { continue };
            settings
                .extend(Joint::read(name, axis, &value).and_then(|joint| joint.settings(self.cell.machine.cycle_ns)));
        }
        Some(settings.into_iter().flatten().collect())
    }

    /// Returns the joint that the file names, with its axis.
    fn axis(&self, name: &Value<'_>) -> Option<(&'c str, &'c AxisConfig)> {
        let given = name.text()?;
        let names = || self.places.iter().map(|place| joint_name(self.cell, *place));
        let Some(place) = self.places.iter().find(|place| joint_name(self.cell, **place) == given) else {
            let renamed =
                self.cell.joint_names.different_names(&self.cell.machine).find(|(object, _)| *object == given);
            let renamed = renamed.map(|(object, joint)| format!("the joint name of axis {object} is `{joint}`"));
            let near = || nearest(given, names()).map(did_you_mean);
            let known = || format!("there are {}", names().collect::<Vec<_>>().join(", "));
            let hint = renamed.or_else(near).unwrap_or_else(known);
            name.refuse(format!("no joint is called `{}`", excerpt(given)), Some(hint));
            return None;
        };
        Some((joint_name(self.cell, *place), self.cell.machine.axes.get(*place)?))
    }
}

/// Limits of one joint in the file.
struct Joint<'a, 'd> {
    name: &'a str,
    axis: &'a AxisConfig,
    limits: Vec<(&'static str, Value<'d>, f64)>,
}

impl<'a, 'd> Joint<'a, 'd> {
    fn read(name: &'a str, axis: &'a AxisConfig, value: &Value<'d>) -> Option<Self> {
        let mut map = value.map(format!("joint `{name}`"))?;
        map.allow(&OTHERS);
        let mut joint = Self { name, axis, limits: Vec::new() };
        joint.positions(&mut map);
        for (has, key) in RATES {
            joint.rate(&mut map, has, key);
        }
        map.finish();
        Some(joint)
    }

    /// Reads position limits, which MoveIt reads in any case.
    fn positions(&mut self, map: &mut Map<'d>) {
        let name = self.name;
        let has = map.optional("has_position_limits").map(|has| (has.boolean(), has));
        let given = POSITIONS.map(|key| map.optional(key));
        let is_any = given.iter().any(Option::is_some);
        match has {
            Some((Some(false), has)) if is_any => {
                let sentence = format!(
                    "{name}: has_position_limits is false, but MoveIt reads a position limit wherever it is given"
                );
                has.refuse(sentence, Some("write true, or leave the limits out".to_owned()));
            }
            Some((Some(true), has)) if !is_any => {
                has.refuse(
                    format!("{name}: has_position_limits is true; min_position or max_position is missing"),
                    None,
                );
            }
            _ => {}
        }
        for (key, value) in POSITIONS.into_iter().zip(given) {
            let Some(value) = value.map(|value| value.called(format!("{name}: {key}"))) else { continue };
            let number = value.number(f64::NEG_INFINITY..=f64::INFINITY);
            self.limits.extend(number.map(|number| (key, value, number)));
        }
    }

    /// Reads a rate limit, which MoveIt reads if `has_..` is true; if it is false, the file gives no such limit.
    fn rate(&mut self, map: &mut Map<'d>, has: &str, key: &'static str) {
        let name = self.name;
        let flag = map.optional(has);
        let given = map.optional(key).map(|value| value.called(format!("{name}: {key}")));
        let is_there = flag.as_ref().map(Value::boolean);
        match (is_there, given) {
            (None, Some(given)) => {
                let sentence = format!("{name}: {has} is missing: MoveIt does not read {key}");
                given.refuse(sentence, Some(format!("add `{has}: true`")));
            }
            (Some(Some(true)), None) => {
                let sentence = format!("{name}: {has} is true; {key} is missing");
                flag.into_iter().for_each(|flag| flag.refuse(&*sentence, None));
            }
            (Some(Some(true)), Some(given)) => {
                let number = given.number(0.0..=f64::INFINITY);
                self.limits.extend(number.map(|number| (key, given, number)));
            }
            _ => {}
        }
    }

    /// Returns the values to set in the cell. Reports a problem if it returns `None`.
    fn settings(&self, cycle_ns: u64) -> Option<Vec<Setting>> {
        let scale = si(&self.axis.scale);
        let mut after = self.axis.parameters;
        let mut settings = Vec::new();
        for (key, value, number) in &self.limits {
            if limit(self.axis, key).is_some_and(|now| (now - number).abs() <= ROUNDING * now.abs()) {
                continue;
            }
            for key in self.keys(key, *number) {
                settings.extend(self.set(key, value, *number, &mut after, cycle_ns)?);
            }
        }
        let given: Vec<_> = self.limits.iter().map(|(key, value, _)| (*key, value.clone())).collect();
        contradictions(&after, &given, &scale, Some(cycle_ns));
        Some(settings)
    }

    /// Returns the keys of a cell for a limit. A lower deceleration limit is raised to the single limit of MoveIt; a
    /// higher one, which stops use, is kept.
    fn keys(&self, key: &'static str, number: f64) -> Vec<&'static str> {
        let asked = self.axis.scale.rate_from_si(number, 2);
        let is_lower = |limit: f64| asked.as_ref().is_ok_and(|asked| limit < *asked);
        let is_both = key == "max_acceleration" && self.axis.parameters.max_deceleration.is_some_and(is_lower);
        if is_both { vec![key, "max_deceleration"] } else { vec![key] }
    }

    fn set(
        &self,
        key: &'static str,
        value: &Value<'_>,
        number: f64,
        after: &mut AxisParameters,
        cycle_ns: u64,
    ) -> Option<Option<Setting>> {
        let scale = si(&self.axis.scale);
        let (_, row) = Row::find(key)?;
        let refuse = |sentence: String| value.refuse(format!("{}: {sentence}", self.name), None);
        let converted = value_of(self.axis, key, number);
        let asked = converted.map_err(|error| refuse(format!("{key}: {}", error_text(&error)))).ok()?;
        if row.value(&self.axis.parameters) == asked {
            return Some(None);
        }
        let highest = max_of_row(row, cycle_ns);
        let is_too_fast =
            matches!(asked, parameter::Value::Real(rate) if highest.is_some_and(|highest| rate > highest));
        let taken = if is_too_fast { Err(Refused::OutOfRange) } else { row.assign(after, asked) };
        taken.map_err(|why| refuse(refused_text(row, why, asked, &scale, highest))).ok()?;
        let written = format!("{number} {}", unit(&scale, row));
        Some(Some(Setting { axis: self.axis.name.clone(), key, value: asked, written }))
    }
}

fn error_text(error: &ConvertError) -> String {
    match error {
        ConvertError::Unit(error) => UnitError::to_string(error),
        ConvertError::Type(value) => format!("{} is no such value", excerpt(value)),
    }
}

/// Returns the unit of a row in SI.
fn unit(scale: &Scale, row: &Row) -> String {
    let order = row.measure.order().unwrap_or(0);
    scale.kind().dimension(order).si_unit().to_string()
}

/// Returns the scale with the unit m or rad, which the file uses.
fn si(scale: &Scale) -> Scale {
    scale.with_unit(scale.kind().dimension(0).si_unit()).unwrap_or(*scale)
}
