//! Summary of a run as fields for JSON.

use super::Info;
use serde_json::{Value as Json, json};

impl Info {
    /// Returns all fields, with the names for programs (docs/json.md).
    pub fn fields(&self) -> Vec<(&'static str, Json)> {
        let files = self.files.iter().map(|(name, bytes)| json!({"file": name, "bytes": bytes}));
        let topics = self.topics.iter().map(|([topic, kind, encoding], count)| {
            json!({"topic": topic, "type": kind, "encoding": encoding, "messages": count})
        });
        let attachments = self.attachments.iter().map(|(file, name, bytes)| {
            json!({"file": self.files.get(*file).map(|(name, _)| name), "name": name, "bytes": bytes})
        });
        let cycles =
            self.cycles.first_and_last.map(|(first, last)| json!({"first": first, "last": last, "lost": self.lost()}));
        let replayable = self.replayable();
        vec![
            ("files", files.collect()),
            ("bytes", json!(self.files.iter().map(|(_, bytes)| bytes).sum::<u64>())),
            ("profile", json!(self.profile)),
            ("start_ns", json!(self.span.map(|(start, _)| start))),
            ("end_ns", json!(self.span.map(|(_, end)| end))),
            ("messages", json!(self.topics.values().sum::<u64>())),
            ("topics", topics.collect()),
            ("lineshaft", json!(self.lineshaft)),
            ("attachments", attachments.collect()),
            ("cycles", json!(cycles)),
            ("replayable", json!(replayable.is_ok())),
            ("not_replayable_because", json!(replayable.err())),
            ("finished", json!(self.end.is_some())),
            ("cuts", json!(self.cuts)),
        ]
    }
}
