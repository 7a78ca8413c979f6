"""The power goes in the middle of what the flash does: after that the board has the old set or the new one, and no other.

A parameter is changed many times, and everything that the flash was told to do is written down. Then each of these is
cut: not begun, or left half done. In the same way the image starts from what is left, and is asked for its parameter.
"""

import os
import random
import subprocess
import unittest

from board import Board
from clock import Clock
from flash import PAGE, WORD
from talk import Ear, Sdo
from test_bus import Machine

# 1420.X: an object of its own, 32 bits.
OBJECT, AXIS = 0x2000 + 1420, 1
# 5010h:02, state of the last change: 2 is done.
STATE = 0x5010, 2
# 5043h: the number of this start.
START = 0x5043, 0
ROUNDS = 80 if os.environ.get("CHIP_ALL") else 8
CUTS = int(os.environ.get("CHIP_CUTS", 10_500 if os.environ.get("CHIP_ALL") else 100))


class Step:
    """Something that the flash was told to do; the value that was stored then, and the one on its way."""

    def __init__(self, kind, offset, data, old, new):
        self.kind, self.offset, self.data, self.old, self.new = kind, offset, data, old, new


def seed():
    """Another one for each commit; `CHIP_SEED` repeats one."""
    if "CHIP_SEED" in os.environ:
        return int(os.environ["CHIP_SEED"])
    commit = subprocess.run(["git", "rev-parse", "--short=8", "HEAD"], capture_output=True, text=True, check=True).stdout
    return int(commit, 16)


def record(test):
    """What the flash does over some changes."""
    machine = Machine(test)
    board = machine.board
    sdo = Sdo(board, machine.ear)
    # It has its start in it, which the board has counted.
    steps, first, value = [], bytes(board.flash.second), sdo.read(OBJECT, AXIS)
    size = len(value)
    number = int.from_bytes(value, "little")
    for count in range(ROUNDS):
        fresh = (number - count - 1).to_bytes(size, "little")
        board.flash.watch = lambda kind, offset, data: steps.append(Step(kind, offset, data, value, fresh))
        begun = len(steps)
        sdo.write(OBJECT, AXIS, fresh)
        for _ in range(1000):
            if sdo.number(*STATE) == 2 and board.flash.busy is None and len(steps) > begun:
                break
            board.run_ticks(5)
        else:
            raise AssertionError("a change is never done")
        # The drives are brought up again.
        board.run_ticks(60)
        if sdo.read(OBJECT, AXIS) != fresh:
            raise AssertionError("a change is not in force")
        value = fresh
    board.flash.watch = None
    return steps, first, bytes(board.flash.second)


class Rig:
    """One board that is switched on again and again."""

    def __init__(self):
        self.board = Board()
        self.ear = Ear(self.board)

    def start(self, second, torn):
        """From a flash; gives the parameter, the number of the start, and alarms."""
        board = self.board
        board.clock._queue.clear()
        board.wire.current, board.wire.waiting, board.wire.bit = None, [], board.wire.bit
        self.ear.frames.clear()
        board.flash.second[:] = second
        board.flash.torn = set(torn)
        board.power_up()
        board.run_ticks(4)
        sdo = Sdo(board, self.ear)
        return sdo.read(OBJECT, AXIS), sdo.number(*START), self.ear.alarms()


class Cuts(unittest.TestCase):
    def test_what_is_kept_is_the_old_or_the_new(self):
        steps, first, last = record(self)
        chance = random.Random(seed())
        rig = Rig()
        image, torn = bytearray(first), set()
        # Each is cut before it begins, and in its middle; of these so many are tried.
        places = [(number, half) for number in range(len(steps)) for half in (False, True)]
        variants = max(1, -(-CUTS // len(places)))
        tried = set(places) if CUTS >= len(places) else set(chance.sample(places, CUTS))
        count = 0
        for number, step in enumerate(steps):
            for half in (False, True):
                if (number, half) not in tried:
                    continue
                for _ in range(variants if half else 1):
                    left, broken = self.cut(step, half, image, torn, chance)
                    value, start, alarms = rig.start(left, broken)
                    self.assertIn(value, (step.old, step.new), f"cut {number} ({step.kind} {step.offset:#x}, half {half})")
                    # The one before was the first of this flash.
                    self.assertEqual(start, 2)
                    self.assertEqual(alarms, [], f"cut {number} ({step.kind} {step.offset:#x}, half {half})")
                    count += 1
            if step.kind == "erase":
                image[step.offset:step.offset + PAGE] = b"\xff" * PAGE
            else:
                image[step.offset:step.offset + WORD] = step.data
        # What was written down is what the flash has.
        self.assertEqual(bytes(image), last)
        print(f"the power went at {count} places in {len(steps)} changes of the flash (seed {seed()})", flush=True)

    def cut(self, step, half, image, torn, chance):
        if not half:
            return image, torn
        left, broken = bytearray(image), set(torn)
        if step.kind == "program":
            if chance.random() < 0.7:
                broken.add(step.offset)
            else:
                # Some of its bits are there, and read as they are.
                mask = chance.getrandbits(64).to_bytes(8, "little")
                left[step.offset:step.offset + WORD] = bytes(a | b for a, b in zip(step.data, mask))
                if left[step.offset:step.offset + WORD] not in (step.data, b"\xff" * 8):
                    # A correct checksum of the eight bytes by chance does not happen.
                    broken.add(step.offset)
            return left, broken
        for offset in range(step.offset, step.offset + PAGE, WORD):
            fate = chance.random()
            if fate < 0.4:
                left[offset:offset + WORD] = b"\xff" * WORD
                broken.discard(offset)
            elif fate < 0.8:
                broken.add(offset)
        return left, broken
