//! The motion core of Lineshaft: one deterministic cycle of encoders, axes and signals.
//!
//! The core uses no ROS, CAN, files, threads or wall time. [`machine::Machine::cycle`] takes the inputs and commands of
//! a cycle and returns its outputs; nothing else changes the machine. The config and the commands and inputs of each
//! cycle determine every output bit. A cycle does not allocate, lock or wait. Integer arithmetic explicitly saturates,
//! wraps or is checked.
//!
//! # Example
//!
//! Two simulated axes: `roll` follows `line` with the gear 355 : 113. 1,000 cycles of 1 ms.
//!
//! ```
//! use lineshaft_core::command::{Action, Command, Commands, Source};
//! use lineshaft_core::config::{AxisConfig, MachineConfig};
//! use lineshaft_core::drive::{Backend, Capabilities};
//! use lineshaft_core::machine::Machine;
//! use lineshaft_core::object::AxisSet;
//! use lineshaft_core::parameter::AxisParameters;
//! use lineshaft_core::request::{Amount, MoveRequest, Rates, SynchronizeRequest, Units};
//! use lineshaft_core::sim::{Model, Plant};
//! use lineshaft_core::unit::{Fraction, Quantity, Scale, Unit};
//!
//! // One increment is 1 um; at most 1 m/s and 10 m/s^2.
//! let per = Quantity::new(Fraction::from_integer(1), Unit::METRE);
//! let scale = Scale::new(Fraction::from_integer(1_000_000), per)?;
//! let parameters = AxisParameters::new(1e6, 1e7);
//! let axis = |name: &str| AxisConfig::new(name.to_owned(), scale, Some(Capabilities::all(0)), parameters);
//! let axes = vec![axis("line"), axis("roll")];
//! let config = MachineConfig { cycle_ns: 1_000_000, axes, ..MachineConfig::default() };
//!
//! // Mode 1: position. The goal is 30 mm, with 0.1 m/s and 1 m/s^2.
//! let (axis, master) = ("roll".to_owned(), "line".to_owned());
//! let gear = SynchronizeRequest { axis, master, mode: 1, numerator: 355, denominator: 113, ..Default::default() };
//! let gear = Action::Synchronize(config.resolve_synchronize(&gear)?);
//! let (position, rates) = (Amount::Number(30_000.0), Rates::numbers([1e5, 1e6, 1e6, 0.0]));
//! let goal = MoveRequest { axis: "line".to_owned(), units: Units::Increments, position, rates, ..Default::default() };
//! let goal = Action::Move(config.resolve_move(&goal)?);
//!
//! let mut plant = Plant::new(&config, &[Some(Model::Ideal); 2]);
//! let mut machine = Machine::new(config)?;
//! let (mut inputs, mut outputs, mut sequence) = (machine.inputs(), machine.outputs(), 0);
//! let mut run = |action: Action, cycles: u32| {
//!     sequence += 1;
//!     let command = [Command { sequence, source: Source::Cli, action }];
//!     for cycle in 0..cycles {
//!         inputs.begin(machine.next_cycle(), 0);
//!         plant.read(&mut inputs);
//!         let commands = if cycle == 0 { Commands::queue(&command) } else { Commands::default() };
//!         machine.cycle(&inputs, commands, &mut outputs);
//!         plant.write(&outputs);
//!     }
//! };
//! run(Action::Enable(AxisSet::first(2)), 100);
//! run(gear, 100);
//! run(goal, 800);
//!
//! let position = |axis: &str| {
//!     let signal = machine.directory().find(&format!("{axis}.command.position")).expect("each axis has it");
//!     machine.board().int(signal)
//! };
//! // 30,000 * 355 / 113 is 94,247.8: the signal is its floor.
//! assert_eq!((position("line"), position("roll")), (30_000, 94_247));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
#![forbid(unsafe_code)]

pub mod axis;
pub mod cam;
pub mod code;
pub mod command;
pub mod config;
pub mod drive;
pub mod encoder;
pub mod event;
pub mod function;
pub mod gantry;
pub mod law;
pub mod machine;
pub mod modulo;
pub mod object;
pub mod parameter;
pub mod position;
pub mod profile;
pub mod regulator;
pub mod request;
pub mod signal;
pub mod sim;
pub mod state;
pub mod sync;
pub mod table;
pub mod text;
pub mod trajectory;
pub mod unit;
pub mod vocabulary;
