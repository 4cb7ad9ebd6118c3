//! Test machine with one closed-loop axis on an ideal drive, and helpers for the tests of the module.

use crate::code::Code;
use crate::command::Action;
use crate::config::{AxisConfig, MachineConfig};
use crate::drive::Capabilities;
use crate::event::Kind;
pub(super) use crate::machine::rig::Rig;
use crate::machine::rig::scale;
use crate::parameter::AxisParameters;
use crate::vocabulary::wf::Request;

/// 1000 inc/mm; 500 mm/s, 100 mm/s^2 up and 200 mm/s^2 down.
pub(super) fn config() -> MachineConfig {
    let mut parameters = AxisParameters::new(500_000.0, 1_000_000.0);
    parameters.error_reaction = 2;
    (parameters.vocabularies.wf.md1, parameters.vocabularies.wf.md2) = (Some(100_000.0), Some(200_000.0));
    let axis = AxisConfig::new("x".into(), scale(), Some(Capabilities::all(0)), parameters);
    MachineConfig { cycle_ns: 1_000_000, axes: vec![axis], ..MachineConfig::default() }
}

impl Rig {
    /// Returns an enabled machine.
    pub(super) fn wf_of(config: MachineConfig) -> Self {
        let mut rig = Self::of(config);
        rig.enable();
        rig
    }

    pub(super) fn wf() -> Self {
        Self::wf_of(config())
    }

    /// Executes one cycle with an action. Returns the code of a refusal.
    pub(super) fn act(&mut self, action: Action) -> Option<Code> {
        let sequence = self.give(action);
        self.answer(sequence).err().map(|refused| refused.code)
    }

    /// Executes one cycle with a request. Returns the code of a refusal.
    pub(super) fn wf_verb(&mut self, request: &Request) -> Option<Code> {
        self.act(Action::vocabulary(request.clone()))
    }

    pub(super) fn wf_state(&self) -> &'static str {
        super::super::STATES[self.int("x.wf.state") as usize]
    }

    /// Returns the codes of the errors so far.
    pub(super) fn errors(&self) -> Vec<Code> {
        self.events.iter().filter(|event| event.kind == Kind::Error).map(|event| event.code).collect()
    }
}
