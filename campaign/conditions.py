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
    """`minutes` of the soak, 0: none."""
    for name, condition in named(folder, minutes=minutes, sets_clock=sets_clock):
        yield attempted(name, condition)


def named(folder: Path, *, minutes: float, sets_clock: bool) -> Iterator[tuple[str, Callable[[], LoadRow]]]:
    """What is tried, with names for what cannot be."""
    domain = free_domain(os.getpid())
    yield "all processors busy", partial(load.busy_processors, folder, domain)
    yield "memory pressure", partial(load.memory_pressure, folder, domain)
    yield "whole graph suspended", partial(load.suspended, folder, domain)
    if sets_clock:
        yield "wall clock", partial(load.wall_clock_set, folder, domain)
    yield "disk full", partial(disks.full_disk, folder, domain)
    yield "slow disk", partial(disks.slow_disk, folder, domain)
    for what, (number, each) in load.COMPANY_OF.items():
        yield what, partial(load.company, what, number, each, folder, domain)
    yield "floods", partial(load.floods, folder, domain)
    yield "two machines", partial(load.two_machines, folder, domain)
    if minutes:
        number, _ = load.COMPANY_OF[load.FOREIGN]
        yield "foreign participants", partial(load.company, load.FOREIGN, number, 1, folder, domain)
        yield "soak", partial(load.soak, minutes, folder, domain)


def attempted(name: str, condition: Callable[[], LoadRow]) -> LoadRow:
    """Its row; one that says why where no file system can be mounted, and where it ended with an error."""
    try:
        return condition()
    except disks.NoDiskError as error:
        return LoadRow(name, untried=str(error))
    except Exception as error:  # whatever it is, the conditions behind it are tried
        return LoadRow(name, problems=[f"not looked at to the end: {error!r}"])
