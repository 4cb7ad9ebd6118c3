use super::*;
use crate::config::Role;
use crate::drive::DriveMode;
use crate::{NodeId, Watching, eds};

const OWN: &str = include_str!("../../../../launch-configs/can/cia402_sim.eds");

/// The file of the simulated drive, with another value of a key in some sections.
fn changed(changes: &[(&str, &str, &str)]) -> Dictionary {
    let mut text = OWN.to_owned();
    for (section, key, value) in changes {
        let at = text.find(&format!("[{section}]\n")).expect("the section");
        let begin = at + text[at..].find(&format!("\n{key}=")).expect("the key") + 1;
        let end = begin + text[begin..].find('\n').expect("the end of the line");
        text.replace_range(begin..end, &format!("{key}={value}"));
    }
    eds::parse(text.as_bytes(), Some(3)).expect("a good file")
}

fn node() -> NodeId {
    NodeId::new(3).expect("1 to 127")
}

fn drive(mode: DriveMode) -> DeviceConfig {
    let mut device = DeviceConfig::plain_drive(0, node(), Watching::None);
    if let Role::Drive(drive) = &mut device.role {
        drive.mode = mode;
    }
    device
}

fn of(errors: &[&str], warnings: &[&str]) -> Findings {
    let owned = |sentences: &[&str]| sentences.iter().map(|sentence| (*sentence).to_owned()).collect();
    Findings { errors: owned(errors), warnings: owned(warnings) }
}

/// Bits 0, 2, 7, 8 of 185h are modes 1, 3, 8, 9 (CiA 402-2); bit 5 is homing.
#[test]
fn mode_that_the_file_does_not_offer_is_an_error() {
    let known = changed(&[("6502", "DefaultValue", "0x185")]);
    assert_eq!(compare(&drive(DriveMode::Csp), Needs::default(), &known), Findings::default());
    let said = "node 3 (x0): 6502h:00 is 00000185h by the file (pp, pv, csp, csv)";
    let cst = format!("{said}: mode 10 (cst) is missing; key mode chooses another");
    assert_eq!(compare(&drive(DriveMode::Cst), Needs::default(), &known), of(&[&cst], &[]));
    let homing = format!("{said}: mode 6 (hm) is missing, and homing.in_drive is true");
    assert_eq!(compare(&drive(DriveMode::Csp), Needs { homes: true }, &known), of(&[&homing], &[]));
    let with_homing = changed(&[("6502", "DefaultValue", "0x1A5")]);
    assert_eq!(compare(&drive(DriveMode::Csp), Needs { homes: true }, &with_homing), Findings::default());
}

#[test]
fn supported_modes_of_0_or_none_say_nothing() {
    for value in ["0", "", "0xFFFFFFFF"] {
        let known = changed(&[("6502", "DefaultValue", value)]);
        assert_eq!(compare(&drive(DriveMode::Cst), Needs { homes: true }, &known), Findings::default(), "{value}");
    }
}
