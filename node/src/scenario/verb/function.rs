//! Verbs `command_function` and `load_table`.

use super::{Deed, Reader, did_you_mean, nearest};
use crate::document::Value;
use lineshaft_core::function::Order;
use lineshaft_core::request::{FieldValue, FunctionRequest};
use lineshaft_core::table::Form;
use lineshaft_core::unit::excerpt;

impl Reader<'_> {
    pub(super) fn command_function(&self, value: &Value<'_>) -> Option<Deed> {
        let mut map = value.map("command_function")?;
        let function = map.required("function");
        // What was recorded may be a set that was staged alone.
        let orders = Order::ALL.iter().filter(|(order, ..)| self.recorded || *order != Order::Stage);
        let orders: Vec<_> = orders.map(|(order, name, _)| (*name, *order)).collect();
        let order = map.required("command").and_then(|command| command.choice(&orders));
        let values = map.optional("parameters").map_or(Some(Vec::new()), |given| fields(&given));
        map.finish();
        let function = function?;
        let name = function.text()?;
        if self.refused.is_none() && self.names.config.find_function(name).is_err() {
            let known = self.names.config.slots.iter().map(|slot| slot.name.as_str());
            let hint = nearest(name, known).map(did_you_mean);
            function.refuse(format!("no function is called `{}`", excerpt(name)), hint);
            return None;
        }
        let request = FunctionRequest { function: name.to_owned(), order: order?, values: values? };
        self.settle(value, self.names.config.resolve_function(&request))
    }

    pub(super) fn load_table(&self, value: &Value<'_>) -> Option<Deed> {
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
            // A name that no table has is refused by itself.
            None => (Vec::new(), Vec::new()),
        };
        self.settle(value, self.names.config.resolve_load_table(name, &numbers.0, &numbers.1))
    }
}

/// Values by the names of their fields.
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
