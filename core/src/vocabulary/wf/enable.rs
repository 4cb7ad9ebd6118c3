//! Controller enable.
//!
//! Law      enable = request and no reset bit and no alarm below 60 and controller ready
//! Source   WF-IF-03, WF-MON-06

/// Alarms below this number drop the controller enable.
const FIRST_HARMLESS_ALARM: u8 = 60;

/// Returns true if the controller is enabled. `alarm` 0 means none.
pub fn enable(request: bool, ready: bool, reset: bool, alarm: u8) -> bool {
    request && !reset && !(1..FIRST_HARMLESS_ALARM).contains(&alarm) && ready
}

#[cfg(test)]
mod tests {
    use super::enable;

    /// Proves: WF-ORA-18, WF-IF-03
    #[test]
    fn an_alarm_below_60_drops_the_enable_and_one_above_does_not() {
        assert!(enable(true, true, false, 65));
        assert!(!enable(true, true, false, 22));
        assert!(!enable(true, true, false, 59) && enable(true, true, false, 60));
        assert!(enable(true, true, false, 0));
        assert!(!enable(false, true, false, 0), "no request");
        assert!(!enable(true, false, false, 0), "not ready");
        assert!(!enable(true, true, true, 0), "reset bit");
    }
}
