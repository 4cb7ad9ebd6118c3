//! `lineshaft enable`, `disable`, `halt`, `reset`: services that do one thing with axes.
//!
//! Law      a command that the node has not accepted within the timeout has failed. The service answers only at the end of the command, so
//!          the acceptance is read from `~/events`. A stop is repeated until it is answered, because the first request to a new client may
//!          be lost. If several nodes have the name, a stop is sent for each axis alone
//! Refuses  axes that the node lacks; a stop still stops the others

use super::output::{print, with_commands};
use super::session::{ASK_AGAIN, Session, own_end};
use super::{Failure, Options};
use crate::recording::clean::clean;
use lineshaft_core::request::RequestError;
use lineshaft_core::unit::excerpt;
use lineshaft_msgs::msg::Event;
use lineshaft_msgs::srv::{AxesCommand, AxesCommandRequest, AxesCommandResponse};
use lineshaft_ros::layer::{Qos, RequestNumber, ServiceClient, Subscription};
use std::time::Duration;
use tokio::time::{Instant, sleep_until, timeout};

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
    failure.map_or(Ok(()), |failure| Err(Failure::Failed(with_commands(&failure, axes, session.target()))))
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
            // Before the client, so that the node usually matches it before it gets the request. Otherwise the event is missed.
            events: session.topic("events", Qos::EVENTS)?,
            client: session.service(service.name(), Qos::SERVICE)?,
            timeout: session.timeout(),
        })
    }

    /// Calls the service. If the node lacks some axes, a stop is called again for the others.
    async fn command(&mut self, axes: &[String]) -> Result<Outcome, Failure> {
        let name = self.client.name().to_string();
        self.session.matched(&name, || self.client.servers()).await?;
        let is_stop = self.service.is_stop();
        let is_shared = self.client.servers() > 1;
        // Each of several nodes would refuse the whole list if it lacks one of the axes.
        let mut lists: Vec<Vec<String>> = match axes {
            [_, ..] if is_stop && is_shared => axes.iter().map(|axis| vec![axis.clone()]).collect(),
            _ => vec![axes.to_vec()],
        };
        let (mut done, mut failures) = (Vec::new(), Vec::new());
        let (mut has_unknown, mut is_none_known) = (false, false);
        while !lists.is_empty() {
            let (answers, failure) = self.call(&lists).await;
            let mut again = Vec::new();
            for (list, answer) in lists.into_iter().zip(answers) {
                let Some(AxesCommandResponse { success, message }) = answer else { continue };
                if success {
                    done.push(message);
                    continue;
                }
                if is_stop && let Some(unknown) = list.iter().find(|name| is_unknown(&message, name)) {
                    has_unknown = true;
                    let known: Vec<_> = list.iter().filter(|name| *name != unknown).cloned().collect();
                    // A request without a name would be for all axes.
                    if known.is_empty() {
                        is_none_known = true;
                    } else {
                        again.push(known);
                    }
                }
                failures.push(message);
            }
            lists = again;
            match failure {
                None => {}
                Some(failure) if done.is_empty() && failures.is_empty() => return Err(failure),
                Some(failure) => {
                    failures.push(failure.to_string());
                    break;
                }
            }
        }
        if has_unknown && (is_shared || self.client.servers() > 1) {
            failures
                .push("another node of this name may have stopped its axes; `lineshaft state` shows them".to_owned());
        } else if is_none_known {
            failures.push("nothing was stopped".to_owned());
        }
        let joined = |parts: Vec<String>| if parts.is_empty() { None } else { Some(parts.join("; ")) };
        Ok(Outcome { done: joined(done), failure: joined(failures) })
    }

    /// Sends a request for each list of axes. Returns their answers, and the reason if some are missing.
    async fn call(&mut self, lists: &[Vec<String>]) -> (Vec<Option<AxesCommandResponse>>, Option<Failure>) {
        let mut answers = vec![None; lists.len()];
        let failure = self.receive(lists, &mut answers).await.err();
        (answers, failure)
    }

    /// Sends a request for each list of axes, and receives all answers.
    async fn receive(
        &mut self,
        lists: &[Vec<String>],
        answers: &mut [Option<AxesCommandResponse>],
    ) -> Result<(), Failure> {
        let (session, name) = (self.session, self.client.name().to_string());
        session.matched(&name, || self.client.servers()).await?;
        // Earlier events belong to other commands.
        while matches!(timeout(Duration::ZERO, self.events.next()).await, Ok(Some(_))) {}
        let mut sent = self.send(lists, answers)?;
        let gone = session.gone();
        tokio::pin!(gone);
        let (begun, mut is_accepted) = (Instant::now(), false);
        let (mut limit, mut repetition) = (begun + self.timeout, begun + ASK_AGAIN);
        loop {
            let numbers: Vec<_> = sent.iter().map(|(number, _)| *number).collect();
            tokio::select! {
                reply = self.client.any_reply(&numbers) => {
                    let (number, response) = reply.map_err(Failure::failed)?;
                    let answered = sent.iter().find(|(sent, _)| *sent == number).map(|(_, index)| *index);
                    if let Some(index) = answered {
                        answers[index] = Some(response);
                        sent.retain(|(_, other)| *other != index);
                    }
                    if sent.is_empty() {
                        return Ok(());
                    }
                }
                event = self.events.next(), if !is_accepted => {
                    let event = event.ok_or_else(own_end)?;
                    is_accepted = event.kind == "accepted" && event.source == "machine";
                }
                failure = &mut gone => return Err(failure),
                () = sleep_until(repetition), if self.service.is_stop() => {
                    repetition += ASK_AGAIN;
                    // If the library does not take it now, the earlier request may still be answered.
                    sent.extend(self.send(lists, answers).unwrap_or_default());
                }
                () = sleep_until(limit) => {
                    let last = begun + PATIENCE;
                    if !is_accepted || limit >= last {
                        return Err(self.unanswered(&name, limit - begun));
                    }
                    eprintln!("{name}: no answer yet; the node accepts commands; waiting for the end");
                    limit = last;
                }
            }
        }
    }

    /// Sends a request for each list of axes without an answer. Returns the number of each request and the index of its list.
    fn send(
        &mut self,
        lists: &[Vec<String>],
        answers: &[Option<AxesCommandResponse>],
    ) -> Result<Vec<(RequestNumber, usize)>, Failure> {
        let open = lists.iter().zip(answers).enumerate().filter(|(_, (_, answer))| answer.is_none());
        open.map(|(index, (axes, _))| Ok((self.client.send(&request(axes)).map_err(Failure::failed)?, index))).collect()
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
    use tokio::time::sleep;

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

    /// The first request gets no answer, as if it was lost.
    #[tokio::test(flavor = "multi_thread", worker_threads = 2)]
    async fn stop_is_repeated_until_any_of_its_requests_is_answered() {
        let served = TestNode::start("repeated");
        let mut server = served.node.service::<AxesCommand>("~/disable", Qos::SERVICE).unwrap();
        let session = served.session().await;
        let mut client = AxesClient::open(&session, AxesService::Disable).unwrap();
        let response = || AxesCommandResponse { success: true, message: "1 axis disabled".to_owned() };
        let node = async {
            drop(next(&mut server).await);
            let second = next(&mut server).await;
            assert_eq!(second.message.axes, ["x"]);
            second.reply.send(response()).await.unwrap();
            // An answer to the first request of the next command counts, too.
            let first = next(&mut server).await;
            let _second = next(&mut server).await;
            first.reply.send(response()).await.unwrap();
        };
        let axes = names(&["x"]);
        let commands = async {
            for _ in 0..2 {
                let outcome = client.command(&axes).await;
                assert_eq!(outcome, Ok(Outcome { done: Some("1 axis disabled".to_owned()), failure: None }));
            }
        };
        tokio::join!(commands, node);
    }

    /// Serves two requests to a node with one axis, which takes long to stop. Returns the axes of each request.
    async fn serve_two(server: &mut ServiceServer<AxesCommand>, own: &str) -> Vec<Vec<String>> {
        let (mut asked, mut stopping) = (Vec::new(), Vec::new());
        for _ in 0..2 {
            let Request { message, reply } = next(server).await;
            match message.axes.iter().find(|name| *name != own) {
                None => stopping.push(reply),
                Some(name) => {
                    let message = format!("no axis is called `{name}`; there are {own}");
                    reply.send_soon(AxesCommandResponse { success: false, message });
                }
            }
            asked.push(message.axes);
        }
        asked
    }

    #[tokio::test(flavor = "multi_thread", worker_threads = 2)]
    async fn stop_for_axes_of_two_nodes_of_one_name_is_sent_for_each_axis() {
        let (first, second) = (TestNode::start("two_nodes"), TestNode::start("two_nodes"));
        let service = |served: &TestNode| served.node.service::<AxesCommand>("~/disable", Qos::SERVICE).unwrap();
        let (mut server_x, mut server_y) = (service(&first), service(&second));
        let session = first.session_to_stop().await;
        let mut client = AxesClient::open(&session, AxesService::Disable).unwrap();
        let both = async {
            while client.client.servers() < 2 {
                sleep(Duration::from_millis(10)).await;
            }
        };
        timeout(LONG, both).await.expect("both nodes are matched");
        let axes = names(&["x", "y"]);
        let (outcome, asked_x, asked_y) =
            tokio::join!(client.command(&axes), serve_two(&mut server_x, "x"), serve_two(&mut server_y, "y"));
        let each = vec![names(&["x"]), names(&["y"])];
        assert_eq!((&asked_x, &asked_y), (&each, &each));
        let failure = "no axis is called `x`; there are y; no axis is called `y`; there are x; another node of this name may have \
                       stopped its axes; `lineshaft state` shows them";
        assert_eq!(outcome, Ok(Outcome { done: None, failure: Some(failure.to_owned()) }));
    }

    #[tokio::test(flavor = "multi_thread", worker_threads = 2)]
    async fn acceptance_before_the_request_belongs_to_another_command() {
        let served = TestNode::start("accepted_before");
        let _server = served.node.service::<AxesCommand>("~/disable", Qos::SERVICE).unwrap();
        let events = served.node.publisher::<Event>("~/events", Qos::EVENTS).unwrap();
        let session = served.session().await;
        let opened = AxesClient::open(&session, AxesService::Disable).unwrap();
        let mut client = AxesClient { timeout: Duration::from_millis(300), ..opened };
        let accepted = Event { kind: "accepted".to_owned(), source: "machine".to_owned(), ..Event::default() };
        for _ in 0..50 {
            events.publish(&accepted).unwrap();
            sleep(Duration::from_millis(20)).await;
        }
        sleep(Duration::from_millis(300)).await;
        let failure = timeout(LONG, client.command(&names(&["x"]))).await.expect("an end in time").unwrap_err();
        assert!(failure.to_string().contains("no answer within 0.3 s"), "{failure}");
    }

    #[tokio::test(flavor = "multi_thread", worker_threads = 2)]
    async fn unknown_axis_is_reported_although_the_request_for_the_others_fails() {
        let served = TestNode::start("unknown_unanswered");
        let mut server = served.node.service::<AxesCommand>("~/disable", Qos::SERVICE).unwrap();
        let session = served.session().await;
        let opened = AxesClient::open(&session, AxesService::Disable).unwrap();
        let mut client = AxesClient { timeout: Duration::from_secs(1), ..opened };
        let unknown = "no axis is called `xx`; there are x, y";
        let node = async {
            let Request { reply, .. } = next(&mut server).await;
            reply.send(AxesCommandResponse { success: false, message: unknown.to_owned() }).await.unwrap();
        };
        let axes = names(&["x", "xx"]);
        let (outcome, ()) = tokio::join!(client.command(&axes), node);
        let unanswered = "no answer within 1 s; the axes may still move; `lineshaft state` shows them";
        let failure = Some(format!("{unknown}; {}/disable: {unanswered}", session.target()));
        assert_eq!(outcome, Ok(Outcome { done: None, failure }));
    }
}
