"""All parameters of one node: values of the file, defaults for the rest, with names, units and places."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

from cnc_ptp.parameters import list_units
from cnc_ptp.parameters.declare import ids
from cnc_ptp.parameters.declare.declarations import (
    Array,
    Catalogue,
    Declaration,
    Limit,
    Number,
    ParameterValue,
    catalogue,
    split_indexes,
)
from cnc_ptp.parameters.errors import Place

AXIS_TYPES = {"ACHSTYP_TRANSLATOR": "T", "ACHSTYP_ROTATOR": "R", "ACHSTYP_SPINDEL": "S"}


class Given(NamedTuple):
    """A value that the machine file gives, already checked."""

    value: ParameterValue
    place: Place


class Parameter(NamedTuple):
    """One parameter of a node with its value."""

    declaration: Declaration
    indexes: tuple[int, ...]
    value: ParameterValue

    @property
    def ros_name(self) -> str:
        return self.declaration.ros_name(self.indexes)


@dataclass(frozen=True)
class ParameterSet:
    """The parameters of the node `/node`. `kind` is machine, channel, axis or spindle.

    `given` has the values of the file by ROS name; `implied` those that follow from the rest of the file and replace a
    default (logical numbers, type of spindles); `invalid` the names whose value was refused.
    """

    node: str
    kind: str
    place: Place
    given: Mapping[str, Given] = field(default_factory=dict)
    implied: Mapping[str, ParameterValue] = field(default_factory=dict)
    invalid: frozenset[str] = frozenset()

    @property
    def catalogue(self) -> Catalogue:
        return catalogue()

    @property
    def axis_type(self) -> str:
        """T, R or S; empty for machine and channels."""
        if self.kind not in ("axis", "spindle"):
            return ""
        return AXIS_TYPES[str(self.value(ids.KENNGR_ACHS_TYP))]

    def value(self, number: str, *indexes: int) -> ParameterValue:
        """Value in the type and unit of the list: the given one, else the default.

        The limits that the file gives apply to a default too: with vb_max at 100000 that of vb_eilgang is 100000.
        """
        declaration = self.catalogue.by_id[number]
        name = declaration.ros_name(indexes)
        if name in self.given:
            return self.given[name].value
        if name in self.implied:
            return self.implied[name]
        default = declaration.default
        for limit in (*declaration.lower, *declaration.upper):
            if isinstance(limit.value, str) and limit.inclusive and not isinstance(default, (str, tuple)):
                bound = self.number(limit.value, *indexes)
                default = max(default, bound) if limit in declaration.lower else min(default, bound)
        return default

    def number(self, number: str, *indexes: int) -> Number:
        """Value of an int or float parameter in list units; indexes that the parameter does not have are ignored."""
        value = self.value(number, *indexes[: self.catalogue.by_id[number].index_count])
        if isinstance(value, (str, tuple)):
            raise TypeError(f"{number} is no number")
        return value

    def kernel(self, number: str, *indexes: int) -> float:
        """Value of an int or float parameter in kernel units (mm, °, s, ratios)."""
        return list_units.to_kernel(self.number(number, *indexes), self.unit(number))

    def percent(self, number: str) -> float:
        """Value in 0.1 % as percent."""
        return self.number(number) / 10

    def text(self, number: str, *indexes: int) -> str:
        return str(self.value(number, *indexes))

    def names(self, number: str) -> tuple[str, ...]:
        """Value of a list of names."""
        value = self.value(number)
        return value if isinstance(value, tuple) else ()

    def is_given(self, number: str, *indexes: int) -> bool:
        return self.catalogue.by_id[number].ros_name(indexes) in self.given

    def is_invalid(self, number: str, *indexes: int) -> bool:
        return self.catalogue.by_id[number].ros_name(indexes) in self.invalid

    def unit(self, number: str) -> str:
        return self.catalogue.by_id[number].unit_for(self.axis_type)

    def where(self, number: str, *indexes: int) -> Place:
        """Place of a given value, otherwise that of the section."""
        given = self.given.get(self.catalogue.by_id[number].ros_name(indexes))
        return given.place if given else self.place

    def used_indexes(self, array: str) -> list[int]:
        """Elements of an array of which the file gives anything; `array` is spindel, gruppe.0.achse …"""
        return self._used.get(array, [])

    @cached_property
    def _used(self) -> dict[str, list[int]]:
        """The elements of each array of which the file gives anything."""
        found: dict[str, set[int]] = {}
        for name in (*self.given, *self.invalid):
            segments = name.split(".")
            for place, segment in enumerate(segments):
                if segment.isascii() and segment.isdecimal():
                    found.setdefault(".".join(segments[:place]), set()).add(int(segment))
        return {array: sorted(indexes) for array, indexes in found.items()}

    def parameters(self) -> Iterator[Parameter]:
        """Every parameter that the node has, for each array element in use, in the order of the declarations."""
        letter = self.axis_type
        for declaration in self.catalogue.of_node(self.kind):
            if letter and letter not in declaration.axes:
                continue
            for indexes in self.elements(declaration.key, self.catalogue.sizes(declaration)):
                yield Parameter(declaration, indexes, self.value(declaration.id, *indexes))

    def elements(self, key: str, arrays: tuple[Array, ...]) -> Iterator[tuple[int, ...]]:
        if not arrays:
            yield ()
            return
        array, _, rest = key.partition(".*")
        for index in sorted({*self.used_indexes(array), *range(arrays[0].always)}):
            inner = f"{array}.{index}{rest}"
            yield from ((index, *others) for others in self.elements(inner, arrays[1:]))

    def find(self, ros_name: str) -> Parameter:
        """The parameter with a ROS name; KeyError if the node has none."""
        key, indexes = split_indexes(ros_name)
        declaration = self.catalogue.by_key[self.kind][key]
        return Parameter(declaration, indexes, self.value(declaration.id, *indexes))


def parameter_limits(declaration: Declaration) -> Iterator[tuple[Limit, bool]]:
    """The limits that are other parameters; True for upper ones."""
    yield from ((limit, False) for limit in declaration.lower if isinstance(limit.value, str))
    yield from ((limit, True) for limit in declaration.upper if isinstance(limit.value, str))
