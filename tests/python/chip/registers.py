"""Registers of a part of the chip: words at offsets, with what a reset makes of them."""


class ManualError(AssertionError):
    """The image has done what the manual forbids."""


class Registers:
    """Words that keep what is written; parts of the chip change what has a meaning."""

    # Offset: value after a reset. An offset that is not here does not exist.
    RESET = {}
    NAME = ""

    def __init__(self, chip):
        self.chip = chip
        self.word = dict(self.RESET)

    def reset(self):
        self.word = dict(self.RESET)

    def offset(self, at):
        at &= ~3
        if at not in self.word:
            raise ManualError(f"{self.NAME} has no register at {at:#x}")
        return at

    def read(self, at):
        return self.word[self.offset(at)]

    def write(self, at, value):
        self.word[self.offset(at)] = value

    def peek(self, at):
        """Without the effects of a reading: for a write that is narrower than the word."""
        return self.word[self.offset(at)]


class Plain(Registers):
    """A part that the model does not have: what is written is read, and nothing comes of it."""

    def __init__(self, chip, name, size=0x400):
        self.NAME = name
        self.RESET = {at: 0 for at in range(0, size, 4)}
        super().__init__(chip)
