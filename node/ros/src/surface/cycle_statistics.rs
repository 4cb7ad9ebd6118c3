//! `~/cycle_statistics`: timing of the cycle, once a second.

use super::host::Statistics;
use super::hub::Hub;
use super::messages::header;
use super::table;
use crate::layer::{CreateError, Node, Publisher};
use lineshaft_msgs::msg::CycleStatistics;
use std::sync::Arc;
use std::time::Duration;
use tokio::task::JoinSet;
use tokio::time::MissedTickBehavior;

/// Time between two messages.
const PERIOD: Duration = Duration::from_secs(1);

pub(super) fn start(node: &Node, hub: &Arc<Hub>, tasks: &mut JoinSet<()>) -> Result<(), CreateError> {
    let publisher = table::CYCLE_STATISTICS.publisher(node)?;
    tasks.spawn(publish(publisher, Arc::clone(hub)));
    Ok(())
}

async fn publish(publisher: Publisher<CycleStatistics>, hub: Arc<Hub>) {
    let mut ticks = tokio::time::interval(PERIOD);
    ticks.set_missed_tick_behavior(MissedTickBehavior::Skip);
    let (mut last, mut failed) = (Statistics::default(), 0_u64);
    loop {
        ticks.tick().await;
        let (host, newest) = (&hub.host, hub.host.statistics());
        let snapshot = host.snapshot();
        let stamp_ns = hub.clock.stamp(snapshot.stamp_ns);
        let message = message(&last, &newest, snapshot.cycle, stamp_ns, host.config().cycle_ns);
        last = newest;
        if let Err(error) = publisher.publish(&message) {
            failed += 1;
            if failed.is_power_of_two() {
                tracing::warn!("{error} ({failed} so far)");
            }
        }
    }
}

/// Returns the message for the time from `last` to `newest`.
fn message(last: &Statistics, newest: &Statistics, cycle: u64, stamp_ns: u64, cycle_ns: u64) -> CycleStatistics {
    let period_cycles = newest.cycles.saturating_sub(last.cycles);
    let mean = |newest: u64, last: u64| match period_cycles {
        0 => 0.0,
        cycles => newest.saturating_sub(last) as f64 / cycles as f64,
    };
    CycleStatistics {
        header: header(stamp_ns),
        cycle,
        cycle_ns: u32::try_from(cycle_ns).unwrap_or(u32::MAX),
        cycles: newest.cycles,
        missed: newest.missed,
        period_cycles,
        period_missed: newest.missed.saturating_sub(last.missed),
        lateness_mean: mean(newest.lateness_ns, last.lateness_ns),
        lateness_max: newest.newest_lateness_ns,
        lateness_worst: newest.worst_lateness_ns,
        duration_mean: mean(newest.duration_ns, last.duration_ns),
        duration_max: newest.newest_duration_ns,
        duration_worst: newest.worst_duration_ns,
        events_lost: newest.events_lost,
        lateness_p50: newest.newest_lateness.p50,
        lateness_p99: newest.newest_lateness.p99,
        lateness_p999: newest.newest_lateness.p999,
        duration_p50: newest.newest_duration.p50,
        duration_p99: newest.newest_duration.p99,
        duration_p999: newest.newest_duration.p999,
        lateness_p50_since_start: newest.lateness.p50,
        lateness_p99_since_start: newest.lateness.p99,
        lateness_p999_since_start: newest.lateness.p999,
        duration_p50_since_start: newest.duration.p50,
        duration_p99_since_start: newest.duration.p99,
        duration_p999_since_start: newest.duration.p999,
    }
}

#[cfg(test)]
mod tests {
    use super::super::host::Percentiles;
    use super::*;

    #[test]
    fn a_period_is_the_difference_of_two_looks_and_has_no_mean_without_cycles() {
        let last =
            Statistics { cycles: 10, missed: 1, lateness_ns: 1_000, duration_ns: 5_000, ..Statistics::default() };
        let newest = Statistics {
            cycles: 14,
            missed: 3,
            lateness_ns: 1_600,
            duration_ns: 6_000,
            newest_lateness_ns: 400,
            newest_duration_ns: 300,
            worst_lateness_ns: 900,
            worst_duration_ns: 800,
            newest_lateness: Percentiles { p50: 110, p99: 390, p999: 400 },
            newest_duration: Percentiles { p50: 240, p99: 290, p999: 300 },
            lateness: Percentiles { p50: 120, p99: 800, p999: 890 },
            duration: Percentiles { p50: 250, p99: 700, p999: 790 },
            events_lost: 2,
        };
        let seen = message(&last, &newest, 13, 2_000_000_007, 1_000_000);
        assert_eq!((seen.header.stamp.sec, seen.header.stamp.nanosec, seen.cycle), (2, 7, 13));
        assert_eq!((seen.cycles, seen.missed, seen.period_cycles, seen.period_missed), (14, 3, 4, 2));
        assert_eq!((seen.lateness_mean, seen.lateness_max, seen.lateness_worst), (150.0, 400, 900));
        assert_eq!((seen.duration_mean, seen.duration_max, seen.duration_worst), (250.0, 300, 800));
        assert_eq!((seen.cycle_ns, seen.events_lost), (1_000_000, 2));
        assert_eq!((seen.lateness_p50, seen.lateness_p99, seen.lateness_p999), (110, 390, 400));
        assert_eq!((seen.duration_p50, seen.duration_p99, seen.duration_p999), (240, 290, 300));
        let of = (seen.lateness_p50_since_start, seen.lateness_p99_since_start, seen.lateness_p999_since_start);
        assert_eq!(of, (120, 800, 890));
        let of = (seen.duration_p50_since_start, seen.duration_p99_since_start, seen.duration_p999_since_start);
        assert_eq!(of, (250, 700, 790));

        let standing = message(&newest, &newest, 13, 2_000_000_007, 1_000_000);
        assert_eq!((standing.period_cycles, standing.lateness_mean, standing.duration_mean), (0, 0.0, 0.0));
    }
}
