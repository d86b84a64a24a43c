"""Everything that decides which machine position a programmed one is, as modal state.

A programmed point goes through, in this order: rotation of the contour in its plane (#ROTATION), scale (#SCALE), mirror
(G21 to G23), offsets (zero offset, G92, #PSET), the coordinate systems from the last one to the first (#CS, then #ACS),
clamp position and tool. Offsets that were on before a coordinate system place it; those programmed in it are its own.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Final, NamedTuple

from cnc_ptp.kinematics.kinematics import Kinematics
from cnc_ptp.nc.coordinates.frame import (
    IDENTITY,
    Frame,
    Matrix,
    diagonal,
    main_axes,
    product,
    rotation_about,
    times,
)

INCH: Final = 25.4
Offsets = tuple[float, ...]
"""One value for each axis of the channel, mm or deg; empty: none."""


class Own(NamedTuple):
    """Offsets of the workpiece or of one coordinate system: zero offset (index 0: G53, 1: G54 ...), G92, #PSET."""

    zero_index: int = 0
    zero: Offsets = ()
    added: Offsets = ()
    preset: Offsets = ()


NO_OFFSETS: Final = Own()


class OffsetChanges(NamedTuple):
    """What programs and commands have changed of the offset tables of the machine; by index of the zero offset.

    values     of all axes
    inactive   places of the axes for which it does not count (G160)
    default    index at program start (V.G.NP_DEFAULT), -1: that of the machine
    """

    values: Mapping[int, Offsets] = {}
    inactive: Mapping[int, frozenset[int]] = {}
    default: int = -1


NO_CHANGES: Final = OffsetChanges()


class System(NamedTuple):
    """A coordinate system that is on: its shift (mm) and rotation, and the offsets that were on before it."""

    command: str
    shift: tuple[float, float, float]
    rotation: Matrix
    before: Own


@dataclass(slots=True)
class Coordinates:
    """The state; `frame` is what it amounts to, None if programmed positions are machine positions.

    unit        mm of one programmed length: 1 (G71) or 25.4 (G70)
    changes     of the offset tables
    turn        angle (deg) and centre of #ROTATION, in the plane that was active
    plane       places of the axes of that plane
    scale       factors by axis; they act while `scaled`
    mirror      -1 for axes that are mirrored, by axis
    systems     coordinate systems that are on, the first one is the outermost
    defined     values of #CS DEF and #ACS DEF by command and number
    clamp, tool offsets of clamp position and tool
    tool_fixed  the offsets of the tool are in machine axes; else they turn with the coordinate systems
    clamp_index number of the clamp position
    limits      software limits of G98 and G99 by place of the axis: negative, positive
    outside     what was there before #MCS ON, None without it
    kinematics  between programmed positions and these of the axes (#FACE, #CYL), behind all of this
    untransformed  the coordinates from before it
    suspended   offset that G92.2 has switched off (vocabulary iso)
    """

    unit: float = 1.0
    changes: OffsetChanges = NO_CHANGES
    own: Own = NO_OFFSETS
    turn: tuple[float, float, float] | None = None
    plane: tuple[int, int] = (0, 1)
    scale: Offsets = ()
    scaled: bool = False
    mirror: Offsets = ()
    systems: tuple[System, ...] = ()
    defined: dict[tuple[str, int], tuple[float, ...]] | None = None
    last_defined: dict[str, int] | None = None
    clamp: Offsets = ()
    tool: Offsets = ()
    tool_fixed: bool = False
    clamp_index: int = 0
    limits: dict[int, tuple[float, float]] | None = None
    outside: "Coordinates | None" = None
    kinematics: Kinematics | None = None
    untransformed: "Coordinates | None" = None
    suspended: Offsets = ()

    def copy(self) -> "Coordinates":
        """Independent: what the fields hold is replaced as a whole, never changed."""
        return Coordinates(
            self.unit,
            self.changes,
            self.own,
            self.turn,
            self.plane,
            self.scale,
            self.scaled,
            self.mirror,
            self.systems,
            self.defined,
            self.last_defined,
            self.clamp,
            self.tool,
            self.tool_fixed,
            self.clamp_index,
            self.limits,
            self.outside,
            self.kinematics,
            self.untransformed,
            self.suspended,
        )

    def lasting(self) -> "Coordinates":
        """Where clamp position and tool are changed: between #MCS ON and #MCS OFF those count from #MCS OFF on."""
        if self.outside is None:
            return self
        self.outside = replace(self.outside)
        return self.outside

    def leave(self) -> None:
        """#MCS ON: the coordinates of the machine."""
        self.outside = self.copy()
        self._place(BARE)

    def come_back(self) -> None:
        """#MCS OFF: those from before #MCS ON; what was programmed between is gone."""
        if self.outside is not None:
            self._place(self.outside)
            self.outside = None

    def _place(self, other: "Coordinates") -> None:
        self.own, self.systems, self.clamp = other.own, other.systems, other.clamp
        self.tool, self.tool_fixed = other.tool, other.tool_fixed
        self.turn, self.plane, self.scaled, self.mirror = other.turn, other.plane, other.scaled, other.mirror

    def frame(self, count: int, main: tuple[int, int, int]) -> Frame | None:
        """The map for `count` axes with the main axes at these places."""
        main = main_axes(main, None if self.kinematics is None else self.kinematics.plane)
        linear, shift = self._contour(count, main)
        shift = self._added(shift, self.own)
        if not self.tool_fixed:
            shift = self._sum(shift, self.tool)
        for system in reversed(self.systems):
            linear = product(system.rotation, linear)
            turned = times(system.rotation, [shift[index] if index >= 0 else 0.0 for index in main])
            for place, index in enumerate(main):
                if index >= 0:
                    shift[index] = turned[place] + system.shift[place]
            shift = self._added(shift, system.before)
        shift = self._sum(shift, self.clamp)
        if self.tool_fixed:
            shift = self._sum(shift, self.tool)
        if linear == IDENTITY and not any(shift):
            return None
        return Frame(linear, tuple(shift), main)

    def _contour(self, count: int, main: tuple[int, int, int]) -> tuple[Matrix, list[float]]:
        """Mirror · scale · rotation about a centre."""
        factors = [1.0] * count
        if self.scaled and self.scale:
            factors = list(self.scale)
        if self.mirror:
            factors = [a * b for a, b in zip(factors, self.mirror, strict=True)]
        x, y, z = (factors[index] if index >= 0 else 1.0 for index in main)
        linear = diagonal(x, y, z)
        shift = [0.0] * count
        if self.turn is not None:
            angle, first, second = self.turn
            a, b = main.index(self.plane[0]), main.index(self.plane[1])
            normal = 3 - a - b
            turn = rotation_about(normal, angle if (a + 1) % 3 == b else -angle)
            centre = [0.0, 0.0, 0.0]
            centre[a], centre[b] = first, second
            moved = times(turn, centre)
            offset = times(linear, [c - m for c, m in zip(centre, moved, strict=True)])
            linear = product(linear, turn)
            for place, index in enumerate(main):
                if index >= 0:
                    shift[index] = offset[place]
        return linear, shift

    def _added(self, shift: list[float], own: Own) -> list[float]:
        return self._sum(self._sum(self._sum(shift, own.zero), own.added), own.preset)

    def _sum(self, shift: list[float], offsets: Offsets) -> list[float]:
        return [a + b for a, b in zip(shift, offsets, strict=True)] if offsets else shift


BARE: Final = Coordinates()


def system_of(command: str, values: tuple[float, ...], before: Own) -> System:
    """From shift and angles: about Z, then about the new Y, then about the new X."""
    x, y, z, a, b, c = values
    rotation = product(product(rotation_about(2, c), rotation_about(1, b)), rotation_about(0, a))
    return System(command, (x, y, z), rotation, before)
