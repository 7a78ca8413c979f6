"""What a network and a disk do to agents: frames that vanish, and no room."""

import ctypes
import os
import pathlib
import socket
import threading
import time

# Of mount(2) and umount2(2).
DETACH = 2
BUFFER = 1 << 16


class Network:
    """The way to a broker, on the loopback. Where it is cut, what goes along vanishes and nobody is told."""

    def __init__(self, port):
        self.to = port
        self.lock = threading.Lock()
        self.is_cut = False
        self.ends = []
        self.dead = []
        self.listening = socket.create_server(("127.0.0.1", 0), backlog=128)
        self.port = self.listening.getsockname()[1]
        threading.Thread(target=self.accept, daemon=True).start()

    def accept(self):
        while True:
            try:
                near, _ = self.listening.accept()
            except OSError:
                return
            with self.lock:
                if self.is_cut:
                    # A connection that no broker hears of.
                    self.dead.append(near)
                    continue
            try:
                far = socket.create_connection(("127.0.0.1", self.to))
            except OSError:
                hang_up(near)
                continue
            for end in (near, far):
                end.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            with self.lock:
                (self.dead if self.is_cut else self.ends).extend([near, far])
            for way in [(near, far), (far, near)]:
                threading.Thread(target=self.forward, args=way, daemon=True).start()

    def forward(self, come, go):
        try:
            while data := come.recv(BUFFER):
                with self.lock:
                    # Taken, as by a router on the way, and gone.
                    is_dead = come in self.dead
                if not is_dead:
                    go.sendall(data)
        except OSError:
            pass
        with self.lock:
            if come in self.dead or come not in self.ends:
                return
            self.ends.remove(come)
            self.ends.remove(go)
        for end in (come, go):
            hang_up(end)

    def cut(self):
        """From now on nothing comes through, in either direction."""
        with self.lock:
            self.is_cut = True
            self.dead += self.ends
            self.ends.clear()

    def mend(self, told):
        """New connections come through. `told`: whoever still has an old one hears that it is none; else nobody does."""
        with self.lock:
            self.is_cut = False
            if told:
                for end in self.dead:
                    hang_up(end)
                self.dead.clear()

    def end(self):
        self.listening.close()
        with self.lock:
            for end in self.ends + self.dead:
                hang_up(end)


def hang_up(end):
    try:
        # Who waits for it hears of it.
        end.shutdown(socket.SHUT_RDWR)
    except OSError:
        pass
    end.close()


class Disk:
    """A small file system of its own, in memory. It needs leave to mount."""

    def __init__(self, folder, megabytes):
        self.folder = pathlib.Path(folder)
        self.folder.mkdir()
        self.system = ctypes.CDLL(None, use_errno=True)
        place, size = os.fsencode(self.folder), f"size={megabytes}m".encode()
        if self.system.mount(b"leadscrew", place, b"tmpfs", 0, size) != 0:
            self.folder.rmdir()
            raise OSError(ctypes.get_errno(), os.strerror(ctypes.get_errno()))

    def fill(self):
        """To its last byte, by somebody else."""
        with open(self.folder / "filler", "ab", buffering=0) as filler:
            size = BUFFER
            while size:
                try:
                    filler.write(bytes(size))
                except OSError:
                    size //= 2

    def clear(self, limit):
        """Room again, once a store has met the full disk: it has given its reserve away then. On a computer with much to do that
        takes its time, up to `limit` seconds. Gives whether one has."""
        end = time.monotonic() + limit
        while list(self.folder.glob("*.reserve")) and time.monotonic() < end:
            time.sleep(0.05)
        met = not list(self.folder.glob("*.reserve"))
        (self.folder / "filler").unlink()
        return met

    def end(self):
        self.system.umount2(os.fsencode(self.folder), DETACH)
        self.folder.rmdir()


def may_mount(folder):
    """Whether this user has leave to."""
    try:
        Disk(pathlib.Path(folder) / "tried", 1).end()
    except OSError:
        return False
    return True
