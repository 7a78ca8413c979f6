"""Agents that are killed and a broker that is restarted: nothing is lost, nothing is doubled, at the broker and on the disk."""

import os
import tempfile
import unittest

from broker import trial


class Killed(unittest.TestCase):
    def test_nothing_is_lost_and_nothing_doubled(self):
        full = bool(os.environ.get("LEADSCREW_FULL"))
        with tempfile.TemporaryDirectory(prefix="leadscrew-shop-") as folder:
            done = trial(
                folder,
                seed=os.environ.get("LEADSCREW_SEED", "1"),
                agents=4,
                machines=5,
                period=500,
                threads=20,
                states=2,
                kills=24 if full else 8,
                restarts=1,
            )
            count = done.count
            files = count.compare(folder)
        self.assertEqual(count.wrong, [])
        self.assertGreaterEqual(done.kills, 8)
        self.assertEqual(count.certificates + count.forgotten, 4 * 5 * 20)
        self.assertGreater(files, 0)


if __name__ == "__main__":
    unittest.main()
