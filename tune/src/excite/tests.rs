use super::*;
use proptest::prelude::*;

const PERMITTED: Permitted = Permitted {
    cycle: 1e-3,
    takes: Takes::Effort,
    travel: 1000.0,
    margin: 100.0,
    velocity: 5000.0,
    command: 0.4,
    ramp: 0.5,
    duration: 1.0,
    seed: 7,
};

/// An axis without inertia: its velocity is the command minus its friction.
fn follows(permitted: Permitted, cycles: usize) -> Vec<(f64, ExcitationOutput)> {
    let mut excitation = Excitation::new(permitted).unwrap();
    let (mut place, mut velocity) = (0.0, 0.0);
    (0..cycles)
        .map(|_| {
            let drive = excitation.next(place, velocity);
            let command = if let ExcitationOutput::Command(command) = drive { command } else { 0.0 };
            velocity = 20_000.0 * (command.abs() - 0.05).max(0.0) * command.signum();
            place += velocity * permitted.cycle;
            (place, drive)
        })
        .collect()
}

#[test]
fn settings_beyond_their_range_are_refused() {
    let said = |permitted| Excitation::new(permitted).unwrap_err().to_string();
    assert_eq!(said(Permitted { command: 0.0, ..PERMITTED }), "command is 0 ; 0.001 to 1  is permitted");
    assert_eq!(said(Permitted { command: 1.1, ..PERMITTED }), "command is 1.1 ; 0.001 to 1  is permitted");
    assert_eq!(said(Permitted { travel: 9.0, ..PERMITTED }), "travel is 9 inc; 10 to 1000000000000 inc is permitted");
    assert!(Excitation::new(Permitted { cycle: f64::NAN, ..PERMITTED }).is_err());
    assert!(Excitation::new(Permitted { margin: 0.0, ..PERMITTED }).is_err());
    assert!(Excitation::new(Permitted { velocity: f64::INFINITY, ..PERMITTED }).is_err());
    assert!(Excitation::new(Permitted { ramp: 0.0, ..PERMITTED }).is_err());
    assert!(Excitation::new(Permitted { duration: 0.0, ..PERMITTED }).is_err());
}

#[test]
fn the_same_seed_is_the_same_excitation() {
    let of = |seed| follows(Permitted { seed, ..PERMITTED }, 4000);
    assert_eq!(of(1), of(1));
    assert_ne!(of(1), of(2));
}

/// Steps last one to eight cycles and have both signs equally often, also with the seed that equals its own mask.
#[test]
fn steps_are_random_with_each_seed() {
    for seed in [0, 1, SEED, u64::MAX] {
        let mut excitation = Excitation::new(Permitted { seed, ..PERMITTED }).unwrap();
        let bits: Vec<f64> = (0..20_000).map(|_| excitation.random_step()).collect();
        let sum: f64 = bits.iter().sum();
        assert!(sum.abs() < 1500.0, "{seed}: {sum}");
        let changes = bits.windows(2).filter(|pair| pair[0] != pair[1]).count();
        // 20000 / 4.5 steps, of which half differ from the previous one.
        assert!((1900..2600).contains(&changes), "{seed}: {changes}");
    }
}

/// It never exceeds the permitted values, returns, and stays ended.
#[test]
fn excitation_moves_back_and_forth_and_returns() {
    for takes in [Takes::Effort, Takes::Velocity] {
        let run = follows(Permitted { takes, duration: 3.0, ..PERMITTED }, 8000);
        let places: Vec<f64> = run.iter().map(|(place, _)| *place).collect();
        let most = places.iter().fold(0.0_f64, |most, place| most.max(place.abs()));
        assert!(most > 0.5 * PERMITTED.travel && most < PERMITTED.travel, "{most}");
        let turns = places.windows(2).filter(|pair| pair[0] * pair[1] < 0.0).count();
        assert!(turns >= 2, "{turns}");
        assert!(matches!(run[run.len() - 1].1, ExcitationOutput::Done(_)), "{takes:?}");
        assert!(places[places.len() - 1].abs() <= 0.1 * PERMITTED.travel);
    }
}

#[test]
fn progress_never_falls() {
    let mut excitation = Excitation::new(PERMITTED).unwrap();
    let (mut place, mut velocity, mut progress) = (0.0, 0.0, 0.0);
    for _ in 0..5000 {
        let ExcitationOutput::Command(command) = excitation.next(place, velocity) else { break };
        velocity = 20_000.0 * (command.abs() - 0.05).max(0.0) * command.signum();
        place += velocity * PERMITTED.cycle;
        assert!((progress..=1.0).contains(&excitation.progress()), "{progress} {}", excitation.progress());
        progress = excitation.progress();
    }
    assert_eq!(excitation.progress(), 1.0);
}

/// Beyond travel and margin it aborts in that cycle, with 0, and stays aborted.
#[test]
fn beyond_its_margin_it_aborts_and_stays_aborted() {
    let mut excitation = Excitation::new(PERMITTED).unwrap();
    assert!(matches!(excitation.next(1100.0, 0.0), ExcitationOutput::Command(_)));
    let over = excitation.next(-1101.0, 0.0);
    assert_eq!(over, ExcitationOutput::Aborted(Abort::Travel { position: -1101.0, most: 1100.0 }));
    assert_eq!(excitation.next(0.0, 0.0), over);
    let ExcitationOutput::Aborted(abort) = over else { panic!() };
    assert_eq!(abort.to_string(), "the axis is -1101 inc from its start; within 1100 inc are permitted");
}

/// It has reversed at 600 inc, and still moves outwards at 850: half of the permitted command brakes it.
#[test]
fn a_turn_that_comes_late_is_braked() {
    let mut excitation = Excitation::new(PERMITTED).unwrap();
    (excitation.up, excitation.down, excitation.amplitude) = (0.1, -0.1, 0.025);
    (excitation.phase, excitation.sense) = (Phase::Legs { left: 100 }, -1.0);
    assert_eq!(excitation.next(850.0, 1000.0), ExcitationOutput::Command(-0.2));
    assert_eq!(excitation.next(750.0, 1000.0), ExcitationOutput::Command(-0.125));
    assert_eq!(excitation.next(-850.0, -1000.0), ExcitationOutput::Command(0.2));
    // Too fast, at any position.
    assert_eq!(excitation.next(0.0, 4800.0), ExcitationOutput::Command(-0.2));
}

proptest! {
    /// For any input the output is within the permitted command, and the excitation ends.
    #[test]
    fn no_input_makes_a_command_beyond_what_is_permitted(
        command in 0.01..1.0_f64,
        is_velocity in any::<bool>(),
        inputs in proptest::collection::vec((any::<f64>(), -2000.0..2000.0_f64, -1e4..1e4_f64, 0_u8..20), 50),
        seed in any::<u64>(),
    ) {
        let takes = if is_velocity { Takes::Velocity } else { Takes::Effort };
        let mut excitation = Excitation::new(Permitted { command, takes, seed, ..PERMITTED }).unwrap();
        for k in 0..10_000_usize {
            let (wild, place, velocity, kind) = inputs[k / 7 % inputs.len()];
            // Mostly possible values of an axis, sometimes impossible ones.
            let (place, velocity) = match kind {
                0 if k > 3000 => (wild, velocity),
                1 => (place / 10.0, wild),
                _ => (place / 2.0, velocity),
            };
            let beyond = place.is_finite() && place.abs() > 1100.0;
            match excitation.next(place, velocity) {
                ExcitationOutput::Command(asked) => {
                    prop_assert!(asked.abs() <= command, "{asked}");
                    prop_assert!(!beyond);
                }
                ExcitationOutput::Done(hold) => {
                    prop_assert!(hold.abs() <= command);
                    return Ok(());
                }
                ExcitationOutput::Aborted(_) => {
                    prop_assert!(matches!(excitation.next(0.0, 0.0), ExcitationOutput::Aborted(_)));
                    return Ok(());
                }
            }
        }
        prop_assert!(false, "it does not end");
    }
}
