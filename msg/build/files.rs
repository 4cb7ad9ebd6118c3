//! Finds and reads the interface files of the package, and checks that they are consistent.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use crate::interface::{Element, Interface, Kind};
use crate::parse::parse;

/// Name of this package.
pub(crate) const OWN: &str = "lineshaft_msgs";
/// Folder of the interfaces of other packages, one folder each.
pub(crate) const FOREIGN: &str = "foreign";

/// Reads every interface below `root`, ordered by package, kind and name.
pub(crate) fn read_all(root: &Path) -> Result<Vec<Interface>, String> {
    let mut interfaces = read_package(root, OWN)?;
    for package in names_in(&root.join(FOREIGN))? {
        interfaces.extend(read_package(&root.join(FOREIGN).join(&package), &package)?);
    }
    interfaces.sort_by(|a, b| (&a.package, a.kind, &a.name).cmp(&(&b.package, b.kind, &b.name)));
    check_references(&interfaces)?;
    Ok(interfaces)
}

fn read_package(folder: &Path, package: &str) -> Result<Vec<Interface>, String> {
    let mut interfaces = Vec::new();
    for kind in Kind::ALL {
        let folder = folder.join(kind.name());
        if !folder.is_dir() {
            continue;
        }
        for file in names_in(&folder)? {
            let path = folder.join(&file);
            let shown = path.display();
            let name = file
                .strip_suffix(&format!(".{}", kind.name()))
                .ok_or_else(|| format!("{shown}: only .{} files belong here", kind.name()))?;
            let text = fs::read_to_string(&path).map_err(|error| format!("{shown}: {error}"))?;
            let interface = parse(package, kind, name, &text)
                .map_err(|refusal| format!("{shown}:{}: {}", refusal.line, refusal.reason))?;
            interfaces.push(interface);
        }
    }
    Ok(interfaces)
}

fn names_in(folder: &Path) -> Result<Vec<String>, String> {
    let shown = folder.display();
    let mut names = Vec::new();
    for entry in fs::read_dir(folder).map_err(|error| format!("{shown}: {error}"))? {
        let entry = entry.map_err(|error| format!("{shown}: {error}"))?;
        names.push(entry.file_name().into_string().map_err(|name| format!("{shown}: {name:?} is no UTF-8"))?);
    }
    names.sort();
    Ok(names)
}

/// Checks that every message exists that a field names.
fn check_references(interfaces: &[Interface]) -> Result<(), String> {
    let known: BTreeSet<(&str, &str)> = interfaces
        .iter()
        .filter(|interface| interface.kind == Kind::Msg)
        .map(|interface| (interface.package.as_str(), interface.name.as_str()))
        .collect();
    for interface in interfaces {
        for field in interface.sections.iter().flat_map(|section| &section.fields) {
            if let Element::Message { package, name } = &field.element
                && !known.contains(&(package.as_str(), name.as_str()))
            {
                let Interface { package: user, kind, name: file, .. } = interface;
                return Err(format!(
                    "{user}/{}/{file}, field {}: no file for {package}/{name}",
                    kind.name(),
                    field.name
                ));
            }
        }
    }
    Ok(())
}
