//! Tests of services of this crate with clients that use the DDS library directly.

use std::future::poll_fn;
use std::net::Ipv4Addr;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::channel;
use std::time::Duration;

use lineshaft_msgs::cdr::encode;
use lineshaft_msgs::msg::AxisStates;
use lineshaft_msgs::srv::{AxesCommand, AxesCommandRequest, AxesCommandResponse};
use tokio::time::{sleep, timeout};

use super::dds::{Discovery, Participant};
use super::member::Member;
use crate::layer::{Environment, Networks, Node, NodeName, Qos};
use crate::link::protocol::{EndpointKind, Join, Order, Spec, WireType};

/// Timeout that is far longer than any step.
const LONG: Duration = Duration::from_secs(20);

/// As in the tests of the layer: a domain that tests with other peers do not use.
fn domain() -> u16 {
    201 + u16::try_from(std::process::id() % 32).unwrap()
}

fn node(name: &str) -> Node {
    let environment = Environment { domain: domain(), networks: Networks::Loopback };
    Node::new(NodeName::new("/", name).unwrap(), &environment).unwrap()
}

fn axes(axis: &str) -> AxesCommandRequest {
    AxesCommandRequest { axes: vec![axis.to_owned()] }
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn client_that_reads_no_replies_does_not_block_others() {
    let domain = domain();
    let (serving, asking) = (node("patience"), node("patience_client"));
    let mut server = serving.service::<AxesCommand>("~/enable", Qos::SERVICE).unwrap();
    let other = Participant::new(domain, Some(&[Ipv4Addr::LOCALHOST])).unwrap();
    let type_name = "lineshaft_msgs::srv::dds_::AxesCommand_Request_";
    let deaf = other.writer("rq/patience/enableRequest", type_name, Qos::SERVICE).unwrap();
    let matched = async {
        loop {
            let change = poll_fn(|context| other.poll_discovery(context)).await.expect("discovery does not end");
            if matches!(change, Discovery::Matched { writer, .. } if writer == deaf.guid()) {
                break;
            }
        }
    };
    timeout(LONG, matched).await.expect("a server");
    deaf.write(encode(&axes("deaf"))).unwrap();
    let unread = timeout(LONG, server.next()).await.unwrap().unwrap();
    let waiting = tokio::spawn(unread.reply.send(AxesCommandResponse::default()));

    let mut client = asking.client::<AxesCommand>("/patience/enable", Qos::SERVICE).unwrap();
    let matched = async {
        while client.servers() == 0 {
            sleep(Duration::from_millis(2)).await;
        }
    };
    timeout(LONG, matched).await.expect("a server");
    let number = client.send(&axes("x")).unwrap();
    let request = timeout(LONG, server.next()).await.unwrap().unwrap();
    request.reply.send_soon(AxesCommandResponse { success: true, message: "done".to_owned() });
    assert_eq!(timeout(LONG, client.reply(number)).await.unwrap().unwrap().message, "done");
    let error = timeout(LONG, waiting).await.unwrap().unwrap().unwrap_err();
    assert_eq!(error.to_string(), "/patience/enable: the client that asked is not there to read the reply");
}

/// A reader that is opened right after another one was closed must not be announced under the number of the disposal.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn client_that_is_created_when_a_subscription_ends_gets_its_replies() {
    let (serving, asking) = (node("numbers"), node("numbers_client"));
    let mut server = serving.service::<AxesCommand>("~/enable", Qos::SERVICE).unwrap();
    tokio::spawn(async move {
        while let Some(request) = server.next().await {
            request.reply.send_soon(AxesCommandResponse { success: true, message: String::new() });
        }
    });
    for round in 0..20 {
        drop(asking.subscription::<AxisStates>("/numbers/axis_states", Qos::STREAM).unwrap());
        let mut client = asking.client::<AxesCommand>("/numbers/enable", Qos::SERVICE).unwrap();
        let answered = async {
            while client.servers() == 0 {
                sleep(Duration::from_millis(2)).await;
            }
            let number = client.send(&axes("x")).unwrap();
            client.reply(number).await.unwrap()
        };
        assert!(timeout(LONG, answered).await.unwrap_or_else(|_| panic!("no reply in round {round}")).success);
    }
}

/// The only worker of the runtime is busy when the subscription is closed: its reader cannot be dropped before.
#[test]
fn closed_subscription_is_dropped_before_the_next_order() {
    let runtime = tokio::runtime::Builder::new_multi_thread().worker_threads(1).enable_all().build().unwrap();
    let (reports, _kept) = channel();
    let join = Join {
        domain: domain(),
        networks: Some(vec![Ipv4Addr::LOCALHOST]),
        namespace: "/".to_owned(),
        name: "closing".to_owned(),
        dead: vec![],
        predecessor: None,
    };
    let mut member = Member::join(&join, reports, runtime.handle().clone()).unwrap();
    let wire = WireType { name: "lineshaft_msgs/msg/AxisStates".to_owned(), ..WireType::default() };
    let name = "/closing/axis_states".to_owned();
    member.follow(Order::Open(0, Spec { kind: EndpointKind::Subscription, name, wire, qos: Qos::STREAM, credit: 1 }));
    let (begun, is_begun) = channel();
    let is_free = Arc::new(AtomicBool::new(false));
    let frees = Arc::clone(&is_free);
    runtime.spawn(async move {
        begun.send(()).unwrap();
        std::thread::sleep(Duration::from_millis(800));
        frees.store(true, Ordering::SeqCst);
    });
    is_begun.recv().unwrap();
    member.follow(Order::Close(0));
    assert!(is_free.load(Ordering::SeqCst));
}
