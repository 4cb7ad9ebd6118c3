//! Reads key `sim` of an axis: the model of its drive, and a check that it fits the interface of the drive.

mod motor;

use crate::document::{Allowed, Map, Value};
use lineshaft_core::drive::Interface;
use lineshaft_core::sim::{Model, ModelError, SecondOrder, TwoSpeed, Valve, VelocityLag};
use lineshaft_core::unit::Dimension;

/// Default bandwidth of the second-order model, in Hz.
const BANDWIDTH: f64 = 60.0;
/// Default damping of that model.
const DAMPING: f64 = 0.8;
/// Default time constant of a drive with a velocity loop, in ns.
const SERVO_NS: i64 = 5_000_000;
/// Default time constant of motors and hydraulics without a velocity loop, in ns.
const MOTOR_NS: i64 = 50_000_000;
/// Default coasting time of a motor, in ns.
const COAST_NS: i64 = 100_000_000;
/// Default dead time of a valve, in ns.
const DEAD_NS: i64 = 20_000_000;

/// Models by name.
const KINDS: [(&str, Kind); 6] = [
    ("ideal", Kind::Ideal),
    ("second_order", Kind::SecondOrder),
    ("velocity", Kind::Velocity),
    ("two_speed", Kind::TwoSpeed),
    ("valve", Kind::Valve),
    ("motor", Kind::Motor),
];

/// Keys of models, with the models that have them.
const KEYS: [(&str, &[Kind]); 6] = [
    ("bandwidth", &[Kind::SecondOrder]),
    ("damping", &[Kind::SecondOrder]),
    ("time_constant", &[Kind::Velocity, Kind::TwoSpeed, Kind::Valve]),
    ("coast", &[Kind::SecondOrder, Kind::TwoSpeed]),
    ("dead_time", &[Kind::Valve, Kind::Motor]),
    ("inverted", &[Kind::Velocity, Kind::TwoSpeed, Kind::Valve, Kind::Motor]),
];

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Ideal,
    SecondOrder,
    Velocity,
    TwoSpeed,
    Valve,
    Motor,
}

impl Kind {
    fn name(self) -> &'static str {
        KINDS.iter().find(|(_, kind)| *kind == self).map_or("", |(name, _)| name)
    }
}

/// Reads the model; `interface` is that of the drive, if known; `reads_encoder`: the axis reads an entry of section
/// `encoders`.
pub(super) fn model(
    map: &mut Map<'_>,
    interface: Option<Interface>,
    reads_encoder: bool,
    cycle_ns: u64,
) -> Option<Model> {
    let named = map.required("model");
    let kind = named.as_ref().and_then(|value| value.choice(&KINDS));
    let values = KEYS.map(|(key, _)| map.optional(key));
    let of_motor = motor::KEYS.map(|key| map.optional(key));
    let encoder_at = map.optional(motor::ENCODER_AT);
    let kind = kind?;
    let mut good = true;
    let keys = values.iter().zip(KEYS.iter().map(|(_, kinds)| *kinds));
    let of_motor_alone = of_motor.iter().chain([&encoder_at]).map(|value| (value, &[Kind::Motor] as &[Kind]));
    for (value, kinds) in keys.chain(of_motor_alone) {
        if let Some(value) = value.as_ref().filter(|_| !kinds.contains(&kind)) {
            let names: Vec<_> = kinds.iter().map(|kind| kind.name()).collect();
            let models = if names.len() == 1 { "model" } else { "models" };
            let sentence =
                format!("{} is for {models} {}; this one is {}", value.label(), names.join(", "), kind.name());
            value.refuse(sentence, None);
            good = false;
        }
    }
    let model = if kind == Kind::Motor {
        let [.., dead_time, inverted] = &values;
        let inverted = inverted.as_ref().map_or(Some(false), Value::boolean);
        let at_load = encoder_at.as_ref().map_or(Some(false), |value| at_load(value, reads_encoder));
        let motor = motor::read(map, &of_motor, dead_time.as_ref(), at_load.unwrap_or_default());
        Some(Model::Motor(motor?).wired(inverted?)).filter(|_| at_load.is_some())
    } else {
        read(kind, &values, cycle_ns)
    };
    let model = model.filter(|_| good)?;
    match (named, interface) {
        (Some(named), Some(interface)) if !model.fits(interface) => {
            let fitting: Vec<_> =
                Interface::ALL.into_iter().filter(|one| model.fits(*one)).map(Interface::name).collect();
            let (kind, allowed) = (kind.name(), fitting.join(", "));
            let sentence = format!("model {kind} is for interface {allowed}; this drive has {}", interface.name());
            let needs_winding = kind == "motor" && interface == Interface::Voltage;
            let winding =
                "a voltage needs a winding: voltage, resistance and torque_constant in the place of rated_torque";
            named.refuse(sentence, needs_winding.then(|| winding.to_owned()));
            None
        }
        _ => Some(model),
    }
}

/// Whether the entry of section `encoders` that the axis reads measures the load instead of the motor.
fn at_load(value: &Value<'_>, reads_encoder: bool) -> Option<bool> {
    let at_load = value.choice(&[("motor", false), ("load", true)])?;
    if at_load && !reads_encoder {
        let sentence = "encoder_at is load, but the axis reads its drive, which sits on the motor; an entry of encoders is \
                        expected in key feedback";
        value.refuse(sentence, None);
        return None;
    }
    Some(at_load)
}

/// Reads the values of [`KEYS`], each separately so that every problem is reported.
fn read(
    kind: Kind,
    [bandwidth, damping, constant, coast, dead, inverted]: &[Option<Value<'_>>; 6],
    cycle_ns: u64,
) -> Option<Model> {
    let inverted = inverted.as_ref().map_or(Some(false), Value::boolean);
    let constant_or = |usual| time(constant, usual, |ns| VelocityLag::new(ns, cycle_ns).map(drop));
    match kind {
        Kind::Ideal => Some(Model::Ideal),
        Kind::SecondOrder => {
            let hertz = bandwidth.as_ref().map_or(Some(BANDWIDTH), |value| {
                let hertz = value.quantity(&[Dimension::Frequency], &Allowed::Any)?.si();
                accept(value, SecondOrder::new(hertz, DAMPING, cycle_ns).map(|_| hertz))
            });
            let damping = damping.as_ref().map_or(Some(DAMPING), |value| {
                let damping = value.number(f64::NEG_INFINITY..=f64::INFINITY)?;
                accept(value, SecondOrder::new(BANDWIDTH, damping, cycle_ns).map(|_| damping))
            });
            let coast = time(coast, 0, |ns| TwoSpeed::new(0, ns, cycle_ns).map(drop));
            let law = SecondOrder::new(hertz?, damping?, cycle_ns).ok()?;
            let law = match coast? {
                0 => Some(law),
                ns => law.coasting(ns, cycle_ns).ok(),
            };
            law.map(Model::SecondOrder)
        }
        Kind::Velocity => {
            let law = VelocityLag::new(constant_or(SERVO_NS)?, cycle_ns).ok()?;
            Some(Model::Velocity(law).wired(inverted?))
        }
        Kind::TwoSpeed => {
            let constant = constant_or(MOTOR_NS);
            let coast = time(coast, COAST_NS, |ns| TwoSpeed::new(0, ns, cycle_ns).map(drop));
            let law = TwoSpeed::new(constant?, coast?, cycle_ns).ok()?;
            Some(Model::TwoSpeed(law).wired(inverted?))
        }
        Kind::Valve => {
            let constant = constant_or(MOTOR_NS);
            let dead = time(dead, DEAD_NS, |ns| Valve::new(0, ns, cycle_ns).map(drop));
            let law = Valve::new(constant?, dead?, cycle_ns).ok()?;
            Some(Model::Valve(law).wired(inverted?))
        }
        // The keys of this model are read by `motor.rs`.
        Kind::Motor => None,
    }
}

/// Reads a time of a model, in ns.
fn time(value: &Option<Value<'_>>, usual: i64, check: impl Fn(i64) -> Result<(), ModelError>) -> Option<i64> {
    let Some(value) = value else { return Some(usual) };
    let time = value.quantity(&[Dimension::Time], &Allowed::Any)?;
    match time.nanoseconds() {
        Ok(ns) => accept(value, check(ns).map(|()| ns)),
        Err(error) => {
            value.refuse(format!("{}: {error}", value.label()), error.hint());
            None
        }
    }
}

fn accept<T>(value: &Value<'_>, result: Result<T, ModelError>) -> Option<T> {
    result.map_err(|error| value.refuse(error.to_string(), None)).ok()
}
