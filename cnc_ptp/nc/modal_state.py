"""The modal state of a program: all that stays from one block to the next."""

from collections.abc import Iterator
from dataclasses import dataclass, field, fields
from typing import Final, NamedTuple

from cnc_ptp.nc.canonical import Function, Motion
from cnc_ptp.nc.contour import DEFAULT_CONTOUR, THROUGH, Contour, Transition
from cnc_ptp.nc.coordinates.coordinates import Coordinates
from cnc_ptp.nc.coordinates.frame import Frame
from cnc_ptp.nc.faults import ProgramError
from cnc_ptp.nc.radius.radius_state import NOT_COMPENSATED, RadiusState
from cnc_ptp.nc.tools.tool_state import ToolState


class Pair(NamedTuple):
    """Coupled spindles by key. The slave turns `num` / `den` times as fast as the master."""

    slave: str
    master: str
    num: float = 1.0
    den: float = 1.0


Pairs = tuple[Pair, ...]


class Step(NamedTuple):
    """A further motion of a block, in programmed or in `machine` coordinates, with functions before it."""

    motion: Motion | None
    functions: tuple[Function, ...] = ()
    machine: bool = False


class Tapping(NamedTuple):
    """What stays from one block with G63, G331, G332 to the next: the last S was negative; last pitch, mm, 0 none.

    `spindle`: key of the one whose speed it was, "" the main one.
    """

    reversed: bool = False
    pitch: float = 0.0
    spindle: str = ""


NO_TAPPING: Final = Tapping()


class FacingAxis(NamedTuple):
    """A facing axis (P-AXIS-00015) by its place: its words are diameters with G51 and G90, with G51 and G91."""

    place: int
    absolute: bool = True
    relative: bool = False


class Turning(NamedTuple):
    """Modal state of turning.

    diameter   the axis of G51, None with G52
    feed       F of G95, mm per turn
    facing     place of the facing axis of G96, -1 with G97
    speed      cutting speed, mm/s; 0: no S since G96
    max_rpm    of G196, 0 without
    """

    diameter: FacingAxis | None = None
    feed: float = 0.0
    facing: int = -1
    speed: float = 0.0
    max_rpm: float = 0.0


NO_TURNING: Final = Turning()


class Drilling(NamedTuple):
    """Numbers of the drilling cycles of the vocabulary iso that stay from block to block.

    to_r      G99: back to the retract plane
    running   number of the cycle that is on (81), 0: none; in the plane `plane`
    initial   position of the drill axis before it, mm
    r, z      levels of the retract plane and of the bottom, mm; q peck depth, mm; p dwell, s; None: not programmed
    """

    to_r: bool = False
    running: int = 0
    plane: int = 17
    initial: float = 0.0
    r: float | None = None
    z: float | None = None
    q: float | None = None
    p: float | None = None


NO_DRILLING: Final = Drilling()


class ThreadState(NamedTuple):
    """Numbers of G33, G34 and G35 that stay to the end of the program.

    letter    of the pitch (I, J, K), "" none yet; `pitch` in mm per revolution
    change    F of G34 and G35, mm per revolution and revolution
    offset    deg from the zero passage of the spindle to the start of the thread
    runs      the last motion was one of G33: another one continues its thread
    changed   what has commanded the spindle since, "" nothing
    stopped   spindles that the program has stopped
    retract   place of an axis and its way, mm, for threads that are broken off; None: as the machine file says
    """

    letter: str = ""
    pitch: float = 0.0
    change: float = 0.0
    offset: float = 0.0
    runs: bool = False
    changed: str = ""
    stopped: frozenset[str] = frozenset()
    retract: tuple[int, float] | None = None


NO_THREAD: Final = ThreadState()


@dataclass(slots=True)
class SpindleModes:
    """Modal state of spindles from one block to the next; by key if there is one value for each.

    main        the main spindle, "" for the one at start-up
    positions   last POS, deg
    gears       gear stage; that at start-up if there is none
    turning     3 or 4 while endless rotation is programmed
    links       coupling groups that were defined (#SET AX LINK), by number
    active      numbers of the groups that are enabled, the last one last
    speedless   errors of M3 and M4 that still have no speed: it must come before the first machining motion
    """

    main: str = ""
    positions: dict[str, float] = field(default_factory=dict)
    gears: dict[str, int] = field(default_factory=dict)
    turning: dict[str, int] = field(default_factory=dict)
    links: dict[int, Pairs] = field(default_factory=dict)
    active: tuple[int, ...] = ()
    speedless: dict[str, ProgramError] = field(default_factory=dict)

    def copy(self) -> "SpindleModes":
        """An independent copy."""
        return SpindleModes(
            self.main,
            dict(self.positions),
            dict(self.gears),
            dict(self.turning),
            dict(self.links),
            self.active,
            dict(self.speedless),
        )


@dataclass(slots=True)
class ModalState:
    """Modal state from one block to the next: mm, mm/s, rpm; the defaults are the initial state of a program.

    `path`, `plane`, `feed_mode`: numbers of the active G codes; `block_time`: F with G93 (s); `radius`: last R (mm,
    signed, 0.0 none); `speeds`: S by spindle; `slope`: #SLOPE, "" is that of P-CHAN-00071. `position` in machine
    coordinates, `programmed`: the same point as programs name it, by `frame` (None: they are equal), which is what
    `coordinates` amount to; while the tool radius is compensated both are points of the contour. `reported`: the
    canonical stream has them. `transition`: between blocks; `once`: at the end of the active one instead; `contour`:
    what G261 means. While a block is resolved: `following`, its further motions; `machine_words`, its axis words are
    machine positions (G53 of the vocabulary iso). `c_axis`: key of the spindle that #CAX has made an axis of the path.
    """

    position: tuple[float, ...] = ()
    path: int = 0
    plane: int = 17
    absolute: bool = True
    centre_absolute: bool = False
    feed: float = 0.0
    feed_mode: int = 94
    block_time: float = 0.0
    radius: float = 0.0
    speeds: dict[str, float] = field(default_factory=dict)
    spindle: SpindleModes = field(default_factory=SpindleModes)
    slope: str = ""
    coordinates: Coordinates = field(default_factory=Coordinates)
    frame: Frame | None = field(default=None, compare=False)
    programmed: tuple[float, ...] = ()
    reported: bool = field(default=False, compare=False)
    drilling: Drilling = NO_DRILLING
    tapping: Tapping = NO_TAPPING
    turning: Turning = NO_TURNING
    c_axis: str = ""
    transition: Transition = THROUGH
    interim_point: dict[int, float] | None = None
    once: Transition | None = None
    contour: Contour = DEFAULT_CONTOUR
    following: Iterator[Step] | None = None
    machine_words: bool = False
    tool: ToolState = field(default_factory=ToolState)
    radius_compensation: RadiusState = NOT_COMPENSATED
    thread: ThreadState = NO_THREAD

    def copy(self) -> "ModalState":
        """An independent copy, so that a refused MDI line leaves the state unchanged."""
        return ModalState(
            self.position,
            self.path,
            self.plane,
            self.absolute,
            self.centre_absolute,
            self.feed,
            self.feed_mode,
            self.block_time,
            self.radius,
            dict(self.speeds),
            self.spindle.copy(),
            self.slope,
            self.coordinates.copy(),
            self.frame,
            self.programmed,
            self.reported,
            self.drilling,
            self.tapping,
            self.turning,
            self.c_axis,
            self.transition,
            self.interim_point,
            self.once,
            self.contour,
            self.following,
            self.machine_words,
            self.tool.copy(),
            self.radius_compensation,
            self.thread,
        )

    def take_over(self, other: "ModalState") -> None:
        """All of another state, which is void then."""
        for each in fields(self):
            setattr(self, each.name, getattr(other, each.name))

    def restore(self, other: "ModalState") -> None:
        """After a cycle: codes, feed, radius, coordinates, D of its caller; position, T, spindles, tables are kept."""
        self.path, self.plane, self.absolute = other.path, other.plane, other.absolute
        self.centre_absolute, self.feed, self.radius = other.centre_absolute, other.feed, other.radius
        self.feed_mode, self.block_time = other.feed_mode, other.block_time
        self.turning = self.turning._replace(diameter=other.turning.diameter, feed=other.turning.feed)
        changes = self.coordinates.changes
        self.slope, self.coordinates = other.slope, other.coordinates
        self.transition, self.contour, self.interim_point = other.transition, other.contour, other.interim_point
        self.coordinates.changes = changes
        self.tool.d, self.tool.data = other.tool.d, other.tool.data
        engaged = self.radius_compensation.engaged
        self.radius_compensation = other.radius_compensation._replace(engaged=engaged)
