"""Behind which canonical blocks the interpreter needs what only the run knows."""

from cnc_ptp.nc.canonical import CanonicalBlock, HomeAxes, KinematicsChange, SpindleAxis, Timer, WaitForPath
from cnc_ptp.nc.measuring import measures


def awaits_path(block: CanonicalBlock) -> bool:
    """Behind this block the interpreter needs what only the run knows."""
    return isinstance(block.motion, HomeAxes) or measures(block.motion) or changes_axes(block) or reads_the_run(block)


def changes_axes(block: CanonicalBlock) -> bool:
    """Behind this block the path has other axes (#CAX, #FACE), which stand where only the run knows."""
    return any(isinstance(function, (SpindleAxis, KinematicsChange)) for function in block.functions)


def reads_the_run(block: CanonicalBlock) -> bool:
    """The line behind this block reads what only the run knows."""
    for function in block.functions:
        if isinstance(function, WaitForPath) and function.awaited:
            return True
        if isinstance(function, Timer) and function.action == "READ":
            return True
    return False
