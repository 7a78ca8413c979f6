"""IWDG: a counter of a clock of its own that resets the chip where it reaches 0 (RM0440, "Independent watchdog (IWDG)")."""

from clock import MS
from registers import Registers

KR, PR, RLR, SR, WINR = 0x00, 0x04, 0x08, 0x0C, 0x10
# Steps of a period of the LSI, 32 kHz.
LSI = MS // 32


class Watchdog(Registers):
    NAME = "IWDG"
    RESET = {KR: 0, PR: 0, RLR: 0xFFF, SR: 0, WINR: 0xFFF}

    def __init__(self, chip):
        super().__init__(chip)
        self.running = False
        self.open = False
        self.end = None

    def reset(self):
        super().reset()
        self.running = self.open = False
        self.chip.clock.drop(self.end)

    def patience(self):
        divider = min(4 << (self.word[PR] & 7), 256)
        return (self.word[RLR] + 1) * divider * LSI

    def feed(self):
        self.chip.clock.drop(self.end)
        if self.running:
            self.end = self.chip.clock.after(self.patience(), self.chip.bite)

    def write(self, at, value):
        at = self.offset(at)
        if at == KR:
            # Any other key than 5555 closes PR and RLR.
            self.open = value == 0x5555
            if value == 0xCCCC:
                self.running = True
            if value in (0xCCCC, 0xAAAA):
                self.feed()
        elif at in (PR, RLR, WINR) and self.open:
            # While an update is under way another one must not begin ("IWDG status register").
            busy = {PR: 1, RLR: 2, WINR: 4}[at]
            if self.word[SR] & busy:
                return
            self.word[at] = value
            self.word[SR] |= busy
            self.chip.clock.after(5 * LSI, lambda: self.settled(busy))

    def settled(self, busy):
        self.word[SR] &= ~busy
