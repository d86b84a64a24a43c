"""Other values of parameters: the text with them describes the machine that they make."""

from __future__ import annotations

import pytest
from machine_support import ROOT

from cnc_ptp.parameters import load_machine, machine_text, read_machine
from cnc_ptp.parameters.changed import changed_text, read_changes

MILL = ROOT / "config" / "mill.yaml"


@pytest.mark.parametrize(
    "change",
    [
        "x.getriebe.0.kv=8000",
        "/y.getriebe[0].kv = 8000",
        "z.P-AXIS-00099=7000",
        "x.vorsteuer.vorsteuerung=VEL",
        "x.simulation.friction.coulomb=0.7123456789012345",
        "channel.prog_start.hsc.path_dev=5",
        "s.simulation.drive_time_constant=2500",
        "machine.watchdog_ms=120",
    ],
)
def test_a_changed_text_describes_the_changed_machine(change: str) -> None:
    text, mill = machine_text(MILL), read_machine(MILL)
    changes = read_changes([change], mill)
    changed = load_machine(text, str(MILL), changes=changes)
    written = load_machine(changed_text(text, changes), str(MILL))
    assert views(written) == views(changed) != views(mill)


def views(machine: object) -> str:
    """All values, without places in the text."""
    names = ("axes", "spindles", "channels", "watchdog_ms", "cycle_time_us", "block_cycles")
    return repr([getattr(machine, name) for name in names])
