//! What the interface files of this package say, as data: for who describes them to people.

/// One interface file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Interface {
    /// Its name in ROS 2, as `lineshaft_msgs/msg/AxisState`.
    pub name: &'static str,
    /// The whole of a message; request and response; goal, result and feedback.
    pub sections: &'static [Section],
}

/// One part of an interface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Section {
    /// `Request`, `Goal`..; empty for a message.
    pub name: &'static str,
    /// What it is for; paragraphs are parted by an empty line.
    pub doc: &'static str,
    /// In the order of the file.
    pub constants: &'static [Constant],
    /// In the order of the file, which is that of the wire.
    pub fields: &'static [Field],
}

/// A constant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Constant {
    /// Its type.
    pub kind: &'static str,
    /// Its name.
    pub name: &'static str,
    /// Its value.
    pub value: i128,
    /// What it means.
    pub doc: &'static str,
}

/// A field.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Field {
    /// Its type, as it stands in the file.
    pub kind: &'static str,
    /// Its name.
    pub name: &'static str,
    /// What it means, with unit and range.
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
