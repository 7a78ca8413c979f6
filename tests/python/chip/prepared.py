"""A flash in which the board has other parameters than the built-in ones."""

from board import Board
from talk import Ear, Sdo

_MADE = {}


def prepared(params):
    """A flash with the parameters: a board without drives takes them as well."""
    if params in _MADE:
        return _MADE[params]
    board = Board()
    ear = Ear(board)
    board.power_up()
    board.run_ticks(20)
    sdo = Sdo(board, ear)
    for text in params:
        number, value = text.split("=")
        number, _, bit = number.partition(".")
        index, value = 0x2000 + int(number), int(value)
        there = sdo.read(index, 0)
        if bit:
            # The bits of a number are one object.
            others = int.from_bytes(there, "little") & ~(1 << int(bit))
            value = others | value << int(bit)
        sdo.write(index, 0, value.to_bytes(len(there), "little"))
        for _ in range(400):
            if sdo.number(0x5010, 2) == 2:
                break
            board.run_ticks(2)
        board.run_ticks(20)
    _MADE[params] = bytes(board.flash.second)
    return _MADE[params]
