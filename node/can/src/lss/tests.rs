use super::*;
use proptest::prelude::*;

/// Simulated device according to CiA 305.
#[derive(Clone, Debug)]
struct Slave {
    identity: Identity,
    node: Option<u8>,
    is_configured: bool,
    part: usize,
    matched: usize,
}

impl Slave {
    fn new(identity: Identity) -> Self {
        Self { identity, node: None, is_configured: false, part: 0, matched: 0 }
    }

    fn take(&mut self, frame: &Frame) -> Option<Frame> {
        assert_eq!(frame.id(), Id::LSS_MASTER);
        let bytes: [u8; 8] = frame.bytes().try_into().unwrap();
        let [command, a, b, c, d, checked, part, next] = bytes;
        let number = u32::from_le_bytes([a, b, c, d]);
        let says = |bytes| Some(Frame::of(Id::LSS_SLAVE, bytes));
        match command {
            4 => self.is_configured = a == 1,
            64..=67 => {
                let place = usize::from(command - 64);
                let is_next = place == 0 || place == self.matched;
                self.matched = if is_next && self.identity[place] == number { place + 1 } else { 0 };
                if self.matched == 4 {
                    self.is_configured = true;
                    return says([68, 0, 0, 0, 0, 0, 0, 0]);
                }
            }
            17 if self.is_configured => {
                self.node = Some(a);
                return says([17, 0, 0, 0, 0, 0, 0, 0]);
            }
            19 if self.is_configured => return says([19, u8::from(b == 1), 0, 0, 0, 0, 0, 0]),
            23 if self.is_configured => return says([23, 2, 0, 0, 0, 0, 0, 0]),
            81 if self.node.is_none() && !self.is_configured => {
                if checked == 0x80 {
                    self.part = 0;
                    return says([79, 0, 0, 0, 0, 0, 0, 0]);
                }
                let part = usize::from(part);
                if part == self.part && (self.identity[part] ^ number) >> checked == 0 {
                    self.part = usize::from(next);
                    self.is_configured = checked == 0 && next < part as u8;
                    return says([79, 0, 0, 0, 0, 0, 0, 0]);
                }
            }
            _ => {}
        }
        None
    }
}

/// Runs a search. Returns its result and the number of questions.
fn search(slaves: &mut [Slave]) -> (Outcome, usize) {
    let mut scan = FastScan::default();
    for questions in 1.. {
        let question = scan.next_question();
        let answers: Vec<_> = slaves.iter_mut().filter_map(|slave| slave.take(&question)).collect();
        assert!(answers.iter().all(FastScan::is_answer));
        if let Some(outcome) = scan.next(!answers.is_empty()) {
            return (outcome, questions);
        }
    }
    unreachable!()
}

fn wait(slaves: &mut [Slave]) {
    for slave in slaves {
        assert_eq!(slave.take(&LssCommand::SwitchToWaiting.frame()), None);
    }
}

#[test]
fn a_search_finds_one_device_after_the_other() {
    let [one, two] = [[0x22, 0x1234, 1, 77], [0x22, 0x1234, 1, 76]];
    let mut slaves = [Slave::new(one), Slave::new(two)];
    assert_eq!(search(&mut slaves), (Outcome::Found(two), FastScan::QUESTIONS));
    assert_eq!((slaves[0].is_configured, slaves[1].is_configured), (false, true));
    slaves[1].take(&LssCommand::NodeId(NodeId::new(5).unwrap()).frame());
    wait(&mut slaves);
    assert_eq!(search(&mut slaves).0, Outcome::Found(one));
    slaves[0].take(&LssCommand::NodeId(NodeId::new(6).unwrap()).frame());
    wait(&mut slaves);
    assert_eq!(search(&mut slaves), (Outcome::Nobody, 1));
}

#[test]
fn device_that_stops_answering_is_lost() {
    let mut scan = FastScan::default();
    assert_eq!(scan.next(true), None);
    let outcome = (0..40).find_map(|_| scan.next(false));
    assert_eq!(outcome, Some(Outcome::Lost));
}

#[test]
fn device_is_selected_by_identity_and_configured() {
    let (one, two) = ([1, 2, 3, 4], [1, 2, 3, 5]);
    let mut slaves = [Slave::new(one), Slave::new(two)];
    let mut all = |frame: &Frame| slaves.iter_mut().filter_map(|slave| slave.take(frame)).collect::<Vec<_>>();
    let answers: Vec<_> = select(two).iter().flat_map(&mut all).collect();
    assert!(answers.len() == 1 && is_selected(&answers[0]));
    let mut ask = |command: LssCommand| {
        let answers = all(&command.frame());
        assert_eq!(answers.len(), 1);
        command.result_of(&answers[0])
    };
    let node = LssCommand::NodeId(NodeId::new(9).unwrap());
    assert_eq!(ask(node), Some(Ok(())));
    assert_eq!(ask(LssCommand::BitRate(2)), Some(Ok(())));
    assert_eq!(ask(LssCommand::BitRate(1)), Some(Err(LssError::BitRate)));
    assert_eq!(ask(LssCommand::Store), Some(Err(LssError::Memory)));
    assert_eq!(slaves.map(|slave| slave.node), [None, Some(9)]);
}

#[test]
fn frames_are_those_of_the_standard() {
    let bytes = |frame: Frame| <[u8; 8]>::try_from(frame.bytes()).unwrap();
    assert_eq!(LssCommand::SwitchToWaiting.frame().id().get(), 0x7E5);
    assert_eq!(bytes(LssCommand::NodeId(NodeId::new(5).unwrap()).frame()), [17, 5, 0, 0, 0, 0, 0, 0]);
    assert_eq!(bytes(LssCommand::BitRate(3).frame()), [19, 0, 3, 0, 0, 0, 0, 0]);
    assert_eq!(bytes(FastScan::default().next_question()), [81, 0, 0, 0, 0, 0x80, 0, 0]);
    assert_eq!((bit_rate(1_000_000), bit_rate(10_000), bit_rate(100_000)), (Some(0), Some(8), None));
    let says = |bytes| LssCommand::Store.result_of(&Frame::of(Id::LSS_SLAVE, bytes));
    assert_eq!(says([23, 1, 0, 0, 0, 0, 0, 0]), Some(Err(LssError::NoStore)));
    assert_eq!(says([23, 255, 7, 0, 0, 0, 0, 0]), Some(Err(LssError::Other(255, 7))));
    assert_eq!(says([17, 0, 0, 0, 0, 0, 0, 0]), None, "of another command");
    assert_eq!(LssCommand::Store.result_of(&LssCommand::Store.frame()), None, "our own frame");
}

proptest! {
    #[test]
    fn any_identity_is_found(identity: Identity) {
        prop_assert_eq!(search(&mut [Slave::new(identity)]), (Outcome::Found(identity), FastScan::QUESTIONS));
    }
}
