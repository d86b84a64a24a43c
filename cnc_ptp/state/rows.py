"""The forms of the rows of a state (encoding.py), which are checked before anything is made of them."""

from __future__ import annotations

from typing import Any, Final

from cnc_ptp.state.faults import damaged
from cnc_ptp.state.made_again import AGAIN

VALUE, ROW = "value", "row"
"""A part that is a value, one that is [number of a row]."""
VALUES, PAIRS = "values", "pairs"
"""What follows: values, keys with values."""
HEADS: Final[dict[str, tuple[Any, ...]]] = {
    "o": (int, VALUES),
    "t": (VALUES,),
    "l": (VALUES,),
    "s": (VALUES,),
    "f": (VALUES,),
    "q": ((int, type(None)), VALUES),
    "d": (PAIRS,),
    "D": (VALUE, PAIRS),
    "n": (str, VALUES),
    "e": (str, str),
    "a": (str, list, str),
    "b": (str,),
    "m": (VALUE, str),
    "p": (VALUE, VALUE, ROW),
    "i": (VALUES,),
    "N": (str,),
    "c": ((int, float), VALUES),
    "E": (str, VALUE, ROW),
    "g": (list,),
    "F": (str, str),
    "R": (str, VALUES),
    "L": (VALUE, list),
    "x": (str,),
    "T": (str, str, ROW),
}
"""The parts of a row by its letter."""
FORMS: Final = {
    letter: (head[:-1], head[-1]) if head[-1] in (VALUES, PAIRS) else (head, None) for letter, head in HEADS.items()
}
"""The parts that each row has, and what follows."""
PLAIN: Final = frozenset((type(None), bool, int, float, str))
PLAIN_OR_ROW: Final = PLAIN | {list}


def require_lists(rows: Any, shapes: Any) -> None:
    """Raises CncError 26151."""
    if not isinstance(rows, list) or not isinstance(shapes, list):
        raise damaged("it has no lists of rows and shapes")


def check_rows(rows: Any, shapes: Any) -> None:
    """Raises CncError 26151 for the first row or shape that no encoder makes."""
    require_lists(rows, shapes)
    for shape in shapes:
        if not is_shape(shape):
            raise damaged(f"a shape is {shape!r:.60}")
    lengths = [len(shape[1]) for shape in shapes]
    for number, row in enumerate(rows):
        if not is_row(row, len(rows), lengths):
            raise damaged(f"row {number} has no form: {row!r:.60}")


def is_shape(shape: Any) -> bool:
    """Class and names of attributes."""
    if not isinstance(shape, list) or len(shape) != 2 or not isinstance(shape[1], list):
        return False
    return all(isinstance(name, str) for name in (shape[0], *shape[1]))


def is_row(row: Any, count: int, lengths: list[int]) -> bool:
    """`count` of rows; `lengths`: numbers of attributes of the shapes."""
    if not isinstance(row, list) or not row or not isinstance(row[0], str) or row[0] not in HEADS:
        return False
    fixed, rest = FORMS[row[0]]
    begin = 1 + len(fixed)
    if len(row) < begin or (rest is None and len(row) > begin):
        return False
    if not all(is_part(part, kind, count) for part, kind in zip(row[1:begin], fixed, strict=True)):
        return False
    others = row[begin:]
    if not are_values(others, count) or (rest is PAIRS and len(others) % 2):
        return False
    if row[0] == "o":
        return 0 <= row[1] < len(lengths) and len(others) == lengths[row[1]]
    return row[0] != "R" or row[1] in AGAIN


def are_values(parts: list[Any], count: int) -> bool:
    """By their types at once: there are tens of thousands of rows, and most lead to no other one."""
    kinds = {*map(type, parts)}
    if kinds <= PLAIN:
        return True
    if not kinds <= PLAIN_OR_ROW:
        return False
    rows = [part for part in parts if type(part) is list]
    return all(len(row) == 1 and type(row[0]) is int and 0 <= row[0] < count for row in rows)


def is_part(part: Any, kind: Any, count: int) -> bool:
    """Whether a part is of a kind of HEADS."""
    if kind in (VALUE, ROW):
        return (kind is VALUE or isinstance(part, list)) and are_values([part], count)
    return isinstance(part, kind)
