//! Result of a command of a scenario, over all times that it was given.

use super::Plan;
use super::moment::text;
use super::player::MOST_HELD;
use super::refusal::Refusal;
use super::report::Failure;
use super::verb::Effect;
use crate::document::Place;
use lineshaft_core::code::Code;
use lineshaft_core::event::{Event, Number};
use lineshaft_core::object::Object;
use lineshaft_core::parameter::ROWS;
use lineshaft_core::text::message;
use lineshaft_core::unit::excerpt;

/// Answer to a command.
#[derive(Clone, Copy, Debug)]
pub(super) enum Answer {
    Accepted,
    Refused(Event),
    /// There was no answer: the event did not fit into the queue.
    None,
    /// The command was not given, because too many were waiting for a cycle.
    NoRoom,
    /// There was no plant, no such drive, or no room for a latch.
    NotInjected,
}

/// Result of an act.
#[derive(Clone, Debug, Default)]
pub(super) struct Outcome {
    /// First unexpected answer.
    wrong: Option<(u64, Answer)>,
    wrong_times: u64,
    /// First expected refusal.
    refused: Option<(u64, Event)>,
    refused_times: u64,
}

/// Whether the answer is the one that the step expects.
pub(super) fn is_expected(answer: &Answer, wanted: Option<&Refusal>, deed: Option<&Effect>, plan: &Plan) -> bool {
    match (answer, wanted) {
        (Answer::Accepted, None) => true,
        // The message was compared when the scenario was read.
        (Answer::Refused(_), Some(_)) if matches!(deed, Some(Effect::Refused(_))) => true,
        (Answer::Refused(event), Some(wanted)) => names(event, wanted, deed, plan),
        _ => false,
    }
}

/// Whether the message, the parameter or the code matches the expected refusal.
fn names(event: &Event, wanted: &Refusal, deed: Option<&Effect>, plan: &Plan) -> bool {
    // For a function it is the number of a field, which the message names.
    let number = event.parameter.filter(|_| !matches!(event.source, Object::Function(_)));
    let row = number.and_then(|row| ROWS.get(usize::from(row)));
    let code = Code::rows().find(|row| row.code == event.code);
    let names = [row.map_or("", |row| row.key), code.map_or("", |row| row.name)];
    let by_id = by_id(event, deed, plan).unwrap_or_default();
    wanted.fits(event.code, &[&message(event, &plan.config), &by_id], &names)
}

/// Act of a step, or entry of `drive`, to which a result belongs.
pub(super) struct Source<'a> {
    place: Place,
    verb: &'a str,
    deed: Option<&'a Effect>,
    /// Message of a request that was refused before it became a command.
    refusal: Option<&'a str>,
    /// Refusal that the step expects.
    wanted: Option<&'a Refusal>,
}

impl<'a> Source<'a> {
    /// Returns the source of the result with this index.
    pub(super) fn of(plan: &'a Plan, index: usize) -> Self {
        match plan.acts.get(index) {
            Some(act) => {
                let step = plan.steps.iter().find(|step| step.acts.contains(&index));
                let refusal = if let Effect::Refused(sentence) = &act.deed { Some(sentence.as_str()) } else { None };
                let wanted = step.and_then(|step| step.refused.as_ref());
                Self { place: act.place, verb: &act.verb, deed: Some(&act.deed), refusal, wanted }
            }
            None => {
                let drive = plan.drives.get(index - plan.acts.len());
                let place = drive.map_or(Place::START, |drive| drive.place);
                Self { place, verb: "drive", deed: None, refusal: None, wanted: None }
            }
        }
    }
}

impl Outcome {
    /// Records an answer.
    pub(super) fn note(&mut self, cycle: u64, answer: Answer, is_expected: bool) {
        match answer {
            Answer::Refused(event) if is_expected => {
                self.refused.get_or_insert((cycle, event));
                self.refused_times += 1;
            }
            _ if is_expected => {}
            _ => {
                self.wrong.get_or_insert((cycle, answer));
                self.wrong_times += 1;
            }
        }
    }

    /// Returns the failure, if any.
    pub(super) fn failure(&self, source: &Source<'_>, plan: &Plan) -> Option<Failure> {
        let (cycle, answer) = self.wrong.as_ref()?;
        let verb = source.verb;
        let wanted = source.wanted;
        let said = match (answer, wanted) {
            (Answer::Refused(event), None) => format!("{verb} was refused: {}", said(event, source, plan)),
            (Answer::Refused(event), Some(wanted)) => {
                let said = said(event, source, plan);
                format!("{verb} was refused: {said}; a refusal with {wanted} was expected")
            }
            (Answer::Accepted, wanted) => {
                let wanted = wanted.map_or_else(String::new, |wanted| format!(" with {wanted}"));
                format!("{verb} was accepted; a refusal{wanted} was expected")
            }
            (Answer::None, _) => format!("{verb} was not answered"),
            (Answer::NoRoom, _) => format!("{verb} was not given: {MOST_HELD} commands wait for a cycle already"),
            (Answer::NotInjected, _) => {
                format!(
                    "{verb} had no effect: the plant has no such drive, its bus is off, or there is no room for another latch"
                )
            }
        };
        let sentence = format!("{said}; in {}{}", text(*cycle, plan.cycle_ns), again(self.wrong_times));
        Some(Failure { place: source.place, sentence })
    }

    /// Returns the refusal that was expected.
    pub(super) fn expected(&self, source: &Source<'_>, plan: &Plan) -> Option<Failure> {
        let (cycle, event) = self.refused.as_ref()?;
        let (verb, said) = (source.verb, said(event, source, plan));
        let sentence = format!("{verb}: {said}; in {}{}", text(*cycle, plan.cycle_ns), again(self.refused_times));
        Some(Failure { place: source.place, sentence })
    }
}

fn said(event: &Event, source: &Source<'_>, plan: &Plan) -> String {
    let own = source.refusal.map(str::to_owned).or_else(|| by_id(event, source.deed, plan));
    own.unwrap_or_else(|| message(event, &plan.config))
}

/// Replaces the number of a goal that is not active by its ID; the number was assigned by the run, and the scenario has
/// only the ID.
fn by_id(event: &Event, deed: Option<&Effect>, plan: &Plan) -> Option<String> {
    let Some(Effect::Cancel(place)) = deed else { return None };
    let id = plan.ids.get(*place).filter(|_| event.code == Code::UNKNOWN_GOAL)?;
    let Number::Count(goal) = event.asked else { return None };
    let number = format!("goal {goal} ");
    Some(message(event, &plan.config).replacen(&number, &format!("goal `{}` ", excerpt(id)), 1))
}

fn again(times: u64) -> String {
    match times {
        0 | 1 => String::new(),
        2 => ", and once more".to_owned(),
        times => format!(", and {} times more", times - 1),
    }
}
