"""The kinds of lists: whose parameters they hold, how their files are called, and how one tells them apart."""

from __future__ import annotations

import re
from typing import Final, NamedTuple

from cnc_ptp.parameters.declare.declarations import Declaration


class Kind(NamedTuple):
    """A kind of list. `node` is the kind of nodes that it is for; `entry` names its files in the start-up list."""

    name: str
    node: str
    entry: str
    pattern: re.Pattern[str]
    """Of the stem of a file; what follows it is the name or number of the unit."""

    @property
    def title(self) -> str:
        """As messages call it."""
        return f"{self.name} list"

    @property
    def counted_by(self) -> str:
        """The parameter of the start-up list with the number of such files; empty if it has none."""
        return {"axis": "zahl_mds", "channel": "kanal_anzahl", "compensation": "zahl_kw"}.get(self.name, "")


def _stem(pattern: str) -> re.Pattern[str]:
    return re.compile(rf"(?:{pattern})(?=[\W_\d]|$)[\W_]*(.*)", re.IGNORECASE)


STARTUP: Final = Kind("start-up", "machine", "", _stem("hochlauf|start_?up"))
COMPENSATION: Final = Kind("compensation", "axis", "achs_kw", _stem("achs_?kw|kompensation|comp(?:ensation)?"))
AXIS: Final = Kind("axis", "axis", "achs_mds", _stem("achs_?mds|achsen?|axis|spindel|spindle"))
CHANNEL: Final = Kind("channel", "channel", "sda_mds", _stem("sda_?mds|kanal|chan(?:nel)?"))
TOOL: Final = Kind("tool", "channel", "werkz_data", _stem("werkz(?:eug)?e?(?:_?data|_?d)?|tools?|wz"))
ZERO: Final = Kind("zero offset", "channel", "nullp_data", _stem("nullp(?:unkt)?(?:_?data|_?d)?|zero|np"))
CLAMP: Final = Kind("clamp position", "channel", "pzv_data", _stem("pzv(?:_?data|_?d)?|clamp"))
KINDS: Final = {kind.name: kind for kind in (STARTUP, COMPENSATION, AXIS, CHANNEL, TOOL, ZERO, CLAMP)}
ENTRIES: Final = {kind.entry: kind for kind in KINDS.values() if kind.entry}
COUNTS: Final = {kind.counted_by: kind for kind in KINDS.values() if kind.counted_by}
WORDS: Final = {kind.name.split()[0].replace("-", ""): kind for kind in KINDS.values()}
"""Kinds as the command line calls them: axis, channel, tool, zero, clamp, compensation, startup."""
_LISTS: Final = {"channel": CHANNEL, "zero": ZERO, "clamp": CLAMP, "tool": TOOL, "compensation": COMPENSATION}


def kind_of(declaration: Declaration) -> Kind:
    """The list in which a parameter is."""
    if declaration.axes and declaration.list_name != "compensation":
        return AXIS
    return _LISTS.get(declaration.list_name, STARTUP)


def by_file_name(file: str) -> tuple[Kind | None, str]:
    """The kind that a file name says, and what it says of the unit: ("axis", "x") of achs_mds_x.lis."""
    stem = file.rpartition(".")[0] or file
    for kind in KINDS.values():
        if found := kind.pattern.match(stem):
            return kind, found[1]
    return None, stem
