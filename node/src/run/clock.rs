//! Makes stamps follow the system clock; times in recordings have no steps.
//!
//! Law      offset = system clock - monotonic clock, read every `LOOK`. A change by more than [`CLOCK_STEP_NS`] is a
//!          step: an event (`CLOCK_STEPPED`), which the bridge also logs, is published; stamps show the step after
//!          `HOLD`. A smaller change is followed by a fraction `SLEW` of the elapsed time, so that stamps never
//!          decrease
//! Reads    the system clock in the bridge; the cycle thread only loads two atomics
//! Writes   the [`HostClock`], from which all stamps are made

use super::bridge::Handle;
use crate::recording::{CLOCK_STEP_NS, CycleTime};
use lineshaft_core::code::Code;
use lineshaft_core::command::{Action, Source};
use lineshaft_core::event::{Event, Kind, Number, Severity};
use lineshaft_core::object::Object;
use lineshaft_core::text;
use lineshaft_ros::layer::HostClock;
use lineshaft_ros::offset::SystemOffset;
use lineshaft_ros::surface::host::SubmitError;
use std::time::{Duration, Instant};

/// Time between two reads of the system clock.
const POLL_INTERVAL: Duration = Duration::from_millis(50);
/// Time between the event of a step and the first stamp that shows it; allows for the transmission of the event.
const HOLD: Duration = Duration::from_millis(100);
/// Maximum time for the event to be published; after it, stamps follow anyway.
const PATIENCE: Duration = Duration::from_millis(500);
/// Steady time changes by at most 1/20 of the elapsed time; in cycles by at most 1/16.
const SLEW: i64 = 20;
const CYCLE_SLEW: i64 = 16;

/// Reaction to the difference between system clock and stamps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Correction {
    Nothing,
    /// Steady time moves by this amount, in ns.
    Slew(i64),
    /// The clock was set by this amount, in ns.
    Step(i64),
}

impl Correction {
    /// Returns the reaction to a difference (in ns) with an uncertainty (in ns), for the time since the last read.
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

/// A step that stamps do not show yet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Step {
    ns: i64,
    stage: Stage,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    /// Found at this time; no command was accepted yet.
    Found(Instant),
    /// Submitted as the command with this number, at this time.
    Submitted(u64, Instant),
    /// Reported at this time.
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

    /// Reads the system clock if it is due, and advances a step.
    pub fn look(&mut self, handle: &Handle) {
        let now = Instant::now();
        if let Some(step) = self.step.take() {
            self.step = self.advance(step, handle, now);
            return;
        }
        let passed = now.duration_since(self.looked);
        if passed < POLL_INTERVAL {
            return;
        }
        self.looked = now;
        let offset = SystemOffset::read();
        let shown = self.clock.base_ns().wrapping_add(self.clock.steps_ns());
        match Correction::of(offset.ns.wrapping_sub(shown), offset.error_ns, passed) {
            Correction::Nothing => {}
            Correction::Slew(by_ns) => self.clock.slew(by_ns),
            Correction::Step(ns) => self.step = self.advance(Step { ns, stage: Stage::Found(now) }, handle, now),
        }
    }

    /// Advances a step; returns `None` once stamps show it.
    fn advance(&self, step: Step, handle: &Handle, now: Instant) -> Option<Step> {
        let is_late = |since: Instant| now.duration_since(since) >= PATIENCE;
        let stage = match step.stage {
            Stage::Found(since) => {
                let note = Action::Note { code: Code::CLOCK_STEPPED, number: step.ns };
                match handle.submit_as(Source::Machine, note) {
                    Ok(sequence) => Stage::Submitted(sequence, now),
                    Err(SubmitError::Full) if !is_late(since) => Stage::Found(since),
                    // No cycle accepts it, so that only the log reports the step.
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

/// Returns the message of the event of a step.
fn sentence(step_ns: i64, handle: &Handle) -> String {
    let event = Event::new(Severity::Warn, Kind::Warning, Object::Machine, Code::CLOCK_STEPPED);
    text::message(&event.with(Number::Count(step_ns), Number::None), handle.machine_config())
}

/// Calculates the times of cycles, in the cycle thread.
#[derive(Debug)]
pub struct CycleClock {
    clock: HostClock,
    /// Base of the clock that cycles have followed so far, in ns.
    base_ns: i64,
}

impl CycleClock {
    /// Creates times from `clock`.
    pub fn new(clock: HostClock) -> Self {
        Self { base_ns: clock.base_ns(), clock }
    }

    /// Returns the time of the cycle with this deadline, in ns of the monotonic clock. It is later than that of the
    /// previous cycle, because the deadline is at least `cycle_ns` less the [bound](super::schedule::shift_bound) after
    /// the previous one. Makes no system call.
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
