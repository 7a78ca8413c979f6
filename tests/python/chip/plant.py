"""The machine around the board: the simulated drives, spindle and encoder of the project, in a process of their own."""

import os
import struct
import subprocess

from talk import SYNC
from wire import Frame

DRIVE = "drive"


class Plant:
    """Its drives are on the wire, its encoder is at TIM2; a period of it is one of TIM6."""

    def __init__(self, board, *params):
        self.board = board
        self.process = subprocess.Popen(
            [os.environ["CHIP_PLANT"], *params], stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        self.behind = []
        # What the drives get and say, for whoever watches.
        self.setpoints = []
        board.wire.listeners.append(self.hear)
        board.on_tick = self.advance

    def close(self):
        self.process.stdin.close()
        self.process.stdout.close()
        self.process.wait()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def hear(self, frame, foreign):
        if frame.fd:
            if not foreign:
                self.tell_together(frame)
        elif not foreign:
            self.behind.append(frame)
            if frame.id == SYNC:
                self.pass_on()
        elif frame.of != DRIVE and (frame.id == 0 or 0x600 < frame.id < 0x680):
            self.answer(b"h", [frame])

    def answer(self, how, frames):
        packed = b"".join(struct.pack("<HB8s", one.id, len(one.data), one.data) for one in frames)
        self.process.stdin.write(how + bytes([len(frames)]) + packed)
        self.process.stdin.flush()
        for _ in range(self.process.stdout.read(1)[0]):
            identifier, length, data = struct.unpack("<HB8s", self.process.stdout.read(11))
            self.board.wire.send(Frame(identifier, data[:length], of=DRIVE))

    def pass_on(self):
        """What the board has said so far is with the drives."""
        if self.behind:
            self.answer(b"x", self.behind)
            self.behind = []

    def tell_together(self, frame):
        """The frame of CAN FD with the setpoints of all drives; what was said before it comes first."""
        self.pass_on()
        self.process.stdin.write(b"t" + struct.pack("<HB", frame.id, len(frame.data)) + frame.data)
        self.process.stdin.flush()

    def advance(self):
        """The next period begins: what the drives were told in the last one is with them, and the spindle has turned."""
        self.pass_on()
        self.process.stdin.write(b"a")
        self.process.stdin.flush()
        count, flags, age, index = struct.unpack("<iBIi", self.process.stdout.read(13))
        self.board.tim2.turn(count, index if flags & 2 else None)
        if flags & 1:
            self.board.tim5.edge(age)
