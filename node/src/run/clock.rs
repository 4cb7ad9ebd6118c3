//! Stamps follow the system clock; what goes into recordings does not step with it.
//!
//! Law      offset = system clock - monotonic clock, read every `LOOK`. A change by more than [`CLOCK_STEP_NS`] is a step: an event
//!          (`CLOCK_STEPPED`), of which the bridge makes the log line, is published; `HOLD` later stamps show the step. A smaller
//!          change is followed by a part of `SLEW` of the time that passes, so that stamps never go back
//! Reads    the system clock in the bridge; the cycle thread loads two atomics
//! Writes   the [`HostClock`], which all stamps show

use super::bridge::Handle;
use crate::recording::{CLOCK_STEP_NS, CycleTime};
use lineshaft_core::code::Code;
use lineshaft_core::command::{Action, Source};
use lineshaft_core::event::{Event, Kind, Number, Severity};
use lineshaft_core::object::Object;
use lineshaft_core::text;
use lineshaft_ros::layer::HostClock;
use lineshaft_ros::offset::SystemOffset;
use lineshaft_ros::surface::host::Busy;
use std::time::{Duration, Instant};

/// Time between two looks at the system clock.
const LOOK: Duration = Duration::from_millis(50);
/// Time between the event of a step and the first stamp that shows it: so long the event may take to its readers.
const HOLD: Duration = Duration::from_millis(100);
/// Longest time that an event may take to be published: then stamps follow all the same.
const PATIENCE: Duration = Duration::from_millis(500);
/// Steady time changes by at most 1/20 of the time that passes, in cycles by 1/16.
const SLEW: i64 = 20;
const CYCLE_SLEW: i64 = 16;

/// What the difference between system clock and stamps asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Change {
    Nothing,
    /// Steady time moves by this (ns).
    Slew(i64),
    /// The clock was set by this (ns).
    Step(i64),
}

impl Change {
    /// For a difference (ns) that is known with an error (ns), so long after the last look.
    fn of(difference_ns: i64, error_ns: u64, passed: Duration) -> Self {
        match difference_ns.unsigned_abs() {
            size if size <= error_ns => Self::Nothing,
            size if size <= CLOCK_STEP_NS.saturating_add(error_ns) => {
                let most = i64::try_from(passed.as_nanos()).unwrap_or(i64::MAX) / SLEW;
                Self::Slew(difference_ns.clamp(-most, most))
            }
            _ => Self::Step(difference_ns),
        }
    }
}

/// A step on its way into the stamps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Step {
    ns: i64,
    stage: Stage,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    /// Found then; no command was taken yet.
    Found(Instant),
    /// Submitted then, as the command of this number.
    Submitted(u64, Instant),
    /// Reported then.
    Reported(Instant),
}

/// Watches the system clock, in the bridge.
#[derive(Debug)]
pub struct ClockWatch {
    clock: HostClock,
    looked: Instant,
    step: Option<Step>,
}

impl ClockWatch {
    /// Makes `clock` follow the system clock.
    pub fn new(clock: HostClock) -> Self {
        Self { clock, looked: Instant::now(), step: None }
    }

    /// Looks at the system clock if it is time, and brings a step further.
    pub fn look(&mut self, handle: &Handle) {
        let now = Instant::now();
        if let Some(step) = self.step.take() {
            self.step = self.advance(step, handle, now);
            return;
        }
        let passed = now.duration_since(self.looked);
        if passed < LOOK {
            return;
        }
        self.looked = now;
        let offset = SystemOffset::read();
        let shown = self.clock.base_ns().wrapping_add(self.clock.steps_ns());
        match Change::of(offset.ns.wrapping_sub(shown), offset.error_ns, passed) {
            Change::Nothing => {}
            Change::Slew(by_ns) => self.clock.slew(by_ns),
            Change::Step(ns) => self.step = self.advance(Step { ns, stage: Stage::Found(now) }, handle, now),
        }
    }

    /// Brings a step further; `None` once stamps show it.
    fn advance(&self, step: Step, handle: &Handle, now: Instant) -> Option<Step> {
        let is_late = |since: Instant| now.duration_since(since) >= PATIENCE;
        let stage = match step.stage {
            Stage::Found(since) => {
                let note = Action::Note { code: Code::CLOCK_STEPPED, number: step.ns };
                match handle.submit_as(Source::Machine, note) {
                    Ok(sequence) => Stage::Submitted(sequence, now),
                    Err(Busy::Full) if !is_late(since) => Stage::Found(since),
                    // No cycle takes it: the line says it alone.
                    Err(_) => {
                        tracing::warn!("{}", text::with_remedy(&sentence(step.ns, handle), Code::CLOCK_STEPPED));
                        Stage::Reported(now)
                    }
                }
            }
            Stage::Submitted(sequence, since) if handle.has_published(sequence) || is_late(since) => {
                Stage::Reported(now)
            }
            Stage::Reported(since) if now.duration_since(since) >= HOLD => {
                self.clock.step(step.ns);
                return None;
            }
            waiting => waiting,
        };
        Some(Step { stage, ..step })
    }
}

/// The sentence of the event of a step.
fn sentence(step_ns: i64, handle: &Handle) -> String {
    let event = Event::new(Severity::Warn, Kind::Warning, Object::Machine, Code::CLOCK_STEPPED);
    text::message(&event.with(Number::Count(step_ns), Number::None), handle.machine_config())
}

/// The times of cycles, in the cycle thread.
#[derive(Debug)]
pub struct CycleClock {
    clock: HostClock,
    /// As far as cycles have followed that of the clock (ns).
    base_ns: i64,
}

impl CycleClock {
    /// Times by `clock`.
    pub fn new(clock: HostClock) -> Self {
        Self { base_ns: clock.base_ns(), clock }
    }

    /// The time of the cycle with this deadline (ns of the monotonic clock), `cycle_ns` or more after the one before. Makes no system call.
    pub fn at(&mut self, deadline: u64, cycle_ns: u64) -> CycleTime {
        let most = cycle_ns.cast_signed() / CYCLE_SLEW;
        let missing = self.clock.base_ns().wrapping_sub(self.base_ns);
        self.base_ns = self.base_ns.wrapping_add(missing.clamp(-most, most));
        let log_ns = deadline.saturating_add_signed(self.base_ns);
        CycleTime { log_ns, stamp_ns: log_ns.saturating_add_signed(self.clock.steps_ns()) }
    }
}

#[cfg(test)]
mod tests;
