"""docs/recordings.md: recording on demand, as it is written there."""

import re
import shlex
import shutil

import pytest
from graph_support import ROOT, Running, run

from cnc_ptp.recording.stored_states import read_stored


@pytest.mark.long
def test_recording_on_demand(tmp_path, monkeypatch):
    text = (ROOT / "docs" / "recordings.md").read_text()
    first, then = re.findall(r"^```\n(.*?)^```$", text.partition("## Recording on demand")[2], re.M | re.S)[:2]
    for name in ("config", "examples"):
        shutil.copytree(ROOT / name, tmp_path / name)
    monkeypatch.chdir(tmp_path)
    command = shlex.split(first)
    assert command[:2] == ["cnc_ptp", "run"]
    with Running(*command[2:]) as graph:
        graph.wait_for_nodes(7)
        for line in then.splitlines():
            run(*shlex.split(line)[1:])
    for name in ("a.mcap", "b.mcap"):
        assert read_stored(tmp_path / name).complete
