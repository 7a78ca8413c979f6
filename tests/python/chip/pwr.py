"""PWR: the core's voltage (RM0440, "Power control (PWR)", section "Dynamic voltage scaling management")."""

from registers import Registers

CR1, SR2, CR5 = 0x00, 0x14, 0x80


class Pwr(Registers):
    NAME = "PWR"
    # CR1.VOS = range 1; CR5.R1MODE (bit 8) = 1: range 1 normal mode.
    RESET = {at: 0 for at in range(0, 0x84, 4)} | {CR1: 0x0200, 0x08: 0x8000, CR5: 0x0100}

    def range_1(self):
        """CR1.VOS, bits 10:9: 01 is range 1, 10 range 2."""
        return self.word[CR1] >> 9 & 3 == 1

    def boost(self):
        """CR5.R1MODE, bit 8: 0 is range 1 boost mode."""
        return self.word[CR5] & 1 << 8 == 0

    def highest_mhz(self):
        """What the system clock may be ("Dynamic voltage scaling management")."""
        if not self.range_1():
            return 26
        return 170 if self.boost() else 150

    def write(self, at, value):
        super().write(at, value)
        self.chip.rcc.check("PWR")
