//! The recorder: takes whole cycles from the cycle thread, keeps them packed in the flight recorder, and makes messages of them for
//! the bag that is being written.
//!
//! The recorder runs on a thread of its own; bags are written by further ones. What goes wrong is told as an event of the machine
//! (a command `Note`, so that it stands in the recording too) and in the log.

mod published;
mod requests;

use super::bridge::Handle;
use super::decoder::Decoder;
use super::flight::folder::FlightFolder;
use super::flight::{Flight, Kept};
use super::frames::{BusFrame, FrameReceiver, Head, Taken};
use super::spawn;
use super::writer::{Failure, Writer};
use crate::recording::bag::{Bag, BagError, BagOptions, Subject, Summary};
use crate::recording::encoder::Encoder;
use crate::recording::{Encoded, Way};
use lineshaft_can::master::Frames;
use lineshaft_core::code::Code;
use lineshaft_core::command::{Action, Source};
use lineshaft_core::event::{Event, Kind, Severity};
use lineshaft_msgs::srv::{RecordRequest, RecordResponse};
use lineshaft_ros::surface::host::{Busy, Host};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::Receiver;
use std::thread::JoinHandle;
use std::time::{Duration, Instant};
use tokio::sync::oneshot;

pub use published::Published;
pub use requests::{BAG_DURATIONS, is_bag_duration};

/// How often it looks for cycles.
const PERIOD: Duration = Duration::from_millis(20);
/// Most cycles of one look: however many there are, requests and failures are looked at in between.
const MOST_CYCLES: usize = 512;
/// Least time between two events about missing cycles.
const SECOND: Duration = Duration::from_secs(1);

/// A request of `~/record` and the way back.
pub type Asked = (RecordRequest, Answer);
type Answer = oneshot::Sender<RecordResponse>;

/// The flight recorder of a run: its memory and where its bags go.
pub type FlightRecorder = (Flight, FlightFolder);

/// A bus on CAN by its name, and the frames that go over it.
pub type BusFrames = (String, Frames);

/// The recorder of a running machine.
pub struct Recorder {
    handle: Arc<Handle>,
    frames: FrameReceiver,
    /// Contents of the received cycle.
    taken: Taken,
    decoder: Decoder,
    subject: Arc<Subject>,
    asked: Receiver<Asked>,
    writer: Option<Writer>,
    /// A bag that begins with the next cycle that one may begin with.
    waiting: Option<(BagOptions, Answer)>,
    flight: Option<FlightRecorder>,
    /// Buses on CAN, and what goes over them.
    buses: Vec<BusFrames>,
    /// What the node publishes, where bags hold it.
    published: Option<Published>,
    /// Bags that are being ended, on threads of their own.
    ending: Vec<JoinHandle<Ended>>,
    /// The bag of the flight recorder that is being saved.
    saving: Option<JoinHandle<Ended>>,
    /// As it was when the last bag ended.
    last: RecordResponse,
    next_cycle: u64,
    /// Cycles whose gaps were seen.
    gaps: u64,
    /// Cycles that are missing and were not told of yet.
    missing: u64,
    told: Option<Instant>,
    /// A bag has no good end.
    has_failed: bool,
}

/// What became of a bag.
struct Ended {
    response: RecordResponse,
    /// How the machine is told where it failed: code and the system's number.
    failed: Option<(Code, i32)>,
}

impl Recorder {
    /// A recorder; `bag` is written from the first cycle on.
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

    /// The same, which keeps frames of buses: in the bags of the flight recorder, and in those whose [`Subject`] has them.
    pub fn with_buses(self, buses: Vec<BusFrames>) -> Self {
        Self { buses, ..self }
    }

    /// The same, which writes what the node publishes into bags whose [`Subject`] has its topics.
    pub fn with_published(self, published: Option<Published>) -> Self {
        Self { published, ..self }
    }

    /// Works until `stop` is set, then takes what is left and ends all bags. True when nothing failed.
    pub fn run(mut self, stop: &AtomicBool) -> bool {
        while !stop.load(Ordering::Relaxed) {
            if !self.look() {
                std::thread::sleep(PERIOD);
            }
        }
        while self.look() {}
        self.end()
    }

    /// Takes what there is; true when there is more.
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
        self.tell_missing();
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
            frames.take(head.cycle, |offset_ns, frame, is_sent| {
                let way = if is_sent { Way::Sent } else { Way::Received };
                self.taken.extras.frames.push(BusFrame { bus, way, offset_ns, frame: *frame });
            });
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
        // A fault in a cycle that was left out is one all the same.
        let is_fault = self.taken.left_out.iter().chain(&self.taken.extras.events).any(is_fault);
        if let Some((flight, _)) = &mut self.flight
            && flight.push(&head, &mut self.taken, is_fault)
            // While a bag is being saved the next one waits: what it is about stays in memory.
            && self.saving.is_none()
        {
            let kept = flight.freeze();
            self.save(kept, None);
        }
        if let Some(state) = head.state.take() {
            self.frames.give_back(state);
        }
    }

    /// Nobody wants the cycles.
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

    /// One event for the cycles that are missing, at most one a second.
    fn tell_missing(&mut self) {
        if self.missing == 0 || self.told.is_some_and(|told| told.elapsed() < SECOND) {
            return;
        }
        let missing = std::mem::take(&mut self.missing);
        self.told = Some(Instant::now());
        self.note(Code::RECORD_LOST, i64::try_from(missing).unwrap_or(i64::MAX));
    }

    fn note(&self, code: Code, number: i64) {
        // With a full lane the log has it.
        if self.handle.submit_as(Source::Machine, Action::Note { code, number }).is_err() {
            tracing::error!("recorder: code {} ({number}) cannot be told as an event: no cycle takes it", code.0);
        }
    }

    /// A bag that waits for a cycle which does not come.
    fn give_up_waiting(&mut self) {
        if !self.handle.takes_commands()
            && let Some((_, answer)) = self.waiting.take()
        {
            let _ = answer.send(self.refused(Busy::Unconfigured.to_string()));
        }
    }

    /// Begins a bag with the next cycle that one may begin with.
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

    /// A bag that ended by itself has failed.
    fn notice_failure(&mut self) {
        if let Some(writer) = self.writer.take_if(|writer| writer.is_over()) {
            let ended = end(writer);
            self.settle(ended);
        }
    }

    /// Takes note of how a bag ended.
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

    /// Takes the writer, with all that is known of its bag.
    fn take_writer(&mut self) -> Option<Writer> {
        let mut writer = self.writer.take()?;
        // Cycles that were left out after the last one that came have left no gap yet.
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
    fn save(&mut self, kept: Kept, answer: Option<Answer>) {
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
            // Whoever asked may have gone.
            let _ = answer.map(|answer| answer.send(response));
            ended
        }));
    }

    /// Ends everything; waits for the disk.
    fn end(mut self) -> bool {
        // A bag that is being saved may not hold the last fault.
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
        // A thread that panicked has said so.
        let threads = self.ending.into_iter().chain(self.saving).flat_map(JoinHandle::join);
        ended.chain(threads).fold(!self.has_failed, |is_good, ended| is_good && ended.failed.is_none())
    }
}

fn is_fault(event: &Event) -> bool {
    event.severity == Severity::Error && event.kind == Kind::Error
}

/// Ends a bag.
fn end(writer: Writer) -> Ended {
    let path = writer.path.clone();
    match writer.finish() {
        Ok(summary) => ended(Ok(summary), "recorded", Code::RECORD_FAILED, &path),
        Err(Failure::Broken(error)) => ended(Err(error), "recorded", Code::RECORD_FAILED, &path),
        // Whoever asked for it was told why.
        Err(Failure::NotBegun(message)) => {
            Ended { response: RecordResponse { message, path, ..RecordResponse::default() }, failed: None }
        }
    }
}

/// What became of a bag, told in the log.
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
            // What was refused was never begun: nothing has failed.
            let failed = matches!(error, BagError::Write { .. }).then(|| (code, error.system_error()));
            Ended { response, failed }
        }
    }
}

#[cfg(test)]
mod tests;
