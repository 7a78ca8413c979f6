"""A CiA 402 drive in cyclic synchronous position that shares nothing with the board: its states are the tables of the Python
package `canopen`, its frames are packed here, and `canopen` is its NMT slave.

It is for a bus in virtual time, where the board waits for its answers."""

import struct

import canopen
from canopen.objectdictionary import UNSIGNED16, ODVariable
from canopen.profiles.p402 import State402

SYNC, NMT = 0x080, 0x000
COMMAND = struct.Struct("<Hi")
# What a status says beside its state: the voltage is on, the drive takes orders, the target is followed.
VOLTAGE, REMOTE, FOLLOWS = 0x0010, 0x0200, 0x1000


class Drive:
    """Axis drive `number`, standing at `actual` increments. It answers every `every`-th SYNC."""

    def __init__(self, number, actual, every=4):
        heartbeat = ODVariable("producer heartbeat time", 0x1017)
        heartbeat.data_type, heartbeat.value = UNSIGNED16, 0
        dictionary = canopen.ObjectDictionary()
        dictionary.add_object(heartbeat)
        self.node = canopen.LocalNode(number, dictionary)
        self.every, self.syncs = every, 0
        self.state, self.actual = "SWITCH ON DISABLED", actual
        self.command = None
        # What happened: the states it went through, and each target that it followed.
        self.states, self.targets = [self.state], []
        self.network = canopen.Network()
        number_of = self.node.id
        self.network.connect(
            interface="socketcan",
            channel="vcan0",
            can_filters=[
                {"can_id": identifier, "can_mask": 0x7FF}
                for identifier in (NMT, SYNC, 0x200 + number_of)
            ],
        )
        self.network.add_node(self.node)
        self.network.subscribe(SYNC, self.sync)
        self.network.subscribe(0x200 + number_of, self.receive)
        self.node.nmt.state = "INITIALISING"
        self.node.nmt.state = "PRE-OPERATIONAL"

    def end(self):
        self.network.disconnect()

    def receive(self, _, data, __):
        if self.node.nmt.state == "OPERATIONAL":
            self.command = COMMAND.unpack(data)

    def sync(self, *_):
        if self.node.nmt.state != "OPERATIONAL":
            return
        if self.command:
            control, target = self.command
            self.obey(control & 0x8F)
            if self.state == "OPERATION ENABLED":
                self.targets.append(target)
                self.actual = target
        self.syncs += 1
        if self.syncs % self.every == 0:
            self.network.send_message(0x180 + self.node.id, self.status())

    def obey(self, control):
        for (state, following), command in State402.TRANSITIONTABLE.items():
            if (state, command) == (self.state, control):
                self.state = following
                self.states.append(following)
                return

    def status(self):
        _, word = State402.SW_MASK[self.state]
        word |= VOLTAGE | REMOTE
        if self.state == "OPERATION ENABLED":
            word |= FOLLOWS
        return COMMAND.pack(word, self.actual)
