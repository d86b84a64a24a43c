"""Inputs with a few changes: bytes, texts, YAML, values of messages."""

from __future__ import annotations

import math
import random
import re
import struct
from collections.abc import Mapping, Sequence
from typing import Any, Final

HUGE: Final = 100_000
"""Characters of a text that is too long for anything."""
LAUGHS: Final = "[&l0 [x, x], " + ", ".join(f"&l{n} [{', '.join([f'*l{n - 1}'] * 9)}]" for n in range(1, 12)) + "]"
"""A billion values in a few words: lists of lists that are the same."""
VALUES: Final = (
    *("", "~", "null", "true", "false", "on", "off", "0", "-0", "-1", "1", "2", "0.5", "-0.0", "1e-320", "1e308"),
    *("1e999", ".nan", ".inf", "-.inf", "nan", "inf", "-inf", "NaN", "Infinity", "9" * 30, "-" + "9" * 400, "1" * 5000),
    *("255", "256", "65536", "2147483648", "-2147483649", "4294967296", "9223372036854775808", "18446744073709551616"),
    *("0x10", "0x_", "0b_", "0o8", "010", "1_000", "1:30", "1:99:99", "12.", ".5", "+.", "1e", "--1", "٣", "²"),
    *("[]", "{}", "[1, 2]", "[[1]]", "{a: 1}", "[" * 50, "[" * 3000, "{" * 50, "]", "}", "'text'"),
    *('"\\0"', '"\\uD800"', "'", '"', "-1e308", "!!null x", "<<", "? a", "\x7f", "\x1b[31m"),
    *("2001-13-45", "2001-01-01", "!!binary x", "!!int x", "!!int 1.5", "!!float x", "!!bool x", "!!timestamp x"),
    *("!!python/object:os.system x", "!!set {a}", "!!omap [1]", "!!pairs [1]", "!foo x", "&a [*a]", "*a", "&b 1"),
    *("|\n  x", ">", "%TAG", "---", "...", "- a", "#", ",", ":", "=", "é", "\u2028", "\ufeff", "\x00"),
    *(LAUGHS, "x", "y", "X", "S", "channel", "plc", "..", "/", "../../etc/passwd", "/dev/zero", "x" * 300),
)  # fmt: skip
"""What stands for a value or in the middle of a text."""
WILD: Final[tuple[Any, ...]] = (
    *(None, True, False, 0, 1, -1, 2, 255, 256, -(2**31), 2**32, 2**53 + 1, 2**63, -(2**63) - 1, 2**64, 10**400),
    *(0.0, -0.0, 0.5, -1.5, 5e-324, 1e-300, 1e300, 1.7976931348623157e308, -1e308, math.nan, math.inf, -math.inf),
    *("", "x", "y", "X", "s", "S", "channel", "plc", "cw", "nan", "1", "\x00", "\ud800", "\u2028", "é", "../x.nc"),
    *("/etc/passwd", "x" * HUGE, "[" * 3000, [], {}, [[]], [{}], [1, 2], [None], ["x"], [math.nan] * 3),
    *({"a": 1}, {"": {}}, [0.0] * 1000, [""] * 3),
)  # fmt: skip
"""Values of a message."""
_PAIR = re.compile(r"([A-Za-z_/][\w./\[\]]*)(\s*:\s*)([^,{}\n#]*)")


def deep(depth: int) -> Any:
    """Lists in lists."""
    value: Any = 0
    for _ in range(depth):
        value = [value]
    return value


def mutated_text(
    texts: Sequence[str], draw: random.Random, words: Sequence[str] = VALUES, *, longest: int = 20_000
) -> str:
    """One of the texts with a few changes: pieces of others, words, single characters, repetitions, gaps."""
    text = draw.choice(texts)
    for _ in range(draw.randint(1, 6)):
        at = draw.randint(0, len(text))
        end = min(len(text), at + draw.choice((0, 1, 1, 2, 5, 30)))
        kind = draw.randrange(5)
        if kind == 0:
            piece = draw.choice(words)
        elif kind == 1:
            piece = chr(draw.choice((draw.randrange(32, 127), draw.randrange(256))))
        elif kind == 2:
            other = draw.choice(texts)
            begin = draw.randint(0, len(other))
            piece = other[begin : begin + draw.randint(0, 60)]
        elif kind == 3:
            piece = text[at:end] * draw.choice((0, 2, 3, 50))
        else:
            piece = ""
        text = text[:at] + piece + text[end:]
    return text[:longest]


def mutated_yaml(texts: Sequence[str], draw: random.Random) -> str:
    """One of the texts with other values and keys: deleted, doubled, renamed; now and then as any text."""
    if draw.random() < 0.25:
        return mutated_text(texts, draw)
    text = draw.choice(texts)
    for _ in range(draw.choice((1, 1, 1, 2, 3))):
        pairs = [*_PAIR.finditer(text)]
        if not pairs:
            break
        text = with_other_pair(text, draw.choice(pairs), pairs, draw)
    return text


def with_other_pair(text: str, pair: re.Match[str], pairs: Sequence[re.Match[str]], draw: random.Random) -> str:
    key, colon, value = pair.groups()
    begin, end = pair.span()
    kind = draw.randrange(8)
    if kind < 4:
        value = f"'{'x' * HUGE}'" if draw.random() < 0.01 else draw.choice(VALUES)
    elif kind == 4:
        return text[:begin] + text[end:].lstrip(",")
    elif kind == 5:
        return f"{text[:end]}{draw.choice((', ', chr(10) + ' ' * draw.choice((0, 2, 4, 6))))}{text[begin:]}"
    elif kind == 6:
        key = draw.choice((draw.choice(pairs)[1], key + draw.choice("x0._["), key[1:], key[::-1], key.upper(), ""))
    else:
        value = draw.choice(pairs)[3]
    return f"{text[:begin]}{key}{colon}{value}{text[end:]}"


def mutated_bytes(data: bytes, draw: random.Random, *, others: Sequence[bytes] = ()) -> bytes:
    """Flipped bits, other bytes and numbers, cuts, gaps, repetitions, pieces of others."""
    changed = bytearray(data)
    for _ in range(draw.choice((1, 1, 1, 1, 2, 3, 8))):
        at, kind = draw.randint(0, max(0, len(changed) - 1)), draw.randrange(8)
        size = draw.choice((1, 1, 2, 4, 8, 16, 64))
        if kind < 2 and changed:
            changed[at] ^= 1 << draw.randrange(8)
        elif kind == 2 and changed:
            changed[at] = draw.choice((0, 1, 0x7F, 0x80, 0xFF, draw.randrange(256)))
        elif kind == 3:
            piece = number_bytes(draw)
            changed[at : at + len(piece)] = piece
        elif kind == 4:
            del changed[at:]
        elif kind == 5:
            del changed[at : at + size]
        elif kind == 6:
            changed[at:at] = changed[at : at + size] * draw.choice((1, 2, 10))
        elif others:
            other = draw.choice(others)
            begin = draw.randint(0, len(other))
            changed[at : at + size] = other[begin : begin + size]
    return bytes(changed)


def number_bytes(draw: random.Random) -> bytes:
    """A number at the end of its range."""
    code = draw.choice("IIQQHBdf")
    if code in "df":
        return struct.pack(
            f"<{code}", draw.choice((math.nan, math.inf, -math.inf, 0.0, -1.0, 1e300 if code == "d" else 1e38))
        )
    largest = 256 ** struct.calcsize(code) - 1
    return struct.pack(
        f"<{code}", draw.choice((0, 1, 2, largest, largest // 2, largest // 2 + 1, largest - 7, min(largest, 1 << 28)))
    )


def wild(draw: random.Random) -> Any:
    """A value that a message hardly ever has."""
    return deep(draw.choice((3, 100, 500))) if draw.random() < 0.01 else draw.choice(WILD)


def mutated_message(message: Mapping[str, Any], draw: random.Random, words: Sequence[str] = ()) -> dict[str, Any]:
    """Fields of other values, without some, with others; nested ones too."""
    changed = dict(message)
    for _ in range(draw.choice((1, 1, 2, 3))):
        name = draw.choice([*changed, *words, ""]) if draw.random() < 0.3 else draw.choice([*changed] or [""])
        kind = draw.randrange(6)
        if kind == 0:
            changed.pop(name, None)
        elif kind == 1 and isinstance(changed.get(name), dict):
            changed[name] = mutated_message(changed[name], draw, words)
        elif kind == 2 and changed:
            changed[name] = changed[draw.choice([*changed])]
        else:
            changed[name] = draw.choice(words) if words and draw.random() < 0.2 else wild(draw)
    return changed
