//! Function types: their names, fields, inputs and outputs.

use super::field::{self, Field};
use super::program::LINES;
use super::shown::Shown;
use super::types;
use serde::{Deserialize, Serialize};

/// A function type.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Kind {
    /// Copies its source.
    Dcopy,
    /// Copies its source or one of two values, selected by E1.
    Ecopy,
    /// Monitors the following errors of drives.
    Sidiff,
    /// Gears its sink to its source with ratios that inputs select.
    Varsync,
    /// Switches a speed on and off.
    Digdreh,
    /// Measures the distance between marks.
    Imes,
    /// Switches outputs by a table of segments.
    Binea,
    /// Switches outputs by cams.
    Cam,
    /// Runs through tables by the travel of its source, or by time.
    Fipw,
    /// Runs through one of several tables by time.
    Fipz,
    /// Runs through tables and sets of tables.
    Xfipw,
    /// Follows a speed through a table.
    Dfkt,
    /// Virtual master in time; zeroes and monitors actual positions.
    Fgen,
    /// PID controller.
    Regl,
    /// Positions by a number of increments at each edge of an input.
    Epos,
    /// Runs a user program.
    Apsf,
}

/// Whether a type has a source or a sink.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Requirement {
    /// Not available.
    Never,
    /// Optional; `none` is allowed.
    May,
    /// Required.
    Must,
}

/// Physical quantity of the sink.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Quantity {
    /// A position, a copied or a measured value: RESET holds it.
    #[default]
    Position,
    /// A speed (0.0001 rpm): RESET sets it to 0; for apsf the program does.
    Speed,
}

impl Quantity {
    /// Both quantities, with their names in cells.
    pub const ALL: [(&'static str, Self); 2] = [("position", Self::Position), ("speed", Self::Speed)];

    /// Returns its name in cells.
    pub fn name(self) -> &'static str {
        match self {
            Self::Position => "position",
            Self::Speed => "speed",
        }
    }
}

/// Description of a function type.
#[derive(Clone, Copy, Debug)]
pub struct Description {
    /// The type.
    pub kind: Kind,
    /// Its name in cells.
    pub name: &'static str,
    /// Its purpose.
    pub help: &'static str,
    /// Fields of its parameter set.
    pub fields: &'static [Field],
    /// Whether it has a source.
    pub source: Requirement,
    /// Whether it has a sink, which may be an axis.
    pub sink: Requirement,
    /// Quantity of the sink, unless the cell sets it.
    pub quantity: Quantity,
    /// Whether the cell may set the quantity of the sink.
    pub chooses_quantity: bool,
    /// Whether its sink may be an axis.
    pub moves_axes: bool,
    /// Number of its inputs, E1 first.
    pub inputs: usize,
    /// Number of its outputs, A1 first.
    pub outputs: usize,
    /// Outputs that RESET sets, because they mean "at rest".
    pub rests: u8,
    /// Number of tables that it reads.
    pub tables: usize,
    /// Whether its tables may be changed while it is started.
    pub edits_tables: bool,
    /// Keys of the words that it reads in addition to its source, at most [`WORDS`](super::program::WORDS).
    pub words: &'static [&'static str],
    /// Values that it publishes in addition to its inputs and outputs, at most 9.
    pub shows: &'static [Shown],
    /// Whether it accepts VALUE_NEW.
    pub renews: bool,
    /// Whether it answers READ_VALUE, at rest only.
    pub reads_at_rest: bool,
    /// Whether its orders end, so that they can be goals.
    pub takes_goals: bool,
}

const OF_PROGRAMS: &[Shown] = &[Shown::number("fuel", "instructions that the last call of its program took")];

const OF_MARKS: &[Shown] = &[SAK_SHARE, CORRECTION, DEVIATION];

/// Values of a type that answers READ_VALUE, whose answer is the last one.
const OF_MARKS_AND_ANSWER: &[Shown] =
    &[SAK_SHARE, CORRECTION, DEVIATION, Shown::position("output_value", "what the last READ_VALUE has found")];

const CORRECTION: Shown = Shown::position("correction", "what printing mark control has added to its sink so far");

const DEVIATION: Shown =
    Shown::position("deviation", "how far the last mark was from its place on the slave, 0 where there was none");

const SAK_SHARE: Shown = Shown::position("sak_share", "what compensation of the following error adds to its sink");

const OF_SAK: &[Shown] = &[SAK_SHARE];

/// Actual positions of AW1 to AW8.
const OF_DRIVES: &[Shown; LINES] = &[
    Shown::position("feedback1", FEEDBACK),
    Shown::position("feedback2", FEEDBACK),
    Shown::position("feedback3", FEEDBACK),
    Shown::position("feedback4", FEEDBACK),
    Shown::position("feedback5", FEEDBACK),
    Shown::position("feedback6", FEEDBACK),
    Shown::position("feedback7", FEEDBACK),
    Shown::position("feedback8", FEEDBACK),
];

const FEEDBACK: &str = "actual position of the axis with that number, since it was zeroed";

/// All types.
pub const TYPES: &[Description] = &[
    Description {
        source: Requirement::Must,
        sink: Requirement::Must,
        chooses_quantity: true,
        moves_axes: true,
        ..Description::of(Kind::Dcopy, "dcopy", "copies its source into its sink", types::DCOPY)
    },
    Description {
        source: Requirement::May,
        sink: Requirement::Must,
        chooses_quantity: true,
        moves_axes: true,
        inputs: 1,
        outputs: 1,
        renews: true,
        ..Description::of(Kind::Ecopy, "ecopy", "copies its source or one of two values, as E1 says", types::ECOPY)
    },
    Description {
        outputs: 8,
        tables: 1,
        edits_tables: true,
        renews: true,
        ..Description::of(
            Kind::Sidiff,
            "sidiff",
            "reports which drives have a larger difference than allowed",
            types::SIDIFF,
        )
    },
    Description {
        source: Requirement::Must,
        moves_axes: true,
        inputs: 4,
        outputs: 1,
        words: &["word_addr"],
        shows: OF_SAK,
        ..Description::of(
            Kind::Varsync,
            "varsync",
            "gears its sink to its source by ratios that inputs choose",
            types::VARSYNC,
        )
    },
    Description {
        source: Requirement::Never,
        quantity: Quantity::Speed,
        moves_axes: true,
        inputs: 3,
        outputs: 1,
        rests: 1,
        ..Description::of(Kind::Digdreh, "digdreh", "switches a speed on and off by inputs", types::DIGDREH)
    },
    Description {
        source: Requirement::Must,
        inputs: 1,
        outputs: 2,
        renews: true,
        ..Description::of(Kind::Imes, "imes", "measures the distance of marks", types::IMES)
    },
    Description {
        sink: Requirement::Never,
        inputs: 8,
        outputs: 8,
        tables: 1,
        words: &["mw_offset_addr"],
        renews: true,
        ..Description::of(Kind::Binea, "binea", "switches outputs by the segments of a table", types::BINEA)
    },
    Description {
        inputs: 8,
        outputs: 8,
        tables: 1,
        edits_tables: true,
        ..Description::of(Kind::Cam, "cam", "switches outputs by cams, ahead of time where they are slow", types::CAM)
    },
    Description {
        moves_axes: true,
        inputs: 1,
        outputs: 1,
        tables: 8,
        shows: OF_MARKS,
        ..Description::of(
            Kind::Fipw,
            "fipw",
            "runs through tables by the travel of its source, or by time",
            types::FIPW,
        )
    },
    Description {
        source: Requirement::Never,
        moves_axes: true,
        inputs: 8,
        outputs: 1,
        rests: 1,
        tables: 8,
        shows: OF_SAK,
        ..Description::of(
            Kind::Fipz,
            "fipz",
            "runs through one of several tables by time, as inputs choose",
            types::FIPZ,
        )
    },
    Description {
        moves_axes: true,
        inputs: 5,
        outputs: 2,
        tables: 8,
        shows: OF_MARKS_AND_ANSWER,
        renews: true,
        reads_at_rest: true,
        ..Description::of(
            Kind::Xfipw,
            "xfipw",
            "runs through large tables and sets of them by the travel of its source, or by time",
            types::XFIPW,
        )
    },
    Description {
        source: Requirement::Must,
        quantity: Quantity::Speed,
        moves_axes: true,
        inputs: 5,
        outputs: 2,
        rests: 1,
        tables: 8,
        edits_tables: true,
        shows: types::DFKT_SHOWS,
        renews: true,
        ..Description::of(Kind::Dfkt, "dfkt", "follows a speed through a table, within limits", types::DFKT)
    },
    Description {
        moves_axes: true,
        inputs: 2,
        outputs: 8,
        rests: 1,
        words: &["override_addr"],
        shows: OF_DRIVES,
        renews: true,
        ..Description::of(
            Kind::Fgen,
            "fgen",
            "makes a master of time, started and stopped by an input; zeroes and monitors actual positions",
            types::FGEN,
        )
    },
    Description {
        source: Requirement::Must,
        quantity: Quantity::Speed,
        moves_axes: true,
        inputs: 4,
        outputs: 2,
        words: &["src1_addr", "src2_addr"],
        renews: true,
        ..Description::of(Kind::Regl, "regl", "controls a speed by what a source reports (PID)", types::REGL)
    },
    Description {
        moves_axes: true,
        inputs: 2,
        outputs: 2,
        rests: 1,
        words: &["vel_override_mw", "acc_override_mw"],
        shows: &[Shown::position("remaining", "what is left of its order")],
        renews: true,
        takes_goals: true,
        ..Description::of(
            Kind::Epos,
            "epos",
            "moves by a travel at each edge of an input: relative, over multiples of it, or from a zero pulse on",
            types::EPOS,
        )
    },
    Description {
        chooses_quantity: true,
        moves_axes: true,
        inputs: 8,
        outputs: 8,
        tables: 1,
        shows: OF_PROGRAMS,
        ..Description::of(Kind::Apsf, "apsf", "runs a program of yours, a WebAssembly module", types::APSF)
    },
];

impl Description {
    const fn of(kind: Kind, name: &'static str, help: &'static str, fields: &'static [Field]) -> Self {
        Self {
            kind,
            name,
            help,
            fields,
            source: Requirement::May,
            sink: Requirement::May,
            quantity: Quantity::Position,
            chooses_quantity: false,
            moves_axes: false,
            inputs: 0,
            outputs: 0,
            rests: 0,
            tables: 0,
            edits_tables: false,
            words: &[],
            shows: &[],
            renews: false,
            reads_at_rest: false,
            takes_goals: false,
        }
    }

    /// Returns the number of values of its parameter set.
    pub fn width(&self) -> usize {
        field::width(self.fields)
    }

    /// Returns the field of that name, and the index of its first value in the set.
    pub fn find(&self, name: &str) -> Option<(&'static Field, usize)> {
        let mut place = 0;
        for field in self.fields {
            if field.name == name {
                return Some((field, place));
            }
            place += field.count;
        }
        None
    }

    /// Returns the field of a value of the set: its number, the field, and the index of the value in it.
    pub fn field_of(&self, mut place: usize) -> Option<(u16, &'static Field, usize)> {
        for (number, field) in (0_u16..).zip(self.fields) {
            if place < field.count {
                return Some((number, field, place));
            }
            place -= field.count;
        }
        None
    }

    /// Returns the default values of the set.
    pub fn defaults(&self) -> Box<[i64]> {
        self.fields.iter().flat_map(|field| std::iter::repeat_n(field.default, field.count)).collect()
    }
}

impl Kind {
    /// Returns the description of the type.
    pub fn description(self) -> &'static Description {
        // The rows are in the order of the enum; a test checks that.
        TYPES.get(self as usize).unwrap_or(&TYPES[0])
    }

    /// Returns the type of that name.
    pub fn find(name: &str) -> Option<Self> {
        TYPES.iter().find(|row| row.name == name).map(|row| row.kind)
    }

    /// Returns the name in cells.
    pub fn name(self) -> &'static str {
        self.description().name
    }
}

#[cfg(test)]
mod tests {
    use super::super::shown::{ANSWER, MOST_SHOWN};
    use super::*;

    /// Proves: AMK-IMES-03, AMK-IMES-04, AMK-IMES-05, AMK-IMES-07, AMK-BINEA-08, AMK-BINEA-13, AMK-CAM-29
    #[test]
    fn types_have_the_fields_and_orders_of_their_tables() {
        let names = |kind: Kind| kind.description().fields.iter().map(|field| field.name).collect::<Vec<_>>();
        assert_eq!(names(Kind::Imes), ["ba", "sf_cycle_time", "spacing", "window", "blocked"]);
        let renews: Vec<_> = TYPES.iter().filter(|row| row.renews).map(|row| row.name).collect();
        assert_eq!(renews, ["ecopy", "sidiff", "imes", "binea", "xfipw", "dfkt", "fgen", "regl", "epos"]);
        assert_eq!(
            (Kind::Binea.description().words, Kind::Cam.description().words),
            (&["mw_offset_addr"][..], &[][..])
        );
    }

    #[test]
    fn types_are_in_order_and_defaults_in_range() {
        for (place, row) in TYPES.iter().enumerate() {
            assert_eq!((row.kind as usize, Kind::find(row.name)), (place, Some(row.kind)));
            // A field that does not allow 0 must be given, or have a default.
            let may_stand = |field: &Field| field.default == 0 || (field.min..=field.max).contains(&field.default);
            assert!(row.fields.iter().all(may_stand), "{}", row.name);
            assert_eq!(row.fields.iter().any(|field| field.live), row.renews, "{}", row.name);
            assert_eq!(row.defaults().len(), row.width());
            assert!(row.shows.len() <= MOST_SHOWN, "{}", row.name);
            let answer = row.shows.get(ANSWER).filter(|shown| shown.name == "output_value");
            assert_eq!(answer.is_some(), row.reads_at_rest, "{}", row.name);
            for place in 0..row.width() {
                let (_, field, nth) = row.field_of(place).expect("each value has a field");
                assert_eq!(row.find(field.name).map(|(_, first)| first + nth), Some(place));
            }
        }
    }
}
