"""Gives units in the middle of a run other parameters.

A unit keeps some parameters as they are and others as values that its constructor has computed. So units are built with
the old and with the new parameters: what differs between these two comes from parameters, and where a running unit
still has the old value, it gets the new one. What it has computed since (a motion that is planned) stays.
"""

from __future__ import annotations

import enum
import re
from collections.abc import Mapping
from functools import partial
from types import BuiltinMethodType, MethodType
from typing import Any

from cnc_ptp.errors import CncError
from cnc_ptp.machine.runner import UnitRunner
from cnc_ptp.machine.wiring import build_units
from cnc_ptp.parameters import MachineParameters
from cnc_ptp.protocol.unit import PLC
from cnc_ptp.state.decoding import set_attribute
from cnc_ptp.state.roots import PACKAGE, PLAIN, attributes

OTHER_PARTS = 26156


def change_parameters(runners: Mapping[str, UnitRunner], old: MachineParameters, new: MachineParameters) -> None:
    """Raises CncError 26156 when a unit would be built of other parts; then the units are void."""
    if (old.cycle_time_us, old.block_cycles) != (new.cycle_time_us, new.block_cycles):
        reason = "other parameters would give the machine another cycle time or other cycle blocks"
        raise CncError(OTHER_PARTS, reason, "nothing was computed")
    before, after = build_units(old), build_units(new)
    if list(before) != list(after):
        raise CncError(OTHER_PARTS, "other parameters would give the machine other units", "nothing was computed")
    change = ParameterChange()
    for name, runner in runners.items():
        if name != PLC:
            change.change(runner.unit, before[name], after[name], name)


class ParameterChange:
    """Walks a running unit beside one with the old and one with the new parameters."""

    def __init__(self) -> None:
        self._seen: set[int] = set()

    def change(self, here: Any, old: Any, new: Any, place: str) -> None:
        """`here`: an instance, list or dict that the run may have changed."""
        if id(here) in self._seen:
            return
        self._seen.add(id(here))
        if isinstance(old, dict):
            for key in [key for key in old if key in new and key in here]:
                self._part(here[key], old[key], new[key], f"{place}[{key}]", partial(here.__setitem__, key))
        elif isinstance(old, list):
            if len(here) == len(old) == len(new):
                for at, parts in enumerate(zip(list(here), old, new, strict=True)):
                    self._part(*parts, f"{place}[{at}]", partial(here.__setitem__, at))
        else:
            others, mine = dict(attributes(new)), dict(attributes(here))
            for name, value in attributes(old):
                if name in others and name in mine:
                    put = partial(set_attribute, type(here), here, name)
                    self._part(mine[name], value, others[name], f"{place}.{name}", put)

    def _part(self, here: Any, old: Any, new: Any, place: str, put: Any) -> None:
        if old is new or isinstance(old, (MethodType, BuiltinMethodType)):
            return
        if is_changeable(old) or is_changeable(new):
            if type(old) is not type(new):
                unit = re.split(r"[.\[]", place)[0]
                raise CncError(OTHER_PARTS, f"other parameters would give {unit} other parts", "nothing was computed")
            if type(here) is type(old):
                self.change(here, old, new, place)
        elif isinstance(old, tuple) and isinstance(new, tuple) and any(map(is_changeable, old)):
            if len(here) == len(old) == len(new):
                for at, parts in enumerate(zip(here, old, new, strict=True)):
                    self._part(*parts, f"{place}[{at}]", refuse_put(place))
        elif is_value(new) and same(here, old) and not same(old, new):
            put(new)


def refuse_put(place: str) -> Any:
    def put(_value: Any) -> None:
        raise CncError(OTHER_PARTS, f"other parameters would give {place} another kind of part", "nothing was computed")

    return put


def is_frozen(found: Any) -> bool:
    """Parameters and other values: never changed once they are there."""
    parameters = getattr(type(found), "__dataclass_params__", None)
    return isinstance(found, (tuple, enum.Enum, frozenset)) or (parameters is not None and parameters.frozen)


def is_changeable(found: Any) -> bool:
    """A part that has a state of its own."""
    if isinstance(found, (*PLAIN, type)) or is_frozen(found):
        return False
    if type(found).__module__.startswith("cnc_ptp.parameters."):
        return False
    return isinstance(found, (list, dict)) or type(found).__module__.startswith(PACKAGE)


def is_value(found: Any) -> bool:
    """Something that does not lead to a unit."""
    if isinstance(found, partial):
        return all(is_value(part) for part in (*found.args, *found.keywords.values()))
    return not is_changeable(found)


def parts_of(found: partial[Any]) -> tuple[Any, ...]:
    """What decides what it does."""
    return found.func, found.args, tuple(found.keywords.items())


def same(one: Any, other: Any) -> bool:
    """Equal values; floats to the bit."""
    if one is other:
        return True
    if isinstance(one, partial) and isinstance(other, partial):
        return same(parts_of(one), parts_of(other))
    if type(one) is not type(other):
        return False
    if isinstance(one, (tuple, list)):
        return len(one) == len(other) and all(map(same, one, other))
    if isinstance(one, float):
        return bool(one.hex() == other.hex())
    try:
        return bool(one == other)
    except ValueError:  # arrays
        return repr(one) == repr(other)
