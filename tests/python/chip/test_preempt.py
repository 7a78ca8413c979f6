"""The tick comes at a chosen instruction: of the interrupt that fills the controller, and of the background that sends.

Whatever it interrupts, each of the tick's setpoints goes once, after its own SYNC, and no answer to anybody is lost.
"""

import os
import random
import unittest

from board import Board
from cpu import FLASH
from plant import Plant
from prepared import prepared
from talk import SYNC, START, Ear
from wire import Frame
from test_cuts import seed

ALL = bool(os.environ.get("CHIP_ALL"))
CAN = 16 + 21
# 9000: a period that leaves room on the wire for everything; 9014: one spindle.
PARAMS = ("9000=2000", "9014=1")
SETPOINTS = {0x210, 0x211, 0x212, 0x220}


class Preempter:
    """Counts the instructions of a context from a moment on, and lets TIM6 overflow before one of them."""

    def __init__(self, board):
        self.board = board
        self.wanted = self.context = None
        self.count = 0
        # Addresses within the IT block that runs: its end is as good, and Unicorn cannot go on in the middle of one.
        self.block = range(0)
        self.done = False
        cpu = board.cpu
        cpu.each(self.instruction)

    def arm(self, context, wanted):
        self.context, self.wanted, self.count, self.done = context, wanted, 0, False
        self.block = range(0)
        self.board.cpu.watched = True

    def end_of_block(self, address):
        """Where the block ends that begins with the IT at `address` (ARMv7-M, A7.7 "IT"). Unicorn does not show the
        instructions that the condition skips, so they cannot be counted as they come."""
        image = self.board.image.code
        mask = image[address - FLASH] & 15
        end = address + 2
        for _ in range(5 - (mask & -mask).bit_length()):
            # A5.1 "Thumb instruction set encoding": these five bits begin an instruction of two halves.
            end += 4 if image[end - FLASH + 1] >> 3 in (0b11101, 0b11110, 0b11111) else 2
        return end

    def instruction(self, address, half):
        inside = address in self.block
        if not inside and half & 0xFF00 == 0xBF00 and half & 15:
            self.block = range(address + 2, self.end_of_block(address))
        if self.board.cpu.number() != self.context:
            return False
        self.count += 1
        if inside or self.count < self.wanted:
            return False
        self.wanted = None
        self.done = True
        self.board.cpu.watched = False
        clock, event = self.board.clock, self.board.tim6.event
        clock.until(event[0])
        return True


class Preempted(unittest.TestCase):
    def setUp(self):
        self.board = board = Board()
        board.flash.second[:] = prepared(PARAMS)
        self.ear = Ear(board)
        self.plant = Plant(board, *PARAMS)
        self.addCleanup(self.plant.close)
        board.power_up()
        board.run_ticks(60)
        board.wire.send(START)
        board.run_ticks(20)
        self.assertEqual(self.ear.with_id(0x181)[-1].data[0], 1, "idle")
        self.preempter = Preempter(board)

    def periods(self):
        """What the board has sent in each whole period, SYNC first."""
        periods = []
        for frame in self.ear.frames:
            if frame.id == SYNC:
                periods.append([])
            if periods:
                periods[-1].append(frame.id)
        return periods[:-1]

    def trial(self, context, wanted, ask=False):
        """False where there is no such instruction any more."""
        board, ear = self.board, self.ear
        ear.frames.clear()
        board.run_ticks(2)
        self.preempter.arm(context, wanted)
        if ask:
            board.wire.send(Frame(0x601, bytes([0x40, 0x18, 0x10, 4, 0, 0, 0, 0])))
        board.run_ticks(4)
        board.cpu.watched = False
        came = [period for period in self.periods()[1:]]
        for number, period in enumerate(came[:-1]):
            told = [identifier for identifier in period if identifier in SETPOINTS]
            # The period that is cut short: what it had no time for is called back, and is not sent any more.
            cut = self.preempter.done and len(told) < len(SETPOINTS)
            if cut:
                self.cut += 1
                self.assertLessEqual(len(set(told)), len(SETPOINTS))
            self.assertEqual(len(told), len(set(told)), f"twice in period {number}, instruction {wanted}: {came}")
            if not cut:
                self.assertEqual(set(told), SETPOINTS, f"period {number}, instruction {wanted}: {came}")
        short = sum(len([one for one in period if one in SETPOINTS]) < len(SETPOINTS) for period in came[:-1])
        self.assertLessEqual(short, 1, f"instruction {wanted}: the tick that interrupts loses its setpoints: {came}")
        beats = [frame.data[0] for frame in ear.frames if frame.id == SYNC]
        self.assertTrue(all((b - a) % 240 == 1 for a, b in zip(beats, beats[1:])), beats)
        if ask:
            self.assertEqual(len(ear.with_id(0x581)), 1, f"instruction {wanted}: an answer is lost")
        return self.preempter.done

    def through(self, context, stride, ask):
        self.cut = 0
        wanted, tried = 1 + random.Random(seed()).randrange(stride), 0
        while self.trial(context, wanted, ask):
            wanted += stride
            tried += 1
            if wanted > 200_000:
                self.fail("it has no end")
        self.assertGreater(tried, 50)
        return tried

    def test_at_each_instruction_of_the_interrupt_that_fills_the_controller(self):
        tried = self.through(CAN, 1 if ALL else 48, ask=False)
        print(f"the tick came at {tried} instructions of the interrupt of the controller", flush=True)

    def test_at_instructions_of_the_background_that_answers(self):
        tried = self.through(0, 1 if ALL else 900, ask=True)
        print(f"the tick came at {tried} instructions of the background", flush=True)
