//! Tests of the layer against itself, over loopback. Clients of ROS are tested elsewhere, with other libraries.

use std::marker::PhantomData;
use std::time::Duration;

use lineshaft_msgs::action::{HomeAxis, HomeAxisFeedback, HomeAxisGoal, HomeAxisResult};
use lineshaft_msgs::cdr::encode;
use lineshaft_msgs::foreign::action_msgs::srv::{CancelGoal, CancelGoalRequest, CancelGoalResponse};
use lineshaft_msgs::foreign::builtin_interfaces::msg::Time;
use lineshaft_msgs::foreign::unique_identifier_msgs::msg::UUID;
use lineshaft_msgs::srv::{AxesCommand, AxesCommandRequest, AxesCommandResponse};
use lineshaft_msgs::{GetResult, GetResultRequest, GetResultResponse, SendGoal, SendGoalRequest, Service};
use tokio::time::{sleep, timeout};

use super::*;
use crate::link::protocol::{EndpointKind, WireType};
use crate::link::{Reader, Writer};

/// Timeout that is far longer than any step.
const LONG: Duration = Duration::from_secs(20);

/// Returns a domain that tests with other peers (10 to 101) do not use, and concurrent runs of these tests seldom.
fn environment() -> Environment {
    let domain = 201 + u16::try_from(std::process::id() % 32).unwrap();
    Environment { domain, networks: Networks::Loopback }
}

fn node(name: &str) -> Node {
    Node::new(NodeName::new("/", name).unwrap(), &environment()).unwrap()
}

struct Client<S> {
    requests: Writer,
    replies: Reader,
    service: PhantomData<S>,
}

impl<S: Service> Client<S> {
    /// Creates a client; completes once it is matched with the server.
    async fn new(node: &Node, name: &str) -> Self {
        let name = node.name().expand(name).unwrap();
        let (requests, replies) =
            node.context().open(EndpointKind::Client, &name, WireType::service::<S>(), Qos::SERVICE);
        let matched = async {
            while requests.matched() == 0 {
                sleep(Duration::from_millis(2)).await;
            }
        };
        timeout(LONG, matched).await.expect("a server");
        Self { replies, requests, service: PhantomData }
    }

    fn send(&self, request: &S::Request) {
        self.requests.write(encode(request)).unwrap();
    }

    async fn receive(&mut self) -> S::Response {
        let sample = timeout(LONG, self.replies.next()).await.expect("a reply").unwrap();
        assert!(sample.answers.is_some(), "the client knows its reply by it");
        sample.decode().unwrap()
    }

    async fn call(&mut self, request: &S::Request) -> S::Response {
        self.send(request);
        self.receive().await
    }
}

fn axes(axis: &str) -> AxesCommandRequest {
    AxesCommandRequest { axes: vec![axis.to_owned()] }
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn requests_are_open_at_the_same_time_and_bad_ones_are_not_handed_out() {
    let (serving, asking) = (node("requests"), node("requests_client"));
    let mut server = serving.service::<AxesCommand>("~/enable", Qos::SERVICE).unwrap();
    let mut client = Client::<AxesCommand>::new(&asking, "/requests/enable").await;

    client.send(&axes("first"));
    client.requests.write([encode(&axes("bad")), vec![0; 8]].concat()).unwrap();
    client.send(&axes("second"));
    let mut open = Vec::new();
    for want in ["first", "second"] {
        let Request { message, reply } = timeout(LONG, server.next()).await.unwrap().unwrap();
        assert_eq!(message, axes(want));
        open.push((message, reply));
    }
    // The later request is answered first.
    while let Some((message, reply)) = open.pop() {
        let response = AxesCommandResponse { success: true, message: message.axes[0].clone() };
        reply.send(response.clone()).await.unwrap();
        assert_eq!(client.receive().await, response);
    }
    drop(serving);
    assert!(timeout(LONG, server.next()).await.unwrap().is_none(), "a server ends with its node");
}

/// A request of one name with 8 characters could be read with the header of another kind of client as well.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn request_with_a_name_of_any_length_is_answered() {
    let (serving, asking) = (node("lengths"), node("lengths_client"));
    let mut server = serving.service::<AxesCommand>("~/halt", Qos::SERVICE).unwrap();
    let mut client = Client::<AxesCommand>::new(&asking, "/lengths/halt").await;
    for length in 1..=32 {
        let name = "x".repeat(length);
        client.send(&axes(&name));
        let Request { message, reply } = timeout(LONG, server.next()).await.expect("the request").unwrap();
        assert_eq!(message, axes(&name));
        reply.send(AxesCommandResponse { success: true, message: name.clone() }).await.unwrap();
        assert_eq!(client.receive().await.message, name);
    }
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn request_that_cannot_be_read_is_answered_if_the_service_gives_reasons() {
    let (serving, asking) = (node("answered"), node("answered_client"));
    let server = serving.service::<AxesCommand>("~/halt", Qos::SERVICE).unwrap();
    let refusal = |_: &AxesCommandRequest, message: String| AxesCommandResponse { success: false, message };
    let mut server = server.with_policy(RequestPolicy::Stops(refusal));
    let mut client = Client::<AxesCommand>::new(&asking, "/answered/halt").await;
    client.requests.write([encode(&axes("bad")), vec![0; 8]].concat()).unwrap();
    client.send(&axes("good"));
    let Request { message, reply } = timeout(LONG, server.next()).await.expect("the request").unwrap();
    assert_eq!(message, axes("good"));
    let AxesCommandResponse { success, message } = client.receive().await;
    assert!(!success && message.starts_with("the request was refused: ") && message.contains("left over"), "{message}");
    reply.send(AxesCommandResponse { success: true, message: "done".to_owned() }).await.unwrap();
    assert_eq!(client.receive().await.message, "done");
}

/// The side returns the requests of the client with the lowest number before all others.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn busy_client_does_not_block_others() {
    let (serving, first, second) = (node("fair"), node("fair_first"), node("fair_second"));
    let mut server = serving.service::<AxesCommand>("~/enable", Qos::SERVICE).unwrap();
    let clients = [
        Client::<AxesCommand>::new(&first, "/fair/enable").await,
        Client::<AxesCommand>::new(&second, "/fair/enable").await,
    ];
    let names = ["first", "second"];
    for (client, name) in clients.iter().zip(names) {
        client.send(&axes(name));
    }
    let mut answered = [0; 2];
    for _ in 0..8 {
        // All sent requests have arrived.
        sleep(Duration::from_millis(100)).await;
        let request = timeout(LONG, server.next()).await.unwrap().unwrap();
        let who = usize::from(request.message == axes(names[1]));
        answered[who] += 1;
        request.reply.send_soon(AxesCommandResponse::default());
        clients[who].send(&axes(names[who]));
    }
    assert_eq!(answered, [4, 4]);
}

struct Asking {
    goals: Client<SendGoal<HomeAxis>>,
    results: Client<GetResult<HomeAxis>>,
    cancels: Client<CancelGoal>,
    _node: Node,
}

impl Asking {
    async fn new(name: &str) -> Self {
        let node = node(&format!("{name}_client"));
        let part = |part: &str| format!("/{name}/home_axis/_action/{part}");
        Self {
            goals: Client::new(&node, &part("send_goal")).await,
            results: Client::new(&node, &part("get_result")).await,
            cancels: Client::new(&node, &part("cancel_goal")).await,
            _node: node,
        }
    }

    fn send_goal(&self, id: u8) {
        let goal = HomeAxisGoal { axis: "x".to_owned(), scheme: 0, method: 35 };
        self.goals.send(&SendGoalRequest { goal_id: UUID { uuid: [id; 16] }, goal });
    }

    async fn result(&mut self, id: u8) -> (i8, HomeAxisResult) {
        let GetResultResponse { status, result } =
            self.results.call(&GetResultRequest { goal_id: UUID { uuid: [id; 16] } }).await;
        (status, result)
    }

    fn send_cancel(&self, id: u8) {
        let mut request = CancelGoalRequest::default();
        request.goal_info.goal_id.uuid = [id; 16];
        self.cancels.send(&request);
    }
}

async fn goal(server: &mut ActionServer<HomeAxis>) -> GoalRequest<HomeAxis> {
    match timeout(LONG, server.next()).await.unwrap().unwrap() {
        ActionEvent::Goal(request) => request,
        ActionEvent::Cancel(_) => panic!("a cancel request in place of a goal"),
    }
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn dropped_requests_are_rejected_and_dropped_goals_aborted() {
    let serving = node("drops");
    let mut server = serving.action::<HomeAxis>("~/home_axis", ActionOptions::default()).unwrap();
    let mut client = Asking::new("drops").await;

    client.send_goal(1);
    drop(goal(&mut server).await);
    assert!(!client.goals.receive().await.accepted);
    assert_eq!(client.result(1).await, (0, HomeAxisResult::default()), "a rejected goal is not known");

    client.send_goal(2);
    let handle = goal(&mut server).await.accept();
    assert!(client.goals.receive().await.accepted);
    handle.execute();
    handle.feedback(&HomeAxisFeedback::default()).unwrap();
    drop(handle);
    assert_eq!(client.result(2).await, (6, HomeAxisResult::default()));

    client.send_goal(2);
    assert!(!client.goals.receive().await.accepted, "the id is in use");
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn application_decides_about_cancel_requests_with_policy_ask() {
    let serving = node("asks");
    let options = ActionOptions { cancels: CancelPolicy::Ask, ..ActionOptions::default() };
    let mut server = serving.action::<HomeAxis>("~/home_axis", options).unwrap();
    let mut client = Asking::new("asks").await;
    client.send_goal(1);
    let handle = goal(&mut server).await.accept();
    client.goals.receive().await;
    handle.execute();

    type Decide = fn(CancelRequest<HomeAxis>);
    let decisions: [(Decide, i8); 3] = [(drop, 1), (CancelRequest::reject, 1), (CancelRequest::accept, 0)];
    for (decide, code) in decisions {
        assert!(!handle.is_cancel_requested());
        client.send_cancel(1);
        match timeout(LONG, server.next()).await.unwrap().unwrap() {
            ActionEvent::Cancel(request) => {
                assert_eq!(request.goals(), [GoalId([1; 16])]);
                decide(request);
            }
            ActionEvent::Goal(_) => panic!("a goal in place of a cancel request"),
        }
        let CancelGoalResponse { return_code, goals_canceling } = client.cancels.receive().await;
        assert_eq!((return_code, goals_canceling.len()), (code, usize::from(code == 0)));
    }
    timeout(LONG, handle.cancel_requested()).await.unwrap();
    client.send_cancel(1);
    assert_eq!(client.cancels.receive().await.return_code, 0, "it is canceling already: nobody is asked again");

    handle.canceled(HomeAxisResult { shift_increments: 7, ..HomeAxisResult::default() });
    let (status, result) = client.result(1).await;
    assert_eq!((status, result.shift_increments), (5, 7));
    client.send_cancel(1);
    assert_eq!(client.cancels.receive().await.return_code, 3, "it has ended");
}

/// An interrupted client cancels all goals without waiting for the acceptance of the goal that it has sent.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn cancel_of_all_goals_includes_undecided_goal() {
    let serving = node("cancels");
    let mut server = serving.action::<HomeAxis>("~/home_axis", ActionOptions::default()).unwrap();
    let mut client = Asking::new("cancels").await;
    client.send_goal(1);
    let undecided = goal(&mut server).await;
    client.send_cancel(0);
    let CancelGoalResponse { return_code, goals_canceling } = client.cancels.receive().await;
    assert_eq!((return_code, goals_canceling.len()), (0, 1));
    let handle = undecided.accept();
    assert!(handle.is_cancel_requested());
    handle.canceled(HomeAxisResult::default());
    assert_eq!(client.result(1).await.0, 5);
    // Sends the two requests at once, to different services.
    let mut count = 0;
    for id in 2..22 {
        client.send_goal(id);
        client.send_cancel(if id % 2 == 0 { 0 } else { id });
        let handle = goal(&mut server).await.accept();
        if client.cancels.receive().await.goals_canceling.is_empty() {
            // The datagram of the goal was lost, or the machine is busy: the goal arrives after the answer of the cancel request.
            handle.abort(HomeAxisResult::default());
            continue;
        }
        timeout(LONG, handle.cancel_requested()).await.expect("it is canceled");
        handle.canceled(HomeAxisResult::default());
        count += 1;
    }
    assert!(count >= 17, "{count} of 20 goals were canceled");
}

/// Cancel of all goals cancels running ones at once, and its answer waits for goals that arrive late: it also lists those that have ended
/// meanwhile.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn answer_to_a_cancel_of_all_goals_lists_a_goal_that_has_ended_before_it() {
    let serving = node("quick_cancel");
    let mut server = serving.action::<HomeAxis>("~/home_axis", ActionOptions::default()).unwrap();
    let mut client = Asking::new("quick_cancel").await;
    client.send_goal(1);
    let handle = goal(&mut server).await.accept();
    handle.execute();
    client.send_cancel(0);
    timeout(LONG, handle.cancel_requested()).await.expect("it is canceled");
    handle.canceled(HomeAxisResult::default());
    let CancelGoalResponse { return_code, goals_canceling } = client.cancels.receive().await;
    assert_eq!((return_code, goals_canceling.len()), (0, 1));
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn goals_are_stamped_by_the_clock_of_the_node() {
    let serving = node("stamps");
    let mut server = serving.action::<HomeAxis>("~/home_axis", ActionOptions::default()).unwrap();
    let mut client = Asking::new("stamps").await;
    let stamp = Time { sec: 7, nanosec: 1 };
    serving.clock().simulate(true);
    serving.clock().set(&stamp);
    client.send_goal(1);
    let accepted = goal(&mut server).await.accept();
    assert_eq!(client.goals.receive().await.stamp, stamp);
    client.send_goal(2);
    goal(&mut server).await.reject();
    assert_eq!(client.goals.receive().await.stamp, stamp);
    drop(accepted);
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn objects_that_outlive_node_are_safe() {
    let gone = node("gone");
    let publisher = gone.publisher::<Time>("t", Qos::STREAM).unwrap();
    let mut actions = gone.action::<HomeAxis>("~/home_axis", ActionOptions::default()).unwrap();
    let rosout = gone.rosout().unwrap();
    publisher.publish(&now()).unwrap();
    drop(gone);
    let error = publisher.publish(&now()).unwrap_err();
    assert_eq!(error.to_string(), "/t: not published: the node is closed");
    assert!(timeout(LONG, actions.next()).await.unwrap().is_none());
    rosout.log(Severity::Info, "nobody hears it", Source::default());
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn client_finds_the_reply_of_each_request_in_any_order() {
    let (serving, asking) = (node("answers"), node("answers_client"));
    let mut server = serving.service::<AxesCommand>("~/enable", Qos::SERVICE).unwrap();
    let mut client = asking.client::<AxesCommand>("/answers/enable", Qos::SERVICE).unwrap();
    let matched = async {
        while client.servers() == 0 {
            sleep(Duration::from_millis(2)).await;
        }
    };
    timeout(LONG, matched).await.expect("a server");
    let numbers = ["first", "second"].map(|axis| client.send(&axes(axis)).unwrap());
    let mut open = Vec::new();
    for _ in numbers {
        open.push(timeout(LONG, server.next()).await.unwrap().unwrap());
    }
    // The later request is answered first.
    while let Some(Request { message, reply }) = open.pop() {
        reply.send(AxesCommandResponse { success: true, message: message.axes[0].clone() }).await.unwrap();
    }
    for (number, want) in numbers.into_iter().zip(["first", "second"]) {
        assert_eq!(timeout(LONG, client.reply(number)).await.unwrap().unwrap().message, want);
    }
    drop(asking);
    let number = client.send(&axes("late"));
    let error = match number {
        Ok(number) => timeout(LONG, client.reply(number)).await.unwrap().unwrap_err(),
        Err(error) => error,
    };
    assert!(error.to_string().starts_with("/answers/enable: "), "{error}");
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn goal_of_a_client_reports_feedback_and_ends_canceled() {
    let (serving, asking) = (node("serves"), node("serves_client"));
    let mut server = serving.action::<HomeAxis>("~/home_axis", ActionOptions::default()).unwrap();
    let mut client = asking.action_client::<HomeAxis>("/serves/home_axis").unwrap();
    let matched = async {
        while client.servers() != [1; 3] {
            sleep(Duration::from_millis(2)).await;
        }
    };
    timeout(LONG, matched).await.expect("a server");
    let (id, number) = client.send_goal(HomeAxisGoal { axis: "x".to_owned(), scheme: 0, method: 35 }).unwrap();
    let handle = goal(&mut server).await.accept();
    assert!(timeout(LONG, client.accepted(number)).await.unwrap().unwrap());
    handle.execute();
    let result = client.request_result(id).unwrap();
    let cancel = client.cancel(id).unwrap();
    assert_eq!(timeout(LONG, client.canceling(cancel)).await.unwrap().unwrap(), 0);
    // The feedback topic may be matched later than the services.
    let mut ticks = tokio::time::interval(Duration::from_millis(20));
    let seen = loop {
        tokio::select! {
            progress = client.result_or_feedback(result) => match progress.unwrap() {
                Progress::Feedback { id, feedback } => break (id, feedback.phase),
                Progress::Ended { .. } => panic!("it has not ended"),
            },
            _ = ticks.tick() => {
                handle.feedback(&HomeAxisFeedback { phase: 2, ..HomeAxisFeedback::default() }).unwrap();
            }
        }
    };
    assert_eq!(seen, (id, 2));
    handle.canceled(HomeAxisResult { shift_increments: 7, ..HomeAxisResult::default() });
    let ended = async {
        loop {
            if let Progress::Ended { status, result } = client.result_or_feedback(result).await.unwrap() {
                break (status, result.shift_increments);
            }
        }
    };
    assert_eq!(timeout(LONG, ended).await.unwrap(), (5, 7));
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn names_of_other_nodes_are_found() {
    let (_other, asking) = (node("found"), node("finds"));
    let mut names = asking.node_names();
    let found = async {
        while !names.so_far().contains("/found") {
            sleep(Duration::from_millis(10)).await;
        }
    };
    timeout(LONG, found).await.expect("the other node");
}
