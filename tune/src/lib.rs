//! Tuning of an axis: an excitation that is safe, a model of what answers to it, gains by stated margins, and how the axis answers with
//! them.
//!
//! Law      `excite` shakes an axis within bounds, cycle by cycle; `record` is what was seen; `identify` makes a model of it, or says
//!          why not; `design` finds gains as they can be set; `response` shows what they do, before and after
//! Reads    nothing but what it is given: no file, no thread, no clock; chance comes from a seed
//! Writes   nothing: who uses it decides what is set
//! Refuses  with one sentence each: `ModelError`, `Abort`, `Refusal`, `LoopError`, `DesignError`
//!
//! The laws of the loops are those of the core; their frequency responses stand here.
//!
//! ```
//! use lineshaft_tune::{Dynamics, Law, Model, Move, Targets, Wish, bode, design, simulate};
//!
//! // A drive that takes velocities: 200000 inc/s at full command, 5 ms behind.
//! let dynamics = Dynamics::Velocity { gain: 200_000.0, time_constant: 0.005, offset: 0.0 };
//! let model = Model { cycle: 0.001, delay: 0.001, dynamics };
//! let wish = Wish {
//!     law: Law::Pid { timer: 1 },
//!     velocity: None,
//!     max_velocity: 200_000.0,
//!     max_acceleration: 1_000_000.0,
//!     inertia_ratio: 0.0,
//!     targets: Targets::default(),
//! };
//! let found = design(&model, &wish)?;
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
    COUPLING_DAMPING, Design, DesignError, INNER_INTEGRAL, INTEGRAL, Law, MOST_INERTIA_RATIO, Targets, Wish, design,
    regimes,
};
pub use excite::{Abort, Drive, Excitation, Permitted};
pub use identify::{
    Deviation, Identified, LEAST_EXPLAINED, LEAST_MOTION, LEAST_REACTION, LEAST_WAY, Refusal, WORTH, identify,
};
pub use loops::{Inner, LoopError, Loops, PositionLaw};
pub use model::{Dynamics, Model, ModelError, Resonance, Takes};
pub use record::Record;
pub use response::{
    Bode, Figures, Margins, Move, Point, Sample, Trace, bode, check_fit, retrace, simulate, velocity_bode,
};
