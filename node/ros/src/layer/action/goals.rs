//! Goals of one action: their states, waiting result requests, and the selection of goals by a cancel request. Independent of the link.
//!
//! Law      accepted -> executing -> succeeded | aborted; accepted or executing -> canceling -> canceled | succeeded | aborted. Every
//!          client gets the result of an ended goal until its timeout. A goal that is canceled before it is accepted starts as canceling. A
//!          cancel request for all goals applies to those that were sent before it
//! Refuses  an ID that is known, also that of a goal that is still undecided or has ended
//! Source   rcl_action, with one exception: a cancel request for a goal that is already canceling returns success, not that the goal has
//!          ended

use std::fmt;
use std::time::{Duration, Instant};

use lineshaft_msgs::foreign::action_msgs::msg::GoalStatus;
use lineshaft_msgs::foreign::action_msgs::srv::CancelGoalResponse;
use lineshaft_msgs::foreign::builtin_interfaces::msg::Time;
use tokio::sync::watch;

use crate::layer::service::Origin;

/// Maximum number of result requests that wait for one goal; of more, the oldest is dropped. A goal that stays open for days also has
/// requests of clients that have disappeared.
const MAX_RESULT_REQUESTS: usize = 256;

/// Identifier of a goal, which its client has chosen.
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
    /// Accepted, but not started.
    Accepted = GoalStatus::STATUS_ACCEPTED,
    /// Executing.
    Executing = GoalStatus::STATUS_EXECUTING,
    /// To be canceled.
    Canceling = GoalStatus::STATUS_CANCELING,
    /// Reached.
    Succeeded = GoalStatus::STATUS_SUCCEEDED,
    /// Ended because a client has canceled it.
    Canceled = GoalStatus::STATUS_CANCELED,
    /// Ended for another reason.
    Aborted = GoalStatus::STATUS_ABORTED,
}

/// End state of a goal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum End {
    Succeeded,
    Canceled,
    Aborted,
}

/// Time when a goal was accepted, in chronological order.
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

/// Goal as the status topic reports it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct GoalStatusEntry {
    pub(super) id: GoalId,
    pub(super) stamp: Stamp,
    pub(super) status: Status,
}

/// Goals that a cancel request applies to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Selection {
    /// Return code, unless the application refuses all of `open`.
    pub(super) code: i8,
    /// Goals that can start to cancel.
    pub(super) open: Vec<GoalId>,
    /// Goals that are already canceling.
    pub(super) canceling: Vec<GoalId>,
}

/// Answer to a result request.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum ResultAnswer<R, W> {
    /// The goal is unknown.
    Unknown(W),
    /// The goal has ended.
    Ended(W, Status, R),
    /// The answer follows when the goal ends.
    Waits,
}

/// All goals of an action server; `R` is a result, `W` a waiting result request.
#[derive(Debug)]
pub(super) struct Goals<R, W> {
    /// Accepted goals, in the order of their acceptance.
    kept: Vec<Goal<R, W>>,
    /// Offered goals, in the order of their offers.
    deciding: Vec<UndecidedGoal>,
    keep: Duration,
    most: usize,
}

/// Goal before the application accepts or rejects it.
#[derive(Debug)]
struct UndecidedGoal {
    id: GoalId,
    origin: Origin,
    is_canceled: bool,
}

#[derive(Debug)]
struct Goal<R, W> {
    shown: GoalStatusEntry,
    /// Origin of the request; `None` if the goal was never offered.
    origin: Option<Origin>,
    cancel: watch::Sender<bool>,
    waiting: Vec<W>,
    ended: Option<(Instant, R)>,
}

impl<R: Clone, W> Goals<R, W> {
    /// Creates an empty list. Ended goals are kept for `keep`, and not more than `most` of them.
    pub(super) fn new(keep: Duration, most: usize) -> Self {
        Self { kept: Vec::new(), deciding: Vec::new(), keep, most }
    }

    /// Adds a goal that is to be decided; returns false if its ID is known.
    pub(super) fn offer(&mut self, id: GoalId, origin: Origin, now: Instant) -> bool {
        self.expire(now);
        if self.knows(id) {
            return false;
        }
        self.deciding.push(UndecidedGoal { id, origin, is_canceled: false });
        true
    }

    /// Returns true if the goal is known, accepted or not.
    pub(super) fn knows(&self, id: GoalId) -> bool {
        self.find(id).is_some() || self.deciding.iter().any(|goal| goal.id == id)
    }

    /// Removes an offered goal that is not accepted.
    pub(super) fn withdraw(&mut self, id: GoalId) {
        self.deciding.retain(|goal| goal.id != id);
    }

    /// Accepts an offered goal. The receiver becomes true when a client cancels the goal.
    pub(super) fn accept(&mut self, id: GoalId, stamp: Stamp) -> watch::Receiver<bool> {
        let place = self.deciding.iter().position(|goal| goal.id == id);
        let decided = place.map(|place| self.deciding.remove(place));
        let is_canceled = decided.as_ref().is_some_and(|goal| goal.is_canceled);
        let (cancel, canceled) = watch::channel(is_canceled);
        let shown =
            GoalStatusEntry { id, stamp, status: if is_canceled { Status::Canceling } else { Status::Accepted } };
        let origin = decided.map(|goal| goal.origin);
        self.kept.push(Goal { shown, origin, cancel, waiting: Vec::new(), ended: None });
        canceled
    }

    /// Sets a goal to executing; returns false if that changes nothing.
    pub(super) fn execute(&mut self, id: GoalId) -> bool {
        match self.find_mut(id) {
            Some(goal) if goal.shown.status == Status::Accepted => {
                goal.shown.status = Status::Executing;
                true
            }
            _ => false,
        }
    }

    /// Returns the goals that a cancel request for `id` and `stamp` applies to. Both zero: all goals that were sent before it. Only a
    /// stamp: those accepted at or before it. Only an ID: that goal. Both: that goal, and those accepted at or before the stamp.
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

    /// Sets these goals to canceling. Returns those that are canceling, also if they were before.
    pub(super) fn cancel(&mut self, ids: &[GoalId]) -> Vec<GoalStatusEntry> {
        let mut canceling = Vec::new();
        for goal in self.kept.iter_mut().filter(|goal| ids.contains(&goal.shown.id) && goal.ended.is_none()) {
            goal.shown.status = Status::Canceling;
            goal.cancel.send_replace(true);
            canceling.push(goal.shown);
        }
        for goal in self.deciding.iter_mut().filter(|goal| ids.contains(&goal.id)) {
            goal.is_canceled = true;
            // The goal gets its stamp when it is accepted.
            canceling.push(GoalStatusEntry { id: goal.id, stamp: Stamp::default(), status: Status::Canceling });
        }
        canceling
    }

    /// Ends a goal. Returns its final status and the waiting result requests; `None` if it has already ended.
    /// A goal that no client has canceled cannot end canceled: it ends aborted.
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

    /// Handles a result request.
    pub(super) fn request_result(&mut self, id: GoalId, who: W, now: Instant) -> ResultAnswer<R, W> {
        self.expire(now);
        match self.find_mut(id) {
            None => ResultAnswer::Unknown(who),
            Some(Goal { ended: Some((_, result)), shown, .. }) => {
                ResultAnswer::Ended(who, shown.status, result.clone())
            }
            Some(goal) => {
                if goal.waiting.len() >= MAX_RESULT_REQUESTS {
                    goal.waiting.remove(0);
                }
                goal.waiting.push(who);
                ResultAnswer::Waits
            }
        }
    }

    /// Removes ended goals whose timeout has passed, and the oldest ones above the maximum number.
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

    /// Returns all goals, in the order of their acceptance.
    pub(super) fn shown(&self) -> impl Iterator<Item = GoalStatusEntry> {
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
