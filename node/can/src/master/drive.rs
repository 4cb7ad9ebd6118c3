//! A drive in the cycles.
//!
//! Law      it is online while it is configured, operational, watched and heard; only then it is told anything. Its words are fresh in the
//!          cycle behind the SYNC that they answer; else the last ones stand. Homing sets its coordinate anew (another epoch)
//! Reads    its PDOs, emergency messages, signs of life
//! Writes   its part of the inputs; the frames that ask it
//! Source   CiA 301, CiA 402-2, contract section 8

use crate::config::{DriveConfig, VelocityFactor};
use crate::drive::image::Image;
use crate::drive::layout::{Asked, Told, Transmission};
use crate::drive::probe::{self, Catch, Caught, Probes};
use crate::drive::{Counter, HomingSetup};
use crate::{Frame, Id, NodeId, Watch};
use lineshaft_core::drive::{
    BusState, DriveInput, DriveOutput, DriveState, Emergency, Inputs, Latch, MODE_HOMING, STATUS_HOMING_ATTAINED,
};
use lineshaft_core::object::Object;

/// A PDO that the drive sends.
#[derive(Clone, Debug)]
struct Received {
    image: Image<Told>,
    is_each_sync: bool,
}

/// What it tells.
#[derive(Clone, Copy, Debug, Default)]
struct Words {
    status: u16,
    mode: i8,
    inputs: u32,
    fault: u16,
    /// That of the counts (counts/s).
    velocity: f64,
}

/// A drive.
#[derive(Debug)]
pub(crate) struct Drive {
    pub(super) node: NodeId,
    pub(super) place: usize,
    asked: Vec<Image<Asked>>,
    told: Vec<Received>,
    factor: VelocityFactor,
    cycle_s: f64,
    /// It is configured and was started.
    is_ready: bool,
    /// It is configured, and about to be started: what it tells counts already.
    listens: bool,
    /// Its counts are those of the coordinate in which it was heard last.
    counts_on: bool,
    /// It has booted since somebody began to configure it.
    has_booted: bool,
    pub(super) watch: Watch,
    counter: Counter,
    words: Words,
    /// It has told where it is, since it was started.
    is_heard: bool,
    is_fresh: bool,
    /// Cycles since its counts were fresh.
    stale: u32,
    emergency: Option<Emergency>,
    object: Object,
    probes: Probes,
    catches: [Catch; 4],
    /// The mode that was asked for last.
    mode: i8,
    pub(super) homing: HomingSetup,
}

impl Drive {
    pub(super) fn new(config: &DriveConfig, cycle_ns: u64) -> Self {
        let told: Vec<_> = config
            .layout
            .told
            .iter()
            .map(|pdo| Received { image: Image::of(pdo), is_each_sync: pdo.transmission == Transmission::EachSync })
            .collect();
        Self {
            node: config.node,
            place: config.place,
            asked: config.layout.asked.iter().map(Image::of).collect(),
            told,
            factor: config.velocity,
            cycle_s: cycle_ns as f64 * 1e-9,
            is_ready: false,
            listens: false,
            counts_on: false,
            has_booted: false,
            watch: Watch::new(config.node, config.watching),
            counter: Counter::default(),
            words: Words::default(),
            is_heard: false,
            is_fresh: false,
            stale: 0,
            emergency: None,
            object: Object::Axis(config.object),
            probes: config.probes,
            catches: Default::default(),
            mode: 0,
            homing: HomingSetup::new(config.velocity),
        }
    }

    /// Identifiers of the PDOs that it sends.
    pub(super) fn sent(&self) -> impl Iterator<Item = Id> {
        self.told.iter().map(|pdo| pdo.image.id())
    }

    pub(super) fn is_ready(&self) -> bool {
        self.is_ready
    }

    /// What it is told from now on holds, unless it boots.
    pub(super) fn prepare(&mut self) {
        (self.is_ready, self.listens, self.has_booted) = (false, false, false);
    }

    /// It is configured, and will be started next: what it sends on change it may send but once, when it starts. `inputs`: its digital
    /// inputs until then.
    pub(super) fn listen(&mut self, inputs: u32) {
        // One that was only away has counted what it was moved meanwhile; one that was homing may have a new zero.
        let counts_on = std::mem::replace(&mut self.counts_on, true) && self.words.mode != MODE_HOMING;
        if !counts_on {
            self.counter.begin_anew();
        }
        self.words = Words { inputs, ..Words::default() };
        (self.listens, self.is_heard, self.is_fresh, self.stale) = (true, false, false, 0);
        self.catches = Default::default();
    }

    /// It is configured, and has been started; `fault` is its error code. False where it has booted since it was
    /// [prepared](Self::prepare).
    pub(super) fn begin(&mut self, fault: u16) -> bool {
        if self.has_booted {
            return false;
        }
        if !std::mem::take(&mut self.listens) {
            self.listen(0);
            self.listens = false;
        }
        if self.words.fault == 0 {
            self.words.fault = fault;
        }
        self.is_ready = true;
        true
    }

    /// It takes part no longer; it counts on meanwhile.
    pub(super) fn end(&mut self) {
        (self.is_ready, self.listens) = (false, false);
    }

    /// Nobody hears any more whether it boots.
    pub(super) fn forget(&mut self) {
        self.end();
        self.counts_on = false;
    }

    /// It has booted: what it was told before does not hold, and its counts may begin anew.
    pub(super) fn boot(&mut self) {
        self.forget();
        self.has_booted = true;
    }

    /// Takes the PDO at a place.
    pub(super) fn take_pdo(&mut self, place: usize, frame: &Frame) {
        let counts = self.is_ready || self.listens;
        let Some(Received { image, is_each_sync }) = self.told.get_mut(place).filter(|_| counts) else { return };
        if !image.take(frame) {
            return;
        }
        let (was, mut word, mut captured) = (self.words, None, 0);
        let words = &mut self.words;
        for (what, value) in image.values() {
            match what {
                Told::Status => words.status = value as u16,
                Told::Mode => words.mode = value as i8,
                Told::Inputs => words.inputs = value as u32,
                Told::Fault => words.fault = value as u16,
                Told::Position => word = Some(value as i32),
                Told::Captured(_) => captured = value as i32,
                Told::Captures(slot) => {
                    if let Some(caught) = self.catches.get_mut(usize::from(slot)) {
                        caught.take(captured, value as u16);
                    }
                }
            }
        }
        let has_zero = |words: Words| words.mode == MODE_HOMING && words.status & STATUS_HOMING_ATTAINED != 0;
        if has_zero(*words) && !has_zero(was) && was.mode == MODE_HOMING {
            self.counter.begin_anew();
        }
        if let Some(word) = word {
            let change = self.counter.take(word);
            let cycles = f64::from(self.stale.saturating_add(1));
            // Behind an absence nobody knows how long the way has taken.
            words.velocity = if self.is_heard { change as f64 / (cycles * self.cycle_s) } else { 0.0 };
            (self.is_heard, self.stale) = (true, 0);
        }
        // The PDO with its position is one of those that go with each SYNC.
        self.is_fresh |= *is_each_sync && word.is_some();
    }

    /// Takes an emergency message.
    pub(super) fn take_emergency(&mut self, emergency: Emergency) {
        self.emergency = Some(emergency);
        if emergency.code != 0 {
            self.words.fault = emergency.code;
        }
    }

    /// What it shows in this cycle.
    pub(super) fn read(&mut self, inputs: &mut Inputs, bus: BusState) {
        let index = self.read_probes(inputs);
        let Some(input) = inputs.drive.get_mut(self.place) else { return };
        let is_online = self.is_ready && self.is_heard && bus != BusState::Off;
        let Words { status, mode, inputs, fault, velocity } = self.words;
        let is_fresh = std::mem::take(&mut self.is_fresh) && is_online;
        self.stale = if is_fresh { 0 } else { self.stale.saturating_add(1) };
        let is_in_fault = matches!(DriveState::from_status(status), DriveState::Fault | DriveState::FaultReaction);
        *input = DriveInput {
            count: self.counter.count(),
            epoch: self.counter.epoch(),
            velocity,
            // In no PDO yet.
            effort: 0.0,
            status,
            mode,
            // The error code stays behind the fault that it is of.
            fault: if is_in_fault { fault } else { 0 },
            online: is_online,
            fresh: is_fresh,
            bus,
            emergency: self.emergency.take(),
            inputs,
            index,
        };
    }

    /// Latches of the axis, and the last index pulse.
    fn read_probes(&mut self, inputs: &mut Inputs) -> Option<i64> {
        let mut index = None;
        for (slot, caught) in (0..).zip(&mut self.catches) {
            let Some((word, lost)) = caught.drain() else { continue };
            let position = self.counter.locate(word);
            match probe::meaning(self.probes, slot) {
                Caught::Index => index = position,
                Caught::Edge(edge) => {
                    inputs.add_latch(Latch { object: self.object, edge, age_ns: None, position });
                    inputs.latches_lost = inputs.latches_lost.saturating_add(lost.into());
                }
            }
        }
        index
    }

    /// The frames that ask it for what a cycle wants; none while it is not ready.
    pub(super) fn frames(&mut self, output: &DriveOutput) -> impl Iterator<Item = Frame> {
        self.mode = self.homing.allow(output.mode, self.mode);
        let (mode, factor, is_ready) = (self.mode, self.factor, self.is_ready);
        let value = move |word| match word {
            Asked::Control => i64::from(output.control),
            Asked::Position => output.position,
            Asked::Velocity => factor.to_drive(output.velocity),
            Asked::Mode => i64::from(mode),
        };
        self.asked.iter().filter(move |_| is_ready).map(move |image| image.frame(value))
    }
}
