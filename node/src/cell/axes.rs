//! Reads section `axes`: drives, encoders and wiring of each axis. Other modules read its parameters.

use super::amc;
use super::analog::{Outputs, is_off_bus};
use super::backends::{Backend, Context, DriveKeys, Hardware};
use super::brake;
use super::compensation;
use super::devices::Io;
use super::drives::{self, Drive, interface_of, law_of};
use super::encoders::{self, Reads};
use super::fixtures;
use super::joints;
use super::loops::Chains;
use super::machine;
use super::models::model;
use super::names::{Entry, Section, UsedOnce, limit, quote};
use super::parameters;
use super::scale::Travel;
use super::terminals::{self, CellTerminal};
use super::wiring;
use crate::document::{Allowed, Value};
use lineshaft_core::axis::{
    ENABLE_TIMEOUT_NS, MISSED_CYCLES, Wired, may_be_analog, may_carry, may_close_loop, may_find_velocity,
    may_output_sign, may_read,
};
use lineshaft_core::code::{Code, not_built_here};
use lineshaft_core::config::{AxisConfig, EncoderConfig, TableConfig};
use lineshaft_core::drive::{Capabilities, Interface, SpeedOutputs};
use lineshaft_core::encoder::source::Master;
use lineshaft_core::modulo::Modulo;
use lineshaft_core::object::MAX_AXES;
use lineshaft_core::sim::{Mechanics, Model};
use lineshaft_core::unit::{Dimension, ScaleKind, number_to_text};
use std::cmp::Ordering;

/// Substitute for the ranges of a model if key `cycle` has a problem.
const SOME_CYCLE_NS: u64 = 1_000_000;

/// An axis, its drive and its second drive; `None` for a virtual axis, and without a second drive.
pub(super) struct Axis {
    pub config: AxisConfig,
    /// Joint name.
    pub joint: String,
    pub first: Option<Driven>,
    pub second: Option<Driven>,
    /// Warnings about its numbers without a unit.
    pub bare_numbers: Vec<String>,
}

/// A drive: its simulation, its location, and the keys that only its backend has.
pub(super) struct Driven {
    pub simulated: (Model, Mechanics),
    pub at: Hardware,
    pub keys: Option<DriveKeys>,
    /// Whether the drive is on no bus of its backend.
    pub is_off_bus: bool,
}

impl Driven {
    /// Whether its encoder has index pulses: those of a touch probe, or of the simulation.
    pub(super) fn has_index(&self) -> bool {
        match &self.keys {
            Some(keys) => keys.has_index(),
            None => self.simulated.1.fixtures.index.is_some(),
        }
    }

    /// Whether the cell shows that the digital inputs of the drive (60FDh) are not read.
    pub(super) fn has_unread_inputs(&self, terminals: &[CellTerminal]) -> bool {
        let is_read_by_io = || terminals::reads_drive(self.at, terminals);
        self.keys.as_ref().is_some_and(|keys| keys.has_unread_inputs(is_read_by_io()))
    }
}

/// Objects that may be used only once in all axes.
struct UniqueNames<'d> {
    taken: drives::Taken,
    outputs: wiring::Taken,
    switches: fixtures::Taken,
    masters: amc::Masters<'d>,
    functions: machine::Functions<'d>,
    joints: joints::Taken<'d>,
}

/// Entries of other sections.
#[derive(Clone, Copy)]
pub(super) struct Entries<'a, 'd> {
    pub io: &'a Io<'d>,
    pub encoders: &'a [Option<EncoderConfig>],
    /// Locations of the encoders.
    pub encoders_at: &'a [Option<Hardware>],
    pub tables: &'a [Option<TableConfig>],
}

/// Reads the axes; `None` for one with problems.
pub(super) fn read<'d>(
    cx: &Context<'d>,
    of: Entries<'_, 'd>,
    functions: machine::Functions<'d>,
    outputs: wiring::Taken,
    chains: &Chains,
) -> Vec<Option<Axis>> {
    let entries = cx.names.section(Section::Axes);
    limit(entries, MAX_AXES);
    let mut once = UniqueNames {
        taken: UsedOnce::new(),
        outputs,
        switches: UsedOnce::new(),
        masters: amc::Masters::new(),
        functions,
        joints: joints::Taken::new(),
    };
    let axes = entries.iter().enumerate();
    let axes = axes.map(|(place, entry)| {
        entry.value.record_bare_numbers();
        let axis = axis(place, entry, cx, of, &mut once);
        let numbers = entry.value.take_bare_numbers();
        axis.map(|axis| {
            let warnings = numbers.iter().filter_map(|number| number.warning(&axis.config.scale));
            Axis { bare_numbers: warnings.collect(), ..axis }
        })
    });
    let axes = axes.collect();
    machine::refuse_shared(&once.functions, &of.io.entries, &once.outputs);
    amc::refuse_loops(&once.masters, chains, cx);
    axes
}

fn axis<'d>(
    place: usize,
    entry: &Entry<'d>,
    cx: &Context<'d>,
    of: Entries<'_, 'd>,
    once: &mut UniqueNames<'d>,
) -> Option<Axis> {
    let UniqueNames { taken, outputs, switches, masters, functions, joints } = once;
    let Entries { io: entries, encoders: coded, tables, .. } = of;
    let io = &*entries.entries;
    let name = entry.name();
    let mut map = entry.value.map(format!("axis `{name}`"))?;
    map.explain_by(parameters::word_of_source);
    let joint = joints::read(&mut map, entry, cx, joints);
    let (travel, factors) = Travel::read_axis(&mut map);
    let ((described, second), has_two) =
        drives::read(&mut map, name, &travel, cx, taken, &mut Outputs { io: entries, taken: outputs });
    let (drive, keys) = described.map_or((None, None), |(drive, keys)| (Some(drive), keys));
    if has_two && !map.has("max_skew") {
        map.required("max_skew");
    }
    let modulo = map.optional("modulo").map(|value| modulo(&value, &travel));
    let sim = map.optional("sim");
    let reads = if drive == Some(Drive::Virtual) { Reads::Nothing(name) } else { Reads::Something };
    let feedback = map.optional("feedback");
    let wired = encoders::feedback(feedback.as_ref(), reads, &travel, cx);
    let mut sections = parameters::Sections::open(&mut map);
    let brake = brake::read(&mut map, drive == Some(Drive::Virtual), cx, io, outputs);
    let pitch_error = compensation::pitch_error(&mut map, &mut sections, cx);
    let wiring = amc::wiring(place, &mut map, &mut sections, cx, (io, tables), masters);
    let who = drive.map(|drive| interface_of(Some(drive)));
    let form = |place| Some(coded.get(usize::from(place))?.as_ref()?.form);
    let absolute = wired.unwrap_or_default().absolute_sources(form);
    let new = parameters::Axis { who, law: law_of(drive), has_two, absolute, cycle_ns: cx.cycle_ns };
    let (mut parameters, given) = parameters::read(&mut map, &mut sections, &travel, new);
    parameters.macs.scale = factors;
    machine::check_axis(&parameters, &given, io, who.is_none_or(|who| may_output_sign(who, &parameters)));
    machine::note_functions(functions, &parameters.output_functions(), &given);
    let open_loop = sections.of("wf").map_or(Some(SpeedOutputs::default()), |section| {
        wiring::read(section, no_output_reason(drive, name).as_deref(), cx, io, outputs)
    });
    sections.finish();
    map.finish();
    let analog = match drive {
        Some(Drive::Real { analog, .. }) => analog,
        _ => None,
    };
    let simulated = match drive {
        Some(Drive::Virtual) => {
            for value in sim.iter() {
                let sentence = format!("{} is for axes with a drive; axis {} is virtual", value.label(), quote(name));
                value.refuse(sentence, Some("leave it out".to_owned()));
            }
            None
        }
        _ => {
            let cycle_ns = cx.cycle_ns.unwrap_or(SOME_CYCLE_NS);
            // A drive that homes by itself uses the index of its own encoder, whichever encoder the axis reads.
            let indexed = match wired {
                Some(Wired::Encoder(place)) if !parameters.homing.in_drive => {
                    cx.names.section(Section::Encoders).get(usize::from(place)).map(Entry::name)
                }
                _ => None,
            };
            let read = |value: Value<'d>| {
                let mut map = value.map("sim")?;
                let reads_encoder = matches!(wired, Some(Wired::Encoder(_)));
                let model = model(&mut map, interface_of(drive), reads_encoder, cycle_ns);
                let mechanics = fixtures::read(&mut map, &travel, cx, io, switches, indexed);
                let mechanics =
                    mechanics.filter(|mechanics| analog.is_none() || fixtures::are_wired(&value, mechanics));
                // A key with problems counts as a brake, too.
                let has_brake = brake != Some(None) || parameters.outputs.brake != 0;
                let times = fixtures::brake_times(&mut map, has_brake);
                let load = fixtures::load(&mut map, &travel);
                let beside = fixtures::second(&mut map, has_two, &travel, cx, io, switches);
                map.finish();
                let brake = brake::simulated(brake.flatten(), parameters.outputs.brake, io, times?);
                let mechanics = Mechanics { load: load?, brake, ..mechanics? };
                // Values that are not given for the second drive are those of the first.
                let beside = beside?.unwrap_or(Mechanics { wires: [None; 3], ..mechanics });
                Some((model?, mechanics, Mechanics { load: mechanics.load, brake, ..beside }))
            };
            let brake = brake::simulated(brake.flatten(), parameters.outputs.brake, io, [0; 2]);
            let bare = Mechanics { brake, ..Mechanics::default() };
            let effort = interface_of(drive).filter(|interface| interface.takes_effort());
            if let (None, Some(interface)) = (&sim, effort) {
                let sentence = format!(
                    "axis {} has interface {} and no simulated motor; sim is expected",
                    quote(name),
                    interface.name()
                );
                entry.key.refuse(sentence, Some("sim: {model: motor, ..}".to_owned()));
                return None;
            }
            let (model, mechanics, beside) = sim.map_or(Some((Model::Ideal, bare, bare)), read)?;
            Some((model, Mechanics { sign: fixtures::sign(&parameters), ..mechanics }, beside))
        }
    };
    let interface = interface_of(drive).unwrap_or_default();
    let law = law_of(drive);
    let missed = |drive: Option<Drive>| match drive {
        Some(Drive::Real { missed_cycles, .. }) => missed_cycles,
        _ => MISSED_CYCLES,
    };
    let beside = second.as_ref().map(|(drive, _)| *drive);
    let missed_cycles = missed(drive).min(beside.map_or(u32::MAX, |drive| missed(Some(drive))));
    let enable_timeout = |drive: Option<Drive>| match drive {
        Some(Drive::Real { enable_timeout_ns, .. }) => Some(enable_timeout_ns),
        _ => None,
    };
    // Two drives are switched on together, so the longer time applies.
    let enable_timeout_ns = enable_timeout(drive).max(enable_timeout(beside)).unwrap_or(ENABLE_TIMEOUT_NS);
    let driven = |drive: Drive, keys: Option<DriveKeys>, simulated: (Model, Mechanics)| match drive {
        Drive::Virtual => (None, None),
        Drive::Real { at, kind, analog, .. } => {
            let offers = kind.offers(interface, simulated.0, keys.as_ref());
            // The drive has only outputs and an input.
            let bare = Capabilities {
                delay: offers.delay,
                velocity: interface == Interface::Velocity,
                torque: interface == Interface::Torque,
                ..Capabilities::default()
            };
            let is_off_bus = is_off_bus(analog, Some(kind));
            (Some(if analog.is_some() { bare } else { offers }), Some(Driven { simulated, at, keys, is_off_bus }))
        }
    };
    let (model, mechanics, of_second) = simulated.unwrap_or_default();
    let (drive, first) = driven(drive?, keys, (model, mechanics));
    let (second_offers, second) = match second {
        Some((drive, keys)) => driven(drive, keys, (model, of_second)),
        // One of two drives has problems.
        None if has_two => return None,
        None => (None, None),
    };
    let modulo = modulo.map_or(Some(None), |modulo| modulo.map(Some))?;
    let open_loop = open_loop?;
    let config = AxisConfig::new(name.to_owned(), travel.scale?, drive, parameters);
    let config = AxisConfig {
        modulo,
        second: second_offers,
        interface,
        law,
        missed_cycles,
        enable_timeout_ns,
        drive_mode: first.as_ref().and_then(|first| first.keys.as_ref()).map(DriveKeys::mode_number),
        open_loop,
        analog,
        brake: brake?,
        vocabularies: wiring?,
        wired: wired?,
        pitch_error: pitch_error.as_ref()?.as_ref().map(|(place, _)| *place),
        ..config
    };
    compensation::check(&config, &pitch_error?, tables);
    check_encoder_backend(&config, first.as_ref(), of, feedback.as_ref(), cx);
    check_source(&config, feedback.as_ref().unwrap_or(&entry.key), &given, cx);
    check_master(&config, place, &given, cx);
    check_loop(&config, place, &entry.key, &given, cx);
    check_carried(&config, &given);
    amc::check(&config, &given, cx.cycle_ns);
    Some(Axis { config, joint: joint.to_owned(), first, second, bare_numbers: Vec::new() })
}

/// Refuses parameters that two drives of one axis do not support.
fn check_carried(axis: &AxisConfig, given: &parameters::Given<'_>) {
    let Some(Err((key, code))) = axis.second.map(|_| may_carry(axis.wired, &axis.parameters)) else { return };
    if let Some((_, value)) = given.iter().find(|(given, _)| *given == key) {
        value.refuse(format!("{key} {} {}", value.peek().unwrap_or_default(), not_built_here(code)), None);
    }
}

/// Refuses a real encoder for an axis with a simulated analog drive, and a simulated encoder for a real one.
fn check_encoder_backend(
    axis: &AxisConfig,
    drive: Option<&Driven>,
    of: Entries<'_, '_>,
    feedback: Option<&Value<'_>>,
    cx: &Context<'_>,
) {
    let (Some(_), Some(drive), Wired::Encoder(place)) = (axis.analog, drive, axis.wired) else { return };
    let is_simulated = |at: Hardware| cx.backend(at).map(Backend::is_simulated);
    let Some(at) = of.encoders_at.get(usize::from(place)).copied().flatten() else { return };
    if let (Some(feedback), true) = (feedback, is_simulated(at) != is_simulated(drive.at)) {
        let sentence = "names an encoder that is simulated while its reference is not, or the other way round";
        feedback.refuse(format!("feedback of axis {} {sentence}", quote(&axis.name)), None);
    }
}

/// Refuses a source that does not exist, or that the drive does not use for its position loop.
fn check_source(axis: &AxisConfig, feedback: &Value<'_>, given: &parameters::Given<'_>, cx: &Context<'_>) {
    let encoders = cx.names.section(Section::Encoders).len();
    let interface = axis.drive.map(|_| axis.interface);
    // Invalid numbers were refused with the other parameters.
    if axis.parameters.encoder.check().is_err() {
        return;
    }
    let Err((key, code)) = may_read(axis.wired, encoders, interface, &axis.parameters) else { return };
    match given.iter().find(|(given, _)| *given == key) {
        Some((_, value)) => {
            value.refuse(format!("{key} {} {}", value.peek().unwrap_or_default(), not_built_here(code)), None);
        }
        None => {
            let sentence = "names an encoder that a drive with interface position does not close its loop with";
            feedback.refuse(format!("feedback of axis {} {sentence}", quote(&axis.name)), None);
        }
    }
}

/// Refuses values with which the control loops of the axis cannot run; if the key is not given, the problem is reported
/// at the axis.
fn check_loop(axis: &AxisConfig, place: usize, name: &Value<'_>, given: &parameters::Given<'_>, cx: &Context<'_>) {
    let Some(cycle_ns) = cx.cycle_ns else { return };
    let encoders = cx.names.section(Section::Encoders).len();
    let interface = axis.drive.map(|_| axis.interface);
    let closes = may_close_loop(interface, axis.law, &axis.parameters, cycle_ns);
    let finds = may_find_velocity(place, interface, (axis.wired, encoders), axis.second.is_some(), &axis.parameters);
    let sources = (axis.wired, encoders);
    let reaches = may_be_analog(axis.analog.as_ref(), axis.interface, sources, &axis.parameters);
    let Err((key, code)) = closes.and(reaches).and(finds) else { return };
    let why = control_loop_error(axis, key, code);
    match given.iter().find(|(given, _)| *given == key) {
        Some((_, value)) => value.refuse(format!("{key} {} {why}", value.peek().unwrap_or_default()), None),
        None => name.refuse(format!("{key} of axis {} {why}", quote(&axis.name)), None),
    }
}

/// Returns the message, without the name, for a value with which the control loops of an axis cannot run.
fn control_loop_error(axis: &AxisConfig, key: &str, code: Code) -> String {
    let Some(analog) = axis.analog.filter(|_| code == Code::ANALOG_FULL) else {
        return not_built_here(code).to_owned();
    };
    let (full, most) = match key {
        "max_velocity" => ("full_velocity", axis.scale.format_rate_precisely(analog.full, 1)),
        _ => ("full_effort", number_to_text(analog.full)),
    };
    format!("exceeds {full} {most}, which is what its drive does at 10 V")
}

/// Refuses a `mencodertype` that names an object that does not exist, or the axis itself.
fn check_master(axis: &AxisConfig, place: usize, given: &parameters::Given<'_>, cx: &Context<'_>) {
    let Some((key, value)) = given.iter().find(|(key, _)| *key == "mencodertype") else { return };
    let (axes, encoders) = (cx.names.section(Section::Axes).len(), cx.names.section(Section::Encoders).len());
    let (number, own) = (axis.parameters.encoder.mencodertype, place + 1);
    let wrong = match Master::decode(number) {
        Some(Master::Axis(named)) if usize::from(named) == own => "is the axis itself".to_owned(),
        Some(Master::Axis(named)) if usize::from(named) > axes => format!("is axis {named}, and the cell has {axes}"),
        Some(Master::Terminal(named)) if usize::from(named) > encoders => {
            format!("is entry {named} of encoders, and the cell has {encoders}")
        }
        _ => return,
    };
    let range = |from: usize, to: usize| match from.cmp(&to) {
        Ordering::Less => Some(format!("-{from} to -{to}")),
        Ordering::Equal => Some(format!("-{from}")),
        Ordering::Greater => None,
    };
    let others = [range(1, place), range(own + 1, axes)].into_iter().flatten();
    let terminals = (1..=encoders.min(TERMINALS)).map(|terminal| format!("{terminal}0"));
    let allowed: Vec<_> = ["0, 1, 2, 5, 6".to_owned()].into_iter().chain(others).chain(terminals).collect();
    value.refuse(format!("{key} {number} {wrong}; {} are allowed", allowed.join(", ")), None);
}

/// Number of encoders that MENCODERTYPE can select.
const TERMINALS: usize = 3;

/// Returns the reason why an axis switches no outputs, if known.
fn no_output_reason(drive: Option<Drive>, axis: &str) -> Option<String> {
    match drive? {
        Drive::Virtual => Some(format!("axis {} is virtual", quote(axis))),
        Drive::Real { interface: Interface::OpenLoop, .. } => None,
        Drive::Real { interface, .. } => Some(format!("axis {} has interface {}", quote(axis), interface.name())),
    }
}

/// Scales in rad have larger denominators than this, because of pi.
const MOST_OF_A_SCALE: i128 = 1 << 31;

fn modulo(value: &Value<'_>, travel: &Travel) -> Option<Modulo> {
    if travel.kind == Some(ScaleKind::Linear) {
        value.refuse("modulo is for rotary axes; this one is linear", Some("leave it out".to_owned()));
        return None;
    }
    let quantity = value.quantity(&[Dimension::Angle(0), Dimension::Increments(0)], &Allowed::Positive)?;
    let exact = match travel.scale?.exact(&quantity) {
        Ok(exact) => exact,
        Err(error) => {
            value.refuse(format!("modulo: {error}"), error.hint());
            return None;
        }
    };
    let parts = (i64::try_from(*exact.numer()).ok(), i64::try_from(*exact.denom()).ok());
    let modulo =
        if let (Some(numerator), Some(denominator)) = parts { Modulo::new(numerator, denominator) } else { None };
    if modulo.is_none() {
        let allowed = "1 inc to 2^61 inc as a fraction with a denominator below 2^31 is allowed";
        let hint = if quantity.unit() == Dimension::Angle(0).si_unit() {
            Some("write it in deg or rev".to_owned())
        } else {
            // In rad, the unit of a number without unit, no revolution is an exact number of increments.
            let is_of_rad = *exact.denom() > MOST_OF_A_SCALE;
            is_of_rad.then(|| "write `per` of `scale` in deg or rev, such as `per: 360 deg`".to_owned())
        };
        value.refuse(format!("modulo is `{quantity}`, {exact} inc; {allowed}"), hint);
    }
    modulo
}
