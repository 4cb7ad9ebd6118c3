//! `lineshaft can scan`.

use super::Failure;
use super::args::ScanArgs;
use super::open::Known;
use super::table::{columns, word};
use crate::cli::command_output::Output;
use crate::progress::Progress;
use crate::recording::clean::clean_lines;
use lineshaft_can::commission::words::nmt_state;
use lineshaft_can::commission::{FoundNode, Scan};
use lineshaft_cia402::texts::profile;
use serde_json::{Value as Json, json};
use std::time::Duration;

/// Time to wait for heartbeats: most devices send at least one per second.
const LISTEN: Duration = Duration::from_secs(1);
/// Minimum time between requests to two nodes: required by an adapter on a slow serial line.
const GAP: Duration = Duration::from_millis(2);
/// Number of bits of a request and its answer.
const BITS: u64 = 270;

pub(super) fn scan(args: &ScanArgs, output: &mut Output) -> Result<(), Failure> {
    output.set("nodes", json!([]));
    let (from, to) = (args.from, args.to);
    if from > to {
        let sentence = format!("--from {} is behind --to {}; 1 to {} is allowed", from.get(), to.get(), to.get());
        return Err(Failure::Usage(sentence));
    }
    let known = Known::of(&args.bus)?;
    let mut session = known.open()?;
    let gap = Duration::from_nanos(BITS * 1_000_000_000 / u64::from(known.bit_rate)).max(GAP);
    let mut progress = Progress::wanted("nodes", Duration::ZERO, !args.json);
    let scan = Scan { from, to, gap, least: LISTEN };
    let found = session.scan(scan, &mut |done, of| progress.set(done, Some(of)))?;
    drop(progress);
    if found.is_empty() {
        return Err(Failure::Bus("no node has answered".to_owned()));
    }
    output.say(&clean_lines(&table(&found)));
    output.set("nodes", found.iter().map(object).collect());
    Ok(())
}

/// Returns a node as a JSON object.
fn object(found: &FoundNode) -> Json {
    let [vendor, product, revision, serial] = found.identity;
    json!({
        "node": found.node.get(),
        "answers": found.answers,
        "nmt_state": found.state.map(nmt_state),
        "device_type": found.device_type,
        "profile": found.device_type.map(|device_type| device_type & 0xFFFF),
        "vendor": vendor,
        "product_code": product,
        "revision": revision,
        "serial": serial,
        "name": found.name,
    })
}

fn table(found: &[FoundNode]) -> String {
    let titles = ["node", "state", "profile", "vendor", "product", "revision", "serial", "name"];
    let mut rows = vec![titles.map(str::to_owned).to_vec()];
    rows.extend(found.iter().map(row));
    columns(&rows)
}

fn row(found: &FoundNode) -> Vec<String> {
    let none = || "-".to_owned();
    let mut row = vec![
        found.node.get().to_string(),
        found.state.map_or_else(none, |state| nmt_state(state).to_owned()),
        found.device_type.map_or_else(none, |device_type| profile(device_type & 0xFFFF)),
    ];
    row.extend(found.identity.map(word));
    row.push(match (&found.name, found.answers) {
        // The name is printed on the line of its node.
        (Some(name), _) => name.replace('\n', " "),
        (None, true) => none(),
        (None, false) => "- (no answer)".to_owned(),
    });
    row
}
