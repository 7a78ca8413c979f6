"""Agents that are killed, a broker that is restarted, a network that is cut, disks that are full: nothing is lost, nothing is doubled, at the broker and on the disk."""

import os
import tempfile
import unittest

from broker import Cut, trial
from trouble import may_mount


class Killed(unittest.TestCase):
    def test_nothing_is_lost_and_nothing_doubled(self):
        full = bool(os.environ.get("LEADSCREW_FULL"))
        with tempfile.TemporaryDirectory(prefix="leadscrew-shop-") as folder:
            disks = 1 if may_mount(folder) else 0
            done = trial(
                folder,
                seed=os.environ.get("LEADSCREW_SEED", "1"),
                agents=4,
                machines=5,
                period=500,
                threads=20,
                states=10,
                kills=24 if full else 8,
                restarts=1,
                cuts=[Cut(0.2, 0.45, told=True, full=disks > 0)],
                disks=disks,
            )
            count = done.count
            files = count.compare(folder)
        self.assertEqual(count.wrong, [])
        self.assertGreaterEqual(done.kills, 8)
        self.assertEqual(count.certificates + count.forgotten, 4 * 5 * 20)
        self.assertGreater(files, 0)
        self.assertEqual(done.full, disks, "a disk was full for nobody")


if __name__ == "__main__":
    unittest.main()
