"""What moves when something happens: machines with programs and scenarios that are long enough for a random moment."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parents[1]
CONFIG, SPINDLES = ROOT / "config", ROOT / "examples" / "spindles"
RAMPS = "acceleration: 5000, deceleration: 5000, jerk: 50000"
MILLING = "N20 G01 X120 Y60 Z-12 F6000\nN30 G02 X60 Y120 I-60 J0\nN40 G00 X0 Y0 Z0\nN50 G01 Y90 F3000\nN60 G00 Y0\n"
ROUND = 3.0
"""Seconds that a round of MILLING takes at least."""
PTP = f"""
- {{at: 0.05, to: x, do: move_absolute, target: 30000, velocity: 2000, {RAMPS}}}
- {{at: 0.05, to: y, do: move_velocity, velocity: -500, {RAMPS}}}
- {{at: 0.05, to: z, do: move_absolute, target: 900, velocity: 600, {RAMPS}}}
- {{at: 0.05, to: c, do: move_absolute, target: 7000, velocity: 720, {RAMPS}}}
- {{at: 2.0, to: z, do: move_absolute, target: -900, velocity: 600, {RAMPS}}}
- {{at: 3.0, to: x, do: set_override, percent: 60}}
- {{at: 4.0, to: x, do: set_override, percent: 100}}
- {{at: 5.5, to: z, do: move_absolute, target: 900, velocity: 600, {RAMPS}}}
- {{at: 12.0, to: y, do: stop}}
"""
COUPLED = f"""
- {{at: 0, to: y, do: couple, master: x, factor: 0.75}}
- {{at: 0, to: z, do: couple, master: y, factor: -0.5}}
- {{at: 0.05, to: x, do: move_absolute, target: 12000, velocity: 1000, {RAMPS}}}
"""
GANTRY = f"""
- {{at: 0, to: y, do: couple_gantry, master: x, difference_limit: 5}}
- {{at: 0.05, to: x, do: move_absolute, target: 12000, velocity: 1000, {RAMPS}}}
"""
THREAD_END = 20.0
"""Position of z, which it comes to from above, mm."""
THREAD = f"G18 G90 M03 S400\nG00 X36 Z300\nG33 Z{THREAD_END:g} K1.5\nM30\n"
TAPPING = "G63 Z-100 F500 S400\nM30\n"


def milling(rounds: int) -> str:
    """A program with so many rounds."""
    return f"%campaign\nN10 G90 G17 M03 S3000\n{rounds * MILLING}N70 M05\nN80 M30\n"


class Link(NamedTuple):
    """A slave that follows the actual or set values of its master, or an axis its spindle: mm for each deg then."""

    master: str
    slave: str
    factor: float


class Case(NamedTuple):
    """A machine and what it does."""

    name: str
    machine: Path
    seconds: float
    """Of machine time in which something may happen to it."""
    program: str | Path = ""
    """Text, or a file."""
    scenario: str | Path = ""
    links: tuple[Link, ...] = ()

    def words(self, folder: Path) -> list[str]:
        """Of the command line of `cnc_ptp run`; texts become files of the folder."""
        words = [str(self.machine)]
        for option, text, name in (
            ("--program", self.program, "campaign.nc"),
            ("--scenario", self.scenario, "campaign.yaml"),
        ):
            if text:
                words += [option, str(text if isinstance(text, Path) else written(folder / name, text))]
        return words


CASES = (
    Case("program", CONFIG / "mill.yaml", 18.0, milling(8)),
    Case("ptp", CONFIG / "ptp.yaml", 10.0, scenario=PTP),
    Case("coupled", CONFIG / "ptp.yaml", 10.0, scenario=COUPLED, links=(Link("x", "y", 0.75), Link("y", "z", -0.5))),
    Case("gantry", CONFIG / "gantry.yaml", 10.0, scenario=GANTRY, links=(Link("x", "y", 1.0),)),
    Case("thread", CONFIG / "lathe.yaml", 20.0, THREAD),
    Case("tapping", CONFIG / "mill.yaml", 10.0, TAPPING, links=(Link("s", "z", -1.25 / 360.0),)),
    Case("gears", SPINDLES / "gears.yaml", 7.0, SPINDLES / "gears.nc", SPINDLES / "gears_plc.yaml"),
)


def written(path: Path, text: str) -> Path:
    path.write_text(text, encoding="utf-8")
    return path
