"""What the tests say to the board, and what it says: CiA 301 as far as that goes."""

from clock import MS
from wire import Frame

BOARD, GATEWAY = 1, 127
SYNC, START = 0x080, Frame(0x000, bytes([1, BOARD]))


class Refused(AssertionError):
    """The board answers a request with an abort code."""


class Ear:
    """What the board has said, with its time."""

    def __init__(self, board):
        self.board = board
        self.frames = []
        board.wire.listeners.append(self.hear)

    def hear(self, frame, foreign):
        if not foreign:
            self.frames.append(frame)

    def with_id(self, identifier):
        return [frame for frame in self.frames if frame.id == identifier]

    def alarms(self):
        """Numbers of the alarms it has told, and 0 for their end (EMCY: error code, register, five bytes of its maker)."""
        told = []
        for frame in self.with_id(0x080 + BOARD):
            code = int.from_bytes(frame.data[:2], "little")
            told.append(int.from_bytes(frame.data[3:5], "little") if code else 0)
        return told

    def wait(self, wanted, patience=1000 * MS):
        """The first frame from now on that is wanted; time goes by meanwhile."""
        start = len(self.frames)
        end = self.board.clock.now + patience
        self.board.limit, before = end, self.board.limit
        self.board.run_until(
            lambda: any(wanted(frame) for frame in self.frames[start:]) or self.board.clock.now >= end)
        self.board.limit = before
        return next((frame for frame in self.frames[start:] if wanted(frame)), None)


class Sdo:
    """A client of the board's server, in expedited and segmented transfers."""

    def __init__(self, board, ear):
        self.board, self.ear = board, ear

    def ask(self, data):
        request = Frame(0x600 + BOARD, bytes(data).ljust(8, b"\0"))
        self.board.wire.send(request)
        answer = self.ear.wait(lambda frame: frame.id == 0x580 + BOARD)
        if answer is None:
            raise AssertionError(f"no answer to {request}")
        if answer.data[0] == 0x80:
            raise Refused(f"{request}: {int.from_bytes(answer.data[4:], 'little'):08X}h")
        return answer.data

    def read(self, index, sub):
        head = bytes([index & 255, index >> 8, sub])
        answer = self.ask(bytes([0x40]) + head)
        if answer[0] & 2:
            return answer[4:8 - (answer[0] >> 2 & 3)]
        data, toggle = b"", 0
        while True:
            answer = self.ask([0x60 | toggle])
            data += answer[1:8 - (answer[0] >> 1 & 7)]
            toggle ^= 0x10
            if answer[0] & 1:
                return data

    def number(self, index, sub):
        return int.from_bytes(self.read(index, sub), "little")

    def write(self, index, sub, data):
        head = bytes([index & 255, index >> 8, sub])
        if len(data) <= 4:
            self.ask(bytes([0x23 | 4 - len(data) << 2]) + head + data)
            return
        self.ask(bytes([0x21]) + head + len(data).to_bytes(4, "little"))
        toggle = 0
        for at in range(0, len(data), 7):
            part = data[at:at + 7]
            last = at + 7 >= len(data)
            self.ask(bytes([toggle | 7 - len(part) << 1 | last]) + part)
            toggle ^= 0x10
