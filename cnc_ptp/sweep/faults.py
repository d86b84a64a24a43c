"""Error numbers of sweeps, and packages that only they need."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from cnc_ptp.errors import CncError
from cnc_ptp.recording.opened import NO_PACKAGE

BAD_VARIATION = 26177
BAD_PARAMETER = 26178
BAD_GOAL = 26179
NO_SCHEDULER = 26181
OTHER_SWEEP = 26182
NO_SWEEP_TABLE = 26183
TOO_MANY_VARIANTS = 26185
UNFIT_WORKERS = 26186
BROKEN_OFF = 26187
WORKER_LOST = 26188
NOTHING = "nothing was started"


def sweep_package(name: str) -> Any:
    """A package that only sweeps need. Raises CncError 26013 where it is not installed."""
    try:
        return import_module(name)
    except ImportError:
        raise CncError(
            NO_PACKAGE, f"{name} is not installed", f"{NOTHING}, install it with: pip install 'cnc_ptp[sweep]'"
        ) from None
