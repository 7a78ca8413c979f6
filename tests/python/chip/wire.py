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


class Frame:
    __slots__ = ("id", "data", "time", "of")

    def __init__(self, identifier, data, of=None):
        self.id, self.data, self.of = identifier, bytes(data), of
        self.time = None

    def __repr__(self):
        return f"{self.id:03X}#{self.data.hex().upper()}"

    def __eq__(self, other):
        return (self.id, self.data) == (other.id, other.data)

    __hash__ = None


class Wire:
    """Who has something to send asks for it; who listens hears everything."""

    def __init__(self, clock, bit=US):
        self.clock, self.bit = clock, bit
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
            took = 0 if self.instant else bits(frame.id, frame.data) * self.bit
            self.clock.after(took, lambda: self.ends(frame, foreign))

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
