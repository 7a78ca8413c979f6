"""Pins and emergencies of what happens to a board, as they are and have to stay: `golden/pins.txt`.

A line is a tick since the power came, and what a scope at a pin or a listener on the wire sees in it. To renew the file:
`CHIP_WRITE=1`.
"""

import os
import unittest
from pathlib import Path

from clock import MS
from test_bus import Machine

GOLDEN = Path(__file__).parent / "golden" / "pins.txt"


def story(machine, since):
    """What was seen from a tick on."""
    board = machine.board
    lines = [(tick, order, f"{name}: {level}") for order, (tick, name, level) in enumerate(board.pins)]
    lines += [(tick, -1, f"reset: {why}") for tick, why in board.starts]
    lines += [(tick, 1000 + order, f"wire: {what}") for order, (tick, what) in enumerate(machine.told)]
    return [f"{tick - since:6} {what}" for tick, _, what in sorted(lines) if tick >= since]


class Seen(Machine):
    """It also notes in which tick emergencies and boot-ups come."""

    def __init__(self, test):
        self.told = []
        super().__init__(test)

    def listen(self):
        def hear(frame, foreign):
            if foreign:
                return
            if frame.id == 0x081:
                alarm = int.from_bytes(frame.data[3:5], "little")
                said = f"EMCY {alarm}" if any(frame.data[:2]) else "EMCY: no error"
                self.told.append((self.board.ticks, said))
            elif frame.id == 0x701 and frame.data == b"\0":
                self.told.append((self.board.ticks, "boot-up"))
        self.board.wire.listeners.append(hear)


def power_up(test):
    machine = Seen(test)
    return story(machine, 0)


def stop(test):
    machine = Seen(test)
    since = machine.board.ticks
    machine.board.contact("stop", False)
    machine.board.run_ticks(100)
    machine.board.contact("stop", True)
    machine.board.run_ticks(100)
    return story(machine, since)


def panic(test):
    """The background gets to where a panic leads."""
    machine = Seen(test)
    board = machine.board
    since = board.ticks
    board.run_ticks(1)
    board.cpu.pc = board.image.find("panicked")[0]
    board.run_ticks(150)
    return story(machine, since)


def hang(test):
    """The background does not get any further: after a quarter of a second, and the watchdog's 0.1 s, it begins anew."""
    machine = Seen(test)
    board = machine.board
    since = board.ticks
    board.run_ticks(1)
    board.cpu.hang()
    board.run_until(lambda: len(board.starts) > 1)
    board.cpu.slice = 0
    board.run_ticks(100)
    return story(machine, since)


class Pins(unittest.TestCase):
    maxDiff = None

    def test_power_up_emergency_stop_panic_and_watchdog(self):
        text = ""
        for scene in (power_up, stop, panic, hang):
            text += f"{scene.__name__.replace('_', ' ')}\n" + "\n".join(scene(self)) + "\n\n"
        if os.environ.get("CHIP_WRITE"):
            GOLDEN.parent.mkdir(exist_ok=True)
            GOLDEN.write_text(text)
        self.assertEqual(text, GOLDEN.read_text())
