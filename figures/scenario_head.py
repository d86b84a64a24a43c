"""The head of a figure's scenario: title, caption and contents of the picture.

The head is the block of comment lines at the top of the file, `key: value` each; indented lines continue the value:

    # title: Dynamics 1.1
    # caption: One or two sentences, which may
    #   go on in further lines.
    # machine: config/ptp.yaml
    # axes: x

Besides there may be
- `panels: velocity, following error`: these in this order (cnc_ptp/plots/panels.py) instead of the usual ones,
- `program: part.nc`: an NC program beside the scenario, which starts with it on the first channel,
- `plc: plc.py`: a PLC in a file beside the scenario, and `signals: move.execute, move.busy`: switched values of its
  object that are drawn below the panels (figures/signals.py),
- `kind: circle`: another picture than panels over time (figures/kinds.py), with `turns:` (figures/circle.py)
  or `over:` and `points:` (figures/spindle_curve.py),
- `errors: shown`: a figure of faults; without it a fault means that there is no picture.

`axes` may name spindles too. All this is in the scenario itself so that a figure is one file, read in one go and
added without touching another.
For the run these lines are comments: `cnc_ptp simulate MACHINE --scenario FILE` takes the file as it is.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from cnc_ptp.errors import CncError
from cnc_ptp.machine.run_entries import read_file

ROOT = Path(__file__).parents[1]
KEYS = ("title", "caption", "machine", "axes")
PANELS, PROGRAM, KIND, TURNS, ERRORS, SHOWN = "panels", "program", "kind", "turns", "errors", "shown"
OVER, POINTS = "over", "points"
PLC, SIGNALS = "plc", "signals"
CHOICES = (PANELS, PROGRAM, PLC, SIGNALS, KIND, TURNS, OVER, POINTS, ERRORS)
OVER_TIME = "time"


class FigureError(Exception):
    """A figure cannot be drawn: which, why, and what happens now."""

    def __init__(self, path: Path, reason: object) -> None:
        super().__init__(f"figure {path.name}: {reason}; no picture was drawn")


@dataclass(frozen=True, slots=True)
class FigureScenario:
    """A scenario that is a figure. `machine` is relative to the repository, `axes` are drawn in this order.

    Without `panels` the usual ones are drawn; `program` is relative to the scenario, empty for none.
    """

    path: Path
    title: str
    caption: str
    machine: str
    axes: tuple[str, ...]
    shows_errors: bool = False
    panels: tuple[str, ...] = ()
    program: str = ""
    kind: str = OVER_TIME
    turns: str = ""
    over: str = ""
    points: tuple[str, ...] = ()
    plc: str = ""
    """Relative to the scenario."""
    signals: tuple[str, ...] = ()

    @property
    def name(self) -> str:
        """Of the picture: the file name without its ending."""
        return self.path.stem

    @property
    def machine_path(self) -> Path:
        return ROOT / self.machine

    @property
    def program_path(self) -> Path | None:
        return self.path.parent / self.program if self.program else None

    @property
    def plc_path(self) -> Path | None:
        return self.path.parent / self.plc if self.plc else None


def read_head(path: Path) -> FigureScenario:
    """The head of a scenario file. Raises FigureError."""
    try:
        text = read_file("scenario", str(path))
    except CncError as error:
        raise FigureError(path, error) from None
    head: dict[str, str] = {}
    for line in comment_block(text):
        if line.startswith(" ") and head:
            last = next(reversed(head))
            head[last] += " " + line.strip()
            continue
        key, colon, value = line.partition(":")
        if not colon or key not in (*KEYS, *CHOICES):
            known = ", ".join(f"{key}: ..." for key in (*KEYS, *CHOICES))
            raise FigureError(path, f"'{line}' in the head is not one of {known}")
        if key in head:
            raise FigureError(path, f"'{key}' occurs twice in the head")
        head[key] = value.strip()
    for key in KEYS:
        if not head.get(key):
            raise FigureError(path, f"the head (comment lines at the top of the file) has no '{key}: ...'")
    if head.get(ERRORS, SHOWN) != SHOWN:
        raise FigureError(path, f"'{ERRORS}: {head[ERRORS]}' in the head must be '{ERRORS}: {SHOWN}'")
    return FigureScenario(
        path,
        head["title"],
        head["caption"],
        head["machine"],
        names(head["axes"]),
        ERRORS in head,
        names(head.get(PANELS, "")),
        head.get(PROGRAM, ""),
        head.get(KIND, OVER_TIME),
        head.get(TURNS, ""),
        head.get(OVER, ""),
        names(head.get(POINTS, "")),
        head.get(PLC, ""),
        names(head.get(SIGNALS, "")),
    )


def names(text: str) -> tuple[str, ...]:
    """The values between commas."""
    return tuple(name.strip() for name in text.split(",") if name.strip())


def comment_block(text: str) -> list[str]:
    """The comment lines at the top, without their marks."""
    lines = []
    for line in text.splitlines():
        if not line.startswith("#"):
            break
        lines.append(line[1:].removeprefix(" "))
    return lines
