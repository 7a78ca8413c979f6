"""A power-up: what the manual demands for 170 MHz, and what is on the wire."""

import unittest

from board import Board
from clock import MS, US
from registers import ManualError
from talk import SYNC, START, Ear, Sdo

DRIVE_MISSING, STOP_OPEN = 4350, 4300


def up(timed=False):
    """`timed`: instructions take time as well."""
    board = Board()
    ear = Ear(board)
    if timed:
        board.cpu.count_time(True)
    board.power_up()
    return board, ear


class Clocks(unittest.TestCase):
    def test_the_clocks_are_started_as_the_manual_has_it(self):
        board, _ = up(timed=True)
        board.run_ticks(1)
        self.assertEqual(board.complaints, [])

    def test_the_core_has_the_voltage_of_its_speed(self):
        board, _ = up()
        board.run_ticks(1)
        self.assertTrue(board.pwr.range_1())
        self.assertTrue(board.pwr.boost(), "PWR_CR5.R1MODE is set: range 1 normal mode, 150 MHz at most")

    def test_the_processor_runs_at_170_mhz_by_way_of_half_of_it(self):
        board, _ = up()
        board.run_ticks(1)
        speeds = [mhz for _, mhz in board.rcc.path]
        self.assertEqual([speeds[0], speeds[-1]], [16, 170])
        self.assertIn(85, speeds)
        self.assertEqual(board.rcc.timer_mhz(), 170)
        self.assertEqual(board.flash.latency(), 4)

    def test_the_wire_has_a_megabit_from_the_crystal(self):
        board, _ = up()
        board.run_ticks(1)
        self.assertEqual(board.wire.bit, US)
        # 24 quanta, sampled behind 21 of them: NBTP has each less one.
        self.assertEqual(board.fdcan.word[0x1C] & 0x01FF_FF7F, 0 << 16 | 19 << 8 | 2)

    def test_the_model_notices_what_the_manual_forbids(self):
        board, _ = up()
        board.run_ticks(1)
        board.complaints.clear()
        board.store(0x4002_2000, 4, 0x0004_0603)
        self.assertRegex(board.complaints[-1], "170 MHz with 3 wait states, [0-9]+ are needed")
        with self.assertRaisesRegex(ManualError, "locked"):
            board.store(0x4002_2014, 4, 1)
        with self.assertRaisesRegex(ManualError, "protected"):
            board.store(0x4000_641C, 4, 0)
        with self.assertRaisesRegex(ManualError, "there is nothing"):
            board.load(0x4000_5C00, 4)

    def test_without_a_crystal_nothing_is_on_the_wire(self):
        board = Board()
        ear = Ear(board)
        board.rcc.crystal = False
        # Nothing sleeps there: time goes by with the instructions.
        board.cpu.slice = 20_000
        board.power_up()
        board.run_for(1000 * MS)
        self.assertEqual(ear.frames, [])
        light = [level for _, name, level in board.pins if name == "light"]
        self.assertGreaterEqual(light.count("high"), 2, light)
        for name in ("clamp", "spindle enable"):
            self.assertNotIn("high", [level for _, one, level in board.pins if one == name])


class Wire(unittest.TestCase):
    def test_it_joins_and_gives_the_beat(self):
        board, ear = up()
        board.run_ticks(30)
        self.assertEqual((ear.frames[0].id, ear.frames[0].data), (0x701, b"\0"))
        beats = ear.with_id(SYNC)
        # The handler of the last tick has begun, and its SYNC may be on the wire still.
        self.assertIn(len(beats), (29, 30))
        self.assertEqual([frame.data[0] for frame in beats], list(range(1, len(beats) + 1)))
        steps = {later.time - sooner.time for sooner, later in zip(beats, beats[1:])}
        # The same way through the handler each time: a few accesses more or less.
        self.assertLess(max(abs(step - 1000 * US) for step in steps), US)

    def test_with_the_stop_circuit_closed_it_misses_its_drives_and_nothing_else(self):
        board, ear = up()
        board.run_for(1500 * MS)
        self.assertEqual(ear.alarms(), [DRIVE_MISSING])

    def test_with_the_stop_circuit_open_it_says_so(self):
        board, ear = up()
        board.contact("stop", False)
        board.run_for(100 * MS)
        self.assertEqual(ear.alarms(), [STOP_OPEN])

    def test_process_data_come_where_the_node_is_started(self):
        board, ear = up()
        board.run_ticks(20)
        self.assertEqual(ear.with_id(0x181), [])
        board.wire.send(START)
        board.run_ticks(45)
        for identifier, length in ((0x181, 8), (0x281, 8), (0x381, 8)):
            frames = ear.with_id(identifier)
            self.assertIn(len(frames), (4, 5), f"{identifier:X}")
            self.assertEqual({len(frame.data) for frame in frames}, {length}, f"{identifier:X}")

    def test_objects_are_read_and_a_wrong_one_is_refused(self):
        board, ear = up()
        board.run_ticks(5)
        sdo = Sdo(board, ear)
        self.assertEqual(sdo.read(0x1000, 0), bytes(4))
        self.assertEqual(sdo.read(0x1008, 0)[:9], b"Leadscrew")
        # Identity object: made of the chip's own number, and not 0.
        self.assertNotEqual(sdo.number(0x1018, 4), 0)
        with self.assertRaisesRegex(AssertionError, "06020000h"):
            sdo.read(0x1FFF, 0)


if __name__ == "__main__":
    unittest.main()
