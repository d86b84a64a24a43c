"""Messages, requests and goals with random fields: such as DDS carries them, whoever has sent them."""

from __future__ import annotations

import importlib
import math
import random
import re
from collections.abc import Mapping, Sequence
from typing import Any

from bench.fuzzing.mutation import HUGE

Texts = Mapping[str, Sequence[str]]
"""What the text fields of a name may have."""

LEFT_OUT = 0.35
"""Share of fields that keep their default."""
SEQUENCE = re.compile(r"sequence<([^,>]+)(?:, (\d+))?>")
ARRAY = re.compile(r"([^\[]+)\[(\d+)\]")
NUMBERS = (0.0, 1.0, 5.0, 10.0, 50.0, 100.0, -1.0, -20.0, 1000.0, 1e-9, math.nan, math.inf, -math.inf)
ANY = ("", "x", "y", "plc", "channel", "nan", "{}", "é\u2028", "\x7f\x1b[31m", "../x", "a b", "x" * 300, "[" * 3000)
JSON = (
    *("", "{}", "[]", "null", "1e999", "NaN", '["a"]', '{"a": 1}', '[{"name": 1}]', "[" * 3000, '{"a": [[1], {}]}'),
    *('{"value": {"$numberDouble": "NaN"}}', '{"value": {"$numberDouble": 1}}', '"\\ud800"', "9" * 400, "{"),
)


def filled(message: Any, draw: random.Random, texts: Texts) -> Any:
    """The message with other values. Most of its lists have the same length."""
    count = draw.choice((0, 1, 1, 2, 2, 3))
    for name, of in message.get_fields_and_field_types().items():
        if draw.random() >= LEFT_OUT:
            setattr(message, name, value(name, of, draw, texts, count))
    return message


def value(name: str, of: str, draw: random.Random, texts: Texts, count: int) -> Any:
    """Of a field of a type."""
    if listed := SEQUENCE.fullmatch(of):
        number = count if draw.random() < 0.8 else draw.choice((0, 1, 5, 5 if "/" in of else 2000))
        number = min(number, int(listed[2] or number))
        return [value(name, listed[1], draw, texts, count) for _ in range(number)]
    if listed := ARRAY.fullmatch(of):
        return [value(name, listed[1], draw, texts, count) for _ in range(int(listed[2]))]
    if "/" in of:
        package, _, kind = of.partition("/")
        return filled(getattr(importlib.import_module(f"{package}.msg"), kind)(), draw, texts)
    if of.startswith("string"):
        return text(name, draw, texts)
    if of == "boolean":
        return draw.random() < 0.6
    if of == "octet":
        return bytes([draw.randrange(256)])
    if of in ("double", "float"):
        return draw.choice((*NUMBERS, draw.uniform(-100.0, 100.0), 1e300 if of == "double" else 1e38))
    return integer(of, draw)


def integer(of: str, draw: random.Random) -> int:
    bits, signed = int(of.removeprefix("u").removeprefix("int")), of.startswith("int")
    largest = 2 ** (bits - signed) - 1
    ends = (largest, largest - 1, -largest - 1 if signed else 0, -1 if signed else 0)
    return draw.choice((0, 1, 2, 3, draw.randrange(1, 40), min(largest, 1000), *ends))


def text(name: str, draw: random.Random, texts: Texts) -> str:
    if draw.random() < 0.005:
        return "x" * HUGE
    if name.endswith("_json"):
        return draw.choice(JSON)
    return draw.choice(texts[name] if name in texts and draw.random() < 0.85 else ANY)
