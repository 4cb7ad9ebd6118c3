//! `lineshaft completions`.

use super::{Exit, Line, say_all};
use clap::{Args, CommandFactory};
use clap_complete::aot::{Shell, generate};

#[derive(Debug, Args)]
pub(super) struct CompletionsArgs {
    /// The shell
    #[arg(value_enum)]
    shell: Shell,
}

pub(super) fn completions(args: &CompletionsArgs) -> Exit {
    say_all(&script(args.shell));
    Exit::Good
}

/// Returns the shell script that completes the commands, options and values of this program.
fn script(shell: Shell) -> String {
    let mut script = Vec::new();
    generate(shell, &mut Line::command(), "lineshaft", &mut script);
    String::from_utf8_lossy(&script).into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::ValueEnum;

    #[test]
    fn the_script_of_each_shell_names_all_commands() {
        let line = Line::command();
        let commands: Vec<_> = line.get_subcommands().map(clap::Command::get_name).collect();
        assert!(commands.contains(&"sim") && commands.contains(&"can"), "{commands:?}");
        for shell in Shell::value_variants() {
            let script = script(*shell);
            for command in &commands {
                assert!(script.contains(command), "{shell}: {command}");
            }
        }
    }
}
