//! Mode of operation by SDO, for a drive that cannot map 6060h or 6061h to a PDO.
//!
//! Law      6060h is written when another mode is commanded. Then 6061h is read until it reports that mode, one request at a time. A mode
//!          is valid once it was read after the last write and two status words have followed: mode and status word then belong to the same
//!          state of the drive. An answer that may belong to an earlier, timed-out read is not used
//! Reads    answers of SDO requests, and whether status words were received
//! Writes   SDO requests
//! Refuses  a mode that the drive refuses: it is not written again before another one is commanded, the drive is enabled, or it is started
//! Source   CiA 402-2 (6060h and 6061h: PDO mapping is optional), CiA 301 (SDO)

use crate::mapping::ModeBySdo;
use crate::object::Object;
use crate::objects;
use crate::sdo::{SdoError, SdoRequest, Transfer};

/// Buffer size for an answer, in bytes.
const ROOM: usize = 16;
/// Time from an answer with another mode to the next request, in ns. It leaves time for other SDO requests.
const POLL_NS: u64 = 10_000_000;
/// Number of status words between the read of a mode and its use: the first one may be older than the answer.
const STATUS_WORDS: u8 = 2;
/// Maximum number of late answers that are expected.
const MOST_OWED: u8 = 8;

/// Pending request.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Stage {
    /// There is no request.
    #[default]
    Idle,
    /// Write of 6060h with this mode.
    Writes(i8),
    /// Read of 6061h.
    Reads,
}

/// Exchange of the mode by SDO. Modes are numbers of 6060h of the drive.
#[derive(Clone, Debug)]
pub struct ModeExchange {
    by_sdo: ModeBySdo,
    /// Commanded mode; 0: none.
    commanded: i8,
    /// Mode of the last write that the drive has confirmed.
    written: Option<i8>,
    /// Present mode of the drive.
    known: Option<i8>,
    /// Mode that was read, and the number of status words that must follow before it is valid.
    heard: Option<(i8, u8)>,
    /// Mode that the drive has refused.
    refused: Option<i8>,
    stage: Stage,
    /// Whether the answer to the pending request may still be used.
    counts: bool,
    /// Number of outstanding answers for 6061h, of requests that have timed out.
    owed: u8,
    /// Whether the last request was not answered.
    is_silent: bool,
    /// Time of the next request, in ns.
    due_ns: u64,
    /// Data buffer. It is passed along with each request and returned with its answer.
    room: Option<Vec<u8>>,
}

impl ModeExchange {
    /// Creates an exchange without a commanded or known mode.
    pub fn new(by_sdo: ModeBySdo) -> Self {
        Self {
            by_sdo,
            commanded: 0,
            written: None,
            known: None,
            heard: None,
            refused: None,
            stage: Stage::Idle,
            counts: false,
            owed: 0,
            is_silent: false,
            due_ns: 0,
            room: Some(Vec::with_capacity(ROOM)),
        }
    }

    /// Returns the objects that are exchanged by SDO.
    pub fn by_sdo(&self) -> ModeBySdo {
        self.by_sdo
    }

    /// Returns true if an object of the mode is exchanged by SDO.
    pub fn is_used(&self) -> bool {
        self.by_sdo.writes || self.by_sdo.reads
    }

    /// Returns the mode that was read by SDO; `None` while it is unknown, and if a PDO reports it.
    pub fn known(&self) -> Option<i8> {
        self.known
    }

    /// Clears all that was written and read, because the drive is started.
    pub fn reset(&mut self) {
        (self.written, self.known, self.heard, self.refused) = (None, None, None, None);
        (self.counts, self.is_silent, self.due_ns) = (false, false, 0);
    }

    /// Commands a mode; 0: none.
    pub fn command(&mut self, mode: i8) {
        if mode == self.commanded {
            return;
        }
        (self.commanded, self.refused, self.due_ns) = (mode, None, 0);
        // A PDO changes the mode at once.
        if !self.by_sdo.writes {
            self.invalidate();
        }
    }

    /// Has the mode written and read again: another client may have changed it, and the drive may accept a mode after enabling that it
    /// refused before.
    pub fn invalidate(&mut self) {
        (self.written, self.known, self.heard, self.refused, self.due_ns) = (None, None, None, None, 0);
        if self.stage == Stage::Reads {
            self.counts = false;
        }
    }

    /// Returns true if the drive is in the commanded mode. `shown`: mode that the PDO reports, if 6061h is mapped.
    pub fn is_settled(&self, shown: i8) -> bool {
        let is_written = !self.by_sdo.writes || self.written == Some(self.commanded);
        let mode = if self.by_sdo.reads { self.known } else { Some(shown) };
        is_written && mode == Some(self.commanded)
    }

    /// Returns true if the drive has refused the commanded mode.
    pub fn is_refused(&self) -> bool {
        self.refused == Some(self.commanded)
    }

    /// Returns the next request, if one is due. The mode is unknown from a write on.
    pub fn next_request(&mut self, now_ns: u64) -> Option<SdoRequest> {
        let is_due = self.stage == Stage::Idle && self.commanded != 0 && now_ns >= self.due_ns && !self.is_refused();
        let writes = self.by_sdo.writes && self.written != Some(self.commanded);
        let reads = self.by_sdo.reads && self.known != Some(self.commanded) && self.heard.is_none();
        if !is_due || !(writes || reads) {
            return None;
        }
        let mut data = self.room.take()?;
        data.clear();
        self.counts = true;
        let object = if writes {
            data.push(self.commanded.cast_unsigned());
            (self.written, self.known, self.heard) = (None, None, None);
            self.stage = Stage::Writes(self.commanded);
            objects::MODE
        } else {
            self.stage = Stage::Reads;
            objects::MODE_DISPLAY
        };
        Some(SdoRequest { object, data, writes })
    }

    /// Returns the data of a request that could not be sent; it is repeated.
    pub fn return_buffer(&mut self, data: Vec<u8>) {
        (self.room, self.stage) = (Some(data), Stage::Idle);
    }

    /// Returns true if an answer for this object belongs to the pending request.
    pub fn is_pending(&self, object: Object) -> bool {
        match self.stage {
            Stage::Idle => false,
            Stage::Writes(_) => object == objects::MODE,
            Stage::Reads => object == objects::MODE_DISPLAY,
        }
    }

    /// Handles the answer to the pending request. Returns an error that is to be reported: each refusal, and the first of several requests
    /// without an answer.
    pub fn handle_answer(&mut self, done: Transfer, now_ns: u64) -> Option<SdoError> {
        let Transfer { object, data, result } = done;
        let (stage, counts) = (std::mem::take(&mut self.stage), self.counts);
        let first = data.first().copied();
        self.room = Some(data);
        let Err(error) = result else {
            self.is_silent = false;
            match (stage, first) {
                (Stage::Writes(mode), _) if counts => (self.written, self.due_ns) = (Some(mode), now_ns),
                (Stage::Reads, Some(mode)) => self.store_read_mode(mode.cast_signed(), counts, now_ns),
                _ => {}
            }
            return None;
        };
        self.due_ns = now_ns.saturating_add(POLL_NS);
        self.record_failure(object, &error);
        let is_refused = matches!(error, SdoError::Refused(..));
        if is_refused && counts {
            self.refused = match stage {
                Stage::Writes(mode) => Some(mode),
                Stage::Idle | Stage::Reads => Some(self.commanded),
            };
        }
        let was_silent = std::mem::replace(&mut self.is_silent, !is_refused);
        (is_refused || !was_silent).then_some(error)
    }

    /// Stores a mode that was read.
    fn store_read_mode(&mut self, mode: i8, counts: bool, now_ns: u64) {
        self.due_ns = now_ns.saturating_add(POLL_NS);
        if let Some(owed) = self.owed.checked_sub(1) {
            // The answer may belong to an earlier request.
            self.owed = owed;
        } else if counts {
            self.heard = Some((mode, STATUS_WORDS));
        }
    }

    /// Records the failure of any request to the drive: the answer to one that has timed out may still arrive.
    pub fn record_failure(&mut self, object: Object, error: &SdoError) {
        if object == objects::MODE_DISPLAY && matches!(error, SdoError::Silent(..)) {
            self.owed = self.owed.saturating_add(1).min(MOST_OWED);
        }
    }

    /// Records a received status word. Returns the mode that is valid from now on, if any.
    pub fn record_status_word(&mut self) -> Option<i8> {
        let (mode, left) = self.heard?;
        let left = left.saturating_sub(1);
        self.heard = (left > 0).then_some((mode, left));
        if left > 0 {
            return None;
        }
        self.known = Some(mode);
        self.known
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sdo::Abort;

    const BOTH: ModeBySdo = ModeBySdo { writes: true, reads: true };

    /// Returns the request that is due.
    fn request(exchange: &mut ModeExchange, now_ns: u64) -> (Object, Vec<u8>) {
        let SdoRequest { object, data, writes } = exchange.next_request(now_ns).expect("a request is due");
        assert_eq!(writes, object == objects::MODE);
        assert!(exchange.is_pending(object) && exchange.next_request(now_ns).is_none(), "one at a time");
        (object, data)
    }

    /// Answers the request that is due.
    fn answer(exchange: &mut ModeExchange, now_ns: u64, read: i8) -> Object {
        let (object, mut data) = request(exchange, now_ns);
        if object == objects::MODE_DISPLAY {
            data.push(read.cast_unsigned());
        }
        assert_eq!(exchange.handle_answer(Transfer { object, data, result: Ok(()) }, now_ns), None);
        object
    }

    fn fail(exchange: &mut ModeExchange, now_ns: u64, error: fn(Object) -> SdoError) -> Option<SdoError> {
        let (object, data) = request(exchange, now_ns);
        exchange.handle_answer(Transfer { object, data, result: Err(error(object)) }, now_ns)
    }

    fn silent(object: Object) -> SdoError {
        SdoError::Silent(object, 500)
    }

    fn refused(object: Object) -> SdoError {
        SdoError::Refused(object, Abort(0x0609_0030))
    }

    /// 6060h is written with 8, then 6061h is read every 10 ms until it is 8.
    #[test]
    fn mode_is_valid_after_read_and_two_status_words() {
        let mut exchange = ModeExchange::new(BOTH);
        assert_eq!(exchange.next_request(0), None, "no mode is commanded");
        exchange.command(8);
        let (object, data) = request(&mut exchange, 0);
        assert_eq!((object, data.as_slice()), (objects::MODE, [8].as_slice()));
        assert_eq!(exchange.handle_answer(Transfer { object, data, result: Ok(()) }, 0), None);
        assert_eq!(answer(&mut exchange, 0, 3), objects::MODE_DISPLAY);
        assert_eq!([exchange.record_status_word(), exchange.record_status_word()], [None, Some(3)]);
        assert!(!exchange.is_settled(8));
        assert_eq!(exchange.next_request(POLL_NS - 1), None, "others have their turn");
        assert_eq!(answer(&mut exchange, POLL_NS, 8), objects::MODE_DISPLAY);
        assert_eq!((exchange.known(), exchange.is_settled(8)), (Some(3), false));
        assert_eq!([exchange.record_status_word(), exchange.record_status_word()], [None, Some(8)]);
        assert!(exchange.is_settled(0));
        assert_eq!(exchange.next_request(u64::MAX), None);
    }

    /// From 8 to 6 and back before 6 is confirmed: the 8 that was read before is no longer valid.
    #[test]
    fn mode_read_before_write_is_invalid() {
        let mut exchange = ModeExchange::new(BOTH);
        exchange.command(8);
        for _ in 0..2 {
            answer(&mut exchange, 0, 8);
        }
        assert_eq!((0..2).find_map(|_| exchange.record_status_word()), Some(8));
        assert!(exchange.is_settled(0));
        exchange.command(6);
        let (object, data) = request(&mut exchange, 0);
        exchange.command(8);
        assert_eq!((exchange.known(), exchange.is_settled(8)), (None, false));
        exchange.handle_answer(Transfer { object, data, result: Ok(()) }, 0);
        assert!(!exchange.is_settled(8));
        assert_eq!(request(&mut exchange, 0), (objects::MODE, vec![8]), "6 was written last");
    }

    /// A read has timed out while the drive was in mode 8. Its answer arrives as that of the next read.
    #[test]
    fn late_answer_of_an_earlier_read_is_not_used() {
        let mut exchange = ModeExchange::new(BOTH);
        exchange.command(8);
        answer(&mut exchange, 0, 8);
        assert_eq!(fail(&mut exchange, 0, silent), Some(silent(objects::MODE_DISPLAY)));
        assert_eq!(fail(&mut exchange, POLL_NS, silent), None, "reported once");
        // Requests of another client to the same drive.
        exchange.record_failure(objects::MODE_DISPLAY, &silent(objects::MODE_DISPLAY));
        exchange.record_failure(objects::POSITION, &silent(objects::POSITION));
        for at in 2..5 {
            answer(&mut exchange, at * POLL_NS, 8);
            assert_eq!((0..4).find_map(|_| exchange.record_status_word()), None, "read {at}");
        }
        answer(&mut exchange, 5 * POLL_NS, 8);
        assert_eq!((0..2).find_map(|_| exchange.record_status_word()), Some(8));
    }

    /// A PDO or another client may have changed the mode during a pending read, so its result is not used.
    #[test]
    fn pending_read_is_ignored_after_invalidation() {
        let mut exchange = ModeExchange::new(ModeBySdo { writes: false, reads: true });
        exchange.command(8);
        let (object, mut data) = request(&mut exchange, 0);
        exchange.command(6);
        exchange.command(8);
        data.push(8);
        exchange.handle_answer(Transfer { object, data, result: Ok(()) }, 0);
        assert_eq!((0..4).find_map(|_| exchange.record_status_word()), None);
        answer(&mut exchange, POLL_NS, 8);
        assert_eq!((0..2).find_map(|_| exchange.record_status_word()), Some(8));
        assert!(exchange.is_settled(0));
        exchange.invalidate();
        assert!(!exchange.is_settled(8));
        assert_eq!(answer(&mut exchange, POLL_NS, 8), objects::MODE_DISPLAY, "at once");
    }

    #[test]
    fn refused_mode_is_reported_and_not_written_again_until_another_one_is_commanded() {
        let mut exchange = ModeExchange::new(BOTH);
        exchange.command(6);
        assert_eq!(fail(&mut exchange, 0, refused), Some(refused(objects::MODE)));
        assert!(exchange.is_refused() && exchange.next_request(u64::MAX).is_none());
        exchange.command(8);
        assert_eq!(request(&mut exchange, POLL_NS).1, [8]);
        let mut exchange = ModeExchange::new(BOTH);
        exchange.command(6);
        fail(&mut exchange, 0, refused);
        exchange.reset();
        assert_eq!(request(&mut exchange, 0).1, [6]);
    }

    /// 6061h is in a PDO: only the write uses SDO.
    #[test]
    fn mapped_mode_display_is_not_read_by_sdo() {
        let mut exchange = ModeExchange::new(ModeBySdo { writes: true, reads: false });
        exchange.command(9);
        assert!(!exchange.is_settled(9), "not written yet");
        assert_eq!(answer(&mut exchange, 0, 0), objects::MODE);
        assert_eq!(exchange.next_request(u64::MAX), None);
        assert_eq!([exchange.is_settled(9), exchange.is_settled(6)], [true, false]);
    }
}
