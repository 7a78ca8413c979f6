"""The controller in trouble: bus-off and restricted mode, and back; a queue that calls back."""

import unittest

from board import Board
from clock import MS
from fdcan import ASM
from plant import Plant
from prepared import prepared
from talk import START, Ear, Sdo
from wire import Frame

# On its way to bus-off the controller is error passive for half a millisecond: a look that falls into that tells it first.
BUS_OFF, RESTRICTED = (4370, 4371), (4386,)
RESET = 4


def order(count, number):
    """RPDO1: an order, and nothing of switches and overrides."""
    return Frame(0x201, bytes([count, number, 0, 255, 255, 255]))


class Machine:
    """A board whose drives are up, with its node started; with these parameters, where there are any."""

    # Ticks in which its drives come up.
    COMES_UP = 30

    def __init__(self, test, *params):
        self.board = Board()
        if params:
            self.board.flash.second[:] = prepared(params)
        self.ear = Ear(self.board)
        self.plant = Plant(self.board, *params)
        test.addCleanup(self.plant.close)
        self.listen()
        self.board.power_up()
        self.board.run_ticks(60)
        self.board.wire.send(START)
        self.board.run_ticks(self.COMES_UP)

    def listen(self):
        """For who wants to hear more."""

    def state(self):
        """(state, alarm) of the newest TPDO1."""
        data = self.ear.with_id(0x181)[-1].data
        return data[0], int.from_bytes(data[2:4], "little")


IDLE, ALARM = 1, 7


class ComesBack(unittest.TestCase):
    def comes_back(self, machine, alarms, ticks=100):
        """It stands on the alarm, and a reset brings drives and machine up again, within these ticks."""
        board = machine.board
        board.run_ticks(400)
        # As after a power-up: it waits for NMT start.
        board.wire.send(START)
        board.run_ticks(30)
        state, alarm = machine.state()
        self.assertEqual(state, ALARM)
        self.assertIn(alarm, alarms)
        self.assertIn(machine.ear.alarms()[-1], alarms)
        board.wire.send(order(1, RESET))
        board.run_ticks(ticks)
        self.assertEqual(machine.state(), (IDLE, 0))
        self.assertEqual(Sdo(board, machine.ear).read(0x1000, 0), bytes(4))


class Trouble(ComesBack):
    def test_drives_come_up_and_the_machine_is_idle(self):
        machine = Machine(self)
        self.assertEqual(machine.state(), (IDLE, 0))
        self.assertEqual(machine.ear.alarms(), [])
        self.assertEqual(machine.board.shown["spindle enable"], "high")
        self.assertEqual(machine.board.shown["light"], "high")

    def test_bus_off_is_left_when_the_wire_is_good_again_and_nothing_old_is_sent(self):
        machine = Machine(self)
        board = machine.board
        board.wire.shorted = True
        board.run_ticks(20)
        self.assertTrue(board.fdcan.off)
        said = len(machine.ear.frames)
        board.run_ticks(100)
        # It stays off for as long as nobody hears anything.
        self.assertEqual(len(machine.ear.frames), said)
        good = board.clock.now
        newest = board.ticks & 0xFF
        board.wire.shorted = False
        board.run_ticks(20)
        fresh = machine.ear.frames[said:]
        self.assertTrue(fresh)
        for frame in fresh:
            self.assertGreater(frame.time, good)
        beats = [frame.data[0] for frame in fresh if frame.id == 0x080]
        # The counter of SYNC has gone on: none is of before.
        self.assertTrue(all((number - newest) % 240 < 60 for number in beats), (newest, beats))
        self.comes_back(machine, BUS_OFF)

    def test_restricted_mode_is_an_alarm_and_is_left(self):
        machine = Machine(self)
        board = machine.board
        board.fdcan.memory_fails()
        board.run_ticks(5)
        self.comes_back(machine, RESTRICTED)
        self.assertEqual(board.fdcan.word[0x18] & ASM, 0)

    def test_a_full_fifo_loses_a_frame_and_nothing_else(self):
        machine = Machine(self)
        board = machine.board
        board.wire.instant = True
        for number in range(8):
            board.wire.send(Frame(0x700 + 100, bytes([number])))
        board.wire.instant = False
        board.run_ticks(50)
        self.assertEqual(machine.state(), (IDLE, 0))

    def test_an_emergency_stop_is_an_alarm_until_a_reset(self):
        machine = Machine(self)
        board = machine.board
        board.contact("stop", False)
        board.run_ticks(30)
        self.assertEqual(machine.state(), (ALARM, 4300))
        board.contact("stop", True)
        board.run_ticks(30)
        self.assertEqual(machine.state(), (ALARM, 4300))
        board.wire.send(order(1, RESET))
        board.run_ticks(100)
        self.assertEqual(machine.state(), (IDLE, 0))
