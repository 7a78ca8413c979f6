"""A board on `vcan0` whose Z drive is of other making and as it was delivered: `params push` sets it up by its profile, and
then it goes along. `cargo xtask vcan` runs this where there is a bus."""

import tempfile
import unittest
from pathlib import Path

from canopen.objectdictionary import (
    INTEGER8,
    UNSIGNED8,
    UNSIGNED32,
    ODRecord,
    ODVariable,
)
from drive import Drive
from machine import BOARD_SIM, Machine

NODE = 17
BOARD = [*BOARD_SIM, "--drives", "X,C", "--at", "X=60,Z=100"]
# Real time, and figures that an interpreter on a busy computer keeps to.
SETTINGS = ["9000=4000", "9005=15", "9011=10000", "9021=150", "9024=0", "9027=0", "9047=0"]
TICK = (4, -3)
# Of an identifier: off, and no remote request.
OFF, NO_REMOTE = 1 << 31, 1 << 30
CONTROL, STATUS = 0x60400010, [0x60410010, 0x60640020]
# The object with the target, by mode.
TARGET = {7: 0x60C10120, 8: 0x607A0020}
# Bit 4 of the controlword: in mode 7 targets count.
BEGUN = 1 << 4


def variable(name, index, sub, kind, value):
    made = ODVariable(name, index, sub)
    made.data_type, made.access_type, made.value, made.default = kind, "rw", value, value
    return made


def record(name, index, values, kinds):
    made = ODRecord(name, index)
    for sub, (value, kind) in enumerate(zip(values, kinds)):
        made.add_member(variable(f"{name} {sub}", index, sub, kind, value))
    return made


class Delivered(Drive):
    """It does what its objects say, and they are not those that a board needs. It has this mode for setpoints alone."""

    def __init__(self, number, actual, mode):
        self.mode = mode
        super().__init__(number, actual)

    def dictionary(self, number):
        made = super().dictionary(number)
        for index, cob_id in ((0x1400, 0x200 + number), (0x1800, (0x180 + number) | OFF | NO_REMOTE)):
            made.add_object(record(f"communication {index:X}", index, [2, cob_id, 255], [UNSIGNED8, UNSIGNED32, UNSIGNED8]))
        for index, mapped in ((0x1600, [0x60400010]), (0x1A00, STATUS)):
            values = [len(mapped), *mapped, *[0] * (8 - len(mapped))]
            made.add_object(record(f"mapping {index:X}", index, values, [UNSIGNED8, *[UNSIGNED32] * 8]))
        made.add_object(record("store", 0x1010, [1, 1], [UNSIGNED8, UNSIGNED32]))
        made.add_object(record("period", 0x60C2, [2, 1, -3], [UNSIGNED8, UNSIGNED8, INTEGER8]))
        made.add_object(variable("mode", 0x6060, 0, INTEGER8, 1))
        return made

    def says(self, index, sub=0):
        at = self.node.sdo[index]
        return (at[sub] if index != 0x6060 else at).raw

    def maps(self, index):
        return [self.says(index, sub + 1) for sub in range(self.says(index))]

    def receive(self, identifier, data, time):
        on = self.says(0x1400, 1) & ~NO_REMOTE == 0x200 + NODE
        if on and self.maps(0x1600) == [CONTROL, TARGET[self.mode]] and self.says(0x1400, 2) <= 240:
            super().receive(identifier, data, time)

    def move(self, control, target):
        if self.mode == 8 or control & BEGUN:
            super().move(control, target)

    def sync(self, *arguments):
        on = self.says(0x1800, 1) & ~NO_REMOTE == 0x180 + NODE
        # As a drive of these: it wants all three in one period.
        fits = (self.says(0x60C2, 1), self.says(0x60C2, 2)) == TICK and self.says(0x6060) == self.mode
        self.every = self.says(0x1800, 2) if on and fits and self.maps(0x1A00) == STATUS else 10**9
        super().sync(*arguments)


class ProfileTest(Machine):
    def push(self, mode, profile, machine):
        """A drive as it was delivered, with this mode alone, goes along after a push of this file."""
        self.drive = Delivered(NODE, 1_000_000, mode)
        self.addCleanup(self.drive.end)
        # Z does not answer.
        self.starts(BOARD, SETTINGS, "alarm: ")
        self.assertIn("Z", str(self.status()["alarm"]))
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "lathe.toml"
            file.write_text(f'{machine}[drive.Z]\nprofile = "{profile}"\n')
            told = self.does("params", "push", str(file), "--dry-run")
            self.assertEqual(self.drive.says(0x6060), 1, told)
            told = self.does("params", "push", str(file))
            self.assertIn(f"{profile} (", told)
            self.assertIn("1800h:01h tpdo1_cob_id", told)
            # Bit 30 is its own: it is what it was.
            self.assertEqual(self.drive.says(0x1800, 1), 0x180 + NODE | NO_REMOTE)
            self.assertIn("nothing to change", self.does("params", "push", str(file), "--dry-run"))
        self.does("reset")
        self.until("all are up", lambda: self.status()["state"] == "idle")
        self.does("jog", "Z-", "--by", "0.5")
        self.until("the step is made", lambda: self.drive.actual == 1_000_000 - 5_000)

    def test_a_drive_as_it_was_delivered_goes_along_after_a_push(self):
        self.push(8, "maxon-epos4", "")

    def test_a_drive_that_has_mode_7_alone_goes_along_after_a_push(self):
        self.push(7, "elmo-dsp402", "9076.Z = 7\n")


if __name__ == "__main__":
    unittest.main()
