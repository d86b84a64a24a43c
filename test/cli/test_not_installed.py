"""What is said where a package, or what is generated, is missing: no traceback."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from machine_support import ROOT

from cnc_ptp import __main__ as entry

MISSING = 'raise ModuleNotFoundError(f"No module named {__name__!r}", name=__name__)\n'


@pytest.mark.parametrize(
    ("package", "words"),
    [
        ("click", ("--version",)),
        ("numpy", ("simulate", "config/ptp.yaml", "--duration", "0.1")),
        ("rclpy", ("status",)),
    ],
)
def test_a_missing_package_is_one_line(package: str, words: tuple[str, ...], tmp_path: Path) -> None:
    (tmp_path / f"{package}.py").write_text(MISSING)
    environment = os.environ | {"PYTHONPATH": f"{tmp_path}:{ROOT}", "CNC_PTP_PURE": "0"}
    done = subprocess.run(
        [sys.executable, "-m", "cnc_ptp", *words], cwd=ROOT, env=environment, capture_output=True, text=True
    )
    assert (done.returncode, done.stderr.splitlines()[-1]) == (
        2,
        f"cnc_ptp is not installed completely (No module named '{package}'); call `make setup` first",
    )
    assert "Traceback" not in done.stderr and done.stdout == ""


def test_missing_interfaces_are_no_mistake_of_ours(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    error = ImportError("cannot import name 'msg' from 'cnc_ptp'", name="cnc_ptp")
    assert entry.is_our_mistake(error)
    monkeypatch.setattr(entry, "__file__", str(tmp_path / "__main__.py"))
    assert not entry.is_our_mistake(error)


def test_a_mistake_of_ours_keeps_its_traceback() -> None:
    assert entry.is_our_mistake(ImportError("cannot import name 'x' from 'cnc_ptp.cli'", name="cnc_ptp.cli"))
    assert entry.is_our_mistake(ImportError("cannot import name 'x' from 'numpy'", name="numpy", path="numpy/a.py"))
    assert entry.is_our_mistake(ImportError("no name at all"))
    assert not entry.is_our_mistake(ModuleNotFoundError("No module named 'rich.box'", name="rich.box"))
    of_numpy = ImportError("IMPORTANT: PLEASE READ THIS")
    of_numpy.__cause__ = ImportError("libblas.so: cannot open", name="_multiarray_umath", path="/lib/_umath.so")
    assert not entry.is_our_mistake(of_numpy)
    assert not entry.is_our_mistake(ImportError("librcl.so: cannot open", name="_rclpy", path="/lib/_rclpy.so"))
