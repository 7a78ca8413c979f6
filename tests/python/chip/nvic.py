"""NVIC, SCB, MPU: which exception has its turn (ARMv7-M Architecture Reference Manual, B1.5 "Exception model", B3 "System
address map"). Sixteen priorities, as the chip has them (PM0214)."""

from registers import ManualError, Registers

NMI, HARD_FAULT = 2, 3
ICSR, VTOR, AIRCR, SCR, CCR, SHCSR, CFSR, HFSR, CPACR = 0xD04, 0xD08, 0xD0C, 0xD10, 0xD14, 0xD24, 0xD28, 0xD2C, 0xD88
MPU_TYPE, MPU_CTRL, MPU_RNR, MPU_RBAR, MPU_RASR = 0xD90, 0xD94, 0xD98, 0xD9C, 0xDA0
LINES = 102
LOWEST = 256


class Nvic(Registers):
    NAME = "the system control space"
    RESET = {at: 0 for at in range(0, 0x1000, 4)} | {0xD00: 0x410F_C241, CCR: 0x200, MPU_TYPE: 0x800}

    def __init__(self, chip):
        super().__init__(chip)
        self.clear()

    def clear(self):
        self.enabled, self.pending, self.priority = set(), set(), [0] * LINES
        # Lines that are up stay pending ("Level-sensitive interrupts").
        self.up = set()
        self.reasons = set()
        self.regions = {}

    def reset(self):
        super().reset()
        self.clear()

    def level(self, line, high):
        if high:
            if line not in self.up:
                self.up.add(line)
                self.pend(line)
        else:
            self.up.discard(line)

    def pend(self, line):
        self.pending.add(line)
        self.chip.cpu.poke()

    def nmi(self, high, reason):
        if high:
            self.reasons.add(reason)
            self.chip.cpu.poke()
        else:
            self.reasons.discard(reason)

    def next(self, running, masked):
        """(number, priority) of the exception that interrupts what runs at a priority; `masked`: PRIMASK is set."""
        if self.reasons and running > -2:
            return NMI, -2
        if masked:
            return None
        best = None
        for line in sorted(self.pending & self.enabled):
            priority = self.priority[line]
            if priority < running and (best is None or priority < best[1]):
                best = (16 + line, priority)
        return best

    def wakes(self):
        """WFI ends with anything that would interrupt if nothing were masked."""
        return bool(self.reasons or self.pending & self.enabled)

    def taken(self, number):
        if number >= 16:
            self.pending.discard(number - 16)

    def left(self, number):
        if number >= 16 and number - 16 in self.up:
            self.pending.add(number - 16)

    def bits(self, lines, at):
        first = (at & 0x1F) * 8
        return sum(1 << line - first for line in lines if first <= line < first + 32)

    @staticmethod
    def named(at, value):
        first = (at & 0x1F) * 8
        return {first + bit for bit in range(32) if value >> bit & 1}

    def read(self, at):
        at = self.offset(at)
        if 0x100 <= at < 0x120 or 0x180 <= at < 0x1A0:
            return self.bits(self.enabled, at)
        if 0x200 <= at < 0x220 or 0x280 <= at < 0x2A0:
            return self.bits(self.pending, at)
        if 0x400 <= at < 0x400 + LINES:
            return sum(self.priority[at - 0x400 + n] << 8 * n for n in range(4) if at - 0x400 + n < LINES)
        if at == ICSR:
            return self.chip.cpu.number()
        return self.word[at]

    peek = read

    def write(self, at, value):
        at = self.offset(at)
        if 0x100 <= at < 0x120:
            self.enabled |= self.named(at, value)
            self.chip.cpu.poke()
        elif 0x180 <= at < 0x1A0:
            self.enabled -= self.named(at, value)
        elif 0x200 <= at < 0x220:
            for line in self.named(at, value):
                self.pend(line)
        elif 0x280 <= at < 0x2A0:
            self.pending -= self.named(at, value) - self.up
        elif 0x400 <= at < 0x400 + LINES:
            for n in range(4):
                if at - 0x400 + n < LINES:
                    # The lower four bits read zero.
                    self.priority[at - 0x400 + n] = value >> 8 * n & 0xF0
        elif at == AIRCR:
            if value >> 16 == 0x05FA:
                if value & 1 << 2:
                    self.chip.software_reset()
        elif at == SCR:
            if value & 1 << 2:
                raise ManualError("the chip is put to deep sleep")
            self.word[at] = value
        elif at == MPU_RASR:
            self.word[at] = value
            self.regions[self.word[MPU_RNR]] = (self.word[MPU_RBAR] & ~31, value)
        elif at not in (0xD00, MPU_TYPE):
            self.word[at] = value

    def guards(self, address):
        """An enabled region without access lies over this address."""
        if not self.word[MPU_CTRL] & 1:
            return False
        for base, value in self.regions.values():
            size = 2 << (value >> 1 & 31)
            if value & 1 and value >> 24 & 7 == 0 and base <= address < base + size:
                return True
        return False
