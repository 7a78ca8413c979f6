"""A board on `vcan0` against the Python packages `canopen` and `python-can`: its services, its process data by its own data
sheet (CANOPEN_EDS), and with a drive of other making. BOARD_SIM is the board's program. `cargo xtask vcan` runs this where
there is a bus."""

import os
import subprocess
import sys
import tempfile
import time
import unittest

import canopen

from drive import Drive
from patience import PATIENCE

# A tick and statuses that a slow kernel keeps up with; late setpoints are only counted.
BOARD = [os.environ["BOARD_SIM"], "--bus", "vcan0", "--set", "9000=5000", "--set", "9022=50", "--set", "9027=0"]
# What the board says as a node. Python does not keep up with all that is on the bus: answers were lost with the rest.
OF_THE_BOARD = [{"can_id": 0x001, "can_mask": 0x07F}]
IMAGE = 0x5010
TIMED_OUT = 0x0504_0000
FAULT = "X=fault:7305@600"


# Three holes, and time to look at them.
HOLES = """G98
G0 X0 Z5
M29 S600
G84 Z-8 R-3 F600 K3
G80
G4 P8000
M30
"""


class Reader:
    """Numbers as postcard writes them, one after the other."""

    def __init__(self, data):
        self.data = bytes(data)

    def take(self, count):
        taken, self.data = self.data[:count], self.data[count:]
        return taken

    def number(self):
        value = shift = 0
        while True:
            byte = self.take(1)[0]
            value |= (byte & 0x7F) << shift
            if byte < 0x80:
                return value
            shift += 7

    def signed(self):
        value = self.number()
        return (value >> 1) ^ -(value & 1)

    def certificates(self):
        """That of the run: ticks measured, largest error, sum of squares. And of each thread: number, line, kind, state,
        passes, late, and the same; what it says of the cut is left out."""
        self.number()
        self.take(4)
        self.number()
        self.number()
        if self.take(1) == b"\1":
            self.number()
        run = (self.number(), self.signed(), self.number())
        self.number()
        threads = []
        while self.data:
            of = (self.number(), self.number(), *self.take(2), self.number(), self.number())
            threads.append((of, (self.number(), self.signed(), self.number())))
            # Of the cut: positions, passes, axis, and nine numbers.
            self.number()
            self.take(2)
            for _ in range(9):
                self.number()
        return run, threads


class OnABus(unittest.TestCase):
    def start(self, *more):
        self.start_until("ready", *more)

    def start_until(self, word, *more):
        self.board = subprocess.Popen(BOARD + list(more), stderr=subprocess.PIPE, text=True)
        self.addCleanup(self.end)
        for line in self.board.stderr:
            if word in line:
                return
        self.fail("the board did not come up")

    def end(self):
        self.board.kill()
        self.board.wait()
        # What it said explains a failure.
        print(self.board.stderr.read(), file=sys.stderr)
        self.board.stderr.close()

    def setUp(self):
        self.network = canopen.Network()
        self.network.connect(interface="socketcan", channel="vcan0", can_filters=OF_THE_BOARD)
        self.addCleanup(self.network.disconnect)
        self.node = canopen.RemoteNode(1, os.environ["CANOPEN_EDS"])
        self.network.add_node(self.node)
        self.node.sdo.RESPONSE_TIMEOUT = 20.0

    def until(self, happened):
        deadline = time.time() + PATIENCE
        while not happened():
            self.assertLess(time.time(), deadline, "it did not happen")
            time.sleep(0.02)

    def in_time(self, transfer):
        """Again where this side stood still for so long that the board gave the transfer up."""
        for _ in range(5):
            try:
                return transfer()
            except canopen.SdoAbortedError as error:
                self.assertEqual(error.code, TIMED_OUT)
        self.fail("never in time")

    def refused(self, code, action):
        with self.assertRaises(canopen.SdoAbortedError) as caught:
            action()
        self.assertEqual(f"{caught.exception.code:08X}", f"{code:08X}")


class BoardTest(OnABus):
    def test_network_management_and_transfers(self):
        heard = []
        self.network.subscribe(0x701, lambda _, data, __: heard.append(bytes(data)))
        self.start()
        self.until(lambda: b"\0" in heard and b"\x7f" in heard)
        self.node.nmt.state = "OPERATIONAL"
        self.until(lambda: self.node.nmt.wait_for_heartbeat(PATIENCE) == "OPERATIONAL")

        sdo = self.node.sdo
        # Expedited and segmented.
        self.assertEqual(sdo[0x1018][2].raw, 0x4C53_4357)
        self.assertTrue(sdo.upload(0x1008, 0).startswith(b"Leadscrew"))
        # A parameter: No. 19, run-out of threads.
        before = sdo[0x2000 + 19].raw
        sdo[0x2000 + 19].raw = before + 1
        self.until(lambda: sdo[0x2000 + 19].raw == before + 1)

        # The parameter set, by blocks with CRC and by segments: the same bytes.
        def by_blocks():
            with sdo.open(IMAGE, 1, "rb", block_transfer=True) as stream:
                return stream.read()

        image = self.in_time(by_blocks)
        self.assertGreater(len(image), 200)
        self.assertEqual(image, self.in_time(lambda: sdo.upload(IMAGE, 1)))

        # Abort codes of wrong requests.
        self.refused(0x0602_0000, lambda: sdo.upload(0x2FFF, 0))
        self.refused(0x0609_0011, lambda: sdo.upload(0x1018, 9))
        self.refused(0x0601_0002, lambda: sdo.download(0x1000, 0, b"\0\0\0\0"))
        self.refused(0x0601_0001, lambda: sdo.upload(0x5020, 1))
        top = self.node.object_dictionary[0x2000 + 19].max
        self.refused(0x0609_0031, lambda: setattr(sdo[0x2000 + 19], "raw", top + 1))

        # Process data, decoded with the sheet.
        self.node.tpdo.read()
        for number in (1, 2, 3):
            self.assertIsNotNone(self.node.tpdo[number].wait_for_reception(PATIENCE), number)
        self.until(lambda: self.node.tpdo[1]["Status.state"].raw == 1)
        self.assertEqual(self.node.tpdo[1]["Status.alarm"].raw, 0)
        self.assertEqual(self.node.tpdo[2]["Status.line"].raw, 0)
        self.assertEqual(self.node.tpdo[3]["Status.spindle speed"].raw, 0)

        # Listened for from before the command on: the answer may come before anybody could begin to wait for it.
        states = []
        self.node.nmt.add_heartbeat_callback(states.append)
        self.node.nmt.state = "RESET COMMUNICATION"
        self.until(lambda: 0 in states)

    def test_certificates_of_threads(self):
        with tempfile.NamedTemporaryFile("w", suffix=".nc") as program:
            program.write(HOLES)
            program.flush()
            self.start("--program", program.name)
            certificates = lambda: self.node.sdo.upload(0x5041, 0)
            read = lambda: Reader(self.in_time(certificates)).certificates()
            done = lambda: [of[3] for of, _ in read()[1]] == [1, 1, 1]
            self.until(done)
            run, threads = read()
        # The newest first: rigid taps of line 4, finished.
        self.assertEqual([of[:5] for of, _ in threads], [(n, 4, 1, 1, 1) for n in (3, 2, 1)])
        measured, largest, squares = zip(*[tally for _, tally in threads])
        self.assertEqual((sum(measured), max(largest), sum(squares)), run)
        self.assertGreater(min(measured), 100)

    def test_emergency_of_an_alarm(self):
        self.start("--trouble", FAULT)
        self.until(lambda: self.node.emcy.log)
        error = self.node.emcy.log[0]
        self.assertEqual((error.code, error.register), (0xFF00, 0x81))
        number = int.from_bytes(error.data[:2], "little")
        self.assertTrue(4000 <= number < 5000, number)
        self.assertEqual(self.node.sdo.upload(0x1001, 0), b"\x81")


class DriveTest(unittest.TestCase):
    def test_a_drive_of_other_making_is_brought_up_and_moved(self):
        # Where the machine powers up, and where the program ends: X 60 and 20 mm of diameter, in increments of 100 nm.
        start, end = 300_000, 100_000
        drive = Drive(16, start)
        self.addCleanup(drive.end)
        with tempfile.NamedTemporaryFile("w", suffix=".nc") as program:
            program.write("G98\nG00 X50 Z-2\nG01 X20 Z-12 F3000\nM30\n")
            program.flush()
            board = [os.environ["BOARD_SIM"], "--bus", "vcan0", "--lockstep", "--drives", "Z,C"]
            machine = ["--at", "X=60,Z=0", "--program", program.name]
            ran = subprocess.run(board + machine, stderr=subprocess.PIPE, text=True, timeout=4 * PATIENCE)
        self.assertEqual(ran.returncode, 0, ran.stderr)
        # Through every state, and no way back.
        path = ["SWITCH ON DISABLED", "READY TO SWITCH ON", "SWITCHED ON", "OPERATION ENABLED"]
        self.assertEqual(drive.states[:4], path)
        # It was told first where it stood, and then to go nowhere by a jump.
        self.assertEqual(drive.targets[0], start)
        steps = [b - a for a, b in zip(drive.targets, drive.targets[1:])]
        # 12 m/min are 2000 increments in a tick.
        self.assertLessEqual(max(map(abs, steps)), 2_000)
        self.assertGreater(max(map(abs, steps)), 100)
        self.assertEqual(drive.actual, end)


if __name__ == "__main__":
    unittest.main()
