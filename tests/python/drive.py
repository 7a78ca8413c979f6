"""A CiA 402 drive that shares nothing with the board: its states are the tables of the Python package `canopen`, its frames
are packed here, and `canopen` is its NMT slave. It follows targets in each SYNC (mode 8, or 7 where a test
makes one of it), and may home by itself (mode 6).

It is for a bus in virtual time, where the board waits for its answers."""

import struct

import canopen
from canopen.objectdictionary import UNSIGNED16, ODVariable
from canopen.profiles.p402 import State402

SYNC, NMT = 0x080, 0x000
COMMAND = struct.Struct("<Hi")
REPORT = struct.Struct("<bI")
POSITION, HOMING = 8, 6
# SYNCs from one report of mode and inputs to the next, where nothing changes.
REPORTS = 16
# What a status says beside its state: the voltage is on, the drive takes orders, the target is followed.
VOLTAGE, REMOTE, FOLLOWS = 0x0010, 0x0200, 0x1000


class Drive:
    """Axis drive `number`, standing at `actual` increments. It answers every `every`-th SYNC."""

    def __init__(self, number, actual, every=4):
        self.node = canopen.LocalNode(number, self.dictionary(number))
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
                for identifier in (NMT, SYNC, 0x200 + number_of, 0x300 + number_of, 0x600 + number_of)
            ],
        )
        self.network.add_node(self.node)
        self.network.subscribe(SYNC, self.sync)
        self.network.subscribe(0x200 + number_of, self.receive)
        self.network.subscribe(0x300 + number_of, self.receive_mode)
        self.node.nmt.state = "INITIALISING"
        self.node.nmt.state = "PRE-OPERATIONAL"

    def dictionary(self, _):
        """What can be read and written."""
        heartbeat = ODVariable("producer heartbeat time", 0x1017)
        heartbeat.data_type, heartbeat.value = UNSIGNED16, 0
        made = canopen.ObjectDictionary()
        made.add_object(heartbeat)
        return made

    def end(self):
        self.network.disconnect()

    def receive(self, _, data, __):
        if self.node.nmt.state == "OPERATIONAL":
            self.command = COMMAND.unpack(data)

    def receive_mode(self, *_):
        """Without homing it has one mode."""

    def sync(self, *_):
        if self.node.nmt.state != "OPERATIONAL":
            return
        if self.command:
            control, target = self.command
            self.obey(control & 0x8F)
            if self.state == "OPERATION ENABLED":
                self.move(control, target)
            else:
                self.rest()
        self.syncs += 1
        self.report()
        if self.syncs % self.every == 0:
            self.network.send_message(0x180 + self.node.id, self.status())

    def move(self, _, target):
        self.targets.append(target)
        self.actual = target

    def rest(self):
        """It has no torque."""

    def report(self):
        """What it reports beside its status."""

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
            word |= self.progress()
        return COMMAND.pack(word, self.actual)

    def progress(self):
        """What the word says of what is under way."""
        return FOLLOWS


class HomingDrive(Drive):
    """One that homes: it has a way with switches on it, and counts from anywhere until it has found its mark."""

    def __init__(self, number, actual, homing, place=0, every=4):
        self.mode, self.wanted = 0, 0
        self.inputs = self.known = self.said = None
        self.mount(homing, place)
        super().__init__(number, actual, every)

    def mount(self, homing, place):
        """Another way around it, on which it stands at this place. Its count stays."""
        # Of each command: the mode in which it came, controlword, target, and 6064h as last said before it.
        self.told = []
        # How far it went at once in position mode, from where it stood.
        self.steps = []
        self.homing, self.place = homing, place

    def receive(self, identifier, data, time):
        super().receive(identifier, data, time)
        if self.command:
            self.told.append((self.mode, *self.command, self.known))

    def receive_mode(self, _, data, __):
        self.wanted = data[0]

    def sync(self, *_):
        # What the board has heard when it makes the command that follows this SYNC.
        self.known = self.said
        super().sync()

    def move(self, control, target):
        if self.mode == HOMING:
            self.place, mark = self.homing.period(self.place, control)
            if mark is not None:
                self.zero = mark
            self.actual = self.place - self.zero
        elif self.mode == POSITION:
            self.steps.append(target - self.actual)
            self.place += target - self.actual
            super().move(control, target)

    def report(self):
        if self.mode != self.wanted:
            self.mode = self.wanted
            self.zero = self.place - self.actual
            self.homing.leave()
            self.inputs = None
        inputs = self.homing.bed.inputs(self.place)
        if inputs != self.inputs or self.syncs % REPORTS == 0:
            self.inputs = inputs
            self.network.send_message(0x280 + self.node.id, REPORT.pack(self.mode, inputs))

    def rest(self):
        self.homing.leave()

    def status(self):
        self.said = self.actual
        return super().status()

    def progress(self):
        return self.homing.bits() if self.mode == HOMING else super().progress()
