//! Settings of tuning: the permitted excitation of an axis, and the requirements of the design.
//!
//! Law      an axis whose loops this program closes is excited below its position loop: by a velocity within
//!          max_acceleration if its drive has interface velocity, otherwise by an effort. Default bounds: 30 % of
//!          max_velocity and of the effort, 0.4 s of that velocity in both directions, 6 s
//! Reads    the configuration of the axis and its parameters in force
//! Writes   the bounds of the excitation, the present loops, the requirements of the design
//! Refuses  an axis without such loops, one with two drives or two encoders, bounds beyond those of the axis, an
//!          inertia ratio for interface velocity or for an encoder that may not be on the motor

use lineshaft_core::axis::Source;
use lineshaft_core::command::Level;
use lineshaft_core::config::{AxisConfig, MachineConfig};
use lineshaft_core::drive::Interface;
use lineshaft_core::parameter::AxisParameters;
use lineshaft_core::regulator::Law;
use lineshaft_tune::{
    DesignSpec, Inner, Loops, MOST_INERTIA_RATIO, ModelError, Permitted, PositionLaw, Takes, Targets,
};

/// Bounds given by the user; the default is that of the axis.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Bounds {
    /// Maximum travel in both directions from the start position, in inc.
    pub travel: Option<f64>,
    /// Maximum velocity, in inc/s.
    pub velocity: Option<f64>,
    /// Maximum effort, as a fraction of the permitted one.
    pub effort: Option<f64>,
    /// Duration of the motion, in s.
    pub duration: Option<f64>,
    /// Inertia of the load as a multiple of that of the motor, if there may be backlash between them; this is no bound.
    pub inertia_ratio: Option<f64>,
}

/// Reason why an axis cannot be tuned.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Unfit {
    /// There is no such axis.
    #[error("no axis is called `{name}`; there are {known}")]
    Unknown {
        /// Given name.
        name: String,
        /// Names of the axes.
        known: String,
    },
    /// This program does not close its loops.
    #[error("{axis}: no loop of it is closed here ({how}); interface velocity or torque can be tuned")]
    NoLoop {
        /// Name of the axis.
        axis: String,
        /// Device that closes the loops.
        how: &'static str,
    },
    /// The control law has gains of another kind.
    #[error("{axis}: regulator is integer, whose gains are those of its module; proportional and pid can be tuned")]
    Integer {
        /// Name of the axis.
        axis: String,
    },
    /// The model would be that of a voltage.
    #[error(
        "{axis}: interface is voltage, and no model here is one of a winding; interface velocity or torque can be tuned"
    )]
    Voltage {
        /// Name of the axis.
        axis: String,
    },
    /// A trial would skew the gantry.
    #[error("{axis}: it has two drives, which nothing keeps square while its position loop is open")]
    TwoDrives {
        /// Name of the axis.
        axis: String,
    },
    /// A trial could not stop the axis.
    #[error(
        "{axis}: its drive takes a torque as a voltage, and coasts where a trial leaves it to its stop; interface velocity, or a drive on a bus, can be tuned"
    )]
    Coasts {
        /// Name of the axis.
        axis: String,
    },
    /// The model supports only one encoder.
    #[error(
        "{axis}: ampencno {number} gives its velocity loop another encoder than its position loop has, and a model knows one; \
         an axis with ampencno -1 can be tuned"
    )]
    TwoEncoders {
        /// Name of the axis.
        axis: String,
        /// Value of AMPENCNO.
        number: i64,
    },
    /// A bound is not permitted for an excitation.
    #[error("{axis}: {error}")]
    Excitation {
        /// Name of the axis.
        axis: String,
        /// Error of the bound.
        error: ModelError,
    },
    /// A bound of an effort was given, but the interface is velocity.
    #[error("{axis}: effort bounds a drive that takes efforts; this one takes velocities")]
    NoEffort {
        /// Name of the axis.
        axis: String,
    },
    /// An inertia ratio was given, but it has no use.
    #[error(
        "{axis}: inertia_ratio suits a drive that takes efforts; this one takes velocities, and closes its velocity loop through play itself"
    )]
    NoRatio {
        /// Name of the axis.
        axis: String,
    },
    /// Backlash would be within the loop.
    #[error(
        "{axis}: inertia_ratio suits an axis whose encoder sits on its motor and is told by its drive; its position comes from {from}"
    )]
    NotOfMotor {
        /// Name of the axis.
        axis: String,
        /// Source of its position.
        from: String,
    },
    /// A bound is outside of its range.
    #[error("{axis}: {name} is {value}; {allowed} is allowed")]
    Bound {
        /// Name of the axis.
        axis: String,
        /// Name of the bound.
        name: &'static str,
        /// Given value.
        value: String,
        /// Permitted range.
        allowed: String,
    },
}

impl Unfit {
    pub(super) fn unknown(config: &MachineConfig, name: &str) -> Self {
        let known = config.axes.iter().map(|axis| axis.name.as_str()).collect::<Vec<_>>().join(", ");
        Self::Unknown { name: name.to_owned(), known }
    }
}

/// Default fraction of max_velocity, and of the effort.
const USUAL: f64 = 0.3;
/// Duration of the travel at the maximum velocity, in s.
const TRAVEL_TIME: f64 = 0.4;
/// Margin beyond the travel, as a fraction of it.
const MARGIN: f64 = 0.25;
/// Fraction of the travel within which a drive with interface velocity must stop: from the position at which its
/// excitation brakes to the end of the margin.
const BRAKING: f64 = 0.4;
/// Default duration of the motion, in s, and its range.
const DURATION: f64 = 6.0;
const DURATIONS: (f64, f64) = (1.0, 60.0);
/// Time from zero to the maximum command, in s.
const RAMP: f64 = 1.0;
/// Minimum travel, in inc.
const LEAST_TRAVEL: f64 = 100.0;
/// Factor by which a commanded velocity exceeds its bound, so that the bound is reached.
const BEYOND: f64 = 1.2;

/// Data for one trial.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setting {
    /// Index of the axis.
    pub axis: u16,
    /// Loop whose input is the excitation.
    pub level: Level,
    /// Permitted excitation.
    pub permitted: Permitted,
    /// Maximum change of a command per cycle; for interface velocity it is limited by max_acceleration.
    pub slew: f64,
    /// Whether the user gave the travel; otherwise it may be reduced if there is too little room.
    pub is_given: bool,
    /// Whether the axis must be homed before it moves.
    pub needs_reference: bool,
    /// Software limits, in inc.
    pub limits: (Option<i64>, Option<i64>),
    /// Present loops.
    pub before: Loops,
    /// Requirements of the design.
    pub wish: DesignSpec,
}

impl Setting {
    /// Creates the setting of the axis with that name, with its parameters in force.
    ///
    /// # Errors
    /// Returns the reason why it cannot be tuned.
    pub fn of(
        config: &MachineConfig,
        name: &str,
        parameters: impl Fn(usize) -> AxisParameters,
        bounds: &Bounds,
    ) -> Result<Self, Unfit> {
        let Some((place, axis)) = config.axes.iter().enumerate().find(|(_, axis)| axis.name == name) else {
            return Err(Unfit::unknown(config, name));
        };
        let p = parameters(place);
        let takes = takes(axis)?;
        if takes == Takes::Effort && p.has_velocity_encoder() {
            return Err(Unfit::TwoEncoders { axis: name.to_owned(), number: p.amplifier.encoder.number });
        }
        let (before, wish) = loops(axis, &p, config.cycle_ns, takes)?;
        let wish = DesignSpec { inertia_ratio: inertia_ratio(config, axis, &p, takes, bounds)?, ..wish };
        Ok(Self {
            axis: u16::try_from(place).unwrap_or(u16::MAX),
            level: if takes == Takes::Effort { Level::Effort } else { Level::Setpoint },
            permitted: permitted(axis, &p, config.cycle_ns, takes, bounds)?,
            slew: match takes {
                Takes::Velocity => p.max_acceleration * config.cycle_ns as f64 / 1e9 / p.max_velocity,
                Takes::Effort => f64::INFINITY,
            },
            is_given: bounds.travel.is_some(),
            needs_reference: p.homing.required,
            limits: (p.min_position, p.max_position),
            before,
            wish,
        })
    }

    /// Returns the question for permission to move a real drive, with the motion that follows.
    pub fn permission_question(&self, axis: &AxisConfig) -> String {
        let Permitted { travel, margin, velocity, command, .. } = self.permitted;
        let (way, rate) = (axis.scale.format_increments((travel + margin) as i64), axis.scale.format_rate(velocity, 1));
        let effort = match self.permitted.takes {
            Takes::Velocity => String::new(),
            Takes::Effort => format!(" and {:.0} % of its effort", 100.0 * command),
        };
        let name = &axis.name;
        format!(
            "{name} hangs on a real drive, or runs beside one: tuning shakes it with about {rate}{effort}, and stops it {way} either side of \
             where it stands, by its drive; no loop holds it meanwhile, and a load that hangs falls"
        )
    }

    /// Returns the bounds at the present position, in inc: a default travel is reduced if there is less room.
    ///
    /// # Errors
    /// Returns an error if there is too little room.
    pub fn at(&self, position: i64) -> Result<Permitted, f64> {
        let (low, high) = self.limits;
        let rooms = [low.map(|low| position.saturating_sub(low)), high.map(|high| high.saturating_sub(position))];
        let room = rooms.into_iter().flatten().fold(f64::INFINITY, |room, way| room.min(way as f64));
        let p = self.permitted;
        if p.travel + p.margin <= room {
            return Ok(p);
        }
        let travel = room / (1.0 + MARGIN);
        if self.is_given || travel < LEAST_TRAVEL {
            return Err(travel);
        }
        let slower = (travel / p.travel).min(1.0);
        // Half of the velocity needs a quarter of the stopping distance.
        let command = if p.takes == Takes::Velocity { slower * p.command } else { p.command };
        let (margin, velocity) = (MARGIN * travel, slower * p.velocity);
        Ok(Permitted { travel, margin, velocity, command: command.max(1e-3), ..p })
    }
}

fn takes(axis: &AxisConfig) -> Result<Takes, Unfit> {
    let (name, no_loop) = (axis.name.clone(), |how| Unfit::NoLoop { axis: axis.name.clone(), how });
    if axis.drive.is_none() {
        return Err(no_loop("the axis is virtual"));
    }
    if axis.second.is_some() {
        return Err(Unfit::TwoDrives { axis: name });
    }
    match axis.interface {
        Interface::Position => Err(no_loop("its drive closes the position loop")),
        Interface::OpenLoop => Err(no_loop("interface open_loop")),
        _ if axis.law == Law::Integer => Err(Unfit::Integer { axis: name }),
        Interface::Velocity => Ok(Takes::Velocity),
        Interface::Torque if axis.analog.is_some() => Err(Unfit::Coasts { axis: name }),
        Interface::Torque => Ok(Takes::Effort),
        Interface::Voltage => Err(Unfit::Voltage { axis: name }),
    }
}

/// Returns the present loops and the requirements of the design.
fn loops(axis: &AxisConfig, p: &AxisParameters, cycle_ns: u64, takes: Takes) -> Result<(Loops, DesignSpec), Unfit> {
    let timer = u32::try_from(p.pid.period_ms).unwrap_or(1);
    let (position, law) = match axis.law {
        Law::Pid => {
            let cycles = u64::from(timer).saturating_mul(1_000_000) / cycle_ns.max(1);
            let cycles = u32::try_from(cycles).unwrap_or(1).max(1);
            (PositionLaw::Pid { gains: p.pid, cycles }, lineshaft_tune::Law::Pid { timer })
        }
        _ => (PositionLaw::Proportional { kv: p.position_loop.kv }, lineshaft_tune::Law::Proportional),
    };
    let method = p.amplifier.method();
    let has_velocity = takes == Takes::Effort && p.amplifier.has_velocity_loop();
    let inner = has_velocity.then(|| Inner { gains: p.amplifier.velocity_gains(cycle_ns), method });
    let (max_velocity, max_acceleration) = (p.max_velocity, p.max_acceleration);
    let before = Loops { position, velocity: inner, max_velocity, max_acceleration };
    let targets = Targets::default();
    let velocity = inner.map(|inner| inner.method);
    Ok((before, DesignSpec { law, velocity, max_velocity, max_acceleration, inertia_ratio: 0.0, targets }))
}

/// Returns the inertia ratio; 0 if none is given.
fn inertia_ratio(
    config: &MachineConfig,
    axis: &AxisConfig,
    p: &AxisParameters,
    takes: Takes,
    bounds: &Bounds,
) -> Result<f64, Unfit> {
    let Some(ratio) = bounds.inertia_ratio else { return Ok(0.0) };
    let name = || axis.name.clone();
    if !(0.0..=MOST_INERTIA_RATIO).contains(&ratio) {
        let allowed = format!("0 to {MOST_INERTIA_RATIO} times the inertia of the motor");
        return Err(Unfit::Bound { axis: name(), name: "inertia_ratio", value: ratio.to_string(), allowed });
    }
    if ratio == 0.0 {
        return Ok(0.0);
    }
    if takes == Takes::Velocity {
        return Err(Unfit::NoRatio { axis: name() });
    }
    match Source::of(axis.wired, config.encoders.len(), p) {
        Ok(Source::Encoder(place)) => {
            let entry = config.encoders.get(usize::from(place)).map_or("an encoder", |entry| entry.name.as_str());
            Err(Unfit::NotOfMotor { axis: name(), from: format!("encoder {entry}") })
        }
        Ok(Source::Simulated) => Err(Unfit::NotOfMotor { axis: name(), from: "its command".to_owned() }),
        _ => Ok(ratio),
    }
}

fn permitted(
    axis: &AxisConfig,
    p: &AxisParameters,
    cycle_ns: u64,
    takes: Takes,
    bounds: &Bounds,
) -> Result<Permitted, Unfit> {
    let judge = |name, value: f64, (least, most): (f64, f64), unit: &str| {
        if (least..=most).contains(&value) {
            return Ok(value);
        }
        let allowed = format!("{least} to {most} {unit}");
        Err(Unfit::Bound { axis: axis.name.clone(), name, value: format!("{value} {unit}"), allowed })
    };
    let velocity = bounds.velocity.unwrap_or(USUAL * p.max_velocity);
    let velocity = judge("velocity", velocity, (1e-3 * p.max_velocity, p.max_velocity), "inc/s")?;
    let braking = if takes == Takes::Velocity { velocity * velocity / (2.0 * p.max_acceleration) } else { 0.0 };
    let usual = (TRAVEL_TIME * velocity).max(LEAST_TRAVEL).max(braking / BRAKING);
    // The stopping distance of the velocity cannot be reduced.
    let least = LEAST_TRAVEL.max((braking / BRAKING).floor());
    let travel = judge("travel", bounds.travel.unwrap_or(usual.round()), (least, 1e12), "inc")?;
    if bounds.effort.is_some() && takes == Takes::Velocity {
        return Err(Unfit::NoEffort { axis: axis.name.clone() });
    }
    let effort = judge("effort", bounds.effort.unwrap_or(USUAL), (0.01, 1.0), "of the largest effort")?;
    let duration = judge("duration", bounds.duration.unwrap_or(DURATION), DURATIONS, "s")?;
    let command = match takes {
        Takes::Velocity => BEYOND * velocity / p.max_velocity,
        Takes::Effort => effort * p.amplifier.max_output(),
    };
    Ok(Permitted {
        cycle: cycle_ns as f64 / 1e9,
        takes,
        travel,
        margin: MARGIN * travel,
        velocity,
        // Minimum of an excitation.
        command: command.clamp(1e-3, 1.0),
        ramp: RAMP,
        duration,
        seed: 1,
    })
}
