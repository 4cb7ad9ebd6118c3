//! The service's way to the bus: orders go in, reports come out, wherever the bus is.
//!
//! Law      while no cycles run, whoever waits here runs the bus meanwhile; while they do, the cycle thread does, and nobody else touches it
//! Refuses  nothing; what does not answer in time is silent

use super::bus::{Bus, Order, Report};
use crate::sdo::{Object, SdoError, Transfer};
use crate::{NmtCommand, NodeId};
use rtrb::{Consumer, Producer, RingBuffer};
use std::collections::VecDeque;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Orders and reports that may wait.
const ROOM: usize = 1024;
/// Between two looks at the bus.
const LOOK: Duration = Duration::from_micros(200);
/// Between two looks whether a transfer is done, while the cycles run the bus.
const LOOK_IN_CYCLES: Duration = Duration::from_millis(1);
/// Bytes of the longest object that the master itself reads.
const LONGEST: usize = 249;
/// What the last segment of an object is filled up with has room, too (bytes).
const SEGMENT: usize = 7;
/// Without a cycle for so long nobody runs the bus any more.
const DEAD: Duration = Duration::from_secs(2);

/// The ends of the rings that the bus has.
pub(crate) type Ends = (Consumer<Order>, Producer<Report>);

/// The way.
pub(crate) struct Port {
    bus: Arc<Mutex<Bus>>,
    is_in_cycles: bool,
    orders: Producer<Order>,
    reports: Consumer<Report>,
    /// Reports that came while something else was waited for.
    kept: VecDeque<Report>,
    /// Answers of the node of the last transfer that nobody had asked for.
    strays: u32,
    /// Counts how often the bus was run.
    turns: Arc<AtomicU64>,
    silent: Arc<[AtomicBool]>,
    /// Nobody runs the bus: the cycles are over.
    is_dead: bool,
}

impl Port {
    /// A way to the bus that `make` makes of the other ends.
    pub(crate) fn new(make: impl FnOnce(Ends) -> Bus) -> Self {
        let (orders, taken) = RingBuffer::new(ROOM);
        let (told, reports) = RingBuffer::new(ROOM);
        let bus = make((taken, told));
        let (turns, silent) = (bus.turns(), bus.silent());
        Self {
            bus: Arc::new(Mutex::new(bus)),
            is_in_cycles: false,
            orders,
            reports,
            kept: VecDeque::new(),
            strays: 0,
            turns,
            silent,
            is_dead: false,
        }
    }

    /// The bus, for the cycles.
    pub(crate) fn bus(&self) -> Arc<Mutex<Bus>> {
        Arc::clone(&self.bus)
    }

    /// The bus; only while no cycles run.
    pub(crate) fn lock(&self) -> MutexGuard<'_, Bus> {
        self.bus.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// From now on the cycles run the bus, or no longer.
    pub(crate) fn set_in_cycles(&mut self, is_in_cycles: bool) {
        (self.is_in_cycles, self.is_dead) = (is_in_cycles, false);
    }

    /// Do the cycles run the bus?
    pub(crate) fn is_in_cycles(&self) -> bool {
        self.is_in_cycles
    }

    /// Has nobody run the bus for so long that nobody will? What was waited for then says nothing of the device.
    pub(crate) fn is_dead(&self) -> bool {
        self.is_dead
    }

    /// Has nobody run the bus for so long that nobody will, since it was asked last?
    pub(crate) fn take_dead(&mut self) -> bool {
        std::mem::take(&mut self.is_dead)
    }

    /// Is there no sign of life any more of the drive at this place of the bus?
    pub(crate) fn is_silent(&self, place: usize) -> bool {
        self.silent.get(place).is_some_and(|silent| silent.load(Ordering::Relaxed))
    }

    /// Runs the bus for a moment, where the cycles do not.
    pub(crate) fn step(&mut self) {
        if self.is_in_cycles {
            std::thread::sleep(LOOK_IN_CYCLES);
        } else {
            self.lock().exchange();
            std::thread::sleep(LOOK);
        }
    }

    /// Runs the bus for so long.
    pub(crate) fn wait(&mut self, time: Duration) {
        let begin = Instant::now();
        while begin.elapsed() < time {
            self.step();
        }
    }

    /// The next thing that has happened.
    pub(crate) fn report(&mut self) -> Option<Report> {
        self.kept.pop_front().or_else(|| self.reports.pop().ok())
    }

    /// Gives an order.
    pub(crate) fn order(&mut self, order: Order) {
        // A full ring is one that nobody empties: no cycle runs any more, and whoever waits for an answer will tell.
        let _ = self.orders.push(order);
    }

    pub(crate) fn nmt(&mut self, command: NmtCommand, node: NodeId) {
        self.order(Order::Nmt(command, Some(node)));
    }

    /// Answers that nobody had asked for, of the node of the last transfer, since the bus was made.
    pub(crate) fn strays(&self) -> u32 {
        self.strays
    }

    /// Reads an object.
    pub(crate) fn read(&mut self, node: NodeId, object: Object) -> Result<Vec<u8>, SdoError> {
        self.read_long(node, object, LONGEST)
    }

    /// Reads an object of at most so many bytes.
    pub(crate) fn read_long(&mut self, node: NodeId, object: Object, most: usize) -> Result<Vec<u8>, SdoError> {
        self.transfer(node, object, || (Vec::with_capacity(most.saturating_add(SEGMENT)), false))
    }

    /// Writes an object.
    pub(crate) fn write(&mut self, node: NodeId, object: Object, data: &[u8]) -> Result<(), SdoError> {
        self.transfer(node, object, || (data.to_vec(), true)).map(drop)
    }

    fn transfer(
        &mut self,
        node: NodeId,
        object: Object,
        data: impl Fn() -> (Vec<u8>, bool),
    ) -> Result<Vec<u8>, SdoError> {
        loop {
            let (data, writes) = data();
            self.order(Order::Transfer { node, object, data, writes });
            match self.wait_for(node, object) {
                // The bus itself talks to the node: it sets up a homing.
                Err(SdoError::Busy(_)) => self.step(),
                done => return done,
            }
        }
    }

    fn wait_for(&mut self, node: NodeId, object: Object) -> Result<Vec<u8>, SdoError> {
        let (mut turns, mut turned) = (self.turns.load(Ordering::Relaxed), Instant::now());
        loop {
            self.step();
            while let Ok(report) = self.reports.pop() {
                match report {
                    Report::Transfer(of, Transfer { object: which, data, result }, strays)
                        if of == node && which == object =>
                    {
                        self.strays = strays;
                        return result.map(|()| data);
                    }
                    // Of a transfer that was given up here.
                    Report::Transfer(..) => {}
                    other => self.kept.push_back(other),
                }
            }
            let now = self.turns.load(Ordering::Relaxed);
            if now != std::mem::replace(&mut turns, now) {
                turned = Instant::now();
            } else if turned.elapsed() > DEAD {
                self.is_dead = true;
                return Err(SdoError::Silent(object, DEAD.as_millis() as u64));
            }
        }
    }
}
