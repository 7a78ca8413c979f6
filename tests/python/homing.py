"""How a drive homes by itself (CiA 402, mode 6), from the standard's description of its methods: the switches along a way,
the index of the motor, and the ways that each method goes. Lengths are increments, times are SYNC periods.

It must not know the board, nor what is on the bus."""

import math

# In a period, and in a period squared.
FAST, SLOW, RAMP = 4_000, 500, 400

# Every method that has a mark.
METHODS = (1, 2, *range(7, 15), *range(17, 31), 33, 34, 35, 37)

# Bits of a statusword in mode 6.
ERROR, ATTAINED, REACHED = 1 << 13, 1 << 12, 1 << 10


class Bed:
    """What is mounted along the way of an axis. A switch changes exactly at its edge."""

    def __init__(self, home=(100_000, 160_000), negative=-300_000, positive=300_000, index=3_333, turn=10_000):
        self.home, self.negative, self.positive = home, negative, positive
        self.index, self.turn = index, turn

    def is_on(self, switch, place):
        low, high = self.home
        on = {"negative": place < self.negative, "positive": place >= self.positive, "home": low <= place < high}
        return on[switch]

    def inputs(self, place):
        """60FDh."""
        switches = ("negative", "positive", "home")
        return sum(self.is_on(switch, place) << bit for bit, switch in enumerate(switches))

    def index_above(self, place):
        return self.index + (math.floor((place - self.index) / self.turn) + 1) * self.turn

    def index_below(self, place):
        return self.index + (math.ceil((place - self.index) / self.turn) - 1) * self.turn

    def met(self, until, start, end):
        """Where a move from `start` to `end` meets what it goes for; `None`: not at all."""
        if until == "index":
            at = self.index_above(start) if end > start else self.index_below(start)
            return at if min(start, end) <= at <= max(start, end) else None
        switch, wanted = until.split()
        was, is_on = self.is_on(switch, start), self.is_on(switch, end)
        if was == is_on or is_on != (wanted == "on"):
            return None
        edges = {"negative": [self.negative], "positive": [self.positive], "home": self.home}[switch]
        return next(edge for edge in edges if min(start, end) <= edge <= max(start, end))


def ways(method, is_on):
    """The ways of a method, one after the other: direction, speed, and what ends each; it is told what did."""
    if method in (35, 37):
        return
    if method in (33, 34):
        yield -1 if method == 33 else 1, SLOW, ["index"]
        return
    # 17 to 30 are 1 to 14 without an index.
    kind = method - 16 if method >= 17 else method
    if kind in (1, 2):
        limit, sign = ("negative", -1) if kind == 1 else ("positive", 1)
        if not is_on(limit):
            yield sign, FAST, [f"{limit} on"]
        sign = -sign
        yield sign, SLOW, [f"{limit} off"]
    elif kind <= 6:
        # A home switch that is on up to an end: its edge left (3, 5), or entered (4, 6).
        sign = 1 if kind in (3, 4) else -1
        if not is_on("home"):
            yield sign, FAST, ["home on"]
        if kind in (3, 5):
            sign = -sign
            yield sign, SLOW, ["home off"]
        else:
            yield -sign, FAST, ["home off"]
            yield sign, SLOW, ["home on"]
    else:
        sign = 1 if kind <= 10 else -1
        limit = "positive on" if sign > 0 else "negative on"
        if not is_on("home"):
            met = yield sign, FAST, ["home on", limit]
            if met == limit:
                yield -sign, FAST, ["home on"]
        # The near edge from outside and inside, the far edge from inside and outside.
        place = (kind - 7) % 4
        if place == 0:
            sign = -sign
            yield sign, SLOW, ["home off"]
        elif place == 1:
            yield -sign, FAST, ["home off"]
            yield sign, SLOW, ["home on"]
        elif place == 2:
            yield sign, FAST, ["home off"]
            sign = -sign
            yield sign, SLOW, ["home on"]
        else:
            yield sign, SLOW, ["home off"]
    if method < 17:
        yield sign, SLOW, ["index"]


def mark(method, bed, start):
    """Where the mark of a method is: what `ways` has to come to."""
    low, high = bed.home
    edges = {
        1: (bed.negative, 1),
        2: (bed.positive, -1),
        3: (low, -1),
        4: (low, 1),
        5: (high, 1),
        6: (high, -1),
        7: (low, -1),
        8: (low, 1),
        9: (high, -1),
        10: (high, 1),
        11: (high, 1),
        12: (high, -1),
        13: (low, 1),
        14: (low, -1),
        33: (start, -1),
        34: (start, 1),
    }
    if method in (35, 37):
        return start
    edge, sign = edges[method - 16 if 17 <= method <= 30 else method]
    if 17 <= method <= 30:
        return edge
    return bed.index_above(edge) if sign > 0 else bed.index_below(edge)


class Homing:
    """An axis in mode 6. `past`: it stays where it comes to rest behind the mark; otherwise it goes back to it."""

    def __init__(self, bed, method, past=False, speeds=(FAST, SLOW)):
        self.bed, self.method, self.past = bed, method, past
        self.speeds = dict(zip((FAST, SLOW), speeds))
        self.speed, self.mark = 0, None
        self.started = self.halted = self.done = False
        self.ways = self.way = None

    def bits(self):
        """Bits 13, 12 and 10 of the statusword."""
        rests = REACHED if self.speed == 0 else 0
        if self.mark is not None:
            return ATTAINED | (REACHED if self.done else 0)
        return rests if self.way is None or self.halted else 0

    def leave(self):
        """Another mode, or no torque."""
        self.started, self.ways, self.way, self.speed = False, None, None, 0

    def period(self, place, control):
        """Gives the place behind it, and the mark where it was found in this period."""
        start = bool(control & 0x10)
        self.halted = bool(control & 0x100)
        found = None
        if start and not self.started:
            self.mark, self.done = None, False
            self.ways = ways(self.method, lambda switch: self.bed.is_on(switch, place))
            found = self.next(None, place)
        elif not start:
            self.ways = self.way = None
        self.started = start
        wanted = 0
        if self.way and not self.halted:
            sign, speed, _ = self.way
            wanted = sign * self.speeds[speed]
            if self.speed * sign < 0:
                wanted = 0
        if self.mark is not None and start and self.speed == 0:
            return self.come_back(place), found
        self.speed += max(-RAMP, min(RAMP, wanted - self.speed))
        behind = place + self.speed
        if self.way and self.speed * self.way[0] > 0:
            for until in self.way[2]:
                at = self.bed.met(until, place, behind)
                if at is not None:
                    found = self.next(until, at)
                    break
        return behind, found

    def next(self, met, at):
        """The next way; behind the last one gives the mark."""
        try:
            self.way = next(self.ways) if met is None else self.ways.send(met)
            return None
        except StopIteration:
            self.way, self.mark = None, at
            return at

    def come_back(self, place):
        left = self.mark - place
        if self.past or left == 0:
            self.done = True
            return place
        return place + max(-SLOW, min(SLOW, left))
