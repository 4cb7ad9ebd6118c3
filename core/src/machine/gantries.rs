//! Axes with two drives: conversion between the process data of both drives and that of the axis.

use super::Machine;
use crate::axis::assigned_input;
use crate::command::Action;
use crate::drive::{Inputs, Outputs};
use crate::event::Refusal;
use crate::object::AxisSet;
use crate::position::Position;
use crate::signal::gantry::GantrySignal;

impl Machine {
    /// Replaces the input of the first drive of each gantry by the combined input of both drives.
    pub(super) fn join_drives(&mut self, inputs: &Inputs, joined: &mut Inputs) {
        for gantry in &mut self.state.gantries {
            let setup = *gantry.setup();
            let Some(axis) = self.state.axes.get_mut(usize::from(setup.axis)) else { continue };
            let [Some(first), Some(second)] = setup.drives.map(|place| inputs.drive.get(place)) else { continue };
            let p = &axis.parameters;
            let numbers = [p.assigned.refswitch, p.gantry.second_refswitch];
            let assigned = numbers.map(|number| assigned_input(|place| inputs.digital(place), number));
            let input = gantry.read([first, second], assigned, p.gantry.square_offset);
            if let Some(place) = joined.drive.get_mut(setup.drives[0]) {
                *place = input;
            }
            // The skew of the drives is not covered by the fast paths.
            axis.require_full_cycle();
        }
    }

    /// Checks that the gantries among these axes may be switched on.
    pub(super) fn check_skews(&self, action: &Action, axes: AxisSet) -> Result<(), Refusal> {
        if !matches!(action, Action::Enable(_)) {
            return Ok(());
        }
        let mut named = axes.iter().filter_map(|index| self.state.axes.get(usize::from(index)));
        named.try_for_each(|axis| {
            let gantry = axis.gantry().and_then(|place| self.state.gantries.get(usize::from(place)));
            gantry.map_or(Ok(()), |gantry| axis.admits_skew(gantry))
        })
    }

    /// Writes the outputs of the second drives, and publishes the signals of the gantries.
    pub(super) fn write_second_drives(&mut self, outputs: &mut Outputs) {
        for (gantry, &first) in self.state.gantries.iter().zip(&self.signals.gantries) {
            let setup = gantry.setup();
            let [leads, follows] = setup.drives;
            let Some(output) = outputs.drive.get(leads).map(|output| gantry.lead(output)) else { continue };
            if let Some(place) = outputs.drive.get_mut(follows) {
                *place = output;
            }
            let Some(axis) = self.state.axes.get(usize::from(setup.axis)) else { continue };
            let skew = axis.in_axis_direction(gantry.skew());
            let place = axis.actual().position + Position::whole(skew);
            let shows = [
                (GantrySignal::Skew, skew),
                (GantrySignal::SecondPosition, place.floor()),
                (GantrySignal::SecondCount, gantry.second_count()),
                (GantrySignal::SecondState, gantry.second() as i64),
                (GantrySignal::SecondSwitch, i64::from(gantry.second_home())),
                (GantrySignal::SecondOutput, output.position),
            ];
            for (signal, value) in shows {
                self.state.board.set_int(signal.of(first), value);
            }
        }
    }
}
