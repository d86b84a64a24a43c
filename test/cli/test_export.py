"""`cnc_ptp export`: a topic of a recording as a file."""

import os
import platform
from importlib.metadata import version

import numpy as np
import pytest
from click.testing import CliRunner
from recording_support import smooth_run

import cnc_ptp.recording
from cnc_ptp import cli


@pytest.fixture
def recording(tmp_path):
    smooth_run(tmp_path / "run.mcap", 0.5)
    return tmp_path / "run.mcap"


def call(*arguments):
    return CliRunner().invoke(cli.main, [str(argument) for argument in arguments])


def test_a_window_of_some_fields(recording, tmp_path):
    output = tmp_path / "x.npz"
    result = call(
        "export",
        recording,
        "--topic",
        "x/state",
        "--fields",
        "cycle,set_jerk",
        "--from",
        0.1,
        "--to",
        0.2,
        "-o",
        output,
    )
    assert (result.exit_code, result.output) == (0, f"{output}: 101 rows of /x/state\n")
    archive = np.load(output)
    assert archive.files == ["time", "cycle", "set_jerk"]
    assert archive["cycle"].tolist() == list(range(100, 201))
    assert sorted(path.name for path in tmp_path.iterdir()) == ["metadata.yaml", "run.mcap", "x.npz"]


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("x.xlsx", "the file name of an export must end in .csv, .parquet or .npz; nothing was started"),
        ("none/x.csv", "/none, make it or give another name; nothing was started"),
    ],
)
def test_outputs_that_cannot_be(recording, tmp_path, name, text):
    result = call("export", recording, "--topic", "/x/state", "-o", tmp_path / name)
    assert result.exit_code == 2
    assert "P-ERR-27030" in result.output and text in " ".join(result.output.split())


def test_disk_that_is_full_leaves_no_file(recording, tmp_path, monkeypatch):
    def full(*_arguments, **_options):
        raise OSError(28, os.strerror(28))

    monkeypatch.setattr("cnc_ptp.commands.look.export.export_topic", full)
    result = call("export", recording, "--topic", "/x/state", "-o", tmp_path / "x.csv")
    assert result.exit_code == 2
    assert "No space left on device; the recording is unchanged" in " ".join(result.output.split())
    assert sorted(path.name for path in tmp_path.iterdir()) == ["metadata.yaml", "run.mcap"]


def test_a_recording_says_what_the_run_was_computed_by(tmp_path):
    run = tmp_path / "run.mcap"
    assert call("simulate", "config/ptp.yaml", "--duration", 0.05, "--record", run).exit_code == 0
    with cnc_ptp.recording.open(run) as recording:
        found = recording.metadata
    assert (found["version"], found["kernel"]) == (version("cnc_ptp"), cnc_ptp.KERNEL.kind)
    assert (found["python"], found["host"]) == (platform.python_version(), platform.node())
