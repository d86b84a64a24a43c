"""Text files: machines with offsets and tools, scenarios, the vendor's lists, CSV tables, sweeps, users."""

from __future__ import annotations

import json
import random
from collections.abc import Callable, Mapping
from functools import cache, partial
from pathlib import Path

from bench.fuzzing.engine import Broken, Target, void
from bench.fuzzing.mutation import VALUES, mutated_bytes, mutated_text, mutated_yaml
from bench.jobs import ROOT
from cnc_ptp.commissioning.curve_points import parse_point, parse_point_file
from cnc_ptp.machine.wiring import unit_kinds
from cnc_ptp.parameters import MachineParameters, load_machine, machine_text, read_machine
from cnc_ptp.parameters.lists.exporting import export_lists
from cnc_ptp.parameters.lists.importing import import_lists
from cnc_ptp.parameters.loader import examine_machine
from cnc_ptp.plc.cam_file import parse_cam
from cnc_ptp.plc.scenario import parse_scenario
from cnc_ptp.plc.setpoint_file import parse_setpoints
from cnc_ptp.sweep.goals import read_goals
from cnc_ptp.sweep.journal import Journal
from cnc_ptp.sweep.results import Row
from cnc_ptp.sweep.table import read_table
from cnc_ptp.sweep.variation import check_variations, read_variations
from cnc_ptp.web.access.users import read_users

MILL, LATHE = ROOT / "config" / "mill.yaml", ROOT / "config" / "lathe.yaml"


def yaml_files() -> dict[Path, str]:
    """Those of configuration and examples."""
    files = [*(ROOT / "config").glob("*.yaml"), *(ROOT / "examples").rglob("*.yaml")]
    return {file: file.read_text(encoding="utf-8") for file in sorted(files)}


@cache
def machine(file: Path = MILL) -> MachineParameters:
    return read_machine(file)


# machines

SMALL_MACHINE = """\
/machine: {ros__parameters: {channels: [ch], axes: [x, "y", c], spindles: [s]}}
/c: {ros__parameters: {kenngr: {achs_typ: ACHSTYP_ROTATOR}}}
/s: {ros__parameters: {kopf.achs_nr: 4, kenngr.achs_typ: ACHSTYP_SPINDEL, getriebe: {"0": {kv: 3000}}}}
/ch:
  ros__parameters: {nullp_data: o.yaml, pzv_data: p.yaml, werkz_data: t.yaml, spdl_anzahl: 1, main_spindle_ax_nr: 4,
    main_spindle_name: S, spindel: {"0": {bezeichnung: S, log_achs_nr: 4}}}
"""
OFFSETS = """\
G54: {name: left vice, X: 100.0001, Y: -50.5}
G59: {C: 45}
G159=7: {X: 12.5, inactive: [Y, C]}
96: {name: pallet, X: 1}
G53: {Y: 3}
default: G159=7
"""
CLAMPS = "0: {name: table, X: 1.5}\n149: {C: -90}\n"
TOOLS = """\
5: {name: turning tool, type: turning, orientation: 3, offsets: {X: 20.5, Y: 41}, wear: {X: -0.02}}
6: {type: turning, d: {6: {orientation: 3, offsets: {X: 40}}, 16: {orientation: 4, offsets: {X: 37}}}}
7: {length: 75, radius: 5, spindle: 4, min_speed: 100, max_speed: 5000, valid: true, fixed: false}
"""


def machines(_folder: Path) -> Target:
    """All shipped machine files, with the files that they name."""
    texts = [machine_text(file) for file, text in yaml_files().items() if "/machine:" in text]
    return Target(partial(mutated_yaml, texts), load_and_examine)


def load_and_examine(text: str) -> None:
    """As `params check` and as a node; what one of them refuses, the other refuses."""
    problems, _ = examine_machine(text, "m.yaml")
    load_machine(text, "m.yaml")
    if problems:
        raise Broken(f"loaded in spite of {problems[0]}")


def named_files(_folder: Path) -> Target:
    """Zero offsets, clamp positions and tools of a small machine."""

    def make(draw: random.Random) -> str:
        files = {"o.yaml": OFFSETS, "p.yaml": CLAMPS, "t.yaml": TOOLS}
        name = draw.choice([*files])
        files[name] = mutated_yaml([files[name]], draw)
        return SMALL_MACHINE + "".join(f"--- # file of the machine: {key}\n{text}\n" for key, text in files.items())

    return Target(make, lambda text: void(load_machine(text, "m.yaml")))


def scenarios(_folder: Path) -> Target:
    """For the mill; files that entries name are an NC program."""
    kinds = unit_kinds(machine())
    texts = [text for text in yaml_files().values() if text.lstrip("#").strip() and " do: " in text]
    texts += [SCENARIO]
    return Target(
        partial(mutated_yaml, texts),
        lambda text: void(parse_scenario(text, "s.yaml", kinds, lambda what, _path: FILES.get(what, "M30\n"))),
    )


SCENARIO = """\
- {at: 0, to: x, do: move_absolute, target: 100, velocity: 50, acceleration: 1e3, buffer_mode: blending_low}
- {at: 0.5, to: "y", do: couple_cam, master: x, table: [[0, 0], [10, 5.5], [20, 0]], cyclic: on}
- {at: 1, to: "y", do: couple_cam, master: x, file: cam.csv}
- {at: 1, to: z, do: external_setpoints, setpoints: [[100, 1.0, 0.0, 0.0, 1], [110, 1.1, 0.0, 0.0, 1]]}
- {at: 1.5, to: z, do: external_setpoints, file: cam.csv}
- {at: 2, to: s, do: start, direction: cw, speed_rpm: 500}
- {at: 2, to: plc, do: follow_trajectory, axes: [x, "y"], points: [[0.5, [1, 2], [0, 0]], [1.0, [2, 3]]]}
- {at: 3, to: channel, do: load, program: part.nc, dialect: iso}
- {at: 3, to: channel, do: start, line: 3, pass_number: 2}
- {at: 4, to: channel, do: mdi, text: "G1 X10 F500"}
- {at: 4, to: x, do: write_parameter, parameter: getriebe.0.kv, value: 5000}
"""


# lists


def lists(_folder: Path) -> Target:
    """A folder of lists, one of which is changed: its bytes, or its lines; or its name."""
    shipped = {file.name: file.read_bytes() for file in sorted((ROOT / "examples" / "lists").glob("*.lis"))}
    manual = [file.read_bytes() for file in sorted((ROOT / "test" / "parameters" / "manual_lists").glob("*.lis"))]

    def make(draw: random.Random) -> dict[str, bytes]:
        files = dict(shipped)
        name = draw.choice([*files])
        data = draw.choice(manual) if draw.random() < 0.2 else files.pop(name)
        if draw.random() < 0.1:
            name = draw.choice([*files, "x.lis", "achs_mds_x.lis.lis", ".lis", "HOCHLAUF.LIS"])
        if draw.random() < 0.5:
            data = mutated_bytes(data, draw, others=manual)
        else:
            data = mutated_text([data.decode("latin-1")], draw, LIST_WORDS, longest=100_000).encode("utf-8", "replace")
        return {**files, name: data}

    def call(files: Mapping[str, bytes]) -> None:
        imported = import_lists("f", files)
        export_lists(imported.text, "m.yaml")

    return Target(make, call)


LIST_WORDS = (
    *VALUES,
    *("\r\n", "\r", "\n", " # ", "struct", "beg", "end", "[0]", "[999999999]", "[-1]", "achse[0].", "0x4"),
    *("kenngr.achs_typ ", "\xff\xfe"),
    *("gruppe[0].achs_anzahl 99", "spdl_anzahl 1000000", "listen[0] /etc/passwd", "ACHSTYP_SPINDEL", '"open'),
)  # fmt: skip


# tables

CAM = "master,slave\n0,0\n10,5.5\n20,0\n"
SETPOINTS = "cycle,position,velocity,acceleration,direction\n100,1.0,0.0,0.0,1\n110,1.1,0,0,1\n120,1.1,0,0,0\n"
CURVE = "speed_rpm,acceleration_deg_s2\n100,5000\n500,5000\n1000,2500\n2000,1000\n"
CSV_WORDS = (*VALUES, ",", ",,", ";", "\n", "\r", '"', '""', "\t", "master", "slave", "cycle", "speed_deg_s", "1e-17")


def csv_tables(_folder: Path) -> Target:
    """Cam tables, external setpoints, points of acceleration curves."""
    readers: dict[str, Callable[[str, str], object]] = {
        CAM: parse_cam, SETPOINTS: parse_setpoints, CURVE: parse_point_file, "100:5000": parse_point,
    }  # fmt: skip

    def make(draw: random.Random) -> tuple[str, str]:
        text = draw.choice([*readers])
        if draw.random() < 0.02:
            return text, text + text.splitlines()[-1] * draw.choice((2000, 20_000))
        return text, mutated_text([text], draw, CSV_WORDS, longest=200_000)

    def call(given: tuple[str, str]) -> None:
        reader, text = given
        readers[reader](text, "rpm" if reader == "100:5000" else "t.csv")

    return Target(make, call)


FILES = {"cam file": CAM, "setpoint file": SETPOINTS}
"""What scenarios name."""


# sweeps

VARIATIONS = ("x.getriebe.0.kv=2000:8000:13", "x.getriebe.0.kv=1000,2000,3000", "s.getriebe.0.kv=normal(3000,100)",
              "x.getriebe.0.kv=log:100:1000:5", "x.getriebe.0.kv=500:9000")  # fmt: skip
GOALS = ("max(following_error.x)", "max:min(set_velocity.x)", "rms(following_error.x + following_error.y) / 2",
         "program_time",
         "max(abs(set_acceleration.x)) ** 2 - last(set_position.x)")  # fmt: skip
SWEEP_WORDS = (
    *VALUES,
    ":",
    ",",
    "(",
    ")",
    "**",
    "9**9**9",
    ".",
    "__import__('os')",
    "lambda: 0",
    "max(",
    "abs(",
    "x.",
    "/0",
)


def sweeps(_folder: Path) -> Target:
    """What varies, and goals."""
    text = machine_text(MILL)

    def make(draw: random.Random) -> tuple[list[str], list[str]]:
        vary = [mutated_text(VARIATIONS, draw, SWEEP_WORDS, longest=3000) for _ in range(draw.choice((1, 1, 2)))]
        goals = [mutated_text(GOALS, draw, SWEEP_WORDS, longest=3000) for _ in range(draw.choice((1, 1, 2)))]
        kind = draw.randrange(2)
        return (vary, []) if kind else ([], goals)

    def call(given: tuple[list[str], list[str]]) -> None:
        vary, goals = given
        if goals:
            read_goals(goals, machine())
        else:
            check_variations(read_variations(vary, machine()), text, "m.yaml")

    return Target(make, call)


def journals(folder: Path) -> Target:
    """Journals of sweeps that were interrupted: what is damaged is refused, or computed again."""
    file = folder / "t.parquet.journal"
    description = {"machine file": "0123", "vary": ["x.getriebe.0.kv=1,2"], "goals": ["program_time"]}
    with Journal(file, description) as journal:
        journal.add(Row(0, (1.0,), (2.5,), 0, ""))
        journal.add(Row(1, (2.0,), (3.5,), 27001, "a text"))
    whole = file.read_bytes()
    words = (*VALUES, "\n", '{"variant": ', "[", "]", "null", '"', json.dumps({"variant": [2, [1], [1], 0, ""]}) + "\n")

    def make(draw: random.Random) -> bytes:
        if draw.random() < 0.5:
            return mutated_bytes(whole, draw)
        return mutated_text([whole.decode()], draw, words).encode("utf-8", "replace")

    def call(content: bytes) -> None:
        file.write_bytes(content)
        try:
            with Journal(file, description) as journal:
                rows = dict(journal.rows)
        except Exception:
            if file.read_bytes() != content:
                raise Broken("a journal that was refused has changed") from None
            raise
        for number, row in rows.items():
            if type(number) is not int or not all(isinstance(goal, (int, float)) for goal in row.goals):
                raise Broken(f"row {row} was taken from a damaged journal")

    return Target(make, call)


def tables(folder: Path) -> Target:
    """Tables of finished sweeps."""
    from cnc_ptp.sweep.results import Results
    from cnc_ptp.sweep.table import write_table

    file = folder / "t.parquet"
    description = {"machine file": "0123", "vary": ["x.getriebe.0.kv=1,2"], "goals": ["program_time"]}
    goals = read_goals(["program_time"], machine())
    write_table(file, Results(("x.getriebe.0.kv",), tuple(goals), (Row(0, (1.0,), (2.5,), 0, ""),)), description)
    whole = file.read_bytes()

    def call(content: bytes) -> None:
        file.write_bytes(content)
        read_table(file, description, 1)

    return Target(partial(mutated_bytes, whole), call)


# users

USERS = """\
users:
  anna: {role: operator, hash: '$argon2id$v=19$m=65536,t=3,p=4$AAAA$BBBB'}
  bert: {role: viewer, hash: abc}
tokens:
  cell: {role: operator, hash: 0123456789abcdef}
"""


def users(folder: Path) -> Target:
    """Files of users and tokens."""
    file = folder / "users.yaml"

    def make(draw: random.Random) -> bytes:
        return (
            mutated_bytes(USERS.encode(), draw)
            if draw.random() < 0.2
            else mutated_yaml([USERS], draw).encode("utf-8", "surrogatepass")
        )

    def call(content: bytes) -> None:
        file.write_bytes(content)
        file.chmod(0o600)
        read_users(file)

    return Target(make, call)
