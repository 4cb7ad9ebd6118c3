//! Time from a SYNC to the answers of the drives, measured through the transport of this program.
//!
//! `cargo bench -p lineshaft-can --bench latency -- ADDRESS COUNT NODE..` sends COUNT SYNCs. Each SYNC is sent when all nodes have answered
//! the previous one with their TPDO 1. The result is one line of JSON. The nodes must be configured, and no other program may use them.
//! `tests/soak/can_peers.py` runs it.

use lineshaft_can::transport::{Address, Options, open};
use lineshaft_can::{Frame, Id, NmtCommand, NodeId};
use std::thread::{sleep, yield_now};
use std::time::{Duration, Instant};

/// Time after which an answer counts as lost.
const PATIENCE: Duration = Duration::from_millis(100);

fn main() {
    let words: Vec<String> = std::env::args().skip(1).filter(|word| word != "--bench").collect();
    let [address, count, nodes @ ..] = words.as_slice() else {
        println!("nothing is measured: give ADDRESS COUNT NODE..");
        return;
    };
    let address: Address = address.parse().expect("an address of a bus");
    let count: usize = count.parse().expect("a number of SYNCs");
    let tpdo =
        |text: &String| NodeId::new(text.parse().ok()?).and_then(|node| Id::new(0x180 + u16::from(node.get())).ok());
    let answers: Vec<Id> = nodes.iter().map(|node| tpdo(node).expect("a node, 1 to 127")).collect();
    let mut way = open(&address, Options { bit_rate: 1_000_000, baud: None }).expect("the bus is there");
    let sync = Frame::data(Id::SYNC, &[]).expect("no data");
    way.send(&NmtCommand::Start.frame(None)).expect("there is room");
    sleep(PATIENCE);
    let (mut times_us, mut lost) = (Vec::with_capacity(count), 0);
    for _ in 0..count {
        while way.receive().expect("the bus is there").is_some() {}
        let (begin, mut left) = (Instant::now(), answers.clone());
        way.send(&sync).expect("there is room");
        while !left.is_empty() && begin.elapsed() < PATIENCE {
            match way.receive().expect("the bus is there") {
                Some(frame) => left.retain(|id| *id != frame.id()),
                // The process that answers shares the processors with this one.
                None => yield_now(),
            }
        }
        if left.is_empty() {
            times_us.push(begin.elapsed().as_secs_f64() * 1e6);
        } else {
            lost += 1;
        }
    }
    way.send(&NmtCommand::EnterPreOperational.frame(None)).expect("there is room");
    sleep(PATIENCE);
    way.close();
    times_us.sort_by(f64::total_cmp);
    let at = |share: f64| times_us.get((times_us.len() as f64 * share) as usize).copied().unwrap_or(f64::NAN);
    println!(
        "{{\"count\": {}, \"lost\": {lost}, \"p50_us\": {:.0}, \"p99_us\": {:.0}}}",
        times_us.len(),
        at(0.5),
        at(0.99)
    );
}
