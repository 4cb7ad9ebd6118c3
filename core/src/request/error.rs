//! Errors of requests before they become commands.

use crate::unit::UnitError;

/// Error of a request before it becomes a command.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RequestError {
    /// An unknown axis.
    #[error("no axis is called `{name}`; there are {known}")]
    UnknownAxis {
        /// The given name.
        name: String,
        /// The known names.
        known: String,
    },
    /// An unknown leader.
    #[error("`{name}` cannot lead; {known} can")]
    UnknownLeader {
        /// The given name.
        name: String,
        /// The known names.
        known: String,
    },
    /// An unknown function.
    #[error("no function is called `{name}`; {known} are known")]
    UnknownFunction {
        /// The given name.
        name: String,
        /// The known names.
        known: String,
    },
    /// An unknown table.
    #[error("no table is called `{name}`; {known} are known")]
    UnknownTable {
        /// The given name.
        name: String,
        /// The known names.
        known: String,
    },
    /// An unknown program.
    #[error("no program is called `{name}`; {known} are known")]
    UnknownProgram {
        /// The given name.
        name: String,
        /// The known names.
        known: String,
    },
    /// An unknown field of a function.
    #[error("{function}: type {kind} has no field `{field}`; it has {known}")]
    UnknownField {
        /// Name of the function.
        function: String,
        /// Type of the function.
        kind: &'static str,
        /// The given name.
        field: String,
        /// The known names.
        known: String,
    },
    /// No value for a field, or too many.
    #[error("{function}: {given} values for {field}; 1 to {most} are possible")]
    FieldCount {
        /// Name of the function.
        function: String,
        /// Name of the field.
        field: String,
        /// Number of given values.
        given: usize,
        /// Maximum number of values.
        most: usize,
    },
    /// A value of a form that no field accepts.
    #[error("{function}: {sentence}")]
    FieldForm {
        /// Name of the function.
        function: String,
        /// Error message, with the name of the field.
        sentence: String,
    },
    /// Two values for the same place of a parameter set.
    #[error("{function}: {field} is given twice")]
    FieldTwice {
        /// Name of the function.
        function: String,
        /// Name of the field.
        field: String,
    },
    /// Numbers that form no valid table.
    #[error("{name}: {sentence}")]
    BadTable {
        /// Name of the table.
        name: String,
        /// Error message.
        sentence: String,
    },
    /// An invalid module of a program.
    #[error("{name}: {sentence}")]
    BadProgram {
        /// Name of the program.
        name: String,
        /// Error message.
        sentence: String,
    },
    /// An unknown latch.
    #[error("`{name}` does not latch; {known} can")]
    UnknownLatch {
        /// The given name.
        name: String,
        /// The known names.
        known: String,
    },
    /// An unknown parameter.
    #[error("no parameter is called `{name}`{hint}")]
    UnknownParameter {
        /// The given name.
        name: String,
        /// Suggestion of similar names.
        hint: String,
    },
    /// An unknown word of a vocabulary.
    #[error("no {what} is called `{name}`; there are {known}")]
    UnknownWord {
        /// Kind of the word.
        what: &'static str,
        /// The given word.
        name: String,
        /// The known words.
        known: String,
    },
    /// A number that none of the named values of a field has.
    #[error("{field} is {value}; {known} are allowed")]
    UnknownChoice {
        /// Name of the field.
        field: &'static str,
        /// The given number.
        value: u8,
        /// The known values with their numbers.
        known: String,
    },
    /// An invalid number for a field.
    #[error("{field} is {value}; {allowed}")]
    BadChoice {
        /// Name of the field.
        field: &'static str,
        /// The given value.
        value: i64,
        /// Allowed values.
        allowed: &'static str,
    },
    /// A value of a field that has no effect in this request.
    #[error("{field} is {value}; {allowed}")]
    NoMeaning {
        /// Name of the field.
        field: &'static str,
        /// The given value.
        value: String,
        /// Allowed value, and the reason.
        allowed: &'static str,
    },
    /// A value that cannot be converted from the units of the request.
    #[error("{field}: {error}")]
    BadValue {
        /// Name of the field.
        field: String,
        /// Error of the conversion.
        error: Box<UnitError>,
    },
    /// A parameter value of the wrong type.
    #[error("{name} is `{value}`; {allowed} is expected")]
    BadParameter {
        /// Name of the parameter.
        name: String,
        /// The given value.
        value: String,
        /// Allowed values.
        allowed: String,
    },
    /// A parameter that the axis does not have.
    #[error("{name} is not there; it is for {allowed}")]
    NotApplicable {
        /// Name of the parameter.
        name: String,
        /// Axes that have it.
        allowed: &'static str,
    },
    /// Invalid part of a trajectory.
    #[error("{name} {value}; {allowed}")]
    BadTrajectory {
        /// Field of the request: `points[1].time`, or that of a joint.
        name: String,
        /// Its value or content.
        value: String,
        /// Allowed values.
        allowed: String,
    },
    /// A set of setpoints without any setpoint.
    #[error("no axis is named; one or more, each with a velocity, are expected")]
    NoSetpoint,
    /// An axis that is named twice.
    #[error("axis `{name}` stands twice; once is allowed")]
    AxisTwice {
        /// The name.
        name: String,
    },
    /// A request to set outputs or memory cells that names none.
    #[error("no {0} is named; one or more, each with a value, are expected")]
    SetsNothing(&'static str),
    /// A name that such a request contains twice.
    #[error("{what} `{name}` stands twice; once is allowed")]
    SetTwice {
        /// Kind of the object.
        what: &'static str,
        /// The name.
        name: String,
    },
    /// A feature that this version does not have.
    #[error("{0} does not exist yet")]
    NotBuilt(String),
}
