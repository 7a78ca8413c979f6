"""The board: the chip with its image, its crystal, its wire, and somebody who looks at its pins."""

import os

from elftools.elf.elffile import ELFFile

from clock import Clock, MS
from cpu import Cpu, RAM, RAM_SIZE, SYSTEM
from fdcan import Fdcan
from flash import BANK, Flash
from gpio import Port
from nvic import Nvic
from pwr import Pwr
from rcc import BORRSTF, IWDGRSTF, PINRSTF, SFTRSTF, Rcc
from registers import ManualError, Plain
from timers import EdgeClock, Encoder, Handwheel, Timer
from watchdog import Watchdog
from wire import Wire

# Pins with a name on the page about the hardware.
PINS = (("C", 3, "clamp"), ("B", 0, "spindle enable"), ("A", 5, "light"), ("A", 12, "CAN transmit"))
TICK, CAN = 54, 21


class Image:
    """What is flashed, and where its functions are."""

    def __init__(self, path):
        self.code = bytearray(b"\xff" * 2 * BANK)
        self.symbols = {}
        with open(path, "rb") as file:
            elf = ELFFile(file)
            end = 0
            for segment in elf.iter_segments():
                if segment["p_type"] == "PT_LOAD" and segment["p_filesz"]:
                    at = segment["p_paddr"] - 0x0800_0000
                    self.code[at:at + segment["p_filesz"]] = segment.data()
                    end = max(end, at + segment["p_filesz"])
            del self.code[end:]
            for symbol in elf.get_section_by_name(".symtab").iter_symbols():
                if symbol.name:
                    self.symbols[symbol.name] = (symbol["st_value"], symbol["st_size"])

    def find(self, part):
        """(first address, size) of the one function with this in its name."""
        hits = {value for name, value in self.symbols.items() if part in name and value[1]}
        if len(hits) != 1:
            raise AssertionError(f"{len(hits)} functions have {part} in their name")
        address, size = hits.pop()
        return address & ~1, size


_IMAGES = {}


def image():
    """The one that xtask has built."""
    path = os.environ["CHIP_IMAGE"]
    if path not in _IMAGES:
        _IMAGES[path] = Image(path)
    return _IMAGES[path]


class Board:
    def __init__(self, code=None):
        self.image = image()
        self.clock = Clock()
        self.wire = Wire(self.clock)
        self.pwr = Pwr(self)
        self.flash = Flash(self)
        self.rcc = Rcc(self)
        self.nvic = Nvic(self)
        self.fdcan = Fdcan(self, self.wire)
        self.tim1 = Handwheel(self, 1, None, 16)
        self.tim2 = Encoder(self, 2, 0, 32)
        self.tim3 = Timer(self, 3, 1, 16)
        self.tim5 = EdgeClock(self, 5, 3, 32)
        self.tim6 = Timer(self, 6, 4, 16, interrupt=TICK)
        self.watchdog = Watchdog(self)
        self.ports = {letter: Port(self, letter, number) for number, letter in enumerate("ABCDEFG")}
        dbgmcu = Plain(self, "DBGMCU")
        dbgmcu.word[0] = 0x2003_6469
        self.parts = {
            0x4000_0000: self.tim2, 0x4000_0400: self.tim3, 0x4000_0C00: self.tim5, 0x4000_1000: self.tim6,
            0x4000_3000: self.watchdog, 0x4000_6400: self.fdcan, 0x4000_7000: self.pwr,
            0x4001_2C00: self.tim1,
            0x4002_1000: self.rcc, 0x4002_2000: self.flash, 0xE004_2000: dbgmcu,
            # The crate's start switches them on, and the image uses none of them.
            0x4001_0000: Plain(self, "SYSCFG"), 0x4001_0400: Plain(self, "EXTI"),
            0x4002_0000: Plain(self, "DMA1"), 0x4002_0400: Plain(self, "DMA2"), 0x4002_0800: Plain(self, "DMAMUX"),
            0xE000_1000: Plain(self, "DWT", 0x1000),
        }
        for number, letter in enumerate("ABCDEFG"):
            self.parts[0x4800_0000 + 0x400 * number] = self.ports[letter]
        for page in range(0xE000_E000, 0xE000_F000, 0x400):
            self.parts[page] = self.nvic
        # Steps of a cycle of the processor.
        self.cycle = 255
        self.resets = None
        self.limit = self.deadline = None
        self.ticks = 0
        self.on_tick = None
        self.shown = {}
        self.pins = []
        self.starts = []
        # What is against the manual, and lets the program go on.
        self.complaints = []
        self.cpu = Cpu(self, self.image.code if code is None else code)
        # UID, 96 bits ("Unique device ID register").
        self.cpu.uc.mem_write(SYSTEM + 0x590, bytes.fromhex("003A001E3235510A34353738"))
        # Stop and hold are break contacts, and closed while nobody presses them; the clamp is open.
        self.contact("stop", True)
        self.contact("hold", True)

    # Registers.

    def load(self, address, size):
        if 0x4000_A400 <= address < 0x4000_B000:
            self.fdcan.clocked()
            return self.fdcan.memory[(address - 0x4000_A400) // 4]
        part = self.parts.get(address & ~0x3FF)
        if part is None:
            raise ManualError(f"there is nothing at {address:#x} that the model knows")
        self.clock_on()
        offset = address - (0xE000_E000 if part is self.nvic else address & ~0x3FF)
        return part.read(offset & ~3) >> 8 * (offset & 3) & (1 << 8 * size) - 1

    def store(self, address, size, value):
        if 0x4000_A400 <= address < 0x4000_B000:
            self.fdcan.clocked()
            if size != 4:
                raise ManualError("the message memory is written in words alone")
            self.fdcan.memory[(address - 0x4000_A400) // 4] = value
            return
        part = self.parts.get(address & ~0x3FF)
        if part is None:
            raise ManualError(f"there is nothing at {address:#x} that the model knows")
        self.clock_on()
        offset = address - (0xE000_E000 if part is self.nvic else address & ~0x3FF)
        if size < 4:
            shift, mask = 8 * (offset & 3), (1 << 8 * size) - 1
            if part is self.nvic and 0x400 <= offset < 0x500 or isinstance(part, (Plain, Timer)):
                value = part.peek(offset & ~3) & ~(mask << shift) | (value & mask) << shift
            elif shift:
                raise ManualError(f"a part of a word is written at {address:#x}")
        part.write(offset & ~3, value)

    def clock_on(self):
        """An access takes a few cycles of the bus."""
        if not self.wire.instant:
            self.clock.now += 4 * self.cycle
        due = self.clock.next()
        if due is not None and due <= self.clock.now:
            self.clock.until(self.clock.now)

    def spend(self, cycles):
        self.clock.advance(cycles * self.cycle)

    def wait(self, time):
        """Somebody asks again and again: up to what happens next, and no further than that."""
        due = self.clock.next()
        self.clock.until(min(time, due) if due is not None else time)

    def complain(self, what):
        if what not in self.complaints:
            self.complaints.append(what)

    # Time.

    def ticked(self, timer):
        if timer is self.tim6 and timer.word[0x0C] & 1:
            self.ticks += 1
            if self.on_tick is not None:
                self.on_tick()

    def run_until(self, condition):
        self.cpu.run(condition)

    def run_for(self, steps):
        end = self.clock.now + steps
        before, self.limit = self.limit, end
        # The image may wait for something and not sleep.
        self.deadline = end
        self.cpu.run(lambda: self.clock.now >= end)
        self.limit, self.deadline = before, None

    def settle(self):
        """Lets the image do what it can without any time."""
        before, self.limit = self.limit, self.clock.now
        self.cpu.asleep = False
        self.cpu.run(lambda: self.cpu.asleep)
        self.limit = before

    def run_ticks(self, count):
        end = self.ticks + count
        self.cpu.run(lambda: self.ticks >= end)

    # Power and resets.

    def power_up(self, forget=True):
        """The power comes; `forget`: it was away for so long that the memory has forgotten."""
        if forget:
            noise = bytes((n * 197 + 61) & 0xFF for n in range(4096)) * (RAM_SIZE // 4096)
            self.cpu.uc.mem_write(RAM, noise)
            self.fdcan.memory = [0xA5A5_A5A5] * len(self.fdcan.memory)
        self.begin(BORRSTF | PINRSTF, "power")

    def software_reset(self):
        self.resets = (SFTRSTF | PINRSTF, "software")
        self.cpu.poke()

    def press_reset(self):
        self.resets = (PINRSTF, "button")

    def bite(self):
        self.resets = (IWDGRSTF | PINRSTF, "watchdog")
        self.cpu.poke()

    def restart(self):
        (flags, why), self.resets = self.resets, None
        self.begin(flags, why)

    def begin(self, flags, why):
        self.resets = None
        self.wire.power_off()
        timers = (self.tim1, self.tim2, self.tim3, self.tim5, self.tim6)
        for part in (self.pwr, self.flash, self.nvic, self.fdcan, *timers, self.watchdog):
            part.reset()
        for port in self.ports.values():
            port.reset()
        self.rcc.reset(flags)
        self.starts.append((self.ticks, why))
        self.pins_changed()
        self.cpu.reset()

    # Pins.

    def contact(self, name, closed):
        """Contacts close to ground."""
        pin = {"stop": 0, "hold": 1, "clamped": 2} | {f"input {number}": 3 + number for number in range(1, 9)}
        pin = pin[name]
        if closed:
            self.ports["C"].outside[pin] = 0
        else:
            self.ports["C"].outside.pop(pin, None)

    def pins_changed(self):
        for letter, pin, name in PINS:
            level = self.ports[letter].shown(pin)
            if self.shown.get(name) != level:
                self.shown[name] = level
                self.pins.append((self.ticks, name, level))
