//! `lineshaft bag`.

use super::{BagCommand, Exit, complain, say};
use crate::recording::info::Info;
use crate::recording::run::Run;
use std::path::Path;

pub(super) fn bag(command: &BagCommand) -> Exit {
    match command {
        BagCommand::Info { run } => info(run),
    }
}

fn info(path: &Path) -> Exit {
    let mut run = match Run::open_any(path) {
        Ok(run) => run,
        Err(error) => {
            complain(&error);
            return Exit::Usage;
        }
    };
    let info = Info::of(&mut run);
    say(&info.to_string().trim_end());
    let flaws: Vec<_> = run.flaws().collect();
    for flaw in &flaws {
        complain(flaw);
    }
    match info.error() {
        Some(error) => {
            complain(error);
            Exit::Usage
        }
        None if flaws.is_empty() => Exit::Good,
        None => Exit::Usage,
    }
}
