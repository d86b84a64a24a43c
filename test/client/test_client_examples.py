"""The examples of the client run; the notebook as Jupyter runs it, cell by cell beside a running event loop."""

from __future__ import annotations

import ast
import asyncio
import json
import os
import re
import subprocess
import sys
from contextlib import redirect_stdout
from io import StringIO
from pathlib import Path

import pytest
from machine_support import ROOT

from cnc_ptp.client import CncError, Machine

EXAMPLES = ROOT / "examples"
NOTEBOOK = json.loads((EXAMPLES / "client.ipynb").read_text(encoding="utf-8"))
NUMBER = r"-?\d+\.?\d*"


def run(name: str, *arguments: str) -> str:
    """What an example prints."""
    command = [sys.executable, f"examples/{name}", *arguments]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=240, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_five_lines() -> None:
    assert len((EXAMPLES / "client_five_lines.py").read_text().split("\n")) == 6
    assert run("client_five_lines.py") == "100.0\n"


@pytest.mark.long
def test_moved_and_measured() -> None:
    """Without feedforward the lag at a steady velocity is v / Kv, Kv = 50 1/s (P-AXIS-00099)."""
    first, *rows, with_feedforward = run("client_measure.py").splitlines()[:5]
    assert (first, with_feedforward) == ("without", "with feedforward")
    lags = {float(v): float(e) for v, e in (re.findall(NUMBER, row) for row in rows)}
    assert lags == {v: pytest.approx(v / 50.0, rel=0.01) for v in (10.0, 50.0, 200.0)}
    better = [float(re.findall(NUMBER, row)[1]) for row in run("client_measure.py").splitlines()[5:]]
    assert len(better) == 3 and max(better) < 0.05


def test_a_tool_changer() -> None:
    lines = run("client_handshake.py").splitlines()
    assert [line.split("s  ")[1].strip() for line in lines] == [
        "line 2: T2",
        "line 2: M6",
        "<job 1 of channel: start, done>, X60",
    ]
    assert float(lines[2].split()[0]) > float(lines[1].split()[0]) + 1.5


def test_the_notebook_is_one() -> None:
    assert (NOTEBOOK["nbformat"], NOTEBOOK["nbformat_minor"]) == (4, 5)
    identities = [cell["id"] for cell in NOTEBOOK["cells"]]
    assert len({*identities}) == len(identities) and all(re.fullmatch(r"[a-zA-Z0-9_-]{1,64}", i) for i in identities)
    for cell in NOTEBOOK["cells"]:
        needed = {"cell_type", "id", "metadata", "source"}
        needed |= {"execution_count", "outputs"} if cell["cell_type"] == "code" else set()
        assert cell.keys() == needed


def test_the_notebook_is_executed(monkeypatch: pytest.MonkeyPatch) -> None:
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    shown: list[list[int]] = []
    monkeypatch.setattr(plt, "show", lambda: shown.append([len(line.get_xdata()) for line in plt.gca().lines]))
    monkeypatch.chdir(EXAMPLES)
    results, printed = asyncio.run(cells_executed())
    plt.close("all")
    assert repr(results["ptp"]) == "(<job 1 of x: move_absolute, done>, 100.0)"
    assert results["spindle"] == pytest.approx(1200.0, rel=0.1)
    assert "P-ERR-120002 axis x: move_absolute refused" in printed["refusal"]
    assert printed["program"].splitlines()[-1].endswith("100 %   0.0 s left")
    assert len(shown) == 2 and min(min(lines) for lines in shown) > 300


async def cells_executed() -> tuple[dict[str, object], dict[str, str]]:
    """The value of the last expression of each cell, and what it prints."""
    names: dict[str, object] = {"__name__": "__main__"}
    results, printed = {}, {}
    for cell in NOTEBOOK["cells"]:
        if cell["cell_type"] != "code":
            continue
        code = ast.parse("".join(cell["source"]), f"client.ipynb {cell['id']}")
        last = code.body.pop() if isinstance(code.body[-1], ast.Expr) else None
        out = StringIO()
        with redirect_stdout(out):
            exec(compile(code, f"client.ipynb {cell['id']}", "exec"), names)
            if isinstance(last, ast.Expr):
                results[cell["id"]] = eval(compile(ast.Expression(last.value), "client.ipynb", "eval"), names)
        printed[cell["id"]] = out.getvalue()
    return results, printed


def test_the_code_of_the_document_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Block by block with one offline machine; an iterator without an end ends where nothing moves."""
    (tmp_path / "config").symlink_to(ROOT / "config")
    (tmp_path / "part.nc").write_text("%part\nN10 G0 Z20\nN20 T1 M6\nN30 G1 X10 F6000\nM30\n")
    monkeypatch.chdir(tmp_path)
    text = (ROOT / "docs" / "client.md").read_text(encoding="utf-8")
    blocks = re.findall(r"^```python\n(.*?)^```", text, re.MULTILINE | re.DOTALL)
    out = StringIO()
    with Machine.offline("config/mill.yaml") as m, redirect_stdout(out):
        names = {"m": m, "asyncio": asyncio}
        for block in blocks:
            run_block(block, names)
            names["m"] = m
            m.x.move_absolute(5).wait()
        names["test_the_tool_is_changed_above_the_part"](m)
    assert len(blocks) == 8
    assert {"100.0", "T 1", "M 6", "True True 20.0", "True"} <= {*out.getvalue().splitlines()}


def run_block(block: str, names: dict[str, object]) -> None:
    code = compile(block, "client.md", "exec", flags=ast.PyCF_ALLOW_TOP_LEVEL_AWAIT)
    try:
        waits = eval(code, names)
        if waits is not None:
            asyncio.run(waits)
    except CncError as error:
        assert error.number == 26174


def test_a_typed_program_passes_mypy(tmp_path: Path) -> None:
    script = tmp_path / "typed.py"
    script.write_text(TYPED + '    m.axes["x"].move_absolute("far")\n')
    found = mypy(script)
    assert 'Argument 1 to "move_absolute" of "AxisCommands" has incompatible type "str"; expected "float"' in found
    assert found.endswith("Found 1 error in 1 file (checked 1 source file)\n")


def mypy(script: Path) -> str:
    """What mypy --strict says of a program that uses the package."""
    command = [sys.executable, "-m", "mypy", "--strict", "--config-file", "", "--follow-imports", "silent", str(script)]
    environment = os.environ | {"MYPYPATH": str(ROOT), "MYPY_CACHE_DIR": str(ROOT / ".mypy_cache" / "client")}
    return subprocess.run(
        command, cwd=script.parent, env=environment, capture_output=True, text=True, check=False
    ).stdout


TYPED = """
import asyncio

from cnc_ptp.client import (
    AxisState, CncError, HandshakeRequest, Job, Machine, MC_MoveAbsolute, MC_MoveVelocity, ProgramJob
)


def peak(m: Machine) -> float:
    job: Job = m.axes["x"].move_absolute(100.0)
    states: list[AxisState] = [state for state in m.axes["x"].states(duration=1.0)]
    job.wait(timeout=5.0)
    return max(state.set_velocity for state in states)


def answered(request: HandshakeRequest) -> bool:
    return request.kind == "M"


async def both(m: Machine) -> None:
    await asyncio.gather(m.axes["x"].move_absolute(0), m.axes["y"].move_absolute(10))
    async for state in m.axes["y"].states():
        print(state.set_position)


with Machine.offline("config/mill.yaml", record="a.mcap") as m:
    m.plc.on_handshake(answered)
    program: ProgramJob = m.channel.run("part.nc", text="M30").wait()
    print(program.progress, m.spindles["s"].start(1200).reached, m.time)
    m.x.move_absolute(1).wait()
    for event in m.events(duration=1.0):
        print(event.text)
    try:
        peak(m)
    except CncError as error:
        print(error.number, error.values)
    asyncio.run(both(m))
    move, turn = MC_MoveAbsolute(m.axes["x"]), MC_MoveVelocity(m.spindles["s"])
    for cycle in m.plc_cycles(duration=1.0):
        move(cycle > 100, position=5.0)
        turn(move.done, velocity=60.0)
        print(turn.in_velocity, move.error_text)
"""
