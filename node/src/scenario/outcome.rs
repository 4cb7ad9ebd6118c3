//! What became of a command of a scenario, over all the times that it was given.

use super::Plan;
use super::moment::text;
use super::player::MOST_HELD;
use super::refusal::Refusal;
use super::report::Failure;
use super::verb::Deed;
use crate::document::Place;
use lineshaft_core::code::Code;
use lineshaft_core::event::{Event, Number};
use lineshaft_core::object::Object;
use lineshaft_core::parameter::ROWS;
use lineshaft_core::text::message;
use lineshaft_core::unit::excerpt;

/// How a command was answered.
#[derive(Clone, Copy, Debug)]
pub(super) enum Answer {
    Accepted,
    Refused(Event),
    /// Not at all: the event found no room.
    None,
    /// The command was not given: too many wait for a cycle.
    NoRoom,
    /// There was no plant, no such drive, or no room for a latch.
    NotInjected,
}

/// What became of an act.
#[derive(Clone, Debug, Default)]
pub(super) struct Outcome {
    /// The first answer that is wrong.
    wrong: Option<(u64, Answer)>,
    wrong_times: u64,
    /// The first refusal that is right.
    refused: Option<(u64, Event)>,
    refused_times: u64,
}

/// Is the answer the one that the step expects?
pub(super) fn is_expected(answer: &Answer, wanted: Option<&Refusal>, deed: Option<&Deed>, plan: &Plan) -> bool {
    match (answer, wanted) {
        (Answer::Accepted, None) => true,
        // The sentence was compared when the scenario was read.
        (Answer::Refused(_), Some(_)) if matches!(deed, Some(Deed::Refused(_))) => true,
        (Answer::Refused(event), Some(wanted)) => names(event, wanted, deed, plan),
        _ => false,
    }
}

/// Is what is wanted said by the sentence, by the parameter or by the code?
fn names(event: &Event, wanted: &Refusal, deed: Option<&Deed>, plan: &Plan) -> bool {
    // Of a function it is the number of a field, which the sentence names.
    let number = event.parameter.filter(|_| !matches!(event.source, Object::Function(_)));
    let row = number.and_then(|row| ROWS.get(usize::from(row)));
    let code = Code::rows().find(|row| row.code == event.code);
    let names = [row.map_or("", |row| row.key), code.map_or("", |row| row.name)];
    let by_id = by_id(event, deed, plan).unwrap_or_default();
    wanted.fits(event.code, &[&message(event, &plan.config), &by_id], &names)
}

/// Whose outcome it is: an act of a step, or an entry of `drive`.
pub(super) struct Source<'a> {
    place: Place,
    verb: &'a str,
    deed: Option<&'a Deed>,
    /// The sentence of a request that never became a command.
    refusal: Option<&'a str>,
    /// What the step expects.
    wanted: Option<&'a Refusal>,
}

impl<'a> Source<'a> {
    /// Of the outcome at that place.
    pub(super) fn of(plan: &'a Plan, index: usize) -> Self {
        match plan.acts.get(index) {
            Some(act) => {
                let step = plan.steps.iter().find(|step| step.acts.contains(&index));
                let refusal = if let Deed::Refused(sentence) = &act.deed { Some(message.as_str()) } else { None };
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
    /// Notes an answer.
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

    /// What is wrong with it.
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
        Some(Failure { place: source.place, message })
    }

    /// The refusal that was expected.
    pub(super) fn expected(&self, source: &Source<'_>, plan: &Plan) -> Option<Failure> {
        let (cycle, event) = self.refused.as_ref()?;
        let (verb, said) = (source.verb, said(event, source, plan));
        let sentence = format!("{verb}: {said}; in {}{}", text(*cycle, plan.cycle_ns), again(self.refused_times));
        Some(Failure { place: source.place, message })
    }
}

fn said(event: &Event, source: &Source<'_>, plan: &Plan) -> String {
    let own = source.refusal.map(str::to_owned).or_else(|| by_id(event, source.deed, plan));
    own.unwrap_or_else(|| message(event, &plan.config))
}

/// A goal that is not active has the number that the run gave it; the scenario knows it by its id.
fn by_id(event: &Event, deed: Option<&Deed>, plan: &Plan) -> Option<String> {
    let Some(Deed::Cancel(place)) = deed else { return None };
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
