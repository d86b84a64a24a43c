"""A parameter that varies: found in the machine, each of its values checked against its declaration."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass

from cnc_ptp.errors import CncError
from cnc_ptp.parameters import MachineParameters, ParameterError, load_machine
from cnc_ptp.parameters.changed import ChosenParameter, choose_parameter
from cnc_ptp.parameters.declare.declarations import Declaration, ParameterValue
from cnc_ptp.parameters.errors import CONTRADICTION
from cnc_ptp.parameters.loader import Changes
from cnc_ptp.parameters.read.parameter_set import parameter_limits
from cnc_ptp.parameters.read.values import BadValue
from cnc_ptp.sweep.faults import BAD_PARAMETER, BAD_VARIATION, NOTHING
from cnc_ptp.sweep.spread import Interval, Scalar, Spread, Values, read_spread


@dataclass(frozen=True, slots=True)
class Variation:
    """A parameter of a unit and how it varies. `text`: the spread as it was given."""

    parameter: ChosenParameter
    text: str
    spread: Spread

    @property
    def unit(self) -> str:
        return self.parameter.unit

    @property
    def ros_name(self) -> str:
        return self.parameter.ros_name

    @property
    def subject(self) -> str:
        return self.parameter.subject

    @property
    def declaration(self) -> Declaration:
        return self.parameter.declaration

    @property
    def name(self) -> str:
        return f"{self.unit}.{self.ros_name}"

    @property
    def whole(self) -> bool:
        """The parameter has whole numbers only."""
        return self.declaration.type == "int"

    def of(self, number: float) -> float | int:
        """A number that was computed, as the parameter can have it."""
        return round(number) if self.whole else float(number)

    def checked(self, value: Scalar) -> ParameterValue:
        """A value in the type of the parameter. Raises CncError 26178 beyond its limits."""
        try:
            return self.parameter.checked(value)
        except BadValue as error:
            raise CncError(BAD_PARAMETER, f"{self.subject}: {error.text}", NOTHING, where="--vary") from None

    def values(self) -> tuple[ParameterValue, ...]:
        """Of a spread that is values; each of them differs."""
        assert isinstance(self.spread, Values)
        number = self.of if self.spread.stepped else None
        found = tuple(self.checked(number(value) if number else value) for value in self.spread.values)  # type: ignore[arg-type]
        twice = [value for value, count in Counter(map(repr, found)).items() if count > 1]
        if twice:
            reason = f"{self.subject}: range '{self.text}' has {twice[0]} more than once"
            raise CncError(BAD_VARIATION, reason, NOTHING, where="--vary")
        return found

    def extremes(self) -> list[ParameterValue]:
        """The outermost values, of a normal distribution its mean."""
        spread = self.spread
        if isinstance(spread, Values):
            values = self.values()
            numbers = [value for value in values if isinstance(value, (int, float))]
            return [min(numbers), max(numbers)] if len(numbers) == len(values) else list(values)
        if isinstance(spread, Interval):
            return [self.checked(self.of(number)) for number in (spread.low, spread.high)]
        return [self.checked(self.of(spread.mean))]


def keys_of(variations: Iterable[Variation]) -> tuple[tuple[str, str], ...]:
    """Unit and parameter of each."""
    return tuple((variation.unit, variation.ros_name) for variation in variations)


def changes_of(names: Sequence[tuple[str, str]], values: Iterable[ParameterValue]) -> Changes:
    """Values by unit and parameter, as load_machine takes them; `names` (unit, parameter) in the order of `values`."""
    changes: dict[str, dict[str, ParameterValue]] = {}
    for (unit, parameter), value in zip(names, values, strict=True):
        changes.setdefault(unit, {})[parameter] = value
    return changes


def read_variations(texts: Sequence[str], machine: MachineParameters) -> list[Variation]:
    """The variations that `unit.parameter=range` describe. Raises CncError 26177 and 26178."""
    found = [read_variation(text, machine) for text in texts]
    if not found:
        raise CncError(BAD_VARIATION, "there is nothing to vary: unit.parameter=range", NOTHING, where="--vary")
    for name, count in Counter(variation.name for variation in found).items():
        if count > 1:
            raise CncError(BAD_VARIATION, f"{name} varies {count} times", NOTHING, where="--vary")
    return found


def read_variation(text: str, machine: MachineParameters) -> Variation:
    name, equals, spread = text.partition("=")
    try:
        found = choose_parameter(name, machine) if equals else None
    except CncError as error:
        raise CncError(BAD_PARAMETER, error.reason, NOTHING, where="--vary") from None
    if found is None:
        reason = f"'{text}' is not of the form unit.parameter=range, as x.getriebe.0.kv=2000:8000:13"
        raise CncError(BAD_VARIATION, reason, NOTHING, where="--vary")
    return Variation(found, spread.strip(), read_spread(spread.strip()))


def check_variations(variations: Sequence[Variation], text: str, file: str) -> None:
    """Checks the outermost values of each before anything runs. Raises CncError 26177, 26178.

    A limit that is another parameter counts as the machine file has it, unless that varies as well; what else
    contradicts each other shows when the variant runs.
    """
    for variation in variations:
        extremes = variation.extremes()
        if limits_are_fixed(variation, variations):
            for value in extremes:
                check_alone(variation, value, text, file)


def limits_are_fixed(variation: Variation, variations: Sequence[Variation]) -> bool:
    """Some limit of the parameter is another one, and none of these varies."""
    limits = {str(limit.value) for limit, _ in parameter_limits(variation.declaration)}
    varying = {other.declaration.id for other in variations if other.unit == variation.unit}
    return bool(limits) and not limits & varying


def check_alone(variation: Variation, value: ParameterValue, text: str, file: str) -> None:
    """Raises CncError 26178 for a value beyond a limit that is another parameter."""
    try:
        load_machine(text, file, changes={variation.unit: {variation.ros_name: value}})
    except ParameterError as error:
        for problem in error.problems:
            if problem.error_id == CONTRADICTION and problem.text.startswith(variation.subject):
                raise CncError(BAD_PARAMETER, problem.text, NOTHING, where="--vary") from None


def outermost_machines(variations: Sequence[Variation], text: str, file: str) -> Iterator[MachineParameters]:
    """With the least of all values, and with the largest, as far as they are possible together."""
    for place in (0, -1):
        changes = changes_of(keys_of(variations), [variation.extremes()[place] for variation in variations])
        with suppress(ParameterError):
            yield load_machine(text, file, changes=changes)
