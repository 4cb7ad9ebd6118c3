//! Handles requests of `~/record`.

use super::super::flight::Segments;
use super::super::spawn;
use super::{Answer, Recorder, end};
use crate::recording::bag::BagOptions;
use crate::recording::date_and_time;
use lineshaft_msgs::srv::{RecordRequest, RecordResponse};
use std::path::PathBuf;
use std::time::{SystemTime, UNIX_EPOCH};

/// Permitted durations of a file of a bag, as text.
pub const BAG_DURATIONS: &str = "0 or 1 to 31536000 s";

/// Whether a file of a bag may have that duration, in s. It ends before a key cycle, and those are one second apart;
/// the maximum is one year.
pub fn is_bag_duration(seconds: f64) -> bool {
    seconds == 0.0 || (1.0..=31_536_000.0).contains(&seconds)
}

impl Recorder {
    pub(super) fn answer(&mut self, request: RecordRequest, answer: Answer) {
        let response = match request.command {
            RecordRequest::STATUS => self.done(self.status_text()),
            RecordRequest::START => match self.options(&request) {
                Ok(options) => return self.wait_to_begin(options, answer),
                Err(sentence) => self.refused(sentence),
            },
            RecordRequest::STOP => match self.stop(answer) {
                None => return,
                Some((answer, response)) => {
                    let _ = answer.send(response);
                    return;
                }
            },
            RecordRequest::SAVE => match self.kept() {
                Ok(kept) => return self.save(kept, Some(answer)),
                Err(sentence) => self.refused(sentence.to_owned()),
            },
            other => self.refused(format!("command is {other}; 0 STATUS, 1 START, 2 STOP, 3 SAVE are allowed")),
        };
        // The caller may have gone.
        let _ = answer.send(response);
    }

    /// Ends the recording; returns the answer if there is nothing to end.
    fn stop(&mut self, answer: Answer) -> Option<(Answer, RecordResponse)> {
        if let Some(writer) = self.take_writer() {
            self.ending.push(spawn("bag end", move || {
                let ended = end(writer);
                let _ = answer.send(ended.response.clone());
                ended
            }));
            return None;
        }
        let Some((options, begun)) = self.waiting.take() else {
            return Some((answer, self.refused("nothing is being recorded".to_owned())));
        };
        let message = format!("{} was stopped before it began", options.path.display());
        let _ = begun.send(self.refused(message.clone()));
        Some((answer, self.done(message)))
    }

    /// Returns the content of the flight recorder, if it can be saved now.
    fn kept(&self) -> Result<Segments, &'static str> {
        match (&self.flight, &self.saving) {
            (None, _) => Err("the flight recorder is off"),
            (_, Some(_)) => Err("the flight recorder is saving a bag already"),
            (Some((flight, _)), None) => Ok(flight.cycles()),
        }
    }

    /// Returns the status of the current or last bag.
    fn status(&self) -> RecordResponse {
        let Some(writer) = &self.writer else { return self.last.clone() };
        RecordResponse {
            recording: true,
            path: writer.path.clone(),
            cycles: writer.cycles,
            size: writer.size(),
            lost: writer.lost,
            replayable: writer.lost == 0,
            ..RecordResponse::default()
        }
    }

    fn status_text(&self) -> String {
        match (&self.writer, self.last.message.as_str()) {
            (Some(_), _) => "recording".to_owned(),
            (None, "") => "not recording".to_owned(),
            (None, last) => format!("not recording; the last bag: {last}"),
        }
    }

    fn done(&self, message: String) -> RecordResponse {
        RecordResponse { success: true, message, ..self.status() }
    }

    pub(super) fn refused(&self, message: String) -> RecordResponse {
        RecordResponse { success: false, message, ..self.status() }
    }

    /// Returns the options of the recording, if it may begin.
    fn options(&self, request: &RecordRequest) -> Result<BagOptions, String> {
        if let Some(writer) = &self.writer {
            return Err(format!("{} is being recorded already", writer.path));
        }
        if let Some((options, _)) = &self.waiting {
            return Err(format!("{} is about to be recorded already", options.path.display()));
        }
        let seconds = request.max_bag_duration;
        if !is_bag_duration(seconds) {
            return Err(format!("max_bag_duration is {seconds} s; {BAG_DURATIONS} is allowed"));
        }
        let path = if request.path.is_empty() { free_path() } else { PathBuf::from(&request.path) };
        Ok(BagOptions::split(path, request.max_bag_size, (seconds * 1e9) as u64))
    }
}

/// Returns a path with the current time as name that does not exist yet.
fn free_path() -> PathBuf {
    // The cast is valid until the year 2554; a clock before 1970 gives 1970.
    let now = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |now| now.as_nanos() as u64);
    let name = format!("lineshaft_{}", date_and_time(now));
    let names = std::iter::once(name.clone()).chain((2..).map(|number| format!("{name}_{number}")));
    names.map(PathBuf::from).find(|path| !path.exists()).unwrap_or_default()
}
