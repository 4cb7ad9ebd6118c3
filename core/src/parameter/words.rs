//! Words of the source systems, with the key or the equivalent of each.
//!
//! Law      a word is found as its source writes it (`VELMAX`, `MD18`, `34.001`, `Stop Mode`) and in small letters,
//!          with or without the prefix of its source; blanks, `_` and `-` are ignored
//! Source   the rows; WF-MD, WF-SIM-01, AMC-PAR-11 for words that are no parameters here

use super::{ROWS, System};

/// Equivalent of a word of a source.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Equivalent {
    /// The parameter of that key.
    Parameter(&'static str),
    /// A key of the axis in its cell.
    Key(&'static str),
    /// Something else, described in text.
    Words(&'static str),
}

/// A word of a source.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Word {
    /// Source system.
    pub system: System,
    /// Name in the source.
    pub name: &'static str,
    /// Equivalent.
    pub equivalent: Equivalent,
}

const fn wf(name: &'static str, here: Equivalent) -> Word {
    Word { system: System::Wf, name, equivalent: here }
}

const fn amc(name: &'static str, here: Equivalent) -> Word {
    Word { system: System::Amc, name, equivalent: here }
}

/// Words that are no parameters.
const ELSEWHERE: [Word; 14] = [
    wf("MD10", Equivalent::Words("the addresses in section `io` of the cell")),
    wf("MD11", Equivalent::Parameter("max_position")),
    wf("MD13", Equivalent::Parameter("min_position")),
    wf("MD18", Equivalent::Key("modulo")),
    wf("MD19", Equivalent::Key("scale")),
    wf("MD20", Equivalent::Key("scale")),
    wf("MD40", Equivalent::Words("`lineshaft sim`, or `run --sim`")),
    wf("MD49", Equivalent::Key("unit")),
    amc("31.010", Equivalent::Key("modulo")),
    amc("32.001", Equivalent::Key("amc: {master: ..}")),
    amc("32.007", Equivalent::Key("amc: {freeze: ..}")),
    amc("38.008", Equivalent::Words("the signal `command.position`")),
    amc("38.009", Equivalent::Words("the signal `command.velocity`")),
    amc("38.010", Equivalent::Words("the signal `command.acceleration`")),
];

impl Word {
    /// Returns all words: those of the rows in their order, then the others.
    pub fn all() -> impl Iterator<Item = Word> {
        let named = ROWS.iter().filter(|row| !row.mnemonic.is_empty());
        let of_rows = named.map(|row| Word {
            system: row.system,
            name: row.mnemonic,
            equivalent: Equivalent::Parameter(row.key),
        });
        of_rows.chain(ELSEWHERE)
    }

    /// Returns the word that a key was meant as; `None` for a valid key.
    pub fn find(key: &str) -> Option<Word> {
        /// No word is longer.
        const LONGEST: usize = 64;
        if key.len() > LONGEST || ROWS.iter().any(|row| row.key == key) {
            return None;
        }
        let small = key.to_lowercase();
        let (system, rest) = PREFIXES
            .iter()
            .find_map(|(prefix, system)| Some((Some(*system), small.strip_prefix(prefix)?)))
            .unwrap_or((None, &small));
        let is_of = |known: System| system.is_none_or(|system| system == known);
        let rest = without_separators(rest);
        let by_number = ROWS.iter().find(|row| is_of(row.system) && row.number.contains('.') && row.number == rest);
        let by_number = by_number.map(|row| Word {
            system: row.system,
            name: row.number,
            equivalent: Equivalent::Parameter(row.key),
        });
        by_number.or_else(|| {
            Self::all().find(|word| is_of(word.system) && without_separators(&word.name.to_lowercase()) == rest)
        })
    }

    /// Returns the equivalent in one clause: `MD18 of Siemens WF 725 is key modulo of the axis in its cell`. A
    /// parameter is written with its object, if given.
    pub fn text(&self, object: Option<&str>) -> String {
        let here = match (self.equivalent, object) {
            (Equivalent::Parameter(key), Some(object)) => format!("`{object}.{key}`"),
            (Equivalent::Parameter(key), None) | (Equivalent::Key(key), None) => format!("`{key}`"),
            (Equivalent::Key(key), Some(_)) => format!("key `{key}` of the axis in its cell"),
            (Equivalent::Words(words), _) => words.to_owned(),
        };
        format!("{} of {} is {here}", self.name, self.system.name())
    }
}

const PREFIXES: [(&str, System); 4] =
    [("wf.", System::Wf), ("amc.", System::Amc), ("saia.", System::Saia), ("macs.", System::Macs)];

/// Removes the separators, which are written differently in each source.
fn without_separators(text: &str) -> String {
    text.chars().filter(|c| !c.is_whitespace() && !"_-".contains(*c)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parameter::Row;

    #[test]
    fn a_word_is_found_as_it_is_written_there_and_here() {
        let text = |key: &str| Word::find(key).map(|word| word.text(None));
        let says = |key: &str, said: &str| assert_eq!(text(key).as_deref(), Some(said), "{key}");
        for key in ["md18", "MD18", "wf.md18", "MD 18", "md_18"] {
            says(key, "MD18 of Siemens WF 725 is `modulo`");
        }
        says("md1", "MD1 of Siemens WF 725 is `wf.md1`");
        says("VELMAX", "VELMAX of MACS is `velmax`");
        says("Stop Mode", "Stop Mode of Unidrive AMC is `amc.stop_mode`");
        says("34.001", "34.001 of Unidrive AMC is `amc.stop_mode`");
        says("amc.34.001", "34.001 of Unidrive AMC is `amc.stop_mode`");
        says("31.010", "31.010 of Unidrive AMC is `modulo`");
        says("DestP", "DestP of SAIA PCD4.H3 is `saia.destp`");
        says("MD40", "MD40 of Siemens WF 725 is `lineshaft sim`, or `run --sim`");
        for none in ["velmax", "wf.md1", "saia.md18", "md", "1", "", "max_velosity", "34.004", &"m".repeat(65)] {
            assert_eq!(text(none), None, "{none}");
        }
        let word = |key| Word::find(key).unwrap();
        assert_eq!(word("md1").text(Some("x")), "MD1 of Siemens WF 725 is `x.wf.md1`");
        assert_eq!(word("md18").text(Some("x")), "MD18 of Siemens WF 725 is key `modulo` of the axis in its cell");
    }

    /// Each word of a row leads to that row, and is not one of the other words.
    #[test]
    fn no_word_stands_for_two_things_of_its_source() {
        for row in ROWS.iter().filter(|row| !row.mnemonic.is_empty()) {
            let same: Vec<_> =
                Word::all().filter(|word| word.system == row.system && word.name == row.mnemonic).collect();
            assert_eq!(same.len(), 1, "{same:?}");
        }
        for word in ELSEWHERE {
            assert!(ROWS.iter().all(|row| row.system != word.system || row.number != word.name), "{word:?}");
            if let Equivalent::Parameter(key) = word.equivalent {
                assert!(Row::find(key).is_some(), "{word:?}");
            }
        }
    }
}
