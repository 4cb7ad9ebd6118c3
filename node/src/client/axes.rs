//! `lineshaft enable`, `disable`, `halt`, `reset`: services that do one thing with axes.
//!
//! Law      a command that the node has not accepted within the timeout has failed. The service answers only at the end of the command, so
//!          the acceptance is read from `~/events`
//! Refuses  axes that the node lacks; a stop still stops the others

use super::output::{print, with_commands};
use super::session::{Session, own_end};
use super::{Failure, Options};
use crate::recording::clean::clean;
use lineshaft_core::request::RequestError;
use lineshaft_core::unit::excerpt;
use lineshaft_msgs::msg::Event;
use lineshaft_msgs::srv::{AxesCommand, AxesCommandRequest, AxesCommandResponse};
use lineshaft_ros::layer::{Qos, ServiceClient, Subscription};
use std::time::Duration;
use tokio::time::{Instant, sleep_until};

/// Maximum time for the end of an accepted command. The node answers within 60 s: a drive may take long to switch on, and an axis to stop.
const PATIENCE: Duration = Duration::from_secs(65);

/// A service of the node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum AxesService {
    Enable,
    Disable,
    Halt,
    ResetErrors,
}

impl AxesService {
    fn name(self) -> &'static str {
        match self {
            Self::Enable => "enable",
            Self::Disable => "disable",
            Self::Halt => "halt",
            Self::ResetErrors => "reset_errors",
        }
    }

    fn is_stop(self) -> bool {
        matches!(self, Self::Halt | Self::Disable)
    }
}

/// Calls the service for these axes, or for all if none is named, and prints the answer of the node.
///
/// # Errors
/// Returns an error if the node refuses the request, lacks one of the axes or does not answer.
pub(crate) async fn command_axes(options: &Options, service: AxesService, axes: &[String]) -> Result<(), Failure> {
    let session = Session::open(&Options { is_stop: service.is_stop(), ..options.clone() }).await?;
    let Outcome { done, failure } = AxesClient::open(&session, service)?.command(axes).await?;
    if let Some(done) = done {
        print(&clean(&done));
    }
    let axis = if let [axis] = axes { Some(axis.as_str()) } else { None };
    failure.map_or(Ok(()), |failure| Err(Failure::Failed(with_commands(&failure, axis))))
}

/// Answer of the node.
#[derive(Debug, PartialEq, Eq)]
struct Outcome {
    /// What was done, if anything.
    done: Option<String>,
    /// What was not done, and why.
    failure: Option<String>,
}

/// Client of one service.
struct AxesClient<'a> {
    session: &'a Session,
    service: AxesService,
    /// Events of the node, which show that it has accepted the command.
    events: Subscription<Event>,
    client: ServiceClient<AxesCommand>,
    /// Maximum time until the node has accepted the command.
    timeout: Duration,
}

impl<'a> AxesClient<'a> {
    fn open(session: &'a Session, service: AxesService) -> Result<Self, Failure> {
        Ok(Self {
            session,
            service,
            // Before the client, so that it is matched when the node gets the request.
            events: session.topic("events", Qos::EVENTS)?,
            client: session.service(service.name(), Qos::SERVICE)?,
            timeout: session.timeout(),
        })
    }

    /// Calls the service. If the node lacks some axes, a stop is called again for the others.
    async fn command(&mut self, axes: &[String]) -> Result<Outcome, Failure> {
        let (mut known, mut unknown) = (axes.to_vec(), Vec::new());
        let AxesCommandResponse { success, message } = loop {
            let response = self.call(&known).await?;
            let is_refused = |name: &&String| !response.success && is_unknown(&response.message, name);
            let Some(name) = known.iter().find(is_refused).filter(|_| self.service.is_stop()).cloned() else {
                break response;
            };
            known.retain(|axis| *axis != name);
            unknown.push(response.message);
            // A request without a name would be for all axes.
            if known.is_empty() {
                let failure = format!("{}; nothing was stopped", unknown.join("; "));
                return Ok(Outcome { done: None, failure: Some(failure) });
            }
        };
        let done = if success {
            Some(message)
        } else {
            unknown.push(message);
            None
        };
        let failure = if unknown.is_empty() { None } else { Some(unknown.join("; ")) };
        Ok(Outcome { done, failure })
    }

    /// Sends the request and waits for the answer.
    async fn call(&mut self, axes: &[String]) -> Result<AxesCommandResponse, Failure> {
        let (session, name) = (self.session, self.client.name().to_string());
        session.matched(&name, || self.client.servers()).await?;
        let number = self.client.send(&request(axes)).map_err(Failure::failed)?;
        let gone = session.gone();
        tokio::pin!(gone);
        let (begun, mut is_accepted) = (Instant::now(), false);
        let mut limit = begun + self.timeout;
        loop {
            tokio::select! {
                reply = self.client.reply(number) => return reply.map_err(Failure::failed),
                event = self.events.next(), if !is_accepted => {
                    let event = event.ok_or_else(own_end)?;
                    is_accepted = event.kind == "accepted" && event.source == "machine";
                }
                failure = &mut gone => return Err(failure),
                () = sleep_until(limit) => {
                    let last = begun + PATIENCE;
                    if !is_accepted || limit >= last {
                        return Err(self.unanswered(&name, limit - begun));
                    }
                    eprintln!("{name}: accepted; the command waits for its end");
                    limit = last;
                }
            }
        }
    }

    fn unanswered(&self, name: &str, time: Duration) -> Failure {
        let state = match self.service.is_stop() {
            true => "the axes may still move; `lineshaft state` shows them",
            false => "it is not known whether it was done; `lineshaft state` shows the axes",
        };
        Failure::Failed(format!("{name}: no answer within {} s; {state}", time.as_secs_f64()))
    }
}

fn request(axes: &[String]) -> AxesCommandRequest {
    AxesCommandRequest { axes: axes.to_vec() }
}

/// Whether the node refuses a request because it has no axis of this name.
fn is_unknown(message: &str, name: &str) -> bool {
    let refusal = RequestError::UnknownAxis { name: excerpt(name), known: String::new() };
    message.starts_with(&refusal.to_string())
}

#[cfg(test)]
mod tests {
    use super::super::test_node::{LONG, TestNode};
    use super::*;
    use lineshaft_msgs::cdr;
    use lineshaft_ros::layer::{Request, ServiceServer};
    use tokio::time::{sleep, timeout};

    async fn next(server: &mut ServiceServer<AxesCommand>) -> Request<AxesCommand> {
        timeout(LONG, server.next()).await.expect("a request in time").expect("the node is open")
    }

    fn names(axes: &[&str]) -> Vec<String> {
        axes.iter().map(|axis| (*axis).to_owned()).collect()
    }

    #[test]
    fn request_is_the_sequence_of_names() {
        assert_eq!(cdr::encode(&request(&[])), [0; 4], "all axes");
        // CDR: the number of strings; each with its length, its characters and a zero, at a multiple of 4.
        let bytes = [&[2, 0, 0, 0, 2, 0, 0, 0][..], b"x\0", &[0, 0, 3, 0, 0, 0], b"y2\0"].concat();
        assert_eq!(cdr::encode(&request(&["x".to_owned(), "y2".to_owned()])), bytes);
    }

    #[test]
    fn refusal_names_the_axis_that_is_missing() {
        let refusal = "no axis is called `xx`; there are x, y";
        assert!(is_unknown(refusal, "xx") && !is_unknown(refusal, "x") && !is_unknown(refusal, "y"));
        assert!(!is_unknown("xx: the drive is offline", "xx"));
    }

    #[tokio::test(flavor = "multi_thread", worker_threads = 2)]
    async fn stop_without_an_answer_ends_after_the_timeout() {
        let served = TestNode::start("unanswered");
        let _server = served.node.service::<AxesCommand>("~/disable", Qos::SERVICE).unwrap();
        let session = served.session().await;
        let opened = AxesClient::open(&session, AxesService::Disable).unwrap();
        let mut client = AxesClient { timeout: Duration::from_millis(300), ..opened };
        let failure = timeout(LONG, client.command(&names(&["x"]))).await.expect("an end in time").unwrap_err();
        let sentence = "no answer within 0.3 s; the axes may still move; `lineshaft state` shows them";
        assert_eq!(failure, Failure::Failed(format!("{}/disable: {sentence}", session.target())));
    }

    #[tokio::test(flavor = "multi_thread", worker_threads = 2)]
    async fn accepted_command_is_waited_for_beyond_the_timeout() {
        let served = TestNode::start("accepted");
        let mut server = served.node.service::<AxesCommand>("~/enable", Qos::SERVICE).unwrap();
        let events = served.node.publisher::<Event>("~/events", Qos::EVENTS).unwrap();
        let session = served.session().await;
        let opened = AxesClient::open(&session, AxesService::Enable).unwrap();
        let mut client = AxesClient { timeout: Duration::from_secs(1), ..opened };
        let node = async {
            let Request { reply, .. } = next(&mut server).await;
            let accepted = Event { kind: "accepted".to_owned(), source: "machine".to_owned(), ..Event::default() };
            // For 2 s: the topic may be matched later than the service.
            for _ in 0..100 {
                events.publish(&accepted).unwrap();
                sleep(Duration::from_millis(20)).await;
            }
            reply.send(AxesCommandResponse { success: true, message: "1 axis enabled".to_owned() }).await.unwrap();
        };
        let axes = names(&["x"]);
        let (outcome, ()) = tokio::join!(client.command(&axes), node);
        assert_eq!(outcome, Ok(Outcome { done: Some("1 axis enabled".to_owned()), failure: None }));
    }

    #[tokio::test(flavor = "multi_thread", worker_threads = 2)]
    async fn stop_with_an_unknown_axis_stops_the_others() {
        let served = TestNode::start("unknown_axis");
        let mut server = served.node.service::<AxesCommand>("~/disable", Qos::SERVICE).unwrap();
        let session = served.session().await;
        let mut client = AxesClient::open(&session, AxesService::Disable).unwrap();
        let unknown = "no axis is called `xx`; there are x, y";
        let node = async {
            for (axes, success, message) in [
                (&["x", "xx"][..], false, unknown),
                (&["x"][..], true, "1 axis disabled"),
                (&["xx"][..], false, unknown),
            ] {
                let request = next(&mut server).await;
                assert_eq!(request.message.axes, axes);
                request.reply.send(AxesCommandResponse { success, message: message.to_owned() }).await.unwrap();
            }
        };
        let commands = async {
            let mixed = client.command(&names(&["x", "xx"])).await;
            let done = Some("1 axis disabled".to_owned());
            assert_eq!(mixed, Ok(Outcome { done, failure: Some(unknown.to_owned()) }));
            let failure = Some(format!("{unknown}; nothing was stopped"));
            assert_eq!(client.command(&names(&["xx"])).await, Ok(Outcome { done: None, failure }));
        };
        tokio::join!(commands, node);
    }
}
