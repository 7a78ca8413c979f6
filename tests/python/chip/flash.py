"""FLASH: two banks of double words with error correction (RM0440, "Embedded flash memory (FLASH) for category 3 devices").

A double word is programmed once between two erases, by two writes of 32 bits, the lower one first. A double word in
which the power went cannot be read: ECCD, and the non-maskable interrupt.
"""

from clock import MS, US
from registers import ManualError, Registers

ACR, PDKEYR, KEYR, OPTKEYR, SR, CR, ECCR, OPTR = 0x00, 0x04, 0x08, 0x0C, 0x10, 0x14, 0x18, 0x20
BANK, PAGE, WORD = 256 * 1024, 2048, 8

# SR.
EOP, OPERR, PROGERR, WRPERR, PGAERR, SIZERR, PGSERR, BSY = (1 << bit for bit in (0, 1, 3, 4, 5, 6, 7, 16))
ERRORS = OPERR | PROGERR | WRPERR | PGAERR | SIZERR | PGSERR | 1 << 8 | 1 << 9
# CR.
PG, PER, MER1, BKER, MER2, STRT, OPTSTRT, LOCK = (1 << bit for bit in (0, 1, 2, 11, 15, 16, 17, 31))
# ECCR.
BK_ECC, SYSF_ECC, ECCC, ECCD = 1 << 21, 1 << 22, 1 << 30, 1 << 31
# Datasheet, "Flash memory characteristics": 64 bits in 81.7 µs, a page in 22 ms, typically.
PROGRAM, ERASE = 82 * US, 22 * MS


class PowerCut(Exception):
    """The power goes in the middle of a change."""


class Flash(Registers):
    NAME = "FLASH"
    # OPTR: DBANK (bit 22), nSWBOOT0, IWDG_SW and so on, as delivered.
    RESET = {at: 0 for at in range(0, 0x80, 4)} | {ACR: 0x0004_0600, CR: 0xC000_0000, OPTR: 0xFFEF_F8AA}

    def __init__(self, chip):
        super().__init__(chip)
        self.second = bytearray(b"\xff" * BANK)
        # Double words of the second bank that cannot be read.
        self.torn = set()
        self.keys = []
        self.half = None
        self.busy = None
        # What is told of each change before it happens: (kind, offset, bytes).
        self.watch = None
        self.begun = 0

    def reset(self):
        super().reset()
        self.keys, self.half = [], None
        self.chip.clock.drop(self.busy)
        self.busy = None

    def latency(self):
        return self.word[ACR] & 15

    def needed_wait_states(self, mhz):
        """Table "Number of wait states according to CPU clock (HCLK) frequency"."""
        pwr = self.chip.pwr
        if not pwr.range_1():
            steps = (12, 24, 26)
        elif pwr.boost():
            steps = (34, 68, 102, 136, 170)
        else:
            steps = (30, 60, 90, 120, 150)
        for states, limit in enumerate(steps):
            if mhz <= limit:
                return states
        return 99

    # Registers.

    def read(self, at):
        at = self.offset(at)
        if at == SR and self.busy is not None:
            # Somebody waits: time goes on to whatever happens next.
            self.chip.wait(self.busy[0])
        if at == KEYR:
            return 0
        return self.word[at]

    def write(self, at, value):
        at = self.offset(at)
        if at == ACR:
            # "Data cache reset": it may be reset only while it is off.
            if value & 1 << 12 and self.word[ACR] & 1 << 10:
                raise ManualError("the cache of data is emptied while it is on (FLASH_ACR.DCRST)")
            self.word[at] = value
            self.chip.rcc.check("FLASH_ACR")
        elif at == KEYR:
            self.key(value)
        elif at == SR:
            self.word[SR] &= ~(value & ~BSY)
        elif at == CR:
            self.control(value)
        elif at == ECCR:
            self.word[ECCR] &= ~(value & (ECCC | ECCD)) & ~(1 << 24) | value & 1 << 24
            if not self.word[ECCR] & ECCD:
                self.chip.nvic.nmi(False, "flash")
        elif at == OPTR:
            raise ManualError("option bytes are changed")
        else:
            self.word[at] = value

    def key(self, value):
        self.keys.append(value)
        if self.keys == [0x4567_0123, 0xCDEF_89AB]:
            self.word[CR] &= ~LOCK
            self.keys = []
        elif self.keys != [0x4567_0123]:
            raise ManualError("a wrong key locks the flash until the next reset (FLASH_KEYR)")

    def control(self, value):
        if self.word[CR] & LOCK:
            raise ManualError("FLASH_CR is written while it is locked")
        if self.word[SR] & BSY:
            raise ManualError("FLASH_CR is written while the flash is busy")
        if value & (MER1 | MER2) or not value & BKER and value & PER and value & STRT:
            raise ManualError("the program's own bank is erased")
        self.word[CR] = value & ~STRT
        if not value & PG:
            self.half = None
        if value & STRT:
            if not value & PER:
                raise ManualError("STRT without anything to be done")
            self.erase((value >> 3 & 127) * PAGE)

    def begin(self, took, done):
        if self.word[SR] & ERRORS:
            self.word[SR] |= PGSERR
            return
        if self.word[ACR] & 1 << 10:
            raise ManualError("the flash changes while its cache of data is on (section \"Flash main memory programming\")")
        self.word[SR] |= BSY

        def end():
            self.busy = None
            done()
            self.word[SR] &= ~BSY
        self.busy = self.chip.clock.after(took, end)

    def told(self, kind, offset, data):
        """Where the test wants it so, the power goes here, and what is left of the change is up to it."""
        self.begun += 1
        if self.watch is not None:
            self.watch(kind, offset, data)

    def erase(self, offset):
        self.told("erase", offset, b"")
        self.begin(ERASE, lambda: self.erased(offset))

    def erased(self, offset):
        self.second[offset:offset + PAGE] = b"\xff" * PAGE
        self.torn -= set(range(offset, offset + PAGE, WORD))
        self.chip.cpu.second_changed(offset, PAGE)

    def store(self, offset, size, value):
        """A write into the second bank."""
        if not self.word[CR] & PG or self.word[CR] & LOCK:
            self.word[SR] |= PGSERR
            return
        if self.word[SR] & BSY:
            raise ManualError("a write while the flash is busy")
        if size != 4:
            self.word[SR] |= SIZERR
            return
        if self.half is None:
            if offset % WORD:
                self.word[SR] |= PGAERR
                return
            self.half = (offset, value)
            return
        (first, low), self.half = self.half, None
        if offset != first + 4:
            self.word[SR] |= PGAERR
            return
        data = low.to_bytes(4, "little") + value.to_bytes(4, "little")
        # "Programming errors": a double word that is not erased can be programmed to all zeros, and to nothing else.
        if (first in self.torn or self.second[first:first + WORD] != b"\xff" * WORD) and data != bytes(WORD):
            self.word[SR] |= PROGERR
            return
        self.told("program", first, data)
        self.begin(PROGRAM, lambda: self.programmed(first, data))

    def programmed(self, offset, data):
        self.second[offset:offset + WORD] = data
        self.torn.discard(offset)
        self.chip.cpu.second_changed(offset, WORD)

    def load(self, offset):
        """A reading of 32 bits of the second bank."""
        double = offset & ~7
        if double in self.torn:
            if not self.word[ECCR] & ECCD:
                # ADDR_ECC counts double words ("FLASH ECC register"); the first address counts until it is cleared.
                self.word[ECCR] = self.word[ECCR] & (1 << 24) | ECCD | BK_ECC | double >> 3 & 0x7FFFF
                self.chip.nvic.nmi(True, "flash")
            return 0xDEAD_BEEF
        return int.from_bytes(self.second[offset:offset + 4], "little")
