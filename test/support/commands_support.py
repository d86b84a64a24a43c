"""Helpers of the tests of the commissioning commands: machines, calls, synthetic recordings."""

import socket
import subprocess
import sys
from pathlib import Path

import yaml
from click.testing import CliRunner

from cnc_ptp import cli
from cnc_ptp.protocol.blocks import AxisBlock, CycleTick
from cnc_ptp.recording.writer import Recording

ROOT = Path(__file__).parents[2]
MILL = ROOT / "config" / "mill.yaml"
PTP = ROOT / "config" / "ptp.yaml"


OF_THE_BLOCK = (
    "master",
    "target_velocity",
    "modulo_begin",
    "modulo_length",
    "torque_digits",
    "couples_actual",
    "probe_on",
    "probe_switched",
    "probe_cycle",
    "probe_position",
    "job",
    "job_events",
    "answers",
    "control_units",
)


def call(*arguments):
    return CliRunner().invoke(cli.main, [str(argument) for argument in arguments])


def served(recording):
    """The finished command `web`, that has refused a recording."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    words = [sys.executable, "-m", "cnc_ptp", "web", str(recording), "--port", str(port)]
    return subprocess.run(words, capture_output=True, text=True, timeout=100, check=False)


def changed_mill(path, axis, **sections):
    """A copy of the mill with sections of one axis replaced or extended key by key; returns its path."""
    machine = yaml.safe_load(MILL.read_text())
    parameters = machine[f"/{axis}"]["ros__parameters"]
    for name, values in sections.items():
        merge(parameters.setdefault(name, {}), values)
    path.write_text(yaml.safe_dump(machine))
    return path


def merge(into, values):
    for name, value in values.items():
        if isinstance(value, dict) and isinstance(into.get(name), dict):
            merge(into[name], value)
        else:
            into[name] = value


def paste(machine, lines, path):
    """The machine file with the lines that an identification wrote; tables are replaced as a whole."""
    whole = yaml.safe_load(Path(machine).read_text())
    for node, content in yaml.safe_load(lines).items():
        parameters = whole[node]["ros__parameters"]
        if "frict_comp" in content["ros__parameters"]:
            parameters.pop("frict_comp", None)
        merge(parameters, content["ros__parameters"])
    path.write_text(yaml.safe_dump(whole))
    return path


def recording_of(path, axis, columns, *, machine=""):
    """A recording of one axis: `columns` by field, 10 values a block; what is not given is 0."""
    names = [name for name in AxisBlock.__dataclass_fields__ if name not in ("first_cycle", "count", *OF_THE_BLOCK)]
    length = len(next(iter(columns.values()))) // 10 * 10
    with Recording(str(path), machine, 0, 1_000_000) as recording:
        for first in range(0, length, 10):
            recording.tick(CycleTick(first, 10))
            rows = {
                name: [float(value) for value in columns.get(name, [0.0] * length)[first : first + 10]]
                for name in names
            }
            for name in ("state", "status_bits", "error_id"):
                rows[name] = [0] * 10
            recording.block(axis, AxisBlock(first, 10, **rows))
    return path
