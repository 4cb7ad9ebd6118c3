//! Frames of a bus, as recordings receive them.

/// Kind of the frames of a bus, which defines their bytes: the link type of capture files (pcap, LINKTYPE_ numbers).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FrameKind(pub u16);

/// A recorded frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RecordedFrame<'a> {
    /// Whether this program has sent it.
    pub is_sent: bool,
    /// Time after the beginning of its cycle, in ns; negative before it.
    pub offset_ns: i64,
    /// Its bytes, as its kind defines them.
    pub bytes: &'a [u8],
}

/// Receiving end of the recorded frames of a bus, for the thread that records.
pub trait FrameSource: Send {
    /// Returns the kind of the frames, which is the same for all.
    fn kind(&self) -> FrameKind;

    /// Passes the frames up to the end of this cycle that were not fetched before to `keep`. If the beginning of the
    /// cycle is unknown, because there was no room to record it, their times are 0.
    fn take(&mut self, cycle: u64, keep: &mut dyn FnMut(RecordedFrame<'_>));
}
