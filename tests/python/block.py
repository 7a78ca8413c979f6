"""A block of inputs and outputs by CiA 401 that shares nothing with the board: eight of each, as it was delivered. Its NMT
slave, its heartbeats and its SDO server are those of the Python package `canopen`; its PDOs are made here."""

import threading
import time

import canopen
from canopen.objectdictionary import (
    UNSIGNED8,
    UNSIGNED16,
    UNSIGNED32,
    ODRecord,
    ODVariable,
)

NMT, BOARD = 0x000, 1
OFF, NO_REMOTE = 1 << 31, 1 << 30
INPUTS, OUTPUTS, DUMMY = 0x60000108, 0x62000108, 0x00050008
OPERATIONAL, PRE_OPERATIONAL = "OPERATIONAL", "PRE-OPERATIONAL"


def variable(name, index, sub, kind, value):
    made = ODVariable(name, index, sub)
    made.data_type, made.access_type, made.value, made.default = kind, "rw", value, value
    return made


def record(name, index, kind, *values):
    """Its count, and numbers of one kind or of one kind each."""
    kinds = kind if isinstance(kind, list) else [kind] * len(values)
    made = ODRecord(name, index)
    for sub, (value, kind) in enumerate(zip([len(values), *values], [UNSIGNED8, *kinds])):
        made.add_member(variable(f"{name} {sub}", index, sub, kind, value))
    return made


class Block:
    """The block with this node."""

    def __init__(self, number):
        self.number = number
        self.inputs = self.outputs = 0
        # All that was told by RPDO1, and the states it went through.
        self.told = []
        self.mute = False
        self.heard = self.sent = None
        self.said = None
        self.node = canopen.LocalNode(number, self.dictionary(number))
        self.network = canopen.Network()
        identifiers = (NMT, 0x200 + number, 0x600 + number, 0x700 + BOARD)
        filters = [{"can_id": identifier, "can_mask": 0x7FF} for identifier in identifiers]
        self.network.connect(interface="socketcan", channel="vcan0", can_filters=filters)
        self.network.add_node(self.node)
        self.network.subscribe(0x200 + number, self.receive)
        self.network.subscribe(0x700 + BOARD, self.hear)
        self.node.nmt.state = "INITIALISING"
        self.node.nmt.state = PRE_OPERATIONAL
        self.runs = True
        self.thread = threading.Thread(target=self.run)
        self.thread.start()

    def dictionary(self, number):
        made = canopen.ObjectDictionary()
        pdo = [UNSIGNED32, UNSIGNED8]
        timed = [*pdo, UNSIGNED16, UNSIGNED8, UNSIGNED16]
        for entry in (
            variable("device type", 0x1000, 0, UNSIGNED32, 0x00030191),
            record("store", 0x1010, UNSIGNED32, 1),
            record("consumer heartbeat time", 0x1016, UNSIGNED32, 0),
            variable("producer heartbeat time", 0x1017, 0, UNSIGNED16, 0),
            record("RPDO1", 0x1400, pdo, 0x200 + number, 255),
            record("RPDO1 mapping", 0x1600, UNSIGNED32, OUTPUTS, 0, 0, 0),
            record("TPDO1", 0x1800, timed, (0x180 + number) | NO_REMOTE, 255, 0, 0, 0),
            record("TPDO1 mapping", 0x1A00, UNSIGNED32, INPUTS, 0, 0, 0),
            record("inputs", 0x6000, UNSIGNED8, 0),
            variable("tells changes", 0x6005, 0, UNSIGNED8, 0),
            record("outputs", 0x6200, UNSIGNED8, 0),
            record("error mode", 0x6206, UNSIGNED8, 0),
            record("error value", 0x6207, UNSIGNED8, 0),
        ):
            made.add_object(entry)
        # One entry of four is in use.
        for index in (0x1600, 0x1A00):
            made[index][0].value = made[index][0].default = 1
        return made

    def end(self):
        self.runs = False
        self.thread.join()
        self.network.disconnect()

    def says(self, index, sub=None):
        at = self.node.sdo[index]
        return at.raw if sub is None else at[sub].raw

    def maps(self, index):
        return [self.says(index, sub + 1) for sub in range(self.says(index, 0))]

    def receive(self, _, data, __):
        maps = self.maps(0x1600)
        on = self.says(0x1400, 1) & ~NO_REMOTE == 0x200 + self.number
        # A PDO of another length than its mapping is not taken.
        if self.node.nmt.state != OPERATIONAL or not on or len(data) != len(maps):
            return
        assert maps in ([OUTPUTS], [OUTPUTS, DUMMY]), maps
        self.outputs = data[0]
        self.told.append(bytes(data))

    def hear(self, *_):
        self.heard = time.monotonic()

    def run(self):
        while self.runs:
            time.sleep(0.005)
            now = time.monotonic()
            watched = self.says(0x1016, 1)
            if watched >> 16 == BOARD and self.heard and now - self.heard > (watched & 0xFFFF) / 1000:
                self.heard = None
                mode = self.says(0x6206, 1)
                self.outputs = self.outputs & ~mode | self.says(0x6207, 1) & mode
                self.node.nmt.state = PRE_OPERATIONAL
            if self.node.nmt.state != OPERATIONAL:
                self.said = None
                continue
            changed = self.inputs != self.said and (self.says(0x6005) or self.said is None)
            timer = self.says(0x1800, 5)
            due = timer and self.sent and now - self.sent >= timer / 1000
            on = self.says(0x1800, 1) & OFF == 0
            if on and not self.mute and (changed or due):
                assert self.maps(0x1A00) == [INPUTS]
                self.said, self.sent = self.inputs, now
                self.network.send_message(0x180 + self.number, bytes([self.inputs]))
