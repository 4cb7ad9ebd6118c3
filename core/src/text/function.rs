//! Messages about functions and tables.

use super::plain;
use crate::code::Code;
use crate::config::{Line, MachineConfig, SlotConfig};
use crate::event::{Event, Number};
use crate::function::{Field, LINES};
use crate::object::Object;
use crate::table::Form;

/// Returns the field of an event of a function.
fn field(event: &Event, config: &MachineConfig) -> Option<&'static Field> {
    let Object::Function(slot) = event.source else { return None };
    let slot = config.slots.get(usize::from(slot))?;
    slot.kind.description().fields.get(usize::from(event.parameter?))
}

/// Returns a message about a field: its name and the problem.
pub(super) fn of_field(event: &Event, config: &MachineConfig, text: String) -> String {
    match field(event, config) {
        Some(field) => format!("{}: {text}", field.name),
        None => text,
    }
}

/// Returns the message of a value outside the range of its field.
fn out_of_range(event: &Event, config: &MachineConfig) -> String {
    let Some(field) = field(event, config) else { return "a value is outside the range of its field".to_owned() };
    let nth = match event.limit {
        Number::Count(nth) if field.count > 1 => format!("[{nth}]"),
        _ => String::new(),
    };
    let unit = if field.unit.is_empty() { String::new() } else { format!(" (unit: {})", field.unit) };
    format!("{}{nth} is {}; {} to {} is allowed{unit}", field.name, plain(event.asked), field.min, field.max)
}

/// Returns the message of a value beyond a limit of the other fields: the side and the limit.
fn beyond(event: &Event, config: &MachineConfig) -> Option<String> {
    if let (Number::Time(call), Number::Time(bound)) = (event.asked, event.limit) {
        let side = if call < bound { "is below the minimum" } else { "exceeds the maximum" };
        let text = format!("{} between two calls {side} {}", plain(event.asked), plain(event.limit));
        return Some(of_field(event, config, text));
    }
    let (Number::Count(asked), Number::Count(bound)) = (event.asked, event.limit) else { return None };
    if field(event, config).is_some_and(|field| field.is_within_full_scale()) {
        let most = bound.saturating_abs();
        let text = format!("{asked} mV exceeds the full scale of the analog output; -{most} to {most} mV is allowed");
        return Some(of_field(event, config, text));
    }
    let side = if asked < bound { "is below the minimum" } else { "exceeds the maximum" };
    Some(of_field(event, config, format!("{asked} {side} {bound}")))
}

/// Returns the message of a mask with a bit of a missing axis: the bit, and the number of axes.
fn no_axis(event: &Event, config: &MachineConfig) -> Option<String> {
    let (Number::Count(mask), Number::Count(axes)) = (event.asked, event.limit) else { return None };
    let bit = (axes.max(0)..i64::from(i64::BITS)).find(|bit| mask >> bit & 1 == 1)?;
    let is = if axes == 1 { "1 axis".to_owned() } else { format!("{axes} axes") };
    Some(of_field(event, config, format!("{mask} has bit {bit} for axis {}; the cell has {is}", bit + 1)))
}

/// Returns the message of a mode that a type does not have, with the modes of the type.
fn no_mode(event: &Event, config: &MachineConfig) -> Option<String> {
    let Object::Function(place) = event.source else { return None };
    let slot = config.slots.get(usize::from(place))?;
    let modes: Vec<String> = slot.kind.modes().iter().map(i64::to_string).collect();
    let text = format!("no mode has number {}; {} are allowed", plain(event.asked), modes.join(", "));
    Some(of_field(event, config, text)).filter(|_| !modes.is_empty())
}

fn slot(number: Number, config: &MachineConfig) -> Option<&SlotConfig> {
    let Number::Count(slot) = number else { return None };
    config.slots.get(usize::try_from(slot).ok()?)
}

/// Returns true if a goal was ended by an error of the axis that its function moves.
pub(super) fn is_axis_error(event: &Event) -> bool {
    matches!(event.source, Object::Function(_)) && event.asked == Number::None
}

/// Returns the message of that error.
pub(super) fn axis_error(event: &Event) -> String {
    let cause = event.code.row().map_or("", |row| row.cause);
    format!("its axis has error {}: {cause}", event.code.0)
}

/// Returns the state of a function: whether it runs, and the outputs that are set.
pub(super) fn state(event: &Event, config: &MachineConfig) -> String {
    let (Number::Count(state), Object::Function(slot)) = (event.asked, event.source) else { return "?".to_owned() };
    let outputs = config.slots.get(usize::from(slot)).map_or(&[][..], |slot| &slot.outputs);
    let output = |place: usize| {
        let line = outputs.get(place).copied().flatten();
        let not = |line: Line| if line.inverted { "not " } else { "" };
        let name = line.map_or(String::new(), |line| format!(" ({}{})", not(line), config.name(line.object)));
        format!("A{}{name}", place + 1)
    };
    let set: Vec<String> = (0..LINES).filter(|place| state >> place & 1 == 1).map(output).collect();
    let set = if set.is_empty() { "no output set".to_owned() } else { format!("set: {}", set.join(", ")) };
    let runs = if state >> LINES & 1 == 1 { "active" } else { "at rest" };
    match event.limit {
        Number::Count(0) | Number::None => format!("{runs}, {set}"),
        left_out => format!("{runs}, {set}; changes before that were not told: {}", plain(left_out)),
    }
}

/// Returns the answer of a function to READ_VALUE; `None` for other objects.
pub(super) fn found(event: &Event, config: &MachineConfig) -> Option<String> {
    Some(format!("READ_VALUE: {} is {}", field(event, config)?.name, plain(event.asked)))
}

/// Returns the message of a table that a function reads.
fn uses_table(event: &Event, config: &MachineConfig) -> String {
    match slot(event.asked, config) {
        Some(slot) => {
            let (name, kind) = (&slot.name, slot.kind.name());
            format!("function {name} is started and reads it; type {kind} takes no new numbers before RESET")
        }
        None => "a started function reads it".to_owned(),
    }
}

/// Returns the message of an output that a function writes.
fn writes(event: &Event, config: &MachineConfig) -> String {
    let owner = slot(event.limit, config).map_or("a function", |slot| &slot.name);
    format!("{} may not be set, nor any value: function {owner} writes it", plain(event.asked))
}

/// Returns the message of a table of another form.
fn other_form(event: &Event) -> String {
    let name = |number| match number {
        Number::Count(form) => usize::try_from(form).ok().and_then(|form| Form::ALL.get(form)).map(|(_, name)| *name),
        _ => None,
    };
    match (name(event.asked), name(event.limit)) {
        (Some(asked), Some(has)) => format!("the numbers are of form {asked}; the table has form {has}"),
        _ => "the numbers are of another form than the table".to_owned(),
    }
}

/// Returns the message of a code that depends on the function or the table; `None` for other codes.
pub(super) fn reason(event: &Event, config: &MachineConfig) -> Option<String> {
    match event.code {
        Code::FUNCTION_RANGE => Some(out_of_range(event, config)),
        Code::AMK_BEYOND => beyond(event, config),
        Code::AMK_NO_MODE => no_mode(event, config),
        Code::AMK_NO_AXIS => no_axis(event, config),
        Code::FUNCTION_USES_TABLE => Some(uses_table(event, config)),
        Code::FUNCTION_WRITES => Some(writes(event, config)),
        Code::FUNCTION_TABLE_FORM => Some(other_form(event)),
        _ => None,
    }
}
