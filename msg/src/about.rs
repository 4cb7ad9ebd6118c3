//! Contents of the interface files of this package, as data for documentation.

/// One interface file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Interface {
    /// Name in ROS 2, such as `lineshaft_msgs/msg/AxisState`.
    pub name: &'static str,
    /// Sections: the whole message; request and response; goal, result and feedback.
    pub sections: &'static [Section],
}

/// One section of an interface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Section {
    /// `Request`, `Goal`..; empty for a message.
    pub name: &'static str,
    /// Description; paragraphs are separated by an empty line.
    pub doc: &'static str,
    /// Constants, in the order of the file.
    pub constants: &'static [Constant],
    /// Fields, in the order of the file and of the wire.
    pub fields: &'static [Field],
}

/// A constant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Constant {
    /// Type.
    pub kind: &'static str,
    /// Name.
    pub name: &'static str,
    /// Value.
    pub value: i128,
    /// Description.
    pub doc: &'static str,
}

/// A field.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Field {
    /// Type, as in the file.
    pub kind: &'static str,
    /// Name.
    pub name: &'static str,
    /// Description, with unit and range.
    pub doc: &'static str,
}

#[cfg(test)]
mod tests {
    use crate::INTERFACES;

    #[test]
    fn what_a_file_says_about_a_field_is_there() {
        let interface = INTERFACES.iter().find(|interface| interface.name == "lineshaft_msgs/action/MoveAxis").unwrap();
        let parts: Vec<_> = interface.sections.iter().map(|section| section.name).collect();
        assert_eq!(parts, ["Goal", "Result", "Feedback"]);
        let goal = &interface.sections[0];
        assert!(goal.doc.starts_with("Moves one axis, on ~/move_axis;") && goal.doc.contains("\n\nA quantity 0 means"));
        let mode = goal.constants.iter().find(|constant| constant.name == "ADDITIVE").unwrap();
        assert_eq!((mode.kind, mode.value, mode.doc), ("uint8", 2, "By a distance from the present target."));
        let jerk = goal.fields.iter().find(|field| field.name == "jerk").unwrap();
        let doc = "Jerk [units/s^3], > 0, 0 = default_jerk; for profile jerk.";
        assert_eq!((jerk.kind, jerk.doc), ("float64", doc));
        let state = INTERFACES.iter().find(|interface| interface.name == "lineshaft_msgs/msg/AxisStates").unwrap();
        assert_eq!(state.sections[0].fields[2].kind, "AxisState[]");
    }
}
