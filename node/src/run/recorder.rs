//! Recorder: receives complete cycles from the cycle thread, keeps them packed in the flight recorder, and converts
//! them to messages of the current bag.
//!
//! The recorder runs in its own thread; other threads write bags. Errors are reported as an event of the machine (a
//! command `Note`, so that the recording contains it) and in the log.

mod published;
mod requests;

use super::bridge::Handle;
use super::decoder::Decoder;
use super::flight::folder::FlightFolder;
use super::flight::{Flight, Segments};
use super::frames::{FrameReceiver, Head, Taken};
use super::spawn;
use super::writer::{Failure, Writer};
use crate::recording::Encoded;
use crate::recording::bag::{Bag, BagError, BagOptions, Subject, Summary};
use crate::recording::encoder::Encoder;
use lineshaft_core::code::Code;
use lineshaft_core::command::{Action, Source};
use lineshaft_core::drive::FrameSource;
use lineshaft_core::event::{Event, Kind, Severity};
use lineshaft_msgs::srv::{RecordRequest, RecordResponse};
use lineshaft_ros::surface::host::{Host, SubmitError};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::Receiver;
use std::thread::JoinHandle;
use std::time::{Duration, Instant};
use tokio::sync::oneshot;

pub use published::Published;
pub use requests::{BAG_DURATIONS, is_bag_duration};

/// Polling interval for cycles.
const PERIOD: Duration = Duration::from_millis(20);
/// Maximum number of cycles per pass; requests and failures are handled between passes.
const MOST_CYCLES: usize = 512;
/// Minimum time between two events about missing cycles.
const SECOND: Duration = Duration::from_secs(1);

/// A request of `~/record` and the sender of its answer.
pub type Asked = (RecordRequest, Answer);
type Answer = oneshot::Sender<RecordResponse>;

/// The flight recorder of a run: its memory and the folder of its bags.
pub type FlightRecorder = (Flight, FlightFolder);

/// Name of a bus, and its frames.
pub type NamedFrames = (String, Box<dyn FrameSource>);

/// Recorder of a running machine.
pub struct Recorder {
    handle: Arc<Handle>,
    frames: FrameReceiver,
    /// Content of the received cycle.
    taken: Taken,
    decoder: Decoder,
    subject: Arc<Subject>,
    asked: Receiver<Asked>,
    writer: Option<Writer>,
    /// A bag that begins with the next suitable cycle.
    waiting: Option<(BagOptions, Answer)>,
    flight: Option<FlightRecorder>,
    /// Buses and their frames.
    buses: Vec<NamedFrames>,
    /// Messages of the node, if bags contain them.
    published: Option<Published>,
    /// Bags that are being finished, each in its own thread.
    ending: Vec<JoinHandle<Ended>>,
    /// Bag of the flight recorder that is being saved.
    saving: Option<JoinHandle<Ended>>,
    /// Status when the last bag ended.
    last: RecordResponse,
    next_cycle: u64,
    /// Number of missing cycles that were noticed.
    gaps: u64,
    /// Number of missing cycles that were not reported yet.
    missing: u64,
    told: Option<Instant>,
    /// Whether a bag was not finished without error.
    has_failed: bool,
}

/// Result of a bag.
struct Ended {
    response: RecordResponse,
    /// Error code and error number of the operating system, for the machine.
    failed: Option<(Code, i32)>,
}

impl Recorder {
    /// Creates a recorder; `bag` is written from the first cycle on.
    pub fn new(
        handle: Arc<Handle>,
        frames: FrameReceiver,
        encoder: Encoder,
        subject: Arc<Subject>,
        asked: Receiver<Asked>,
        bag: Option<Bag>,
        flight: Option<FlightRecorder>,
    ) -> Self {
        let decoder = Decoder::new(frames.unpacker(), encoder, handle.config());
        Self {
            handle,
            frames,
            taken: Taken::default(),
            decoder,
            subject,
            asked,
            writer: bag.map(Writer::of),
            waiting: None,
            flight,
            buses: Vec::new(),
            published: None,
            ending: Vec::new(),
            saving: None,
            last: RecordResponse::default(),
            next_cycle: 0,
            gaps: 0,
            missing: 0,
            told: None,
            has_failed: false,
        }
    }

    /// Records frames of buses: in the bags of the flight recorder, and in bags whose [`Subject`] has the buses.
    pub fn with_buses(self, buses: Vec<NamedFrames>) -> Self {
        Self { buses, ..self }
    }

    /// Writes messages of the node into bags whose [`Subject`] has their topics.
    pub fn with_published(self, published: Option<Published>) -> Self {
        Self { published, ..self }
    }

    /// Runs until `stop` is set, then receives the remaining cycles and finishes all bags. Returns true if nothing
    /// failed.
    pub fn run(mut self, stop: &AtomicBool) -> bool {
        while !stop.load(Ordering::Relaxed) {
            if !self.look() {
                std::thread::sleep(PERIOD);
            }
        }
        while self.look() {}
        self.end()
    }

    /// Handles all pending data; returns true if there is more.
    fn look(&mut self) -> bool {
        let is_wanted = self.writer.is_some() || self.waiting.is_some();
        if let Some(published) = &mut self.published {
            published.hear(is_wanted);
        }
        let mut left = MOST_CYCLES;
        while left > 0
            && let Some(head) = self.frames.take(&mut self.taken)
        {
            self.take(head);
            left -= 1;
        }
        self.report_missing();
        self.notice_failure();
        self.collect();
        self.give_up_waiting();
        while let Ok((request, answer)) = self.asked.try_recv() {
            self.answer(request, answer);
        }
        left == 0
    }

    fn take(&mut self, mut head: Head) {
        self.count_missing(head.cycle);
        for (bus, (_, frames)) in self.buses.iter_mut().enumerate() {
            let kind = frames.kind();
            frames.take(head.cycle, &mut |frame| self.taken.extras.frames.push(bus, kind, frame));
        }
        let is_wanted = self.writer.is_some() || (self.waiting.is_some() && head.can_begin());
        if is_wanted {
            let mut encoded = self.decoder.decode(&head, &self.taken);
            match &mut self.published {
                Some(published) if self.writer.is_some() => published.add_to(&mut encoded),
                Some(published) => published.begin(&mut encoded),
                None => {}
            }
            let encoded = Arc::new(encoded);
            self.begin_waiting(&encoded);
            if let Some(writer) = &mut self.writer
                && !writer.push(&encoded)
            {
                self.missing += 1;
                if let Some(published) = &mut self.published {
                    published.leave_out(&encoded);
                }
            }
        } else if let Some(published) = &mut self.published {
            published.skip(head.time.stamp_ns);
        }
        // A fault in a cycle that was dropped counts as well.
        let is_fault = self.taken.left_out.iter().chain(&self.taken.extras.events).any(is_fault);
        if let Some((flight, _)) = &mut self.flight
            && flight.push(&head, &mut self.taken, is_fault)
            // While a bag is being saved the next one waits; its cycles stay in memory.
            && self.saving.is_none()
        {
            let kept = flight.freeze();
            self.save(kept, None);
        }
        if let Some(state) = head.state.take() {
            self.frames.give_back(state);
        }
    }

    /// Whether no recording needs the cycles.
    fn is_idle(&self) -> bool {
        self.writer.is_none() && self.waiting.is_none() && self.flight.is_none()
    }

    fn count_missing(&mut self, cycle: u64) {
        let gap = cycle.saturating_sub(self.next_cycle);
        self.next_cycle = cycle + 1;
        self.gaps += gap;
        if gap > 0
            && let Some(writer) = &mut self.writer
        {
            writer.lose(gap);
        }
        self.missing += if self.is_idle() { 0 } else { gap };
    }

    /// Reports missing cycles in one event, at most once per second.
    fn report_missing(&mut self) {
        if self.missing == 0 || self.told.is_some_and(|told| told.elapsed() < SECOND) {
            return;
        }
        let missing = std::mem::take(&mut self.missing);
        self.told = Some(Instant::now());
        self.note(Code::RECORD_LOST, i64::try_from(missing).unwrap_or(i64::MAX));
    }

    fn note(&self, code: Code, number: i64) {
        // If the queue is full, only the log has it.
        if self.handle.submit_as(Source::Machine, Action::Note { code, number }).is_err() {
            tracing::error!("recorder: code {} ({number}) cannot be told as an event: no cycle takes it", code.0);
        }
    }

    /// Cancels a bag that waits for a cycle although none runs.
    fn give_up_waiting(&mut self) {
        if !self.handle.takes_commands()
            && let Some((_, answer)) = self.waiting.take()
        {
            let _ = answer.send(self.refused(SubmitError::Unconfigured.to_string()));
        }
    }

    /// Begins a bag with the next suitable cycle.
    fn wait_to_begin(&mut self, options: BagOptions, answer: Answer) {
        if let Some(published) = &self.published {
            published.open();
        }
        self.waiting = Some((options, answer));
    }

    fn begin_waiting(&mut self, cycle: &Encoded) {
        if cycle.can_begin()
            && let Some((options, answer)) = self.waiting.take()
        {
            let subject = Subject::clone(&self.subject);
            self.writer = Some(Writer::begin(options, subject, cycle.cycle, answer));
        }
    }

    /// Handles a bag that ended by itself because of an error.
    fn notice_failure(&mut self) {
        if let Some(writer) = self.writer.take_if(|writer| writer.is_over()) {
            let ended = end(writer);
            self.settle(ended);
        }
    }

    /// Records the result of a bag.
    fn settle(&mut self, ended: Ended) {
        self.fail(ended.failed);
        self.last = ended.response;
    }

    fn fail(&mut self, failed: Option<(Code, i32)>) {
        if let Some((code, number)) = failed {
            self.has_failed = true;
            self.note(code, number.into());
        }
    }

    fn collect(&mut self) {
        while let Some(place) = self.ending.iter().position(JoinHandle::is_finished) {
            if let Ok(ended) = self.ending.swap_remove(place).join() {
                self.settle(ended);
            }
        }
        if let Some(saving) = self.saving.take_if(|saving| saving.is_finished())
            && let Ok(ended) = saving.join()
        {
            self.fail(ended.failed);
        }
    }

    /// Removes the writer, after it got all information about its bag.
    fn take_writer(&mut self) -> Option<Writer> {
        let mut writer = self.writer.take()?;
        // Cycles that were dropped after the last received one have left no gap yet.
        let unseen = self.frames.lost().saturating_sub(self.gaps);
        if unseen > 0 {
            writer.lose(unseen);
        }
        if let Some(published) = &mut self.published {
            writer.push_late(published.take_rest());
        }
        Some(writer)
    }

    /// Saves cycles as a bag of the flight recorder.
    fn save(&mut self, kept: Segments, answer: Option<Answer>) {
        let Some((_, folder)) = &self.flight else { return };
        let buses = self.buses.iter().map(|(name, _)| name.clone()).collect();
        let (folder, subject) =
            (folder.clone(), Subject { buses, published: Vec::new(), ..Subject::clone(&self.subject) });
        let mut decoder = self.decoder.clone();
        let is_recording = self.writer.is_some();
        self.saving = Some(spawn("flight bag", move || {
            let saved = folder.save(&kept, &mut decoder, &subject);
            let ended = ended(saved, "saved", Code::FLIGHT_FAILED, &folder.to_string());
            let response = RecordResponse { recording: is_recording, ..ended.response.clone() };
            // The caller may have gone.
            let _ = answer.map(|answer| answer.send(response));
            ended
        }));
    }

    /// Ends all bags; waits for the disk.
    fn end(mut self) -> bool {
        // A bag that is being saved may lack the last fault.
        if let Some(saving) = self.saving.take()
            && let Ok(ended) = saving.join()
        {
            self.has_failed |= ended.failed.is_some();
        }
        if let Some((flight, _)) = &mut self.flight
            && flight.is_due()
        {
            let kept = flight.freeze();
            self.save(kept, None);
        }
        let writer = self.take_writer();
        if self.missing > 0 {
            tracing::warn!("{} cycles are missing in the recording, told of here alone", self.missing);
        }
        let ended = writer.map(end).into_iter();
        // A thread that panicked has reported it.
        let threads = self.ending.into_iter().chain(self.saving).flat_map(JoinHandle::join);
        ended.chain(threads).fold(!self.has_failed, |is_good, ended| is_good && ended.failed.is_none())
    }
}

fn is_fault(event: &Event) -> bool {
    event.severity == Severity::Error && event.kind == Kind::Error
}

/// Finishes a bag.
fn end(writer: Writer) -> Ended {
    let path = writer.path.clone();
    match writer.finish() {
        Ok(summary) => ended(Ok(summary), "recorded", Code::RECORD_FAILED, &path),
        Err(Failure::Broken(error)) => ended(Err(error), "recorded", Code::RECORD_FAILED, &path),
        // The client that requested it got the reason.
        Err(Failure::NotBegun(message)) => {
            Ended { response: RecordResponse { message, path, ..RecordResponse::default() }, failed: None }
        }
    }
}

/// Logs the result of a bag and returns it.
fn ended(result: Result<Summary, BagError>, done: &str, code: Code, path: &str) -> Ended {
    match result {
        Ok(Summary { path, cycles, size, lost, replayable, .. }) => {
            let but = if lost > 0 { format!(", {lost} are missing") } else { String::new() };
            let (message, path) = (format!("{done} {cycles} cycles{but}"), path.display().to_string());
            tracing::info!("{message}: {path}");
            let response =
                RecordResponse { success: true, message, recording: false, path, cycles, size, lost, replayable };
            Ended { response, failed: None }
        }
        Err(error) => {
            tracing::error!("{error}");
            let response =
                RecordResponse { message: error.to_string(), path: path.to_owned(), ..RecordResponse::default() };
            // A refused bag was never begun, so nothing has failed.
            let failed = matches!(error, BagError::Write { .. }).then(|| (code, error.system_error()));
            Ended { response, failed }
        }
    }
}

#[cfg(test)]
mod tests;
