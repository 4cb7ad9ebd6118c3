//! Connection of the service to the bus: sends orders and receives reports.
//!
//! Law      while no cycles run, a waiting call of the service runs the bus; while they run, only the cycle thread does
//! Refuses  nothing; a missing answer is reported as a timeout

use super::bus::{Bus, Order, Report};
use crate::{NmtCommand, NodeId};
use lineshaft_cia402::object::Object;
use lineshaft_cia402::sdo::{SdoError, Transfer};
use rtrb::{Consumer, Producer, RingBuffer};
use std::collections::VecDeque;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Maximum number of waiting orders and reports.
const ROOM: usize = 1024;
/// Time between two polls of the bus.
const POLL_PERIOD: Duration = Duration::from_micros(200);
/// Time between two checks of a transfer while the cycles run the bus.
const LOOK_IN_CYCLES: Duration = Duration::from_millis(1);
/// Maximum size of an object that the master itself reads, in bytes.
const LONGEST: usize = 249;
/// Additional room for padding of the last segment, in bytes.
const SEGMENT: usize = 7;
/// Time without a cycle after which the cycles count as ended.
const CYCLE_TIMEOUT: Duration = Duration::from_secs(2);

/// Ends of the rings that belong to the bus.
pub(crate) type BusEnds = (Consumer<Order>, Producer<Report>);

/// Connection to the bus.
pub(crate) struct Port {
    bus: Arc<Mutex<Bus>>,
    is_in_cycles: bool,
    orders: Producer<Order>,
    reports: Consumer<Report>,
    /// Reports that were received while waiting for another one.
    kept: VecDeque<Report>,
    /// Unexpected answers of the node of the last transfer.
    strays: u32,
    /// Counter of how often the bus was run.
    turns: Arc<AtomicU64>,
    silent: Arc<[AtomicBool]>,
    /// Whether the cycles have ended, so that the bus is not run.
    is_dead: bool,
}

impl Port {
    /// Creates the connection. `make` creates the bus from the other ends of the rings.
    pub(crate) fn new(make: impl FnOnce(BusEnds) -> Bus) -> Self {
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

    /// Returns the bus, for the cycles.
    pub(crate) fn bus(&self) -> Arc<Mutex<Bus>> {
        Arc::clone(&self.bus)
    }

    /// Locks the bus; only while no cycles run.
    pub(crate) fn lock(&self) -> MutexGuard<'_, Bus> {
        self.bus.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Sets whether the cycles run the bus.
    pub(crate) fn set_in_cycles(&mut self, is_in_cycles: bool) {
        (self.is_in_cycles, self.is_dead) = (is_in_cycles, false);
    }

    /// Returns true if the cycles run the bus.
    pub(crate) fn is_in_cycles(&self) -> bool {
        self.is_in_cycles
    }

    /// Returns true if the cycles have ended while the service waited. A timeout is then no statement about the device.
    pub(crate) fn is_dead(&self) -> bool {
        self.is_dead
    }

    /// Returns true if the cycles have ended while the service waited, and resets the flag.
    pub(crate) fn take_have_cycles_ended(&mut self) -> bool {
        std::mem::take(&mut self.is_dead)
    }

    /// Returns true if the device at this place of the bus no longer sends signs of life.
    pub(crate) fn is_silent(&self, place: usize) -> bool {
        self.silent.get(place).is_some_and(|silent| silent.load(Ordering::Relaxed))
    }

    /// Runs the bus once, or waits briefly if the cycles run it.
    pub(crate) fn step(&mut self) {
        if self.is_in_cycles {
            std::thread::sleep(LOOK_IN_CYCLES);
        } else {
            self.lock().exchange();
            std::thread::sleep(POLL_PERIOD);
        }
    }

    /// Runs the bus for the given time.
    pub(crate) fn wait(&mut self, time: Duration) {
        let begin = Instant::now();
        while begin.elapsed() < time {
            self.step();
        }
    }

    /// Returns the next report.
    pub(crate) fn report(&mut self) -> Option<Report> {
        self.kept.pop_front().or_else(|| self.reports.pop().ok())
    }

    /// Sends an order.
    pub(crate) fn order(&mut self, order: Order) {
        // A full ring means that no cycle runs any more; a caller that waits for an answer detects that.
        let _ = self.orders.push(order);
    }

    pub(crate) fn nmt(&mut self, command: NmtCommand, node: NodeId) {
        self.order(Order::Nmt(command, Some(node)));
    }

    /// Returns the number of unexpected answers of the node of the last transfer, since the bus was created.
    pub(crate) fn strays(&self) -> u32 {
        self.strays
    }

    /// Reads an object.
    pub(crate) fn read(&mut self, node: NodeId, object: Object) -> Result<Vec<u8>, SdoError> {
        self.read_long(node, object, LONGEST)
    }

    /// Reads an object of at most `most` bytes.
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
                // The bus itself has a transfer with the node for a homing setup or a mode.
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
                    // Result of a transfer that was abandoned here.
                    Report::Transfer(..) => {}
                    other => self.kept.push_back(other),
                }
            }
            let now = self.turns.load(Ordering::Relaxed);
            if now != std::mem::replace(&mut turns, now) {
                turned = Instant::now();
            } else if turned.elapsed() > CYCLE_TIMEOUT {
                self.is_dead = true;
                return Err(SdoError::Silent(object, CYCLE_TIMEOUT.as_millis() as u64));
            }
        }
    }
}
