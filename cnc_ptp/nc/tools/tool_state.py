"""The tool of a program as modal state."""

from dataclasses import dataclass

from cnc_ptp.parameters import Tool

NO_TOOL = Tool()
NOT_WRITTEN = ("", "", 0)


@dataclass(slots=True)
class ToolState:
    """Selected tool.

    t, d      last T word and the active compensation data, 0 for none
    data      compensation data that act: those of D, as the program has changed them (V.G.WZ_AKT)
    changed   compensation data that the program has changed (V.G.WZ[n]), by D number
    written   name, file and line of the last change of V.G.WZ_AKT
    """

    t: int = 0
    d: int = 0
    data: Tool = NO_TOOL
    changed: dict[int, Tool] | None = None
    written: tuple[str, str, int] = NOT_WRITTEN

    def copy(self) -> "ToolState":
        """Independent: what the fields hold is replaced as a whole, never changed."""
        return ToolState(self.t, self.d, self.data, self.changed, self.written)
