"""A board on `vcan0` whose block of inputs and outputs is of other making and as it was delivered: `params push` sets it up, and
then its inputs and outputs are the machine's. `cargo xtask vcan` runs this where there is a bus."""

import tempfile
import unittest
from pathlib import Path

from block import DUMMY, INPUTS, OUTPUTS, Block
from machine import BOARD_SIM, Machine
from patience import PATIENCE

NODE = 5
BOARD = [*BOARD_SIM, "--block", "elsewhere", "--at", "X=60,Z=100"]
# Real time, and figures that an interpreter on a busy computer keeps to.
SETTINGS = ["9000=4000", "9005=15", "9011=10000", "9021=150", "9024=0", "9027=0", "9047=0", "9462=2000"]
FILE = """
[io.door]
at = "401:{node}:in0"
[io.clamp]
at = "401:{node}:out3"
safe = true
[io.coolant]
at = "401:{node}:out0"
[m.60]
set = "coolant"
answer = "401:{node}:in7=1"
within = "20 s"
[m.61]
set = "clamp"
"""


class BlockTest(Machine):
    def file(self, node):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        file = Path(folder.name) / "lathe.toml"
        file.write_text(FILE.format(node=node))
        return str(file)

    def number(self):
        alarm = self.status()["alarm"]
        return alarm and alarm["no"]

    def test_a_block_as_it_was_delivered_works_after_a_push(self):
        block = Block(NODE)
        self.addCleanup(block.end)
        self.starts(BOARD, SETTINGS)
        file = self.file(NODE)
        told = self.does("params", "push", file, "--dry-run")
        self.assertIn("1017h:00h", told)
        self.assertEqual(block.says(0x1017), 0)
        self.does("params", "push", file)
        self.assertEqual((block.maps(0x1600), block.maps(0x1A00)), ([OUTPUTS, DUMMY], [INPUTS]))
        self.assertEqual((block.says(0x1016, 1), block.says(0x1017)), (1 << 16 | 2000, 100))
        self.assertEqual((block.says(0x1800, 5), block.says(0x6005), block.says(0x6207, 1)), (100, 1, 8))
        self.assertIn("nothing to change", self.does("params", "push", file))
        # Output 20 is the safe one.
        self.until("the block has its outputs", lambda: block.outputs == 8)
        block.inputs = 1
        self.does("io", "wait", "401:5:in0=1", "--timeout", str(PATIENCE))

        waits = self.begin("mdi", "M60")
        self.until("M60 switches", lambda: block.outputs == 9)
        block.inputs = 0x81
        self.ends(waits)
        self.assertEqual(set(block.told), {b"\x08\x00", b"\x09\x00"})

        block.mute = True
        self.until("its inputs are missed", lambda: self.number() == 4562)
        self.until("its outputs are safe", lambda: block.outputs == 8)
        block.mute = False
        self.does("io", "wait", "401:5:in0=1", "--timeout", str(PATIENCE))
        self.does("reset")
        self.assertIsNone(self.number())
        # The board is lost: the block has been told what to do then.
        block.outputs = 0xF7
        self.board.kill()
        self.until("the block is safe", lambda: block.outputs == 8)

    def test_another_node_than_the_blocks_is_told_and_nothing_changes(self):
        block = Block(NODE)
        self.addCleanup(block.end)
        self.starts(BOARD, SETTINGS)
        told = self.does("params", "push", self.file(6), code=3)
        self.assertIn("node 6 (9461), does not answer", told)
        # A drive answers, and is none; as a set that is refused before.
        told = self.does("params", "push", self.file(16), code=1)
        self.assertIn("4436", told)
        self.assertEqual((block.says(0x1017), block.told), (0, []))
        self.assertIn("9461 block_node = 0", self.does("params", "get", "9461"))


if __name__ == "__main__":
    unittest.main()
