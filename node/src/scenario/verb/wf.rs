//! Verb `wf` (contract section 9): commands an axis with the functions of the Siemens WF 725 / 726 positioning modules.
//!
//! All keys except `axis` are optional; the state of an absent key does not change:
//! - `mode`: mdi, single, automatic (single block; also automatic_single), continuous, jog, actual_value; changed at
//!   standstill
//! - `blocks`: up to 16 of `{position, velocity, absolute}`; replaces the program. `position`: a number without unit is
//!   in the axis unit. `velocity`: a number without unit is the speed value, hundredths of max_velocity. `absolute`:
//!   default true (G90)
//! - `block`: number of the block, from 1, with which the next START begins
//! - `start`: true is START
//! - `jog`: plus, minus, both, none: levels of the inputs JOG+ and JOG-. They move the axis in mode jog; in the other
//!   modes they select the direction of approach of a rotary axis
//! - `cam`: level of the deceleration cam of mode reference, if wf.md15 is interface; initially false
//! - `fixed_speed`: 1, 2, 3: jog speed, one of wf.fixed_speed_1 to 3
//! - `enable`: the controller enable request, initially true; false stops the axis
//! - `reset`: true ends the motion and acknowledges the alarm; no other key is permitted with it
//! - `value`: in mode actual_value, the new position of the axis at standstill; a number without unit is in the axis
//!   unit

use super::amount::amount;
use super::{Effect, Reader};
use crate::document::{Map, Value};
use lineshaft_core::command::Action;
use lineshaft_core::position::Length;
use lineshaft_core::request::{Amount, RequestError, Units};
use lineshaft_core::unit::Scale;
use lineshaft_core::vocabulary::wf::{Block, Blocks, FIXED_SPEEDS, Jog, MAX_BLOCKS, Mode, Request, Speed};

/// Modes by name.
pub(crate) const MODES: [(&str, Mode); 8] = [
    ("mdi", Mode::Mdi),
    ("single", Mode::Single),
    ("automatic", Mode::Automatic),
    ("automatic_single", Mode::Automatic),
    ("continuous", Mode::Continuous),
    ("jog", Mode::Jog),
    ("reference", Mode::Reference),
    ("actual_value", Mode::ActualValue),
];

pub(crate) const JOGS: [(&str, Jog); 4] =
    [("none", Jog::None), ("plus", Jog::Plus), ("minus", Jog::Minus), ("both", Jog::Both)];

/// Error of a part of the verb: reported already, or to be returned as refusal of the verb.
enum Trouble {
    Noted,
    Told(RequestError),
}

impl From<RequestError> for Trouble {
    fn from(error: RequestError) -> Self {
        Self::Told(error)
    }
}

impl Reader<'_> {
    pub(super) fn wf(&self, value: &Value<'_>) -> Option<Effect> {
        let mut map = value.map("wf")?;
        let axis = map.required("axis");
        let scale = self.scale(axis.as_ref());
        let request = read(&mut map, scale.as_ref());
        map.finish();
        let axis = axis?;
        let (index, _) = match self.names.config.find_axis(axis.text()?) {
            Ok(found) => found,
            Err(error) => return self.to_command(&axis, Err(error)),
        };
        match request {
            Ok(request)
                if request == Request::default() && self.refuse_nothing(value, "wf", &["axis", "start", "reset"]) =>
            {
                None
            }
            Ok(request) => self.to_command(value, Ok(Action::vocabulary(Request { axis: index, ..request }))),
            Err(Trouble::Told(error)) => self.to_command(value, Err(error)),
            Err(Trouble::Noted) => None,
        }
    }
}

fn read(map: &mut Map<'_>, scale: Option<&Scale>) -> Result<Request, Trouble> {
    // All keys are read before the first error ends reading.
    let mode = map.optional("mode").map(|value| value.choice(&MODES));
    let blocks = map.optional("blocks").map(|value| blocks(&value, scale));
    let block = map.optional("block").map(|value| value.integer(0..=u8::MAX));
    let start = map.optional("start").map(|value| value.boolean());
    let jog = map.optional("jog").map(|value| value.choice(&JOGS));
    let cam = map.optional("cam").map(|value| value.boolean());
    let fixed_speed = map.optional("fixed_speed").map(|value| value.integer(1..=FIXED_SPEEDS));
    let enable = map.optional("enable").map(|value| value.boolean());
    let reset = map.optional("reset").map(|value| value.boolean());
    let preset = map.optional("value").map(|value| position(&value, scale));
    let request = Request {
        axis: 0,
        mode: noted(mode)?,
        blocks: blocks.transpose()?,
        block: noted(block)?,
        start: noted(start)?.unwrap_or(false),
        jog: noted(jog)?,
        cam: noted(cam)?,
        fixed_speed: noted(fixed_speed)?,
        enable: noted(enable)?,
        reset: noted(reset)?.unwrap_or(false),
        value: preset.transpose()?,
    };
    if request.reset && request != (Request { reset: true, ..Request::default() }) {
        map.refuse("reset stands with other keys; it is a verb of its own", Some("write two verbs".to_owned()));
        return Err(Trouble::Noted);
    }
    Ok(request)
}

/// Returns an optional value; an error if it is wrong.
fn noted<T>(value: Option<Option<T>>) -> Result<Option<T>, Trouble> {
    value.map(|value| value.ok_or(Trouble::Noted)).transpose()
}

fn blocks(value: &Value<'_>, scale: Option<&Scale>) -> Result<Blocks, Trouble> {
    let items = value.list().ok_or(Trouble::Noted)?;
    let blocks: Vec<_> = items.iter().map(|item| block(item, scale)).collect();
    let blocks: Vec<Block> = blocks.into_iter().collect::<Result<_, _>>()?;
    let allowed = "1 to 16 blocks are allowed";
    let bad = || RequestError::BadChoice { field: "number of blocks", value: blocks.len() as i64, allowed };
    if blocks.is_empty() || blocks.len() > MAX_BLOCKS {
        return Err(bad().into());
    }
    Ok(Blocks::new(&blocks).ok_or_else(bad)?)
}

fn block(value: &Value<'_>, scale: Option<&Scale>) -> Result<Block, Trouble> {
    let mut map = value.map(value.label()).ok_or(Trouble::Noted)?;
    let place = map.required("position").map(|value| position(&value, scale));
    let speed = map.required("velocity").map(|value| speed(&value, scale));
    let absolute = map.optional("absolute").map(|value| value.boolean());
    map.finish();
    Ok(Block {
        position: place.ok_or(Trouble::Noted)??.exact(),
        speed: speed.ok_or(Trouble::Noted)??,
        absolute: noted(absolute)?.unwrap_or(true),
    })
}

fn position(value: &Value<'_>, scale: Option<&Scale>) -> Result<Length, Trouble> {
    let amount = amount(value, 0, scale, false).ok_or(Trouble::Noted)?;
    // Without an axis no conversion is possible; the missing axis has been reported.
    let length = amount.length(Units::AxisUnit, scale.ok_or(Trouble::Noted)?);
    Ok(length.map_err(|error| RequestError::BadValue { field: value.label().to_owned(), error: Box::new(error) })?)
}

fn speed(value: &Value<'_>, scale: Option<&Scale>) -> Result<Speed, Trouble> {
    let amount = amount(value, 1, scale, false).ok_or(Trouble::Noted)?;
    match amount {
        Amount::Number(number) => Ok(Speed::Value(number)),
        Amount::Quantity(_) | Amount::Increments(_) | Amount::IncrementsPerTime(_) => {
            let rate = amount.rate(Units::AxisUnit, scale.ok_or(Trouble::Noted)?, 1);
            let bad = |error| RequestError::BadValue { field: value.label().to_owned(), error: Box::new(error) };
            Ok(Speed::Velocity(rate.map_err(bad)?))
        }
    }
}
