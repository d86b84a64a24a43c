"""Compensation of the tool radius as modal state, and what the machine file says of it."""

from typing import Final, NamedTuple

from cnc_ptp.parameters import ChannelParameters, Tool

LEFT, RIGHT = 1, -1


class RadiusSettings(NamedTuple):
    """Of the machine file.

    look_ahead    elements of the contour that are known before one is handed out (P-CHAN-90035)
    other_blocks  largest number of blocks without motion in the plane between two elements (P-CHAN-90036)
    by_lines      G25 at the start of programs, else G26 (P-CHAN-90037)
    """

    look_ahead: int = 5
    other_blocks: int = 100
    by_lines: bool = False


DEFAULT_SETTINGS: Final = RadiusSettings()
BY_LINES: Final = 25
"""G code of outer corners by straight lines."""


def radius_settings(channel: ChannelParameters) -> RadiusSettings:
    """Those of the machine file."""
    by_lines = channel.outer_corners == BY_LINES
    return RadiusSettings(channel.contour_look_ahead, channel.contour_other_blocks, by_lines)


class RadiusState(NamedTuple):
    """Modal state of G40, G41, G42.

    side          1 left of the contour (G41), -1 right of it (G42), 0 off (G40)
    by_lines      outer corners by straight lines (G25), else by arcs (G26)
    contour_feed  F of an arc is that of the contour (G11), else that of the tool's centre (G10)
    engaged       the tool is beside the contour: from the approach to the departure
    data          compensation data of D (vocabulary iso); None: those of the active tool
    """

    side: int = 0
    by_lines: bool = False
    contour_feed: bool = False
    engaged: bool = False
    data: Tool | None = None

    @property
    def on(self) -> bool:
        """Motions are those of the contour, not of the tool."""
        return self.side != 0 or self.engaged

    @property
    def code(self) -> str:
        """As programs write it."""
        return {LEFT: "G41", RIGHT: "G42"}.get(self.side, "G40")


NOT_COMPENSATED: Final = RadiusState()
