"""A handwheel at the board's own pins leads Z as far as it is turned."""

import unittest

from board import Board
from plant import Plant
from prepared import prepared
from talk import START, Ear
from wire import Frame

# Inputs 5 to 8 are X, Z, x10 and x100.
# One spindle: the wire has room for setpoints of 1 ms.
PARAMS = ("9014=1", "9048=5")
MODE_WHEEL = 18
Z_NODE = 17


class OwnWheel(unittest.TestCase):
    def test_an_axis_goes_as_far_as_the_wheel_at_the_pins_is_turned(self):
        board = Board()
        ear = Ear(board)
        board.flash.second[:] = prepared(PARAMS)
        plant = Plant(board, *PARAMS)
        self.addCleanup(plant.close)
        board.contact("input 6", True)
        board.contact("input 7", True)
        board.power_up()
        board.run_ticks(60)
        board.wire.send(START)
        board.run_ticks(30)

        def z():
            """The last setpoint of the drive of Z (607Ah in its RPDO1), in steps of 0.1 um."""
            return int.from_bytes(ear.with_id(0x200 + Z_NODE)[-1].data[2:6], "little", signed=True)

        def turn(edges):
            for _ in range(abs(edges)):
                board.tim1.by(1 if edges > 0 else -1)
                board.run_ticks(2)
            board.run_ticks(400)

        turn(8)
        begin = z()
        echo = ear.with_id(0x681)[-1].data[:2]
        board.wire.send(Frame(0x201, bytes([1, MODE_WHEEL, 0, 255, 255, 255]) + echo))
        board.run_ticks(30)
        self.assertEqual(z(), begin)
        # Four edges a detent, each ten micrometres; what trembles at one is none.
        turn(40)
        self.assertEqual(z(), begin + 10 * 100)
        for edges in (1, -1, -1, 1):
            turn(edges)
        self.assertEqual(z(), begin + 10 * 100)
        turn(-80)
        self.assertEqual(z(), begin - 10 * 100)
        board.contact("input 6", False)
        board.run_ticks(20)
        turn(40)
        self.assertEqual(z(), begin - 10 * 100)
