//! Verbs `command_function`, `run_function`, `load_table` and `load_program`.

use super::{Effect, EffectOfGoal, Reader, did_you_mean, nearest};
use crate::document::Value;
use crate::program;
use lineshaft_core::function::Order;
use lineshaft_core::request::{FieldValue, FunctionRequest};
use lineshaft_core::table::Form;
use lineshaft_core::unit::excerpt;

impl Reader<'_> {
    pub(super) fn command_function(&self, value: &Value<'_>) -> Option<Effect> {
        let mut map = value.map("command_function")?;
        let function = map.required("function");
        // A recorded command may be a parameter set that was only staged.
        let orders = Order::ALL.iter().filter(|(order, ..)| self.recorded || *order != Order::Stage);
        let orders: Vec<_> = orders.map(|(order, name, _)| (*name, *order)).collect();
        let order = map.required("command").and_then(|command| command.choice(&orders));
        let values = map.optional("parameters").map_or(Some(Vec::new()), |given| fields(&given));
        map.finish();
        let function = function?;
        let name = self.known_function(&function)?;
        let request = FunctionRequest { function: name.to_owned(), order: order?, values: values? };
        self.to_command(value, self.names.config.resolve_function(&request))
    }

    pub(super) fn run_function(&mut self, value: &Value<'_>) -> EffectOfGoal {
        let Some(mut map) = value.map("run_function") else { return (None, None) };
        let id = map.optional("id").map(|id| self.ids.carry(&id));
        let function = map.required("function");
        let values = map.optional("parameters").map_or(Some(Vec::new()), |given| fields(&given));
        map.finish();
        let deed = (|| {
            let function = function?;
            let name = self.known_function(&function)?;
            self.to_command(value, self.names.config.resolve_run(name, &values?))
        })();
        (deed, id.flatten())
    }

    /// Reads the name of a function; any name if the step expects a refusal.
    fn known_function<'v>(&self, function: &'v Value<'_>) -> Option<&'v str> {
        let name = function.text()?;
        if self.refused.is_none() && self.names.config.find_function(name).is_err() {
            let known = self.names.config.slots.iter().map(|slot| slot.name.as_str());
            let hint = nearest(name, known).map(did_you_mean);
            function.refuse(format!("no function is called `{}`", excerpt(name)), hint);
            return None;
        }
        Some(name)
    }

    pub(super) fn load_table(&self, value: &Value<'_>) -> Option<Effect> {
        let mut map = value.map("load_table")?;
        let table = map.required("table");
        let name = table.as_ref().and_then(|table| table.text());
        let place = name.and_then(|name| self.names.config.find_table(name).ok());
        let form = place.and_then(|place| self.names.config.tables.get(usize::from(place))).map(|it| it.table.form());
        let words = if form == Some(Form::Words) { map.optional("words") } else { None };
        let points = words.or_else(|| map.required("points"));
        map.finish();
        let (name, points) = (name?, points?);
        let numbers = match form {
            Some(form) => crate::cell::listed(&points, form)?,
            // A name that no table has is refused separately.
            None => (Vec::new(), Vec::new()),
        };
        self.to_command(value, self.names.config.resolve_load_table(name, &numbers.0, &numbers.1))
    }

    pub(super) fn load_program(&self, value: &Value<'_>) -> Option<Effect> {
        let mut map = value.map("load_program")?;
        let program = map.required("program");
        let (file, text) = (map.optional("wasm"), map.optional("module"));
        let state = map.required("state").map(|state| state.choice(&[("keep", true), ("reset", false)]));
        map.finish();
        let (program, keeps) = (program?, state??);
        // A recording contains the module itself.
        let (given, bytes) = match (file, text, self.names.folder) {
            (Some(file), None, Some(folder)) => {
                let bytes = program::load(&folder.join(file.text()?));
                (file, bytes)
            }
            (None, Some(text), _) => {
                let bytes = program::decode(text.text()?).ok_or_else(|| "it is no module".to_owned());
                (text, bytes)
            }
            _ => {
                value.refuse("load_program has one of wasm, a file beside the scenario, and module, a text", None);
                return None;
            }
        };
        match bytes {
            Ok(bytes) => self.to_command(value, self.names.config.resolve_load_program(program.text()?, &bytes, keeps)),
            Err(sentence) => {
                given.refuse(format!("cannot read `{}`: {sentence}", excerpt(given.peek().unwrap_or_default())), None);
                None
            }
        }
    }
}

/// Reads values by the names of their fields.
fn fields(given: &Value<'_>) -> Option<Vec<(String, FieldValue)>> {
    let whole = |value: &Value<'_>| value.integer(i64::MIN..=i64::MAX);
    let field = |(key, value): &(Value<'_>, Value<'_>)| {
        let name = key.text()?.to_owned();
        if !value.is_list() {
            return Some((name, FieldValue::One(whole(value)?)));
        }
        let values: Vec<_> = value.list()?.iter().map(whole).collect();
        Some((name, FieldValue::List(values.into_iter().collect::<Option<_>>()?)))
    };
    let values: Vec<_> = given.entries()?.iter().map(field).collect();
    values.into_iter().collect()
}
