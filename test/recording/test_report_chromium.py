"""The report opened in a real browser without a network: the plots are drawn and no script fails."""

import re
import shutil
import subprocess

import pytest
from recording_support import smooth_run

from cnc_ptp.recording.reader import read_recording
from cnc_ptp.recording.report import write_report

BROWSER = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
EVIL = "</script><script>document.title='taken over'</script><img src=x onerror=\"document.title='taken over'\">"
pytestmark = pytest.mark.skipif(BROWSER is None, reason="no Chromium in PATH (apt-get install chromium)")


@pytest.fixture(scope="module")
def opened(tmp_path_factory):
    """The document after its scripts have run, and what the browser said on its console."""
    folder = tmp_path_factory.mktemp("browser")
    smooth_run(folder / "run.mcap", 2.0, text=EVIL)
    write_report(read_recording(folder / "run.mcap"), folder / "run.html", program="bracket.nc")
    command = [
        BROWSER,
        "--headless",
        "--no-sandbox",
        "--disable-gpu",
        "--disable-background-networking",
        "--enable-unsafe-swiftshader",
        "--host-resolver-rules=MAP * ~NOTFOUND",
        f"--user-data-dir={folder / 'profile'}",
        "--enable-logging=stderr",
        "--virtual-time-budget=20000",
        "--window-size=1400,1000",
        "--dump-dom",
        (folder / "run.html").as_uri(),
    ]
    done = subprocess.run(command, capture_output=True, text=True, timeout=240, check=True)
    return done.stdout, [line for line in done.stderr.splitlines() if ":CONSOLE" in line]


def test_no_script_fails(opened):
    _, console = opened
    assert [line for line in console if re.search(r"Uncaught|Error|Refused|violates", line)] == []


def test_all_plots_are_drawn(opened):
    document, _ = opened
    assert document.count('class="main-svg"') >= 6  # three figures, each with several layers
    assert len(re.findall(r'<path class="js-line"[^>]* d="M', document)) >= 27
    assert document.count('class="gl-container"') >= 1
    assert len(re.findall(r"following error in mm</text>", document)) == 3
    assert 'class="point"' in document  # state bands


def test_text_of_the_recording_is_no_code(opened):
    document, _ = opened
    assert "<title>bracket.nc</title>" in document
    assert "taken over" in document


def test_nothing_offers_to_send_data_away(opened):
    document, _ = opened
    assert 'data-title="Download plot' in document
    assert not re.search(r'data-title="[^"]*(Share|Edit|cloud|Cloud)', document)
