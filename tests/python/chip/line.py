"""A Lawicel (SLCAN) adapter on the board's wire, behind a socket: `leadscrew --bus slcan:unix:…` drives the image."""

import os
import select
import socket
import tempfile
import time

from clock import US
from talk import BOARD
from wire import Frame

GATEWAY = "gateway"
# When in a period of the tick the outside is served, in parts of it: the tick's own frames have gone, and others may still.
SERVED = 0.6
# States in which nothing moves by itself: idle, and an alarm.
RESTS = (1, 7)
# Seconds after which nothing comes of it any more. The longest example has 600 000 ticks.
PATIENCE = 36_000 if os.environ.get("CHIP_ALL") else 600
# Ticks of a machine that has nothing to do, at once: drives answer every fourth SYNC.
TURN = 40


class Line:
    """As many adapters as there are programs that want one. Virtual time: it stands still while they talk."""

    def __init__(self, board):
        self.board = board
        self.folder = tempfile.TemporaryDirectory(prefix="chip")
        self.path = os.path.join(self.folder.name, "line")
        self.server = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        self.server.bind(self.path)
        self.server.listen()
        self.clients = {}
        self.status = None
        # Requests to the board's server.
        self.requests = self.batches = 0
        # The gateway has not gone on with its program though there was room: it has no more of it.
        self.complete = False
        board.wire.listeners.append(self.hear)

    def close(self):
        for client in list(self.clients):
            self.drop(client)
        self.server.close()
        self.folder.cleanup()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    @property
    def bus(self):
        return f"slcan:unix:{self.path}"

    # The wire's side.

    def hear(self, frame, foreign):
        # An adapter for classical frames tells no others.
        if frame.fd:
            return
        line = f"t{frame.id:03X}{len(frame.data)}{frame.data.hex().upper()}\r".encode()
        for client, state in list(self.clients.items()):
            if state["open"] and frame.of != (GATEWAY, client):
                self.say(client, line)
        if frame.id == 0x180 + BOARD and not foreign:
            self.status = frame.data

    # The programs' side.

    def say(self, client, data):
        try:
            client.sendall(data)
        except OSError:
            self.drop(client)

    def drop(self, client):
        if self.clients.pop(client, None) is not None:
            client.close()

    def pump(self, patience):
        """Takes what programs say; true where one has said anything."""
        ready, _, _ = select.select([self.server, *self.clients], [], [], patience)
        for client in ready:
            if client is self.server:
                fresh, _ = self.server.accept()
                self.clients[fresh] = {"open": False, "text": b""}
                continue
            try:
                data = client.recv(65536)
            except OSError:
                data = b""
            if not data:
                self.drop(client)
                continue
            state = self.clients[client]
            *lines, state["text"] = (state["text"] + data).split(b"\r")
            for line in lines:
                self.obey(client, state, line.decode())
        return bool(ready)

    def obey(self, client, state, line):
        if not line:
            return
        if line[0] == "t" and state["open"]:
            length = int(line[4])
            frame = Frame(int(line[1:4], 16), bytes.fromhex(line[5:5 + 2 * length]), of=(GATEWAY, client))
            if frame.id == 0x600 + BOARD:
                self.requests += 1
                # The beginning of a transfer into 5020h:01.
                self.batches += frame.data[0] >> 5 in (1, 6) and frame.data[1:4] == bytes([0x20, 0x50, 1])
            self.board.wire.send(frame)
            self.say(client, b"z\r")
        elif line[0] == "V":
            self.say(client, b"V1013\r")
        elif line[0] in "SOC":
            state["open"] = line[0] == "O"
            self.say(client, b"\r")
        else:
            self.say(client, b"\a")

    # Time.

    def serve(self, quiet, asked=0.0):
        """Lets everybody talk until nobody has asked anything for so many seconds; first waits for more of the program as
        long as `asked` says. The time of the board stands still. True where more of it came."""
        board = self.board
        board.wire.instant = True
        # The frame that is on the wire ends in its time.
        board.run_until(lambda: board.wire.current is None)
        before, seen = self.batches, self.requests
        begun = last = time.monotonic()
        # Orders are said again and again until the board confirms them, for which it has to tick: they are not waited for.
        while True:
            if self.pump(min(quiet, 0.002)):
                board.settle()
            now = time.monotonic()
            if self.requests != seen:
                seen, last = self.requests, now
            if now - last >= quiet and (self.batches > before or now - begun >= asked):
                break
        board.wire.instant = False
        return self.batches > before

    def runs(self):
        """A program is under way (5001h:03, bit 3)."""
        return self.status is not None and self.status[1] & 8 != 0

    def rests(self):
        return self.status is None or self.status[0] in RESTS and not self.runs()

    def tick(self):
        """A tick, and what the outside does in it."""
        board = self.board
        begun = board.ticks
        board.run_until(lambda: board.ticks > begun)
        # TIM6_ARR: a microsecond less than the period.
        period = (board.tim6.word[0x2C] + 1) * US
        board.run_for(int(SERVED * period))
        board.settle()

    def work(self, until):
        """Goes on until that is true."""
        ended = time.monotonic() + PATIENCE
        while not until():
            if time.monotonic() > ended:
                raise AssertionError(f"it takes too long; the board says {self.status and self.status.hex()}")
            if not self.runs():
                self.complete = False
            if self.rests():
                self.serve(0.03)
                for _ in range(TURN):
                    self.tick()
                continue
            told, self.status = self.status, None
            self.tick()
            fresh, self.status = self.status is not None, self.status or told
            room = int.from_bytes(self.status[6:8], "little")
            if fresh and self.runs() and room >= 600 and not self.complete:
                # There is room for more of the program: whoever has it is waited for.
                self.complete = not self.serve(0.02, asked=1.0)
            else:
                self.serve(0)


