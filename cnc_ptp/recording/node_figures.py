"""Names of the figures that nodes give in /diagnostics, each with its unit."""

BLOCKS = "blocks"
LOST_BLOCKS = "lost blocks"
CAME_TWICE = "blocks that came twice"
LATENESS_P50 = "lateness p50 [ms]"
LATENESS_P99 = "lateness p99 [ms]"
LATENESS_MAX = "lateness, largest [ms]"
BUFFER_FILL = "buffer of interpreted blocks, least [%]"
PATH_AHEAD = "path that is known [mm]"
LAG_OF_LIMIT = "following error of its limit [%]"


def following_error(unit: str) -> str:
    """The largest one since the start; `unit`: mm or deg."""
    return f"following error, largest [{unit}]"
