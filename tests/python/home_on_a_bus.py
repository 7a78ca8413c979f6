"""A board on `vcan0` that finds its reference with a drive of other making. BOARD_SIM and LEADSCREW are the programs.
`cargo xtask vcan` runs this where there is a bus."""

import os
import re
import unittest

from drive import HOMING, POSITION, HomingDrive
from homing import FAST, METHODS, SLOW, Bed, Homing, mark
from machine import BOARD_SIM, Machine

# X is the drive of other making; its mark is at this radius, and it may go 40 mm to find it. Increments of 100 nm.
MARK = 12.3456
INCREMENT = 0.0001
BOARD = [*BOARD_SIM, "--lockstep", "--drives", "Z,C", "--at", "X=60,Z=0"]
SETTINGS = ["9050.X=1", f"9058.X={MARK}", "9062.X=40", "9047=0", "9024=0"]
START = 300_000
# 12 m/min are so many increments in a tick: no axis goes faster.
FASTEST = 2_000

# The home switch of a method: to the positive end, to the negative end, or a piece of the way.
FAR = 10**9
HOME = {19: (100_000, FAR), 20: (100_000, FAR), 21: (-FAR, -100_000), 22: (-FAR, -100_000)}
PIECE = (100_000, 160_000)


# All of it, or a part that the seed chooses.
FULL = os.environ.get("LEADSCREW_FULL") == "1"
SEED = int(os.environ.get("LEADSCREW_SEED", "0"))


def sides(method):
    """Where an axis may stand before: off its switch on either side, and on it."""
    if method >= 33:
        return [1_234]
    if method in (1, 17):
        return [-260_001, -301_000]
    if method in (2, 18):
        return [259_999, 300_500]
    if method in HOME:
        return [0, 150_000, -150_000]
    return [60_000, 130_000, 200_000]


def starts(method):
    """Two of these, or one. A method with an index and its twin without one (16 more) have all of them together."""
    places = sides(method)
    first = 0 if FULL else (SEED + method) % len(places)
    # 16 more is one more, modulo 3.
    turned = [places[(first + method // 16 + more) % len(places)] for more in range(len(places))]
    return turned[: 2 if FULL else 1]


class HomeTest(Machine):
    def setUp(self):
        self.drive = HomingDrive(16, START, Homing(Bed(), 35))
        self.addCleanup(self.drive.end)
        self.starts(BOARD, SETTINGS)

    def mounts(self, method, start, past=False, **more):
        bed = Bed(home=HOME.get(method, PIECE))
        self.drive.mount(Homing(bed, method, past, **more), start)
        return mark(method, bed, start)

    def has_not_jumped(self, what):
        """Since the last mounting: into the other mode, in it, and back."""
        told, steps = list(self.drive.told), list(self.drive.steps)
        modes = [mode for mode, *_ in told]
        self.assertIn(HOMING, modes, what)
        first = next(at for at, (_, control, *_) in enumerate(told) if control & 0x10)
        back = len(modes) - 1 - modes[::-1].index(HOMING)
        # As long as it homes it is told to be where it has said it is, and so with the first command behind that.
        for mode, control, target, known in told[first : back + 2]:
            self.assertEqual(target, known, f"{what}: mode {mode}, {control:04X}h")
        # Before it homes it is told to stay.
        self.assertEqual({target for _, _, target, _ in told[:first]}, {told[0][2]}, what)
        self.assertGreater(len(told), back + 2, what)
        # In position mode no SYNC moves it farther than its axis may go, and none moves it here.
        self.assertEqual(set(steps), {0}, what)

    def is_homed(self, what, marked, told):
        """`told`: what `home` has printed."""
        drive = self.drive
        self.assertIn("referenced X Z C", told, what)
        self.assertEqual(drive.mode, POSITION, what)
        # The mark that the method names, and counted from it.
        self.assertEqual(drive.homing.mark, marked, what)
        self.assertEqual(drive.actual, drive.place - marked, what)
        # X is told as a diameter.
        found = float(re.search(r"X referenced at (\S+)", told)[1])
        expected = 2 * (MARK + drive.actual * INCREMENT)
        self.assertAlmostEqual(found, expected, delta=2 * INCREMENT, msg=what)

    def test_every_method_from_every_side(self):
        homed = 0
        for method in METHODS:
            for start in starts(method):
                past = homed % 2 == 1
                what = f"method {method} from {start}, past {past}"
                marked = self.mounts(method, start, past)
                self.is_homed(what, marked, self.does("home", "X"))
                self.assertEqual(self.drive.place != marked, past and method not in (35, 37), what)
                self.has_not_jumped(what)
                homed += 1
        # And where it is then is where it goes on from.
        at = self.drive.actual
        self.does("jog", "X-", "--by", "0.5")
        self.until("the step is made", lambda: self.drive.actual == at - 2_500)
        self.assertTrue(all(-FASTEST <= step <= 0 for step in self.drive.steps), self.drive.steps)

    def test_a_switch_that_does_not_come(self):
        self.mounts(24, 0)
        self.drive.homing.bed = Bed(home=(FAR, FAR), positive=FAR)
        told = self.does("home", "X", code=4)
        self.assertIn("4520", told)
        self.until("it is in position mode again", lambda: self.drive.mode == POSITION)
        status = self.status()
        self.assertNotIn("X", status["referenced"].split())
        self.assertIsNone(self.drive.homing.mark)
        # It was told to stop at 40 mm, and has needed no farther than its ramp and a few statuses.
        self.assertGreater(self.drive.place, 400_000)
        self.assertLess(self.drive.place, 500_000)
        self.has_not_jumped("not found")
        # With its switch there it is found.
        marked = self.mounts(24, 0)
        self.does("reset")
        self.is_homed("found", marked, self.does("home", "X"))
        self.has_not_jumped("found")

    def test_a_hold_in_the_middle(self):
        # So slow that the hold comes before the switch.
        marked = self.mounts(8, 0, speeds=(1, SLOW))
        home = self.begin("home", "X")
        self.until("it homes", lambda: self.drive.homing.speed == 1)
        self.does("hold")
        self.until("it halts", lambda: self.drive.homing.halted and self.drive.homing.speed == 0)
        self.assertIs(self.status()["hold"], True)
        place = self.drive.place
        self.assertGreater(place, 0)
        self.assertLess(place, PIECE[0])
        self.assertIsNone(home.poll())
        # More of the time that a drive has to begin is over, and it stands.
        syncs = self.drive.syncs
        self.until("time goes on", lambda: self.drive.syncs > syncs + 400)
        self.assertEqual(self.drive.place, place)
        self.drive.homing.speeds[FAST] = FAST
        self.does("resume")
        self.is_homed("held", marked, self.ends(home))
        self.has_not_jumped("held")


class BoardLooksTest(Machine):
    """The switch is an input of the drive, and the board looks for it (9050 = 2): the drive follows its targets."""

    def starts_with(self, number, start):
        self.drive = HomingDrive(16, START, Homing(Bed(home=(100_000, FAR)), 35), start)
        # It is in this mode from the beginning, and nobody tells it another.
        self.drive.mode = self.drive.wanted = POSITION
        self.addCleanup(self.drive.end)
        others = [setting for setting in SETTINGS if not setting.startswith("9050.X")]
        self.starts(BOARD, [*others, "9050.X=2", f"9051.X={number}"])

    def homes(self, edge, what):
        self.assertIn("referenced X Z C", self.does("home", "X"), what)
        self.assertEqual(self.drive.mode, POSITION, what)
        # 5 mm before the mark, by what the board says and by where the axis is: three looks at 1 µm a tick, and one more.
        x = float(self.status()["mx"]) / 2
        self.assertAlmostEqual(x, MARK - 5, delta=INCREMENT, msg=what)
        # On a busy computer a report comes some ticks after its switch, at 1 µm a tick: 10 µm. Lock-step tests have the
        # exact figure.
        off = self.drive.place - (edge - 50_000)
        self.assertLessEqual(abs(off), 100, what)
        self.assertTrue(all(abs(step) <= FASTEST for step in self.drive.steps), what)

    def test_the_board_looks_for_a_switch_at_the_drive(self):
        self.starts_with(35, 20_000)
        self.homes(100_000, "from before it")
        self.homes(100_000, "again")

    def test_a_drive_that_says_nothing_of_its_inputs(self):
        self.starts_with(34, 20_000)
        self.drive.report = lambda: None
        self.assertIn("4532", self.does("home", "X", code=4))
        self.assertEqual(set(self.drive.steps), {0})


if __name__ == "__main__":
    unittest.main()
