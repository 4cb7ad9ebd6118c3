use proptest::prelude::*;

use super::*;

fn open(registry: &Arc<Registry>, kind: EndpointKind, name: &str, qos: Qos) -> (Writer, Reader) {
    registry.open(kind, name.to_owned(), WireType::default(), qos)
}

fn publisher(registry: &Arc<Registry>, name: &str, qos: Qos) -> Writer {
    open(registry, EndpointKind::Publisher, name, qos).0
}

fn subscription(registry: &Arc<Registry>, name: &str, qos: Qos) -> Reader {
    open(registry, EndpointKind::Subscription, name, qos).1
}

fn server(registry: &Arc<Registry>) -> (Writer, Reader) {
    open(registry, EndpointKind::Server, "/service", Qos::SERVICE)
}

fn caller() -> Caller {
    Caller(Bytes::from_static(&[9]))
}

fn join() -> Join {
    Join {
        domain: 7,
        networks: None,
        namespace: "/".to_owned(),
        name: "n".to_owned(),
        dead: Vec::new(),
        predecessor: None,
    }
}

fn all(orders: &Orders) -> Vec<Order> {
    let all: Vec<_> = orders.queue.try_iter().collect();
    orders.queued.fetch_sub(all.iter().map(size).sum(), Ordering::Relaxed);
    all
}

#[tokio::test]
async fn new_side_receives_complete_state() {
    let registry = Arc::new(Registry::default());
    let first = registry.begin(join());
    let stream = publisher(&registry, "/stream", Qos::STREAM);
    let latched = publisher(&registry, "/latched", Qos::STATUS);
    let (service, mut requests) = server(&registry);
    let gone = publisher(&registry, "/gone", Qos::STREAM);
    drop(gone);
    stream.write(vec![1]).unwrap();
    latched.write(vec![2]).unwrap();
    latched.write(vec![3]).unwrap();
    let open = service.reply(caller(), vec![4].into());
    let answered = service.reply(caller(), vec![5].into());
    registry.handle_report(1, Report::Replied(1, Ok(())));
    assert_eq!(answered.await, Ok(()));
    registry.handle_report(1, Report::Matched(0, 2));
    for _ in 0..5 {
        registry.handle_report(1, Report::Taken(2, Ok(Sample::default())));
    }
    requests.next().await.unwrap();
    assert_eq!((all(&first).len(), stream.matched()), (11, 2), "one order for each step");

    registry.end();
    assert_eq!(stream.matched(), 0, "of a side that is no more");
    stream.write(vec![6]).unwrap();
    let second = registry.begin(join());
    let told = all(&second);
    let [Order::Join(_), Order::Open(0, _), Order::Open(1, _), latest, Order::Open(2, spec), reply] = told.as_slice()
    else {
        panic!("{told:?}")
    };
    assert_eq!(latest, &Order::Write(1, vec![3].into()), "the latched value; no side received the published one");
    assert_eq!((spec.kind, spec.credit), (EndpointKind::Server, CREDIT - 4), "four wait here");
    let Order::Reply(2, reply) = reply else { panic!("{reply:?}") };
    assert_eq!((reply.token, reply.bytes[0], reply.patience_ms), (0, 4, 10_000));
    registry.handle_report(2, Report::Replied(0, Err(ReplyFailure::NoReader)));
    assert_eq!(open.await, Err(ReplyFailure::NoReader));
}

/// A request of a client may be answered after its server was dropped.
#[test]
fn endpoint_is_closed_when_both_parts_are_dropped() {
    let registry = Arc::new(Registry::default());
    let orders = registry.begin(join());
    let (service, requests) = server(&registry);
    drop(requests);
    registry.handle_report(1, Report::Taken(0, Ok(Sample::default())));
    drop(service.reply(caller(), vec![4].into()));
    drop(service);
    let told = all(&orders);
    let [Order::Join(_), Order::Open(0, _), Order::Reply(0, _), Order::Close(0)] = told.as_slice() else {
        panic!("{told:?}")
    };
}

#[tokio::test]
async fn samples_are_forwarded_at_rate_of_reader() {
    let registry = Arc::new(Registry::default());
    let orders = registry.begin(join());
    let mut reader = subscription(&registry, "/a", Qos::STREAM);
    all(&orders);
    for taken in 1..=CREDIT {
        registry.handle_report(1, Report::Taken(0, Ok(Sample::default())));
        reader.next().await.unwrap();
        let wanted = if taken % 8 == 0 { vec![Order::More(0, 8)] } else { Vec::new() };
        assert_eq!(all(&orders), wanted, "{taken}");
    }
}

#[test]
fn queue_of_blocked_side_is_bounded() {
    let registry = Arc::new(Registry::default());
    let orders = registry.begin(join());
    let (stream, latched) = (publisher(&registry, "/a", Qos::STREAM), publisher(&registry, "/b", Qos::STATUS));
    let megabyte = Bytes::from(vec![0; 1 << 20]);
    let written = (0..100).take_while(|_| stream.write(megabyte.clone()).is_ok()).count();
    assert_eq!(written, 64);
    assert_eq!(latched.write(vec![1]), Ok(()), "the newest value that counts is never left out");
    all(&orders);
    assert_eq!(stream.write(megabyte), Ok(()));
    registry.close_all();
    assert_eq!(stream.write(vec![1]), Err(WriteError::Closed));
}

fn sample_of(number: i64, is_stale: bool) -> Result<Sample, String> {
    let id = SampleId { number, ..SampleId::default() };
    Ok(Sample { id, is_stale, ..Sample::default() })
}

#[tokio::test]
async fn handover_transfers_open_state() {
    let registry = Arc::new(Registry::default());
    let first = registry.begin(join());
    let stream = publisher(&registry, "/stream", Qos::STREAM);
    let latched = publisher(&registry, "/latched", Qos::STATUS);
    let (service, _requests) = server(&registry);
    latched.write(vec![1]).unwrap();
    registry.handle_report(1, Report::Matched(0, 2));
    all(&first);

    let second = registry.begin_next(join());
    let told = all(&second);
    let [Order::Join(_), Order::Open(0, _), Order::Open(1, _), Order::Write(1, _), Order::Open(2, _)] = told.as_slice()
    else {
        panic!("{told:?}")
    };
    stream.write(vec![2]).unwrap();
    latched.write(vec![3]).unwrap();
    let answered = service.reply(caller(), vec![4].into());
    let unanswered = service.reply(caller(), vec![5].into());
    let late = publisher(&registry, "/late", Qos::STREAM);
    registry.order_side(2, Order::Probe(5));
    assert_eq!(all(&first).len(), 5, "all but the probe");
    let told = all(&second);
    let [Order::Write(1, latest), Order::Open(3, _), Order::Probe(5)] = told.as_slice() else { panic!("{told:?}") };
    assert_eq!(latest, &vec![3]);

    registry.handle_report(2, Report::Matched(0, 1));
    assert_eq!((stream.matched(), registry.is_next_matched()), (2, false), "the present side counts");
    registry.handle_report(2, Report::Matched(0, 2));
    assert!(registry.is_next_matched());
    registry.handle_report(2, Report::Matched(3, 1));
    registry.hand_over();
    assert_eq!((stream.matched(), late.matched()), (2, 1));
    stream.write(vec![6]).unwrap();
    let after = service.reply(caller(), vec![7].into());
    let told = all(&second);
    let [Order::Write(0, _), Order::Reply(2, reply)] = told.as_slice() else { panic!("{told:?}") };
    assert_eq!((reply.token, registry.previous_has_replies()), (2, true));
    registry.handle_report(1, Report::Replied(0, Ok(())));
    assert_eq!((answered.await, registry.previous_has_replies()), (Ok(()), true));
    registry.end_previous();
    assert_eq!((first.next(), registry.previous_has_replies()), (None, false), "it has to end");
    let told = all(&second);
    let [Order::Reply(2, reply)] = told.as_slice() else { panic!("{told:?}") };
    assert_eq!((reply.token, reply.patience_ms), (1, 10_000), "what the first one has not replied");
    registry.handle_report(2, Report::Replied(1, Ok(())));
    registry.handle_report(2, Report::Replied(2, Ok(())));
    assert_eq!((unanswered.await, after.await), (Ok(()), Ok(())));
    registry.handle_report(1, Report::Matched(0, 0));
    assert_eq!(stream.matched(), 2, "the side that ends has lost them");
    registry.end_handover();
    registry.end();
    assert_eq!(late.matched(), 0);
}

#[tokio::test]
async fn both_sides_have_credit_for_what_is_taken() {
    let registry = Arc::new(Registry::default());
    let first = registry.begin(join());
    let mut reader = subscription(&registry, "/a", Qos::STREAM);
    let second = registry.begin_next(join());
    all(&first);
    all(&second);
    for number in 1..=3 * i64::from(CREDIT) {
        registry.handle_report(1, Report::Taken(0, sample_of(number, false)));
        registry.handle_report(2, Report::Taken(0, sample_of(number, false)));
        reader.next().await.unwrap();
    }
    assert_eq!(all(&first), vec![Order::More(0, 8); 12]);
    assert_eq!(all(&second), vec![Order::More(0, 8); 12]);
}

#[tokio::test]
async fn a_next_side_that_fails_changes_nothing() {
    let registry = Arc::new(Registry::default());
    let first = registry.begin(join());
    let mut reader = subscription(&registry, "/a", Qos::STREAM);
    let second = registry.begin_next(join());
    registry.handle_report(2, Report::Taken(0, sample_of(1, true)));
    registry.handle_report(2, Report::Taken(0, Err("broken".to_owned())));
    assert_eq!(all(&second)[2..], [Order::More(0, 1), Order::More(0, 1)], "what it drops does not hold it up");
    registry.end_handover();
    assert_eq!(second.next(), None);
    all(&first);
    registry.handle_report(1, Report::Taken(0, sample_of(1, true)));
    registry.handle_report(1, Report::Taken(0, Err("broken".to_owned())));
    assert!(reader.next().await.unwrap().is_stale);
    assert_eq!(reader.next().await, Err("broken".to_owned()));
    assert_eq!(all(&first), []);
}

proptest! {
    /// Both sides receive all samples of a writer from some number, at different times; the first side until it has ended.
    #[test]
    fn sample_received_by_two_sides_is_forwarded_once(
        heard in prop::collection::vec((any::<bool>(), 1..30_i64), 0..80), handover in 0..80_usize,
    ) {
        let registry = Arc::new(Registry::default());
        let _sides = (registry.begin(join()), registry.begin_next(join()));
        let mut reader = subscription(&registry, "/a", Qos::STREAM);
        let mut expected = Vec::new();
        for (place, (is_second, number)) in heard.iter().enumerate() {
            if place == handover {
                registry.hand_over();
            }
            registry.handle_report(if *is_second { 2 } else { 1 }, Report::Taken(0, sample_of(*number, false)));
            if !expected.contains(number) {
                expected.push(*number);
            }
        }
        let passed: Vec<_> = std::iter::from_fn(|| reader.samples.try_recv().ok()).map(|sample| sample.unwrap().id.number).collect();
        prop_assert_eq!(passed, expected);
    }
}
