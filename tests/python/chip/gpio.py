"""GPIO: pins, and who says their level (RM0440, "General-purpose I/Os (GPIO)")."""

from registers import ManualError, Registers

MODER, OTYPER, OSPEEDR, PUPDR, IDR, ODR, BSRR, LCKR, AFRL, AFRH, BRR = range(0, 0x2C, 4)
INPUT, OUTPUT, ALTERNATE, ANALOG = range(4)


class Port(Registers):
    """After a reset all pins are analog, but those of the debug probe."""

    def __init__(self, chip, letter, clock_bit):
        self.NAME = f"GPIO{letter}"
        self.letter, self.clock_bit = letter, clock_bit
        self.RESET = {at: 0 for at in range(0, 0x2C, 4)} | {
            "A": {MODER: 0xABFF_FFFF, OSPEEDR: 0x0C00_0000, PUPDR: 0x6400_0000},
            "B": {MODER: 0xFFFF_FEBF, OSPEEDR: 0x0000_00C0, PUPDR: 0x0000_0100},
        }.get(letter, {MODER: 0xFFFF_FFFF})
        # What somebody outside drives a pin to: 0 or 1.
        self.outside = {}
        super().__init__(chip)

    def mode(self, pin):
        return self.word[MODER] >> 2 * pin & 3

    def level(self, pin):
        """0, 1, or `None`: nobody says so."""
        mode = self.mode(pin)
        if mode == OUTPUT:
            high = self.word[ODR] >> pin & 1
            if not (high and self.word[OTYPER] >> pin & 1):
                return high
        if pin in self.outside:
            return self.outside[pin]
        if mode == ANALOG:
            return None
        return {1: 1, 2: 0}.get(self.word[PUPDR] >> 2 * pin & 3)

    def shown(self, pin):
        """What a scope shows at the pin."""
        if self.mode(pin) == ALTERNATE:
            return f"alternate {self.word[AFRL if pin < 8 else AFRH] >> 4 * (pin & 7) & 15}"
        if self.mode(pin) == OUTPUT:
            return {0: "low", 1: "high"}.get(self.level(pin), "floats")
        if self.mode(pin) == ANALOG:
            return "floats"
        return {1: "pulled up", 2: "pulled down"}.get(self.word[PUPDR] >> 2 * pin & 3, "floats")

    def clocked(self):
        if not self.chip.rcc.enabled(0x4C, self.clock_bit):
            raise ManualError(f"{self.NAME} has no clock (RCC_AHB2ENR)")

    def read(self, at):
        self.clocked()
        if self.offset(at) == IDR:
            return sum((self.level(pin) or 0) << pin for pin in range(16) if self.mode(pin) != ANALOG)
        return self.word[self.offset(at)]

    def write(self, at, value):
        self.clocked()
        at = self.offset(at)
        if at == BSRR:
            self.word[ODR] = (self.word[ODR] & ~(value >> 16) | value) & 0xFFFF
        elif at == BRR:
            self.word[ODR] &= ~value & 0xFFFF
        elif at != IDR:
            self.word[at] = value
        self.chip.pins_changed()
