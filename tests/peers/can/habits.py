"""Habits of real drives, where CiA 402 leaves room or a maker has taken it.

`habit NODE NAME` on the control socket gives a drive one of them, before anybody configures it:

  slow_words      looks at its control word in every 4th cycle alone
  late_homing     shows bits 10 and 12 of the homing before for 200 ms after bit 4 rises
  late_mode       shows a new mode of operation (6061h) after 300 ms
  ack_at_enable   shows the setpoint acknowledge (bit 12) in mode 1 from the moment it is enabled, until a setpoint is given
  fixed_pdos      keeps the COB-IDs of PDO 3 and 4 of both directions: they cannot be written
  unmapped_mode   has 6060h and 6061h in no PDO
"""
from canopen.sdo import SdoAbortedError

from drive402 import MODE, MODE_D, OE, Drive, k

AB_READ_ONLY = 0x06010002
BOTH = 0x1400                                                # bits 10 and 12


class HabitualDrive(Drive):
    def __init__(self, *args):
        self.habits = set()
        self.old_bits = self.old_for = self.mode_wait = self.cycles = 0
        super().__init__(*args)

    def take_habit(self, name):
        if name not in HABITS:
            raise ValueError(f"{name} is no habit; {', '.join(sorted(HABITS))} are")
        self.habits.add(name)
        if name == "unmapped_mode":
            self._drop_pdos()
            for key, count in ((MODE, k(0x1601)), (MODE_D, k(0x1A01))):
                self._types[key].pdo_mappable = False
                self._types[count].default = self.v[count] = 1   # the second entry was the mode
            self._load_pdos()

    def _controlword(self):
        if "slow_words" not in self.habits:
            super()._controlword()

    def _check_pdo_write(self, index, sub, val):
        if "fixed_pdos" in self.habits and index in (0x1402, 0x1403, 0x1802, 0x1803) and sub == 1:
            raise SdoAbortedError(AB_READ_ONLY)
        super()._check_pdo_write(index, sub, val)

    def advance(self, dt):
        v = self.v
        self.cycles += 1
        if "slow_words" in self.habits and self.cycles % 4 == 0:
            super()._controlword()
        asked = v[MODE]
        if "late_mode" in self.habits and asked != v[MODE_D] and self.mode_wait < 0.3:
            self.mode_wait += dt
            v[MODE] = v[MODE_D]
            super().advance(dt)
            v[MODE] = asked
        else:
            self.mode_wait = 0
            super().advance(dt)

    def _enable(self):
        super()._enable()
        self.pp_ack = "ack_at_enable" in self.habits

    def _mode_edges(self, cw, rise):
        if self.v[MODE_D] == 1 and self.pp_ack and self.pp_active is None and "ack_at_enable" in self.habits:
            if not rise & 0x10:
                return                                       # it stands until a setpoint is given
            self.pp_ack = False
        super()._mode_edges(cw, rise)

    def _start_homing(self):
        self.old_bits, self.old_for = self.homing_bits & BOTH, 0.2
        super()._start_homing()

    def _refresh(self, dt):
        self.old_for = max(0, self.old_for - dt)
        bits = self.homing_bits
        if "late_homing" in self.habits and self.old_for > 0 and self.state == OE:
            self.homing_bits = self.old_bits
        super()._refresh(dt)
        self.homing_bits = bits


HABITS = {"slow_words", "late_homing", "late_mode", "ack_at_enable", "fixed_pdos", "unmapped_mode"}
