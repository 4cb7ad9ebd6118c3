//! Reads the keys of model motor: data of a motor and its load.
//!
//! Law      a motor has a rated torque, or a winding with a voltage; its load is rigidly coupled, or by a stiffness
//! Refuses  keys of a winding or of a coupling without one, values that are given twice, values outside their ranges

use crate::document::{Allowed, Map, Value};
use lineshaft_core::sim::{Amplifier, Coupling, Friction, Load, ModelError, Motor, MotorData, Reading, Stage};
use lineshaft_core::unit::Dimension;

/// Keys that no other model has.
pub(super) const KEYS: [&str; 24] = [
    "inertia",
    "load_inertia",
    "inertia_ratio",
    "viscous_friction",
    "coulomb_friction",
    "static_friction",
    "load_viscous_friction",
    "load_coulomb_friction",
    "load_static_friction",
    "load_torque",
    "stiffness",
    "coupling_damping",
    "backlash",
    "rated_torque",
    "max_torque",
    "torque_lag",
    "voltage",
    "resistance",
    "inductance",
    "torque_constant",
    "back_emf",
    "counts_per_turn",
    "noise",
    "seed",
];

/// Position of the encoder that the axis reads; not one of the keys above, because its value is no number.
pub(super) const ENCODER_AT: &str = "encoder_at";

/// Keys that require the first one of their row.
const NEEDS: [(&str, &[&str]); 2] = [
    ("stiffness", &["coupling_damping", "backlash"]),
    ("voltage", &["resistance", "inductance", "torque_constant", "back_emf"]),
];

/// Keys that exclude the first one of their row.
const INSTEAD: [(&str, &[&str]); 2] =
    [("load_inertia", &["inertia_ratio"]), ("voltage", &["rated_torque", "max_torque", "torque_lag"])];

/// Default maximum torque of a motor, as a multiple of the rated torque.
const PEAK: f64 = 3.0;

/// Values of the keys, by name.
struct Given<'v, 'd> {
    values: &'v [Option<Value<'d>>; KEYS.len()],
    /// Whether all values that were read so far are valid.
    good: std::cell::Cell<bool>,
}

impl<'v, 'd> Given<'v, 'd> {
    fn value(&self, key: &str) -> Option<&'v Value<'d>> {
        let place = KEYS.iter().position(|name| *name == key)?;
        self.values.get(place)?.as_ref()
    }

    fn note<T>(&self, read: Option<T>) -> Option<T> {
        self.good.set(self.good.get() && read.is_some());
        read
    }

    /// Returns a number in SI, or the default if its key is missing.
    fn si(&self, key: &str, dimension: Dimension, usual: f64) -> f64 {
        let Some(value) = self.value(key) else { return usual };
        self.note(value.quantity(&[dimension], &Allowed::Any)).map_or(usual, |quantity| quantity.si())
    }

    /// Returns a time, in ns; 0 if its key is missing.
    fn nanoseconds(&self, value: Option<&Value<'_>>) -> i64 {
        let Some(value) = value else { return 0 };
        let time = value.quantity(&[Dimension::Time], &Allowed::Any).and_then(|time| {
            let ns = time.nanoseconds();
            ns.map_err(|error| value.refuse(format!("{}: {error}", value.label()), error.hint())).ok()
        });
        self.note(time).unwrap_or(0)
    }

    fn friction(&self, [viscous, coulomb, holding]: [&str; 3]) -> Friction {
        let viscous = self.si(viscous, Dimension::ViscousFriction, 0.0);
        let coulomb = self.si(coulomb, Dimension::Torque, 0.0);
        Friction { viscous, coulomb, holding: self.si(holding, Dimension::Torque, coulomb) }
    }

    fn stage(&self) -> Stage {
        if self.value("voltage").is_none() {
            let rated = self.si("rated_torque", Dimension::Torque, 1.0);
            return Stage::Torque { rated, lag_ns: self.nanoseconds(self.value("torque_lag")) };
        }
        let torque_constant = self.si("torque_constant", Dimension::TorqueConstant, 1.0);
        Stage::Winding {
            voltage: self.si("voltage", Dimension::Voltage, 1.0),
            resistance: self.si("resistance", Dimension::Resistance, 1.0),
            inductance: self.si("inductance", Dimension::Inductance, 0.0),
            torque_constant,
            // In SI both constants of a motor have the same value.
            back_emf: self.si("back_emf", Dimension::VoltageConstant, torque_constant),
        }
    }

    /// Returns the maximum setpoint, as a multiple of the rated torque.
    fn limit(&self, stage: Stage) -> f64 {
        match stage {
            Stage::Torque { rated, .. } if rated > 0.0 => {
                self.si("max_torque", Dimension::Torque, PEAK * rated) / rated
            }
            Stage::Torque { .. } => PEAK,
            Stage::Winding { .. } => 1.0,
        }
    }

    /// Refuses keys that exclude or require others.
    fn check_combinations(&self) {
        for (first, others) in NEEDS.iter().filter(|(first, _)| self.value(first).is_none()) {
            for value in others.iter().filter_map(|key| self.value(key)) {
                let sentence = format!("{} is for a motor with {first}; this one has none", value.label());
                self.note::<()>(None);
                value.refuse(sentence, None);
            }
        }
        for (first, others) in INSTEAD.iter().filter(|(first, _)| self.value(first).is_some()) {
            for value in others.iter().filter_map(|key| self.value(key)) {
                self.note::<()>(None);
                value.refuse(format!("{} stands beside {first}; one of them is expected", value.label()), None);
            }
        }
    }

    /// Reports required keys that are missing.
    fn check_missing(&self, map: &mut Map<'_>) {
        let has = |key: &str| self.value(key).is_some();
        let has_load = has("load_inertia") || has("inertia_ratio");
        let needed = [
            ("inertia", true),
            ("counts_per_turn", true),
            ("rated_torque", !has("voltage")),
            ("load_inertia", has("stiffness") && !has_load),
            ("resistance", has("voltage")),
            ("torque_constant", has("voltage")),
        ];
        for (key, _) in needed.into_iter().filter(|(key, is_needed)| *is_needed && !has(key)) {
            self.note(map.required(key));
        }
    }
}

/// Returns the key that an error of the core refers to.
fn key_of(error: &ModelError) -> &'static str {
    match error {
        ModelError::Motor { name, .. } => name,
        ModelError::TorqueLag(_) => "torque_lag",
        _ => "dead_time",
    }
}

/// Reads the motor; `None` if it has problems.
pub(super) fn read(
    map: &mut Map<'_>,
    values: &[Option<Value<'_>>; KEYS.len()],
    dead_time: Option<&Value<'_>>,
    at_load: bool,
) -> Option<Motor> {
    let given = Given { values, good: std::cell::Cell::new(true) };
    given.check_missing(map);
    given.check_combinations();
    let inertia = given.si("inertia", Dimension::Inertia, 1.0);
    let ratio = given.si("inertia_ratio", Dimension::Ratio, if given.value("stiffness").is_some() { 1.0 } else { 0.0 });
    let stage = given.stage();
    let coupling = given.value("stiffness").map(|_| Coupling {
        stiffness: given.si("stiffness", Dimension::Stiffness, 1.0),
        damping: given.si("coupling_damping", Dimension::ViscousFriction, 0.0),
        backlash: given.si("backlash", Dimension::Angle(0), 0.0),
    });
    let data = MotorData {
        inertia,
        friction: given.friction(["viscous_friction", "coulomb_friction", "static_friction"]),
        load: Load {
            inertia: given.si("load_inertia", Dimension::Inertia, ratio * inertia),
            friction: given.friction(["load_viscous_friction", "load_coulomb_friction", "load_static_friction"]),
            torque: given.si("load_torque", Dimension::Torque, 0.0),
        },
        coupling,
        amplifier: Amplifier { stage, limit: given.limit(stage), dead_time_ns: given.nanoseconds(dead_time) },
        reading: Reading {
            counts_per_turn: given.si("counts_per_turn", Dimension::Increments(0), 1.0),
            noise: given.si("noise", Dimension::Increments(0), 0.0),
            seed: given.value("seed").map_or(Some(0), |value| given.note(value.integer(0..=u64::MAX))).unwrap_or(0),
            at_load,
        },
    };
    for problem in data.problems() {
        let key = key_of(&problem);
        let value = if key == "dead_time" { dead_time } else { given.value(key) };
        // A problem of a derived value is reported at the key from which it is derived.
        let value = value.or_else(|| given.value("inertia_ratio").filter(|_| key == "load_inertia"));
        if let Some(value) = value {
            value.refuse(problem.to_string(), None);
        }
        given.note::<()>(None);
    }
    given.good.get().then(|| Motor::new(data).ok())?
}
