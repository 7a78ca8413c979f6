"""What is wrong with a drive of other making on `vcan0`, as `leadscrew doctor` names it. `cargo xtask vcan` runs this where
there is a bus."""

import json
import tempfile
import unittest
from pathlib import Path

from machine import Machine
from profile_on_a_bus import BOARD, NODE, OFF, Delivered

# In virtual time no setpoint is late, however busy the computer is.
SETTINGS = ["9011=10000", "9024=0", "9047=0"]

# Of a sign that lasts, more than the second after which it counts.
SECONDS = "4"


class DoctorTest(Machine):
    def setUp(self):
        self.drive = Delivered(NODE, 1_000_000, 8)
        self.addCleanup(self.drive.end)
        self.drive.node.sdo[0x1017].raw = 100
        self.starts([*BOARD, "--lockstep"], SETTINGS, "alarm: ")
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "lathe.toml"
            file.write_text('[drive.Z]\nprofile = "maxon-epos4"\n')
            self.does("params", "push", str(file))
        self.comes_up()

    def comes_up(self):
        self.does("reset")
        self.until("all are up", lambda: self.status()["state"] == "idle")

    def finds(self, code):
        told = self.does("doctor", "--json", "--seconds", SECONDS, code=code)
        return json.loads(told.splitlines()[0])

    def sets(self, index, sub, value):
        """The drive's own value, as if it had been set up so; what it was."""
        at = self.drive.node.sdo[index][sub]
        was, at.raw = at.raw, value
        return was

    def test_a_drive_that_goes_along_has_nothing(self):
        told = self.finds(0)
        self.assertEqual(told["findings"], [])
        self.assertGreater(told["frames"], 100)

    def test_a_wrong_setting_of_a_drive_is_the_first_cause(self):
        for rule, index, sub, value in (
            (29, 0x1800, 1, 0x180 + NODE | OFF),
            (25, 0x1A00, 0, 1),
            (26, 0x1400, 2, 255),
        ):
            was = self.sets(index, sub, value)
            told = self.finds(1)
            self.assertEqual((told.get("first_cause"), told["findings"][0]["node"]), (rule, NODE), told)
            self.sets(index, sub, was)
            self.comes_up()

    def test_a_fault_of_a_drive_is_told_with_its_code(self):
        self.drive.state = "FAULT"
        self.drive.node.emcy.send(0x7320)
        told = self.finds(1)
        self.assertEqual((told.get("first_cause"), told["findings"][0]["node"]), (51, NODE), told)

    def test_a_drive_that_has_gone_is_told_as_that(self):
        self.drive.end()
        told = self.finds(1)
        self.assertEqual((told.get("first_cause"), told["findings"][0]["node"]), (7, NODE), told)


if __name__ == "__main__":
    unittest.main()
