//! Reads key `joint` of an axis: its joint name in ROS 2.
//!
//! Rule     1 to 64 characters; no control characters, no line separators, no white space at the ends
//! Refuses  the joint name or the object name of another axis

use super::backends::Context;
use super::names::{Entry, Section, quote};
use crate::document::{Map, Place, Value};
use std::collections::BTreeMap;

/// Maximum length of a joint name, in characters.
const LONGEST: usize = 64;

/// Joint names that were given so far, with their axes and locations.
pub(super) type Taken<'d> = BTreeMap<&'d str, (&'d str, Place)>;

/// Returns the joint name of an axis: that of the key `joint`, otherwise the name of the axis.
pub(super) fn read<'d>(map: &mut Map<'d>, entry: &Entry<'d>, cx: &Context<'d>, taken: &mut Taken<'d>) -> &'d str {
    let own = entry.name();
    let Some(value) = map.optional("joint") else { return own };
    let Some(joint) = value.text() else { return own };
    if !is_joint_name(joint) {
        let allowed = "1 to 64 characters are allowed, without control characters, and without white space at the ends";
        value.refuse(format!("joint is {}; {allowed}", quote(joint)), None);
        return own;
    }
    let of_other = cx.names.section(Section::Axes).iter().find(|other| other.name() == joint && joint != own);
    if let Some(other) = of_other {
        refuse(&value, own, joint, &format!("the name of axis {}", other.quoted()), other.key.place());
    } else if let Some((other, place)) = taken.get(joint) {
        refuse(&value, own, joint, &format!("the joint of axis {} already", quote(other)), *place);
    } else {
        taken.insert(joint, (own, value.place()));
    }
    joint
}

fn refuse(value: &Value<'_>, axis: &str, joint: &str, what: &str, Place { line, col }: Place) {
    let sentence = format!("joint of axis {} is `{joint}`, which is {what}, at {line}:{col}", quote(axis));
    value.refuse(format!("{sentence}; each axis needs a joint name of its own"), None);
}

fn is_joint_name(text: &str) -> bool {
    let is_forbidden = |c: char| c.is_control() || matches!(c, '\u{2028}' | '\u{2029}');
    (1..=LONGEST).contains(&text.chars().count()) && text.trim() == text && !text.contains(is_forbidden)
}
