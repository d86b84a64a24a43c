"""The pages with a real machine behind them: an offline one that runs in real time, without DDS."""

import asyncio
import shutil
import time
from contextlib import suppress
from pathlib import Path

import pytest
from web_browser_support import PATIENCE, PHONE, TABLET, InThread, eventually, open_page, until
from web_support import EXAMPLES, MILL, ROOT, waiting_mill

from cnc_ptp.commands.run.web import words_of
from cnc_ptp.parameters import read_machine
from cnc_ptp.web.access.access import Access
from cnc_ptp.web.access.guard import Names
from cnc_ptp.web.faces.machine_face import offline_face
from cnc_ptp.web.hub import Hub
from cnc_ptp.web.programs.programs import ProgramFolder
from cnc_ptp.web.server import Server

LONG_PATIENCE = 120_000
"""ms, for a simulation in a process of its own."""


@pytest.fixture
def programs(tmp_path):
    for name in ("bracket.nc", "cover.nc", "turned_part.nc"):
        shutil.copy(Path(EXAMPLES) / name, tmp_path / name)
    return tmp_path


@pytest.fixture
def mill(browser, programs):
    yield from pages_of(browser, programs, MILL)


@pytest.fixture
def lathe(browser, programs):
    yield from pages_of(browser, programs, str(ROOT / "config" / "lathe.yaml"))


@pytest.fixture
def two_channels(browser, programs):
    """channel1 has X, channel2 has Y."""
    yield from pages_of(browser, programs, str(ROOT / "examples" / "spindles" / "two_channels.yaml"))


@pytest.fixture
def waiting(browser, programs, tmp_path_factory):
    """Its functions wait for an acknowledgement."""
    yield from pages_of(browser, programs, waiting_mill(tmp_path_factory.mktemp("machine")))


@pytest.fixture
def tuned(browser, programs):
    """Its machine file is in the folder of the test."""
    yield from pages_of(browser, programs, str(shutil.copy(MILL, programs / "mill.yaml")))


def pages_of(browser, programs, machine):
    """Opens pages of an offline machine; `hub` and `server` are those of the pages."""
    hub = Hub(lambda: offline_face(machine), name="machine", folder=ProgramFolder(str(programs)), machine_file=machine)
    with InThread(Server(hub, Access(None), Names(), words=words_of).app) as server:
        pages = []

        def open_one(name="operate", **options):
            pages.append(open_page(browser, f"{server.url}#{name}", **{"command": True, **options}))
            return pages[-1]

        open_one.hub, open_one.server = hub, server
        yield open_one
        complaints = [text for page in pages for text in page.complaints.texts]
        for page in pages:
            page.close()
        assert complaints == []


def load(page, name="bracket.nc"):
    page.wait_for_selector(f"option:text-is('{name}')", state="attached")
    page.select_option("[aria-label='Load a program']", name)
    page.wait_for_selector(f".program-name >> text={name}")
    until(page, "app.store.units.channel.state === 'ready'")


def test_a_program_is_loaded_run_overridden_held_and_reset(mill):
    page = mill()
    load(page)
    page.wait_for_selector(".line >> text=; Bracket, 120 x 80")
    page.click("button.primary >> text=Start")
    page.wait_for_selector(".line.active")
    until(page, "app.store.units.channel.progress > 0")
    page.locator("[data-unit=channel] input").fill("60")
    until(page, "app.store.units.channel.override === 60")
    page.click("text=Feed hold")
    page.wait_for_selector("button >> text=Resume")
    page.click("button >> text=Resume")
    until(page, "app.store.units.channel.state === 'running'")
    page.click("button:text-is('Reset')")
    until(page, "!app.store.units.channel.active")


def test_a_held_button_moves_the_axis_and_its_end_stops_it(mill):
    page = mill()
    jog_until(page, "app.store.units.x.set_position > 1")
    page.mouse.up()
    until(page, "app.store.units.x.state === 'Standstill'")
    there = page.evaluate("app.store.units.x.set_position")
    page.wait_for_timeout(300)
    assert page.evaluate("app.store.units.x.set_position") == there
    jog_until(page, f"app.store.units.x.set_position > {there} + 1")
    page.evaluate("window.dispatchEvent(new Event('blur'))")
    until(page, "app.store.units.x.state === 'Standstill'")
    page.mouse.up()


def test_a_finger_on_a_tablet_moves_the_axis_and_stops_it_when_it_is_lifted(mill):
    page = mill(size=TABLET, touch=True)
    page.wait_for_selector(".jog")
    assert page.evaluate("matchMedia('(pointer: coarse)').matches && navigator.maxTouchPoints > 0")
    assert page.evaluate("document.documentElement.scrollWidth") <= TABLET["width"]
    finger = Finger(page, "Jog X +")
    hold_until(page, finger.press, finger.lift, "app.store.units.x.set_position > 25")  # longer than a long press
    page.wait_for_selector("[aria-label='Jog X +'].held")
    finger.lift()
    until(page, "app.store.units.x.state === 'Standstill'")
    there = page.evaluate("app.store.units.x.set_position")
    page.wait_for_timeout(300)
    assert page.evaluate("app.store.units.x.set_position") == there
    assert page.locator(".jog.held").count() == 0


class Finger:
    """Of a person who touches a button. Playwright only taps."""

    def __init__(self, page, name):
        self._devtools = page.context.new_cdp_session(page)
        button = page.locator(f"[aria-label='{name}']")
        button.scroll_into_view_if_needed()
        box = button.bounding_box()
        self._place = {"x": box["x"] + box["width"] / 2, "y": box["y"] + box["height"] / 2}

    def press(self):
        self._devtools.send("Input.dispatchTouchEvent", {"type": "touchStart", "touchPoints": [self._place]})

    def lift(self):
        self._devtools.send("Input.dispatchTouchEvent", {"type": "touchEnd", "touchPoints": []})


def test_a_jog_that_the_axis_refuses_is_told_and_its_button_released(mill, programs):
    (programs / "slow.nc").write_text("%SLOW\nN10 G1 X100 F60\nN20 M30\n", encoding="utf-8")
    page = mill()
    refused = ".notice.error >> text=/axis x: jog refused: .*; nothing was changed/"
    page.evaluate("app.command('x', 'power', { enabled: false })")
    until(page, "app.store.units.x.state === 'Disabled'")
    press_jog(page)
    page.wait_for_selector(refused)
    assert "the axis is in Disabled" in page.inner_text(refused)
    page.wait_for_selector(".jog.held", state="detached")
    page.mouse.up()
    page.click("[aria-label='Close notice']")
    page.evaluate("app.command('x', 'power', { enabled: true })")
    until(page, "app.store.units.x.state === 'Standstill'")
    load(page, "slow.nc")
    page.click("button.primary >> text=Start")
    until(page, "app.store.units.x.set_velocity > 0")
    press_jog(page)
    page.wait_for_selector(refused)
    page.wait_for_selector(".jog.held", state="detached")
    page.mouse.up()
    page.click("button:text-is('Reset')")


async def watch_velocity(hub, samples):
    """Time (s, of this computer) and set velocity of x, every few ms, until it stands."""
    end = time.monotonic() + PATIENCE / 1000
    while time.monotonic() < end and not (samples and samples[-1][1] == 0.0):
        samples.append((time.monotonic(), abs(hub.face.state()["x"]["set_velocity"])))
        await asyncio.sleep(0.005)


def press_jog(page):
    until(page, "app.roundTrip.time < 100")  # it is long while a page is being drawn
    box = page.locator("[aria-label='Jog X +']").bounding_box()
    page.mouse.move(box["x"] + 10, box["y"] + 10)
    page.mouse.down()


def jog_until(page, expression):
    """Holds the button with the mouse."""
    hold_until(page, lambda: press_jog(page), page.mouse.up, expression)


def hold_until(page, press, lift, expression):
    """A page that is too busy to repeat its jog in time ends it: it is pressed again."""
    for _ in range(20):
        press()
        for _ in range(40):
            if page.evaluate(f"() => ({expression})"):
                return
            page.wait_for_timeout(50)
        lift()
    raise AssertionError(f"no jog until {expression}")


def jog_until_it_moves(page):
    jog_until(page, "app.store.units.x.set_velocity > 10 && app.store.units.x.set_acceleration === 0")


@pytest.mark.parametrize("how", ["crash", "close"])
def test_an_axis_stops_when_its_page_dies(browser, mill, how):
    """Of the time until it begins 0.2 s are the patience of the axis; `bench web` measures it."""
    page = open_page(browser, mill.server.url, command=True)
    jog_until_it_moves(page)
    samples = []
    watching = mill.server.begin(watch_velocity(mill.hub, samples))
    died = time.monotonic()
    if how == "crash":
        with suppress(Exception):
            page.goto("chrome://crash", timeout=500)
    else:
        page.close()
    watching.result(2 * PATIENCE / 1000)
    held = samples[0][1]
    slower = next(at for at, velocity in samples if velocity < held - 1e-6)
    assert held > 10 and 0.0 < slower - died < 5.0, "0.2 s and what a busy computer adds"
    assert samples[-1][1] == 0.0
    speeds = [velocity for _, velocity in samples]
    assert speeds == sorted(speeds, reverse=True)


def test_manual_data_input_moves_and_a_refusal_is_shown(mill):
    page = mill()
    field = page.locator("[aria-label='NC text to execute']")
    field.fill("G1 X3 F3000")
    field.press("Enter")
    until(page, "Math.abs(app.store.units.x.set_position - 3) < 1e-9")
    field.fill("G1 XQ")
    field.press("Enter")
    page.wait_for_selector(".notice.error")


def test_the_words_of_the_language_are_completed(mill):
    page = mill()
    field = page.locator("[aria-label='NC text to execute']")
    field.fill("g54")
    page.wait_for_selector(".offers li:has-text('G54') >> text=Zero offset 1")
    field.fill("#hs")
    field.press("Tab")
    assert field.input_value() == "#HSC"


def test_the_scope_triggers_on_a_motion(mill):
    page = mill("scope")
    page.wait_for_selector(".channels >> text=x.set_velocity")
    page.select_option("label:text-is('Mode') + select", "single")
    page.fill("label:text-is('Level') + input", "5")
    page.press("label:text-is('Level') + input", "Enter")
    page.wait_for_selector("text=Waiting for the trigger")
    page.evaluate("() => void app.command('x', 'move_absolute', { target: 8, velocity: 20 })")
    page.wait_for_selector("text=Frozen")
    assert "lost" not in page.inner_text("main")
    cells = page.locator(".measures tbody tr").first.locator("td").all_inner_texts()
    assert cells[1] == "20"


def test_an_alarm_is_read_and_acknowledged(mill):
    page = mill("alarms")
    page.evaluate("() => void app.command('x', 'move_absolute', { target: 5000 })")
    page.wait_for_selector(".alarm >> text=Remedy")
    page.click("button:text-is('Acknowledge')")
    page.wait_for_selector("text=Acknowledged by web")


def test_the_backplot_of_a_program(mill):
    page = mill()
    load(page, "cover.nc")
    page.keyboard.press("Alt+Digit2")
    page.wait_for_selector("[data-ms]")
    page.wait_for_selector("text=/[0-9,]+ segments/")


def test_arrow_keys_tilt_the_backplot_up_to_the_view_from_above(mill):
    page = mill("watch")
    page.wait_for_selector("text=No program is loaded.")
    height = "document.querySelector('.backplot').scene._camera.position.z"
    before = page.evaluate(height)
    page.focus("canvas")
    page.keyboard.press("ArrowUp")
    assert page.evaluate(height) > before
    for _ in range(2):
        page.keyboard.press("ArrowDown")
    assert page.evaluate(height) < before
    for _ in range(20):
        page.keyboard.press("ArrowUp")
    angle = """() => {
        const { _camera, _controls } = document.querySelector('.backplot').scene;
        return _camera.position.clone().sub(_controls.target).angleTo(_camera.up) * 180 / Math.PI;
    }"""
    assert abs(page.evaluate(angle) - 1) < 0.01


def test_an_upload_asks_before_it_replaces(mill, programs):
    page = mill()
    asked = []
    page.on("dialog", lambda dialog: (asked.append(dialog.message), dialog.accept()))
    content = {"name": "bracket.nc", "mimeType": "text/plain", "buffer": b"%A\nN10 G0 X1\nN20 M30\n"}
    page.set_input_files("[aria-label='Upload a program']", content)
    page.wait_for_selector(".line >> text=N10 G0 X1")
    assert asked == ["bracket.nc is in the program folder already. Replace it?"]
    assert (programs / "bracket.nc").read_bytes() == content["buffer"]
    page.complaints.texts.clear()  # the browser logs the refusal 409


def test_the_axis_page_shows_and_writes_parameters(mill):
    page = mill("commission")
    page.wait_for_selector("text=Status, logical")
    page.click("[role=tab]:text-is('Parameters')")
    page.fill("[type=search]", "P-AXIS-00099")
    row = page.locator(".parameters tbody tr").first
    row.locator("input").fill("4000")
    row.locator("button").click()
    page.wait_for_selector(".notice >> text=P-AXIS-00099 = 4000")
    page.fill("[type=search]", "P-AXIS-00255")
    feedforward = page.locator(".parameters tbody tr").first
    feedforward.locator("select").select_option("1")
    feedforward.locator("button").click()
    page.wait_for_selector(".notice >> text=P-AXIS-00255 = 1")
    page.click("[role=tab]:text-is('Online')")  # what is read again has them
    page.click("[role=tab]:text-is('Parameters')")
    page.fill("[type=search]", "P-AXIS-00099")
    until(page, "document.querySelector('.parameters input')?.value === '4000'")
    page.fill("[type=search]", "P-AXIS-00255")
    until(page, "document.querySelector('.parameters select')?.value === '1'")


def test_a_value_is_a_number_however_it_is_written(mill):
    page = mill("commission")
    page.click("[role=tab]:text-is('Parameters')")
    page.fill("[type=search]", "P-AXIS-00099")
    row = page.locator(".parameters tbody tr").first
    for text, number in (("4.1e3", "4100"), ("4200.0", "4200")):
        row.locator("input").fill(text)
        row.locator("button").click()
        until(page, f"document.querySelector('.parameters input').value === '{number}'")
    page.evaluate("app.command('x', 'write_parameter', {parameter: 'P-AXIS-00099', value: 4300})")
    until(page, "document.querySelector('.parameters input').value === '4300'")


def test_what_is_entered_outlives_the_writing_of_another_parameter(mill):
    page = mill("commission")
    page.click("[role=tab]:text-is('Parameters')")
    page.fill("[type=search]", "P-AXIS-00")
    page.wait_for_selector(".parameters [aria-label^='P-AXIS-00255']")
    page.select_option(".parameters select[aria-label^='P-AXIS-00255']", "1")
    entered = ".parameters input[aria-label^='P-AXIS-00001']"
    page.fill(entered, "7")
    assert page.input_value(".parameters input[aria-label^='P-AXIS-00099']") != "4000"
    page.evaluate("app.command('x', 'write_parameter', {parameter: 'P-AXIS-00099', value: 4000})")
    until(page, "document.querySelector(\".parameters input[aria-label^='P-AXIS-00099']\").value === '4000'")
    assert page.input_value(".parameters select[aria-label^='P-AXIS-00255']") == "1"
    assert page.input_value(entered) == "7"
    assert page.evaluate("selector => document.activeElement === document.querySelector(selector)", entered)


def test_each_function_of_an_axis_has_its_form(mill):
    page = mill("commission")
    for tab in ("Functions", "Dynamics", "Coupling", "Compensation"):
        page.click(f"[role=tab]:text-is('{tab}')")
        assert page.locator(".tab-body form").count() >= 3, tab
    page.click("[role=tab]:text-is('Functions')")
    form = page.locator("form:has(button:text-is('move absolute'))")
    form.locator("input").first.fill("2.5")
    form.locator("button").click()
    until(page, "Math.abs(app.store.units.x.set_position - 2.5) < 1e-9")


def test_a_taught_offset_and_the_curve_of_the_spindle(mill):
    page = mill()
    page.evaluate("() => void app.command('x', 'move_absolute', { target: 1.5 })")
    until(page, "app.store.units.x.set_position === 1.5 && app.store.units.x.state === 'Standstill'")
    page.locator("[aria-label='G55 X']").fill("7.5")
    page.locator("[aria-label='G55 X']").press("Enter")
    page.wait_for_selector(".notice >> text=G55 X = 7.500")
    page.click("[aria-label='Teach all axes of G56']")
    until(page, "document.querySelector('[aria-label=\\'G56 X\\']').value === '1.5'")
    page.keyboard.press("Alt+Digit4")
    page.select_option("label:text-is('Unit') + select", "s")
    page.click("[role=tab]:text-is('Curve')")
    page.wait_for_selector("[aria-label='Curve of gear 1'] .uplot")


def test_the_ptp_test_goes_to_and_fro(mill):
    page = mill("commission")
    page.click("[role=tab]:text-is('PTP test')")
    page.fill("label:text-is('Position 1 in mm') + input", "4")
    page.fill("label:text-is('Position 2 in mm') + input", "1")
    page.click("button.primary >> text=Start")
    page.wait_for_selector("text=2 strokes")
    assert page.evaluate("app.store.units.x.set_position") == 1


def test_the_circle_test_draws_its_deviations(mill):
    page = mill("commission")
    page.click("[role=tab]:text-is('Circle test')")
    page.fill("label:text-is('Radius in mm') + input", "5")
    page.click("button.primary >> text=Start")
    page.wait_for_selector("text=Deviations are drawn 500 times as large.")
    radius = float(page.locator(".reading:has-text('Radius') output").inner_text())
    assert abs(radius - 5) < 0.05


def acknowledge_by_hand(page, on=True):
    """The box shows it when the PLC has accepted it."""
    box = page.locator("label:has-text('Acknowledge functions by hand') input")
    assert box.is_checked() is not on
    box.click()
    eventually(page, lambda: box.is_checked() is on)


def test_what_waits_is_acknowledged_when_the_plc_does_it_automatically_again(waiting, programs):
    (programs / "tool.nc").write_text("%TOOL\nN10 M6\nN20 G1 X2 F6000\nN30 M30\n", encoding="utf-8")
    page = waiting()
    acknowledge_by_hand(page)
    load(page, "tool.nc")
    page.click("button.primary >> text=Start")
    page.wait_for_selector(".handshakes >> text=M6")
    acknowledge_by_hand(page, on=False)
    page.wait_for_selector(".handshakes li", state="detached")
    until(page, "Math.abs(app.store.units.x.set_position - 2) < 1e-9 && !app.store.units.channel.active")


@pytest.mark.parametrize(
    ("function", "shown"), [("M6", "M6"), ("M3 S500", "M3 500 (s)"), ("H12", "H12")], ids=["M", "spindle", "H"]
)
def test_a_program_waits_for_somebody_who_acknowledges(waiting, programs, function, shown):
    (programs / "tool.nc").write_text(f"%TOOL\nN10 {function}\nN20 G1 X2 F6000\nN30 M30\n", encoding="utf-8")
    page, other = waiting(), waiting(command=False)
    acknowledge_by_hand(page)
    load(page, "tool.nc")
    page.click("button.primary >> text=Start")
    for each in (page, other):
        each.wait_for_selector(f".handshakes strong:text-is('{shown}')")
        each.wait_for_selector(".handshakes >> text=line 2")
    assert other.locator(".handshakes button").is_disabled()
    assert page.evaluate("app.store.units.x.set_position") == 0
    page.click(".handshakes >> text=Acknowledge")
    for each in (page, other):
        each.wait_for_selector(".handshakes li", state="detached")
    until(page, "Math.abs(app.store.units.x.set_position - 2) < 1e-9 && !app.store.units.channel.active")


def test_a_reset_withdraws_what_is_to_be_acknowledged(waiting, programs):
    (programs / "tool.nc").write_text("%TOOL\nN10 M6\nN20 G1 X2 F6000\nN30 M30\n", encoding="utf-8")
    page = waiting()
    acknowledge_by_hand(page)
    load(page, "tool.nc")
    page.click("button.primary >> text=Start")
    page.wait_for_selector(".handshakes >> text=M6")
    page.click("button:text-is('Reset')")
    page.wait_for_selector(".handshakes li", state="detached")
    until(page, "!app.store.units.channel.active")
    assert page.evaluate("app.store.units.x.set_position") == 0


@pytest.mark.long
def test_friction_is_identified_and_its_values_become_a_new_file(tuned, tmp_path):
    page = tuned("commission")
    before = (tmp_path / "mill.yaml").read_bytes()
    page.click("[role=tab]:text-is('Identify')")
    page.click("button.primary >> text=Start")
    page.set_default_timeout(LONG_PATIENCE)
    page.wait_for_selector("[role=status]:text-is('Finished.')")
    assert "frict_comp" in page.inner_text("[aria-label='Identified values']")
    page.fill("label:text-is('New machine file') + input", "better.yaml")
    page.click("button:text-is('Accept')")
    page.wait_for_selector(f".notice >> text='{tmp_path}/better.yaml is written.'")
    assert read_machine(str(tmp_path / "better.yaml")).axes["x"].name == "x"
    assert (tmp_path / "mill.yaml").read_bytes() == before
    page.click("button:text-is('Accept')")
    page.wait_for_selector(".notice.error >> text=better.yaml is there already; nothing was written; give another name")


def test_the_drive_is_identified_and_that_is_cancelled(tuned):
    page = tuned("commission")
    page.click("[role=tab]:text-is('Identify')")
    page.select_option("label:text-is('What') + select", "dynamics")
    page.click("button.primary >> text=Start")
    page.wait_for_selector("[role=status] >> text=identify runs")
    page.click("button:text-is('Cancel')")
    page.wait_for_selector("[role=status] >> text=/task [0-9]+ was cancelled; nothing was found/")


def test_the_simulated_circle_test_shows_its_picture_and_report(tuned):
    page = tuned("commission")
    page.click("[role=tab]:text-is('Circle test')")
    page.fill("label:text-is('Radius in mm') + input", "5")
    page.click("text=Simulate")
    page.set_default_timeout(LONG_PATIENCE)
    page.wait_for_selector("img.picture")
    until(page, "document.querySelector('img.picture').naturalWidth > 100")
    assert page.inner_text("pre[aria-label=Report]").startswith("Circle test XY, R 5 mm about X 0 Y 0, F 2000 mm/min")


def test_a_snapshot_without_a_recorder(mill):
    page = mill("scope")
    page.click("text=MCAP snapshot")
    text = "snapshot: there is no recorder; nothing was written; run with --keep SECONDS"
    page.wait_for_selector(f".notice.error >> text={text}")
    page.complaints.texts.clear()  # the browser logs the refusal 400


def test_the_path_of_a_turned_part_is_seen_as_a_lathe(lathe):
    page = lathe()
    load(page, "turned_part.nc")
    page.keyboard.press("Alt+Digit2")
    page.wait_for_selector("[data-ms]")
    assert page.input_value("[aria-label=View]") == "turning"
    assert page.evaluate("document.querySelector('.backplot').scene._view") == "turning"


def test_the_simulated_drive_and_a_service_channel_that_is_not_there(mill):
    page = mill("commission")
    page.click("[role=tab]:text-is('Drive')")
    page.wait_for_selector("th:has-text('P-SIM')")
    service = page.locator("section:has(h2:text-is('Service channel (SERCOS)'))")
    service.locator("button:text-is('Read')").click()
    page.wait_for_selector(".notice.error")
    assert service.locator("output").inner_text() == ""


def test_an_empty_position_is_not_zero(mill):
    page = mill("commission")
    page.click("[role=tab]:text-is('PTP test')")
    page.fill("label:text-is('Position 2 in mm') + input", "")
    page.click("button.primary >> text=Start")
    page.wait_for_timeout(300)
    page.wait_for_selector("text=Not started.")
    assert page.evaluate("document.activeElement.required && document.activeElement.value === ''")
    assert "move_absolute" not in [command for _, _, command in mill.hub.face.users]


def test_the_emergency_stop_and_its_release_are_seen_on_other_pages(mill):
    page, other = mill(), mill(command=False)
    page.click("text=Emergency stop")
    other.wait_for_selector(".pill >> text=Emergency stop")
    page.on("dialog", lambda dialog: dialog.accept())
    page.click("text=Release stop")
    until(other, "!app.store.inEmergency")


def test_the_target_of_an_axis_is_shown(mill):
    page = mill("commission")
    page.evaluate("() => void app.command('x', 'move_absolute', { target: 7.25 })")
    page.wait_for_selector(".reading:has-text('Target position') >> text=7.2500")


def test_a_jog_ends_when_a_commissioner_takes_the_command_over(mill):
    page, other = mill(), mill(command=False)
    jog_until_it_moves(page)
    other.on("dialog", lambda dialog: dialog.accept())
    other.click("text=Take over")
    until(other, "app.store.holds")
    until(other, "app.store.units.x.state === 'Standstill'")
    page.mouse.up()


def test_the_jog_keys_of_a_lathe_move_x_and_z_and_those_of_y_nothing(lathe):
    page = lathe()
    page.click("text=Jog keys")
    until(page, "app.roundTrip.time < 100")
    page.evaluate("() => { window.jogs = []; app.jogger.onChange((axis, v) => v && jogs.push([axis, Math.sign(v)])); }")
    for key in ("ArrowLeft", "ArrowRight", "ArrowUp", "ArrowDown", "PageUp", "PageDown"):
        page.keyboard.press(key)
    assert page.evaluate("jogs") == [["x", -1], ["x", 1], ["z", 1], ["z", -1]]
    assert page.locator(".jog").all_inner_texts() == ["X − ←", "X + →", "Z − ⇟", "Z + ⇞"]


def choose(page, channel):
    page.select_option("[aria-label=Channel]", channel)
    page.wait_for_selector(f"h2:text-is('Control {channel}')")


def manual(page, text):
    page.locator("[aria-label='NC text to execute']").fill(text)
    page.locator("[aria-label='NC text to execute']").press("Enter")


def test_the_chosen_channel_is_the_one_that_is_operated(two_channels, programs):
    (programs / "second.nc").write_text("%SECOND\nN10 G1 Y5 F30\nN20 M30\n", encoding="utf-8")
    page = two_channels()

    def given():
        return [(unit, command) for _, unit, command in two_channels.hub.face.users]

    assert page.locator("[aria-label=Channel] option").all_inner_texts() == ["channel1", "channel2"]
    assert page.input_value("[aria-label=Channel]") == "channel1"
    choose(page, "channel2")
    manual(page, "G1 Y1 F6000")
    until(page, "Math.abs(app.store.units.y.set_position - 1) < 1e-9 && !app.store.units.channel2.active")
    page.wait_for_selector("option:text-is('second.nc')", state="attached")
    page.select_option("[aria-label='Load a program']", "second.nc")
    page.wait_for_selector(".program-name >> text=second.nc")
    page.wait_for_selector(".line >> text=N10 G1 Y5")
    page.click("button:text-is('Start channel2')")
    page.wait_for_selector(".pill >> text=channel2: Running")
    page.keyboard.press("F8")
    page.wait_for_selector("button:text-is('Resume channel2')")
    page.wait_for_selector("button[aria-pressed=true]:text-is('Feed hold channel2')")
    page.keyboard.press("F9")
    page.wait_for_selector("button:text-is('Start channel2')")
    page.keyboard.press("Control+ArrowDown")
    until(page, "app.store.units.channel2.override === 95")
    page.click("button:text-is('Reset channel2')")
    until(page, "!app.store.units.channel2.active")
    assert {unit for unit, _ in given()} == {"channel2"}
    choose(page, "channel1")
    page.wait_for_selector(".program-name >> text=No program is loaded")
    assert page.locator(".offsets thead th").all_inner_texts() == ["Offset", "X mm"]
    manual(page, "G1 X2 F6000")
    until(page, "Math.abs(app.store.units.x.set_position - 2) < 1e-9")
    assert given()[-1] == ("channel1", "mdi")
    assert page.evaluate("app.store.units.channel1.override") == 100


def test_the_choice_of_a_channel_is_kept_and_watched(two_channels, programs):
    (programs / "second.nc").write_text("%SECOND\nN10 G1 Y5 F600\nN20 M30\n", encoding="utf-8")
    page = two_channels(size=PHONE)
    choose(page, "channel2")
    page.wait_for_selector("option:text-is('second.nc')", state="attached")
    page.select_option("[aria-label='Load a program']", "second.nc")
    page.wait_for_selector(".line >> text=N10 G1 Y5")
    assert page.evaluate("document.documentElement.scrollWidth") <= PHONE["width"]
    assert page.inner_text("button.emergency") == "Emergency stop, all channels"
    page.reload()
    page.wait_for_selector("h2:text-is('Control channel2')")
    assert page.input_value("[aria-label=Channel]") == "channel2"
    page.keyboard.press("Alt+Digit2")
    page.wait_for_selector("h2:text-is('Progress channel2')")
    page.wait_for_selector("text=/[0-9,]+ segments/")
    page.select_option("[aria-label=Channel]", "channel1")
    page.wait_for_selector("h2:text-is('Progress channel1')")
    page.wait_for_selector("text=No program is loaded.")


def test_with_one_channel_there_is_nothing_to_choose(mill):
    page = mill()
    page.wait_for_selector("button:text-is('Feed hold')")
    assert page.locator(".channel-choice").is_hidden()
    assert page.inner_text("button.emergency") == "Emergency stop"
