"""Loaded by each worker process of this computer: Ctrl-C is for the command, which ends its workers itself."""

from __future__ import annotations

import signal
from typing import Any


def dask_setup(worker: Any) -> None:
    """Called by Dask in a new worker."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
