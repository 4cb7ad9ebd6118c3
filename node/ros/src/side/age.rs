//! Detects stale samples, which were meant for an earlier run of the node.
//!
//! The DDS library requests from each writer all samples that it still has. Cyclone DDS still has the samples that it sent to a dead reader
//! until the lease of that reader expires. So a restarted node would execute the commands to the previous node once more. The same holds
//! for a client that was disconnected, and sent a request meanwhile.
//!
//! Law      writer on this host, with the same clock: a sample is stale if it was written before the reader existed. Writer on another
//!          host, whose clock may differ: a sample is stale if its timestamp is not recent. This check applies only within [`MOMENT`] of
//!          the match, and while the lease of a dead node may last. A later sample cannot be old, because the writer sends all its old
//!          samples at once
//! Source   issue "an axis moves that nobody moved"; before this check, dead participants are disposed (`dispose`)

use std::time::Duration;

/// A writer sends all its old samples within this time after its match.
const MOMENT: Duration = Duration::from_secs(1);
/// Other participants keep a dead participant of the library for its lease (50 s); with a margin.
const LEASE: Duration = Duration::from_secs(60);
/// Maximum difference of two clocks in a network without faults, including the transmission time of a sample.
const APART: Duration = Duration::from_secs(2);

/// Age data of a sample.
#[derive(Clone, Copy, Debug)]
pub(super) struct Known {
    /// Source timestamp by the writer's clock, in ticks of 2^-32 s; `None` if it is missing.
    pub(super) written: Option<u64>,
    /// Time of this host's clock, in ticks of 2^-32 s.
    pub(super) now: u64,
    /// Time since the reader was created, or since the first announcement of the writer's participant after a loss.
    pub(super) reader: Duration,
    /// Time since the writer was matched.
    pub(super) matched: Duration,
    /// Whether the writer is on this host.
    pub(super) is_local: bool,
}

/// Whether the sample was meant for an earlier run of the node.
pub(super) fn is_stale(sample: Known) -> bool {
    let Known { written, now, reader, matched, is_local } = sample;
    // The age of a sample without a timestamp is unknown; every RMW sends the timestamp.
    let Some(written) = written else { return false };
    if is_local {
        // After the clock was set back, a sample seems newer than it is. Its age is at least 0.
        return longer(now.saturating_sub(written), reader);
    }
    matched < MOMENT && reader < LEASE && longer(now.abs_diff(written), APART.min(reader))
}

/// Whether an age in ticks exceeds a time.
fn longer(age: u64, time: Duration) -> bool {
    u128::from(age) * 1_000_000_000 > time.as_nanos() << 32
}

#[cfg(test)]
mod tests {
    use super::*;

    const fn seconds(seconds: u64) -> u64 {
        seconds << 32
    }

    fn known(written: u64, now: u64) -> Known {
        let time = Duration::from_secs(10);
        Known {
            written: Some(seconds(written)),
            now: seconds(now),
            reader: time,
            matched: Duration::ZERO,
            is_local: true,
        }
    }

    #[test]
    fn on_this_host_what_was_written_before_the_reader_was_there_is_stale() {
        assert!(is_stale(known(99, 110)));
        assert!(is_stale(Known { matched: Duration::from_secs(9), ..known(99, 110) }), "at any time");
        assert!(!is_stale(known(100, 110)));
        assert!(!is_stale(known(109, 110)));
        assert!(!is_stale(known(115, 110)), "the clock was set back");
        assert!(!is_stale(Known { written: None, ..known(0, 110) }));
    }

    #[test]
    fn of_another_host_what_comes_with_the_match_has_to_be_new() {
        let far = |written, now| Known { is_local: false, ..known(written, now) };
        assert!(is_stale(far(99, 110)));
        assert!(is_stale(far(107, 110)), "older than clocks differ");
        assert!(is_stale(far(115, 110)), "its clock is ahead, and nothing shows how old it is");
        assert!(!is_stale(far(108, 110)));
        assert!(!is_stale(far(110, 110)));
        // The writer has already sent all its old samples.
        assert!(!is_stale(Known { matched: MOMENT, ..far(99, 110) }));
        // No participant stores samples for an earlier node any more.
        assert!(!is_stale(Known { reader: LEASE, ..far(9, 110) }));
        // The reader is half a second old, and the sample one second.
        assert!(is_stale(Known { reader: Duration::from_millis(500), ..far(109, 110) }));
    }
}
