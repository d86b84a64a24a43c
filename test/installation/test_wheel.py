"""Files of a wheel and their places: `ros2 run` and launch look for executables in lib/cnc_ptp of the prefix."""

import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest
from ament_index_python.packages import get_package_prefix

from cnc_ptp.compiled.sources import library_file, state_file

pytestmark = pytest.mark.long
ROOT = Path(__file__).parents[2]
SOURCES = (
    "cnc_ptp",
    "config",
    "examples",
    "launch",
    "resource",
    "package.xml",
    "setup.py",
    "setup.cfg",
    "pyproject.toml",
    "LICENSE",
)
COMMANDS = {
    "simulate",
    "run",
    "status",
    "jog",
    "check",
    "explain",
    "format",
    "replay",
    "report",
    "plot",
    "layout",
    "recover",
    "params",
    "identify",
    "circle",
    "curve",
    "lists",
    "sweep",
}
NODES = {"nc_channel", "axis", "spindle", "plc_bridge", "clock", "recorder", "player"}
EXECUTABLES = {"cnc_ptp", *COMMANDS, *NODES}
WITHOUT_CMAKE = """
import pathlib, runpy, subprocess, sys
def stage_one_file(command, **options):
    if "--install" in command:
        package = pathlib.Path(command[-1], "stage/lib/python3/site-packages/cnc_ptp/msg")
        package.mkdir(parents=True)
        (package / "__init__.py").touch()
subprocess.run = stage_one_file
sys.argv = ["setup.py", "--quiet", *sys.argv[1:]]
runpy.run_path("setup.py", run_name="__main__")
"""


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    """A wheel of everything but the generated interfaces, which take minutes."""
    source = tmp_path_factory.mktemp("source")
    generated = shutil.ignore_patterns("msg", "srv", "action", "*.so", "__pycache__")
    for name in SOURCES:
        if (ROOT / name).is_dir():
            shutil.copytree(ROOT / name, source / name, ignore=generated)
        else:
            shutil.copy2(ROOT / name, source / name)
    objects = f"build/kernel-{sys.implementation.cache_tag}"
    if (ROOT / objects).is_dir():  # they need not be compiled again
        shutil.copytree(ROOT / objects, source / objects)
    build = [sys.executable, "-c", WITHOUT_CMAKE, "bdist_wheel"]
    done = subprocess.run(build, cwd=source, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return next((source / "dist").glob("*.whl"))


def test_wheel_holds_the_executables(wheel):
    with zipfile.ZipFile(wheel) as archive:
        modes = {entry.filename: entry.external_attr >> 16 for entry in archive.infolist()}
    folder = "cnc_ptp-0.1.0.data/data/lib/cnc_ptp/"
    assert {name.removeprefix(folder) for name in modes if name.startswith(folder)} == EXECUTABLES
    assert all(modes[folder + name] & 0o111 == 0o111 for name in EXECUTABLES)


def test_wheel_holds_the_compiled_kernel(wheel):
    folder = Path("cnc_ptp", "compiled", "library")
    with zipfile.ZipFile(wheel) as archive:
        assert {str(library_file(folder)), str(state_file(folder))} <= {*archive.namelist()}
        assert "failure" not in archive.read(str(state_file(folder))).decode()


def test_installed_executable_runs(wheel, tmp_path, monkeypatch):
    """As ros2 run finds it, from anywhere, by a link as well."""
    prefix = tmp_path / "prefix with blank"
    pip = [sys.executable, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--no-deps", "--no-index"]
    subprocess.run([*pip, "--ignore-installed", "--prefix", prefix, wheel], check=True)
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(prefix))
    executable = Path(get_package_prefix("cnc_ptp"), "lib", "cnc_ptp", "params")
    assert os.access(executable, os.X_OK) and (prefix / "bin" / "cnc_ptp").exists()
    link = tmp_path / "link"
    link.symlink_to(executable)
    for path in (executable, link):
        done = subprocess.run([path, "P-AXIS-00099"], cwd="/", capture_output=True, text=True, check=True)
        assert "getriebe[i].kv" in done.stdout


def test_this_environment_has_the_executables(monkeypatch):
    monkeypatch.setenv("AMENT_PREFIX_PATH", sys.prefix)
    folder = Path(get_package_prefix("cnc_ptp"), "lib", "cnc_ptp")
    assert {path.name for path in folder.iterdir() if os.access(path, os.X_OK)} == EXECUTABLES
    done = subprocess.run([folder / "check", "examples/bracket.nc"], cwd=ROOT, capture_output=True, check=False)
    assert done.returncode == 0, done.stderr
