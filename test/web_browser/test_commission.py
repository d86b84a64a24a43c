"""Commission: identification and circle test as tasks of the server; the snapshot of the scope."""

import re
from pathlib import Path

import pytest
from fake_machine import SNAPSHOT
from web_browser_support import eventually, until

VALUES = "/x:\n  ros__parameters:\n    lr_param: {frict_comp: 1}\n"
PICTURE = (
    '<svg xmlns="http://www.w3.org/2000/svg" width="40" height="30"><circle cx="20" cy="15" r="10" fill="red"/></svg>'
)
CANCELLED = {"number": 26256, "text": "task 1 was cancelled; nothing was found", "cause": "", "remedy": ""}


def open_tab(look, name, **options):
    page = look("commission", command=True, **options)
    page.click(f"[role=tab]:text-is('{name}')")
    return page


def result(task=1, **fields):
    return {"type": "result", "task": task, "ok": True, "output": "report of the task", **fields}


@pytest.mark.parametrize("what", ["friction", "dynamics"])
def test_an_axis_is_identified_and_its_values_accepted(look, server, fake, what):
    page = open_tab(look, "Identify")
    page.select_option("label:text-is('What') + select", what)
    page.click("button.primary >> text=Start")
    eventually(page, lambda: fake.has_received(type="identify", axis="x", what=what))
    page.wait_for_selector("[role=status]:text-is('Started.')")
    assert page.locator("h2:text-is('Result')").is_hidden()
    server.do(fake.tell({"type": "progress", "task": 7, "text": "of another page"}))
    server.do(fake.tell({"type": "progress", "task": 1, "text": "speed 3 of 8"}))
    page.wait_for_selector("[role=status]:text-is('speed 3 of 8')")
    assert page.get_attribute("progress", "value") is None  # how far it is is not known
    server.do(fake.tell({"type": "progress", "task": 1, "text": "friction of x: 35 %", "percent": 35}))
    page.wait_for_selector("[role=status]:text-is('friction of x: 35 %')")
    assert page.get_attribute("progress", "value") == "35"
    server.do(fake.tell(result(task=7, values="of another page")))
    server.do(fake.tell(result(values=VALUES)))
    page.wait_for_selector("[role=status]:text-is('Finished.')")
    assert page.inner_text("[aria-label=Report]") == "report of the task"
    assert page.inner_text("[aria-label='Identified values']").strip() == VALUES.strip()
    assert page.locator("button:text-is('Cancel')").is_disabled()
    page.fill("label:text-is('New machine file') + input", "better.yaml")
    page.click("button:text-is('Accept')")
    page.wait_for_selector(".notice >> text='/machines/better.yaml is written.'")
    assert fake.has_received(type="accept", task=1, file="better.yaml")


def test_a_machine_file_that_is_there_is_not_replaced(look, server, fake):
    text = "x_identified.yaml is there already; nothing was written; give another name"
    fake.refusals["accept"] = {"number": 26254, "text": text, "cause": "", "remedy": "Give another name."}
    page = open_tab(look, "Identify")
    page.click("button.primary >> text=Start")
    eventually(page, lambda: fake.has_received(type="identify"))
    server.do(fake.tell(result(values=VALUES)))
    page.click("button:text-is('Accept')")
    page.wait_for_selector(f".notice.error >> text={text}")


def test_an_identification_is_cancelled(look, server, fake):
    page = open_tab(look, "Identify")
    assert page.locator("button:text-is('Cancel')").is_disabled()
    page.click("button.primary >> text=Start")
    page.click("button:text-is('Cancel')")
    eventually(page, lambda: fake.has_received(type="cancel_task", task=1))
    server.do(fake.tell({"type": "result", "task": 1, "ok": False, "output": "", **CANCELLED}))
    page.wait_for_selector("[role=status] >> text=task 1 was cancelled; nothing was found")
    assert page.locator("h2:text-is('Result')").is_hidden()
    assert page.locator("button:text-is('Cancel')").is_disabled()


def test_a_task_that_another_one_holds_up_is_refused(look, fake):
    text = "another task runs; nothing was done; wait for its end, or cancel it"
    fake.refusals["identify"] = {"number": 26256, "text": text, "cause": "", "remedy": ""}
    page = open_tab(look, "Identify")
    page.click("button.primary >> text=Start")
    page.wait_for_selector(f".notice.error >> text={text}")
    assert page.locator("[role=status]:text-is('Not started.')").count() == 1


def test_only_a_commissioner_identifies(look, fake):
    fake.role = "operator"
    page = open_tab(look, "Identify")
    assert page.locator("button.primary:text-is('Start')").is_disabled()


def test_the_circle_test_on_a_simulation_shows_its_picture(look, server, fake):
    page = open_tab(look, "Circle test")
    page.select_option("label:text-is('Plane') + select", "XZ")
    page.fill("label:text-is('Radius in mm') + input", "7.5")
    page.fill("label:text-is('Feed in mm/min') + input", "1500")
    page.click("text=Simulate")
    eventually(page, lambda: fake.has_received(type="circle", plane="ZX", radius=7.5, feed=1500))
    server.do(fake.tell(result(picture=PICTURE)))
    page.wait_for_selector("img.picture")
    until(page, "document.querySelector('img.picture').naturalWidth === 40")
    assert page.inner_text("pre[aria-label=Report]") == "report of the task"


def test_a_circle_without_a_radius_is_none(look, fake):
    page = open_tab(look, "Circle test")
    page.fill("label:text-is('Radius in mm') + input", "")
    page.click("text=Simulate")
    until(page, "document.activeElement.required && document.activeElement.value === ''")
    assert not fake.has_received(type="circle")


def test_a_snapshot_of_the_recorder_is_saved(look, fake):
    page = look("scope")
    page.select_option("label:text-is('Window') + select", "5")
    with page.expect_download() as download:
        page.click("text=MCAP snapshot")
    assert download.value.suggested_filename == "snapshot.mcap"
    assert Path(download.value.path()).read_bytes() == SNAPSHOT
    assert fake.snapshots == [{"seconds": "5"}]


def test_a_snapshot_of_a_frozen_scope_has_its_window(look, fake):
    page = look("scope")
    until(page, "(/([0-9]+) samples/.exec(document.querySelector('main').innerText) || [0, 0])[1] > 2500")
    page.click("button:text-is('Freeze')")
    frozen = fake.cycle
    eventually(page, lambda: fake.cycle > frozen + 1500)
    with page.expect_download():
        page.click("text=MCAP snapshot")
    told = page.wait_for_selector(".notice.info >> text=/The snapshot has .* the whole picture/").inner_text()
    first, end = re.fullmatch(r"The snapshot has ([\d.]+) s to ([\d.]+) s, the whole picture\.", told).groups()
    with page.expect_download() as download:
        page.click("text=Export CSV")
    rows = Path(download.value.path()).read_text(encoding="utf-8").splitlines()[1:]
    begin, last = (float(row.split(",")[1]) for row in (rows[0], rows[-1]))
    assert float(first) == begin < last <= (frozen + 200) / 1000
    assert [float(fake.snapshots[-1][name]) for name in ("until", "seconds")] == pytest.approx(
        [last + 0.001, last + 0.001 - begin]
    )
    assert float(end) == pytest.approx(last + 0.001)
    fake.kept_from = round(last * 1000)
    with page.expect_download():
        page.click("text=MCAP snapshot")
    text = (
        f"The snapshot has {last:.3f} s to {end} s; the picture begins at {first} s, which the recorder no longer has."
    )
    page.wait_for_selector(f".notice.warning >> text={text}")


def test_the_machine_has_its_parameters_and_nothing_else(look):
    page = look("commission")
    page.select_option("label:text-is('Unit') + select", label="Machine")
    page.wait_for_selector(".parameters >> text=P-MACH-00003")
    assert page.locator("[role=tab]").all_inner_texts() == ["Parameters"]
    assert page.locator(".parameters tbody tr").count() == 1


def test_elements_of_an_array_have_a_line_each(look):
    page = look("commission")
    page.click("[role=tab]:text-is('Parameters')")
    page.wait_for_selector(".parameters >> text=getriebe[1].kv")
    assert page.locator(".parameters tr:has-text('P-AXIS-00099')").count() == 2


def test_a_snapshot_without_a_recorder_is_refused(look, fake):
    text = "snapshot: there is no recorder; nothing was written; run with --keep SECONDS"
    fake.refusals["snapshot"] = {"number": 26258, "text": text, "cause": "", "remedy": ""}
    page = look("scope")
    page.click("text=MCAP snapshot")
    page.wait_for_selector(f".notice.error >> text={text}")
    page.complaints.texts.clear()  # the browser logs the refusal 400


def test_a_snapshot_that_breaks_off_is_told_and_not_saved(look, fake):
    fake.breaks_off = True
    page = look("scope")
    saved = []
    page.on("download", lambda download: saved.append(download))
    page.click("text=MCAP snapshot")
    page.wait_for_selector(".notice.error")
    assert fake.snapshots and not saved
    page.complaints.texts.clear()  # the browser logs the transfer


def test_a_viewer_takes_no_snapshot(look, fake):
    fake.role = "viewer"
    page = look("scope")
    page.wait_for_selector("text=Export CSV")
    assert page.locator("text=MCAP snapshot").count() == 0


def test_forms_have_units_and_say_what_an_empty_field_means(look):
    page = open_tab(look, "Functions")
    form = page.locator(".panel:has(h2:text-is('move absolute'))")
    assert form.locator("label").all_inner_texts() == [
        "target in mm",
        "velocity in mm/s (optional)",
        "acceleration in mm/s² (optional)",
        "jerk in mm/s³ (optional)",
    ]
    assert "largest value; empty: P-AXIS-00212" in form.inner_text()
    page.click("text='PTP test'")
    page.wait_for_selector("label:text-is('Velocity in mm/s')")
    page.wait_for_selector("small:text-is('empty: P-AXIS-00001')")
    assert "Position 1 in mm" in page.inner_text("main")
    units = "[{unit: '°, mm'}, {unit: 's, mm, °'}, {}].map((one) => it.argumentUnit(one, {unit: 'deg'}))"
    assert page.evaluate(f"import('/static/format.js').then((it) => {units})") == ["°", "s, mm, °", ""]


def test_the_online_page_shows_each_feed_enable(look, server, fake):
    """TX1250 4.3: Controller, Feed Fw, Feed Bw, from the bits of the state."""
    page = open_tab(look, "Online")
    fake.state["x"]["status_bits"] = 1 << 20 | 1 << 17
    for word, on in (("Controller", True), ("Feed forward", False), ("Feed backward", True), ("Waits for feed", True)):
        page.wait_for_selector(f"li:has-text('{word}: {'on' if on else 'off'}')")
    fake.state["x"]["status_bits"] = 0
    page.wait_for_selector("li:has-text('Feed forward: on')")
    page.wait_for_selector("li:has-text('Waits for feed: off')")


def test_the_online_page_has_the_lag_of_every_cycle_kv_and_the_position_range(look, fake):
    page = open_tab(look, "Online")
    page.wait_for_selector(".readings >> text=83.3")
    page.wait_for_selector("li:has-text('In position range: off')")
    fake.lag, fake.arrives = (-0.125, 0.25), True
    page.wait_for_selector("text=−0.12500")
    page.wait_for_selector("text=0.25000")
    page.wait_for_selector("li:has-text('In position range: on')")
    fake.lag = (0.004, 0.004)
    page.click("text=Reset lag")
    page.wait_for_selector("text=−0.12500", state="detached")
