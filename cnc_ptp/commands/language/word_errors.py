"""Which errors a word may have: errors.yaml, iso_errors.yaml, and the texts from the lists of faults."""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Final

from cnc_ptp import yaml_text
from cnc_ptp.nc import c_axis_faults, faults, spindle_faults, thread_faults, turning_faults
from cnc_ptp.nc.coordinates import coordinate_faults
from cnc_ptp.nc.expressions import expression_faults
from cnc_ptp.nc.expressions.readable import READABLE
from cnc_ptp.nc.faults import Fault
from cnc_ptp.nc.flow import flow_faults
from cnc_ptp.nc.iso import iso_faults
from cnc_ptp.nc.radius import radius_faults
from cnc_ptp.nc.tools import tool_faults

PARTS: Final = (
    *(faults, flow_faults, expression_faults, coordinate_faults, spindle_faults, tool_faults),
    *(c_axis_faults, radius_faults, thread_faults, turning_faults),
)
READ_ONLY: Final = expression_faults.NOT_ASSIGNABLE.number


FILES: Final = {"twincat": "errors.yaml", "iso": "iso_errors.yaml"}


@cache
def errors_by_key(dialect: str = "twincat") -> dict[str, tuple[int, ...]]:
    """The list of a vocabulary."""
    loaded = yaml_text.load(Path(__file__).with_name(FILES[dialect]).read_text(encoding="utf-8"))
    return {str(key): tuple(numbers) for key, numbers in loaded.items()}


def errors_of(name: str, kind: str, dialect: str = "twincat") -> list[int]:
    """Numbers of the errors that a word may have besides those of any line and of expressions."""
    listed = errors_by_key(dialect)
    found = {number for key, numbers in listed.items() if name in key.split(", ") for number in numbers}
    found |= set(listed.get(kind, ()))
    assignable = any(reading.write is not None for _, reading in READABLE.get(name, ()))
    return sorted(found - {READ_ONLY} if assignable else found)


def error_texts(dialect: str = "twincat") -> dict[int, str]:
    """By number the text of each fault of a vocabulary, with … for what the program says."""
    parts = PARTS if dialect == "twincat" else (*PARTS, iso_faults)
    texts = {fault.number: re.sub(r"\{[^}]*\}", "…", fault.template) for part in parts for fault in faults_in(part)}
    if dialect == "twincat":
        return texts
    listed = {number for numbers in errors_by_key(dialect).values() for number in numbers}
    return {number: text for number, text in texts.items() if number in listed}


def faults_in(part: ModuleType) -> Iterator[Fault]:
    """The faults of a list, also those in its tables."""
    for value in vars(part).values():
        if isinstance(value, Fault):
            yield value
        elif isinstance(value, dict):
            yield from (fault for fault in value.values() if isinstance(fault, Fault))
