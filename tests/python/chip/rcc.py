"""RCC: oscillators, PLL, dividers, clocks of the parts, why there was a reset (RM0440, "Reset and clock control (RCC)")."""

from clock import MS, US
from registers import ManualError, Registers

CR, ICSCR, CFGR, PLLCFGR = 0x00, 0x04, 0x08, 0x0C
CIER, CIFR, CICR = 0x18, 0x1C, 0x20
AHB1ENR, AHB2ENR, AHB3ENR, APB1ENR1, APB1ENR2, APB2ENR = 0x48, 0x4C, 0x50, 0x58, 0x5C, 0x60
CCIPR, BDCR, CSR, CRRCR, CCIPR2 = 0x88, 0x90, 0x94, 0x98, 0x9C

# CSR: flags of the last reset.
RMVF, OBLRSTF, PINRSTF, BORRSTF, SFTRSTF, IWDGRSTF, WWDGRSTF, LPWRRSTF = (
    1 << bit for bit in (23, 25, 26, 27, 28, 29, 30, 31))

HSI_MHZ, CRYSTAL_MHZ = 16, 24
# Datasheet, "HSE oscillator characteristics": the crystal starts in 2 ms; "PLL characteristics": lock in 40 µs.
CRYSTAL_START, PLL_LOCK = 2 * MS, 40 * US


class Rcc(Registers):
    NAME = "RCC"
    RESET = {at: 0 for at in range(0, 0xA4, 4)} | {
        CR: 0x0000_0500,
        ICSCR: 0x4000_0000,
        CFGR: 0x0000_0005,
        PLLCFGR: 0x0000_1000,
        AHB1ENR: 0x0000_0100,
        CSR: 0x0C00_0000,
    }

    def __init__(self, chip):
        super().__init__(chip)
        self.crystal = True
        self.waits = {}
        # Since when the AHB runs at half of a fast clock, and the highest speed so far.
        self.halved_since = None
        self.path = []

    def reset(self, flags=BORRSTF | PINRSTF):
        # Flags stay until they are taken back ("RCC control/status register").
        kept = self.word[CSR] & 0xFF00_0000
        super().reset()
        self.word[CSR] = kept | flags
        self.waits = {}
        self.halved_since = None
        self.path = [(self.chip.clock.now, HSI_MHZ)]
        self.chip.cycle = US // HSI_MHZ

    # The tree of clocks.

    def pll_mhz(self):
        """The PLL's output R."""
        return self.pll_between() / (2, 4, 6, 8)[self.word[PLLCFGR] >> 25 & 3]

    def pll_between(self):
        """The PLL's oscillator."""
        value = self.word[PLLCFGR]
        source = {2: HSI_MHZ, 3: CRYSTAL_MHZ}.get(value & 3)
        if source is None:
            raise ManualError("the PLL has no source")
        m, n = (value >> 4 & 15) + 1, value >> 8 & 127
        into = source / m
        between = into * n
        # Datasheet, "PLL characteristics", range 1.
        if not 2.66 <= into <= 16:
            raise ManualError(f"the PLL is fed with {into} MHz")
        if not 96 <= between <= (344 if self.chip.pwr.range_1() else 128):
            raise ManualError(f"the PLL runs at {between} MHz")
        return between

    def sysclk_mhz(self, switch=None):
        switch = self.word[CFGR] >> 2 & 3 if switch is None else switch
        return {1: lambda: HSI_MHZ, 2: lambda: CRYSTAL_MHZ, 3: self.pll_mhz}[switch]()

    def ahb_divider(self, cfgr=None):
        code = (self.word[CFGR] if cfgr is None else cfgr) >> 4 & 15
        return 1 if code < 8 else (2, 4, 8, 16, 64, 128, 256, 512)[code - 8]

    def hclk_mhz(self):
        return self.sysclk_mhz() / self.ahb_divider()

    def apb_divider(self, shift):
        code = self.word[CFGR] >> shift & 7
        return 1 if code < 4 else (2, 4, 8, 16)[code - 4]

    def timer_mhz(self):
        """Timers of APB1: its clock, or twice that where it is divided ("Clock tree")."""
        divider = self.apb_divider(8)
        return self.hclk_mhz() / divider * (1 if divider == 1 else 2)

    def fdcan_mhz(self):
        """CCIPR.FDCANSEL, bits 25:24: 00 is the crystal, 01 the PLL's output Q."""
        select = self.word[CCIPR] >> 24 & 3
        if select == 1 and self.word[CR] & 1 << 25 and self.word[PLLCFGR] & 1 << 20:
            return self.pll_between() / (2, 4, 6, 8)[self.word[PLLCFGR] >> 21 & 3]
        if select != 0 or not self.word[CR] & 1 << 17:
            raise ManualError("the CAN controller has no clock")
        return CRYSTAL_MHZ

    def check(self, who):
        """What holds at every moment, whoever has changed something."""
        sysclk, hclk = self.sysclk_mhz(), self.hclk_mhz()
        pwr, flash = self.chip.pwr, self.chip.flash
        if sysclk > pwr.highest_mhz():
            self.chip.complain(
                f"{who}: {sysclk:g} MHz, and the core's voltage is for {pwr.highest_mhz()} at most "
                "(Dynamic voltage scaling management)"
            )
        needed = flash.needed_wait_states(hclk)
        if flash.latency() < needed:
            self.chip.complain(f"{who}: {hclk:g} MHz with {flash.latency()} wait states, {needed} are needed")

    # Registers.

    def read(self, at):
        at = self.offset(at)
        if at in (CR, CFGR, CIFR):
            # Somebody waits for it, and asks again and again: each time some microseconds.
            self.chip.wait(self.chip.clock.now + 2 * US)
        return self.word[at]

    def write(self, at, value):
        at = self.offset(at)
        before = self.word[at]
        if at == CR:
            self.oscillators(before, value)
        elif at == CFGR:
            self.switch(before, value)
        elif at == PLLCFGR:
            if self.word[CR] & 1 << 24 and (value ^ before) & 0x7FF3:
                raise ManualError("the PLL is changed while it runs (RCC_PLLCFGR)")
            self.word[at] = value
        elif at == CICR:
            if value & 1 << 8:
                self.word[CIFR] &= ~(1 << 8)
                self.chip.nvic.nmi(False, "crystal")
        elif at == CSR:
            if value & RMVF:
                self.word[CSR] &= 0x007F_FFFF
            ready = 2 if value & 1 else 0
            self.word[CSR] = self.word[CSR] & 0xFF00_0000 | value & 1 | ready
        elif at == CRRCR:
            self.word[at] = value & ~2 | (2 if value & 1 else 0)
        elif at == CIFR:
            pass
        elif at == CCIPR and (value ^ before) & 3 << 24 and self.enabled(APB1ENR1, 25):
            raise ManualError("the clock of the CAN controller is changed while it runs (RCC_CCIPR)")
        else:
            self.word[at] = value

    def later(self, bit, after):
        """A ready bit that comes some time after."""
        def ready():
            self.word[CR] |= 1 << bit
        self.waits[bit] = self.chip.clock.after(after, ready)

    def oscillators(self, before, value):
        ready = before & (1 << 10 | 1 << 17 | 1 << 25)
        cr = value & ~(1 << 10 | 1 << 17 | 1 << 25) | ready
        self.word[CR] = cr
        for on, is_ready, after in ((8, 10, 2 * US), (16, 17, CRYSTAL_START), (24, 25, PLL_LOCK)):
            if cr & 1 << on and not before & 1 << on:
                if on == 24 and self.word[PLLCFGR] & 3 == 3 and not before & 1 << 17:
                    raise ManualError("the PLL is switched on before its crystal runs")
                if on != 16 or self.crystal:
                    self.later(is_ready, after)
            elif not cr & 1 << on and before & 1 << on:
                self.chip.clock.drop(self.waits.pop(is_ready, None))
                used = {8: (1,), 16: (2, 3), 24: (3,)}[on]
                if self.word[CFGR] >> 2 & 3 in used:
                    raise ManualError("an oscillator in use is switched off")
                self.word[CR] &= ~(1 << is_ready)

    def switch(self, before, value):
        wanted = value & 3
        ready = {0: False, 1: 10, 2: 17, 3: 25}[wanted]
        if ready is False or not self.word[CR] & 1 << ready:
            raise ManualError("a clock is selected that is not ready (RCC_CFGR.SW)")
        old_sysclk, new_sysclk = self.sysclk_mhz(), self.sysclk_mhz(wanted)
        old_divider, new_divider = self.ahb_divider(before), self.ahb_divider(value)
        # "Dynamic voltage scaling management", to range 1 boost mode: the AHB is divided by two before the clock goes
        # above, and that for a microsecond at least after.
        if new_sysclk > 80 >= old_sysclk:
            if new_divider < 2:
                self.chip.complain("to a fast clock without half the speed before (AHB prescaler)")
            self.halved_since = self.chip.clock.now
        if new_divider == 1 and old_divider > 1 and self.halved_since is not None and new_sysclk > 80:
            took = self.chip.clock.now - self.halved_since
            if took < US:
                self.chip.complain(f"half the speed for {took / US:.2f} µs; a microsecond is asked for")
            self.halved_since = None
        # The hardware answers in SWS.
        self.word[CFGR] = value & ~0xC | wanted << 2
        self.check("RCC_CFGR")
        self.path.append((self.chip.clock.now, self.hclk_mhz()))
        self.chip.cycle = int(US / self.hclk_mhz())

    def enabled(self, register, bit):
        return self.word[register] & 1 << bit != 0

    def crystal_stops(self):
        """The clock security system tells it, and goes on by the other oscillator ("Clock security system (CSS)")."""
        self.crystal = False
        if not self.word[CR] & 1 << 19:
            return
        self.word[CR] &= ~(1 << 16 | 1 << 17 | 1 << 24 | 1 << 25)
        self.word[CFGR] = self.word[CFGR] & ~0xF | 0x5
        self.word[CIFR] |= 1 << 8
        self.chip.nvic.nmi(True, "crystal")
