//! An open-loop axis at positions set by the test, which executes orders at once.

use crate::code::Code;
use crate::drive::Interface;
use crate::encoder::Lead;
use crate::event::Refusal;
use crate::modulo::Modulo;
use crate::object::Object;
use crate::parameter::AxisParameters;
use crate::position::Position;
use crate::profile::Motion;
use crate::sync::Leads;
use crate::vocabulary::wf::{Block, Blocks, Mode, Request, Speed, Wf, WfSignal};
use crate::vocabulary::{Order, View};

/// Increments per mm.
pub(super) const MM: i64 = 1000;
/// Maximum velocity (inc/s): a speed value is 1000 inc/s.
pub(super) const MAX_VELOCITY: f64 = 100_000.0;

pub(super) struct Bench {
    pub wf: Wf,
    pub parameters: AxisParameters,
    pub modulo: Option<Modulo>,
    pub cycle: u64,
    pub cycle_ns: u64,
    /// Actual position (inc).
    pub actual: i64,
    pub owns: bool,
    pub on: bool,
    pub in_error: bool,
    pub interface: Interface,
    /// Last commanded velocity (inc/s).
    pub velocity: f64,
    /// Alarms and acknowledgements, in their order.
    pub orders: Vec<Order>,
    leads: Leads,
    words: [u64; WfSignal::COUNT],
}

impl Bench {
    /// MD42..44 = 40, 20, 5; MD45..48 = 100, 35, 10, 1 mm (WF-ORA-08); PEH window 0.5 mm, MD30 100 ms.
    pub(super) fn new() -> Self {
        let mut parameters = AxisParameters::new(MAX_VELOCITY, 1e6);
        parameters.error_reaction = 2;
        let wf = &mut parameters.vocabularies.wf;
        (wf.md42, wf.md43, wf.md44) = (40, 20, 5);
        (wf.md45, wf.md46, wf.md47, wf.md48) = (100 * MM, 35 * MM, 10 * MM, MM);
        (wf.peh_window, wf.md30) = (Some(MM / 2), 100_000_000);
        (wf.fixed_speed_1, wf.fixed_speed_2, wf.fixed_speed_3) = (10.0, 50.0, 80.0);
        Self {
            wf: Wf::default(),
            parameters,
            modulo: None,
            cycle: 100,
            cycle_ns: 1_000_000,
            actual: 0,
            owns: false,
            on: true,
            in_error: false,
            interface: Interface::OpenLoop,
            velocity: 0.0,
            orders: Vec::new(),
            leads: Leads::default(),
            words: [0; WfSignal::COUNT],
        }
    }

    fn view(&self) -> View<'_> {
        let position = Position::whole(self.actual);
        View {
            object: Object::Axis(0),
            cycle: self.cycle,
            cycle_ns: self.cycle_ns,
            owns: self.owns,
            owned: false,
            free: self.on && !self.in_error,
            on: self.on,
            closing: false,
            locked: self.in_error,
            in_error: self.in_error,
            error: crate::code::Code::NONE,
            contact: crate::code::Code::NONE,
            homing: false,
            search_speed: 0.0,
            homed: false,
            command: Motion { velocity: self.velocity, ..Motion::at_rest(position) },
            present: Motion { velocity: self.velocity, ..Motion::at_rest(position) },
            rests: self.velocity == 0.0,
            idle: self.velocity == 0.0,
            has_end: false,
            target: position,
            actual: Lead { position, valid: true, uneven: 1.0, ..Lead::default() },
            following_error: 0,
            at_limit: false,
            modulo: self.modulo,
            unit: MM as f64,
            interface: Some(self.interface),
            closes_loop: false,
            wiring: crate::vocabulary::Wiring::default(),
            parameters: &self.parameters,
            leads: &self.leads,
            latches: &[],
            index: None,
        }
    }

    fn obey(&mut self, order: Order) {
        match order {
            Order::Speed { velocity } => {
                self.velocity = velocity;
                self.owns = true;
            }
            Order::Fail { .. } => {
                (self.owns, self.in_error, self.velocity) = (false, true, 0.0);
                self.orders.push(order);
            }
            Order::Reset => {
                self.in_error = false;
                self.orders.push(order);
            }
            other => panic!("an open-loop axis was asked for {other:?}"),
        }
    }

    /// Executes a request in this cycle, its order, then the step of the cycle.
    pub(super) fn give(&mut self, request: &Request) -> Result<(), Refusal> {
        let mut wf = self.wf;
        let order = wf.run(request, &self.view())?;
        if matches!(order, Some(Order::Speed { velocity }) if velocity != 0.0) && !self.view().free {
            // The axis refuses this order in the same way.
            return Err(Refusal::new(Code::NOT_ENABLED, Object::Machine));
        }
        self.wf = wf;
        if let Some(order) = order {
            self.obey(order);
        }
        self.step();
        Ok(())
    }

    /// Executes a request or a step, and ignores the order.
    pub(super) fn give_blindly(&mut self, request: Option<&Request>) {
        let mut wf = self.wf;
        match request {
            Some(request) => drop(wf.run(request, &self.view())),
            None => drop(wf.step(&self.view())),
        }
        self.wf = wf;
        let mut words = self.words;
        self.wf.publish(&self.view(), self.wf.switching(), &mut words);
        self.cycle = self.cycle.wrapping_mul(3);
    }

    /// Executes the step of this cycle at the present position.
    fn step(&mut self) {
        let mut wf = self.wf;
        let order = wf.step(&self.view());
        self.wf = wf;
        if let Some(order) = order {
            self.obey(order);
        }
        let mut words = self.words;
        let view = View { cycle: 0, ..self.view() };
        self.wf.publish(&view, self.wf.switching(), &mut words);
        self.words = words;
        self.cycle += 1;
    }

    /// Executes the next cycle, with the axis at `actual` (inc).
    pub(super) fn at(&mut self, actual: i64) -> &mut Self {
        self.actual = actual;
        self.step();
        self
    }

    /// Executes a number of cycles at the same position.
    pub(super) fn wait(&mut self, cycles: u64) -> &mut Self {
        (0..cycles).for_each(|_| self.step());
        self
    }

    pub(super) fn int(&self, signal: WfSignal) -> i64 {
        self.words[signal as usize].cast_signed()
    }

    pub(super) fn real(&self, signal: WfSignal) -> f64 {
        f64::from_bits(self.words[signal as usize])
    }

    pub(super) fn state(&self) -> &'static str {
        super::super::STATES[self.int(WfSignal::State) as usize]
    }

    /// Returns state, speed value, Q, enable.
    pub(super) fn now(&self) -> (&'static str, f64, i64, i64) {
        let on = (self.int(WfSignal::Q), self.int(WfSignal::Enable));
        assert_eq!(self.velocity == 0.0, on.0 == 0, "the drive runs with the output");
        let volts = self.velocity / MAX_VELOCITY * 10.0;
        assert!((self.real(WfSignal::Dac) - volts).abs() < 1e-9, "the voltage tells the speed of the drive");
        (self.state(), self.real(WfSignal::Speed), on.0, on.1)
    }

    /// Returns F and B.
    pub(super) fn direction(&self) -> (i64, i64) {
        (self.int(WfSignal::F), self.int(WfSignal::B))
    }

    /// Starts blocks.
    pub(super) fn start(&mut self, mode: Mode, blocks: &[Block]) {
        self.give(&start(mode, blocks)).expect("START is accepted");
    }
}

/// Returns a block to a position (mm), with a speed value.
pub(super) fn to(position: i64, speed: f64) -> Block {
    Block { position: Position::whole(position * MM), speed: Speed::Value(speed), absolute: true }
}

/// Returns a block by a distance (mm), with a speed value.
pub(super) fn by(distance: i64, speed: f64) -> Block {
    Block { absolute: false, ..to(distance, speed) }
}

pub(super) fn load(mode: Mode, blocks: &[Block]) -> Request {
    let blocks = Blocks::new(blocks).expect("no more than fit");
    Request { mode: Some(mode), blocks: Some(blocks), ..Request::default() }
}

pub(super) fn start(mode: Mode, blocks: &[Block]) -> Request {
    Request { start: true, ..load(mode, blocks) }
}

pub(super) fn again() -> Request {
    Request { start: true, ..Request::default() }
}

pub(super) fn reset() -> Request {
    Request { reset: true, ..Request::default() }
}
