//! `lineshaft schema`.

use super::{Exit, say_all};
use crate::reference::{File, schema};
use clap::{Args, ValueEnum};

#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  lineshaft schema cell > cell.schema.json\n  lineshaft schema scenario > scenario.schema.json\n\n\
                  An editor with yaml-language-server reads it where a file begins with\n  \
                  # yaml-language-server: $schema=cell.schema.json\n\ndocs/keys.md lists all keys.\nExit codes: 0 good, 2 bad usage."
)]
pub(super) struct SchemaArgs {
    /// The kind of file
    #[arg(value_enum)]
    file: SchemaFile,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum SchemaFile {
    /// A cell
    Cell,
    /// A scenario
    Scenario,
    /// The description of a table, for `lineshaft table make`
    Table,
}

pub(super) fn run(args: &SchemaArgs) -> Exit {
    let file = match args.file {
        SchemaFile::Cell => File::Cell,
        SchemaFile::Scenario => File::Scenario,
        SchemaFile::Table => File::Table,
    };
    say_all(&format!("{:#}\n", schema(file)));
    Exit::Good
}
