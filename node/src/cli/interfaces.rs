//! `lineshaft interfaces`.

use super::params::width;
use super::{Exit, say_all};
use crate::interfaces::{details, listing, markdown, meant};
use crate::scenario::did_you_mean;
use clap::Args;

#[derive(Debug, Args)]
pub(super) struct InterfacesArgs {
    /// A topic, a service, an action, or a type as `MoveAxis`: all that is said about it; left out: the list
    name: Option<String>,
    /// Print everything as Markdown, as it stands in docs/interfaces.md
    #[arg(long, conflicts_with = "name")]
    markdown: bool,
}

pub(super) fn interfaces(args: &InterfacesArgs) -> Exit {
    let text = match &args.name {
        _ if args.markdown => markdown(),
        None => listing(width()),
        Some(name) => match details(name, width()) {
            Some(text) => text,
            None => {
                let meant = meant(name).map_or(String::new(), |meant| format!("{} ", did_you_mean(meant)));
                let sentence =
                    format!("no topic, service, action or type `{name}`; {meant}`lineshaft interfaces` lists all");
                super::complain(&sentence);
                return Exit::Usage;
            }
        },
    };
    say_all(&text);
    Exit::Good
}
