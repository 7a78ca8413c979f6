"""FDCAN1: message memory, filters, queue of frames to be sent, FIFO of received ones, error counters, bus-off, restricted
mode (RM0440, "FD controller area network (FDCAN)"; what it leaves open, from Bosch's M_CAN, which it is)."""

from clock import US
from registers import ManualError, Registers
from wire import LENGTHS, Frame

DBTP, CCCR, NBTP, TSCC, TSCV, ECR, PSR, TDCR = 0x0C, 0x18, 0x1C, 0x20, 0x24, 0x40, 0x44, 0x48
IR, IE, ILS, ILE, RXGFC, RXF0S, RXF0A, RXF1S, RXF1A = 0x50, 0x54, 0x58, 0x5C, 0x80, 0x90, 0x94, 0x98, 0x9C
TXBC, TXFQS, TXBRP, TXBAR, TXBCR, TXBTO, TXBCF, TXBTIE, TXBCIE, TXEFS, TXEFA, CKDIV = (
    0xC0, 0xC4, 0xC8, 0xCC, 0xD0, 0xD4, 0xD8, 0xDC, 0xE0, 0xE4, 0xE8, 0x100)

# CCCR.
INIT, CCE, ASM, MON, DAR, TEST, FDOE, BRSE = 1, 2, 4, 1 << 5, 1 << 6, 1 << 7, 1 << 8, 1 << 9
# IR.
RF0N, RF0F, RF0L, TC, TCF, TFE, MRAF, ELO, EP, EW, BO, PEA = (
    1 << bit for bit in (0, 1, 2, 7, 8, 9, 14, 16, 17, 18, 19, 23))

# "FDCAN message RAM": words of a controller, and where its parts begin.
WORDS = 212
FILTERS, FIFO, BUFFERS, ELEMENT, PLACES = 0x00 // 4, 0xB0 // 4, 0x278 // 4, 18, 3
INTERRUPT = 21


class Fdcan(Registers):
    NAME = "FDCAN1"
    RESET = {at: 0 for at in range(0, 0x104, 4)} | {
        0x00: 0x3214_1218,
        0x04: 0x8765_4321,
        DBTP: 0x0000_0A33,
        CCCR: INIT,
        NBTP: 0x0600_0A03,
        PSR: 0x0000_0707,
        0x88: 0,
        TXFQS: 3,
    }

    def __init__(self, chip, wire):
        super().__init__(chip)
        self.memory = [0] * WORDS
        self.wire = wire
        wire.controller = self
        self.clear()

    def clear(self):
        self.pending, self.cancelled = {}, set()
        self.sending = None
        self.fifo = []
        self.put = 0
        self.tec = self.rec = 0
        self.off = False
        self.recovery = None
        self.stamps = {}

    def reset(self):
        super().reset()
        self.chip.clock.drop(self.recovery)
        self.clear()

    def powered_up(self):
        """Words of the memory are not cleared by a reset."""

    def clocked(self):
        if not self.chip.rcc.enabled(0x58, 25):
            raise ManualError("FDCAN has no clock (RCC_APB1ENR1)")

    def joins(self):
        """It takes part in what happens on the wire."""
        return not self.word[CCCR] & INIT and not self.off

    # Sending.

    def offer(self):
        """The frame it wants to send: the smallest identifier, of equal ones the lowest place ("Tx queue")."""
        if not self.joins() or self.word[CCCR] & (ASM | MON) or not self.pending:
            return None
        return min(self.pending.items(), key=lambda one: (one[1].id, one[0]))[1]

    def begun(self, frame):
        self.sending = frame

    def place_of(self, frame):
        return next((place for place, one in self.pending.items() if one is frame), None)

    def sent(self, frame):
        self.sending = None
        place = self.place_of(frame)
        if place is None:
            return
        del self.pending[place]
        bit = 1 << place
        self.word[TXBTO] |= bit
        if self.tec:
            self.tec -= 1
        if place in self.cancelled:
            self.cancelled.discard(place)
            self.finish_cancel(bit)
        if self.word[TXBTIE] & bit:
            self.word[IR] |= TC
        if not self.pending:
            self.word[IR] |= TFE
        self.tell()

    def failed(self, frame):
        """An error while it sends: eight more ("Error handling"; ISO 11898-1, rule c)."""
        self.sending = None
        before = self.tec
        # Nobody acknowledges: an error passive sender is not counted any further; a short circuit is a bit error.
        self.tec += 8
        if before < 96 <= self.tec:
            self.word[IR] |= EW
        if before < 128 <= self.tec:
            self.word[IR] |= EP
        place = self.place_of(frame)
        if place in self.cancelled:
            self.cancelled.discard(place)
            del self.pending[place]
            self.finish_cancel(1 << place)
        if self.tec > 255:
            # "Bus-off": INIT is set by the hardware.
            self.off = True
            self.word[CCCR] |= INIT
            self.word[IR] |= BO
        self.tell()

    def finish_cancel(self, bit):
        self.word[TXBCF] |= bit
        if self.word[TXBCIE] & bit:
            self.word[IR] |= TCF

    def request(self, places):
        for place in range(PLACES):
            bit = 1 << place
            if not places & bit:
                continue
            if place in self.pending:
                raise ManualError("a place is filled whose frame has not been sent")
            if self.word[CCCR] & CCE:
                continue
            at = BUFFERS + place * ELEMENT
            first, second = self.memory[at], self.memory[at + 1]
            if first & 3 << 29:
                raise ManualError("an extended or remote frame is sent")
            code, fd = second >> 16 & 15, bool(second & 1 << 21)
            if fd:
                self.may_send_fd(second)
            elif code > 8:
                raise ManualError("a classical frame of more than eight bytes is sent")
            data = b"".join(word.to_bytes(4, "little") for word in self.memory[at + 2:at + ELEMENT])[:LENGTHS[code]]
            self.pending[place] = Frame(first >> 18 & 0x7FF, data, of=self, fd=fd)
            self.word[TXBTO] &= ~bit
            self.word[TXBCF] &= ~bit
        self.wire.kick()

    def may_send_fd(self, second):
        """What a frame of CAN FD with the rate of its data needs ("Tx buffer element": FDF, BRS; CCCR, DBTP, TDCR)."""
        if self.word[CCCR] & (FDOE | BRSE) != FDOE | BRSE or not second & 1 << 20:
            raise ManualError("a frame of CAN FD is sent without FDOE, BRSE or BRS")
        prescaler, before = (self.word[DBTP] >> 16 & 31) + 1, (self.word[DBTP] >> 8 & 31) + 1
        if not self.word[DBTP] & 1 << 23 or prescaler > 2:
            raise ManualError("the delay of the transceiver is not measured (DBTP.TDC)")
        if self.word[TDCR] >> 8 & 127 != prescaler * (1 + before):
            raise ManualError("a bit is not looked at where it is sampled (TDCR.TDCO)")

    def cancel(self, places):
        for place in range(PLACES):
            if not places & 1 << place or place not in self.pending:
                continue
            if self.pending[place] is self.sending:
                self.cancelled.add(place)
            else:
                del self.pending[place]
                self.finish_cancel(1 << place)
        self.tell()

    # Receiving.

    def hears(self, frame):
        """It begins: its stamp is taken here ("Timestamp generation": TSS = 10 is TIM3)."""
        if self.word[TSCC] & 3 == 2:
            self.stamps[id(frame)] = self.chip.tim3.count() & 0xFFFF

    def accepts(self, identifier):
        """Standard filters, then what is told of the rest (RXGFC.ANFS: 00 FIFO 0, 01 FIFO 1, else none)."""
        size = self.word[RXGFC] >> 16 & 31
        for number in range(size):
            word = self.memory[FILTERS + number]
            kind, what, one, two = word >> 30, word >> 27 & 7, word >> 16 & 0x7FF, word & 0x7FF
            if what == 0:
                continue
            hit = {0: one <= identifier <= two, 1: identifier in (one, two), 2: identifier & two == one & two}.get(kind)
            if hit:
                return {1: 0, 2: 1}.get(what)
        return {0: 0, 1: 1}.get(self.word[RXGFC] >> 4 & 3)

    def heard(self, frame):
        stamp = self.stamps.pop(id(frame), 0)
        if not self.joins():
            return
        if self.rec:
            self.rec -= 1
        fifo = self.accepts(frame.id)
        if fifo is None:
            return
        if fifo == 1:
            raise ManualError("a frame for FIFO 1, which nobody reads")
        if len(self.fifo) == PLACES:
            if self.word[RXGFC] & 1 << 9:
                raise ManualError("FIFO 0 in overwrite mode is not modelled")
            self.word[IR] |= RF0L
            self.tell()
            return
        if frame.fd and not self.word[CCCR] & FDOE:
            raise ManualError("a classical controller destroys a frame of CAN FD")
        at = FIFO + self.put * ELEMENT
        self.memory[at] = frame.id << 18
        # ANMF: no filter has matched. FDF and BRS as they came.
        self.memory[at + 1] = 1 << 31 | (3 << 20) * frame.fd | LENGTHS.index(len(frame.data)) << 16 | stamp
        padded = frame.data.ljust(64, b"\0")
        for word in range(16):
            self.memory[at + 2 + word] = int.from_bytes(padded[4 * word:4 * word + 4], "little")
        self.fifo.append(self.put)
        self.put = (self.put + 1) % PLACES
        self.word[IR] |= RF0N | (RF0F if len(self.fifo) == PLACES else 0)
        self.tell()

    # Trouble.

    def memory_fails(self):
        """The message memory does not answer in time: restricted mode ("Restricted operation mode")."""
        self.word[CCCR] |= ASM
        self.word[IR] |= MRAF
        self.tell()

    def recovered(self):
        """129 times eleven recessive bits are counted where there are any."""
        self.recovery = None
        if self.wire.shorted:
            self.recover()
            return
        self.off = False
        self.tec = self.rec = 0
        self.wire.kick()

    def recover(self):
        self.chip.clock.drop(self.recovery)
        self.recovery = self.chip.clock.after(129 * 11 * self.wire.bit, self.recovered)

    # Registers.

    def tell(self):
        lines = self.word[IR] & self.word[IE]
        if lines and self.word[ILS]:
            raise ManualError("interrupts of line 1, which nobody serves")
        self.chip.nvic.level(INTERRUPT, bool(lines and self.word[ILE] & 1))

    def read(self, at):
        self.clocked()
        at = self.offset(at)
        if at == CCCR:
            self.chip.spend(8)
        elif at == PSR:
            # ACT: bits 4:3, EP 5, EW 6, BO 7.
            state = self.word[PSR] & ~0xF8 | (1 if self.joins() else 0) << 3
            state |= (self.tec > 127) << 5 | (self.tec >= 96) << 6 | self.off << 7
            return state
        elif at == ECR:
            return min(self.tec, 255) | self.rec << 8
        elif at == TXBRP:
            return sum(1 << place for place in self.pending)
        elif at == TXFQS:
            free = [place for place in range(PLACES) if place not in self.pending]
            return free[0] << 16 if free else 1 << 21
        elif at == RXF0S:
            get = self.fifo[0] if self.fifo else self.put
            return len(self.fifo) | get << 8 | self.put << 16 | (len(self.fifo) == PLACES) << 24
        elif at == TSCV:
            return self.chip.tim3.count()
        return self.word[at]

    def write(self, at, value):
        self.clocked()
        at = self.offset(at)
        if at == CCCR:
            self.control(value)
        elif at in (NBTP, DBTP, TDCR, TSCC, RXGFC, TXBC, CKDIV):
            # "Protected": CCE and INIT have to be set.
            if self.word[CCCR] & 3 != 3:
                raise ManualError(f"register {at:#x} of FDCAN is written while it is protected")
            self.word[at] = value
            if at == NBTP:
                self.timed(value)
            elif at == DBTP:
                self.data_timed(value)
        elif at == IR:
            self.word[IR] &= ~value
            self.tell()
        elif at in (IE, ILE, ILS):
            self.word[at] = value
            self.tell()
        elif at == TXBAR:
            self.request(value)
        elif at == TXBCR:
            self.cancel(value)
        elif at == RXF0A:
            if value & 7 in self.fifo:
                count = self.fifo.index(value & 7) + 1
                del self.fifo[:count]
                if self.wire.instant:
                    self.wire.kick()
        elif at in (RXF0S, TXBRP, TXFQS, TXBTO, TXBCF, PSR, ECR):
            pass
        else:
            self.word[at] = value

    def bit(self, prescaler, before, after):
        """Steps of a bit on the wire, from the clock that the controller really has."""
        return prescaler * (1 + before + after) * US / self.chip.rcc.fdcan_mhz()

    def timed(self, value):
        """NBTP: the bit's length."""
        steps = self.bit((value >> 16 & 0x1FF) + 1, (value >> 8 & 0xFF) + 1, (value & 0x7F) + 1)
        if steps != int(steps):
            raise ManualError(f"a bit of {steps} steps")
        self.wire.bit = int(steps)

    def data_timed(self, value):
        """DBTP: the same of the data."""
        after = (value >> 4 & 15) + 1
        if (value & 15) + 1 > after:
            raise ManualError("a receiver shifts by more than what follows the sample point (DBTP.DSJW)")
        self.wire.data_bit = self.bit((value >> 16 & 31) + 1, (value >> 8 & 31) + 1, after)

    def control(self, value):
        before = self.word[CCCR]
        if value & (TEST | MON | DAR):
            raise ManualError("a mode of FDCAN that the model does not have (CCCR)")
        # "Protected": FDOE and BRSE.
        if (value ^ before) & (FDOE | BRSE) and before & 3 != 3:
            raise ManualError("CAN FD is switched while it is protected (CCCR)")
        if value & CCE and not before & INIT:
            value &= ~CCE
        # ASM is set by the host only while CCE and INIT are; it can be reset at any time ("FDCAN CC control register").
        if value & ASM and not before & ASM and before & 3 != 3:
            value &= ~ASM
        if not value & INIT:
            value &= ~CCE
        self.word[CCCR] = value & 0xFFFF
        if value & CCE and not before & CCE:
            # "CCE": these registers are reset as it is set.
            self.pending, self.cancelled, self.fifo, self.put = {}, set(), [], 0
            self.word[TXBTO] = self.word[TXBCF] = 0
        if before & INIT and not value & INIT:
            if self.off:
                # "Bus-off recovery".
                self.recover()
            else:
                self.wire.kick()
        self.tell()
