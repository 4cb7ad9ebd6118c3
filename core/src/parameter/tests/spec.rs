//! Documents of the specification, for the tests.

/// MACS.
pub(super) const MACS: &str = include_str!("../../../../docs/spec/macs.md");
/// Unidrive AMC.
pub(super) const AMC: &str = include_str!("../../../../docs/spec/amc.md");
/// SAIA PCD4.H3.
pub(super) const SAIA: &str = include_str!("../../../../docs/spec/saia-h3.md");
/// Siemens WF 725 / 726.
pub(super) const WF: &str = include_str!("../../../../docs/spec/wf725.md");
/// Requirements that were set aside.
pub(super) const SET_ASIDE: &str = include_str!("../../../../docs/spec/not-applicable.md");

/// Returns the lines of the first table below a heading, without the head of the table.
pub(super) fn table(text: &'static str, heading: &str) -> Vec<&'static str> {
    let start = text.find(heading).unwrap_or_else(|| panic!("no {heading}"));
    let lines = text[start..].lines().skip_while(|line| !line.starts_with('|'));
    lines.take_while(|line| line.starts_with('|')).skip(2).collect()
}

/// Returns the cells of a line; a `|` inside a cell is escaped.
pub(super) fn cells(line: &'static str) -> Vec<&'static str> {
    let mut cells = Vec::new();
    let mut start = 1;
    let bytes = line.as_bytes();
    for place in 1..bytes.len() {
        if bytes[place] == b'|' && bytes[place - 1] != b'\\' {
            cells.push(line[start..place].trim());
            start = place + 1;
        }
    }
    cells
}

/// Returns the table lines that begin with such a requirement.
pub(super) fn requirements(text: &'static str, start: &str) -> Vec<Vec<&'static str>> {
    let is_one = |line: &&str| line.strip_prefix("| ").is_some_and(|line| line.starts_with(start));
    text.lines().filter(is_one).map(cells).collect()
}
