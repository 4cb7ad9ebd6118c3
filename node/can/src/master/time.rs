//! TIME message with the time of day.
//!
//! Law      milliseconds after midnight and days since 1984-01-01, both in UTC; a system clock before that day gives 0
//! Writes   frames with identifier 100h
//! Source   CiA 301 (TIME_OF_DAY, 1012h)

use crate::{Frame, Id};
use std::time::Duration;

/// Days from 1970-01-01 to 1984-01-01.
const FIRST_DAY: u64 = 5113;
const MS_PER_DAY: u64 = 86_400_000;

/// Producer of the TIME message: period, and time of the last one.
#[derive(Clone, Copy, Debug)]
pub(super) struct TimeOfDay {
    every_ns: Option<u64>,
    sent_ns: Option<u64>,
}

impl TimeOfDay {
    /// `None`: TIME is never sent.
    pub(super) fn new(every_ns: Option<u64>) -> Self {
        Self { every_ns, sent_ns: None }
    }

    /// Returns the frame if it is due; `since_1970`: time of the system clock.
    pub(super) fn due(&mut self, now_ns: u64, since_1970: impl FnOnce() -> Duration) -> Option<Frame> {
        let every_ns = self.every_ns?;
        if self.sent_ns.is_some_and(|sent| now_ns.saturating_sub(sent) < every_ns) {
            return None;
        }
        self.sent_ns = Some(now_ns);
        Frame::data(Id::TIME, &of_day(since_1970())).ok()
    }
}

fn of_day(since_1970: Duration) -> [u8; 6] {
    let ms = u64::try_from(since_1970.as_millis()).unwrap_or(u64::MAX).saturating_sub(FIRST_DAY * MS_PER_DAY);
    let [a, b, c, d] = ((ms % MS_PER_DAY) as u32).to_le_bytes();
    // 16 bits are sufficient until 2163.
    let [e, f] = u16::try_from(ms / MS_PER_DAY).unwrap_or(u16::MAX).to_le_bytes();
    [a, b, c, d, e, f]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 1984-01-01 00:00 is 441,763,200 s after 1970; 2026-11-25 13:12:22.001 UTC is day 15,669, 47,542,001 ms.
    #[test]
    fn the_time_of_day_is_that_of_the_standard() {
        assert_eq!(of_day(Duration::from_secs(441_763_200)), [0; 6]);
        assert_eq!(of_day(Duration::ZERO), [0; 6]);
        let day = 15_669_u16.to_le_bytes();
        let ms = 47_542_001_u32.to_le_bytes();
        let now = of_day(Duration::from_millis(1_795_612_342_001));
        assert_eq!(now, [ms[0], ms[1], ms[2], ms[3], day[0], day[1]]);
    }

    #[test]
    fn time_message_is_sent_at_once_and_then_periodically() {
        let sent = |time: &mut TimeOfDay, now_ns| time.due(now_ns, || Duration::ZERO).is_some();
        let mut time = TimeOfDay::new(Some(100));
        assert_eq!([50, 149, 150, 249, 900].map(|now| sent(&mut time, now)), [true, false, true, false, true]);
        assert!(!sent(&mut TimeOfDay::new(None), 50));
    }
}
