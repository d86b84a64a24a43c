"""What a program asks of the end of a block: exact stop, contouring (G61, G261, #CONTOUR MODE), smoothing (#HSC)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, NamedTuple

if TYPE_CHECKING:
    from cnc_ptp.parameters import ChannelParameters

DEV: Final = "DEV"
"""The distance to the programmed path is given."""
DIST: Final = "DIST"
"""Where the path is left and met again is given."""
POS: Final = "POS"
"""As DIST, and a point through which the curve goes."""


class Contour(NamedTuple):
    """Words of #CONTOUR MODE; those of the TwinCAT CNC programming manual with its defaults.

    path_dev     PATH_DEV: largest distance of the path axes to the programmed path, mm; in DEV
    track_dev    TRACK_DEV: largest deviation of each other axis, mm or deg; 0 none is given:
                 a corner in which one of them has a kink gets no curve
    pre_dist     PRE_DIST: mm of path length before the corner at which the path is left; in DIST and POS
    post_dist    POST_DIST: mm behind the corner at which it is met again; in DIST and POS
    remain_part  REMAIN_PART: % of a block that its two corners leave as they are
    max_angle    MAX_ANGLE: largest change of direction between two lines at which there is a curve, deg; 0 always
    point        X, Y, Z: the interim point in machine coordinates, one value for each axis of the channel; in POS
    room         lowest and highest position of each axis, mm or deg; in POS, whose curve may lead beyond its points
    """

    mode: str = DEV
    path_dev: float = 1.0
    track_dev: float = 0.0
    pre_dist: float = 1.0
    post_dist: float = 1.0
    remain_part: float = 0.0
    max_angle: float = 0.0
    point: tuple[float, ...] = ()
    room: tuple[tuple[float, float], ...] = ()


DEFAULT_CONTOUR: Final = Contour()


class Smoothing(NamedTuple):
    """Words of #HSC ON [BSPLINE …]: largest deviation of the path (mm) and of each other axis (mm or deg; 0: none)."""

    path_dev: float
    track_dev: float = 0.0


class Transition(NamedTuple):
    """How the path goes from a block into the next one.

    exact       it stops at the end of the block, unless this belongs to a smoothed curve
    contour     the corner there may be rounded like that; None: not
    smoothing   the block belongs to a curve that is smoothed; None: not
    """

    exact: bool
    contour: Contour | None = None
    smoothing: Smoothing | None = None

    @property
    def stops(self) -> bool:
        """The path stops at the end of the block, whatever follows."""
        return self.exact and self.smoothing is None


EXACT_STOP: Final = Transition(exact=True)
THROUGH: Final = Transition(exact=False)


class PathDefaults(NamedTuple):
    """What holds at the start of a program (P-CHAN-90011 … 90015).

    transition  between blocks
    contour     what G261 means
    smoothing   what #HSC ON means without words; None: PATH_DEV must be given
    """

    transition: Transition = THROUGH
    contour: Contour = DEFAULT_CONTOUR
    smoothing: Smoothing | None = None


PATH_DEFAULTS: Final = PathDefaults()


def path_defaults(channel: ChannelParameters) -> PathDefaults:
    """Those of the machine file."""
    contour = DEFAULT_CONTOUR._replace(path_dev=channel.contour_path_dev, track_dev=channel.contour_track_dev)
    smoothing = Smoothing(channel.hsc_path_dev, channel.hsc_track_dev) if channel.hsc_path_dev else None
    transition = EXACT_STOP if channel.transition == EXACT_STOP_CODE else THROUGH
    if channel.transition == CONTOURING_CODE:
        transition = THROUGH._replace(contour=contour)
    return PathDefaults(transition, contour, smoothing)


EXACT_STOP_CODE: Final = 60
CONTOURING_CODE: Final = 261
