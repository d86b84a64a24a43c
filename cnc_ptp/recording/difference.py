"""Two recordings on one time scale, and how far they are apart."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt
import yaml

from cnc_ptp import yaml_text
from cnc_ptp.errors import CncError
from cnc_ptp.protocol.channel_states import IN_PROGRAM
from cnc_ptp.recording.reader import AXIS_STATE, CHANNEL_STATE, SPINDLE_STATE, Recorded
from cnc_ptp.recording.statistics import in_machine_order
from cnc_ptp.recording.units import unit_of
from cnc_ptp.wire.layout import Records

TOO_LONG = 26021
NOT_COMPARABLE = 26022
NOTHING = "nothing was drawn"
LETTERS = ("A", "B")
PROGRAM, START, RUN = "program", "start", "run"
"""What lies on each other: the starts of the programs, of the recordings, or of the runs (cycle 0)."""
COMPARED = {
    CHANNEL_STATE: ("path_velocity", "override_percent"),
    SPINDLE_STATE: ("set_speed_rpm", "actual_speed_rpm", "set_position_deg"),
    AXIS_STATE: ("set_position", "actual_position", "set_velocity", "following_error"),
}


@dataclass(frozen=True, slots=True)
class FieldDifference:
    """A field of a unit in both recordings.

    first, second  largest magnitude in each
    largest        of the difference, and its `cycle`; NaN counts as infinite
    parted         first cycle in which they differ in any bit, -1 without one
    """

    unit: str
    field: str
    first: float
    second: float
    largest: float
    cycle: int
    parted: int


@dataclass(frozen=True, slots=True)
class Compared:
    """Two recordings, A and B, on one time scale, and how far they are apart."""

    pair: tuple[Recorded, Recorded]
    found: list[FieldDifference]

    @property
    def parted(self) -> float | None:
        """When the first set value parts, s; None if none does."""
        cycles = [each.parted for each in self.found if each.field.startswith("set_") and each.parted >= 0]
        return min(cycles) * self._cycle_time if cycles else None

    @property
    def alone(self) -> list[str]:
        """Units that only one of the machines has, which cannot be compared: a sentence for each machine."""
        units = [[topic.removeprefix("/").removesuffix("/state") for topic in each.states] for each in self.pair]
        return [
            f"Only {letter} has {', '.join(own)}."
            for letter, one, other in zip(LETTERS, units, units[::-1], strict=True)
            if (own := [unit for unit in one if unit not in other])
        ]

    def lines(self, units: dict[str, str]) -> list[str]:
        """What there is to say in short; `units`: mm or deg by axis."""
        largest: dict[str, FieldDifference] = {}
        for each in self.found:
            measure = measure_of(each, units)
            if each.largest and (measure not in largest or each.largest > largest[measure].largest):
                largest[measure] = each
        texts = [
            f"{each.largest:.6g} {measure} ({each.unit} {each.field.replace('_', ' ')} at "
            f"{each.cycle * self._cycle_time:.3f} s)"
            for measure, each in largest.items()
        ]
        apart = (
            f"B − A: at most {', '.join(texts)}" if texts else "B − A: no difference in the values that are compared"
        )
        parted = "set values never part" if self.parted is None else f"set values part at {self.parted:.3f} s"
        if not self.found:
            return ["A and B have no cycle in common", *self.alone]
        return [f"{apart}; {parted}", " ".join(self.alone)] if self.alone else [f"{apart}; {parted}"]

    @property
    def _cycle_time(self) -> float:
        return self.pair[0].cycle_time_ns * 1e-9


def compared(first: Recorded, second: Recorded, align: str = PROGRAM) -> Compared:
    """Both as the machine file lists their units; `align`: see `aligned`, whose errors it raises."""
    pair = aligned(in_machine_order(first), in_machine_order(second), align)
    return Compared(pair, list(differences(*pair)))


def aligned(first: Recorded, second: Recorded, align: str = PROGRAM) -> tuple[Recorded, Recorded]:
    """Both with the starts of their programs (or their own ones) in the same cycle; the earlier one is shifted.

    Raises CncError 26021 for a recording that is too long, 26022 for recordings that have nothing in common.
    """
    for recorded in (first, second):
        if recorded.reduced is not None:
            raise CncError(
                TOO_LONG, f"recording {recorded.path}: too long to be compared", f"{NOTHING}, choose --from and --to"
            )
    where = f"recordings {first.path} and {second.path}"
    if first.cycle_time_ns != second.cycle_time_ns:
        times = " and ".join(f"{recorded.cycle_time_ns * 1e-6:g} ms" for recorded in (first, second))
        raise CncError(NOT_COMPARABLE, f"{where}: cycle times of {times}", NOTHING)
    if not first.states.keys() & second.states.keys():
        raise CncError(NOT_COMPARABLE, f"{where}: have no unit in common", NOTHING)
    if align == RUN:
        return first, second
    begins = [program_start(recorded) if align == PROGRAM else first_cycle(recorded) for recorded in (first, second)]
    last = max(begins)
    return shifted(first, last - begins[0]), shifted(second, last - begins[1])


def first_cycle(recorded: Recorded) -> int:
    return min((int(rows["cycle"].min()) for rows in recorded.states.values()), default=0)


def program_start(recorded: Recorded) -> int:
    """The first cycle in which a program was being executed; that of the recording without one."""
    found = [
        int(rows["cycle"][active[0]])
        for rows in recorded.of_type(CHANNEL_STATE).values()
        if len(active := np.flatnonzero(np.isin(rows["state"], IN_PROGRAM)))
    ]
    return min(found, default=first_cycle(recorded))


def shifted(recorded: Recorded, cycles: int) -> Recorded:
    """Everything that many cycles later."""
    if cycles == 0:
        return recorded
    states = {topic: rows.copy() for topic, rows in recorded.states.items()}
    for rows in states.values():
        rows["cycle"] += np.uint64(cycles)
    return replace(
        recorded,
        states=states,
        events=[replace(event, cycle=event.cycle + cycles) for event in recorded.events],
        commands=[replace(command, cycle=command.cycle + cycles) for command in recorded.commands],
    )


def common_cycles(first: Records, second: Records) -> tuple[Records, Records]:
    """The states of the cycles that both have."""
    _, places, others = np.intersect1d(first["cycle"], second["cycle"], return_indices=True)
    return first[places], second[others]


def differences(first: Recorded, second: Recorded) -> Iterator[FieldDifference]:
    """Of all units that both have, the most telling fields; of the cycles that both have."""
    for kind, fields in COMPARED.items():
        others = second.of_type(kind)
        for unit, rows in first.of_type(kind).items():
            if unit not in others:
                continue
            a, b = common_cycles(rows, others[unit])
            for field in fields if len(a) else ():
                yield field_difference(unit, field, a["cycle"], a[field], b[field])


def field_difference(
    unit: str, field: str, cycles: npt.NDArray[Any], first: npt.NDArray[Any], second: npt.NDArray[Any]
) -> FieldDifference:
    """Of the values (n,) at the same `cycles` (n,); n > 0."""
    one, other = (values.astype(np.float64) for values in (first, second))
    change = np.nan_to_num(np.abs(other - one), nan=np.inf)
    apart = np.flatnonzero(one.view(np.uint64) != other.view(np.uint64))
    place = int(apart[change[apart].argmax()]) if len(apart) else 0
    largest = float(change[place]) if len(apart) else 0.0
    parted = int(cycles[apart[0]]) if len(apart) else -1
    size, now = (float(np.abs(values).max()) for values in (one, other))
    return FieldDifference(unit, field, size, now, largest, int(cycles[place]), parted)


def measure_of(difference: FieldDifference, units: dict[str, str]) -> str:
    """The unit of measurement of a field; `units`: mm or deg by axis."""
    return unit_of(difference.field, units.get(difference.unit, "mm"))


def parameter_differences(first: Recorded, second: Recorded) -> list[tuple[str, str, str]]:
    """Parameters of the machine files that differ: name, both values; – where one has none."""
    values = [dict(_flat("", _yaml(recorded.machine_yaml))) for recorded in (first, second)]
    names = dict.fromkeys([*values[0], *values[1]])
    pairs = ((name, *(str(each.get(name, "–")) for each in values)) for name in names)
    return [(name, one, other) for name, one, other in pairs if one != other]


def _yaml(text: str) -> Any:
    try:
        return yaml_text.load(text)
    except yaml.YAMLError:
        return {}


def _flat(name: str, value: Any) -> Iterator[tuple[str, Any]]:
    if isinstance(value, dict):
        for key, inner in value.items():
            part = "" if key == "ros__parameters" else f".{str(key).removeprefix('/')}"
            yield from _flat(f"{name}{part}".removeprefix("."), inner)
    else:
        yield name, value
