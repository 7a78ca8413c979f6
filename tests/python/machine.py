"""A board on `vcan0`, and the commands of `leadscrew` that somebody types at it. BOARD_SIM and LEADSCREW are the programs."""

import json
import os
import subprocess
import sys
import time
import unittest

from patience import PATIENCE

BOARD_SIM = [os.environ["BOARD_SIM"], "--bus", "vcan0"]


class Machine(unittest.TestCase):
    def starts(self, board, settings, said="ready"):
        """The board has said this after it."""
        settings = [word for setting in settings for word in ("--set", setting)]
        self.board = subprocess.Popen(board + settings, stderr=subprocess.PIPE, text=True)
        self.addCleanup(self.end)
        for line in self.board.stderr:
            if said in line:
                return
        self.fail(f"the board did not say {said}")

    def end(self):
        self.board.kill()
        self.board.wait()
        # What it said explains a failure.
        print(self.board.stderr.read(), file=sys.stderr)
        self.board.stderr.close()

    def begin(self, *words):
        command = [os.environ["LEADSCREW"], *words, "--bus", "vcan0"]
        pipes = {"stdin": subprocess.DEVNULL, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
        return subprocess.Popen(command, text=True, env={**os.environ, "NO_COLOR": "1"}, **pipes)

    def ends(self, process, code=0):
        """What it prints until it ends with this code."""
        try:
            out, err = process.communicate(timeout=PATIENCE)
        except subprocess.TimeoutExpired:
            process.kill()
            self.fail(f"it does not end: {process.communicate()}")
        self.assertEqual(process.returncode, code, f"{process.args}: {out}{err}")
        return out + err

    def does(self, *words, code=0):
        return self.ends(self.begin(*words), code)

    def status(self):
        return json.loads(self.does("status", "--json"))

    def until(self, what, happened):
        deadline = time.time() + PATIENCE
        while not happened():
            self.assertLess(time.time(), deadline, what)
            time.sleep(0.02)
