//! Why a request is refused before it becomes a command.

use crate::unit::UnitError;

/// Why a request is refused before it becomes a command.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RequestError {
    /// A name that no axis has.
    #[error("no axis is called `{name}`; there are {known}")]
    UnknownAxis {
        /// The name given.
        name: String,
        /// The names there are.
        known: String,
    },
    /// A name that nothing has that could lead.
    #[error("`{name}` cannot lead; {known} can")]
    UnknownLeader {
        /// The name given.
        name: String,
        /// The names there are.
        known: String,
    },
    /// A name that no function has.
    #[error("no function is called `{name}`; {known} are known")]
    UnknownFunction {
        /// The name given.
        name: String,
        /// The names there are.
        known: String,
    },
    /// A name that no table has.
    #[error("no table is called `{name}`; {known} are known")]
    UnknownTable {
        /// The name given.
        name: String,
        /// The names there are.
        known: String,
    },
    /// A name that no program has.
    #[error("no program is called `{name}`; {known} are known")]
    UnknownProgram {
        /// The name given.
        name: String,
        /// The names there are.
        known: String,
    },
    /// A name that no field of a function has.
    #[error("{function}: type {kind} has no field `{field}`; it has {known}")]
    UnknownField {
        /// The function.
        function: String,
        /// Its type.
        kind: &'static str,
        /// The name given.
        field: String,
        /// The names there are.
        known: String,
    },
    /// More values than a field has, or none.
    #[error("{function}: {given} values for {field}; 1 to {most} are possible")]
    FieldCount {
        /// The function.
        function: String,
        /// The field.
        field: String,
        /// How many.
        given: usize,
        /// How many are possible.
        most: usize,
    },
    /// A value of a form that no field takes.
    #[error("{function}: {sentence}")]
    FieldForm {
        /// The function.
        function: String,
        /// What is wrong with it, with the name of the field.
        sentence: String,
    },
    /// Two values for one place of a set.
    #[error("{function}: {field} is given twice")]
    FieldTwice {
        /// The function.
        function: String,
        /// The field.
        field: String,
    },
    /// Numbers that make no table.
    #[error("{name}: {sentence}")]
    BadTable {
        /// The table.
        name: String,
        /// What is wrong.
        sentence: String,
    },
    /// A module that is not taken.
    #[error("{name}: {sentence}")]
    BadProgram {
        /// The program.
        name: String,
        /// What is wrong.
        sentence: String,
    },
    /// A name that nothing has that latches.
    #[error("`{name}` does not latch; {known} can")]
    UnknownLatch {
        /// The name given.
        name: String,
        /// The names there are.
        known: String,
    },
    /// A name that no parameter has.
    #[error("no parameter is called `{name}`{hint}")]
    UnknownParameter {
        /// The name given.
        name: String,
        /// What may have been meant.
        hint: String,
    },
    /// A word that a vocabulary does not have.
    #[error("no {what} is called `{name}`; there are {known}")]
    UnknownWord {
        /// What it should be.
        what: &'static str,
        /// The word given.
        name: String,
        /// The words there are.
        known: String,
    },
    /// A number for a field that has names.
    #[error("{field} is {value}; {allowed}")]
    BadChoice {
        /// The field.
        field: &'static str,
        /// The value given.
        value: i64,
        /// What it may be.
        allowed: &'static str,
    },
    /// A value of a field that the rest of the request gives no meaning.
    #[error("{field} is {value}; {allowed}")]
    NoMeaning {
        /// The field.
        field: &'static str,
        /// The value given.
        value: String,
        /// What it may be, and why.
        allowed: &'static str,
    },
    /// A value that the request's units cannot hold.
    #[error("{field}: {error}")]
    BadValue {
        /// The field.
        field: String,
        /// What is wrong with it.
        error: Box<UnitError>,
    },
    /// A parameter's value of the wrong type.
    #[error("{name} is `{value}`; {allowed} is expected")]
    BadParameter {
        /// The parameter.
        name: String,
        /// The value given.
        value: String,
        /// What it may be.
        allowed: String,
    },
    /// A parameter that others have.
    #[error("{name} is not there; it is for {allowed}")]
    NotApplicable {
        /// The parameter.
        name: String,
        /// Who has it.
        allowed: &'static str,
    },
    /// Something of a trajectory.
    #[error("{name} {value}; {allowed}")]
    BadTrajectory {
        /// What, by the fields of the request: `points[1].time`, or that of a joint.
        name: String,
        /// What it is or has.
        value: String,
        /// What it may be.
        allowed: String,
    },
    /// A set of setpoints without one.
    #[error("no axis is named; one or more, each with a velocity, are expected")]
    NoSetpoint,
    /// A name that stands twice where each axis stands once.
    #[error("axis `{name}` stands twice; once is allowed")]
    AxisTwice {
        /// The name.
        name: String,
    },
    /// A request that sets outputs or memory cells, without one.
    #[error("no {0} is named; one or more, each with a value, are expected")]
    SetsNothing(&'static str),
    /// A name that stands twice in such a request.
    #[error("{what} `{name}` stands twice; once is allowed")]
    SetTwice {
        /// What is set.
        what: &'static str,
        /// The name.
        name: String,
    },
    /// Something that this version does not have.
    #[error("{0} does not exist yet")]
    NotBuilt(String),
}
