//! Generates the Rust types of the interfaces.

use std::fmt::Write as _;

use crate::files::OWN;
use crate::hash::Hashes;
use crate::interface::{Constant, DUMMY_FIELD, Element, Field, Interface, Kind, Section, Shape};
use crate::schema::schema;

/// Returns the source of all modules: `msg`, `srv`, `action` of this package and `foreign` with those of the others.
pub(crate) fn generate(interfaces: &[Interface], hashes: &Hashes) -> String {
    let mut out = package(interfaces, hashes, OWN);
    out += "/// Interfaces of other packages that the node speaks, one module per package.\npub mod foreign {\n";
    let mut packages: Vec<&str> = interfaces.iter().map(|interface| interface.package.as_str()).collect();
    packages.dedup();
    for name in packages.into_iter().filter(|name| *name != OWN) {
        let package = package(interfaces, hashes, name);
        out += &format!("/// Interfaces of the package `{name}`.\npub mod {name} {{\n{package}}}\n");
    }
    out += "}\n";
    out + &about(interfaces) + &list(interfaces) + &all_hashes(hashes)
}

/// Returns the interfaces of this package as data for documentation, with their comments.
fn about(interfaces: &[Interface]) -> String {
    let mut out = "/// The interfaces of this package, with what their files say about them.\n\
                   pub const INTERFACES: &[about::Interface] = &[\n"
        .to_owned();
    for interface in interfaces.iter().filter(|interface| interface.package == OWN) {
        let Interface { package, kind, name, .. } = interface;
        out += &format!("about::Interface {{ name: \"{package}/{}/{name}\", sections: &[\n", kind.name());
        for (section, name) in interface.sections.iter().zip(interface.kind.sections()) {
            out += &format!("about::Section {{ name: {name:?}, doc: {:?}, constants: &[\n", joined(&section.doc));
            for Constant { doc, primitive, name, value } in &section.constants {
                let (kind, doc) = (primitive.name, joined(doc));
                out +=
                    &format!("about::Constant {{ kind: {kind:?}, name: {name:?}, value: {value}, doc: {doc:?} }},\n");
            }
            out += "], fields: &[\n";
            for Field { doc, type_text: kind, name, .. } in &section.fields {
                out += &format!("about::Field {{ kind: {kind:?}, name: {name:?}, doc: {:?} }},\n", joined(doc));
            }
            out += "] },\n";
        }
        out += "] },\n";
    }
    out + "];\n"
}

/// Joins comment lines to one text; an empty line begins a new paragraph.
fn joined(lines: &[String]) -> String {
    let paragraphs: Vec<String> = lines.split(String::is_empty).map(|lines| lines.join(" ")).collect();
    paragraphs.join("\n\n")
}

/// Returns a macro that calls another one with every message struct, for tests that hold for all of them.
fn list(interfaces: &[Interface]) -> String {
    let mut out = "#[cfg(test)]\nmacro_rules! for_every_struct { ($call:ident) => {\n".to_owned();
    for interface in interfaces {
        for suffix in interface.kind.sections() {
            out += &format!("$call!({}::{}{suffix});\n", module(&interface.package, interface.kind), interface.name);
        }
    }
    out + "} }\n"
}

/// Returns the hashes of all types, for the tests that compare them with those of ROS 2.
fn all_hashes(hashes: &Hashes) -> String {
    let mut out = "#[cfg(test)]\nconst TYPE_HASHES: &[(&str, &str)] = &[\n".to_owned();
    for (name, hash) in hashes {
        out += &format!("({name:?}, {hash:?}),\n");
    }
    out + "];\n"
}

/// Returns a constant with the hash of the type `name`.
fn hash_constant(hashes: &Hashes, constant: &str, name: &str) -> String {
    let hash = hashes.get(name).expect("every type of the files has a hash");
    format!("const {constant}: &'static str = {hash:?};\n")
}

fn package(interfaces: &[Interface], hashes: &Hashes, package: &str) -> String {
    let mut out = String::new();
    for kind in Kind::ALL {
        let mut members = interfaces.iter().filter(|i| i.package == package && i.kind == kind).peekable();
        if members.peek().is_none() {
            continue;
        }
        let what = match kind {
            Kind::Msg => "Messages",
            Kind::Srv => "Services",
            Kind::Action => "Actions",
        };
        out += &format!("/// {what} of the package `{package}`.\npub mod {} {{\n", kind.name());
        members.for_each(|interface| out += &self::interface(interfaces, hashes, interface));
        out += "}\n";
    }
    out
}

fn interface(interfaces: &[Interface], hashes: &Hashes, interface: &Interface) -> String {
    let mut out = match interface.kind {
        Kind::Msg => String::new(),
        Kind::Srv => service(hashes, interface),
        Kind::Action => action(hashes, interface),
    };
    for (section, suffix) in interface.sections.iter().zip(interface.kind.sections()) {
        out += &structure(interfaces, hashes, interface, section, suffix);
    }
    out
}

fn structure(
    interfaces: &[Interface],
    hashes: &Hashes,
    interface: &Interface,
    section: &Section,
    suffix: &str,
) -> String {
    let Interface { package, kind, name, .. } = interface;
    let kind = kind.name();
    let separator = if suffix.is_empty() { "" } else { "_" };
    let ros_name = format!("{package}/{kind}/{name}{separator}{suffix}");
    let mut out = doc(&section.doc, &format!("{suffix} of [`{name}`]."));
    // The serde name is the name of the type in decoding errors.
    out += "#[derive(Clone, Debug, Default, PartialEq, ::serde::Serialize, ::serde::Deserialize)]\n";
    out += &format!("#[serde(rename = \"{ros_name}\")]\npub struct {name}{suffix} {{\n");
    for field in &section.fields {
        out += &doc(&field.doc, "");
        // A name in ROS 2 may be a keyword in Rust (`type`); its raw form is the same name.
        out += &format!("pub r#{}: {},\n", field.name, rust_type(field));
    }
    if section.fields.is_empty() {
        out += &format!(
            "/// Takes one byte on the wire, where an empty struct cannot be; its value has no meaning.\n\
             pub {DUMMY_FIELD}: u8,\n"
        );
    }
    out += "}\n";
    if !section.constants.is_empty() {
        out += &format!("impl {name}{suffix} {{\n");
        for constant in &section.constants {
            out += &doc(&constant.doc, "");
            out += &format!("pub const {}: {} = {};\n", constant.name, constant.primitive.rust, constant.value);
        }
        out += "}\n";
    }
    out += &format!("impl crate::Message for {name}{suffix} {{\nconst NAME: &'static str = \"{ros_name}\";\n");
    out += &hash_constant(hashes, "HASH", &ros_name);
    out += &format!("const SCHEMA: &'static str = {:?};\n}}\n", schema(interfaces, section));
    out
}

fn service(hashes: &Hashes, interface: &Interface) -> String {
    let Interface { package, name, sections, .. } = interface;
    let mut out = doc(sections.first().map_or(&[], |section| &section.doc), &format!("Service {name}."));
    out += &format!(
        "#[derive(Clone, Copy, Debug)]\npub enum {name} {{}}\nimpl crate::Service for {name} {{\n\
         type Request = {name}Request;\ntype Response = {name}Response;\n\
         const NAME: &'static str = \"{package}/srv/{name}\";\n"
    );
    let ros_name = format!("{package}/srv/{name}");
    out += &hash_constant(hashes, "HASH", &ros_name);
    for part in ["Request", "Response"] {
        let constant = part.to_uppercase();
        out += &hash_constant(hashes, &format!("{constant}_HASH"), &format!("{ros_name}_{part}"));
    }
    out + "}\n"
}

fn action(hashes: &Hashes, interface: &Interface) -> String {
    let Interface { package, name, sections, .. } = interface;
    let mut out = doc(sections.first().map_or(&[], |section| &section.doc), &format!("Action {name}."));
    out += &format!(
        "#[derive(Clone, Copy, Debug)]\npub enum {name} {{}}\nimpl crate::Action for {name} {{\n\
         type Goal = {name}Goal;\ntype Result = {name}Result;\ntype Feedback = {name}Feedback;\n\
         const NAME: &'static str = \"{package}/action/{name}\";\n"
    );
    let ros_name = format!("{package}/action/{name}");
    out += &hash_constant(hashes, "HASH", &ros_name);
    for service in ["SendGoal", "GetResult"] {
        let constant = if service == "SendGoal" { "SEND_GOAL" } else { "GET_RESULT" };
        out += &format!("const {constant}_NAME: &'static str = \"{package}/action/{name}_{service}\";\n");
        out += &hash_constant(hashes, &format!("{constant}_HASH"), &format!("{ros_name}_{service}"));
        for part in ["Request", "Response"] {
            let upper = part.to_uppercase();
            let hashed = format!("{ros_name}_{service}_{part}");
            out += &hash_constant(hashes, &format!("{constant}_{upper}_HASH"), &hashed);
        }
    }
    out += &hash_constant(hashes, "FEEDBACK_MESSAGE_HASH", &format!("{ros_name}_FeedbackMessage"));
    out + "}\n"
}

fn rust_type(field: &Field) -> String {
    let element = match &field.element {
        Element::Primitive(primitive) => primitive.rust.to_owned(),
        Element::Text(None) => "::std::string::String".to_owned(),
        Element::Text(Some(bound)) => format!("crate::Bounded<::std::string::String, {bound}>"),
        Element::Message { package, name } => format!("{}::{name}", module(package, Kind::Msg)),
    };
    match field.shape {
        Shape::One => element,
        Shape::Array(length) => format!("[{element}; {length}]"),
        Shape::Sequence => format!("::std::vec::Vec<{element}>"),
        Shape::Bounded(bound) => format!("crate::Bounded<::std::vec::Vec<{element}>, {bound}>"),
    }
}

fn module(package: &str, kind: Kind) -> String {
    let kind = kind.name();
    if package == OWN { format!("crate::{kind}") } else { format!("crate::foreign::{package}::{kind}") }
}

/// Returns comment lines as documentation.
fn doc(lines: &[String], otherwise: &str) -> String {
    let mut out = String::new();
    for line in lines {
        let _ = writeln!(out, "/// {}", escaped(line));
    }
    if lines.is_empty() {
        let _ = writeln!(out, "/// {otherwise}");
    }
    out
}

/// Units in brackets must not become links, and `~/name` must not strike text out; text in back quotes is code already.
fn escaped(line: &str) -> String {
    let mut out = String::new();
    let mut code = false;
    for c in line.chars() {
        code ^= c == '`';
        if !code && "[]<>*~".contains(c) {
            out.push('\\');
        }
        out.push(c);
    }
    out
}
