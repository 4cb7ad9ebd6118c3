//! Tunes an axis of the running machine, from the request to the findings.
//!
//! Law      the trial runs in the cycle thread; its record is evaluated in a separate thread without real-time
//!          requirements
//! Reads    the parameters in force when it begins
//! Writes   a trial, then findings
//! Refuses  settings that [`Setting`] refuses, a real drive without permission, a second trial

use super::bridge::Handle;
use super::trials::Watch;
use crate::tune::{Bounds, Ended, Findings, Setting, Stop, Subject, Trial};
use lineshaft_core::code::Code;
use lineshaft_core::command::Source;
use lineshaft_core::config::MachineConfig;
use lineshaft_ros::surface::host::{GateState, Host, SubmitError, TuneOrder, Tuning, TuningFailure, TuningResult};
use std::sync::Arc;
use tokio::sync::oneshot;

impl Handle {
    /// Makes the cycle thread run a trial of an axis, which is returned at its end.
    ///
    /// # Errors
    /// Returns the reason why not, in one sentence.
    pub fn begin_trial(
        &self,
        setting: Setting,
        source: Source,
    ) -> Result<(Arc<Watch>, oneshot::Receiver<Trial>), String> {
        let (config, trials) = (self.config(), &self.trials);
        let busy = |other: u16| {
            let name = config.axes.get(usize::from(other)).map_or("another axis", |axis| axis.name.as_str());
            format!("{name} is being tuned; one axis at a time")
        };
        if let Some(other) = trials.busy() {
            return Err(busy(other));
        }
        let trial = Trial::new(setting, source, config, self.directory()).map_err(|unfit| unfit.to_string())?;
        let is_real = self.real.get(usize::from(setting.axis)) != Some(&false);
        let trial = if is_real { trial.of_real() } else { trial };
        let begin = || match self.gate() {
            GateState::Open => trials.begin(trial).map_err(busy),
            GateState::Closed => Err("the backends have not started yet; try again".to_owned()),
            GateState::Failed(why) => Err(why),
        };
        // While commands are not accepted, no cycle would run it.
        self.commander.while_open(begin).map_err(|busy| busy.to_string())?
    }
}

/// Begins the tuning; `real` has true at the indices of axes with a real drive. In a cell with real drives, permission
/// is given for an axis by name, because others may follow it.
///
/// # Errors
/// Returns the reason why not, in one sentence.
pub(super) fn begin(handle: &Handle, real: &[bool], order: &TuneOrder) -> Result<Tuning, String> {
    let (config, parameters) = (handle.config(), handle.parameters());
    let place = usize::from(order.axis);
    let Some(axis) = config.axes.get(place) else { return Err(format!("there is no axis {place}")) };
    let &TuneOrder { travel, velocity, effort, duration, inertia_ratio, .. } = order;
    let bounds = Bounds { travel, velocity, effort, duration, inertia_ratio };
    let in_force = |place: usize| *parameters.effective.get(place).unwrap_or(&axis.parameters);
    let subject = Subject::of(axis, &in_force(place));
    let setting = Setting::of(config, &axis.name, in_force, &bounds).map_err(|unfit| unfit.to_string())?;
    if (real.len() != config.axes.len() || real.contains(&true)) && !order.real {
        return Err(format!("{}; `real` permits that", setting.permission_question(axis)));
    }
    let (watch, back) = handle.begin_trial(setting, Source::Ros)?;
    let config = config.clone();
    let found = async move {
        let gone = || TuningFailure { code: Code::DISABLED, message: "the machine has stopped".to_owned() };
        let trial = back.await.map_err(|_| gone())?;
        let failed = |_| {
            Err(TuningFailure {
                code: Code::NOT_TUNED,
                message: "the computation has failed; this is a bug".to_owned(),
            })
        };
        tokio::task::spawn_blocking(move || find(&trial, subject, &config)).await.unwrap_or_else(failed)
    };
    Ok(Tuning { watch, found: Box::pin(found) })
}

/// Evaluates a finished trial.
fn find(trial: &Trial, subject: Subject, config: &MachineConfig) -> Result<TuningResult, TuningFailure> {
    let setting = trial.setting();
    let ended = trial.ended().unwrap_or(Ended::Late);
    if let Some(message) = ended.sentence(config, setting) {
        let code = match ended {
            Ended::Failed(event) => event.code,
            Ended::NotHomed => Code::HOMING_REQUIRED,
            Ended::Stopped(Stop::Cancel) => Code::CANCELLED,
            Ended::Stopped(Stop::Halt) => Code::HALTED,
            Ended::Stopped(Stop::NoRoom) => SubmitError::Full.code(),
            Ended::Stopped(Stop::NoCycles) => Code::NOT_ACTIVE,
            _ => Code::NOT_TUNED,
        };
        return Err(TuningFailure { code, message: format!("{}: {message}", subject.axis) });
    }
    let name = subject.axis.clone();
    let refused = |refusal| TuningFailure { code: Code::NOT_TUNED, message: format!("{name}: {refusal}") };
    let findings = Findings::find(subject, trial.record(), &setting.wish, &setting.before).map_err(refused)?;
    let gains = findings.gains.iter().map(|gain| (gain.key, gain.new)).collect();
    Ok(TuningResult { report: findings.text(), gains })
}
