//! Sends the signals for the state topics from the cycle thread: those of each cycle that a rate selects.
//!
//! With only the newest signals ([`Snapshot`]), samples would be missing if a ROS thread is scheduled late.

use super::pool::{PoolReceiver, PoolSender, Room, pool};
use crate::recording::cadence::Cadence;
use lineshaft_core::signal::Board;
use lineshaft_ros::surface::host::Snapshot;

/// Samples that may wait for the bridge.
const ROOM: Room = Room { time_ns: 500_000_000, bytes: 16 << 20, least: 8 };

/// Rates of the state topics, in cycles.
#[derive(Clone, Debug)]
pub struct Cadences {
    /// Rate of joint_states.
    pub joint_states: Cadence,
    /// Rate of ~/axis_states.
    pub axis_states: Cadence,
    /// Rate of ~/shaft; `None`: it is off.
    pub shaft: Option<Cadence>,
}

impl Cadences {
    /// Returns the fraction of cycles that some topic selects, 0 to 1; equal rates select the same cycles.
    fn share(&self) -> f64 {
        let mut all: Vec<&Cadence> = [&self.joint_states, &self.axis_states].into_iter().chain(&self.shaft).collect();
        all.dedup();
        all.iter().map(|cadence| cadence.share()).sum::<f64>().min(1.0)
    }
}

/// Signals of a cycle, and the topics that need them.
#[derive(Clone, Debug)]
pub struct Sample {
    /// The signals.
    pub snapshot: Snapshot,
    /// Whether joint_states needs it.
    pub joint_states: bool,
    /// Whether ~/axis_states needs it.
    pub axis_states: bool,
    /// Whether ~/shaft needs it.
    pub shaft: bool,
}

/// End in the cycle thread.
#[derive(Debug)]
pub struct SampleSender {
    cadences: Cadences,
    pool: PoolSender<Sample>,
}

/// End in the bridge.
#[derive(Debug)]
pub struct SampleReceiver {
    pool: PoolReceiver<Sample>,
}

/// Creates both ends for a machine with this board.
pub fn samples(cadences: Cadences, cycle_ns: u64, board: &Board) -> (SampleSender, SampleReceiver) {
    let first = Snapshot { cycle: 0, stamp_ns: 0, board: board.clone() };
    let sample = Sample { snapshot: first, joint_states: false, axis_states: false, shaft: false };
    let per_sample = (cycle_ns as f64 / cadences.share().max(f64::EPSILON)) as u64;
    let (filler, emptier) = pool(ROOM.count(per_sample, 8 * board.len()), || sample.clone());
    (SampleSender { cadences, pool: filler }, SampleReceiver { pool: emptier })
}

impl SampleSender {
    /// Sends the cycle that has just run, if a topic needs it; returns whether it did.
    pub fn send(&mut self, cycle: u64, stamp_ns: u64, board: &Board) -> bool {
        let joint_states = self.cadences.joint_states.is_due(cycle);
        let axis_states = self.cadences.axis_states.is_due(cycle);
        let shaft = self.cadences.shaft.as_mut().is_some_and(|shaft| shaft.is_due(cycle));
        let is_taken = joint_states || axis_states || shaft;
        if !is_taken {
            return false;
        }
        self.pool.send(|sample| {
            (sample.joint_states, sample.axis_states, sample.shaft) = (joint_states, axis_states, shaft);
            (sample.snapshot.cycle, sample.snapshot.stamp_ns) = (cycle, stamp_ns);
            sample.snapshot.board.copy_from(board);
        });
        true
    }
}

impl SampleReceiver {
    /// Receives all pending samples, in order.
    pub fn take(&mut self, mut each: impl FnMut(&Sample)) {
        while let Some(sample) = self.pool.take() {
            each(&sample);
            self.pool.give_back(sample);
        }
    }

    /// Returns the number of dropped samples so far.
    pub fn lost(&self) -> u64 {
        self.pool.lost()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cell::Cell;
    use lineshaft_core::machine::Machine;

    /// Creates both ends with rates, in 1/s, of joint_states, ~/axis_states and ~/shaft.
    fn at([joint_states, axis_states]: [f64; 2], shaft: Option<f64>, board: &Board) -> (SampleSender, SampleReceiver) {
        let cadence = |rate| Cadence::new(rate, 1_000_000);
        let cadences = Cadences {
            joint_states: cadence(joint_states),
            axis_states: cadence(axis_states),
            shaft: shaft.map(cadence),
        };
        samples(cadences, 1_000_000, board)
    }

    #[test]
    fn each_topic_gets_the_cycles_of_its_rate_even_if_read_late() {
        let machine = Machine::new(Cell::demo().machine).unwrap();
        let (mut sender, mut receiver) = at([100.0, 50.0], None, machine.board());
        let mut seen = Vec::new();
        for cycle in 0..300_u64 {
            sender.send(cycle, 7 * cycle, machine.board());
            // The receiver runs at intervals, up to 120 ms late.
            if cycle % 120 == 119 || cycle == 299 {
                receiver.take(|sample| {
                    assert_eq!(sample.snapshot.stamp_ns, 7 * sample.snapshot.cycle);
                    seen.push((sample.snapshot.cycle, sample.joint_states, sample.axis_states));
                });
            }
        }
        let wanted: Vec<_> = (0..30).map(|n| (10 * n, true, n % 2 == 0)).collect();
        assert_eq!((seen, receiver.lost()), (wanted, 0));
    }

    /// 25 per second: every 40th cycle, even if no other topic selects it; without a rate none.
    #[test]
    fn the_shaft_has_cycles_of_its_own() {
        let machine = Machine::new(Cell::demo().machine).unwrap();
        let seen = |shaft| {
            let (mut sender, mut receiver) = at([1.0, 1.0], shaft, machine.board());
            (0..100).for_each(|cycle| {
                sender.send(cycle, 0, machine.board());
            });
            let mut seen = Vec::new();
            receiver.take(|sample| seen.push((sample.snapshot.cycle, sample.axis_states, sample.shaft)));
            seen
        };
        assert_eq!(seen(Some(25.0)), [(0, true, true), (40, false, true), (80, false, true)]);
        assert_eq!(seen(None), [(0, true, false)]);
    }

    #[test]
    fn unread_samples_are_counted_and_the_first_ones_kept() {
        let machine = Machine::new(Cell::demo().machine).unwrap();
        let (mut sender, mut receiver) = at([1000.0, 1.0], None, machine.board());
        (0..507).for_each(|cycle| {
            sender.send(cycle, 0, machine.board());
        });
        let mut seen = Vec::new();
        receiver.take(|sample| seen.push(sample.snapshot.cycle));
        assert_eq!((seen, receiver.lost()), ((0..500).collect(), 7));
        sender.send(600, 0, machine.board());
        receiver.take(|sample| assert_eq!(sample.snapshot.cycle, 600));
    }
}
