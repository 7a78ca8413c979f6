"""`leadscrew` drives the image: the setpoints are those of the simulation, and an operator gets what he orders."""

import json
import os
import subprocess
import tempfile
import unittest
from pathlib import Path

from board import Board
from line import Line
from plant import Plant
from prepared import prepared
from talk import Ear

LEADSCREW = os.environ.get("LEADSCREW", "leadscrew")
# One spindle: with the four of the built-in set the wire is so full at 1 ms that setpoints come late.
# One spindle; integers in 0.0001 mm, as in the machine file of the examples.
PARAMS = ("9014=1", "1004.1=1")
EXAMPLES = Path(os.environ.get("CHIP_EXAMPLES", "examples"))
# The shortest; some of the others take many minutes.
ALWAYS = ("g84-left-hand.nc", "g84-floating.nc")
# The first does not run alone, for it is about a stop in a tap; the second is refused, as it is to be.
APART = ("g84-recovery.nc", "g78-as-printed.nc")


class Machine:
    """A board with its drives, and `leadscrew` on its line."""

    def __init__(self, test, *params):
        params = params or PARAMS
        self.board = Board()
        self.board.flash.second[:] = prepared(params)
        self.ear = Ear(self.board)
        self.plant = Plant(self.board, *params)
        test.addCleanup(self.plant.close)
        self.line = Line(self.board)
        test.addCleanup(self.line.close)
        self.board.power_up()
        self.board.run_ticks(60)

    def start(self, *args):
        return subprocess.Popen(
            [LEADSCREW, *args, "--bus", self.line.bus], env=os.environ | {"NO_COLOR": "1"},
            stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    def end(self, child):
        """(exit code, standard output, standard error) at the end of a program."""
        try:
            self.line.work(lambda: child.poll() is not None)
        finally:
            if child.poll() is None:
                child.kill()
        out, err = child.communicate()
        return child.returncode, out, err

    def good(self, *args):
        code, out, err = self.end(self.start(*args))
        if code:
            raise AssertionError(f"{args}: exit {code}\n{out}{err}")
        return out

    def status(self):
        return json.loads(self.good("status", "--json"))

    def wait(self, what, wanted):
        for _ in range(50):
            if wanted(self.status()):
                return
        raise AssertionError(f"{what} never comes; the last is {self.status()}")


def simulated(*args):
    """What `--bus sim` makes of it."""
    told = subprocess.run([LEADSCREW, *args, "--json"], capture_output=True, text=True, check=False)
    if told.returncode:
        raise AssertionError(told.stderr)
    return json.loads(told.stdout)


def program(test, text):
    folder = tempfile.TemporaryDirectory()
    test.addCleanup(folder.cleanup)
    path = Path(folder.name) / "program.nc"
    path.write_text(text)
    return str(path)


class Compares(unittest.TestCase):
    def same(self, path, *params):
        """A program on the image and in the simulation: the same setpoints. The machine, and how many of them were late."""
        params = params or PARAMS
        machine = Machine(self, *params)
        # The age of an edge has steps of a clock on the chip, and of a nanosecond in the simulation.
        machine.good("params", "set", "9006.0=0")
        machine.wait("the machine", lambda status: status["state"] == "idle")
        ran = json.loads(machine.good("run", path, "--json"))
        settings = [word for setting in ("9006.0=0", *params) for word in ("--set", setting)]
        there = simulated("run", path, *settings)
        for field in ("ok", "moves", "setpoint_hash", "late"):
            self.assertEqual(ran[field], there[field], f"{field} of {path}")
        return machine, ran["late"]


class Setpoints(Compares):
    def test_setpoints_are_those_of_the_simulation(self):
        names = ALWAYS
        if os.environ.get("CHIP_ALL"):
            names = sorted({path.name for path in EXAMPLES.glob("*.nc")} - set(APART))
        ticks = 0
        for name in names:
            with self.subTest(name):
                machine, _ = self.same(str(EXAMPLES / name))
                ticks += machine.board.ticks
        print(f"setpoints of {len(names)} programs as in the simulation, {ticks} ticks", flush=True)


class Operator(unittest.TestCase):
    SLOW = "O0001\nG98\nG0 X50 Z0\nG1 Z-4 F600\nG0 Z5\nM30\n"

    def test_hold_override_and_resume(self):
        machine = Machine(self)
        machine.good("override", "feed", "50")
        running = machine.start("run", program(self, self.SLOW), "--json")
        self.addCleanup(lambda: running.poll() is None and running.kill())
        # In its slow move.
        machine.line.work(lambda: machine.line.status is not None and machine.line.status[0] == 2 and machine.line.runs())
        before = machine.board.ticks
        machine.line.work(lambda: machine.board.ticks >= before + 250)
        machine.good("hold")
        machine.line.work(lambda: machine.line.status[0] == 3)
        held = machine.status()
        self.assertEqual((held["state"], held["hold"], held["override"]["feed"]), ("hold", True, 50))
        machine.good("resume")
        code, out, err = machine.end(running)
        self.assertEqual(code, 0, err)
        ran = json.loads(out)
        self.assertEqual((ran["ok"], ran["moves"]), (True, 4))
        self.assertEqual(machine.status()["mz"], 5)

    def test_a_feed_hold_button_holds(self):
        machine = Machine(self)
        running = machine.start("run", program(self, self.SLOW))
        self.addCleanup(lambda: running.poll() is None and running.kill())
        machine.line.work(lambda: machine.line.status is not None and machine.line.status[0] == 2 and machine.line.runs())
        machine.board.contact("hold", False)
        machine.line.work(lambda: machine.line.status[0] == 3)
        machine.board.contact("hold", True)
        machine.good("resume")
        code, _, err = machine.end(running)
        self.assertEqual(code, 0, err)

    def enable(self, machine, since):
        """What the pin of the spindle's enable did from a tick on: (ticks after it, level)."""
        seen = [(tick - since, level) for tick, name, level in machine.board.pins if name == "spindle enable"]
        return [change for change in seen if change[0] >= 0]

    def turning(self):
        """A machine whose spindle turns while an axis moves; the run, and the tick now."""
        machine = Machine(self)
        text = "O0001\nG98\nM3 S600\nG0 X50 Z0\nG4 P500\nG1 Z-40 F600\nM30\n"
        running = machine.start("run", program(self, text))
        self.addCleanup(lambda: running.poll() is None and running.kill())
        machine.line.work(lambda: machine.line.status is not None and machine.line.status[0] == 2 and machine.line.runs())
        begun = machine.board.ticks
        machine.line.work(lambda: machine.board.ticks >= begun + 800)
        self.assertEqual(machine.board.shown["spindle enable"], "high")
        return machine, running, machine.board.ticks

    def test_a_stop_takes_the_enable_of_a_turning_spindle_when_it_stands(self):
        machine, running, since = self.turning()
        machine.board.contact("stop", False)
        machine.line.work(lambda: machine.line.status[0] == 7)
        machine.line.work(lambda: self.enable(machine, since))
        [(fell, level)] = self.enable(machine, since)
        self.assertEqual(level, "low")
        # From 600 rpm it takes its ramp to stand.
        self.assertGreater(fell, 50)
        machine.board.contact("stop", True)
        later = machine.board.ticks
        machine.line.work(lambda: machine.board.ticks >= later + 200)
        self.assertEqual(self.enable(machine, since), [(fell, "low")], "a stop that is released gives no power back")
        code, _, _ = machine.end(running)
        self.assertNotEqual(code, 0)

    def test_a_wire_that_fails_takes_the_enable_of_a_turning_spindle(self):
        machine, running, since = self.turning()
        board = machine.board
        board.wire.shorted = True
        board.run_ticks(20)
        self.assertTrue(board.fdcan.off)
        self.assertEqual(self.enable(machine, since), [], "it turns")
        board.run_until(lambda: self.enable(machine, since))
        board.wire.shorted = False
        board.run_ticks(400)
        self.assertEqual([level for _, level in self.enable(machine, since)], ["low"], "a wire that is back gives none")
        running.kill()

    def test_a_stop_in_a_tap_is_retracted(self):
        machine = Machine(self)
        running = machine.start("run", str(EXAMPLES / "g84-tap.nc"))
        self.addCleanup(lambda: running.poll() is None and running.kill())
        # TPDO1, flag 4: locked to the spindle.
        machine.line.work(lambda: machine.line.status is not None and machine.line.status[1] & 16)
        begun = machine.board.ticks
        machine.line.work(lambda: machine.board.ticks >= begun + 400)
        machine.board.contact("stop", False)
        machine.line.work(lambda: machine.line.status[0] == 7)
        machine.board.contact("stop", True)
        code, _, _ = machine.end(running)
        self.assertNotEqual(code, 0)
        stopped = machine.status()
        self.assertEqual(stopped["state"], "alarm")
        self.assertTrue(stopped["tap"]["in_hole"])
        self.assertEqual(machine.board.shown["spindle enable"], "high", "a tap in its hole keeps its spindle")
        machine.good("reset")
        machine.wait("the machine", lambda status: status["state"] == "idle")
        machine.good("retract")
        self.assertFalse(machine.status()["tap"]["in_hole"])

    def test_parameters_are_pulled_pushed_and_kept_over_a_reset(self):
        machine = Machine(self)
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        pulled = str(Path(folder.name) / "pulled.toml")
        machine.good("params", "pull", "-o", pulled)
        self.assertEqual(machine.good("params", "diff", pulled), "no difference\n")
        machine.good("params", "set", "1420.X=11000")
        machine.wait("the machine", lambda status: status["state"] == "idle")
        machine.board.press_reset()
        machine.board.run_ticks(60)
        code, out, _ = machine.end(machine.start("params", "diff", pulled))
        self.assertEqual((code, out), (1, "1420.X  rapid_rate.X  11000 mm/min  → 12000 mm/min\n"))
