//! Tuning of an axis: safe excitation, identification of a model, gains for given margins, and the response of the axis
//! with them.
//!
//! Law      `excite` excites an axis within limits, cycle by cycle; `record` stores the measurement; `identify` finds a
//!          model, or returns the reason why not; `design` finds gains that can be set; `response` shows their effect,
//!          before and after
//! Reads    only its arguments: no file, no thread, no clock; random numbers come from a seed
//! Writes   nothing: the caller decides which gains to set
//! Refuses  with one message each: `ModelError`, `Abort`, `Refusal`, `LoopError`, `DesignError`
//!
//! The laws of the loops are those of the core; their frequency responses are in this crate.
//!
//! ```
//! use lineshaft_tune::{DesignSpec, Dynamics, Law, Model, Move, Targets, bode, design, simulate};
//!
//! // A drive that takes velocities: 200000 inc/s at full command, 5 ms behind.
//! let dynamics = Dynamics::Velocity { gain: 200_000.0, time_constant: 0.005, offset: 0.0 };
//! let model = Model { cycle: 0.001, delay: 0.001, dynamics };
//! let spec = DesignSpec {
//!     law: Law::Pid { timer: 1 },
//!     velocity: None,
//!     max_velocity: 200_000.0,
//!     max_acceleration: 1_000_000.0,
//!     inertia_ratio: 0.0,
//!     targets: Targets::default(),
//! };
//! let found = design(&model, &spec)?;
//! assert!(found.position.is_stable() && found.position.phase >= 60.0);
//! assert_eq!(bode(&model, &found.loops)?.margins.phase, found.position.phase);
//!
//! let to = Move::Trapezoid { distance: 20_000.0, velocity: 100_000.0, acceleration: 1_000_000.0 };
//! let trace = simulate(&model, &found.loops, &to, 1.0, 5.0)?;
//! assert!(trace.figures.settling.is_some());
//! # Ok::<(), lineshaft_tune::DesignError>(())
//! ```

#![forbid(unsafe_code)]

mod design;
mod discrete;
mod excite;
mod identify;
mod loops;
mod model;
mod record;
mod response;

pub use design::{
    COUPLING_DAMPING, Design, DesignError, DesignSpec, INNER_INTEGRAL, INTEGRAL, Law, MOST_INERTIA_RATIO, Targets,
    design, regimes,
};
pub use excite::{Abort, Excitation, ExcitationOutput, Permitted};
pub use identify::{
    Deviation, Identified, LEAST_EXPLAINED, LEAST_MOTION, LEAST_REACTION, LEAST_WAY, MAX_RESONANCE_RATIO, Refusal,
    identify,
};
pub use loops::{Inner, LoopError, Loops, PositionLaw};
pub use model::{Dynamics, Model, ModelError, Resonance, Takes};
pub use record::Record;
pub use response::{
    Bode, Figures, Margins, Move, Point, Sample, Trace, bode, check_fit, retrace, simulate, velocity_bode,
};
