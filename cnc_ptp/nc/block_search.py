"""The place at which a program begins that is not started at its beginning: what is before it is only interpreted."""

from typing import NamedTuple

from cnc_ptp.nc.canonical import Source


def base_name(path: str) -> str:
    """A file without its folder."""
    return path.rpartition("/")[2]


class StartPoint(NamedTuple):
    """A line, or the block with a number (the other one is 0), of a `file` ("": the loaded program).

    `pass_number`: the how-manieth of its passes, from 1, if it lies in a loop or subroutine.
    """

    line: int = 0
    block_number: int = 0
    file: str = ""
    pass_number: int = 1

    @property
    def name(self) -> str:
        """For errors: `line 120`, `block N500`."""
        return f"line {self.line}" if self.line else f"block N{self.block_number}"


class BlockSearch:
    """Looks for a start point among the lines that are about to be executed.

    found           where the program begins, once it is reached
    passes          how often the place was passed
    below, above    nearest numbers of lines or blocks that were passed, 0: none
    position        where the tool is at the place (machine coordinates, mm or deg), if that is beside the contour
                    because its radius is compensated
    """

    def __init__(self, point: StartPoint, file: str) -> None:
        """`file`: as the sources of its lines name it."""
        self.point, self.file = point, file
        self.found: Source | None = None
        self.passes = self.below = self.above = 0
        self.position: tuple[float, ...] | None = None

    def meets(self, source: Source) -> bool:
        """Whether the program begins with this line, which is the next to be executed."""
        if source.file != self.file:
            return False
        wanted = self.point.line or self.point.block_number
        number = source.line if self.point.line else source.block_number
        if number != wanted:
            if self.below < number < wanted:
                self.below = number
            elif number > wanted and (number < self.above or not self.above):
                self.above = number
            return False
        self.passes += 1
        if self.passes < self.point.pass_number:
            return False
        self.found = source
        return True
