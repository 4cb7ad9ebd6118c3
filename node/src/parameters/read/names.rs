//! Names of parameters in older files.

use lineshaft_core::parameter::{ROWS, Row, System};

/// Misspellings in the manual of MACS, in lower case, with the correct names (spec/macs.md 1.2, A-01).
const MISPRINTS: &[(&str, &str)] = &[
    ("syncfac_t_m", "syncfactm"),
    ("syncfac_t_s", "syncfacts"),
    ("syncfacst", "syncfacts"),
    ("syncfac5", "syncfacts"),
    ("syncpfacts", "syncfacts"),
    ("posfac_t_z", "posfact_z"),
    ("posfac_t_n", "posfact_n"),
    ("syncfalt", "syncfault"),
    ("syncfac_t_f", "syncfault"),
    ("synckmarkm", "syncmarkm"),
    ("synckmarks", "syncmarks"),
    ("syncpmarkm", "syncmarkm"),
    ("synckm", "syncmarkm"),
    ("syncfac_t_mk", "syncmarkm"),
    ("syncfac_t_mks", "syncmarks"),
    ("syncfmpar", "syncmfpar"),
    ("syncfac_t_mf", "syncmfpar"),
    ("syncfmftime", "syncmftime"),
    ("syncfac_t_mft", "syncmftime"),
    ("syncfac_t_mmc", "syncmmaxcorr"),
    ("syncpulsm", "syncmpulsm"),
    ("syncpulss", "syncmpulss"),
    ("syncfac_t_mp", "syncmpulsm"),
    ("syncfac_t_mps", "syncmpulss"),
    ("syncfmstart", "syncmstart"),
    ("syncfac_t_ms", "syncmstart"),
    ("syncfac_t_mtp", "syncmtypm"),
    ("syncfvtime", "syncvftime"),
    ("synvftime", "syncvftime"),
    ("synvtime", "syncvftime"),
    ("synccffvel", "syncffvel"),
    ("homelevel", "home_vel"),
    ("i2limit", "i2tlimit"),
    ("poserrtim", "poserrtime"),
    ("maxvel", "velmax"),
];

/// Returns the name of a parameter as in the catalogue: a MACS name may be in capitals, or misprinted.
pub(super) fn canonical(name: &str) -> String {
    let Some((object, key)) = name.split_once('.') else { return name.to_owned() };
    if Row::find(key).is_some() {
        return name.to_owned();
    }
    let small = key.to_ascii_lowercase();
    let of_macs = ROWS.iter().filter(|row| row.system == System::Macs).map(|row| row.key);
    let right = MISPRINTS.iter().find(|(misprint, _)| *misprint == small).map_or(small.as_str(), |(_, right)| right);
    of_macs.into_iter().find(|known| *known == right).map_or(name.to_owned(), |right| format!("{object}.{right}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_misprint_means_a_parameter_that_there_is_and_is_none_itself() {
        for (misprint, right) in MISPRINTS {
            assert!(Row::find(misprint).is_none(), "{misprint}");
            assert!(Row::find(right).is_some(), "{right}");
        }
    }

    #[test]
    fn names_of_macs_are_read_as_its_manual_writes_them() {
        for (given, expected) in [
            ("x.VELMAX", "x.velmax"),
            ("x.SYNCFAC_T_M", "x.syncfactm"),
            ("x.MAXVEL", "x.velmax"),
            ("machine.CANNR", "machine.cannr"),
            ("x.max_velocity", "x.max_velocity"),
            // Names of other sources must be written exactly.
            ("x.MAX_VELOCITY", "x.MAX_VELOCITY"),
            ("x.SAIA.KPROP", "x.SAIA.KPROP"),
            ("x", "x"),
        ] {
            assert_eq!(canonical(given), expected);
        }
    }
}
