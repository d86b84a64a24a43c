"""The report opened in a real browser without a network: the plots are drawn and no script fails."""

import json
import math
import re
from urllib.parse import unquote

import pytest
from browser_support import BROWSER, failures, open_page
from recording_support import smooth_run

from cnc_ptp.plots.report import plots_page, report_page
from cnc_ptp.recording.reader import read_recording
from cnc_ptp.recording.rows import time_rows

EVIL = "</script><script>document.title='taken over'</script><img src=x onerror=\"document.title='taken over'\">"
pytestmark = pytest.mark.skipif(BROWSER is None, reason="no Chromium in PATH (apt-get install chromium)")


PROBE = """
<script>
(async function () {
  const plot = document.getElementById("time"), found = {};
  while (plot.dataset.cycles !== "all") await new Promise((next) => setTimeout(next, 50));
  const find = (title, name) => {
    const axis = "y" + (plot.layout.annotations.findIndex((note) => note.text === title) + 1);
    return plot.data.find((one) => one.yaxis === axis && one.name === name);
  };
  const of = (title, name) => {
    const trace = find(title, name);
    const range = plot.layout[trace.yaxis.replace("y", "yaxis")].range;
    return { x: Array.from(trace.x), y: Array.from(trace.y), range };
  };
  const mouse = (kind, time, target) => {
    const layout = plot._fullLayout, box = plot.getBoundingClientRect();
    const x = box.left + layout._size.l + layout.xaxis.d2p(time), y = box.top + layout.yaxis2._offset + 20;
    const where = target || plot;
    where.dispatchEvent(new MouseEvent(kind, { clientX: x, clientY: y, bubbles: true, detail: 1 }));
  };
  const until = async (done) => {
    for (let i = 0; i < 100 && !done(); i++) await new Promise((next) => setTimeout(next, 50));
  };
  const scale = () => plot.layout.yaxis2.range.join();
  let before = scale();
  found.whole = of("X: position in mm", "actual");
  await Plotly.relayout(plot, { "xaxis.range[0]": 0.25, "xaxis.range[1]": 0.3 });
  await until(() => scale() !== before);
  found.zoomed = of("X: position in mm", "actual");
  found.speed = of("s: speed in rpm", "set");
  found.marks = plot.data.find((one) => one.meta === "commands").text;
  const drag = plot.querySelector(".nsewdrag");
  mouse("mousedown", 0.26, drag);
  mouse("mouseup", 0.26, document);
  mouse("mousemove", 0.2802);
  await until(() => plot.querySelector(".cursor-time"));
  found.time = plot.querySelector(".cursor-time").textContent;
  found.values = Array.from(plot.querySelectorAll(".cursor-values")).map((box) => box.innerText);
  found.lines = plot.querySelectorAll(".cursor-line").length;
  window.dispatchEvent(new KeyboardEvent("keydown", { key: "Escape" }));
  found.without = plot.querySelectorAll(".cursor-line").length;
  before = scale();
  await Plotly.relayout(plot, { "xaxis.range[0]": 0, "xaxis.range[1]": 2 });
  await until(() => scale() !== before);
  found.again = of("X: position in mm", "actual");
  found.words = plot.data.find((one) => one.meta === "commands").text;

  const update = Plotly.update;
  const zoom = (begin, end) => Plotly.relayout(plot, { "xaxis.range[0]": begin, "xaxis.range[1]": end });
  const busy = (meanwhile) => {
    Plotly.update = async (...all) => {
      Plotly.update = update;
      await meanwhile();
      return update(...all);
    };
  };
  const shows = (time) => {
    const { x } = of("X: position in mm", "actual");
    return x.length < 100 && x.includes(time);
  };
  busy(() => zoom(0.9, 0.95));
  await zoom(0.5, 0.55);
  await until(() => shows(0.92));
  found.late = of("X: position in mm", "actual");
  const hidden = plot.data.indexOf(find("X: position in mm", "set"));
  busy(() => Plotly.restyle(plot, { visible: "legendonly" }, [hidden]));
  await zoom(0.24, 0.26);
  await until(() => shows(0.25) && of("X: position in mm", "actual").range[0] > 5);
  found.alone = of("X: position in mm", "actual");
  busy(() => Promise.reject(new Error("Plotly failed")));
  await zoom(1.1, 1.15);
  await zoom(1.5, 1.55);
  await until(() => shows(1.52));
  found.behind = of("X: position in mm", "actual");
  const result = document.createElement("pre");
  result.id = "probe";
  result.textContent = encodeURIComponent(JSON.stringify(found));
  document.body.appendChild(result);
})();
</script>
"""


@pytest.fixture(scope="module")
def opened(tmp_path_factory):
    folder = tmp_path_factory.mktemp("browser")
    smooth_run(folder / "run.mcap", 2.0, text=EVIL)
    page = report_page(read_recording(folder / "run.mcap"), program="bracket.nc")
    (folder / "run.html").write_text(page, encoding="utf-8")
    return open_page(folder / "run.html")


def test_no_script_fails(opened):
    _, console = opened
    assert failures(console) == []


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


@pytest.fixture(scope="module")
def probe(tmp_path_factory):
    """What the plots held before, while and after the page was zoomed to 0.25 ... 0.3 s, and behind later zooms."""
    folder = tmp_path_factory.mktemp("probe")
    smooth_run(folder / "run.mcap", 2.0)
    recorded = read_recording(folder / "run.mcap")
    page = plots_page(recorded, list(time_rows(recorded, {}, {})), title="run")
    (folder / "run.html").write_text(page.replace("</body></html>", PROBE + "</body></html>"), encoding="utf-8")
    document, console = open_page(folder / "run.html")
    found = re.search(r'<pre id="probe">([^<]*)</pre>', document)
    assert found, console
    return json.loads(unquote(found[1]))


@pytest.fixture(scope="module")
def position():
    """Actual position of x in mm by cycle, from the formula of the run."""
    speed = 2.0 * math.pi
    return lambda cycle: 40.0 * math.cos(speed * 0.001 * cycle) + 40.0 * speed * math.sin(speed * 0.001 * cycle) / 16.7


def test_zoomed_plots_show_every_cycle(probe, position):
    cycles = [round(time * 1000) for time in probe["zoomed"]["x"]]
    assert set(range(250, 301)) <= set(cycles) <= set(range(248, 303))
    assert len(cycles) == len(set(cycles))
    for cycle, value in zip(cycles, probe["zoomed"]["y"], strict=True):
        assert value == pytest.approx(position(cycle), abs=1e-4)


def test_scales_follow_the_zoom(probe, position):
    low, high = probe["zoomed"]["range"]
    values = [position(cycle) for cycle in range(249, 302)]
    values += [40.0 * math.cos(2.0 * math.pi * 0.001 * cycle) for cycle in range(249, 302)]  # the set position
    span = max(values) - min(values)
    assert min(values) - 0.3 * span < low < min(values)
    assert max(values) < high < max(values) + 0.3 * span
    low, high = probe["again"]["range"]
    assert low < -40.0 and high > 40.0
    assert max(probe["again"]["y"]) == pytest.approx(max(map(position, range(2000))), abs=1e-4)


def shown_cycles(part):
    return {round(time * 1000) for time in part["x"]}


def test_what_comes_while_plotly_is_at_work_is_not_lost(probe, position):
    """Another zoom, and a line hidden by its legend entry: points and scale are those of the last window."""
    assert set(range(900, 951)) <= shown_cycles(probe["late"]) <= set(range(898, 953))
    low, high = probe["alone"]["range"]
    actual = [position(cycle) for cycle in range(239, 262)]
    assert 0.0 < min(actual) - low < 2.0 and 0.0 < high - max(actual) < 2.0  # the set position is about 0 there


def test_zooming_goes_on_behind_a_failure(probe):
    assert set(range(1500, 1551)) <= shown_cycles(probe["behind"]) <= set(range(1498, 1553))


def test_cursor_and_reference(probe, position):
    assert probe["time"] == "0.28 s   Δt +0.02 s"
    assert (probe["lines"], probe["without"]) == (2, 1)
    [speed] = [text for text in probe["values"] if text.startswith("set 560")]
    assert speed.splitlines() == ["set 560  Δy +40", "actual 548.8  Δy +39.2"]
    now, before = position(280), position(260)
    [found] = [
        match
        for text in probe["values"]
        if (match := re.search(r"actual (\S+)  Δy (\S+)", text))
        and float(match[1].replace("−", "-")) == pytest.approx(now, abs=1e-3)
    ]
    assert float(found[2].replace("−", "-")) == pytest.approx(now - before, abs=1e-3)


def test_words_of_commands_have_room(probe):
    assert probe["words"][0] == ""  # the next one comes 10 ms later
    assert probe["words"][1].startswith("channel start")
    assert probe["words"][2].startswith("x move absolute target = 9999")
    assert probe["marks"] == ["", "", ""]  # none in the part that is shown
