//! Verb `set_output`: OUT, OUTB and OUTAN (MACS-IO-03), one output for each entry, all in the same cycle.

use super::super::ruler::Ruler;
use super::{Deed, Reader, did_you_mean, nearest};
use crate::document::Value;
use lineshaft_core::command::Action;
use lineshaft_core::config::IoKind;
use lineshaft_core::unit::excerpt;

impl Reader<'_> {
    pub(super) fn set_output(&self, value: &Value<'_>) -> Vec<Deed> {
        let entries = value.entries().unwrap_or_default();
        if entries.is_empty() && value.is_map() {
            value.refuse("set_output is empty; `output: value` is expected", None);
        }
        entries.iter().filter_map(|(key, value)| self.one_output(key, value)).collect()
    }

    fn one_output(&self, key: &Value<'_>, value: &Value<'_>) -> Option<Deed> {
        let name = key.text()?;
        let io = &self.names.config.io;
        let is_output = |kind| matches!(kind, IoKind::DigitalOutput | IoKind::AnalogOutput);
        let Some(index) = io.iter().position(|entry| entry.name == name && is_output(entry.kind)) else {
            let outputs = io.iter().filter(|entry| is_output(entry.kind));
            let hint = nearest(name, outputs.map(|entry| entry.name.as_str())).map(did_you_mean);
            key.refuse(format!("no output is called `{}`", excerpt(name)), hint);
            return None;
        };
        let signal = self.names.signal(key)?;
        // A number of V may have any digits; a quantity is exact.
        let is_number = value.peek().is_some_and(|text| text.parse::<f64>().is_ok());
        let value = match io[index].kind {
            IoKind::AnalogOutput if is_number => value.number(f64::NEG_INFINITY..=f64::INFINITY)?,
            _ => Ruler::of(self.names, signal).read(value)?.to_f64(),
        };
        Some(Deed::Command(Action::SetOutput { index: u16::try_from(index).ok()?, value }))
    }
}
