//! Descriptions of function types: their names, fields, inputs and outputs.

use super::field::{self, Field};
use super::shown::Shown;
use super::types::Kind;
use super::wires::Width;

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

/// Source of the marks of a type.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MarkSource {
    /// No marks.
    None,
    /// E1, or the encoder that is the source if E1 is not wired.
    Input,
    /// The encoder that is the source.
    Encoder,
    /// The index pulse of the axis that is the sink.
    SinkAxis,
}

/// Values of the first eight axes that a type reads without a source.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Monitored {
    /// None.
    Nothing,
    /// Position control differences of the last cycle.
    Errors,
    /// Actual positions.
    Positions,
}

/// Limits of a type in AMKASYN, which the preset `amkasyn` of a cell checks.
#[derive(Clone, Copy, Debug)]
pub struct AmkLimits {
    /// Whether its parameter set contains the time between two calls, in at most 131 units of 0.5 ms.
    pub sets_call_time: bool,
    /// Whether its sink may be an analog output.
    pub writes_analog: bool,
    /// Widths of a memory cell as sink.
    pub sink_widths: &'static [Width],
    /// Maximum words of a table.
    pub table_words: usize,
}

impl AmkLimits {
    /// Limits of most types.
    pub(super) const USUAL: Self =
        Self { sets_call_time: false, writes_analog: false, sink_widths: &[Width::W16, Width::W32], table_words: 256 };
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
    /// Whether its source must be an encoder.
    pub measures_encoder: bool,
    /// Source of its marks.
    pub marks: MarkSource,
    /// Values of axes that it reads without a source.
    pub monitors: Monitored,
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
    /// Whether it accepts VALUE_NEW: it has a live field.
    pub renews: bool,
    /// Whether it answers READ_VALUE, at rest only.
    pub reads_at_rest: bool,
    /// Whether its orders end, so that they can be goals.
    pub takes_goals: bool,
    /// Whether it runs a user program.
    pub runs_program: bool,
    /// Limits of the type in AMKASYN.
    pub amk: AmkLimits,
    /// Values of fields with which START accepts a set, for tests and benches; none if it accepts the defaults.
    pub example: &'static [(&'static str, i64)],
}

impl Description {
    /// Returns the description of a type that has only fields.
    pub(super) const fn of(kind: Kind, name: &'static str, help: &'static str, fields: &'static [Field]) -> Self {
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
            measures_encoder: false,
            marks: MarkSource::None,
            monitors: Monitored::Nothing,
            inputs: 0,
            outputs: 0,
            rests: 0,
            tables: 0,
            edits_tables: false,
            words: &[],
            shows: &[],
            renews: field::has_live(fields),
            reads_at_rest: false,
            takes_goals: false,
            runs_program: false,
            amk: AmkLimits::USUAL,
            example: &[],
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

#[cfg(test)]
mod tests {
    use super::super::program::SlotSetup;
    use super::super::shown::{ANSWER, MOST_SHOWN, OF_MARKS_AND_ANSWER};
    use super::super::types::{Any, TYPES};
    use super::super::wires::MemorySize;
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
            assert_eq!(row.defaults().len(), row.width());
            assert!(row.example.iter().all(|(name, _)| row.find(name).is_some()), "{}", row.name);
            assert!(row.shows.len() <= MOST_SHOWN, "{}", row.name);
            let stored = Any::new(row.kind, &SlotSetup::default()).shown().len();
            let of_call = OF_MARKS_AND_ANSWER.get(..row.shows.len());
            assert!(stored == row.shows.len() || stored == 0 && of_call == Some(row.shows), "{}", row.name);
            let answer = row.shows.get(ANSWER).filter(|shown| shown.name == "output_value");
            assert_eq!(answer.is_some(), row.reads_at_rest, "{}", row.name);
            for place in 0..row.width() {
                let (_, field, nth) = row.field_of(place).expect("each value has a field");
                assert_eq!(row.find(field.name).map(|(_, first)| first + nth), Some(place));
            }
        }
    }
    /// States of functions at rest differ only by their setup.
    #[test]
    fn types_recognize_another_setup() {
        let memory = MemorySize { mean: 500, cams: 500 };
        let [first, second] = [[true, false], [false, true]].map(SlotSetup::of_words);
        let setups = [SlotSetup::default(), first, second, SlotSetup { room: memory, ..SlotSetup::default() }];
        let image = |function: &Any| postcard::to_allocvec(function).expect("a state has a form");
        for row in TYPES {
            let functions = setups.each_ref().map(|setup| Any::new(row.kind, setup));
            for (mine, other) in functions.iter().flat_map(|mine| functions.iter().map(move |other| (mine, other))) {
                assert_eq!(mine.is_set_up_as(other), image(mine) == image(other), "{}", row.name);
            }
        }
    }
}
