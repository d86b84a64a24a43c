"""Path geometry and path interpolation: where the tool is at path length s, and how s grows with time.

Units: mm, s, mm/s, mm/s², mm/s³ (deg for rotary axes).
"""

from cnc_ptp.path.geometry import Arc, AxisLimits, Element, Line
from cnc_ptp.path.interpolator import PathInterpolator, PathRow

__all__ = ["Arc", "AxisLimits", "Element", "Line", "PathInterpolator", "PathRow"]
