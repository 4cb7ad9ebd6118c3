//! Source of simulation time: the topic `/clock`, while it is used.

use std::sync::{Mutex, PoisonError};

use lineshaft_msgs::foreign::rosgraph_msgs::msg::Clock as ClockMessage;
use tokio::task::JoinHandle;

use super::clock::Clock;
use super::endpoint::CreateError;
use super::subscription::Subscription;

/// Sets the clock of a node from the messages of a topic while it is switched on.
pub struct TimeSource {
    clock: Clock,
    subscribe: Box<dyn Fn() -> Result<Subscription<ClockMessage>, CreateError> + Send + Sync>,
    runtime: tokio::runtime::Handle,
    /// Task that reads the topic while it is used.
    reading: Mutex<Option<JoinHandle<()>>>,
}

impl TimeSource {
    pub(super) fn new(
        runtime: tokio::runtime::Handle,
        clock: Clock,
        subscribe: impl Fn() -> Result<Subscription<ClockMessage>, CreateError> + Send + Sync + 'static,
    ) -> Self {
        Self { clock, subscribe: Box::new(subscribe), runtime, reading: Mutex::default() }
    }

    /// Starts or ends the use of the topic; the subscription exists only meanwhile.
    ///
    /// # Errors
    /// The subscription cannot be created; the clock is unchanged then.
    pub fn switch(&self, is_on: bool) -> Result<(), CreateError> {
        let mut reading = self.reading.lock().unwrap_or_else(PoisonError::into_inner);
        if is_on == reading.is_some() {
            return Ok(());
        }
        if is_on {
            let subscription = (self.subscribe)()?;
            self.clock.simulate(true);
            *reading = Some(self.runtime.spawn(follow(subscription, self.clock.clone())));
        } else if let Some(task) = reading.take() {
            task.abort();
            self.clock.simulate(false);
        }
        Ok(())
    }
}

impl Drop for TimeSource {
    fn drop(&mut self) {
        if let Some(task) = self.reading.lock().unwrap_or_else(PoisonError::into_inner).take() {
            task.abort();
        }
    }
}

async fn follow(mut subscription: Subscription<ClockMessage>, clock: Clock) {
    while let Some(message) = subscription.next().await {
        clock.set(&message.clock);
    }
}
