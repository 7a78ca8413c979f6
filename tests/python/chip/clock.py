"""Time of the model: whole steps that all clocks of the board have in common, and what happens at which of them."""

import heapq

# Steps of a microsecond: 170, 85, 24 and 16 MHz all have whole periods.
US = 4080
MS = 1000 * US


class Clock:
    """What is to come, in the order of time."""

    def __init__(self):
        self.now = 0
        self._queue = []
        self._count = 0

    def at(self, time, what):
        """Calls `what` at a time. The handle it gives can be dropped."""
        self._count += 1
        entry = [max(time, self.now), self._count, what]
        heapq.heappush(self._queue, entry)
        return entry

    def after(self, steps, what):
        return self.at(self.now + steps, what)

    @staticmethod
    def drop(entry):
        if entry is not None:
            entry[2] = None

    def next(self):
        """When the next thing happens; `None`: never."""
        while self._queue and self._queue[0][2] is None:
            heapq.heappop(self._queue)
        return self._queue[0][0] if self._queue else None

    def advance(self, steps):
        self.until(self.now + steps)

    def until(self, time):
        """Lets everything up to a time happen."""
        while True:
            next_time = self.next()
            if next_time is None or next_time > time:
                break
            _, _, what = heapq.heappop(self._queue)
            self.now = max(self.now, next_time)
            what()
        self.now = max(self.now, time)

    def leap(self):
        """To the next thing that happens. False where nothing ever does."""
        time = self.next()
        if time is None:
            return False
        self.until(time)
        return True
