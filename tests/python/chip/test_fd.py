"""CAN FD: the rates of the controller, the setpoints of all drives in one frame, and what others send."""

import unittest

import test_bus
import test_line
from board import Board
from clock import US
from prepared import prepared
from talk import SYNC, Ear, Refused, Sdo
from wire import Frame

TOGETHER, FOREIGN_SETPOINTS, UNUSABLE = 0x481, 4374, 4301
FD = "9031=1"
CRYSTAL, PLL = 0, 1


def clock(board):
    """RCC_CCIPR.FDCANSEL."""
    return board.rcc.word[0x88] >> 24 & 3


class Machine(test_bus.Machine):
    """The same with drives that are enabled one after the other."""

    COMES_UP = 500


class Rates(unittest.TestCase):
    def test_a_rate_has_its_clock_and_is_on_the_wire(self):
        for kbit, source in ((4000, CRYSTAL), (5000, PLL)):
            with self.subTest(kbit):
                machine = Machine(self, f"9032={kbit}", FD)
                board = machine.board
                self.assertEqual(machine.state(), (test_bus.IDLE, 0))
                self.assertEqual(clock(board), source)
                self.assertAlmostEqual(board.wire.bit, US, delta=1)
                self.assertAlmostEqual(board.wire.data_bit, 1000 * US / kbit, delta=1)
                self.assertEqual(board.complaints, [])

    def test_a_rate_that_no_clock_gives_is_refused(self):
        machine = test_bus.Machine(self)
        sdo = Sdo(machine.board, machine.ear)
        sdo.write(0x2000 + 9032, 0, (8000).to_bytes(2, "little"))
        machine.board.run_ticks(60)
        with self.assertRaisesRegex(Refused, "06040043h"):
            sdo.write(0x2000 + 9031, 0, bytes([1]))
        self.assertEqual(sdo.number(0x5010, 7), 4388)
        self.assertEqual(sdo.number(0x2000 + 9031, 0), 0)

    def test_rates_that_do_not_go_together_are_an_alarm_at_the_next_start(self):
        board = Board()
        # Taken while the bus has a megabit.
        board.flash.second[:] = prepared((FD, "9020=800"))
        ear = Ear(board)
        board.power_up()
        board.run_ticks(60)
        self.assertAlmostEqual(board.wire.bit, 1.25 * US, delta=1)
        self.assertEqual(ear.alarms(), [UNUSABLE])

    def test_another_rate_comes_into_force_with_its_set(self):
        machine = test_bus.Machine(self)
        board = machine.board
        sdo = Sdo(board, machine.ear)
        # Without a frame of CAN FD to send, the controller stays with the crystal.
        self.assertEqual(clock(board), CRYSTAL)
        for number, value, source in ((9031, bytes([1]), PLL), (9032, (2000).to_bytes(2, "little"), CRYSTAL)):
            sdo.write(0x2000 + number, 0, value)
            board.run_ticks(60)
            self.assertEqual(clock(board), source)
        self.assertAlmostEqual(board.wire.data_bit, US / 2, delta=1)
        board.run_ticks(20)
        self.assertTrue(machine.ear.with_id(TOGETHER))
        # The bus goes on as before.
        self.assertEqual(sdo.number(0x2000 + 9032, 0), 2000)


class Setpoints(test_bus.ComesBack):
    def test_each_period_has_one_frame_for_all_drives(self):
        machine = Machine(self, FD)
        board, ear = machine.board, machine.ear
        ear.frames.clear()
        board.run_ticks(100)
        beats, frames = ear.with_id(SYNC), ear.with_id(TOGETHER)
        self.assertIn(len(frames) - len(beats), (-1, 0))
        # X, Z, C and four spindles: 42 bytes, filled up.
        self.assertEqual({(frame.fd, len(frame.data)) for frame in frames}, {(True, 48)})
        late = [frame.time - beat.time for beat, frame in zip(beats, frames)]
        self.assertLess(max(late), 900 * US)
        # No drive has one of its own.
        self.assertEqual([frame for frame in ear.frames if 0x201 < frame.id < 0x220], [])

    def test_setpoints_of_somebody_else_are_an_alarm(self):
        for params in ((FD,), ()):
            with self.subTest(params):
                machine = Machine(self, *params)
                board = machine.board
                board.wire.data_bit = board.wire.data_bit or US
                # A frame of CAN FD that is nobody's setpoints is none of the board's business.
                board.wire.send(Frame(0x491, bytes(24), fd=True))
                board.run_ticks(30)
                self.assertEqual(machine.state(), (test_bus.IDLE, 0))
                # Of X: RPDO1 of its node.
                board.wire.send(Frame(TOGETHER if params else 0x210, bytes(24), fd=True))
                board.run_ticks(30)
                self.assertEqual(machine.state(), (test_bus.ALARM, FOREIGN_SETPOINTS))

    def test_bus_off_is_left_and_the_frames_come_again(self):
        machine = Machine(self, FD)
        board = machine.board
        board.wire.shorted = True
        board.run_ticks(20)
        self.assertTrue(board.fdcan.off)
        board.wire.shorted = False
        self.comes_back(machine, test_bus.BUS_OFF, Machine.COMES_UP)
        machine.ear.frames.clear()
        board.run_ticks(10)
        self.assertGreaterEqual(len(machine.ear.with_id(TOGETHER)), 8)


class Programs(test_line.Compares):
    def test_at_2_khz_with_four_drives_none_is_late_and_sync_comes_on_time(self):
        # One spindle, and a status of each drive in every eighth period.
        params = ("9014=1", "9021=8", FD, "9000=500")
        text = "O0001\nG98\nM3 S600\nG0 X50 Z2\nG1 Z-1 F600\nG0 Z5\nM30\n"
        machine, late = self.same(test_line.program(self, text), *params)
        self.assertEqual(late, 0)
        board = machine.board
        machine.ear.frames.clear()
        board.run_ticks(2000)
        beats = machine.ear.with_id(SYNC)
        self.assertGreater(len(beats), 1990)
        steps = {later.time - sooner.time for sooner, later in zip(beats, beats[1:])}
        # Nothing is on the wire as SYNC is due: the same way through the handler each time.
        self.assertLess(max(abs(step - 500 * US) for step in steps), US)
