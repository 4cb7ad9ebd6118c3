//! Verb `set_output`: OUT, OUTB and OUTAN (MACS-IO-03); all its outputs are set in the same cycle.

use super::super::ruler::ValueFormat;
use super::{Effect, Reader, did_you_mean, nearest};
use crate::document::Value;
use lineshaft_core::config::IoKind;
use lineshaft_core::unit::excerpt;

impl Reader<'_> {
    pub(super) fn set_output(&self, value: &Value<'_>) -> Option<Effect> {
        let entries = value.entries()?;
        if entries.is_empty() {
            // A value that is no mapping has been reported already.
            if value.is_map() {
                value.refuse("set_output is empty; `output: value` is expected", None);
            }
            return None;
        }
        // All entries are read, so that every problem is reported.
        let given: Vec<_> = entries.iter().map(|(key, value)| self.one_output(key, value)).collect();
        let given: Vec<_> = given.into_iter().collect::<Option<_>>()?;
        self.to_command(value, self.names.config.resolve_set_output(&given))
    }

    fn one_output(&self, key: &Value<'_>, value: &Value<'_>) -> Option<(String, f64)> {
        let name = key.text()?;
        let io = &self.names.config.io;
        let is_output = |kind| matches!(kind, IoKind::DigitalOutput | IoKind::AnalogOutput);
        let Some(entry) = io.iter().find(|entry| entry.name == name && is_output(entry.kind)) else {
            let outputs = io.iter().filter(|entry| is_output(entry.kind));
            let hint = nearest(name, outputs.map(|entry| entry.name.as_str())).map(did_you_mean);
            key.refuse(format!("no output is called `{}`", excerpt(name)), hint);
            return None;
        };
        let signal = self.names.signal(key)?;
        // A number in V may have any digits; a quantity is exact.
        let is_number = value.peek().is_some_and(|text| text.parse::<f64>().is_ok());
        let value = match entry.kind {
            IoKind::AnalogOutput if is_number => value.number(f64::NEG_INFINITY..=f64::INFINITY)?,
            _ => ValueFormat::of(self.names, signal).read(value)?.to_f64(),
        };
        Some((name.to_owned(), value))
    }
}
