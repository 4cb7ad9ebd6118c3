#!/usr/bin/env python3
"""A CANopen device on durand, whose SDO server and LSS slave share nothing with python-canopen.

  durand_node.py --bus slcan-tcp:127.0.0.1:0 --nodes 1 --exit-with-parent

Objects: 1000h to 1018h as durand has them, 2001h a text that can be written. LSS: a node
id can be given and stored (255: it has none yet), no other bit rate.
Prints one JSON line when ready.
"""
import argparse
import ctypes
import json
import signal

import can
from durand import Node, Record, Variable
from durand.datatypes import DatatypeEnum as DT
from durand.network import NetworkABC
from durand.node import MinimalNodeCapabilities
from durand.scheduler import VirtualScheduler, set_scheduler

from slcan_adapter import SlcanAdapterBus


class Network(NetworkABC):
    def __init__(self, bus):
        self.bus, self.subscriptions = bus, {}

    def add_subscription(self, cob_id, callback):
        self.subscriptions[cob_id] = callback

    def remove_subscription(self, cob_id):
        self.subscriptions.pop(cob_id)

    def send(self, cob_id, msg):
        self.bus.send(can.Message(arbitration_id=cob_id, data=msg, is_extended_id=False))

    def run(self):
        while True:
            msg = self.bus.recv(1.0)
            callback = self.subscriptions.get(msg.arbitration_id) if msg else None
            if callback:
                callback(msg.arbitration_id, bytes(msg.data))


def main():
    ap = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    ap.add_argument("--bus", required=True, help="slcan-tcp:HOST:PORT")
    ap.add_argument("--nodes", required=True, help="its node id; 255: none yet")
    ap.add_argument("--exit-with-parent", action="store_true", help="end when the starting process ends")
    a = ap.parse_args()
    if a.exit_with_parent:
        ctypes.CDLL(None).prctl(1, signal.SIGTERM)           # PR_SET_PDEATHSIG
    set_scheduler(VirtualScheduler())                        # nobody waits for a heartbeat
    bus = SlcanAdapterBus("tcp:" + a.bus.removeprefix("slcan-tcp:"))
    network = Network(bus)
    node = Node(network, int(a.nodes, 0), capabilities=MinimalNodeCapabilities)
    od = node.object_dictionary
    od[0x1008] = Variable(DT.VISIBLE_STRING, "ro", b"durand device", name="Manufacturer device name")
    identity = Record(name="Identity object")
    for sub, value in enumerate((0xFFFF, 0x40200001, 0x10001, 0x8000000B), 1):
        identity[sub] = Variable(DT.UNSIGNED32, "ro", value, name=f"Identity {sub}")
    od[0x1018] = identity
    node.lss.set_store_configuration_callback(lambda bit_rate, node_id: None)
    od[0x2001] = Variable(DT.VISIBLE_STRING, "rw", b"", name="Echo")
    print(json.dumps({"ready": True, "bus": bus.path, "nodes": [node.node_id]}), flush=True)
    network.run()


if __name__ == "__main__":
    main()
