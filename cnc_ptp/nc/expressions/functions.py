"""Functions of expressions by name. Angles are in degrees, positions in a text count from 1.

A function of numbers gives NaN where it is not defined.
"""

import math
from collections.abc import Callable, Sequence
from typing import Final, NamedTuple

from cnc_ptp.nc.canonical import number
from cnc_ptp.nc.degrees import cosine, sine
from cnc_ptp.nc.expressions.nodes import TRUTH
from cnc_ptp.nc.expressions.values import Scalar

NAN: Final = math.nan
ANY: Final = 99
"""Number of arguments without a limit."""


def tangent(degrees: float) -> float:
    below = cosine(degrees)
    return NAN if below == 0.0 else 1.0 if math.fmod(degrees, 180.0) == 45.0 else sine(degrees) / below


def cotangent(degrees: float) -> float:
    below = sine(degrees)
    return NAN if below == 0.0 else cosine(degrees) / below


def arc_sine(value: float) -> float:
    return math.degrees(math.asin(value)) if -1.0 <= value <= 1.0 else NAN


def arc_cosine(value: float) -> float:
    return math.degrees(math.acos(value)) if -1.0 <= value <= 1.0 else NAN


def arc_cotangent(value: float) -> float:
    """0° ... 180°."""
    return 90.0 - math.degrees(math.atan(value))


def arc_tangent_2(y: float, x: float) -> float:
    """Angle of the point (x, y), -180° ... 180°."""
    return NAN if x == 0.0 and y == 0.0 else math.degrees(math.atan2(y, x))


def square_root(value: float) -> float:
    return math.sqrt(value) if value >= 0.0 else NAN


def exponential(value: float) -> float:
    return math.exp(value) if value < 710.0 else math.inf


def power_of_ten(value: float) -> float:
    return math.pow(10.0, value) if value < 308.3 else math.inf


def natural_logarithm(value: float) -> float:
    return math.log(value) if value > 0.0 else NAN


def decimal_logarithm(value: float) -> float:
    return math.log10(value) if value > 0.0 else NAN


def rounded(value: float) -> float:
    """To the nearest integer, half away from 0."""
    return math.copysign(math.floor(abs(value) + 0.5), value) if abs(value) < 2.0**52 else value


def sign(value: float) -> float:
    return 1.0 if value > 0.0 else -1.0 if value < 0.0 else 0.0


def inverted(value: float) -> float:
    """All bits of an integer."""
    return float(~int(value)) if value == math.floor(value) and abs(value) < 2.0**53 else NAN


class Function(NamedTuple):
    """A function of numbers: fewest and most arguments, what it does with the list of them."""

    fewest: int
    most: int
    operation: Callable[[Sequence[float]], float]
    text: str
    """For the reference: syntax and meaning."""


NUMERIC: Final[dict[str, Function]] = {
    "ABS": Function(1, 1, lambda a: abs(a[0]), "ABS[x]: absolute value"),
    "SIGN": Function(1, 1, lambda a: sign(a[0]), "SIGN[x]: -1, 0 or 1"),
    "SQR": Function(1, 1, lambda a: a[0] * a[0], "SQR[x]: square"),
    "SQRT": Function(1, 1, lambda a: square_root(a[0]), "SQRT[x]: square root, x >= 0"),
    "EXP": Function(1, 1, lambda a: exponential(a[0]), "EXP[x]: e to the power of x"),
    "DEXP": Function(1, 1, lambda a: power_of_ten(a[0]), "DEXP[x]: 10 to the power of x"),
    "LN": Function(1, 1, lambda a: natural_logarithm(a[0]), "LN[x]: natural logarithm, x > 0"),
    "LOG": Function(1, 1, lambda a: decimal_logarithm(a[0]), "LOG[x]: logarithm to base 10, x > 0"),
    "SIN": Function(1, 1, lambda a: sine(a[0]), "SIN[a]: sine of an angle in degrees"),
    "COS": Function(1, 1, lambda a: cosine(a[0]), "COS[a]: cosine"),
    "TAN": Function(1, 1, lambda a: tangent(a[0]), "TAN[a]: tangent, not at 90° and 270°"),
    "COT": Function(1, 1, lambda a: cotangent(a[0]), "COT[a]: cotangent, not at 0° and 180°"),
    "ASIN": Function(1, 1, lambda a: arc_sine(a[0]), "ASIN[x]: angle in degrees, -90 ... 90"),
    "ACOS": Function(1, 1, lambda a: arc_cosine(a[0]), "ACOS[x]: angle in degrees, 0 ... 180"),
    "ATAN": Function(1, 1, lambda a: math.degrees(math.atan(a[0])), "ATAN[x]: angle in degrees, -90 ... 90"),
    "ACOT": Function(1, 1, lambda a: arc_cotangent(a[0]), "ACOT[x]: angle in degrees, 0 ... 180"),
    "ATAN2": Function(2, 2, lambda a: arc_tangent_2(a[0], a[1]), "ATAN2[y, x]: angle in degrees, -180 ... 180"),
    "INT": Function(1, 1, lambda a: float(math.trunc(a[0])), "INT[x]: without its decimals"),
    "FRACT": Function(1, 1, lambda a: a[0] - math.trunc(a[0]), "FRACT[x], FRAC[x]: its decimals"),
    "ROUND": Function(1, 1, lambda a: rounded(a[0]), "ROUND[x]: nearest integer, half away from 0"),
    "FLOOR": Function(1, 1, lambda a: float(math.floor(a[0])), "FLOOR[x]: next integer below"),
    "CEIL": Function(1, 1, lambda a: float(math.ceil(a[0])), "CEIL[x]: next integer above"),
    "MIN": Function(1, ANY, lambda a: min(a), "MIN[a, b ...]: the smallest"),
    "MAX": Function(1, ANY, lambda a: max(a), "MAX[a, b ...]: the largest"),
    "NOT": Function(1, 1, lambda a: 1.0 if abs(a[0]) < TRUTH else 0.0, "NOT[x]: TRUE if x is FALSE"),
    "INV": Function(1, 1, lambda a: inverted(a[0]), "INV[n]: all bits of an integer inverted"),
}
NUMERIC["FRAC"] = NUMERIC["FRACT"]

CONSTANTS: Final = {"TRUE": 1.0, "FALSE": 0.0, "PI": math.pi}


class TextFunction(NamedTuple):
    """A function of texts: the kinds of its arguments (t text, n number; ? before one that may be missing)."""

    kinds: str
    gives_text: bool
    operation: Callable[[Sequence[Scalar]], Scalar]
    """Gives NaN where it is not defined."""
    text: str


def _text(value: Scalar) -> str:
    assert isinstance(value, str)
    return value


def _count(value: Scalar) -> int:
    """A length or a position; a text never gets here."""
    assert isinstance(value, float)
    return max(0, int(value))


def _middle(a: Sequence[Scalar]) -> Scalar:
    begin = _count(a[2]) - 1
    return _text(a[0])[begin : begin + _count(a[1])] if begin >= 0 else NAN


def _inserted(a: Sequence[Scalar]) -> Scalar:
    text, place = _text(a[0]), _count(a[2])
    return text[:place] + _text(a[1]) + text[place:]


def _deleted(a: Sequence[Scalar]) -> Scalar:
    text, begin = _text(a[0]), _count(a[2]) - 1
    return text[:begin] + text[begin + _count(a[1]) :] if begin >= 0 else NAN


def _replaced(a: Sequence[Scalar]) -> Scalar:
    text, begin = _text(a[0]), _count(a[3]) - 1
    return text[:begin] + _text(a[1]) + text[begin + _count(a[2]) :] if begin >= 0 else NAN


def _code(a: Sequence[Scalar]) -> Scalar:
    text, place = _text(a[0]), _count(a[1]) if len(a) > 1 else 1
    return float(ord(text[place - 1])) if 1 <= place <= len(text) else NAN


def _character(a: Sequence[Scalar]) -> Scalar:
    code = _count(a[0])
    return chr(code) if 32 <= code < 127 else NAN


def _right(a: Sequence[Scalar]) -> Scalar:
    text, count = _text(a[0]), _count(a[1])
    return text[-count:] if count else ""


def _read(a: Sequence[Scalar]) -> Scalar:
    try:
        value = float(_text(a[0]))
    except ValueError:
        return NAN
    return value if math.isfinite(value) else NAN


TEXTUAL: Final[dict[str, TextFunction]] = {
    "LEN": TextFunction("t", False, lambda a: float(len(_text(a[0]))), "LEN[text]: number of characters"),
    "LEFT": TextFunction("tn", True, lambda a: _text(a[0])[: _count(a[1])], "LEFT[text, n]: its first n characters"),
    "RIGHT": TextFunction("tn", True, _right, "RIGHT[text, n]: its last n characters"),
    "MID": TextFunction("tnn", True, _middle, "MID[text, n, place]: n characters from a place"),
    "FIND": TextFunction("tt", False, lambda a: 1.0 + _text(a[0]).find(_text(a[1])), "FIND[text, part]: place, or 0"),
    "ORD": TextFunction("t?n", False, _code, "ORD[text, place]: code of a character"),
    "CHR": TextFunction("n", True, _character, "CHR[n]: character of a code, 32 ... 126"),
    "INSERT": TextFunction("ttn", True, _inserted, "INSERT[text, part, place]: part behind a place"),
    "DELETE": TextFunction("tnn", True, _deleted, "DELETE[text, n, place]: without n characters from a place"),
    "REPLACE": TextFunction("ttnn", True, _replaced, "REPLACE[text, part, n, place]: part in place of n characters"),
    "INT_TO_STR": TextFunction("n", True, lambda a: number(rounded(_number(a[0]))), "INT_TO_STR[n]: as a text"),
    "REAL_TO_STR": TextFunction("n", True, lambda a: number(_number(a[0])), "REAL_TO_STR[x]: as a text"),
    "STR_TO_INT": TextFunction("t", False, lambda a: rounded(_number(_read(a))), "STR_TO_INT[text]: as an integer"),
    "STR_TO_REAL": TextFunction("t", False, _read, "STR_TO_REAL[text]: as a number"),
}


def _number(value: Scalar) -> float:
    assert isinstance(value, float)
    return value
