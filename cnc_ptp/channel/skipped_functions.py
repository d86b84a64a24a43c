"""The functions of blocks that are not executed: what is left of them when the program begins behind these blocks.

Of each group the last one counts: of the functions of a spindle, of T, D and H, of M functions that exclude each other.
M06 changes to the T before it, so that these two stay together; a later T selects the next tool.
They are output in their order in the program, so that synchronisation and couplings are as they would have been.
"""

from __future__ import annotations

from typing import Final, NamedTuple

from cnc_ptp.nc.canonical import (
    AuxiliaryFunction,
    AxisFeedforward,
    CanonicalBlock,
    CompensationSwitch,
    CuttingSpeed,
    Function,
    GearChange,
    MachineData,
    SpindleCommand,
    SpindleFeedforward,
    SpindleFunction,
    SpindleLink,
)

Group = tuple[str, str, str]
M_GROUPS: Final = {10: "clamp", 11: "clamp"}
"""M functions that exclude each other (DIN 66025-2); every other one is a group of its own."""
TOOL_CHANGE: Final = 6
COOLANT_OFF: Final = 9
COOLANT: Final = (7, 8)
"""Mist and flood may both be on; M09 switches both off."""
TURNING: Final = (3, 4)


class Kept(NamedTuple):
    """A function, and its block by its number among those that are skipped."""

    number: int
    block: CanonicalBlock
    function: Function


class SkippedFunctions:
    """Collects functions; `blocks` are the blocks that output what is left."""

    def __init__(self) -> None:
        self._kept: dict[Group, Kept] = {}
        self._number = 0

    def add(self, block: CanonicalBlock) -> None:
        """The functions of the next block that is skipped."""
        self._number += 1
        for function in block.functions:
            group = group_of(function)
            if group is None:
                continue
            if isinstance(function, AuxiliaryFunction) and function.letter == "M":
                self._before_m(function)
            before = self._kept.pop(group, None)
            merged = function if before is None else combined(before.function, function)
            self._kept[group] = Kept(self._number, block, merged)

    def _before_m(self, function: AuxiliaryFunction) -> None:
        """What M06 and M09 do to the functions before them."""
        spindle = function.spindle
        if function.number == COOLANT_OFF:
            for number in COOLANT:
                self._kept.pop((f"M{number}", spindle, ""), None)
        if function.number == TOOL_CHANGE:
            selected = self._kept.pop(("T", "", ""), None)
            if selected is not None:
                self._kept.pop(("changed", spindle, ""), None)
                self._kept["changed", spindle, ""] = selected

    def blocks(self) -> list[CanonicalBlock]:
        """One for each skipped block of which something is left, without motion."""
        numbers = sorted({kept.number for kept in self._kept.values()})
        of_block = [[kept for kept in self._kept.values() if kept.number == number] for number in numbers]
        return [
            CanonicalBlock(first.block.source, tuple([kept.function for kept in of]), None, "", calls=first.block.calls)
            for of in of_block
            for first in of[:1]
        ]


def group_of(function: Function) -> Group | None:
    """Functions of one group replace each other; None for what has no effect on later blocks."""
    if isinstance(function, AuxiliaryFunction):
        kind = function.letter
        if kind == "M":
            kind = M_GROUPS.get(function.number, f"M{function.number}")
        return kind, function.spindle, ""
    if isinstance(function, SpindleFunction):
        return "function", function.spindle, ""
    if isinstance(function, SpindleCommand):
        return "command", function.spindle, function.command
    if isinstance(function, GearChange):
        return "gear", function.spindle, ""
    if isinstance(function, CuttingSpeed):
        return "cutting speed", function.spindle, ""
    if isinstance(function, SpindleLink):
        return "link", function.slave, ""
    if isinstance(function, AxisFeedforward):
        return "feedforward", "", ""
    if isinstance(function, SpindleFeedforward):
        return "feedforward", function.spindle, ""
    if isinstance(function, CompensationSwitch):
        return "compensation", function.axis, " ".join(function.kinds)
    if isinstance(function, MachineData):
        return "machine data", function.axis, function.parameter
    return None


def combined(before: Function, function: Function) -> Function:
    """What two functions of one group amount to."""
    if isinstance(before, SpindleFunction) and isinstance(function, SpindleFunction):
        return _of_spindle(before, function)
    if isinstance(before, AxisFeedforward) and isinstance(function, AxisFeedforward):
        on = before.on if function.on is None else function.on
        return AxisFeedforward(on, tuple({**dict(before.weights), **dict(function.weights)}.items()))
    if isinstance(before, SpindleFeedforward) and isinstance(function, SpindleFeedforward):
        on = before.on if function.on is None else function.on
        weight = before.weight if function.weight is None else function.weight
        return SpindleFeedforward(function.spindle, on, weight)
    return function


def _of_spindle(before: SpindleFunction, function: SpindleFunction) -> SpindleFunction:
    """A speed alone changes a rotation; behind M05 and M19 it only counts for the next M03, which has it anyway."""
    if function.m is not None or before.m is None:
        return function
    if before.m in TURNING and function.speed_rpm is not None:
        before = before._replace(speed_rpm=function.speed_rpm)
    return before._replace(full_override=function.full_override)
