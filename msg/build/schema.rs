//! Text of a type in a bag: schema encoding `ros2msg`.

use crate::interface::{Element, Interface, Kind, Section};

/// Returns the text of a section, then that of each message that it needs, after a line of 80 `=` and a line
/// `MSG: package/Type`.
pub(crate) fn schema(interfaces: &[Interface], section: &Section) -> String {
    let mut text = ended(&section.text);
    let mut needed: Vec<(&str, &str)> = Vec::new();
    collect(section, &mut needed);
    let mut done = 0;
    while let Some(&(package, name)) = needed.get(done) {
        done += 1;
        let found = interfaces.iter().find(|i| i.kind == Kind::Msg && i.package == package && i.name == name);
        if let Some(section) = found.and_then(|interface| interface.sections.first()) {
            text += &format!("{}\nMSG: {package}/{name}\n{}", "=".repeat(80), ended(&section.text));
            collect(section, &mut needed);
        }
    }
    text
}

/// Adds the messages that a section names, each once, in order of first mention.
fn collect<'a>(section: &'a Section, needed: &mut Vec<(&'a str, &'a str)>) {
    for field in &section.fields {
        if let Element::Message { package, name } = &field.element {
            let entry = (package.as_str(), name.as_str());
            if !needed.contains(&entry) {
                needed.push(entry);
            }
        }
    }
}

/// Returns the text without blank lines at its ends, closed by one line end; an empty text stays empty.
fn ended(text: &str) -> String {
    let text = text.trim();
    if text.is_empty() { String::new() } else { format!("{text}\n") }
}
