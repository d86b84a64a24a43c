"""`cnc_ptp status` and `cnc_ptp watch`: the units of a running machine."""

from __future__ import annotations

import math
import time
from collections.abc import Sequence

from rich.console import Console, Group
from rich.live import Live
from rich.text import Text

from cnc_ptp.commands.client.unit_table import line, unit_table, wide_console
from cnc_ptp.commands.console import RUN_FAILED
from cnc_ptp.interrupt import EndRequest
from cnc_ptp.nodes.client.latest_blocks import GONE_TEXT, LatestBlocks
from cnc_ptp.nodes.client.latest_programs import LatestPrograms
from cnc_ptp.nodes.client.machine_client import PATIENCE, MachineClient, connected


def status() -> int:
    """Prints one table. Status 1 when a unit is in error or silent."""
    with connected() as client:
        units = shown_units(client, ())
        blocks = client.look_at(units)
        programs = LatestPrograms(client, [unit for unit in units if client.kinds[unit] == "channel"])
        client.spin_until(lambda: len(blocks.views()) == len(units) and programs.complete, PATIENCE)
        views = blocks.views()
        silent = [unit for unit in units if unit not in {view.name for view in views}]
        console = wide_console()
        console.print(headline(client, blocks), markup=False)
        console.print(unit_table(views, silent))
        for text in programs.lines():
            console.print(text, markup=False)
    return RUN_FAILED if silent or any(view.error_id for view in views) else 0


def watch(units: Sequence[str], rate: float, seconds: float | None) -> int:
    """Shows units until Ctrl-C or for some seconds; status 1 when the machine goes away."""
    with connected() as client, EndRequest() as end:
        shown = shown_units(client, units)
        blocks = client.look_at(shown)
        client.spin_until(lambda: end.given or len(blocks.views()) == len(shown), PATIENCE)
        looker = Looker(client, blocks, shown)
        deadline = math.inf if seconds is None else time.monotonic() + seconds
        with looker:
            while not end.given and not blocks.gone and (left := deadline - time.monotonic()) > 0.0:
                looker.show()
                client.spin_until(lambda: end.given or blocks.gone, min(1.0 / rate, left))
        if blocks.gone:
            Console(stderr=True, highlight=False).print(GONE_TEXT, style="red")
        return RUN_FAILED if blocks.gone else 0


def shown_units(client: MachineClient, units: Sequence[str]) -> list[str]:
    """Those that are asked for, or all that have a state. Raises CncError 26111."""
    for unit in units:
        client.require_unit(unit, ("channel", "axis", "spindle"))
    return list(units) or [unit for unit, kind in client.kinds.items() if kind != "plc"]


def headline(client: MachineClient, blocks: LatestBlocks) -> str:
    cycle = max((view.cycle for view in blocks.views()), default=0)
    where = "" if client.get_namespace() == "/" else f", namespace {client.get_namespace()}"
    return f"ROS domain {client.context.get_domain_id()}{where}, cycle {cycle}"


class Looker:
    """A table that is drawn again on a terminal; lines elsewhere."""

    def __init__(self, client: MachineClient, blocks: LatestBlocks, units: Sequence[str]) -> None:
        self._client = client
        self._blocks = blocks
        self._units = units
        console = wide_console()
        self._live = Live(console=console, auto_refresh=False) if console.is_terminal else None
        self._cycle = -1

    def __enter__(self) -> Looker:
        if self._live is not None:
            self._live.start()
        return self

    def __exit__(self, *_: object) -> None:
        if self._live is not None:
            self._live.stop()

    def show(self) -> None:
        """Shows the newest blocks; lines only of new ones."""
        views = self._blocks.views()
        cycle = max((view.cycle for view in views), default=-1)
        new = cycle != self._cycle
        self._cycle = cycle
        if self._live is not None:
            silent = [unit for unit in self._units if unit not in {view.name for view in views}]
            table = unit_table(views, silent)
            self._live.update(Group(Text(headline(self._client, self._blocks)), table), refresh=True)
        elif new:
            for view in views:
                print(line(view), flush=True)
