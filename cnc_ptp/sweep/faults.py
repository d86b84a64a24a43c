"""Error numbers of sweeps, and packages that only they need."""

from __future__ import annotations

from typing import Any

from cnc_ptp.recording.opened import package

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
    return package(name, f"{NOTHING}, install it with: pip install 'cnc_ptp[sweep]'")
