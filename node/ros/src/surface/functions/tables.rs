//! `~/load_table` and `~/get_table`: points of a table.

use crate::layer::{CreateError, Node, Request, ServiceServer};
use crate::surface::hub::Hub;
use crate::surface::{one_command, table};
use lineshaft_core::command::Action;
use lineshaft_core::config::MachineConfig;
use lineshaft_core::parameter::ParameterImage;
use lineshaft_msgs::srv::{GetTable, GetTableResponse, LoadTableRequest};
use std::sync::Arc;
use tokio::task::JoinSet;

pub(super) fn start(node: &Node, hub: &Arc<Hub>, tasks: &mut JoinSet<()>) -> Result<(), CreateError> {
    let server = table::LOAD_TABLE.server(node)?;
    tasks.spawn(one_command::serve(server, Arc::clone(hub), resolve));
    tasks.spawn(serve(table::GET_TABLE.server(node)?, Arc::clone(hub)));
    Ok(())
}

fn resolve(config: &MachineConfig, LoadTableRequest { table, x, y }: LoadTableRequest) -> Result<Action, String> {
    // A spline through a million points takes time; other requests are answered meanwhile.
    let resolved = tokio::task::block_in_place(|| config.resolve_load_table(&table, &x, &y));
    resolved.map_err(|error| error.to_string())
}

async fn serve(mut server: ServiceServer<GetTable>, hub: Arc<Hub>) {
    while let Some(Request { message, reply }) = server.next().await {
        let answer = get(hub.host.config(), &hub.host.parameters(), &message.table);
        reply.send_soon(answer.unwrap_or_else(|message| GetTableResponse { message, ..GetTableResponse::default() }));
    }
}

/// Returns the table with this name in an image.
fn get(config: &MachineConfig, image: &ParameterImage, name: &str) -> Result<GetTableResponse, String> {
    let place = config.find_table(name).map_err(|error| error.to_string())?;
    let table = image.tables.get(usize::from(place)).ok_or("the table could not be read")?;
    let (x, y) = (table.x().to_vec(), table.y().to_vec());
    Ok(GetTableResponse { success: true, message: String::new(), form: table.form().name().to_owned(), x, y })
}

#[cfg(test)]
mod tests {
    use super::*;
    use lineshaft_core::command::{Command, Commands, Source};
    use lineshaft_core::config::TableConfig;
    use lineshaft_core::machine::Machine;
    use lineshaft_core::table::{Form, Table};

    fn config() -> MachineConfig {
        let table = |name: &str, form, x: &[i64], y: &[i64]| {
            let table = Arc::new(Table::new(form, x, y).expect("a sound table"));
            TableConfig { name: name.to_owned(), table }
        };
        let tables = vec![table("rise", Form::Y, &[], &[0, 4]), table("knife", Form::Xy, &[0, 9], &[1, 2])];
        MachineConfig { cycle_ns: 1_000_000, tables, ..MachineConfig::default() }
    }

    fn ask(table: &str, x: &[i64], y: &[i64]) -> Result<Action, String> {
        resolve(&config(), LoadTableRequest { table: table.to_owned(), x: x.into(), y: y.into() })
    }

    #[test]
    fn a_table_that_was_loaded_is_read_from_then_on() {
        let config = config();
        let mut machine = Machine::new(config.clone()).expect("a sound machine");
        let mut image = machine.parameter_image();
        let read = |image: &ParameterImage, name| get(&config, image, name);
        let rise = read(&image, "rise").expect("there");
        assert_eq!((rise.success, rise.form.as_str(), rise.x, rise.y), (true, "y", vec![], vec![0, 4]));
        let action = ask("knife", &[5, 6], &[7, 8]).expect("sound");
        let commands = [Command { sequence: 1, source: Source::Ros, action }];
        let (inputs, mut outputs) = (machine.inputs(), machine.outputs());
        let before = machine.parameter_version();
        machine.cycle(&inputs, Commands::queue(&commands), &mut outputs);
        // A change of the version makes readers read the image again.
        assert_ne!(machine.parameter_version(), before);
        machine.copy_parameters(&mut image);
        let knife = read(&image, "knife").expect("there");
        assert_eq!((knife.form.as_str(), knife.x, knife.y), ("xy", vec![5, 6], vec![7, 8]));
        assert_eq!(read(&image, "rise").expect("there").y, [0, 4]);
        assert_eq!(read(&image, "fall"), Err("no table is called `fall`; rise, knife are known".to_owned()));
    }

    #[test]
    fn numbers_of_another_form_are_refused() {
        let sentence = "rise: a table of form y has 2 places in x; it takes none";
        assert_eq!(ask("rise", &[1, 2], &[1, 2]).map(|_| ()), Err(sentence.to_owned()));
        let sentence = "knife: a table of form xy has 0 places and 2 values; as many of both are needed";
        assert_eq!(ask("knife", &[], &[1, 2]).map(|_| ()), Err(sentence.to_owned()));
    }
}
