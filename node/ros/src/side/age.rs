//! Which samples were meant for another life of the node.
//!
//! The DDS library asks each writer for all that it still has, and Cyclone DDS still has what it sent to a reader that is dead and
//! whose lease is not over: a node that starts again would do once more what the one before it was told.
//! Likewise a program that was cut off, and asked for something meanwhile.
//!
//! Law      of a writer on this host, which has its clock: stale is what was written before the reader was there. Of another
//!          host, whose clock may be any: within [`MOMENT`] of the match, and while a dead node's lease may last, stale is what
//!          does not seem to be written just now. What is later than that moment cannot be old: the writer gives at once all
//!          that it has
//! Source   issue "an axis moves that nobody moved"; a good-bye for the dead (`dispose`) comes before all this

use std::time::Duration;

/// A writer gives all that it has within this time of its match.
const MOMENT: Duration = Duration::from_secs(1);
/// A dead participant of the library is kept by others for its lease (50 s), and a little.
const LEASE: Duration = Duration::from_secs(60);
/// Two clocks of a network that is in order differ by less, with the way of a sample.
const APART: Duration = Duration::from_secs(2);

/// What is known of a sample.
#[derive(Clone, Copy, Debug)]
pub(super) struct Known {
    /// By its writer's clock, ticks of 2^-32 s; `None`: not told.
    pub(super) written: Option<u64>,
    /// Likewise, by this host's clock.
    pub(super) now: u64,
    /// Since the reader was made, or the writer's participant spoke again that was lost meanwhile.
    pub(super) reader: Duration,
    /// Since the writer was matched.
    pub(super) matched: Duration,
    /// The writer is on this host.
    pub(super) is_local: bool,
}

/// Was it meant for another life?
pub(super) fn is_stale(sample: Known) -> bool {
    let Known { written, now, reader, matched, is_local } = sample;
    // Of one without a time nothing can be said; no RMW leaves it out.
    let Some(written) = written else { return false };
    if is_local {
        // A clock that was set back makes a sample seem younger than it is: not younger than now.
        return longer(now.saturating_sub(written), reader);
    }
    matched < MOMENT && reader < LEASE && longer(now.abs_diff(written), APART.min(reader))
}

/// Is an age in ticks above a time?
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
        assert!(is_stale(far(115, 110)), "its clock is ahead, and nothing tells how old it is");
        assert!(!is_stale(far(108, 110)));
        assert!(!is_stale(far(110, 110)));
        // The writer has given what it had.
        assert!(!is_stale(Known { matched: MOMENT, ..far(99, 110) }));
        // No node from before is in anybody's memory.
        assert!(!is_stale(Known { reader: LEASE, ..far(9, 110) }));
        // A reader of half a second: a second is before it.
        assert!(is_stale(Known { reader: Duration::from_millis(500), ..far(109, 110) }));
    }
}
