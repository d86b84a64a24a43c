"""All conditions that a running machine is put under, one after another."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

from campaign import disks, load
from campaign.graph import free_domain
from campaign.load import LoadRow


def conditions(folder: Path, *, minutes: float, sets_clock: bool = False) -> Iterator[LoadRow]:
    """`minutes` of the soak, 0: none. Raises PermissionError for the wall clock."""
    domain = free_domain(os.getpid())
    yield load.busy_processors(folder, domain)
    yield load.memory_pressure(folder, domain)
    yield load.suspended(folder, domain)
    if sets_clock:
        yield load.wall_clock_set(folder, domain)
    yield with_disk("disk full", partial(disks.full_disk, folder, domain))
    yield with_disk("slow disk", partial(disks.slow_disk, folder, domain))
    yield load.company("subscribers", load.SUBSCRIBERS, folder, domain)
    yield load.company("foreign nodes", load.FOREIGN_NODES, folder, domain)
    yield load.company("late", 1, folder, domain)
    yield load.floods(folder, domain)
    yield load.two_machines(folder, domain)
    if minutes:
        yield load.soak(minutes, folder, domain)


def with_disk(name: str, condition: Callable[[], LoadRow]) -> LoadRow:
    """A row that says why it was not tried where no file system can be mounted."""
    try:
        return condition()
    except disks.NoDiskError as error:
        return LoadRow(f"{name}: not tried, {error}")
