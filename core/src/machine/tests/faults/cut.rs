//! Absolute encoders whose line is cut: they do not recover, so each needs a separate machine.

use super::super::rig::{Rig, config};
use super::{Numbers, Shown, X, begin, by_errcond, check_reaction, errors, set, shown};
use crate::axis::Wired;
use crate::code::Code;
use crate::drive::Interface;
use crate::encoder::{Absolute, Form};

/// docs/errors.md, 10206: without its encoder a loop that is closed in the core is switched off, with the brake closed
/// for all reactions except 0. A drive that closes the loop itself follows error_reaction, where 5 stops like 2.
fn expected(interface: Interface, errcond: i64) -> (Shown, Shown) {
    match interface {
        Interface::Position => by_errcond(if errcond == 5 { 2 } else { errcond }),
        _ => (shown(false, errcond != 0), shown(false, errcond != 0)),
    }
}

#[test]
fn a_cut_line_ends_in_the_reaction_of_its_interface_in_its_cycle() {
    let rounds = if std::env::var_os("LINESHAFT_LONG").is_some() { 100 } else { 10 };
    let mut numbers = Numbers(5);
    let (mut faults, mut cycles) = (0, 0);
    for round in 0..rounds {
        for interface in [Interface::Position, Interface::Velocity] {
            for errcond in 0..6 {
                let mut config = config(0);
                config.axes[1].interface = interface;
                config.axes[1].wired = Wired::Drive(Form::Absolute(Absolute::single_turn(1 << 20)));
                config.axes[1].parameters.max_following_error = 20_000;
                let mut rig = Rig::of(config);
                rig.enable();
                set(&mut rig, "error_reaction", errcond);
                begin(&mut rig, &mut numbers);
                let text = format!("round {round}, {interface:?}, errcond {errcond}");
                assert_eq!(errors(&rig, X), [], "{text}");
                rig.plant.drive(0).expect("x").cut_encoder();
                rig.run(1);
                check_reaction(&mut rig, Code::ENCODER_INVALID, expected(interface, errcond), &text);
                assert_eq!(errors(&rig, X), [Code::ENCODER_INVALID], "{text}: told once");
                assert_eq!(rig.real("x.command.velocity"), 0.0, "{text}");
                (faults, cycles) = (faults + 1, cycles + rig.machine.next_cycle());
            }
        }
    }
    println!("{faults} lines of absolute encoders cut in {cycles} cycles, each answered in its cycle and told once");
}
