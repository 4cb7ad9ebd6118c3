//! Mode of operation of a drive that maps 6060h or 6061h to no PDO: written and read by SDO.
//!
//! Law      6060h is written when another mode is commanded; then 6061h is read until it shows that mode, one request at a time. A mode is
//!          known once it was read after the last write and two status words have followed: both are of one state of the drive then.
//!          An answer that may be the late one of an earlier read is not used
//! Reads    answers of SDO requests, and that status words have come
//! Writes   SDO requests
//! Refuses  a mode that the drive refuses: it is not written again before another one is commanded, the drive is enabled, or it is started
//! Source   CiA 402-2 (6060h and 6061h: PDO mapping is optional), CiA 301 (SDO)

use super::layout::ModeBySdo;
use super::objects;
use crate::sdo::{Object, SdoError, Transfer};

/// Bytes that an answer has room for.
const ROOM: usize = 16;
/// From an answer that does not show the mode to the next request (ns): other SDO requests have their turn meanwhile.
const POLL_NS: u64 = 10_000_000;
/// Status words between a mode that was read and its use: the first one may be older than the answer.
const STATUS_WORDS: u8 = 2;
/// Late answers that are expected at most.
const MOST_OWED: u8 = 8;

/// The request under way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Stage {
    /// None.
    #[default]
    Idle,
    /// 6060h is written with this mode.
    Writes(i8),
    /// 6061h is read.
    Reads,
}

/// An SDO request.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ModeRequest {
    /// 6060h or 6061h.
    pub object: Object,
    /// The bytes to be written, or room for those that are read.
    pub data: Vec<u8>,
    /// Whether it writes.
    pub writes: bool,
}

/// The exchange of the mode by SDO. Modes are numbers of 6060h of the drive.
#[derive(Clone, Debug)]
pub struct ModeExchange {
    by_sdo: ModeBySdo,
    /// The commanded mode; 0: none.
    commanded: i8,
    /// The mode that the drive has confirmed as written last.
    written: Option<i8>,
    /// The mode that the drive is in.
    known: Option<i8>,
    /// A mode that was read, and the status words that have to follow before it is known.
    heard: Option<(i8, u8)>,
    /// The mode that the drive has refused.
    refused: Option<i8>,
    stage: Stage,
    /// Whether the answer of the request under way is still of use.
    counts: bool,
    /// Answers of 6061h that may still come, of requests that have timed out.
    owed: u8,
    /// The last request was not answered.
    is_silent: bool,
    /// When the next request may go (ns).
    due_ns: u64,
    /// Goes with each request and comes back with its answer.
    room: Option<Vec<u8>>,
}

impl ModeExchange {
    /// Nothing is commanded or known.
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

    /// The objects that go by SDO.
    pub fn by_sdo(&self) -> ModeBySdo {
        self.by_sdo
    }

    /// Whether an object of the mode goes by SDO.
    pub fn is_used(&self) -> bool {
        self.by_sdo.writes || self.by_sdo.reads
    }

    /// The mode that was read by SDO; none while it is not known, and where a PDO reports it.
    pub fn known(&self) -> Option<i8> {
        self.known
    }

    /// Forgets all that was written and read: the drive is started.
    pub fn begin_anew(&mut self) {
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
            self.distrust();
        }
    }

    /// Has the mode written and read again: another client may have changed it, and what the drive has refused without power it may take now.
    pub fn distrust(&mut self) {
        (self.written, self.known, self.heard, self.refused, self.due_ns) = (None, None, None, None, 0);
        if self.stage == Stage::Reads {
            self.counts = false;
        }
    }

    /// Whether the drive is in the commanded mode; `shown`: the one that its PDO reports, if 6061h is mapped.
    pub fn is_settled(&self, shown: i8) -> bool {
        let is_written = !self.by_sdo.writes || self.written == Some(self.commanded);
        let mode = if self.by_sdo.reads { self.known } else { Some(shown) };
        is_written && mode == Some(self.commanded)
    }

    /// Whether the drive has refused the commanded mode.
    pub fn is_refused(&self) -> bool {
        self.refused == Some(self.commanded)
    }

    /// The next request, if one is due. From a write on the mode is not known.
    pub fn next_request(&mut self, now_ns: u64) -> Option<ModeRequest> {
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
        Some(ModeRequest { object, data, writes })
    }

    /// The request could not be sent; it is made again.
    pub fn give_back(&mut self, data: Vec<u8>) {
        (self.room, self.stage) = (Some(data), Stage::Idle);
    }

    /// Whether an answer of this object is that of its own request.
    pub fn awaits(&self, object: Object) -> bool {
        match self.stage {
            Stage::Idle => false,
            Stage::Writes(_) => object == objects::MODE,
            Stage::Reads => object == objects::MODE_DISPLAY,
        }
    }

    /// Takes the answer of its own request. Returns an error that is to be reported: each refusal, and the first of several requests without an
    /// answer.
    pub fn take(&mut self, done: Transfer, now_ns: u64) -> Option<SdoError> {
        let Transfer { object, data, result } = done;
        let (stage, counts) = (std::mem::take(&mut self.stage), self.counts);
        let first = data.first().copied();
        self.room = Some(data);
        let Err(error) = result else {
            self.is_silent = false;
            match (stage, first) {
                (Stage::Writes(mode), _) if counts => (self.written, self.due_ns) = (Some(mode), now_ns),
                (Stage::Reads, Some(mode)) => self.hear(mode.cast_signed(), counts, now_ns),
                _ => {}
            }
            return None;
        };
        self.due_ns = now_ns.saturating_add(POLL_NS);
        self.note_failed(object, &error);
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

    /// A mode was read.
    fn hear(&mut self, mode: i8, counts: bool, now_ns: u64) {
        self.due_ns = now_ns.saturating_add(POLL_NS);
        if let Some(owed) = self.owed.checked_sub(1) {
            // It may be that of an earlier request.
            self.owed = owed;
        } else if counts {
            self.heard = Some((mode, STATUS_WORDS));
        }
    }

    /// Notes the failure of any request to the drive: the answer of one that has timed out may still come.
    pub fn note_failed(&mut self, object: Object, error: &SdoError) {
        if object == objects::MODE_DISPLAY && matches!(error, SdoError::Silent(..)) {
            self.owed = self.owed.saturating_add(1).min(MOST_OWED);
        }
    }

    /// A status word has come. Returns the mode that is known from now on.
    pub fn hear_status(&mut self) -> Option<i8> {
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

    /// The request that is due.
    fn request(exchange: &mut ModeExchange, now_ns: u64) -> (Object, Vec<u8>) {
        let ModeRequest { object, data, writes } = exchange.next_request(now_ns).expect("a request is due");
        assert_eq!(writes, object == objects::MODE);
        assert!(exchange.awaits(object) && exchange.next_request(now_ns).is_none(), "one at a time");
        (object, data)
    }

    /// Answers the request that is due.
    fn answer(exchange: &mut ModeExchange, now_ns: u64, read: i8) -> Object {
        let (object, mut data) = request(exchange, now_ns);
        if object == objects::MODE_DISPLAY {
            data.push(read.cast_unsigned());
        }
        assert_eq!(exchange.take(Transfer { object, data, result: Ok(()) }, now_ns), None);
        object
    }

    fn fail(exchange: &mut ModeExchange, now_ns: u64, error: fn(Object) -> SdoError) -> Option<SdoError> {
        let (object, data) = request(exchange, now_ns);
        exchange.take(Transfer { object, data, result: Err(error(object)) }, now_ns)
    }

    fn silent(object: Object) -> SdoError {
        SdoError::Silent(object, 500)
    }

    fn refused(object: Object) -> SdoError {
        SdoError::Refused(object, Abort(0x0609_0030))
    }

    /// 6060h is written with 8, then 6061h is read until it is 8; a read every 10 ms.
    #[test]
    fn mode_is_known_once_it_was_read_and_two_status_words_have_come() {
        let mut exchange = ModeExchange::new(BOTH);
        assert_eq!(exchange.next_request(0), None, "no mode is commanded");
        exchange.command(8);
        let (object, data) = request(&mut exchange, 0);
        assert_eq!((object, data.as_slice()), (objects::MODE, [8].as_slice()));
        assert_eq!(exchange.take(Transfer { object, data, result: Ok(()) }, 0), None);
        assert_eq!(answer(&mut exchange, 0, 3), objects::MODE_DISPLAY);
        assert_eq!([exchange.hear_status(), exchange.hear_status()], [None, Some(3)]);
        assert!(!exchange.is_settled(8));
        assert_eq!(exchange.next_request(POLL_NS - 1), None, "others have their turn");
        assert_eq!(answer(&mut exchange, POLL_NS, 8), objects::MODE_DISPLAY);
        assert_eq!((exchange.known(), exchange.is_settled(8)), (Some(3), false));
        assert_eq!([exchange.hear_status(), exchange.hear_status()], [None, Some(8)]);
        assert!(exchange.is_settled(0));
        assert_eq!(exchange.next_request(u64::MAX), None);
    }

    /// From 8 to 6 and back before 6 is confirmed: 8 was read before, and is not known any more.
    #[test]
    fn mode_that_was_read_before_a_write_is_not_known() {
        let mut exchange = ModeExchange::new(BOTH);
        exchange.command(8);
        for _ in 0..2 {
            answer(&mut exchange, 0, 8);
        }
        assert_eq!((0..2).find_map(|_| exchange.hear_status()), Some(8));
        assert!(exchange.is_settled(0));
        exchange.command(6);
        let (object, data) = request(&mut exchange, 0);
        exchange.command(8);
        assert_eq!((exchange.known(), exchange.is_settled(8)), (None, false));
        exchange.take(Transfer { object, data, result: Ok(()) }, 0);
        assert!(!exchange.is_settled(8));
        assert_eq!(request(&mut exchange, 0), (objects::MODE, vec![8]), "6 was written last");
    }

    /// A read has timed out while the drive was in mode 8: its answer comes as that of the next one.
    #[test]
    fn late_answer_of_an_earlier_read_is_not_used() {
        let mut exchange = ModeExchange::new(BOTH);
        exchange.command(8);
        answer(&mut exchange, 0, 8);
        assert_eq!(fail(&mut exchange, 0, silent), Some(silent(objects::MODE_DISPLAY)));
        assert_eq!(fail(&mut exchange, POLL_NS, silent), None, "reported once");
        // Of somebody else, at the same drive.
        exchange.note_failed(objects::MODE_DISPLAY, &silent(objects::MODE_DISPLAY));
        exchange.note_failed(objects::POSITION, &silent(objects::POSITION));
        for at in 2..5 {
            answer(&mut exchange, at * POLL_NS, 8);
            assert_eq!((0..4).find_map(|_| exchange.hear_status()), None, "read {at}");
        }
        answer(&mut exchange, 5 * POLL_NS, 8);
        assert_eq!((0..2).find_map(|_| exchange.hear_status()), Some(8));
    }

    /// What comes of a read under way says nothing of a mode that a PDO, or another client, may have changed meanwhile.
    #[test]
    fn read_under_way_is_not_used_once_the_mode_is_distrusted() {
        let mut exchange = ModeExchange::new(ModeBySdo { writes: false, reads: true });
        exchange.command(8);
        let (object, mut data) = request(&mut exchange, 0);
        exchange.command(6);
        exchange.command(8);
        data.push(8);
        exchange.take(Transfer { object, data, result: Ok(()) }, 0);
        assert_eq!((0..4).find_map(|_| exchange.hear_status()), None);
        answer(&mut exchange, POLL_NS, 8);
        assert_eq!((0..2).find_map(|_| exchange.hear_status()), Some(8));
        assert!(exchange.is_settled(0));
        exchange.distrust();
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
        exchange.begin_anew();
        assert_eq!(request(&mut exchange, 0).1, [6]);
    }

    /// 6061h in a PDO: only the write goes by SDO.
    #[test]
    fn mode_that_a_pdo_reports_is_not_read() {
        let mut exchange = ModeExchange::new(ModeBySdo { writes: true, reads: false });
        exchange.command(9);
        assert!(!exchange.is_settled(9), "not written yet");
        assert_eq!(answer(&mut exchange, 0, 0), objects::MODE);
        assert_eq!(exchange.next_request(u64::MAX), None);
        assert_eq!([exchange.is_settled(9), exchange.is_settled(6)], [true, false]);
    }
}
