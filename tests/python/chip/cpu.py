"""The processor: Unicorn runs the instructions; exceptions come and go as ARMv7-M has them (B1.5.6 "Exception entry
behavior", B1.5.8 "Exception return behavior").

An interrupt is taken between two pieces of code that Unicorn translates at once, which is a few instructions late at most;
where a test names the instruction, right before it. Instructions take no time, but accesses to registers do, and sleep.
"""

import unicorn
from unicorn import arm_const as arm

FLASH, SECOND, RAM, RAM_SIZE = 0x0800_0000, 0x0804_0000, 0x2000_0000, 128 * 1024
# The second half of the second bank is looked at word by word. Before it lies code, and what is as empty as it reads.
BANK, WATCHED = 256 * 1024, 128 * 1024
KEPT = BANK - WATCHED
SYSTEM = 0x1FFF_7000
PERIPHERALS = (
    (0x4000_0000, 0x30000), (0x4800_0000, 0x2000), (0xE000_E000, 0x1000), (0xE004_2000, 0x1000), (0xE000_1000, 0x1000))
# What a handler returns to.
TRAP = 0x1FFE_0000
LOWEST = 256
CPSIE, WFI = 0xB662, 0xBF30
# Instructions without a sleep or a wait that are too many.
PATIENCE = 50_000_000
# Registers whose reading does something: the captures of TIM2 and TIM5.
ONCE = {timer + at for timer in (0x4000_0000, 0x4000_0C00) for at in (0x34, 0x38, 0x3C, 0x40)}
FRAME = (arm.UC_ARM_REG_R0, arm.UC_ARM_REG_R1, arm.UC_ARM_REG_R2, arm.UC_ARM_REG_R3, arm.UC_ARM_REG_R12, arm.UC_ARM_REG_LR)


def plain_store(code):
    """Bytes of a store that changes no register; 0: it is another one (ARMv7-M, A7.7 "STR", "STRB", "STRH")."""
    half = int.from_bytes(code[:2], "little")
    immediate = half >> 13 == 0b011 and not half & 1 << 11 or half >> 11 in (0b10000, 0b10010)
    if immediate or half >> 9 in (0b0101000, 0b0101001, 0b0101010):
        return 2
    if half & 0xFF90 == 0xF880:
        return 4
    is_offset = int.from_bytes(code[2:4], "little") & 0x0FC0 == 0 or int.from_bytes(code[2:4], "little") & 0x0F00 == 0x0C00
    return 4 if half & 0xFF90 == 0xF800 and is_offset else 0


class Locked(AssertionError):
    """A fault in the handler of faults."""


class Cpu:
    def __init__(self, chip, code):
        self.chip = chip
        uc = self.uc = unicorn.Uc(unicorn.UC_ARCH_ARM, unicorn.UC_MODE_THUMB | unicorn.UC_MODE_MCLASS)
        uc.ctl_set_cpu_model(arm.UC_CPU_ARM_CORTEX_M4)
        uc.mem_map(FLASH, BANK + KEPT, unicorn.UC_PROT_READ | unicorn.UC_PROT_EXEC)
        uc.mem_write(FLASH, bytes(code))
        uc.mmio_map(SECOND + KEPT, WATCHED, self.load_kept, None, self.store_kept, None)
        uc.mem_map(RAM, RAM_SIZE)
        uc.mem_map(TRAP, 0x1000)
        uc.mem_map(SYSTEM, 0x1000, unicorn.UC_PROT_READ)
        for base, size in PERIPHERALS:
            uc.mmio_map(base, size, self.load, base, self.store, base)
        self.active = []
        self.poked = self.asleep = self.watched = False
        self.failure = None
        # Instructions without a sleep after which time goes on; 0: it does not.
        self.slice = 0
        self.insert_hooks(code)
        uc.hook_add(unicorn.UC_HOOK_BLOCK, self.fetches_second, None, SECOND, SECOND + KEPT - 1)

    def fetches_second(self, uc, address, size, _):
        """"Read while write": an instruction of the bank that changes makes the processor wait until the change is over."""
        if self.chip.flash.busy is not None:
            self.fail(AssertionError(f"{address:#x} is run from the second bank while it changes"))

    def insert_hooks(self, code):
        """Where interrupts are let in again, one that waits is taken at once."""
        self.unmasking = []
        for at in range(0, len(code) - 3, 2):
            half = int.from_bytes(code[at:at + 2], "little")
            is_msr = half & 0xFFF0 == 0xF380 and int.from_bytes(code[at + 2:at + 4], "little") == 0x8810
            if half == CPSIE or is_msr:
                address = FLASH + at
                self.uc.hook_add(unicorn.UC_HOOK_CODE, self.unmasks, (half, is_msr), address, address)

    def count_time(self, counts):
        """Instructions take time as well, a cycle for each four bytes: no less than they do."""
        if not counts:
            self.uc.hook_del(self.counter)
            self.uc.ctl_flush_tb()
            return

        def block(uc, address, size, _):
            self.chip.clock.now += (size >> 2) * self.chip.cycle
        self.counter = self.uc.hook_add(unicorn.UC_HOOK_BLOCK, block)

    def each(self, what):
        """Calls `what` with address and first half of every instruction from now on; where it says so, interrupts that
        wait come before that instruction."""
        image = self.chip.image.code

        def code(uc, address, size, _):
            if not self.watched:
                return
            at = address - FLASH
            if what(address, image[at] | image[at + 1] << 8) and self.is_interrupted():
                self.jump = address
                uc.emu_stop()
        self.uc.hook_add(unicorn.UC_HOOK_CODE, code, None, FLASH, FLASH + len(image) - 1)
        self.uc.ctl_flush_tb()

    def unmasks(self, uc, address, size, what):
        half, is_msr = what
        if not self.chip.nvic.wakes():
            return
        if is_msr:
            registers = (arm.UC_ARM_REG_R0, arm.UC_ARM_REG_R1, arm.UC_ARM_REG_R2, arm.UC_ARM_REG_R3, arm.UC_ARM_REG_R4,
                         arm.UC_ARM_REG_R5, arm.UC_ARM_REG_R6, arm.UC_ARM_REG_R7, arm.UC_ARM_REG_R8, arm.UC_ARM_REG_R9,
                         arm.UC_ARM_REG_R10, arm.UC_ARM_REG_R11, arm.UC_ARM_REG_R12)
            mask = uc.reg_read(registers[half & 15]) & 1
        else:
            mask = 0
        if mask == 0 and uc.reg_read(arm.UC_ARM_REG_PRIMASK) & 1:
            # It is carried out here, so that what waits comes right after it.
            uc.reg_write(arm.UC_ARM_REG_PRIMASK, 0)
            self.jump = address + (4 if is_msr else 2)
            self.poked = True
            uc.emu_stop()

    # Registers.

    def load(self, uc, offset, size, base):
        try:
            value = self.chip.load(base + offset, size)
        except BaseException as error:
            self.fail(error)
            return 0
        if self.poked and base + offset not in ONCE and self.is_interrupted():
            # Unicorn stops before the reading is done: it is done again when the interrupt is over.
            uc.emu_stop()
        elif self.chip.deadline is not None and self.chip.clock.now >= self.chip.deadline and base + offset not in ONCE:
            # As far as the test wants it to run, though it waits for something.
            self.poked = True
            uc.emu_stop()
        return value

    def store(self, uc, offset, size, value, base):
        try:
            self.chip.store(base + offset, size, value)
        except BaseException as error:
            self.fail(error)
            return
        if self.poked and self.is_interrupted():
            pc = uc.reg_read(arm.UC_ARM_REG_PC)
            length = plain_store(uc.mem_read(pc, 4))
            if length:
                # Unicorn stops in front of the instruction whose write has just been done: it goes on after that.
                self.stored = (pc, pc + length)
                uc.emu_stop()

    def is_interrupted(self):
        """Something has its turn now. With each instruction counted, the processor is where Unicorn says it is."""
        if self.chip.resets or self.chip.nvic.next(self.priority(), self.masked()) is not None:
            return True
        # It waits: what lets it in looks by itself.
        self.poked = False
        return False

    def load_kept(self, uc, offset, size, _):
        try:
            word = self.chip.flash.load(KEPT + offset & ~3)
            return word >> 8 * (offset & 3) & (1 << 8 * size) - 1
        except BaseException as error:
            self.fail(error)
            return 0

    def store_kept(self, uc, offset, size, value, _):
        try:
            self.chip.flash.store(KEPT + offset, size, value)
        except BaseException as error:
            self.fail(error)

    def second_changed(self, offset, size):
        """Code and what lies before the pages that are looked at stay what they are."""
        if offset < KEPT:
            raise AssertionError("the image keeps something where the model does not look")

    def fail(self, error):
        if self.failure is None:
            self.failure = error
        self.uc.emu_stop()

    def poke(self):
        """Somebody wants to interrupt: at the next access to a register, sleep, or instruction that lets interrupts in."""
        self.poked = True

    # Exceptions.

    def number(self):
        return self.active[-1][0] if self.active else 0

    def priority(self):
        return min((one[1] for one in self.active), default=LOWEST)

    def masked(self):
        return self.uc.reg_read(arm.UC_ARM_REG_PRIMASK) & 1 != 0

    def enter(self, number, priority, pc):
        uc = self.uc
        context = uc.context_save()
        sp = uc.reg_read(arm.UC_ARM_REG_SP)
        aligned = (sp - 32) & ~7
        xpsr = uc.reg_read(arm.UC_ARM_REG_XPSR) & ~(1 << 9) | (1 << 9 if (sp - 32) & 4 else 0)
        words = [uc.reg_read(register) for register in FRAME] + [pc & ~1, xpsr]
        frame = b"".join(word.to_bytes(4, "little") for word in words)
        try:
            uc.mem_write(aligned, frame)
        except unicorn.UcError:
            # A fault while the registers are put on the stack: the handler of faults gets a stack that has ended.
            if number == 3 and self.number() == 3:
                raise Locked("two faults") from None
            number, priority = 3, -1
        self.active.append((number, priority, context, aligned))
        self.chip.nvic.taken(number)
        uc.reg_write(arm.UC_ARM_REG_SP, aligned)
        uc.reg_write(arm.UC_ARM_REG_LR, TRAP | 1)
        vector = FLASH + 4 * number
        return int.from_bytes(uc.mem_read(vector, 4), "little") & ~1

    def leave(self):
        uc = self.uc
        number, _, context, aligned = self.active.pop()
        if uc.reg_read(arm.UC_ARM_REG_SP) != aligned:
            raise AssertionError(f"exception {number} returns with another stack than it began with")
        # Written by the handler: the interrupted code goes on from what is on the stack.
        frame = uc.mem_read(aligned, 32)
        masked = uc.reg_read(arm.UC_ARM_REG_PRIMASK)
        uc.context_restore(context)
        for place, register in enumerate(FRAME):
            uc.reg_write(register, int.from_bytes(frame[4 * place:4 * place + 4], "little"))
        uc.reg_write(arm.UC_ARM_REG_PRIMASK, masked)
        self.chip.nvic.left(number)
        return int.from_bytes(frame[24:28], "little")

    def reset(self):
        uc = self.uc
        self.active, self.poked, self.failure = [], False, None
        uc.reg_write(arm.UC_ARM_REG_PRIMASK, 0)
        uc.reg_write(arm.UC_ARM_REG_SP, int.from_bytes(uc.mem_read(FLASH, 4), "little"))
        uc.reg_write(arm.UC_ARM_REG_LR, 0xFFFF_FFFF)
        self.pc = int.from_bytes(uc.mem_read(FLASH + 4, 4), "little") & ~1

    def hang(self):
        """What runs now gets no further: an instruction that branches to itself, in memory that is not used."""
        self.uc.mem_write(TRAP + 0x100, b"\xfe\xe7")
        self.pc = TRAP + 0x100
        # Time goes on meanwhile.
        self.slice = 1000

    def run(self, until):
        """Runs until `until()` is true; it is asked whenever the processor sleeps or is interrupted."""
        uc, nvic = self.uc, self.chip.nvic
        while not until():
            if self.chip.resets:
                self.chip.restart()
                continue
            turn = nvic.next(self.priority(), self.masked())
            if turn is not None:
                self.pc = self.enter(*turn, self.pc)
            self.step()
        return True

    def step(self):
        """Up to the next sleep, return or interruption."""
        uc, chip = self.uc, self.chip
        self.poked, self.jump, self.stored = False, None, None
        try:
            uc.emu_start(self.pc | 1, TRAP, count=self.slice or PATIENCE)
        except unicorn.UcError as error:
            if self.failure is None:
                self.pc = self.fault(error)
                return
        if self.failure is not None:
            failure, self.failure = self.failure, None
            raise failure
        self.pc = self.jump if self.jump is not None else uc.reg_read(arm.UC_ARM_REG_PC)
        if self.stored is not None and self.pc == self.stored[0]:
            self.pc = self.stored[1]
        elif self.pc == TRAP:
            self.pc = self.leave()
        elif self.jump is None and not chip.resets:
            if int.from_bytes(uc.mem_read(self.pc - 2, 2), "little") == WFI:
                while not chip.nvic.wakes() and not chip.resets:
                    due = chip.clock.next()
                    if due is not None and due <= chip.clock.now:
                        chip.clock.until(chip.clock.now)
                        continue
                    if chip.limit is not None and chip.clock.now >= chip.limit:
                        # The sleep goes on: it is gone to again.
                        self.pc -= 2
                        self.asleep = True
                        return
                    if not chip.clock.leap():
                        raise AssertionError("the processor sleeps, and nothing ever wakes it")
            elif self.slice:
                chip.clock.advance(self.slice * chip.cycle)
            elif not self.poked:
                raise AssertionError(f"no end of it at {self.pc:#x}")

    def fault(self, error):
        """What cannot be carried out is a fault (B1.5.14 "Fault behavior"; the image has no other handler of them)."""
        pc = self.uc.reg_read(arm.UC_ARM_REG_PC)
        if self.priority() <= -1:
            raise Locked(f"{error} at {pc:#x} in a handler of faults") from None
        self.faulted = (pc, str(error))
        return self.enter(3, -1, pc)
