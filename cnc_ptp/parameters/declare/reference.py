"""The parameter reference: single entries for the terminal, and docs/parameters.md:
`python -m cnc_ptp.parameters.declare.reference > docs/parameters.md`."""

import re
import sys
from collections.abc import Callable, Iterator

from cnc_ptp.errors import CncError, did_you_mean, nearest
from cnc_ptp.parameters import errors
from cnc_ptp.parameters.declare import where
from cnc_ptp.parameters.declare.declarations import AXIS_LETTERS, LISTS, Declaration, catalogue, dotted
from cnc_ptp.parameters.declare.ranges import default_text, range_text, shown_range

HEADLINES = {
    "axis": "Axis list (axes and spindles)",
    "channel": "Channel list (NC channels)",
    "startup": "Start-up list (NC channels)",
    "zero": "Zero offset list (NC channels)",
    "clamp": "Clamp position list (NC channels)",
    "compensation": "Compensation list (axes and spindles)",
    "tool": "Tool list (NC channels)",
    "simulation": "Simulation list (axes and spindles; our own)",
    "machine": "Machine list (`/machine`; those under `ptp` belong to axes; our own)",
}
CHANGES = {
    "now": "while the machine runs, at once",
    "standstill": "while the machine runs, at a standstill",
    "start": "at start-up only (as the manual has it)",
    "": "at start-up only",
}
"""When a new value takes effect."""
INTRODUCTION = """\
# Parameters

Made by `make docs` from `cnc_ptp/parameters/declare/declarations.yaml`; do not edit.

A machine file is a ROS parameters file. `/machine` names the nodes, each node has a section:

    /machine: {ros__parameters: {channels: [channel], axes: [x, "y", z], spindles: [s]}}
    /x: {ros__parameters: {kopf: {achs_nr: 1}, getriebe: {"0": {kv: 5000}}}}

`getriebe[0].kv` of the lists is `getriebe: {"0": {kv: …}}` or `getriebe.0.kv` in the file and in ROS. Integers are
decimal or `0x…`; flags are constants joined by `|` or one number; booleans are true, false, 1 or 0. A parameter that
the file does not give has its default, cut to the limits that the file gives.
Quote the name "y": ROS reads a bare y (and n) as a boolean.

The kernel works in mm, ° and s. Units with two entries are for linear axes / rotary axes and spindles.
Axis types: T linear, R rotary, S spindle. A range with an id in it ends at the value of that parameter.
Behind the meaning, **—**: accepted and checked, without effect in this version; *S only*: in effect for spindles only.
*acts in*: sections of these documents that name the parameter, and the module that reads it.

*change* says when a new value takes effect in a machine that runs ([how](plc.md#parameters-at-run-time)): *now*;
*standstill*, of the axis; *start*, at start-up only, as the manuals have it. All others: at start-up only, too.
"""


def reference_markdown() -> str:
    """docs/parameters.md."""
    return "\n".join([INTRODUCTION, *array_lines(), *(line for name in LISTS for line in list_lines(name))])


def array_lines() -> Iterator[str]:
    yield "## Arrays\n"
    sizes = ", ".join(f"`{name}` {array.size}" for name, array in catalogue().arrays.items())
    yield f"Indexes begin at 0. Largest numbers of elements: {sizes}.\n"


def list_lines(list_name: str) -> Iterator[str]:
    """The tables of a list, one for each topic."""
    yield f"## {HEADLINES[list_name]}\n"
    declarations = [entry for entry in catalogue().by_id.values() if entry.list_name == list_name]
    for topic in dict.fromkeys(entry.topic for entry in declarations):
        yield f"### {topic[0].upper()}{topic[1:]}\n"
        yield "| id | name | type | range | unit | default | axes | change | meaning | | acts in |"
        yield "|---|---|---|---|---|---|---|---|---|---|---|"
        of_topic = (entry for entry in declarations if entry.topic == topic)
        yield from (table_row(entry) for entry in sorted(of_topic, key=lambda entry: entry.id))
        yield ""


def table_row(declaration: Declaration) -> str:
    drives = f" Drive types: {declaration.drives}." if declaration.drives else ""
    since = f" Since {declaration.since}." if declaration.since else ""
    cells = (
        declaration.id,
        f"`{declaration.name}`",
        declaration.data_type,
        range_text(declaration),
        unit_text(declaration),
        default_text(declaration.default),
        declaration.axes,
        declaration.change,
        f"{declaration.text}{drives}{since}",
        effect_text(declaration),
        where_text(declaration),
    )
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


def where_text(declaration: Declaration) -> str:
    """Sections of the documents that name it, and the module that reads it."""
    links = [section.link for section in where.sections_of(declaration)]
    return "; ".join([*links, *(f"`{module}`" for module in where.modules_of(declaration)[:1])])


def effect_text(declaration: Declaration) -> str:
    """Last column of the table."""
    if isinstance(declaration.effective, str):
        return f"{declaration.effective} only"
    return "" if declaration.effective else "**—**"


def effect_line(declaration: Declaration) -> str:
    if isinstance(declaration.effective, str):
        kinds = " and ".join(AXIS_LETTERS[letter] for letter in declaration.effective)
        return f"  In effect for {kinds} only."
    return "" if declaration.effective else "  Accepted and checked, but without effect in this version."


def unit_text(declaration: Declaration) -> str:
    linear, other = declaration.unit
    return linear if linear == other else f"{linear} / {other}"


def matches(declaration: Declaration, wanted: str) -> bool:
    name = re.sub(r"\.(\d+|\*|i|j)(?=\.|$)", ".*", dotted(wanted.replace("[i]", ".*").replace("[j]", ".*")))
    return (
        declaration.id == wanted.upper()
        or declaration.key == name
        or declaration.key.split(".*")[-1].endswith("." + name)
    )


def find(wanted: str) -> list[Declaration]:
    """Parameters by id or name, else by number, by parts of id and name, and by words of the text, in this order.

    Raises CncError 25018 with the nearest names if there is none.
    """
    declarations = list(catalogue().by_id.values())
    words = wanted.lower().split()
    short = re.fullmatch(r"(p-[a-z]+-)(\d{1,5})", wanted.strip().lower())
    wanted = f"{short[1]}{short[2]:0>5}" if short else wanted
    searches: tuple[Callable[[Declaration], bool], ...] = (
        lambda entry: matches(entry, wanted.strip()),
        lambda entry: wanted.strip().isdecimal() and int(entry.id.rpartition("-")[2]) == int(wanted),
        lambda entry: all(word in f"{entry.id} {entry.name}".lower() for word in words),
        lambda entry: all(word in f"{entry.id} {entry.name} {entry.text}".lower() for word in words),
    )
    exact, numbered, named, described = ([entry for entry in declarations if fits(entry)] for fits in searches)
    found = exact or numbered or [*named, *(entry for entry in described if entry not in named)]
    if not found or not words:
        raise CncError(errors.UNKNOWN_PARAMETER, f"no parameter is called {wanted!r}{near(wanted)}")
    return found


def near(wanted: str) -> str:
    """The most similar id or name, and up to two more that are very similar, as a question."""
    candidates: dict[str, Declaration] = {}
    for declaration in catalogue().by_id.values():
        for name in (declaration.id, declaration.name, declaration.name.split(".")[-1], *declaration.misprints):
            candidates.setdefault(name.lower(), declaration)
    typed = wanted.lower()
    names = [name for name in candidates if not name.startswith("p-")]  # ids resemble each other
    close = nearest(typed, candidates, cutoff=0.5) + nearest(typed, names, most=3, cutoff=0.8)
    texts = dict.fromkeys(f"{candidates[name].id} {candidates[name].name}" for name in close)
    return did_you_mean(list(texts))


def entry_text(declaration: Declaration) -> str:
    """One parameter in full, for a terminal."""
    lines = [
        f"{declaration.id}  {declaration.name}",
        f"  {declaration.text}",
        f"  list     {declaration.list_name}, {declaration.topic}"
        + (f"; axis types {declaration.axes}" if declaration.axes else ""),
        f"  type     {declaration.data_type} ({declaration.type})",
        f"  range    {range_text(declaration)}",
        f"  unit     {unit_text(declaration)}",
        f"  default  {default_text(declaration.default)}",
        *shown_lines(declaration),
        f"  drives   {declaration.drives}",
        f"  since    {declaration.since}",
        f"  change   {change_text(declaration)}",
        f"  source   {declaration.source}",
        effect_line(declaration),
    ]
    return "\n".join(line for line in lines if line.strip() not in ("", "range", "unit", "drives", "since"))


def change_text(declaration: Declaration) -> str:
    """When a new value takes effect, and for which axes."""
    when, _, letters = declaration.change.partition(" ")
    return CHANGES[when] + (f", of {' and '.join(AXIS_LETTERS[letter] for letter in letters)}" if letters else "")


def shown_lines(declaration: Declaration) -> Iterator[str]:
    """Range and default in the units in which people think, for each axis type that has its own."""
    lines = {shown_range(declaration, letter): None for letter in declaration.axes or "T"}
    for unit, limits, default in lines:
        if unit:
            yield f"  in {unit:<5} {limits}; default {default}"


if __name__ == "__main__":
    sys.stdout.write(reference_markdown())
