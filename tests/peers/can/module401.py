"""A simulated module of inputs and outputs (CiA 401) and an encoder (CiA 406).

Communication (NMT, SDO, PDOs, SYNC, heartbeat) is that of drive402.Drive, whose
objects are there as well. Inputs and the position are set, outputs are read, by
the control commands `set` and `get`. With the heartbeat of the master lost the
outputs of a module go to 0 (6206h, 6207h: defaults).
"""
from canopen.objectdictionary.datatypes import INTEGER16, UNSIGNED8, UNSIGNED32

import od402
from drive402 import Drive, k

GROUPS = [
    (0x6000, "Read input 8-bit", 8, UNSIGNED8, "ro"),
    (0x6200, "Write output 8-bit", 8, UNSIGNED8, "rww"),
    (0x6401, "Read analogue input 16-bit", 12, INTEGER16, "ro"),
    (0x6411, "Write analogue output 16-bit", 12, INTEGER16, "rww"),
]
DEVICE_TYPE = {401: 0x000F0191, 406: 0x00010196}       # in- and outputs of both kinds; single-turn


def build(node_id, profile):
    d = od402.build(node_id)
    d[0x1000].default = DEVICE_TYPE[profile]
    if profile == 406:
        d.add_object(od402._var(0x6004, 0, "Position value", UNSIGNED32, "ro", 0, 1, node_id))
        return d
    for index, name, count, dtype, access in GROUPS:
        subs = [(i, f"{name} {i}", dtype, access, 0, 1) for i in range(1, count + 1)]
        od402._group(d, index, name, "array", subs, node_id)
    return d


class Module(Drive):
    def __init__(self, node_id, sim, profile):
        self.profile = profile
        self.amplifier = None
        super().__init__(node_id, sim, build(node_id, profile))

    def turn_by(self, module, rate):
        """An amplifier turns this encoder: `rate` counts/s at full scale of the first analog output of a module,
        while its first digital one is 1."""
        self.amplifier = (module, rate, float(self.v[k(0x6004)]))

    def advance(self, dt):
        super().advance(dt)
        if self.amplifier:
            module, rate, place = self.amplifier
            if not module.dead and module.v[k(0x6200, 1)] & 1:
                place += rate * module.v[k(0x6411, 1)] / 32767 * dt
            self.amplifier = (module, rate, place)
            self.v[k(0x6004)] = int(place) & 0xFFFFFFFF

    def _connection_lost(self, code=0x8130):
        if self.profile == 401:
            for index, _, count, _, access in GROUPS:
                if access == "rww":
                    for i in range(1, count + 1):
                        self.v[k(index, i)] = 0
