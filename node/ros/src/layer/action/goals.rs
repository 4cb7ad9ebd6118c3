//! The goals of one action: their states, who waits for their results, what a cancel request means. Knows no DDS.
//!
//! Law      accepted -> executing -> succeeded | aborted; accepted or executing -> canceling -> canceled | succeeded |
//!          aborted. Every client gets the result of an ended goal, until its time has passed. A goal that
//!          is canceled while it is being decided begins with canceling. A cancel request for all goals means those that
//!          were sent before it
//! Refuses  an id that is known, also one that is still being decided or has ended
//! Source   rcl_action, except: who cancels a goal that is canceling already is told that it is, not that it has ended

use std::fmt;
use std::time::{Duration, Instant};

use lineshaft_msgs::foreign::action_msgs::msg::GoalStatus;
use lineshaft_msgs::foreign::action_msgs::srv::CancelGoalResponse;
use lineshaft_msgs::foreign::builtin_interfaces::msg::Time;
use tokio::sync::watch;

use crate::layer::service::Origin;

/// Who may wait for the result of one goal; of more, the first to ask is forgotten. A goal that stays open for days is asked
/// for by clients that have gone since.
const MOST_ASKERS: usize = 256;

/// Identifier of a goal, which its client chose.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct GoalId(pub [u8; 16]);

impl fmt::Display for GoalId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, byte) in self.0.iter().enumerate() {
            let dash = if matches!(index, 4 | 6 | 8 | 10) { "-" } else { "" };
            write!(f, "{dash}{byte:02x}")?;
        }
        Ok(())
    }
}

/// State of an accepted goal, with its number on the wire.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i8)]
pub enum Status {
    /// Accepted, not begun.
    Accepted = GoalStatus::STATUS_ACCEPTED,
    /// Being done.
    Executing = GoalStatus::STATUS_EXECUTING,
    /// To be given up.
    Canceling = GoalStatus::STATUS_CANCELING,
    /// Reached.
    Succeeded = GoalStatus::STATUS_SUCCEEDED,
    /// Given up because a client asked for it.
    Canceled = GoalStatus::STATUS_CANCELED,
    /// Given up for another reason.
    Aborted = GoalStatus::STATUS_ABORTED,
}

/// How a goal ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum End {
    Succeeded,
    Canceled,
    Aborted,
}

/// When a goal was accepted; earlier is less.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Stamp {
    sec: i32,
    nanosec: u32,
}

impl From<&Time> for Stamp {
    fn from(time: &Time) -> Self {
        Self { sec: time.sec, nanosec: time.nanosec }
    }
}

impl From<Stamp> for Time {
    fn from(stamp: Stamp) -> Self {
        Self { sec: stamp.sec, nanosec: stamp.nanosec }
    }
}

/// A goal as the status topic shows it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Shown {
    pub(super) id: GoalId,
    pub(super) stamp: Stamp,
    pub(super) status: Status,
}

/// What a cancel request means.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Selection {
    /// The answer, unless the application refuses all of `open`.
    pub(super) code: i8,
    /// Goals that can begin to cancel.
    pub(super) open: Vec<GoalId>,
    /// Goals that do so already.
    pub(super) canceling: Vec<GoalId>,
}

/// Answer to one who asks for a result.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum Asked<R, W> {
    /// There is no such goal.
    Unknown(W),
    /// It has ended.
    Ended(W, Status, R),
    /// He is told when it ends.
    Waits,
}

/// All goals of an action server; `R` is a result, `W` somebody who waits for one.
#[derive(Debug)]
pub(super) struct Goals<R, W> {
    /// In the order in which they were accepted.
    kept: Vec<Goal<R, W>>,
    /// In the order in which they were offered.
    deciding: Vec<Deciding>,
    keep: Duration,
    most: usize,
}

/// A goal before the application accepts or rejects it.
#[derive(Debug)]
struct Deciding {
    id: GoalId,
    origin: Origin,
    is_canceled: bool,
}

#[derive(Debug)]
struct Goal<R, W> {
    shown: Shown,
    /// When it was sent; `None` if it was never offered.
    origin: Option<Origin>,
    cancel: watch::Sender<bool>,
    waiting: Vec<W>,
    ended: Option<(Instant, R)>,
}

impl<R: Clone, W> Goals<R, W> {
    /// Ended goals are kept for `keep`, and not more than `most` of them.
    pub(super) fn new(keep: Duration, most: usize) -> Self {
        Self { kept: Vec::new(), deciding: Vec::new(), keep, most }
    }

    /// Takes a goal for decision; false when its id is known.
    pub(super) fn offer(&mut self, id: GoalId, origin: Origin, now: Instant) -> bool {
        self.expire(now);
        if self.knows(id) {
            return false;
        }
        self.deciding.push(Deciding { id, origin, is_canceled: false });
        true
    }

    /// Whether there is such a goal, accepted or not.
    pub(super) fn knows(&self, id: GoalId) -> bool {
        self.find(id).is_some() || self.deciding.iter().any(|goal| goal.id == id)
    }

    /// The offered goal is not accepted.
    pub(super) fn withdraw(&mut self, id: GoalId) {
        self.deciding.retain(|goal| goal.id != id);
    }

    /// The offered goal is accepted. The receiver is true once a client has canceled it.
    pub(super) fn accept(&mut self, id: GoalId, stamp: Stamp) -> watch::Receiver<bool> {
        let place = self.deciding.iter().position(|goal| goal.id == id);
        let decided = place.map(|place| self.deciding.remove(place));
        let is_canceled = decided.as_ref().is_some_and(|goal| goal.is_canceled);
        let (cancel, canceled) = watch::channel(is_canceled);
        let shown = Shown { id, stamp, status: if is_canceled { Status::Canceling } else { Status::Accepted } };
        let origin = decided.map(|goal| goal.origin);
        self.kept.push(Goal { shown, origin, cancel, waiting: Vec::new(), ended: None });
        canceled
    }

    /// The goal is being done; false when that is nothing new.
    pub(super) fn execute(&mut self, id: GoalId) -> bool {
        match self.find_mut(id) {
            Some(goal) if goal.shown.status == Status::Accepted => {
                goal.shown.status = Status::Executing;
                true
            }
            _ => false,
        }
    }

    /// What a cancel request for `id` and `stamp` means: both zero all goals that were sent before it, a stamp alone those
    /// accepted at or before it, an id alone that goal, both that goal and those accepted at or before the stamp.
    pub(super) fn select(&mut self, id: GoalId, stamp: Stamp, origin: Origin, now: Instant) -> Selection {
        self.expire(now);
        let (no_id, no_stamp) = (id == GoalId::default(), stamp == Stamp::default());
        let mut selection = Selection { code: CancelGoalResponse::ERROR_NONE, open: Vec::new(), canceling: Vec::new() };
        for goal in &self.kept {
            let is_before = || goal.origin.is_none_or(|goal| goal.is_before(origin));
            let meant = goal.shown.id == id || if no_stamp { no_id && is_before() } else { goal.shown.stamp <= stamp };
            match goal.shown.status {
                _ if !meant => {}
                Status::Accepted | Status::Executing => selection.open.push(goal.shown.id),
                Status::Canceling => selection.canceling.push(goal.shown.id),
                Status::Succeeded | Status::Canceled | Status::Aborted => {}
            }
        }
        for goal in &self.deciding {
            let meant = goal.id == id || no_id && no_stamp && goal.origin.is_before(origin);
            match goal.is_canceled {
                _ if !meant => {}
                true => selection.canceling.push(goal.id),
                false => selection.open.push(goal.id),
            }
        }
        if !no_id && no_stamp && selection.open.is_empty() && selection.canceling.is_empty() {
            selection.code = match self.find(id) {
                None => CancelGoalResponse::ERROR_UNKNOWN_GOAL_ID,
                Some(_) => CancelGoalResponse::ERROR_GOAL_TERMINATED,
            };
        }
        selection
    }

    /// Lets these goals cancel; returns those that do, of which some may have done so before.
    pub(super) fn cancel(&mut self, ids: &[GoalId]) -> Vec<Shown> {
        let mut canceling = Vec::new();
        for goal in self.kept.iter_mut().filter(|goal| ids.contains(&goal.shown.id) && goal.ended.is_none()) {
            goal.shown.status = Status::Canceling;
            goal.cancel.send_replace(true);
            canceling.push(goal.shown);
        }
        for goal in self.deciding.iter_mut().filter(|goal| ids.contains(&goal.id)) {
            goal.is_canceled = true;
            // It gets its stamp when it is accepted.
            canceling.push(Shown { id: goal.id, stamp: Stamp::default(), status: Status::Canceling });
        }
        canceling
    }

    /// Ends a goal; returns its final status and who waits for the result. `None` when it has ended before.
    /// A goal that nobody canceled cannot end canceled: it ends aborted.
    pub(super) fn end(&mut self, id: GoalId, end: End, result: R, now: Instant) -> Option<(Status, Vec<W>)> {
        let goal = self.find_mut(id).filter(|goal| goal.ended.is_none())?;
        goal.shown.status = match end {
            End::Succeeded => Status::Succeeded,
            End::Canceled if goal.shown.status == Status::Canceling => Status::Canceled,
            End::Canceled | End::Aborted => Status::Aborted,
        };
        goal.ended = Some((now, result));
        let ended = (goal.shown.status, std::mem::take(&mut goal.waiting));
        self.expire(now);
        Some(ended)
    }

    /// Somebody asks for a result.
    pub(super) fn ask(&mut self, id: GoalId, who: W, now: Instant) -> Asked<R, W> {
        self.expire(now);
        match self.find_mut(id) {
            None => Asked::Unknown(who),
            Some(Goal { ended: Some((_, result)), shown, .. }) => Asked::Ended(who, shown.status, result.clone()),
            Some(goal) => {
                if goal.waiting.len() >= MOST_ASKERS {
                    goal.waiting.remove(0);
                }
                goal.waiting.push(who);
                Asked::Waits
            }
        }
    }

    /// Forgets ended goals whose time is over, and the oldest of those that are too many.
    pub(super) fn expire(&mut self, now: Instant) {
        let keep = self.keep;
        self.kept.retain(|goal| goal.ended.as_ref().is_none_or(|(end, _)| now.duration_since(*end) < keep));
        let ended = self.kept.iter().filter(|goal| goal.ended.is_some()).count();
        for _ in self.most..ended {
            let ends = self.kept.iter().enumerate().filter_map(|(index, goal)| Some((goal.ended.as_ref()?.0, index)));
            if let Some((_, oldest)) = ends.min() {
                self.kept.remove(oldest);
            }
        }
    }

    /// All goals that are kept, in the order in which they were accepted.
    pub(super) fn shown(&self) -> impl Iterator<Item = Shown> {
        self.kept.iter().map(|goal| goal.shown)
    }

    fn find(&self, id: GoalId) -> Option<&Goal<R, W>> {
        self.kept.iter().find(|goal| goal.shown.id == id)
    }

    fn find_mut(&mut self, id: GoalId) -> Option<&mut Goal<R, W>> {
        self.kept.iter_mut().find(|goal| goal.shown.id == id)
    }
}

#[cfg(test)]
mod tests;
