"""The machines in config/."""

import math
import subprocess
import sys
from pathlib import Path

import pytest

from cnc_ptp.parameters import ChannelSpindle, Synchronisation, read_machine

CONFIG = Path(__file__).parents[2] / "config"


@pytest.mark.parametrize("path", sorted(CONFIG.glob("*.yaml")), ids=lambda path: path.stem)
def test_machines_load_without_warnings(path: Path) -> None:
    assert read_machine(path).warnings == ()


@pytest.mark.parametrize("path", sorted(CONFIG.glob("*.yaml")), ids=lambda path: path.stem)
def test_ros_reads_the_machines_too(path: Path) -> None:
    rclpy = pytest.importorskip("rclpy")
    context = rclpy.Context()
    context.init(args=["--ros-args", "--params-file", str(path)])
    context.shutdown()


def test_mill() -> None:
    mill = read_machine(CONFIG / "mill.yaml")
    limits = {name: (axis.soft_limit_negative, axis.soft_limit_positive) for name, axis in mill.axes.items()}
    assert limits == {"x": (-300.0, 300.0), "y": (-200.0, 200.0), "z": (-150.0, 150.0)}
    assert [axis.rapid_velocity for axis in mill.axes.values()] == [300.0, 300.0, 200.0]
    assert [axis.acceleration for axis in mill.axes.values()] == [2000.0, 1800.0, 1500.0]
    assert [axis.jerk for axis in mill.axes.values()] == [50_000.0, 45_000.0, 37_500.0]
    for axis in mill.axes.values():
        assert axis.deceleration != axis.acceleration
        assert (axis.control.kv, axis.control.plant.time_constant) == (50.0, 0.003)
        assert axis.encoder_increment == 10.0 / 2**20
        assert axis.control.monitoring.kind == 4
        assert axis.control.monitoring.moving_limit > axis.max_velocity / axis.control.kv
    assert mill.axes["x"].max_velocity == 500.0
    assert [gear.max_speed for gear in mill.spindles["s"].gears.values()] == [12_000 * 6.0]
    assert mill.spindles["s"].gears[1].acceleration == 36_000.0


def test_channel_of_the_mill() -> None:
    channel = read_machine(CONFIG / "mill.yaml").channels["channel"]
    wait, tell = Synchronisation.MVS_SVS, Synchronisation.MOS
    assert [axis[:2] for axis in channel.axes] == [("X", "x"), ("Y", "y"), ("Z", "z")]
    assert channel.spindles == (
        ChannelSpindle("S", "s", wait, wait, wait, Synchronisation.NO_SYNCH, tell, own_name="S1", number=4),
    )
    assert (channel.main_spindle, channel.m_functions[8]) == ("S", wait)


def test_ptp() -> None:
    ptp = read_machine(CONFIG / "ptp.yaml")
    assert list(ptp.axes) == ["x", "y", "z", "c"]
    for name in "xyz":
        axis = ptp.axes[name]
        assert (axis.soft_limit_negative, axis.soft_limit_positive) == (-100_000.0, 100_000.0)
        assert (axis.max_velocity, axis.max_acceleration) == (10_000.0, 50_000.0)
        assert (axis.control.plant.time_constant, axis.encoder_increment) == (0.0, 0.0)
    c = ptp.axes["c"]
    assert (c.rotary, c.modulo, c.modulo_low, c.modulo_high, c.soft_limit_positive) == (
        True,
        True,
        0.0,
        360.0,
        math.inf,
    )


def test_loading_imports_neither_ros_nor_numbers() -> None:
    """Each of eight processes loads the machine: nothing heavy comes along."""
    program = (
        "import sys; from cnc_ptp.parameters import read_machine; read_machine(sys.argv[1]);"
        "assert not {'rclpy', 'numpy', 'plotly'} & set(sys.modules)"
    )
    command = [sys.executable, "-c", program, str(CONFIG / "mill.yaml")]
    subprocess.run(command, check=True, cwd=CONFIG.parent, timeout=60)
