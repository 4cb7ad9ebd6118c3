//! Summary of a run in a few lines.

mod fields;

use super::clean::clean;
use super::inputs;
use super::run::{Run, RunError, grouped};
use super::series::{SeriesError, refused};
use lineshaft_msgs::Message as _;
use lineshaft_msgs::msg::CycleInputs;
use std::collections::BTreeMap;
use std::fmt;

/// Maximum number of topics that are listed.
const MAX_TOPICS: usize = 1000;
/// Maximum number of attachment names that are listed.
const MAX_ATTACHMENTS: usize = 100;

/// Content of a run. Its text is for people.
#[derive(Debug)]
pub struct Info {
    files: Vec<(String, u64)>,
    profile: String,
    /// Time of the first and of the last message, in ns.
    span: Option<(u64, u64)>,
    /// Number of messages, by topic, type and encoding.
    topics: BTreeMap<[String; 3], u64>,
    /// Metadata `lineshaft`.
    lineshaft: Option<BTreeMap<String, String>>,
    /// File, name and size in bytes.
    attachments: Vec<(usize, String, u64)>,
    cycles: Cycles,
    /// Lost cycles, and whether the recorder reports that the run can be replayed; `None` unless all files were
    /// finished.
    end: Option<End>,
    cuts: Vec<String>,
    /// Whether all files belong to one run.
    is_one_run: bool,
    error: Option<SeriesError>,
}

/// Cycle numbers of the inputs.
#[derive(Clone, Copy, Debug, Default)]
struct Cycles {
    first_and_last: Option<(u64, u64)>,
    missing: u64,
    /// Whether a cycle is not after the previous one.
    is_mixed: bool,
}

/// Report of the recorder at the end.
#[derive(Clone, Copy, Debug)]
struct End {
    lost: u64,
    replayable: bool,
}

impl Info {
    /// Reads a run to its end, or to the first damage.
    pub fn of(run: &mut Run) -> Self {
        let files: Vec<(String, u64)> = run.files().iter().map(|file| (file.name.clone(), file.bytes)).collect();
        let attachments = run.files().iter().enumerate().flat_map(|(place, file)| {
            file.attachments.iter().map(move |attachment| (place, attachment.name.clone(), attachment.bytes))
        });
        let mut info = Self {
            profile: run.files().first().map_or_else(String::new, |file| file.profile.clone()),
            span: None,
            topics: BTreeMap::new(),
            lineshaft: run.metadata("lineshaft").cloned(),
            attachments: attachments.collect(),
            cycles: Cycles::default(),
            end: end(run),
            cuts: run.cuts().map(ToString::to_string).collect(),
            is_one_run: run.is_of_one_cell(),
            error: None,
            files,
        };
        info.error = info.count(run).err();
        info
    }

    /// Returns the defect of the run, if any. The other fields then describe the part before it.
    pub fn error(&self) -> Option<&SeriesError> {
        self.error.as_ref()
    }

    /// Checks whether the run can be replayed.
    ///
    /// # Errors
    /// Returns the reason why not, as a part of a sentence.
    pub fn replayable(&self) -> Result<(), String> {
        let has = |name: &str| self.attachments.iter().any(|(_, attached, _)| attached == name);
        let has_state = self.attachments.iter().any(|(file, attached, _)| *file == 0 && attached == "machine_state");
        if !self.is_one_run {
            return Err("its files were not recorded with the same cell".to_owned());
        }
        if self.lineshaft.is_none() {
            return Err("it was not recorded by lineshaft".to_owned());
        }
        if !has("cell.yaml") {
            return Err("no cell is attached".to_owned());
        }
        let Some((first, _)) = self.cycles.first_and_last else {
            return Err("it holds no inputs".to_owned());
        };
        if self.error.is_some() {
            return Err("it is damaged".to_owned());
        }
        if self.cycles.is_mixed {
            return Err("its cycles do not follow one another".to_owned());
        }
        if first > 0 && !has_state {
            return Err(format!("it begins with cycle {first}, and the machine's state there is not attached"));
        }
        match (self.lost(), self.end) {
            (0, Some(End { replayable: false, .. })) => Err("its recorder says so".to_owned()),
            (0, _) => Ok(()),
            (1, _) => Err("1 cycle is lost".to_owned()),
            (lost, _) => Err(format!("{} cycles are lost", grouped(lost))),
        }
    }

    /// Returns a line for each name, with its size and number of files.
    fn attachment_lines(&self) -> Vec<String> {
        let mut names: Vec<(&str, u64, u64, usize)> = Vec::new();
        let mut more = 0_u64;
        for (_, name, bytes) in &self.attachments {
            let has_room = names.len() < MAX_ATTACHMENTS;
            match names.iter_mut().find(|(known, ..)| known == name) {
                Some((_, least, most, count)) => {
                    (*least, *most, *count) = ((*least).min(*bytes), (*most).max(*bytes), *count + 1);
                }
                None if has_room => names.push((name, *bytes, *bytes, 1)),
                None => more += 1,
            }
        }
        let lines = names.into_iter().map(|(name, least, most, count)| {
            let size = if least == most { size(least) } else { format!("{} to {}", size(least), size(most)) };
            if count == 1 { format!("{name}, {size}") } else { format!("{name}, {size}, {count} times") }
        });
        lines.chain((more > 0).then(|| format!("and {more} more"))).collect()
    }

    fn lost(&self) -> u64 {
        self.cycles.missing.max(self.end.map_or(0, |end| end.lost))
    }

    fn count(&mut self, run: &mut Run) -> Result<(), SeriesError> {
        run.rewind();
        let mut counts: BTreeMap<String, BTreeMap<String, BTreeMap<String, u64>>> = BTreeMap::new();
        let result = loop {
            let message = match run.next_message() {
                Ok(Some(message)) => message,
                Ok(None) => break Ok(()),
                Err(error) => break Err(RunError::into(error)),
            };
            let (first, last) = self.span.unwrap_or((message.log_time, message.log_time));
            self.span = Some((first.min(message.log_time), last.max(message.log_time)));
            // Each name is copied once, not for every message.
            let known = counts.get_mut(message.topic).and_then(|kinds| kinds.get_mut(message.kind));
            match known.and_then(|encodings| encodings.get_mut(message.encoding)) {
                Some(count) => *count += 1,
                None => {
                    let kinds = counts.entry(message.topic.to_owned()).or_default();
                    kinds.entry(message.kind.to_owned()).or_default().insert(message.encoding.to_owned(), 1);
                }
            }
            if message.kind == CycleInputs::NAME && message.is_cdr() {
                match inputs::decode(&message) {
                    Ok(inputs) => self.cycles.take(inputs.cycle),
                    Err(reason) => break Err(refused(&message, &self.files[message.file].0, reason)),
                }
            }
        };
        for (topic, kinds) in counts {
            for (kind, encodings) in kinds {
                let each = encodings.into_iter();
                self.topics.extend(each.map(|(encoding, count)| ([topic.clone(), kind.clone(), encoding], count)));
            }
        }
        result
    }
}

impl Cycles {
    fn take(&mut self, cycle: u64) {
        match &mut self.first_and_last {
            None => self.first_and_last = Some((cycle, cycle)),
            Some((_, last)) if cycle > *last => {
                self.missing += cycle - *last - 1;
                *last = cycle;
            }
            Some(_) => self.is_mixed = true,
        }
    }
}

/// Returns the report of the recorder over all files, or `None` if one of them was not finished.
fn end(run: &Run) -> Option<End> {
    let mut end = End { lost: 0, replayable: true };
    for file in run.files() {
        let (_, map) = file.metadata.iter().find(|(name, _)| name == "lineshaft_end")?;
        let lost: u64 = map.get("lost").and_then(|lost| lost.parse().ok()).unwrap_or(0);
        end.lost = end.lost.saturating_add(lost);
        end.replayable &= map.get("replayable").is_none_or(|replayable| replayable == "true");
    }
    Some(end)
}

impl fmt::Display for Info {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names = self.files.iter().map(|(name, _)| name.clone());
        rows(f, "Files", names)?;
        row(f, "Bag size", &size(self.files.iter().map(|(_, bytes)| bytes).sum()))?;
        let profile = if self.profile.is_empty() { String::new() } else { format!(", profile {}", self.profile) };
        row(f, "Storage id", &format!("mcap{profile}"))?;
        if let Some((start, end)) = self.span {
            row(f, "Duration", &format!("{} s", decimal_seconds(end - start)))?;
            row(f, "Start", &utc(start))?;
            row(f, "End", &utc(end))?;
        }
        row(f, "Messages", &self.topics.values().sum::<u64>().to_string())?;
        let topics = self.topics.iter().take(MAX_TOPICS).map(|([topic, kind, encoding], count)| {
            format!("Topic: {topic} | Type: {kind} | Count: {count} | Serialization Format: {encoding}")
        });
        let more = self.topics.len().saturating_sub(MAX_TOPICS);
        rows(f, "Topic information", topics.chain((more > 0).then(|| format!("and {more} more"))))?;
        if let Some(lineshaft) = &self.lineshaft {
            rows(f, "Lineshaft", lineshaft.iter().map(|(key, value)| format!("{key}: {value}")))?;
        }
        rows(f, "Attachments", self.attachment_lines().into_iter())?;
        if let Some((first, last)) = self.cycles.first_and_last {
            row(f, "Cycles", &format!("{first} to {last}, {} lost", self.lost()))?;
        }
        let replayable = match self.replayable() {
            Err(reason) => format!("no, {reason}"),
            Ok(()) if self.end.is_none() => "yes, but its recording was not finished".to_owned(),
            Ok(()) => "yes".to_owned(),
        };
        row(f, "Replayable", &replayable)?;
        let last =
            self.cycles.first_and_last.map_or_else(String::new, |(_, last)| format!("; the last cycle is {last}"));
        let end = self.cuts.len().checked_sub(1);
        rows(
            f,
            "Cut",
            self.cuts.iter().enumerate().map(|(place, cut)| {
                // Even if cycles are lost, the last cycle of the run is in the last file.
                if Some(place) == end { format!("{cut}{last}") } else { cut.clone() }
            }),
        )
    }
}

const WIDTH: usize = 19;

fn row(f: &mut fmt::Formatter<'_>, name: &str, text: &str) -> fmt::Result {
    writeln!(f, "{:WIDTH$}{}", format!("{name}:"), clean(text))
}

/// Writes lines, the first one with the name; nothing without lines.
fn rows(f: &mut fmt::Formatter<'_>, name: &str, texts: impl Iterator<Item = String>) -> fmt::Result {
    let mut name = format!("{name}:");
    for text in texts {
        writeln!(f, "{name:WIDTH$}{}", clean(&text))?;
        name.clear();
    }
    Ok(())
}

/// Formats a size as `ros2 bag info` does.
fn size(bytes: u64) -> String {
    let units = ["KiB", "MiB", "GiB", "TiB"];
    let mut size = bytes as f64;
    let mut unit = "B";
    for larger in units {
        if size < 1024.0 {
            break;
        }
        (size, unit) = (size / 1024.0, larger);
    }
    if unit == "B" { format!("{bytes} B") } else { format!("{size:.1} {unit}") }
}

fn decimal_seconds(time: u64) -> String {
    let text = format!("{}.{:09}", time / 1_000_000_000, time % 1_000_000_000);
    let trimmed = text.trim_end_matches('0');
    // At least milliseconds.
    let shortest = text.len() - 6;
    text[..trimmed.len().max(shortest)].to_owned()
}

/// Formats a time in UTC by ISO 8601.
///
/// Law      days are counted in eras of 400 years that begin on March 1, so that a leap day is the last day of its year
fn utc(time: u64) -> String {
    const DAY: u64 = 86_400;
    let seconds = time / 1_000_000_000;
    let (days, second) = (seconds / DAY + 719_468, seconds % DAY);
    let (era, day) = (days / 146_097, days % 146_097);
    let year = (day - day / 1460 + day / 36_524 - day / 146_096) / 365;
    let day = day - (365 * year + year / 4 - year / 100);
    let month = (5 * day + 2) / 153;
    let date = day - (153 * month + 2) / 5 + 1;
    let month = if month < 10 { month + 3 } else { month - 9 };
    let year = era * 400 + year + u64::from(month <= 2);
    let (hour, minute) = (second / 3600, second / 60 % 60);
    let second = format!("{:02}.{}", second % 60, decimal_seconds(time % 1_000_000_000).trim_start_matches("0."));
    format!("{year:04}-{month:02}-{date:02}T{hour:02}:{minute:02}:{second}Z")
}

#[cfg(test)]
mod tests;
