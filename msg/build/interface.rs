//! Contents of an interface file, as data.

use std::fmt;

/// The three kinds of interface files, which are also folder names, file extensions and parts of type names.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Kind {
    Msg,
    Srv,
    Action,
}

impl Kind {
    pub(crate) const ALL: [Self; 3] = [Self::Msg, Self::Srv, Self::Action];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Msg => "msg",
            Self::Srv => "srv",
            Self::Action => "action",
        }
    }

    /// Returns the names of the sections between the `---`; a file must have exactly these sections.
    pub(crate) fn sections(self) -> &'static [&'static str] {
        match self {
            Self::Msg => &[""],
            Self::Srv => &["Request", "Response"],
            Self::Action => &["Goal", "Result", "Feedback"],
        }
    }
}

/// One interface file.
#[derive(Clone, Debug)]
pub(crate) struct Interface {
    pub(crate) package: String,
    pub(crate) kind: Kind,
    /// Name, as in the file name: `AxisState`.
    pub(crate) name: String,
    pub(crate) sections: Vec<Section>,
}

/// One struct of an interface file: a whole .msg, a part of the others.
#[derive(Clone, Debug, Default)]
pub(crate) struct Section {
    /// Comment block at its head.
    pub(crate) doc: Vec<String>,
    pub(crate) constants: Vec<Constant>,
    pub(crate) fields: Vec<Field>,
    /// Its lines as in the file.
    pub(crate) text: String,
}

#[derive(Clone, Debug)]
pub(crate) struct Constant {
    pub(crate) doc: Vec<String>,
    pub(crate) primitive: Primitive,
    pub(crate) name: String,
    pub(crate) value: i128,
}

#[derive(Clone, Debug)]
pub(crate) struct Field {
    pub(crate) doc: Vec<String>,
    /// Its type as in the file.
    pub(crate) type_text: String,
    pub(crate) element: Element,
    pub(crate) shape: Shape,
    pub(crate) name: String,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Element {
    Primitive(Primitive),
    /// `string`, or `string<=N`.
    Text(Option<usize>),
    /// A message of a package.
    Message {
        package: String,
        name: String,
    },
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Shape {
    One,
    /// `[N]`
    Array(usize),
    /// `[]`
    Sequence,
    /// `[<=N]`
    Bounded(usize),
}

/// Field that ROS 2 adds to a struct without fields: one byte on the wire.
pub(crate) const DUMMY_FIELD: &str = "structure_needs_at_least_one_member";

/// A type of fixed size: its name in the files, its number in type descriptions, its Rust type, and its range of whole
/// numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Primitive {
    pub(crate) name: &'static str,
    /// Its constant in type_description_interfaces/msg/FieldType. `char` has that of `uint8`.
    pub(crate) description_id: u8,
    pub(crate) rust: &'static str,
    /// `None`: no integer, so it has no constants.
    pub(crate) range: Option<(i128, i128)>,
}

impl Primitive {
    const fn integer(name: &'static str, description_id: u8, rust: &'static str, low: i128, high: i128) -> Self {
        Self { name, description_id, rust, range: Some((low, high)) }
    }

    const fn other(name: &'static str, description_id: u8, rust: &'static str) -> Self {
        Self { name, description_id, rust, range: None }
    }

    pub(crate) const ALL: [Self; 13] = [
        Self::other("bool", 15, "bool"),
        Self::integer("byte", 16, "u8", 0, u8::MAX as i128),
        Self::integer("char", 3, "u8", 0, u8::MAX as i128),
        Self::integer("int8", 2, "i8", i8::MIN as i128, i8::MAX as i128),
        Self::integer("uint8", 3, "u8", 0, u8::MAX as i128),
        Self::integer("int16", 4, "i16", i16::MIN as i128, i16::MAX as i128),
        Self::integer("uint16", 5, "u16", 0, u16::MAX as i128),
        Self::integer("int32", 6, "i32", i32::MIN as i128, i32::MAX as i128),
        Self::integer("uint32", 7, "u32", 0, u32::MAX as i128),
        Self::integer("int64", 8, "i64", i64::MIN as i128, i64::MAX as i128),
        Self::integer("uint64", 9, "u64", 0, u64::MAX as i128),
        Self::other("float32", 10, "f32"),
        Self::other("float64", 11, "f64"),
    ];

    pub(crate) fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|primitive| primitive.name == name)
    }
}

#[cfg(test)]
impl Field {
    /// Returns the type as in a file, with the package before the name of a message.
    pub(crate) fn type_text(&self) -> String {
        let shape = match self.shape {
            Shape::One => String::new(),
            Shape::Array(length) => format!("[{length}]"),
            Shape::Sequence => "[]".to_owned(),
            Shape::Bounded(length) => format!("[<={length}]"),
        };
        format!("{}{shape}", self.element)
    }
}

impl fmt::Display for Element {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Primitive(primitive) => f.write_str(primitive.name),
            Self::Text(None) => f.write_str("string"),
            Self::Text(Some(length)) => write!(f, "string<={length}"),
            Self::Message { package, name } => write!(f, "{package}/{name}"),
        }
    }
}
