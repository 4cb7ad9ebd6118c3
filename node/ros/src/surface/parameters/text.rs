//! `~/export_parameters` and `~/import_parameters`: sets of parameters as text.

use super::give;
use crate::layer::{CreateError, Node, Request, ServiceServer};
use crate::surface::host::ParameterSelection;
use crate::surface::hub::Hub;
use crate::surface::table;
use lineshaft_core::command::Action;
use lineshaft_msgs::srv::{
    ExportParameters, ExportParametersRequest, ExportParametersResponse, ImportParameters, ImportParametersResponse,
};
use std::sync::Arc;
use tokio::task::{JoinSet, spawn_blocking};

/// Maximum size of a text, in bytes: many times all parameters of the largest machine.
const LONGEST: usize = 1 << 20;

pub(super) fn start(node: &Node, hub: &Arc<Hub>, tasks: &mut JoinSet<()>) -> Result<(), CreateError> {
    let server = table::EXPORT_PARAMETERS.server(node)?;
    tasks.spawn(serve_export(server, Arc::clone(hub)));
    let server = table::IMPORT_PARAMETERS.server(node)?;
    tasks.spawn(serve_import(server, Arc::clone(hub)));
    Ok(())
}

async fn serve_export(mut server: ServiceServer<ExportParameters>, hub: Arc<Hub>) {
    let service = server.name().to_string();
    while let Some(Request { message, reply }) = server.next().await {
        let response = match export(&hub, message).await {
            Ok(text) => ExportParametersResponse { success: true, message: String::new(), text },
            Err(message) => {
                hub.refuse(format!("{service}: {message}"));
                ExportParametersResponse { success: false, message, text: String::new() }
            }
        };
        reply.send_soon(response);
    }
}

async fn export(hub: &Arc<Hub>, request: ExportParametersRequest) -> Result<String, String> {
    let axes = hub.host.config().find_axes(&request.axes).map_err(|error| error.to_string())?;
    let what = listing(request.which)?;
    let host = Arc::clone(&hub.host);
    let text = spawn_blocking(move || host.write_parameters(axes, what)).await;
    text.map_err(|_| "the text could not be written".to_owned())
}

/// Returns the selection with this number in the interface.
fn listing(number: u8) -> Result<ParameterSelection, String> {
    match number {
        ExportParametersRequest::ALL => Ok(ParameterSelection::All),
        ExportParametersRequest::NOT_DEFAULT => Ok(ParameterSelection::NotDefault),
        ExportParametersRequest::NOT_CELL => Ok(ParameterSelection::NotCell),
        ExportParametersRequest::NOT_SAVED => Ok(ParameterSelection::NotSaved),
        other => Err(format!("which is {other}; 0 ALL, 1 NOT_DEFAULT, 2 NOT_CELL, 3 NOT_SAVED are allowed")),
    }
}

async fn serve_import(mut server: ServiceServer<ImportParameters>, hub: Arc<Hub>) {
    let service = server.name().to_string();
    // Handled in sequence: sets keep the order of their requests, and many long ones use only one thread.
    while let Some(Request { message, reply }) = server.next().await {
        let outcome = match read(&hub, message.text).await {
            Ok(Some(set)) => set_all(&hub, set).await,
            Ok(None) => Ok(()),
            Err(sentence) => {
                hub.refuse(format!("{service}: {sentence}"));
                Err(sentence)
            }
        };
        let success = outcome.is_ok();
        reply.send_soon(ImportParametersResponse { success, message: outcome.err().unwrap_or_default() });
    }
}

async fn set_all(hub: &Arc<Hub>, set: Action) -> Result<(), String> {
    give(hub, set)?.accepted().await
}

/// Returns the command for a text; `None` if the text sets nothing, like the export of an axis with default values.
async fn read(hub: &Arc<Hub>, text: String) -> Result<Option<Action>, String> {
    if text.len() > LONGEST {
        return Err(format!("the text is {} bytes long; {LONGEST} are allowed", text.len()));
    }
    if is_empty(&text) {
        return Ok(None);
    }
    let host = Arc::clone(&hub.host);
    let read = spawn_blocking(move || host.read_parameters(&text)).await;
    let read = read.unwrap_or_else(|_| Err("the text could not be read".to_owned()));
    read.map(Some).map_err(|sentences| sentences.trim_end().to_owned())
}

/// Returns true if a text contains only blanks and comments.
fn is_empty(text: &str) -> bool {
    text.lines().map(str::trim).all(|line| line.is_empty() || line.starts_with('#'))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn choices_have_the_numbers_of_the_interface() {
        let all = [
            ParameterSelection::All,
            ParameterSelection::NotDefault,
            ParameterSelection::NotCell,
            ParameterSelection::NotSaved,
        ];
        assert_eq!([0, 1, 2, 3].map(listing), all.map(Ok));
        assert!(listing(4).is_err_and(|sentence| sentence.starts_with("which is 4; 0 ALL")));
    }

    #[test]
    fn comments_alone_ask_for_nothing() {
        assert!(is_empty("") && is_empty(" \n# nothing\n  # here\n"));
        assert!(!is_empty("# x\nx.max_velocity: 1") && !is_empty("{}"));
    }
}
