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
    where.dispatchEvent(new PointerEvent(kind, { clientX: x, clientY: y, bubbles: true }));
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
  const click = (time) => {
    mouse("pointerdown", time, drag);
    mouse("pointerup", time, document);
  };
  click(0.26);
  mouse("pointermove", 0.2802);
  await until(() => plot.querySelector(".cursor-time"));
  found.time = plot.querySelector(".cursor-time").textContent;
  found.values = Array.from(plot.querySelectorAll(".cursor-values")).map((box) => box.innerText);
  found.lines = plot.querySelectorAll(".cursor-line").length;
  click(0.28);
  found.measured = document.getElementById("measured").innerText;
  window.dispatchEvent(new KeyboardEvent("keydown", { key: "Escape" }));
  found.cleared = document.getElementById("measured").hidden;
  found.without = plot.querySelectorAll(".cursor-line").length;
  before = scale();
  await Plotly.relayout(plot, { "xaxis.range[0]": 0, "xaxis.range[1]": 2 });
  await until(() => scale() !== before);
  found.again = of("X: position in mm", "actual");
  found.words = plot.data.find((one) => one.meta === "commands").text;
  found.events = plot.data.filter((one) => one.meta === "events").map((one) => one.text);

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


@pytest.mark.long
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
    assert speed.splitlines() == ["set 560  Δ +40  +2000 /s", "actual 548.8  Δ +39.2  +1960 /s"]
    now, before = position(280), position(260)
    [found] = [
        match
        for text in probe["values"]
        if (match := re.search(r"actual (\S+)  Δ (\S+)", text))
        and float(match[1].replace("−", "-")) == pytest.approx(now, abs=1e-3)
    ]
    assert float(found[2].replace("−", "-")) == pytest.approx(now - before, abs=1e-3)


def test_two_marks_measure(probe, position):
    """Values, difference and slope of each line between them."""
    head, *rows = [line.split("\t") for line in probe["measured"].splitlines()]
    assert head == ["A 0.26 s, B 0.28 s, Δt +0.02 s", "A", "B", "Δ", "slope"]
    values = {name: cells for name, *cells in rows}
    assert values["s: speed in rpm, actual"] == ["509.6", "548.8", "+39.2", "+1960 /s"]
    before, now, change, slope = (
        float(cell.removesuffix(" /s").replace("−", "-")) for cell in values["X: position in mm, actual"]
    )
    assert (before, now) == (pytest.approx(position(260), abs=1e-3), pytest.approx(position(280), abs=1e-3))
    assert change == pytest.approx(position(280) - position(260), abs=1e-3)
    assert slope == pytest.approx((position(280) - position(260)) / 0.02, rel=1e-3)
    assert probe["cleared"] is True


def test_words_of_events_have_room(probe):
    info, warning, error = probe["events"]
    assert info == ["channel: program started"]
    assert warning[0].startswith("P-ERR-24010 spindle s: speed 980 rpm")
    assert error[0].startswith("P-ERR-23020 axis y: following error")


def test_words_of_commands_have_room(probe):
    assert probe["words"][0] == ""  # the next one comes 10 ms later
    assert probe["words"][1].startswith("channel start")
    assert probe["words"][2].startswith("x move absolute target = 9999")
    assert probe["marks"] == ["", "", ""]  # none in the part that is shown


PLACES = """
<script>
(async function () {
  const plot = document.getElementById("time"), found = {};
  while (plot.dataset.cycles !== "all") await new Promise((next) => setTimeout(next, 50));
  const [plane, space, length] = ["path0", "path1", "length"].map((name) => document.getElementById(name));
  const until = async (done) => {
    for (let i = 0; i < 100 && !done(); i++) await new Promise((next) => setTimeout(next, 50));
  };
  found.narrow = [document.documentElement.scrollWidth, document.documentElement.clientWidth, plot.clientWidth];
  const mark = plane.querySelector(".cursor-place");
  found.before = mark.hidden;
  const place = () => {
    const { xaxis, yaxis } = plane._fullLayout;
    return [xaxis.p2d(parseFloat(mark.style.left) - xaxis._offset), yaxis.p2d(parseFloat(mark.style.top) - yaxis._offset)];
  };
  const cursor = space.data[space.data.length - 1];
  window.page.setCursor(0.3);
  await until(() => cursor.x[0] !== null);
  found.plane = place();
  found.space = ["x", "y", "z"].map((axis) => cursor[axis][0]);
  plane.emit("plotly_hover", { points: [{ customdata: 0.75 }] });
  found.time = plot.querySelector(".cursor-time").textContent;
  found.again = place();
  plane.emit("plotly_unhover", {});
  found.after = mark.hidden;
  const colours = (kind) => plane._fullLayout.updatemenus[0].buttons.map((button) => button.label);
  found.colours = colours();
  window.dispatchEvent(new Event("beforeprint"));
  found.paper = Array.from(document.querySelectorAll(".paper > div"), (box) => box.querySelectorAll(".main-svg").length);
  found.heights = Array.from(document.querySelectorAll(".paper > div"), (box) => parseFloat(box.style.height));
  found.widths = [plane, space].map((one) => one.layout.width);
  window.dispatchEvent(new Event("afterprint"));
  found.screen = document.querySelectorAll(".paper > div").length;
  const result = document.createElement("pre");
  result.id = "probe";
  result.textContent = encodeURIComponent(JSON.stringify(found));
  document.body.appendChild(result);
})();
</script>
"""


@pytest.fixture(scope="module")
def places(tmp_path_factory):
    """A whole report in a narrow window."""
    folder = tmp_path_factory.mktemp("places")
    smooth_run(folder / "run.mcap", 2.0)
    page = report_page(read_recording(folder / "run.mcap"))
    (folder / "run.html").write_text(page.replace("</body></html>", PLACES + "</body></html>"), encoding="utf-8")
    document, console = open_page(folder / "run.html", width=500)
    found = re.search(r'<pre id="probe">([^<]*)</pre>', document)
    assert found, console
    return json.loads(unquote(found[1]))


def test_the_cursor_has_a_place_on_the_paths(places, position):
    """Of 0.3 s; the circle is that of the actual position."""
    assert places["before"] is True
    assert places["plane"][0] == pytest.approx(position(300), abs=0.3)
    assert places["space"][0] == pytest.approx(position(300), abs=0.01)
    assert places["space"][2] == pytest.approx(3.0 * 0.3 - 3.0 / 16.7, abs=0.01)


def test_a_place_on_a_path_has_a_time(places, position):
    assert places["time"] == "0.75 s"
    assert places["again"][0] == pytest.approx(position(750), abs=0.3)
    assert places["after"] is True


def test_the_path_is_coloured_by_feed_and_following_error(places):
    assert places["colours"] == ["feed", "following error"]


def test_a_narrow_page_does_not_scroll_sideways(places):
    whole, seen, plot = places["narrow"]
    assert whole <= seen <= 500
    assert plot < seen


def test_paper_has_groups_of_plots(places):
    """20 plots over time; each group fits on A4 at 96 pixels an inch, between margins of 12 mm."""
    assert len(places["paper"]) >= 4
    assert all(count >= 1 for count in places["paper"])
    assert max(places["heights"]) <= (297 - 24) / 25.4 * 96
    assert places["widths"] == [700, 700]
    assert places["screen"] == 0
