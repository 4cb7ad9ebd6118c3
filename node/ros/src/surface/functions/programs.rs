//! `~/load_program`: loads another module into a program.

use crate::layer::{CreateError, Node};
use crate::surface::hub::Hub;
use crate::surface::{one_command, table};
use lineshaft_core::command::Action;
use lineshaft_core::config::MachineConfig;
use lineshaft_msgs::srv::LoadProgramRequest;
use std::sync::Arc;
use tokio::task::JoinSet;

pub(super) fn start(node: &Node, hub: &Arc<Hub>, tasks: &mut JoinSet<()>) -> Result<(), CreateError> {
    let server = table::LOAD_PROGRAM.server(node)?;
    tasks.spawn(one_command::serve(server, Arc::clone(hub), resolve));
    Ok(())
}

fn resolve(config: &MachineConfig, request: LoadProgramRequest) -> Result<Action, String> {
    let LoadProgramRequest { program, module, keep_state } = request;
    // Checking a large module takes time; other requests are answered meanwhile.
    let resolved = tokio::task::block_in_place(|| config.resolve_load_program(&program, &module, keep_state));
    resolved.map_err(|error| error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::refusing::OutcomeResponse;
    use lineshaft_core::config::ProgramConfig;
    use lineshaft_msgs::srv::LoadProgramResponse;

    #[test]
    fn names_and_modules_are_checked_before_anything_is_a_command() {
        let text = "(module (memory 1) (global (export \"image\") i32 (i32.const 16)) (data (i32.const 16) \"\\b0\\03\") (func (export \"cycle\")))";
        let module = wat::parse_str(text).unwrap();
        let load = |program: &str, module: &[u8]| {
            let request = LoadProgramRequest { program: program.to_owned(), module: module.into(), keep_state: true };
            let program = lineshaft_program::Module::load(&wat::parse_str(text).unwrap()).unwrap();
            let programs = vec![ProgramConfig { name: "p".to_owned(), module: Arc::new(program) }];
            resolve(&MachineConfig { programs, ..MachineConfig::default() }, request)
        };
        let runtime = tokio::runtime::Builder::new_multi_thread().build().unwrap();
        runtime.block_on(async {
            assert!(matches!(load("p", &module), Ok(Action::LoadProgram { index: 0, keeps: true, .. })));
            assert_eq!(load("q", &module).unwrap_err(), "no program is called `q`; p are known");
            assert_eq!(
                load("p", b"").unwrap_err(),
                "p: it is no WebAssembly: its first four bytes are others than \\0asm"
            );
        });
        let response = LoadProgramResponse::of;
        assert!(!response(Err("x".to_owned())).success && response(Ok(())).success);
    }
}
