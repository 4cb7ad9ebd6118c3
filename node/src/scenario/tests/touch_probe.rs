//! Tests verbs `touch_probe` and `abort_trigger`.

use super::*;

/// x moves to 100 mm from cycle 100 on: at 50 mm/s from cycle 200 on, where it is at 2.5 mm; in cycle 301 its position
/// was read as 7500 inc.
const WAY: &str = "- {at: 0, do: {enable: {axes: [x]}}}\n\
    - {name: go, at: 100, do: {move_axis: {axis: x, position: 100 mm}}}\n";

fn steps(rest: &str) -> String {
    format!("scenario: s\ncycles: 2600\nsteps:\n{WAY}{rest}")
}

#[test]
fn touch_probe_records_the_position_and_the_goal_continues() {
    passes(&steps(
        "- {at: 50, do: {touch_probe: {axis: x, event: mark}}}\n\
         - {at: 301, do: {inject: {latch: {input: mark, age: 350 us}}}}\n\
         - {at: 310, do: {inject: {latch: {input: mark, age: 0 us}}}}\n\
         expect:\n\
         - {event: {kind: latch, source: x, age_ns: 350000, increments: 7482, text: touch probe}, at: 301, count: 1}\n\
         - {event: {kind: latch, source: x}, count: 1}\n\
         - {event: {kind: done, source: x, code: 0, increments: 7482}, at: 301, count: 1}\n\
         - {signal: x.latch.position, at: 301, is: 7482 inc}\n\
         - {signal: x.latch.count, at: end, is: 1}\n\
         - {signal: x.command.position, at: end, is: 100 mm}\n",
    ));
}

/// A mark at every 10 mm of the first 60 mm, and a window from 20 to 40 mm with three of them.
#[test]
fn a_continuous_one_records_within_its_window_until_it_is_aborted() {
    passes(&steps(
        "- {at: 60, do: {touch_probe: {axis: x, event: mark, edge: both, continuous: true, first_position: 19.9 mm, last_position: 40.1 mm}}}\n\
         - {at: 351, every: 200, count: 6, do: {inject: {latch: {input: mark, edge: falling}}}}\n\
         - {at: 2000, do: {abort_trigger: {axis: x, event: mark}}}\n\
         - {at: 2001, do: {abort_trigger: {axis: x}}, refused: {code: TOUCH_PROBE_NOT_ARMED, text: no touch probe is armed}}\n\
         expect:\n\
         - {event: {kind: latch, source: x, increments: 20000, text: falling edge of mark}, at: 551, count: 1}\n\
         - {event: {kind: latch, source: x, increments: 30000}, at: 751, count: 1}\n\
         - {event: {kind: latch, source: x, increments: 40000}, at: 951, count: 1}\n\
         - {event: {kind: latch, source: x}, count: 3}\n\
         - {event: {kind: done, source: x, code: CANCELLED}, at: 2000, count: 1}\n",
    ));
}

#[test]
fn what_is_wrong_with_it_is_told_at_its_place() {
    let wrong = |arguments: &str| problem("steps", &format!("{{at: 1, do: {arguments}}}"));
    assert_eq!(wrong("{touch_probe: ^{axis: x}}"), "missing key `event` in touch_probe");
    assert_eq!(wrong("{touch_probe: ^{axis: x, event: start}}"), "`start` does not latch; mark, belt, x, turret can");
    assert!(wrong("{touch_probe: ^{axis: q, event: mark}}").starts_with("no axis is called `q`"));
    assert_eq!(
        wrong("{touch_probe: {axis: x, event: mark, edge: ^up}}"),
        "edge is `up`; one of rising, falling, both, index is allowed"
    );
    assert_eq!(
        wrong("{touch_probe: ^{axis: x, event: mark, window_only: false, last_position: 5 mm}}"),
        "window_only is 0; without it first_position and last_position must be 0"
    );
    assert!(
        wrong("{touch_probe: ^{axis: x, event: mark, edge: index}}")
            .starts_with("edge is 3; INDEX is that of the axis")
    );
    assert_eq!(wrong("{abort_trigger: ^{axis: x, event: lamp}}"), "`lamp` does not latch; mark, belt, x, turret can");
    let failed = failure(
        "steps: [{at: 1, do: {touch_probe: {axis: x, event: mark, first_position: 2 mm, last_position: 1 mm}}}]\n",
    );
    assert!(failed.contains("first_position 2 mm exceeds last_position 1 mm"), "{failed}");
}
