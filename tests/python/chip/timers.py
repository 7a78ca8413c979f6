"""TIM1, 2, 3, 5, 6 as far as the image uses them (RM0440, "General-purpose timers", "Basic timers (TIM6/TIM7)",
"Advanced-control timers (TIM1/TIM8/TIM20)").

They count by themselves: what they show is computed from the time. TIM2 counts the encoder's edges, its trigger output
captures TIM5; TIM3 is the CAN controller's clock for its stamps; TIM6 raises the tick.
"""

from clock import US
from registers import ManualError, Registers

CR1, CR2, SMCR, DIER, SR, EGR = 0x00, 0x04, 0x08, 0x0C, 0x10, 0x14
CCMR1, CCMR2, CCER, CNT, PSC, ARR = 0x18, 0x1C, 0x20, 0x24, 0x28, 0x2C
CCR1, CCR2, CCR3, CCR4 = 0x34, 0x38, 0x3C, 0x40


class Timer(Registers):
    """A counter upwards, with prescaler and preload."""

    def __init__(self, chip, number, clock_bit, bits, interrupt=None):
        self.NAME = f"TIM{number}"
        self.clock_bit, self.interrupt = clock_bit, interrupt
        self.last = (1 << bits) - 1
        self.RESET = {at: 0 for at in range(0, 0x70, 4)} | {ARR: self.last}
        super().__init__(chip)
        self.began, self.start, self.period = 0, 0, self.last + 1
        self.step = US
        self.event = None

    def reset(self):
        super().reset()
        self.chip.clock.drop(self.event)
        self.event = None
        self.period = self.last + 1

    def clocked(self):
        if not self.chip.rcc.enabled(0x58, self.clock_bit):
            raise ManualError(f"{self.NAME} has no clock (RCC_APB1ENR1)")

    def runs(self):
        return self.word[CR1] & 1 != 0

    def count(self):
        if not self.runs():
            return self.word[CNT]
        return (self.start + (self.chip.clock.now - self.began) // self.step) % self.period

    def settle(self):
        """Takes what is preloaded: prescaler always, reload where it is buffered (ARPE)."""
        steps = (self.word[PSC] + 1) * US / self.chip.rcc.timer_mhz()
        if steps != int(steps):
            raise ManualError(f"{self.NAME} counts in {steps} steps")
        self.step = int(steps)
        self.period = self.word[ARR] + 1
        self.began, self.start = self.chip.clock.now, 0

    def plan(self):
        """The next overflow, where anybody wants to know."""
        self.chip.clock.drop(self.event)
        self.event = None
        if self.runs() and self.interrupt is not None:
            left = self.period - self.start
            self.event = self.chip.clock.at(self.began + left * self.step, self.overflow)

    def overflow(self):
        self.settle()
        self.word[SR] |= 1
        self.plan()
        self.tell()
        self.chip.ticked(self)

    def tell(self):
        if self.interrupt is not None:
            self.chip.nvic.level(self.interrupt, bool(self.word[SR] & self.word[DIER] & 1))

    def read(self, at):
        self.clocked()
        at = self.offset(at)
        if at == CNT:
            return self.count()
        if at in (CCR1, CCR3):
            # Reading what was captured clears its flag ("TIMx status register").
            self.word[SR] &= ~(1 << 1 + (at - CCR1) // 4)
        return self.word[at]

    def peek(self, at):
        return self.word[self.offset(at)]

    def write(self, at, value):
        self.clocked()
        at = self.offset(at)
        if at == CR1:
            was = self.runs()
            if was and not value & 1:
                self.word[CNT] = self.count()
            self.word[at] = value
            if value & 1 and not was:
                start = self.word[CNT]
                if not hasattr(self, "updated"):
                    self.settle()
                self.began, self.start = self.chip.clock.now, start
                self.plan()
        elif at == SR:
            # Flags are cleared by 0.
            self.word[SR] &= value
            self.tell()
        elif at == EGR:
            if value & 1:
                self.settle()
                self.word[CNT] = 0
                # URS: only an overflow is told.
                if not self.word[CR1] & 1 << 2:
                    self.word[SR] |= 1
                self.plan()
                self.tell()
        elif at == ARR:
            self.word[at] = value & self.last
            if not self.word[CR1] & 1 << 7:
                self.start, self.began = self.count(), self.chip.clock.now
                self.period = self.word[ARR] + 1
                self.plan()
        elif at == CNT:
            self.word[at] = value & self.last
            self.start, self.began = value & self.last, self.chip.clock.now
        else:
            self.word[at] = value
            if at == DIER:
                self.tell()


class Encoder(Timer):
    """TIM2 in encoder mode: it counts edges, and nothing else."""

    def count(self):
        if self.runs() and self.word[SMCR] & 0x10007 != 3:
            raise ManualError(f"{self.NAME} counts, and not every edge of both lines (SMCR.SMS = 3)")
        return self.word[CNT]

    def turn(self, count, index):
        """The encoder shows this count; `index`: the one at which its pulse came."""
        if not self.runs():
            return
        self.word[CNT] = count & 0xFFFF_FFFF
        # Channel 3 captures TI3 (CCMR2.CC3S = 01), where it is enabled (CCER.CC3E).
        if index is not None and self.word[CCMR2] & 3 == 1 and self.word[CCER] & 1 << 8:
            self.word[CCR3] = index & 0xFFFF_FFFF
            self.word[SR] |= 1 << 3

    def tells_edges(self):
        """CR2.MMS (bits 25 and 6:4) = 1000: the trigger output is the encoder's clock."""
        cr2 = self.word[CR2]
        return (cr2 >> 25 & 1) << 3 | cr2 >> 4 & 7 == 8


class Handwheel(Encoder):
    """TIM1 in encoder mode, of sixteen bits; its lines are PA8 and PA9 (AF6)."""

    def clocked(self):
        if not self.chip.rcc.enabled(0x60, 11):
            raise ManualError("TIM1 has no clock (RCC_APB2ENR)")

    def by(self, edges):
        """The wheel is turned."""
        shown = [self.chip.ports["A"].shown(pin) for pin in (8, 9)]
        # CCMR1.CC1S = CC2S = 01: the channels are inputs of their own lines.
        if self.runs() and shown == ["alternate 6"] * 2 and self.word[CCMR1] & 0x303 == 0x101:
            self.word[CNT] = self.word[CNT] + edges & self.last


class EdgeClock(Timer):
    """TIM5: keeps its count at each edge that TIM2 tells it."""

    def edge(self, age_ns):
        if not (self.runs() and self.chip.tim2.tells_edges()):
            return
        # ITR1 is TIM2 for TIM5 ("TIMx internal trigger connection"); CC1S = 11: channel 1 captures TRC.
        trigger = self.word[SMCR] >> 4 & 7
        if trigger == 1 and self.word[CCMR1] & 3 == 3 and self.word[CCER] & 1:
            ago = age_ns * 170 // 1000
            self.word[CCR1] = (self.count() - ago) & self.last
            self.word[SR] |= 1 << 1
