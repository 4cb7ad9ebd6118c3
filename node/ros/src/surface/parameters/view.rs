//! All parameters at one moment: those of the machine, and those of the node itself.

use super::catalogue::{Catalogue, DeclaredParameter};
use super::functions::FunctionParameter;
use super::own::OwnParameter;
use lineshaft_core::parameter::ParameterImage;
use lineshaft_msgs::foreign::rcl_interfaces::msg::{ParameterDescriptor, ParameterValue};
use std::collections::BTreeMap;

/// Declared parameters with their values.
pub(super) struct View<'a> {
    pub catalogue: &'a Catalogue,
    pub image: &'a ParameterImage,
    pub own: &'a BTreeMap<String, OwnParameter>,
}

/// Parameter.
pub(super) enum KnownParameter<'a> {
    Machine(&'a DeclaredParameter),
    Function(&'a FunctionParameter),
    Own(&'a OwnParameter),
}

impl KnownParameter<'_> {
    pub(super) fn value(&self, image: &ParameterImage) -> ParameterValue {
        match self {
            Self::Machine(declared) => declared.message(image),
            Self::Function(known) => known.message(image),
            Self::Own(own) => own.value.clone(),
        }
    }

    pub(super) fn descriptor(&self) -> ParameterDescriptor {
        match self {
            Self::Machine(declared) => declared.descriptor(),
            Self::Function(known) => known.descriptor(),
            Self::Own(own) => own.descriptor.clone(),
        }
    }
}

impl<'a> View<'a> {
    /// Returns all names, ascending.
    pub(super) fn names(&self) -> Vec<&'a str> {
        let of_machine = self.catalogue.all().iter().map(|declared| declared.name.as_str());
        let of_functions = self.catalogue.functions().iter().map(|known| known.name.as_str());
        let mut names: Vec<&str> = of_machine.chain(of_functions).chain(self.own.keys().map(String::as_str)).collect();
        names.sort_unstable();
        names
    }

    /// Returns the parameters with these names; `None` if one of them is not declared, as in rclcpp, or if there are more names than
    /// parameters: an answer to a name that is repeated a million times would be far longer than the request.
    pub(super) fn find_all(&self, names: &[String]) -> Option<Vec<KnownParameter<'a>>> {
        if names.len() > self.catalogue.len() + self.own.len() {
            return None;
        }
        let find = |name: &String| match self.own.get(name) {
            Some(own) => Some(KnownParameter::Own(own)),
            None => match self.catalogue.function(name) {
                Some(known) => Some(KnownParameter::Function(known)),
                None => self.catalogue.find(name).map(KnownParameter::Machine),
            },
        };
        names.iter().map(find).collect()
    }
}
