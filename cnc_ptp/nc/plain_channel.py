"""The channel of a machine of which no more is given than axes and spindles."""

from collections.abc import Collection, Sequence

from cnc_ptp.nc.program import Channel, SpindleTable, Vocabulary
from cnc_ptp.nc.spindles import spindle_table
from cnc_ptp.nc.vocabulary import TWINCAT


def plain_channel(
    axes: Sequence[str],
    spindles: Sequence[str] | SpindleTable = ("S",),
    vocabulary: Vocabulary = TWINCAT,
    rotary: Collection[str] = (),
) -> Channel:
    """`axes` by name, those in `rotary` in deg, a C axis too; all else has its default.

    `spindles`: the first is the main spindle (DIN words M3, S1000); names are enough where gears and links are not
    needed.
    """
    table = spindle_table(spindles)
    turns = frozenset(rotary).union([table.c_axis] if table.c_axis else [])
    index = {axis: position for position, axis in enumerate(axes)}
    return Channel(tuple(axes), index, table, vocabulary, turns)
