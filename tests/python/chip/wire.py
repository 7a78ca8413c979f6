"""The wire: one frame at a time, the smallest identifier first (ISO 11898-1: arbitration, stuffing, error frames)."""

from functools import lru_cache

from clock import US


@lru_cache(maxsize=65536)
def bits(identifier, data):
    """Bits of a classical data frame with its stuffing and the gap that follows."""
    stream = [0] + [identifier >> bit & 1 for bit in range(10, -1, -1)] + [0, 0, 0]
    stream += [len(data) >> bit & 1 for bit in range(3, -1, -1)]
    for byte in data:
        stream += [byte >> bit & 1 for bit in range(7, -1, -1)]
    crc = 0
    for bit in stream:
        crc = (crc << 1) ^ (0x4599 if bit ^ crc >> 14 & 1 else 0)
        crc &= 0x7FFF
    stream += [crc >> bit & 1 for bit in range(14, -1, -1)]
    stuffed, run, last = 0, 0, None
    for bit in stream:
        if bit == last:
            run += 1
        else:
            last, run = bit, 1
        if run == 5:
            stuffed += 1
            # The stuffed bit begins a run of its own.
            last, run = 1 - bit, 1
    # Delimiter of the checksum, acknowledge, end of frame, gap.
    return len(stream) + stuffed + 1 + 2 + 7 + 3


@lru_cache(maxsize=65536)
def fd_bits(identifier, data):
    """(bits at the nominal rate, bits at the rate of the data) of a frame of CAN FD that switches its rate."""
    head = [0] + [identifier >> bit & 1 for bit in range(10, -1, -1)] + [0, 0, 1, 0, 1]
    # ESI, the code of the length, the data.
    body = [0] + [LENGTHS.index(len(data)) >> bit & 1 for bit in range(3, -1, -1)]
    for byte in data:
        body += [byte >> bit & 1 for bit in range(7, -1, -1)]
    nominal = fast = run = 0
    last = None
    for place, bit in enumerate(head + body):
        bits_of = 1
        run = run + 1 if bit == last else 1
        last = bit
        if run == 5:
            bits_of, run, last = 2, 1, 1 - bit
        if place < len(head):
            nominal += bits_of
        else:
            fast += bits_of
    # Count of stuffing bits and checksum, with a stuffed bit before each four of them.
    fast += 27 if len(data) <= 16 else 32
    # Delimiter of the checksum, acknowledge, end of frame, gap.
    return nominal + 1 + 2 + 7 + 3, fast


# The lengths that a frame of CAN FD can have, by their code.
LENGTHS = (0, 1, 2, 3, 4, 5, 6, 7, 8, 12, 16, 20, 24, 32, 48, 64)


class Frame:
    __slots__ = ("id", "data", "time", "of", "fd")

    def __init__(self, identifier, data, of=None, fd=False):
        self.id, self.data, self.of, self.fd = identifier, bytes(data), of, fd
        self.time = None

    def __repr__(self):
        return f"{self.id:03X}{'##1' if self.fd else '#'}{self.data.hex().upper()}"

    def __eq__(self, other):
        return (self.id, self.data, self.fd) == (other.id, other.data, other.fd)

    __hash__ = None


class Wire:
    """Who has something to send asks for it; who listens hears everything."""

    def __init__(self, clock, bit=US):
        self.clock, self.bit = clock, bit
        # A bit of the data of CAN FD; none where the controller has no rate for them.
        self.data_bit = None
        self.waiting = []
        self.controller = None
        self.listeners = []
        self.current = None
        # CANH and CANL touch: nobody hears anything, and every frame is an error.
        self.shorted = False
        # Frames take no time: for what is to happen between two moments.
        self.instant = False
        self.log = []
        self.keeps = False

    def send(self, frame):
        """A frame of somebody who is not the chip."""
        self.waiting.append(frame)
        self.kick()

    def kick(self):
        if self.current is not None:
            return
        offers = []
        if self.controller is not None:
            own = self.controller.offer()
            if own is not None:
                offers.append((own.id, 0, own))
        # Where frames take no time, whoever hears them has the time to take each.
        if self.waiting and not (self.instant and self.controller is not None and self.controller.fifo):
            first = min(range(len(self.waiting)), key=lambda n: (self.waiting[n].id, n))
            offers.append((self.waiting[first].id, 1, self.waiting[first]))
        if not offers:
            return
        _, foreign, frame = min(offers, key=lambda offer: offer[:2])
        self.current = frame
        frame.time = self.clock.now
        if self.controller is not None and not foreign:
            self.controller.begun(frame)
        if foreign and self.controller is not None:
            self.controller.hears(frame)
        if self.shorted:
            # An error frame: flag of six to twelve bits, delimiter of eight, gap of three.
            self.clock.after((17 + 20) * self.bit, lambda: self.fails(frame, foreign))
        else:
            self.clock.after(0 if self.instant else self.takes(frame), lambda: self.ends(frame, foreign))

    def takes(self, frame):
        """Steps of the clock from its start to the end of the gap behind it."""
        if not frame.fd:
            return bits(frame.id, frame.data) * self.bit
        nominal, fast = fd_bits(frame.id, frame.data)
        return nominal * self.bit + round(fast * self.data_bit)

    def fails(self, frame, foreign):
        self.current = None
        if foreign:
            # They give up some time: whoever they are, they are of no interest here.
            self.waiting.remove(frame)
        else:
            self.controller.failed(frame)
        self.kick()

    def ends(self, frame, foreign):
        self.current = None
        if foreign:
            self.waiting = [one for one in self.waiting if one is not frame]
            if self.controller is not None:
                self.controller.heard(frame)
        else:
            self.controller.sent(frame)
        if self.keeps:
            self.log.append(frame)
        for listener in list(self.listeners):
            listener(frame, foreign)
        self.kick()

    def power_off(self):
        """What the chip was sending ends in the middle."""
        if self.current is not None and self.current.of is self.controller:
            self.current = None
