"""All conditions that a running machine is put under, one after another."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

from campaign import disks, load
from campaign.graph import free_domain
from campaign.load import LoadRow


def conditions(folder: Path, *, minutes: float, sets_clock: bool = False) -> Iterator[LoadRow]:
    """`minutes` of the soak, 0: none."""
    domain = free_domain(os.getpid())
    yield load.busy_processors(folder, domain)
    yield load.memory_pressure(folder, domain)
    yield load.suspended(folder, domain)
    if sets_clock:
        yield load.wall_clock_set(folder, domain)
    yield disks.full_disk(folder, domain)
    yield disks.slow_disk(folder, domain)
    for what, (number, each) in load.COMPANY_OF.items():
        yield load.company(what, number, each, folder, domain)
    yield load.floods(folder, domain)
    yield load.two_machines(folder, domain)
    if minutes:
        number, _ = load.COMPANY_OF[load.FOREIGN]
        yield load.company(load.FOREIGN, number, 1, folder, domain)
        yield load.soak(minutes, folder, domain)
