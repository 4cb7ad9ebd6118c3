//! Tests of services of this crate with clients that use the DDS library directly.

use std::future::poll_fn;
use std::net::Ipv4Addr;
use std::time::Duration;

use lineshaft_msgs::cdr::encode;
use lineshaft_msgs::srv::{AxesCommand, AxesCommandRequest, AxesCommandResponse};
use tokio::time::{sleep, timeout};

use super::dds::{Discovery, Participant};
use crate::layer::{Environment, Networks, Node, NodeName, Qos};

/// Timeout that is far longer than any step.
const LONG: Duration = Duration::from_secs(20);

fn axes(axis: &str) -> AxesCommandRequest {
    AxesCommandRequest { axes: vec![axis.to_owned()] }
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn client_that_reads_no_replies_does_not_block_others() {
    // As in the tests of the layer: domains that tests with other peers do not use.
    let domain = 201 + u16::try_from(std::process::id() % 32).unwrap();
    let environment = Environment { domain, networks: Networks::Loopback };
    let node = |name| Node::new(NodeName::new("/", name).unwrap(), &environment).unwrap();
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
