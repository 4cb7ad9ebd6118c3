//! State of homing of an axis.

pub(in crate::axis) mod in_drive;
pub(crate) mod methods;
pub(in crate::axis) mod search;

use crate::position::Position;
use crate::profile::Limits;
use crate::state::HomingPhase;
use in_drive::InDrive;
use search::Search;
use serde::{Deserialize, Serialize};

/// State of homing of an axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(in crate::axis) struct Homing {
    /// Whether the axis is referenced.
    done: bool,
    /// Whether the reference was lost and this has not been reported yet.
    lost: bool,
    /// Whether positions relative to any zero, of homing or set by a command, have become invalid.
    unsure: bool,
    /// Whether the counts started again during homing.
    broken: bool,
    /// Active homing.
    run: Option<Run>,
    /// Whether homing was ended early and the axis has not come to rest since.
    ends: bool,
    /// Distance by which set_position has moved the software limits since the last homing (inc).
    limit_shift: i64,
}

/// Active homing, with the parameters of its start.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(in crate::axis) struct Run {
    pub(in crate::axis) method: i64,
    /// Direction of way 1 in the coordinate of the axis: 1 or -1.
    pub(in crate::axis) sense: i8,
    /// Velocities: fast, reduced, slow (inc/s).
    pub(in crate::axis) speeds: [f64; 3],
    pub(in crate::axis) limits: Limits,
    /// Distance that the axis moves from the reference (inc). None: it only stops.
    pub(in crate::axis) goes: Option<i64>,
    /// Distance from the reference to the zero (inc).
    pub(in crate::axis) offset: i64,
    /// Cycle in which it began.
    pub(in crate::axis) began: u64,
    /// Whole minutes of homing in the drive that were reported.
    pub(in crate::axis) minutes: u64,
    pub(in crate::axis) stage: Stage,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(in crate::axis) enum Stage {
    /// Searches for the reference.
    Search(Search),
    /// Found: stops anywhere, or moves to the zero.
    Found { zero: Position, goes: bool },
    /// The drive searches for it.
    InDrive(InDrive),
}

impl Run {
    /// Returns the direction in which the reference is approached, in the coordinate of the axis: 1 or -1; 0 for a
    /// method without motion.
    #[inline]
    pub(in crate::axis) fn approach(&self) -> i8 {
        methods::legs(self.method).last().map_or(0, |leg| leg.way * self.sense)
    }

    /// Whether the axis moves there by its command.
    #[inline]
    pub(in crate::axis) fn is_own(&self) -> bool {
        !matches!(self.stage, Stage::InDrive(_))
    }

    /// Returns the velocity of a leg (inc/s).
    pub(in crate::axis) fn speed(&self, leg: &methods::Leg) -> f64 {
        let [fast, reduced, slow] = self.speeds;
        match leg.speed {
            methods::Speed::Fast => fast,
            methods::Speed::Reduced => reduced,
            methods::Speed::Slow => slow,
        }
    }
}

impl Homing {
    /// Returns the active homing.
    #[inline]
    pub(in crate::axis) fn run(&self) -> Option<Run> {
        self.run
    }

    /// Begins homing, or continues it in another stage.
    #[inline]
    pub(in crate::axis) fn continue_run(&mut self, run: Run) {
        self.run = Some(run);
    }

    /// Ends active homing with its zero, and returns it.
    pub(in crate::axis) fn finish(&mut self) -> Option<Run> {
        (self.done, self.lost) = (true, false);
        self.run.take()
    }

    /// Notes the whole minutes of homing in the drive that were reported.
    pub(in crate::axis) fn note_minutes(&mut self, minutes: u64) {
        if let Some(run) = &mut self.run {
            run.minutes = minutes;
        }
    }

    /// Whether positions relative to any zero have become invalid since the last call.
    #[inline]
    pub(in crate::axis) fn take_unsure(&mut self) -> bool {
        std::mem::take(&mut self.unsure)
    }

    /// Whether the reference was lost since the last call.
    #[inline]
    pub(in crate::axis) fn take_lost(&mut self) -> bool {
        std::mem::take(&mut self.lost)
    }

    /// Whether the counts started again during homing since the last call.
    #[inline]
    pub(in crate::axis) fn take_broken(&mut self) -> bool {
        std::mem::take(&mut self.broken)
    }

    /// Handles counts that start again: the reference is lost, and active homing cannot continue.
    pub(in crate::axis) fn break_counts(&mut self) {
        self.forget();
        self.broken = self.is_running();
    }

    /// Notes that the software limits move by `by` (inc) with the coordinate.
    #[inline]
    pub(in crate::axis) fn shift_limits(&mut self, by: i64) {
        self.limit_shift = self.limit_shift.saturating_add(by);
    }

    #[inline]
    pub(in crate::axis) fn is_homed(&self) -> bool {
        self.done
    }

    /// Whether homing is active. Then neither software limits nor limit switches stop the axis; homing itself handles
    /// the switches.
    #[inline]
    pub(in crate::axis) fn is_running(&self) -> bool {
        self.run.is_some()
    }

    /// Whether the drive moves by itself.
    #[inline]
    pub(in crate::axis) fn is_in_drive(&self) -> bool {
        matches!(self.run, Some(Run { stage: Stage::InDrive(_), .. }))
    }

    /// Whether homing is not active and has nothing left to report.
    #[inline]
    pub(in crate::axis) fn is_settled(&self) -> bool {
        self.run.is_none() && !self.lost && !self.unsure && !self.broken && !self.ends
    }

    /// Returns the difference between its coordinate and that of its own zero (inc).
    #[inline]
    pub(in crate::axis) fn limit_shift(&self) -> i64 {
        self.limit_shift
    }

    pub(in crate::axis) fn phase(&self) -> HomingPhase {
        let Some(run) = self.run else { return HomingPhase::None };
        match run.stage {
            Stage::Search(search) => search.phase(run.method),
            Stage::Found { goes: true, .. } => HomingPhase::MoveToOffset,
            Stage::Found { .. } => search::last_phase(run.method),
            Stage::InDrive(_) => HomingPhase::InDrive,
        }
    }

    /// Ends active homing without a zero.
    #[inline]
    pub(in crate::axis) fn stop(&mut self) {
        self.ends |= self.run.take().is_some();
    }

    /// Ends active homing without a zero, for a motion that replaces it.
    pub(in crate::axis) fn cancel_homing(&mut self) {
        self.run = None;
        self.ends = false;
    }

    /// Whether the axis still stops after homing was ended.
    #[inline]
    pub(in crate::axis) fn is_ending(&self) -> bool {
        self.ends
    }

    /// Called when the axis is at rest or does something else.
    #[inline]
    pub(in crate::axis) fn forget_end(&mut self) {
        self.ends = false;
    }

    /// Makes the axis unreferenced.
    pub(in crate::axis) fn forget(&mut self) {
        self.lost |= self.done;
        self.unsure = true;
        self.done = false;
    }

    /// Called when the encoder that gave the reference is no longer in use.
    #[inline]
    pub(in crate::axis) fn forget_reference_of_encoder(&mut self) {
        self.lost = true;
    }

    /// Mirrors the stored distances.
    #[inline]
    pub(in crate::axis) fn turn_over(&mut self) {
        self.limit_shift = self.limit_shift.saturating_neg();
    }

    pub(in crate::axis) fn is_sound(&self) -> bool {
        self.run.is_none_or(|run| {
            let good = |rate: f64| rate > 0.0 && rate.is_finite();
            let searches = match run.stage {
                Stage::Search(search) => search.is_sound(run.method),
                _ => true,
            };
            run.speeds.into_iter().all(good) && run.limits.is_sound() && matches!(run.sense, 1 | -1) && searches
        })
    }
}
