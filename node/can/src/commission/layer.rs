//! LSS: sets node IDs and bit rates of devices that are selected by their identity (CiA 305).
//!
//! Law      the selected device is switched to configuration state, configured, and switched back to waiting state, also if it refuses
//! Refuses  an identity that no device has; commands that the device refuses
//! Source   CiA 305

use super::session::{CommissionError, Session};
use crate::Frame;
use crate::lss::{FastScan, Identity, LssCommand, LssError, Outcome, is_selected, select};
use std::time::Duration;

/// Longest time for an answer during a search. It passes completely if the answer is no, as no device sends a frame then.
const ANSWER: Duration = Duration::from_millis(100);

impl Session {
    /// Searches for the first device without a node ID. Calls `progress` with the number of sent requests and the total number.
    ///
    /// # Errors
    /// The device that was found no longer answers; the bus connection is lost.
    pub fn search(&mut self, progress: &mut dyn FnMut(usize, usize)) -> Result<Option<Identity>, CommissionError> {
        let patience = ANSWER.min(Duration::from_nanos(self.timeout_ns()));
        self.send(&LssCommand::SwitchToWaiting.frame())?;
        let mut scan = FastScan::default();
        let mut asked = 0;
        let outcome = loop {
            self.send(&scan.next_question())?;
            asked += 1;
            progress(asked, FastScan::QUESTIONS);
            let is_answered =
                self.wait_for_answer(patience, |frame| FastScan::is_answer(frame).then_some(()))?.is_some();
            if let Some(outcome) = scan.next(is_answered) {
                break outcome;
            }
        };
        self.send(&LssCommand::SwitchToWaiting.frame())?;
        match outcome {
            Outcome::Found(identity) => Ok(Some(identity)),
            Outcome::Nobody => Ok(None),
            Outcome::Lost => Err(CommissionError::LostInSearch),
        }
    }

    /// Sends a command to the device with an identity.
    ///
    /// # Errors
    /// No device has the identity; the device refuses or does not answer; the bus connection is lost.
    pub fn send_lss_command(&mut self, identity: Identity, command: LssCommand) -> Result<(), CommissionError> {
        self.send(&LssCommand::SwitchToWaiting.frame())?;
        let time = Duration::from_nanos(self.timeout_ns());
        for frame in select(identity) {
            self.send(&frame)?;
        }
        if self.wait_for_answer(time, |frame| is_selected(frame).then_some(()))?.is_none() {
            return Err(CommissionError::Nobody(identity));
        }
        self.send(&command.frame())?;
        let answer: Option<Result<(), LssError>> = self.wait_for_answer(time, |frame| command.result_of(frame))?;
        self.send(&LssCommand::SwitchToWaiting.frame())?;
        match answer {
            Some(done) => done.map_err(CommissionError::Lss),
            None => Err(CommissionError::SilentLss(self.timeout_ns() / 1_000_000)),
        }
    }

    /// Listens until a frame is an answer, or the time has passed.
    fn wait_for_answer<T>(
        &mut self,
        time: Duration,
        is_it: impl Fn(&Frame) -> Option<T>,
    ) -> Result<Option<T>, CommissionError> {
        let begin = self.elapsed();
        let mut answer = None;
        self.listen(|now, frame| {
            answer = frame.and_then(&is_it);
            answer.is_none() && now.saturating_sub(begin) < time
        })?;
        Ok(answer)
    }
}
