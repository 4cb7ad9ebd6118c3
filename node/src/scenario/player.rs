//! Executes a scenario, independent of the code that runs the cycle.
//!
//! In each cycle, in this order:
//!
//! 1. [`Player::before`]: steps that are due fire; injections are applied to the plant;
//! 2. inputs are read, then [`Player::override_inputs`] replaces driven values;
//! 3. the cycle of the machine, with [`Player::commands`];
//! 4. [`Player::after`]: answers, conditions and expectations are evaluated.

use super::drive::Target;
use super::judge::{End, Record, Seen};
use super::outcome::{self, Answer, Outcome};
use super::step::{Step, Trigger};
use super::verb::Effect;
use super::{Plan, Report, Scenario, moment};
use crate::scenario::report::Failure;
use lineshaft_core::command::{Action, Command, Commands, Setpoints, Source};
use lineshaft_core::drive::Inputs;
use lineshaft_core::event::Kind;
use lineshaft_core::machine::Machine;
use lineshaft_core::signal::Value as Number;
use lineshaft_core::sim::Plant;
use std::collections::VecDeque;

/// Maximum number of commands that wait for a later cycle because a cycle accepts no more; further ones are not given
/// and are reported.
pub(super) const MOST_HELD: usize = 4096;

/// No step is due.
const NEVER: u64 = u64::MAX;

/// State of a scenario that is executed.
#[derive(Debug)]
pub struct Player {
    scenario: Scenario,
    /// Current or last cycle.
    cycle: u64,
    /// Number of cycles that have run.
    ran: u64,
    steps: Vec<StepState>,
    /// First cycle in which each step fired.
    fired: Vec<Option<u64>>,
    next_due: u64,
    /// Sequence number of the last command with each ID; 0 if there was none yet.
    goals: Vec<u64>,
    /// Stops, then other commands, that wait for a cycle, because a cycle accepts only a limited number.
    held: [VecDeque<(Command, Pending)>; 2],
    stop: Vec<Command>,
    queue: Vec<Command>,
    /// Setpoints of the current cycle.
    stream: Setpoints,
    pending: Vec<Pending>,
    /// Results of the acts, then of the entries of `drive`.
    outcomes: Vec<Outcome>,
    /// Value of the memory cell of each entry of `drive` at the end of the last cycle.
    memory: Vec<Option<Number>>,
    records: Vec<Record>,
    /// Memory for the values of a condition.
    values: Vec<Number>,
}

#[derive(Clone, Copy, Debug)]
struct StepState {
    due: u64,
    times: u64,
}

/// A command of the current cycle, and its source.
#[derive(Clone, Copy, Debug)]
struct Pending {
    sequence: u64,
    outcome: usize,
    step: Option<usize>,
    is_answered: bool,
}

impl Player {
    /// Creates the state before cycle 0.
    pub fn new(scenario: &Scenario) -> Self {
        let plan = &scenario.0;
        let due = |step: &Step| match step.trigger {
            Trigger::At(cycle) => cycle,
            Trigger::When { .. } => NEVER,
        };
        Self {
            cycle: 0,
            ran: 0,
            steps: plan.steps.iter().map(|step| StepState { due: due(step), times: 0 }).collect(),
            fired: vec![None; plan.steps.len()],
            next_due: plan.steps.iter().map(due).min().unwrap_or(NEVER),
            goals: vec![0; plan.ids.len()],
            held: Default::default(),
            stop: Vec::new(),
            queue: Vec::new(),
            stream: Setpoints::none(plan.config.axes.len()),
            pending: Vec::new(),
            outcomes: vec![Outcome::default(); plan.acts.len() + plan.drives.len()],
            memory: vec![None; plan.drives.len()],
            records: vec![Record::default(); plan.expectations.len()],
            values: Vec::new(),
            scenario: scenario.clone(),
        }
    }

    /// Returns true if every cycle of the scenario has run.
    pub fn is_over(&self) -> bool {
        self.ran >= self.scenario.cycles()
    }

    /// Starts a cycle, counted from 0 at the start of the scenario: steps that are due fire. Commands are numbered from
    /// `sequence`, the number of the last command of any client. Without a plant nothing can be injected. The cycle
    /// accepts `room` commands; stops have priority, and the others wait for the next cycle.
    pub fn before(&mut self, cycle: u64, sequence: &mut u64, mut plant: Option<&mut Plant>, room: usize) {
        self.cycle = cycle;
        self.stop.clear();
        self.queue.clear();
        self.stream.clear();
        self.pending.clear();
        if self.next_due <= cycle {
            let scenario = self.scenario.clone();
            for (index, step) in scenario.0.steps.iter().enumerate() {
                if self.steps[index].due <= cycle {
                    self.fire(index, step, &scenario.0, sequence, plant.as_deref_mut());
                }
            }
            self.next_due = self.steps.iter().map(|step| step.due).min().unwrap_or(NEVER);
        }
        if let Some(plant) = plant {
            self.drive_counts(plant);
        }
        self.drive_memory(sequence);
        self.release(room);
    }

    /// Returns the maximum number of commands that one cycle can add.
    pub fn most_commands(&self) -> u64 {
        let plan = &self.scenario.0;
        (plan.acts.len() + plan.drives.len()) as u64
    }

    /// Moves waiting commands into the cycle, up to `room`, stops first.
    fn release(&mut self, room: usize) {
        let [stops, others] = &mut self.held;
        let mut room = room;
        for (held, lane) in [(stops, &mut self.stop), (others, &mut self.queue)] {
            let given = held.len().min(room);
            room -= given;
            for (command, pending) in held.drain(..given) {
                lane.push(command);
                self.pending.push(pending);
            }
            for (_, pending) in held.drain(MOST_HELD.min(held.len())..) {
                self.outcomes[pending.outcome].note(self.cycle, Answer::NoRoom, false);
            }
        }
    }

    fn fire(&mut self, index: usize, step: &Step, plan: &Plan, sequence: &mut u64, mut plant: Option<&mut Plant>) {
        let state = &mut self.steps[index];
        state.times += 1;
        state.due = match step.repeat {
            Some(repeat) if repeat.count.is_none_or(|count| state.times < count) => {
                self.cycle.saturating_add(repeat.every)
            }
            _ => NEVER,
        };
        self.fired[index].get_or_insert(self.cycle);
        for outcome in step.acts.clone() {
            let Some(act) = plan.acts.get(outcome) else { continue };
            let action = match &act.deed {
                Effect::Command(action) => action.clone(),
                Effect::Refused(sentence) => Action::Refuse(sentence.as_str().into()),
                Effect::Cancel(id) => Action::Cancel { goal: self.goals.get(*id).copied().unwrap_or(0) },
                Effect::Inject(injection) => {
                    if !plant.as_deref_mut().is_some_and(|plant| injection.apply(plant)) {
                        self.outcomes[outcome].note(self.cycle, Answer::NotInjected, false);
                    }
                    continue;
                }
                Effect::Stream(setpoints) => {
                    self.stream.merge(setpoints);
                    continue;
                }
            };
            let number = self.give(action, sequence, outcome, Some(index));
            if let Some(goal) = act.id.and_then(|id| self.goals.get_mut(id)) {
                *goal = number;
            }
        }
    }

    fn give(&mut self, action: Action, sequence: &mut u64, outcome: usize, step: Option<usize>) -> u64 {
        *sequence += 1;
        let [stops, others] = &mut self.held;
        let lane = if action.stops() { stops } else { others };
        let pending = Pending { sequence: *sequence, outcome, step, is_answered: false };
        lane.push_back((Command { sequence: *sequence, source: Source::Scenario, action }, pending));
        *sequence
    }

    /// Moves the simulation by driven counts, so that index pulses and marks on the way are detected.
    fn drive_counts(&self, plant: &mut Plant) {
        for drive in &self.scenario.0.drives {
            match (drive.target, drive.value(self.cycle)) {
                (Target::Encoder(place), Some(Number::Int(count))) => plant.replace_encoder_count(place, count),
                (Target::Drive(place), Some(Number::Int(count))) => plant.replace_drive_count(place, count),
                _ => {}
            }
        }
    }

    /// Sends commands for driven memory cells that do not have the value yet.
    fn drive_memory(&mut self, sequence: &mut u64) {
        let scenario = self.scenario.clone();
        let plan = &scenario.0;
        for (place, drive) in plan.drives.iter().enumerate() {
            let Target::Memory(index) = drive.target else { continue };
            let wanted = drive.value(self.cycle);
            let is_written = self.held[1].iter().any(|(command, _)| match &command.action {
                Action::SetMemory(values) => values.iter().any(|value| value.index == index),
                _ => false,
            });
            if let Some(value) = wanted.filter(|value| is_written || self.memory[place] != Some(*value)) {
                let action = Action::set_memory(index, value.to_f64());
                self.give(action, sequence, plan.acts.len() + place, None);
            }
        }
    }

    /// Returns the commands of the current cycle.
    pub fn commands(&self) -> Commands<'_> {
        let stream = Some(&self.stream).filter(|stream| !stream.is_empty());
        Commands { stop: &self.stop, queue: &self.queue, stream }
    }

    /// Replaces inputs by the driven values of the current cycle.
    pub fn override_inputs(&self, inputs: &mut Inputs) {
        for drive in &self.scenario.0.drives {
            if let Some(value) = drive.value(self.cycle) {
                drive.replace(inputs, value);
            }
        }
    }

    /// Ends a cycle that `machine` has just run.
    pub fn after(&mut self, machine: &Machine) {
        let scenario = self.scenario.clone();
        let plan = &scenario.0;
        self.ran = self.cycle + 1;
        self.take_answers(machine, plan);
        self.judge_conditions(machine, plan);
        let seen = Seen { cycle: self.cycle, machine, fired: &self.fired };
        for (expectation, record) in plan.expectations.iter().zip(&mut self.records) {
            expectation.evaluate(record, &seen, plan.cycles - 1);
        }
        for (memory, drive) in self.memory.iter_mut().zip(&plan.drives) {
            *memory = Some(machine.board().value(drive.signal, drive.kind));
        }
    }

    fn take_answers(&mut self, machine: &Machine, plan: &Plan) {
        if self.pending.is_empty() {
            return;
        }
        for event in machine.events() {
            let answer = match event.kind {
                Kind::Accepted => Answer::Accepted,
                Kind::Refused => Answer::Refused(*event),
                _ => continue,
            };
            let Some(pending) = self.pending.iter_mut().find(|pending| pending.sequence == event.command) else {
                continue;
            };
            pending.is_answered = true;
            let step = pending.step.and_then(|step| plan.steps.get(step));
            let wanted = step.and_then(|step| step.refused.as_ref());
            let deed = plan.acts.get(pending.outcome).map(|act| &act.deed);
            let is_expected = outcome::is_expected(&answer, wanted, deed, plan);
            self.outcomes[pending.outcome].note(self.cycle, answer, is_expected);
        }
        for pending in self.pending.iter().filter(|pending| !pending.is_answered) {
            self.outcomes[pending.outcome].note(self.cycle, Answer::None, false);
        }
    }

    /// Evaluates `when` steps that are armed and have not fired yet.
    fn judge_conditions(&mut self, machine: &Machine, plan: &Plan) {
        for (index, step) in plan.steps.iter().enumerate() {
            let Trigger::When { predicate, after } = &step.trigger else { continue };
            let is_armed = index.checked_sub(1).is_none_or(|before| self.fired[before].is_some());
            let state = &mut self.steps[index];
            if !is_armed || state.times > 0 || state.due != NEVER {
                continue;
            }
            self.values.clear();
            predicate.look(machine, &mut self.values);
            if predicate.holds(&self.values) {
                state.due = self.cycle.saturating_add(1).saturating_add(*after);
                self.next_due = self.next_due.min(state.due);
            }
        }
    }

    /// Returns the step that fired last, for people; `None` before the first one.
    pub fn last_step(&self) -> Option<String> {
        let fired = self.fired.iter().enumerate().filter_map(|(place, cycle)| Some(((*cycle)?, place)));
        let (_, place) = fired.max()?;
        let name = self.scenario.0.steps.get(place)?.name.as_ref();
        Some(name.map_or_else(|| format!("step {}", place + 1), |name| format!("step `{name}`")))
    }

    /// Returns the report. Before the end of the scenario, the report is about the part that has run.
    pub fn finish(mut self) -> Report {
        for (_, pending) in self.held.iter().flatten() {
            self.outcomes[pending.outcome].note(self.cycle, Answer::None, false);
        }
        let plan = &self.scenario.0;
        let sources = (0..self.outcomes.len()).map(|index| outcome::Source::of(plan, index));
        let mut refused: Vec<_> =
            self.outcomes.iter().zip(sources).filter_map(|(outcome, source)| outcome.expected(&source, plan)).collect();
        let end = self.end(plan);
        let results = plan.expectations.iter().zip(&self.records);
        let results = results.map(|(expectation, record)| expectation.result(record, &end, &plan.steps)).collect();
        let mut failures = self.failures(plan);
        failures.sort();
        refused.sort();
        let has_fired = |step: &usize| self.fired.get(*step).is_some_and(Option::is_some);
        Report {
            name: plan.name.clone(),
            file: plan.file.clone(),
            cycles: self.ran,
            cycle_ns: plan.cycle_ns,
            wall: None,
            expectations: plan.expectations.len(),
            not_judged: plan.expectations.iter().filter_map(|e| e.since).filter(|step| !has_fired(step)).count(),
            steps: plan.steps.len(),
            steps_fired: self.fired.iter().flatten().count(),
            not_fired: self.not_fired(plan, true),
            failures,
            refused,
            results,
        }
    }

    fn end(&self, plan: &Plan) -> End<'_> {
        End { last: plan.cycles - 1, is_complete: self.is_over(), cycle_ns: plan.cycle_ns, fired: &self.fired }
    }

    fn failures(&self, plan: &Plan) -> Vec<Failure> {
        let end = self.end(plan);
        let mut failures = Vec::new();
        if !end.is_complete {
            let sentence = format!("the run ended after {} of {} cycles", self.ran, plan.cycles);
            failures.push(Failure { place: plan.place, sentence });
        }
        for (index, outcome) in self.outcomes.iter().enumerate() {
            failures.extend(outcome.failure(&outcome::Source::of(plan, index), plan));
        }
        if end.is_complete {
            failures.extend(self.not_fired(plan, false));
        }
        for (expectation, record) in plan.expectations.iter().zip(&self.records) {
            failures.extend(expectation.verdict(record, &end));
        }
        failures
    }

    /// Returns the steps that never fired: the optional or the other ones.
    fn not_fired(&self, plan: &Plan, optional: bool) -> Vec<Failure> {
        let steps =
            plan.steps.iter().enumerate().filter(|(index, step)| {
                step.optional == optional && self.fired.get(*index).is_none_or(Option::is_none)
            });
        let failure =
            |(index, step): (usize, &Step)| Failure { place: step.place, sentence: self.why_not_fired(index, step) };
        steps.map(failure).collect()
    }

    fn why_not_fired(&self, index: usize, step: &Step) -> String {
        let plan = &self.scenario.0;
        let name = step.name.as_ref().map_or_else(|| "the step".to_owned(), |name| format!("step `{name}`"));
        let is_armed = index.checked_sub(1).is_none_or(|before| self.fired[before].is_some());
        let due = self.steps[index].due;
        let reason = match &step.trigger {
            _ if due != NEVER => {
                let (due, last) = (moment::text(due, plan.cycle_ns), moment::text(plan.cycles - 1, plan.cycle_ns));
                format!("it was due in {due}, and the scenario ends with {last}")
            }
            Trigger::When { .. } if !is_armed => "the step before it never fired".to_owned(),
            Trigger::When { predicate, .. } => format!("{} never came", predicate.text()),
            Trigger::At(_) => "its cycle never came".to_owned(),
        };
        format!("{name} never fired: {reason}")
    }
}
