//! An excitation runs in a cycle: it neither allocates nor frees memory in any of its phases.

use assert_no_alloc::{AllocDisabler, assert_no_alloc, violation_count};
use lineshaft_tune::{Excitation, ExcitationOutput, Permitted, Takes};

#[global_allocator]
static ALLOCATOR: AllocDisabler = AllocDisabler;

#[test]
fn excitation_does_not_allocate() {
    for (takes, is_stuck, sense) in [
        (Takes::Effort, false, 1.0),
        (Takes::Velocity, false, 1.0),
        (Takes::Effort, true, 1.0),
        (Takes::Effort, false, -1.0),
    ] {
        let permitted = Permitted {
            cycle: 1e-3,
            takes,
            travel: 1000.0,
            margin: 100.0,
            velocity: 5000.0,
            command: 0.4,
            ramp: 0.5,
            duration: 3.0,
            seed: 7,
        };
        let mut excitation = Excitation::new(permitted).unwrap();
        let (mut place, mut velocity, mut cycles) = (0.0, 0.0, 0_u32);
        // An axis without inertia: its velocity is the command minus its friction.
        let end = loop {
            let drive = assert_no_alloc(|| {
                let _ = excitation.progress();
                excitation.next(place, velocity)
            });
            let ExcitationOutput::Command(command) = drive else { break drive };
            velocity =
                if is_stuck { 0.0 } else { sense * 20_000.0 * (command.abs() - 0.05).max(0.0) * command.signum() };
            place += velocity * permitted.cycle;
            cycles += 1;
        };
        assert_eq!(violation_count(), 0);
        assert_eq!(matches!(end, ExcitationOutput::Aborted(_)), is_stuck || sense < 0.0, "{end:?}");
        assert!(cycles > 100, "{cycles}");
    }
}
