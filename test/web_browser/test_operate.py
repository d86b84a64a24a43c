"""Operate: jog that always ends, program, overrides, MDI, handshakes."""

from itertools import pairwise

import pytest
from fake_machine import Fake
from web_browser_support import DESKTOP, InThread, eventually, open_page, until

LOST = {
    "pointerup": "() => 0",
    "blur of the page": "() => window.dispatchEvent(new Event('blur'))",
    "visibilitychange": "() => document.dispatchEvent(new Event('visibilitychange'))",
    "pagehide": "() => window.dispatchEvent(new Event('pagehide'))",
    "pointercancel": "() => document.querySelector('[data-jog=x]').dispatchEvent(new PointerEvent('pointercancel'))",
    "lost capture": "() => document.querySelector('[data-jog=x]').dispatchEvent(new PointerEvent('lostpointercapture'))",
    "Meta": "() => document.body.dispatchEvent(new KeyboardEvent('keydown', { key: 'Meta', bubbles: true }))",
    "help": "() => document.dispatchEvent(new KeyboardEvent('keydown', { key: 'F1' }))",
    "another page": "() => { location.hash = 'watch'; }",
    "the command is lost": "() => app.store.take({type: 'operator', holder: {user: 'anna', page: 99}, asking: null}) || app.store.tell('operator')",
}


def jogs(fake):
    return [message for message in fake.received if message["type"] == "jog" and message["velocity"] != 0]


def press_jog(page, name="Jog X −"):
    box = page.locator(f"[aria-label='{name}']").bounding_box()
    page.mouse.move(box["x"] + 10, box["y"] + 10)
    page.mouse.down()


@pytest.mark.parametrize("how", LOST)
def test_a_jog_ends_however_its_key_is_lost(look, fake, how):
    page = look(command=True)
    press_jog(page)
    eventually(page, lambda: len(jogs(fake)) >= 4)
    if how == "pointerup":
        page.mouse.up()
    page.evaluate(LOST[how])
    eventually(page, lambda: fake.has_received(type="jog_stop"))
    sent = jogs(fake)
    assert [message["sequence"] for message in sent] == [*range(1, len(sent) + 1)]
    assert {(message["axis"], message["velocity"]) for message in sent} == {("x", -16.6)}
    page.wait_for_timeout(300)
    assert jogs(fake) == sent
    last = [message for message in fake.received if message["type"].startswith("jog")][-2:]
    assert [message["type"] for message in last] == ["jog", "jog_stop"]
    assert last[0]["velocity"] == 0
    page.mouse.up()


def test_the_button_that_was_pressed_before_ends_no_jog_of_the_next_one(look, fake):
    page = look(command=True)
    for name, ends in (("Jog X +", 1), ("Jog X −", 2)):  # the first one has the focus until the second one is pressed
        begun = len(jogs(fake))
        press_jog(page, name)
        eventually(page, lambda begun=begun: len(jogs(fake)) >= begun + 4)
        page.mouse.up()
        eventually(page, lambda ends=ends: len([m for m in fake.received if m["type"] == "jog_stop"]) == ends)
    page.wait_for_timeout(200)
    assert len([m for m in fake.received if m["type"] == "jog_stop"]) == 2


def test_a_key_beside_the_pointer_does_not_keep_a_jog(look, fake):
    page = look(command=True)
    press_jog(page)
    eventually(page, lambda: jogs(fake))
    page.keyboard.down("Enter")
    page.mouse.up()
    eventually(page, lambda: fake.has_received(type="jog_stop"))
    sent = len(jogs(fake))
    page.wait_for_timeout(200)
    page.keyboard.up("Enter")
    assert len(jogs(fake)) == sent


def test_lines_and_offsets_are_within_a_desktop(look):
    page = look(command=True)
    lines = page.locator(".operate .lines").bounding_box()
    assert lines["y"] + lines["height"] <= DESKTOP["height"], "a line that Follow or Find shows is seen"
    table = page.locator(".scroll:has(.offsets)")
    assert table.evaluate("(one) => one.scrollWidth <= one.clientWidth"), (
        "buttons that teach are seen beside their offset"
    )
    assert table.locator("thead th").all_inner_texts() == ["Offset", "X mm", "Y mm", "Z mm"]


def test_a_program_that_has_not_begun_has_no_progress(look, fake):
    page = look()
    bar = "document.querySelector('.operate progress').value"
    fake.state["channel"] |= {"state": "hold", "active": True, "progress": 0.07}
    until(page, f"{bar} === 0.07")
    fake.state["channel"] |= {"state": "ready", "active": False}
    until(page, f"{bar} === 0")


def test_jog_messages_come_every_50_ms(look, fake):
    page = look(command=True)
    press_jog(page, "Jog Y +")
    eventually(page, lambda: len(jogs(fake)) >= 20)
    page.mouse.up()
    times = [message["time"] for message in jogs(fake)]
    steps = sorted(later - earlier for earlier, later in pairwise(times))
    assert 45 <= steps[len(steps) // 2] <= 170  # 50 where nothing else runs; the page ends a jog at 170


def test_without_the_command_nothing_is_jogged(look, fake):
    page = look()
    page.evaluate("app.jogger.start('x', 10)")
    page.wait_for_selector(".notice >> text=does not hold the command")
    assert jogs(fake) == []


def test_a_jog_that_begins_while_the_connection_breaks_is_none_afterwards(look, fake):
    page = look(command=True)
    until(page, "app.roundTrip.time < 150")
    fake.holder = None  # as a page that is gone holds it no longer
    page.evaluate("() => { app.connection._socket.close(); app.jogger.start('x', 10); }")
    until(page, "app.store.link !== 'open'")
    until(page, "app.store.link === 'open' && app.store.machine !== null")
    page.click("text=Take command")
    until(page, "app.store.holds")
    page.wait_for_timeout(300)
    assert jogs(fake) == []
    assert page.locator(".jog.held").count() == 0


def test_a_jog_that_the_axis_or_the_server_refuses_is_told_and_ends(look, server, fake):
    page = look(command=True)
    event = "axis x: jog refused: the axis is in Disabled, it must be in Standstill or jogging; nothing was changed"
    error = "axis x: jog refused: the machine file closes it to pages; nothing was changed"
    told = {"type": "error", "number": 26218, "text": error, "cause": "", "remedy": ""}
    for number, (text, tell) in enumerate(
        (
            (event, lambda: fake.raise_alarm(event, severity="warning", number=23005)),
            (error, lambda: fake.tell(told)),
        ),
        1,
    ):
        press_jog(page)
        page.wait_for_selector("[data-jog=x].held")
        server.do(tell())
        page.wait_for_selector(f".notice.error >> text={text}")
        eventually(page, lambda count=number: len([m for m in fake.received if m["type"] == "jog_stop"]) == count)
        assert page.locator(".jog.held").count() == 0
        sent = len(jogs(fake))
        page.wait_for_timeout(300)
        assert len(jogs(fake)) == sent
        page.mouse.up()
    assert page.locator(".notice").count() == 2


def test_a_warning_of_a_jog_that_is_carried_out_or_of_another_axis_ends_none(look, server, fake):
    page = look(command=True)
    press_jog(page)
    eventually(page, lambda: jogs(fake))
    server.do(fake.raise_alarm("axis x: jog: jerk 1 mm/s³ is above A/T", severity="warning", number=23012))
    server.do(fake.raise_alarm("axis y: jog refused: it is at its soft limit", severity="warning", source="y"))
    page.wait_for_selector("text=2 alarms")
    sent = len(jogs(fake))
    eventually(page, lambda: len(jogs(fake)) > sent + 2)
    assert not fake.has_received(type="jog_stop")
    assert page.locator(".notice >> text=jog refused").count() == 0, "that of somebody else"
    page.mouse.up()


def test_a_page_without_the_command_does_not_tell_refused_jogs(look, server, fake):
    page = look()
    server.do(fake.raise_alarm("axis x: jog refused: it is at its soft limit", severity="warning"))
    page.wait_for_selector("text=1 alarm")
    assert page.locator(".notice").count() == 0


def test_jog_by_keys(look, fake):
    page = look(command=True)
    page.keyboard.down("ArrowRight")
    page.wait_for_timeout(150)
    page.keyboard.up("ArrowRight")
    assert jogs(fake) == []  # they are off until they are switched on
    page.click("text=Jog keys")
    page.keyboard.down("Shift")
    page.keyboard.down("ArrowUp")
    eventually(page, lambda: len(jogs(fake)) >= 3)
    page.keyboard.up("ArrowUp")
    eventually(page, lambda: fake.has_received(type="jog_stop"))
    assert {(message["axis"], message["velocity"]) for message in jogs(fake)} == {("y", 166)}


def test_the_end_of_shift_ends_a_rapid_jog(look, fake):
    page = look(command=True)
    page.click("text=Jog keys")
    page.keyboard.down("Shift")
    page.keyboard.down("ArrowRight")
    eventually(page, lambda: len(jogs(fake)) >= 3)
    page.keyboard.up("Shift")
    eventually(page, lambda: fake.has_received(type="jog_stop"))
    page.keyboard.up("ArrowRight")


def test_the_jog_keys_do_nothing_behind_the_help(look, fake):
    page = look(command=True)
    page.click("text=Jog keys")
    page.keyboard.press("F1")
    page.keyboard.press("F1")
    assert page.locator("dialog[open]").count() == 1
    page.keyboard.down("ArrowRight")
    page.wait_for_timeout(200)
    page.keyboard.up("ArrowRight")
    assert jogs(fake) == []


def test_keys_belong_to_the_axes_with_their_names_and_to_the_order_where_no_axis_has_one(look):
    page = look()
    found = page.evaluate(
        """async () => {
        const { axesOfKeys } = await import('/static/operate/jog_keys.js');
        const of = (...names) => axesOfKeys(names.map((name) => ({ name }))).map((axis) => axis?.name ?? null);
        return [of('x', 'z'), of('Z', 'c', 'Y', 'X'), of('b', 'y'), of('u', 'v'), of('q1', 'q2', 'q3', 'q4'), of()];
    }"""
    )
    assert found == [
        ["x", None, "z"],
        ["X", "Y", "Z"],
        [None, "y", None],
        ["u", "v", None],
        ["q1", "q2", "q3"],
        [None, None, None],
    ]


def test_the_buttons_and_the_help_say_which_key_moves_which_axis(look):
    page = look()
    page.wait_for_selector(".jog")
    assert page.locator(".jog").all_inner_texts() == [
        "X − ←",
        "X + →",
        "Y − ↓",
        "Y + ↑",
        "Z − ⇟",
        "Z + ⇞",
    ]
    assert page.get_attribute("[aria-label='Jog Z +']", "aria-keyshortcuts") == "PageUp"
    assert keys_that_jog(page) == {"←, →": "X", "↓, ↑": "Y", "Page down, Page up": "Z"}


def test_axes_with_other_names_are_jogged_in_the_order_of_the_machine(browser):
    fake = Fake(axes="uv")
    with InThread(fake.app) as server:
        page = open_page(browser, server.url, command=True)
        page.wait_for_selector(".jog")
        assert page.locator(".jog").all_inner_texts() == ["U − ←", "U + →", "V − ↓", "V + ↑"]
        assert keys_that_jog(page) == {"←, →": "U", "↓, ↑": "V"}
        page.click("text=Close")
        page.click("text=Jog keys")
        until(page, "app.roundTrip.time < 150")
        page.keyboard.down("ArrowDown")
        eventually(page, lambda: len(jogs(fake)) >= 3)
        page.keyboard.up("ArrowDown")
        eventually(page, lambda: fake.has_received(type="jog_stop", axis="v"))
        assert {(message["axis"], message["velocity"]) for message in jogs(fake)} == {("v", -16.6)}
        assert page.complaints.texts == []
        page.close()


def keys_that_jog(page):
    """Keys -> axis, as the help says it."""
    page.keyboard.press("F1")
    rows = page.locator("dialog.help tr:has-text('jog keys are on')").all()
    return {row.locator("kbd").inner_text(): row.locator("td").inner_text().split()[1] for row in rows}


def test_a_jog_is_refused_where_messages_take_too_long(look, fake):
    fake.delay = 0.3
    page = look(command=True)
    until(page, "Number.isFinite(app.roundTrip.time)")
    page.wait_for_selector(".round-trip[data-kind=warn] >> text=/[0-9]+ ms/")
    page.evaluate("app.jogger.start('x', 10)")
    page.wait_for_selector(".notice >> text=/Messages to the server and back take [0-9]+ ms, more than 150 ms/")
    assert jogs(fake) == []
    eventually(page, lambda: fake.pings[-1].get("round_trip", 0) >= 300)
    assert "round_trip" not in fake.pings[0]
    fake.delay = 0.0
    until(page, "app.roundTrip.time < 150")
    page.evaluate("app.jogger.start('x', 10)")
    eventually(page, lambda: len(jogs(fake)) >= 2)


def test_axes_are_homed_one_after_the_other_after_a_question(look, server, fake):
    page = look(command=True)
    answers = [False, True]
    asked = []

    def answer(dialog):
        asked.append(dialog.message)
        dialog.accept() if answers.pop(0) else dialog.dismiss()

    page.on("dialog", answer)
    page.click("summary:text-is('Enable, home')")
    page.click("text=Home axes")
    page.wait_for_timeout(100)
    assert commands(fake) == [None]
    page.click("text=Home axes")
    eventually(page, lambda: homed(fake) == ["z"])
    assert asked[0] == "Home all axes, one after the other: Z, X, Y? Look whether their ways are free."
    for number, axis in enumerate("zxy", 1):
        until(page, f"app.store.units.{axis}.state === 'Homing'")
        page.wait_for_timeout(300)
        assert homed(fake) == [*"zxy"[:number]]
        server.do(fake.arrive(axis))
        eventually(page, lambda n=number: homed(fake) == [*"zxy"[: n + 1]])


def homed(fake):
    return [message["unit"] for message in fake.received if message.get("command") == "home"]


def test_the_spindle_panel(look, fake):
    page = look(command=True)
    speed = page.locator("label:text-is('Speed in rpm') + input")
    speed.fill("800")
    page.click("button >> text=ccw")
    eventually(page, lambda: commands(fake)[-1] == ("start", {"direction": "ccw", "speed_rpm": 800}))
    speed.fill("")
    page.click("button >> text=ccw")
    page.click("text=Set speed")
    page.click("summary:text-is('Orient, gear, coupling')")
    angle = page.locator("label:text-is('Angle in °') + input")
    angle.fill("")
    page.click("text=Orient >> nth=-1")
    assert page.locator("label:text-is('Gear') + select option").all_inner_texts() == ["1", "2"]
    page.select_option("label:text-is('Gear') + select", "2")
    page.click("text=Select gear")
    eventually(page, lambda: commands(fake)[-1] == ("select_gear", {"stage": 2}))
    assert len(commands(fake)) == 2  # empty fields gave none
    page.click("section:has(h2:text-is('Spindle s')) >> button:text-is('Stop')")
    eventually(page, lambda: commands(fake)[-1] == ("stop", {}))


def test_a_view_that_is_left_listens_no_more(look):
    page = look()
    count = "[...app.store._listeners.values()].reduce((sum, one) => sum + one.size, 0)"
    page.wait_for_selector(".positions")
    before = page.evaluate(count)
    for _ in range(3):
        page.evaluate("location.hash = 'alarms'")
        page.wait_for_selector("main.alarms .events")
        page.evaluate("location.hash = 'operate'")
        page.wait_for_selector(".positions")
    assert page.evaluate(count) == before


def test_the_page_that_hangs_ends_its_jog(look, fake):
    page = look(command=True)
    press_jog(page)
    eventually(page, lambda: len(jogs(fake)) >= 3)
    page.evaluate("() => { const end = performance.now() + 400; while (performance.now() < end); }")
    eventually(page, lambda: fake.has_received(type="jog_stop"))
    page.mouse.up()


def test_a_program_is_loaded_and_runs_with_its_active_line(look, fake):
    page = look(command=True)
    page.select_option("[aria-label='Load a program']", "bracket.nc")
    page.wait_for_selector(".line >> text=N10 G1 X1")
    page.click("button.primary >> text=Start")
    page.wait_for_selector(".line.active")
    page.keyboard.press("F8")
    page.wait_for_selector(".pill >> text=Feed hold")
    page.wait_for_selector("button >> text=Resume")
    commands = [(message["command"], message["arguments"]) for message in fake.received if message["type"] == "command"]
    assert commands == [("start", {}), ("feed_hold", {"enabled": True})]


def test_start_at_a_line(look, fake):
    page = look(command=True)
    page.select_option("[aria-label='Load a program']", "bracket.nc")
    page.wait_for_selector(".line >> text=N10")
    page.fill("[aria-label='Find in the program']", "120")
    page.press("[aria-label='Find in the program']", "Enter")
    page.click("text=Start at line 120")
    eventually(page, lambda: fake.has_received(arguments={"line": 120}))


def test_a_program_of_150000_lines_is_a_short_list(look, fake):
    fake.programs["long.nc"] = "\n".join(f"N{i} G1 X{i % 100}" for i in range(150_000))
    page = look(command=True)
    page.select_option("[aria-label='Load a program']", "long.nc")
    page.wait_for_selector(".line >> text=N0 G1 X0")
    page.fill("[aria-label='Find in the program']", "149990")
    page.press("[aria-label='Find in the program']", "Enter")
    page.wait_for_selector(".line >> text=N149989")
    assert page.locator(".line").count() < 120


def test_upload_and_drop(look, fake):
    page = look(command=True)
    page.set_input_files(
        "[aria-label='Upload a program']",
        {"name": "new.nc", "mimeType": "text/plain", "buffer": b"N10 G0 X5\nN20 M30\n"},
    )
    page.wait_for_selector(".line >> text=N10 G0 X5")
    assert fake.programs["new.nc"] == "N10 G0 X5\nN20 M30\n"
    page.evaluate(
        """() => {
        const data = new DataTransfer();
        data.items.add(new File(["N10 G0 Y7\\nN20 M30"], "dropped.nc"));
        document.querySelector(".program-panel").dispatchEvent(new DragEvent("drop", { dataTransfer: data, bubbles: true }));
    }"""
    )
    page.wait_for_selector(".line >> text=N10 G0 Y7")


def test_override_by_slider_and_keys(look, fake):
    page = look(command=True)
    page.locator("[data-unit=channel] input").focus()
    for _ in range(3):
        page.keyboard.press("ArrowLeft")
    eventually(page, lambda: page.evaluate("app.store.units.channel.override") == 97)
    page.keyboard.press("Control+ArrowUp")
    eventually(page, lambda: page.evaluate("app.store.units.channel.override") == 102)
    page.click("[aria-label='Feed 100 %']")
    eventually(page, lambda: fake.state["channel"]["override"] == 100)
    page.evaluate("app.store.unit('channel').limits = { override: 103 }")
    page.keyboard.press("Control+ArrowUp")
    eventually(page, lambda: commands(fake)[-1] == ("set_override", {"percent": 103}))


def test_mdi_has_a_history_and_completes(look, fake):
    page = look(command=True)
    field = page.locator("[aria-label='NC text to execute']")
    field.fill("G0 X10 Y20")
    field.press("Enter")
    eventually(page, lambda: fake.has_received(arguments={"text": "G0 X10 Y20"}))
    eventually(page, lambda: field.input_value() == "")
    field.press("ArrowUp")
    assert field.input_value() == "G0 X10 Y20"
    field.fill("")
    field.press_sequentially("G0 X1")
    page.wait_for_selector(".offers li")
    field.press("Tab")
    assert field.input_value() == "G0 X10 Y20"


def test_mdi_completes_what_the_channel_knows_and_says_what_it_means(look):
    page = look(command=True)
    field = page.locator("[aria-label='NC text to execute']")
    field.press_sequentially("g5")
    page.wait_for_selector(".offers li:has-text('G54') >> text=Zero offset 1.")
    field.press("Tab")
    assert field.input_value() == "G54"
    field.press_sequentially(" x")
    page.wait_for_selector(".offers li >> text=axis x, mm")
    field.fill("G0 X1 #timer st")
    field.press("Tab")
    assert field.input_value() == "G0 X1 #TIMER START"


def test_words_that_come_when_mdi_is_left_open_no_list(look):
    page = look(command=True)
    asked = []
    page.route("**/api/words*", lambda route: asked.append(route))
    field = page.locator("[aria-label='NC text to execute']")
    field.press_sequentially("g5")
    eventually(page, lambda: asked)
    field.blur()
    page.wait_for_timeout(300)  # the list closes 150 ms after that
    with page.expect_response("**/api/words*"):
        asked[0].continue_()
    page.wait_for_timeout(300)
    assert page.locator(".offers").is_hidden() and field.get_attribute("aria-expanded") == "false"
    field.fill("g54")
    page.wait_for_selector(".offers li >> text=Zero offset 1.")


def test_completions(look):
    page = look("alarms")
    found = page.evaluate(
        """async () => {
        const { completions } = await import('/static/operate/mdi.js');
        const words = [["G00", "rapid"], ["G01", "feed"], ["G10", "ten"], ["M03", "on"], ["#CS ON", "system"], ["X", "axis x"]].map(([name, meaning]) => ({ name, meaning }));
        const of = (text) => completions(text, ["G1 X5", "M3"], words).map(({ text, meaning }) => `${text}: ${meaning}`);
        return [of(""), of("g0"), of("g1"), of("G1 X"), of("#c"), of("G1 #CS o"), of("Q"), of("G1 ")];
    }"""
    )
    assert found == [
        [],
        ["G00: rapid", "G01: feed"],
        ["G1 X5: ", "G01: feed", "G10: ten"],
        ["G1 X5: ", "G1 X: axis x"],
        ["#CS ON: system"],
        ["G1 #CS ON: system"],
        [],
        ["G1 X5: "],
    ]


def test_a_handshake_is_acknowledged(look, server, fake):
    page = look(command=True)
    server.do(fake.request(kind="M", number=6))
    page.wait_for_selector("text=M6")
    page.click(".handshakes >> text=Acknowledge")
    eventually(page, lambda: fake.has_received(unit="plc", command="acknowledge", arguments={"id": 7}))
    page.wait_for_selector(".handshakes li", state="detached")


def test_functions_are_acknowledged_by_hand_when_the_plc_has_accepted_it(look, server, fake):
    page = look(command=True)
    box = page.locator("label:has-text('Acknowledge functions by hand') input")
    assert not box.is_checked()
    box.click()
    eventually(page, box.is_checked)
    assert commands(fake) == [("auto_acknowledge", {"enabled": False})]
    text = "plc plc: auto_acknowledge: this page does not hold the command; nothing was done"
    fake.refusals["command"] = {"number": 26236, "text": text, "cause": "", "remedy": ""}
    box.click()
    page.wait_for_selector(f".notice.error >> text={text}")
    assert box.is_checked()
    fake.refusals.clear()
    box.click()
    eventually(page, lambda: not box.is_checked())
    assert commands(fake)[-1] == ("auto_acknowledge", {"enabled": True})
    server.do(fake.tell({"type": "state", "time": fake.time, "units": {"plc": {"auto_acknowledge": False}}}))
    eventually(page, box.is_checked)  # a machine that says it is believed


def test_without_the_command_nobody_decides_who_acknowledges(look):
    page = look()
    assert page.locator("label:has-text('Acknowledge functions by hand') input").is_disabled()


def test_positions_of_work_and_machine(look, fake):
    page = look()
    page.wait_for_selector(".positions .big >> text=/[0-9]/")
    shift = "() => app.store.units.z.work_position - app.store.units.z.set_position"
    assert page.evaluate(shift) == -10
    assert page.inner_text("[data-axis=z] .big") == "−15.000"
    page.click("button:text-is('Machine')")
    assert page.inner_text("[data-axis=z] .big") == "−5.000"
    page.click("button:text-is('Actual')")
    assert page.inner_text("[data-axis=z] .big") == "−5.004"


def test_offsets_are_shown_set_and_taught(look, server, fake):
    page = look(command=True)
    cell = page.locator("[aria-label='G54 X']")
    eventually(page, lambda: cell.input_value() == "12.5")
    assert page.locator("[aria-label='G54 Z']").input_value() == "-3"
    page.wait_for_selector("text='Programs start with G54.'")
    tell_offset(server, fake, index=1, name="G54", values={"X": 7.5, "Y": 0.0, "Z": -3.0}, inactive=[])
    eventually(page, lambda: cell.input_value() == "7.5")
    tell_offset(server, fake, index=2, name="G55", values={"X": 2.0, "Y": 1.0, "Z": 0.0}, inactive=["X"])
    page.wait_for_selector("[aria-label='G55 X'][title='does not count for this axis (G160)']")
    assert [page.input_value(f"[aria-label='G55 {axis}']") for axis in "XYZ"] == ["2", "1", "0"]
    assert page.get_attribute("[aria-label='G55 Y']", "title") == ""
    cell.fill("-4")
    cell.press("Enter")
    eventually(page, lambda: commands(fake)[-1] == ("set_zero_offset", {"index": 1, "axis": "X", "value": -4}))
    eventually(page, lambda: cell.input_value() == "-4")
    page.click("[aria-label='Teach G55 Y']")
    eventually(page, lambda: commands(fake)[-1] == ("teach_zero_offset", {"index": 2, "axis": "Y", "value": 0}))
    page.click("[aria-label='Teach all axes of G56']")
    eventually(page, lambda: commands(fake)[-1] == ("teach_zero_offset", {"index": 3, "value": 0}))


def test_an_offset_that_is_refused_is_shown_as_it_is(look, server, fake):
    page = look(command=True)
    cell = page.locator("[aria-label='G54 X']")
    eventually(page, lambda: cell.input_value() == "12.5")
    fake.refusals["command"] = {"number": 22004, "text": "a program runs", "cause": "", "remedy": ""}
    for entered in ("-4", ""):
        cell.fill(entered)
        cell.press("Enter")
        eventually(page, lambda: cell.input_value() == "12.5")
    page.wait_for_selector(".notice.error >> text=a program runs")
    cell.fill("-5")
    tell_offset(server, fake, index=1, name="G54", values={"X": 7.5, "Y": 0.0, "Z": -3.0}, inactive=[])
    page.wait_for_timeout(200)
    assert cell.input_value() == "-5"  # what is being entered stays
    cell.press("Enter")
    eventually(page, lambda: cell.input_value() == "7.5")


def tell_offset(server, fake, **row):
    table = {"channel": "channel", "axes": ["X", "Y", "Z"], "default": 1, "offsets": [row]}
    server.do(fake.tell({"type": "zero_offsets", **table}))


def test_the_picker_takes_the_endings_of_the_server(look):
    page = look(command=True)
    until(
        page, "document.querySelector('[aria-label=\\'Upload a program\\']').accept === '.nc,.ngc,.cnc,.tap,.mpf,.spf'"
    )


def commands(fake):
    return [
        (message["command"], message["arguments"]) for message in fake.received if message["type"] == "command"
    ] or [None]
