//! `lineshaft can configure`.

use super::Failure;
use super::args::ConfigureArgs;
use super::open::Known;
use crate::cell::{device_file, passed_over};
use crate::cli::{say, warn};
use crate::progress::Progress;
use lineshaft_cia402::object::Object;
use std::time::Duration;

pub(super) fn configure(args: &ConfigureArgs) -> Result<(), Failure> {
    let (node, path) = (args.node, &args.dcf);
    let dictionary = device_file("--dcf", path, node).map_err(Failure::Usage)?;
    warn(passed_over("--dcf", path, &dictionary, &[]));
    let file = path.display();
    let values = dictionary.configured_values().map_err(|error| Failure::Usage(format!("--dcf {file}: {error}")))?;
    if values.is_empty() {
        let sentence = "configures nothing: no object that can be written has a ParameterValue";
        return Err(Failure::Usage(format!("--dcf {file} {sentence}")));
    }
    let mut session = Known::of(&args.bus)?.open()?;
    session.check_identity(node, dictionary.device.vendor_number, dictionary.device.product_number)?;
    let mut progress = Progress::new("objects", Duration::ZERO);
    let done = session.configure(node, &values, &mut |done, of| progress.set(done, Some(of)));
    drop(progress);
    let done = done?;
    let (written, compared) = (done.written.len(), done.compared);
    say(&format_args!("{node}: {written} of {compared} objects differed and were written{}", listed(&done.written)));
    if !done.left_out.is_empty() {
        say(&format_args!("{node}: left out, {}", done.left_out));
    }
    if args.store {
        session.store(node)?;
        say(&format_args!("{node}: it has stored them"));
    }
    Ok(())
}

fn listed(objects: &[Object]) -> String {
    let names: Vec<_> = objects.iter().map(Object::to_string).collect();
    if names.is_empty() { String::new() } else { format!(": {}", names.join(", ")) }
}
