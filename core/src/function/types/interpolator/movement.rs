//! Transitions of a movement: from table to table, forward and back, in and out.
//!
//! Law      starts, stops and sets are evaluated in positive direction only; in negative direction x returns to the
//!          table that it came from, and before the first table the sink rests until x is back. A step of the master
//!          may pass any number of tables
//! Source   AMK-FIPW-42 to -55 with A-23 to -29, AMK-XFIPW-40 to -60 with to -22

use super::setup::{Movement, Setup};
use super::{Interpolator, MovementState};
use crate::function::program::{CallInputs, LINES};
use serde::{Deserialize, Serialize};

impl Interpolator {
    /// Begins a movement with its first table, at the present x.
    pub(super) fn begin(&mut self) {
        (self.stage, self.table, self.passes, self.last_point) = (MovementState::Run, 0, 0, 0);
        (self.is_armed, self.is_stored) = (false, false);
        if self.setup.movement != Movement::Cyclic {
            self.sets.switch();
        }
    }

    /// Advances x while the sink rests, and begins a movement if E1 and the position allow it: at the first zero of
    /// this call, or in the window.
    pub(super) fn advance_at_rest(&mut self, way: i64, (e1, rises): (bool, bool), seen: &CallInputs<'_>) {
        let length = self.curve(seen).length();
        let next = self.x.saturating_add(way);
        self.x = next.rem_euclid(length);
        let passed = next >= length;
        self.clock_in((e1, rises), passed || self.is_in_window(way, self.setup.start_angle));
        if self.stage == MovementState::Run && self.setup.movement != Movement::Immediate {
            if passed {
                self.x = next - length;
            }
            // The set may have a table that ends before the window does.
            self.pass_ends(e1, seen);
        }
    }

    /// Begins a movement if E1 and the position of x allow it.
    pub(super) fn clock_in(&mut self, (e1, rises): (bool, bool), is_there: bool) {
        match self.setup.movement {
            Movement::Immediate if rises => {
                self.x = 0;
                self.begin();
                return;
            }
            Movement::Immediate => return,
            Movement::Cyclic => self.is_armed = true,
            Movement::Sequence => self.is_armed |= rises,
            Movement::Coupled if self.setup.by_level => self.is_armed = e1 && self.had_edge,
            Movement::Coupled => self.is_armed = e1 && (self.is_armed || rises),
        }
        if self.is_armed && is_there {
            self.begin();
        }
    }

    /// Leaves the working table for the stop tables within its window; without stop tables the pass runs to its end.
    pub(super) fn clock_out(&mut self, way: i64, e1: bool, seen: &CallInputs<'_>) {
        let Setup { movement, tables, working, stop_angle, .. } = self.setup;
        let may = self.stage == MovementState::Run && movement == Movement::Coupled && !e1;
        if may && self.table == working && working.saturating_add(1) < tables && self.is_in_window(way, stop_angle) {
            let length = self.curve(seen).length();
            self.register.end_working_table(&self.setup.marks, self.x, length);
            (self.table, self.last_point) = (working.saturating_add(1), 0);
            // Tables of the set may have different lengths.
            self.x = self.x.rem_euclid(self.curve(seen).length());
        }
    }

    /// Handles the ends of tables that x has passed: each table once, the working table any number of times.
    pub(super) fn pass_ends(&mut self, e1: bool, seen: &CallInputs<'_>) {
        while self.stage == MovementState::Run {
            let curve = self.curve(seen);
            let length = curve.length();
            if self.x < length {
                return;
            }
            let times = self.repeats(self.x / length, e1);
            self.total.pass(curve.end(), times, self.setup.scale);
            self.x -= length.saturating_mul(times);
            self.last_point = 0;
            if self.table == self.setup.working {
                self.passes = self.passes.saturating_add(times);
                // The register sees at most two passes: further ones change nothing after the second.
                (0..times.min(2)).for_each(|_| self.register.pass());
            }
            self.change_table(e1, seen);
        }
    }

    /// Returns how many of `passes` passes of the present table can be handled at once.
    fn repeats(&self, passes: i64, e1: bool) -> i64 {
        if self.table != self.setup.working || self.sets.is_due() {
            return 1;
        }
        match self.setup.movement {
            Movement::Cyclic => passes,
            Movement::Coupled => {
                if e1 {
                    passes
                } else {
                    1
                }
            }
            Movement::Immediate | Movement::Sequence => {
                passes.min(self.setup.passes.saturating_sub(self.passes)).max(1)
            }
        }
    }

    /// Changes to the table that follows the end of the present one.
    fn change_table(&mut self, e1: bool, seen: &CallInputs<'_>) {
        let Setup { movement, tables, working, passes, .. } = self.setup;
        let repeats = self.table == working
            && match movement {
                Movement::Cyclic => true,
                Movement::Coupled => e1,
                Movement::Immediate | Movement::Sequence => self.passes < passes,
            };
        if !repeats {
            let mut next = self.table.saturating_add(1);
            if next == working {
                self.passes = 0;
                if movement == Movement::Coupled && !e1 {
                    next = working.saturating_add(1);
                }
            }
            self.register.end_working_table(&self.setup.marks, 0, 1);
            if next >= tables {
                self.end(e1, seen);
                return;
            }
            self.table = next;
        }
        if repeats || self.setup.switches_everywhere {
            self.sets.switch();
        }
    }

    /// Ends a movement, or begins the next one immediately.
    fn end(&mut self, e1: bool, seen: &CallInputs<'_>) {
        let again = e1 && (self.is_stored || self.setup.by_level && self.setup.movement == Movement::Coupled);
        if again {
            self.begin();
            return;
        }
        (self.stage, self.table, self.is_armed, self.is_stored) = (MovementState::Out, 0, false, false);
        self.x = match self.setup.movement {
            Movement::Immediate => 0,
            _ => self.x.rem_euclid(self.curve(seen).length()),
        };
    }

    /// Returns to the previous tables while the master moves back.
    pub(super) fn return_to_previous(&mut self, seen: &CallInputs<'_>) {
        while self.stage == MovementState::Run && self.x < 0 {
            let is_cyclic = self.setup.movement == Movement::Cyclic;
            let working = self.setup.working;
            let before = match self.table {
                _ if is_cyclic => 0,
                table if table > working.saturating_add(1) => table - 1,
                table if table >= working && self.passes > 0 => working,
                table if table >= working && working > 0 => working - 1,
                table if table < working && table > 0 => table - 1,
                _ => return,
            };
            if before == working || self.table == working {
                self.register.return_to_previous_pass();
            }
            (self.table, self.last_point) = (before, 0);
            let curve = self.curve(seen);
            let all = self.x.saturating_neg().saturating_add(curve.length() - 1) / curve.length();
            let times = match before {
                _ if is_cyclic => all,
                table if table == working => all.min(self.passes),
                _ => 1,
            };
            if before == working && !is_cyclic {
                self.passes -= times;
            }
            self.total.pass(curve.end(), times.saturating_neg(), self.setup.scale);
            self.x = self.x.saturating_add(curve.length().saturating_mul(times));
        }
    }
}

/// The sets of tables, and the selection of the inputs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Sets {
    /// Number of sets; 0 if sets are not selected.
    count: u8,
    active: u8,
    /// Set that is selected now.
    selected: Option<u8>,
    /// Selection that was carried out.
    executed: Option<u8>,
}

impl Sets {
    /// Index of the first table of the active set.
    #[inline]
    pub(super) fn first(&self, setup: &Setup) -> usize {
        usize::from(self.active) * usize::from(setup.tables)
    }

    /// Reads the selection from the inputs.
    #[inline]
    pub(super) fn read_inputs(&mut self, setup: &Setup, seen: &CallInputs<'_>) {
        if !setup.switches_sets {
            return;
        }
        let tables = (0..LINES).take_while(|number| seen.tables.get(*number).is_some()).count();
        self.count = tables.checked_div(usize::from(setup.tables)).unwrap_or(0).min(LINES) as u8;
        let inputs = seen.inputs >> u8::from(setup.is_started_by_e1());
        // As many inputs as are needed to select one of the sets.
        let mask = match self.count {
            0 | 1 => 0,
            2 => 0b001,
            3 | 4 => 0b011,
            _ => 0b111,
        };
        self.selected = (inputs & 1 == 1).then_some(inputs >> 1 & mask);
        if self.executed != self.selected {
            self.executed = None;
        }
    }

    /// Returns true if the set changes at the next opportunity.
    #[inline]
    pub(super) fn is_due(&self) -> bool {
        self.selected.is_some_and(|set| set < self.count && set != self.active)
    }

    /// Activates the selected set.
    pub(super) fn switch(&mut self) {
        if let Some(set) = self.selected.filter(|set| *set < self.count) {
            (self.active, self.executed) = (set, Some(set));
        }
    }

    /// Returns true if the selected set is active.
    pub(super) fn is_taken(&self) -> bool {
        self.executed.is_some()
    }

    pub(super) fn is_sound(&self) -> bool {
        usize::from(self.active) < LINES
    }
}
