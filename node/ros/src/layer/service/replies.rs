//! Replies of one service.

use std::future::Future;

use super::ReplyError;
use crate::layer::endpoint::Context;
use crate::layer::name::FullName;
use crate::line_limit::MessageRateLimit;
use crate::link::Writer;
use crate::link::protocol::{Caller, ParticipantId, ReplyFailure};

/// Writer of the replies of one service.
pub(super) struct Replies {
    writer: Writer,
    service: FullName,
    context: Context,
    failed: MessageRateLimit<()>,
}

impl Replies {
    pub(super) fn new(context: &Context, writer: Writer, service: FullName) -> Self {
        Self { writer, service, context: context.clone(), failed: MessageRateLimit::default() }
    }

    pub(super) fn service(&self) -> &FullName {
        &self.service
    }

    pub(super) fn spawn(&self, task: impl Future<Output = ()> + Send + 'static) {
        self.context.runtime.spawn(task);
    }

    /// Sends a reply to a client of participant `to`. A failure is logged, because the client would wait forever without any message.
    pub(super) async fn send(&self, caller: Caller, to: ParticipantId, bytes: Vec<u8>) -> Result<(), ReplyError> {
        let service = self.service.clone();
        let error = match self.writer.reply(caller, bytes.into()).await {
            Ok(()) => return Ok(()),
            Err(ReplyFailure::NoReader) => {
                let error = ReplyError::NoReader { service };
                // The client has left and does not wait.
                tracing::debug!("{error}");
                return Err(error);
            }
            Err(ReplyFailure::Full) => ReplyError::Full { service },
            Err(ReplyFailure::Broken(reason)) => ReplyError::Failed { service, reason },
        };
        self.failed.log((), |more| tracing::warn!("{error} (participant {to}){more}"));
        Err(error)
    }
}
