"""The shell of the pages: all of them open, keys, themes, a broken connection, texts that are no markup."""

import pytest
from fake_machine import NASTY, Fake
from web_browser_support import HERE, PHONE, InThread, open_page, until

PAGES = ["operate", "watch", "scope", "commission", "alarms", "program"]
AXE = (HERE / "vendor" / "axe.js").read_text(encoding="utf-8")
RULES = {"runOnly": ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "best-practice"]}
COLOURS = {"runOnly": {"type": "rule", "values": ["color-contrast", "link-in-text-block"]}}
"""What may differ in the dark."""


def violations(page):
    """What axe finds in the dark, then in the light, as scheme, rule, element and reason."""
    if not page.evaluate("'axe' in window"):
        page.evaluate(AXE)
    found = []
    for scheme, rules in (("dark", COLOURS), ("light", RULES)):
        page.emulate_media(color_scheme=scheme)
        page.wait_for_function("scheme => document.documentElement.dataset.theme === scheme", arg=scheme)
        ran = page.evaluate("rules => axe.run(document, rules)", rules)
        assert ran["passes"] or ran["incomplete"], "no rule has looked at anything"
        found += [
            (scheme, one["id"], node["target"], node["failureSummary"])
            for one in ran["violations"]
            for node in one["nodes"]
        ]
    return found


@pytest.mark.parametrize("name", PAGES)
def test_each_page_is_accessible(look, server, fake, name):
    page = look(name, command=True)
    server.do(fake.raise_alarm("axis x: following error 2.5 mm > 1 mm"))
    server.do(fake.request())
    page.wait_for_selector("text=1 alarm")
    page.wait_for_timeout(400)
    assert violations(page) == []


@pytest.mark.parametrize("scheme", ["dark", "light"])
def test_a_contrast_that_is_bad_in_one_scheme_alone_is_found(look, scheme):
    """Whatever the page stands in when it is looked at."""
    for stands_in in ("dark", "light"):
        page = look("alarms", scheme=stands_in)
        page.wait_for_selector("main h2")
        assert violations(page) == []
        page.evaluate(
            """scheme => {
            const sheet = new CSSStyleSheet();
            sheet.replaceSync(`[data-theme=${scheme}] main h2 { color: #777; background: #888; }`);
            document.adoptedStyleSheets = [sheet];
        }""",
            scheme,
        )
        assert {(where, rule) for where, rule, _, _ in violations(page)} == {(scheme, "color-contrast")}, stands_in


def test_operate_is_accessible_on_a_phone(look, server, fake):
    page = look(command=True, size=PHONE)
    server.do(fake.raise_alarm("axis x: following error 2.5 mm > 1 mm"))
    server.do(fake.request())
    page.wait_for_selector("text=1 alarm")
    page.wait_for_timeout(400)
    assert violations(page) == []


TABS = {
    "x": ["Online", "PTP test", "Functions", "Dynamics", "Coupling", "Compensation", "Identify", "Circle test", "Parameters", "Drive"],
    "s": ["Online", "Functions", "Curve", "Parameters"],
    "channel": ["Functions", "Parameters"],
    "plc": ["Parameters"],
}  # fmt: skip
CONTENT = ".graph .u-over, .parameters tbody tr, form, output, .muted"


def test_each_tab_of_each_unit_is_accessible(look):
    page = look("commission", command=True)
    for unit, tabs in TABS.items():
        page.select_option("label:text-is('Unit') + select", unit)
        assert page.locator("[role=tab]").all_inner_texts() == tabs
        for tab in tabs:
            page.click(f"[role=tab]:text-is('{tab}')")
            page.wait_for_selector(f".tab-body :is({CONTENT})")
            page.wait_for_timeout(200)
            assert violations(page) == [], (unit, tab)


def test_a_scope_with_all_that_it_has_is_accessible(look):
    page = look("scope")
    page.select_option("section:has-text('Spectrum') >> label:text-is('Signal') + select", "x.set_velocity")
    page.select_option("label:text-is('X') + select", "x.set_velocity")
    page.select_option("label:text-is('Y') + select", "x.following_error")
    page.select_option("label:text-is('Kind') + select", "event")
    page.click("summary:text-is('Math channel')")
    page.wait_for_selector("[aria-label=Spectrum] .uplot")
    page.wait_for_selector("[aria-label='One signal over another'] .uplot")
    assert violations(page) == []


def test_what_opens_on_the_pages_is_accessible(look, server, fake):
    """Completions, details, notices, the list of keys."""
    page = look(command=True)
    for summary in page.locator("summary").all():
        summary.click()
    page.fill("[aria-label='NC text to execute']", "x")
    page.wait_for_selector(".offers li >> text=axis x, mm")
    refusal = {"number": 26233, "text": "this is no message", "cause": "", "remedy": "Load the page again."}
    server.do(fake.tell({"type": "error", **refusal}))
    page.wait_for_selector(".notice.error")
    assert violations(page) == []
    page.keyboard.press("F1")
    page.wait_for_selector("dialog[open]")
    assert violations(page) == []


def test_the_login_and_a_machine_that_is_gone_are_accessible(look, server, fake):
    fake.has_login = True
    page = look()
    gone = {"number": 26171, "text": "the machine is gone: its graph has ended", "cause": "", "remedy": ""}
    server.do(fake.tell({"type": "gone", **gone}))
    page.wait_for_selector(".instead >> text=the machine is gone")
    assert violations(page) == []
    page.click("text=Log out")
    page.wait_for_selector("h2:text-is('Login')")
    assert violations(page) == []
    page.complaints.texts.clear()  # the browser logs each 401


def test_the_pages_of_a_recording_are_accessible(browser):
    with InThread(Fake(recording=True).app) as server:
        page = open_page(browser, server.url)
        for name in ("watch", "scope", "alarms"):
            page.evaluate("name => { location.hash = name; }", name)
            page.wait_for_selector(f"main.{name} section")
            assert violations(page) == [], name
        assert page.complaints.texts == []
        page.close()


def test_the_curve_of_a_spindle_is_drawn_with_its_break_points(look):
    page = look("commission")
    page.select_option("label:text-is('Unit') + select", "s")
    page.click("[role=tab]:text-is('Curve')")
    page.wait_for_selector("[aria-label='Curve of gear 1'] .uplot")
    assert page.locator(".u-legend .u-label").all_inner_texts() == ["Speed", "acceleration", "break points"]
    page.click("summary:text-is('Points of gear 1')")
    assert page.locator("details tr:has-text('break point') td").all_inner_texts() == ["3000", "6000", "break point"]


@pytest.mark.parametrize("name", PAGES)
def test_no_page_is_wider_than_a_phone_and_no_panel_lower_than_what_is_in_it(look, name):
    page = look(name, size=PHONE)
    page.wait_for_timeout(300)
    link = page.locator("[aria-current=page]").bounding_box()
    assert link["x"] >= 0 and link["x"] + link["width"] <= PHONE["width"]
    assert page.evaluate("document.documentElement.scrollWidth") <= PHONE["width"]
    assert page.evaluate("document.querySelector('main').scrollWidth") <= PHONE["width"]
    assert (
        page.evaluate(
            "[...document.querySelectorAll('main .panel')].filter((one) => one.scrollHeight > one.clientHeight + 1).map((one) => one.innerText)"
        )
        == []
    )


def test_pages_are_reached_by_keys(look):
    page = look()
    page.keyboard.press("Alt+Digit3")
    page.wait_for_selector("main.scope .uplot")
    page.keyboard.press("Alt+Digit5")
    page.wait_for_selector("main.alarms")
    page.keyboard.press("F1")
    page.wait_for_selector("dialog[open]")


def test_the_theme_is_that_of_the_system_or_as_chosen(look):
    page = look(scheme="dark")
    assert page.evaluate("document.documentElement.dataset.theme") == "dark"
    page.select_option(".theme", "light")
    assert page.evaluate("document.documentElement.dataset.theme") == "light"
    page.reload()
    page.wait_for_selector(".theme")
    assert page.evaluate("document.documentElement.dataset.theme") == "light"


def test_the_page_comes_back_when_the_connection_breaks(look, server, fake):
    page = look()

    async def cut():
        for socket in [*fake.sockets]:
            await socket.close()

    server.do(cut())
    until(page, "app.store.link !== 'open'")
    until(page, "app.store.link === 'open' && app.store.machine !== null")
    page.wait_for_selector(".positions")


def test_an_answer_that_breaks_off_is_asked_for_again(look):
    """Who the page is, when it connects again."""
    page = look()
    answers = []

    def broken_once(route):
        answers.append(route)
        if len(answers) == 1:
            route.fulfill(status=200, content_type="application/json", body='{"user": "web", ')
        else:
            route.continue_()

    page.route("**/api/session", broken_once)
    page.evaluate("app.connection._socket.close()")
    until(page, "app.store.link !== 'open'")
    until(page, "app.store.link === 'open' && app.store.machine !== null")
    assert len(answers) == 2


def test_the_end_of_the_machine_is_shown(look, server, fake):
    page = look()
    server.do(
        fake.tell(
            {
                "type": "gone",
                "number": 26171,
                "text": "the machine is gone: its graph has ended",
                "cause": "",
                "remedy": "",
            }
        )
    )
    page.wait_for_selector(".instead >> text=the machine is gone")
    assert "No machine" in page.inner_text(".pill")


def test_a_machine_that_moves_and_tells_nothing_new_is_not_shown_as_running(look, fake):
    page = look()
    fake.state["channel"]["state"] = "running"
    page.wait_for_selector(".pill[data-kind=good]:text-is('Running')")
    page.evaluate("() => { app.store.take = () => {}; }")
    page.wait_for_selector(".pill[data-kind=warn]:text-is('No news')")


def test_texts_are_never_markup(look, server, fake):
    page = look("program", command=True)
    page.wait_for_selector(".programs >> text=<script>")
    page.click(f"[aria-label='Load {NASTY}']")
    page.wait_for_selector(".line >> text=<script>")
    server.do(fake.raise_alarm("<img src=x onerror='window.hacked = true'>"))
    server.do(
        fake.tell(
            {
                "type": "error",
                "number": 26233,
                "text": "<script>window.hacked = true</script>",
                "cause": "",
                "remedy": "",
            }
        )
    )
    page.wait_for_selector(".notice >> text=<script>")
    page.click("text=1 alarm")
    page.wait_for_selector(".alarm >> text=<img")
    assert page.evaluate("window.hacked") is None
    assert page.evaluate("document.querySelectorAll('main img, main script, .notices script').length") == 0


def test_the_emergency_stop_needs_no_command_right(look, fake):
    page = look()
    page.click("text=Emergency stop")
    page.wait_for_selector(".pill >> text=Emergency stop")
    assert fake.has_received(unit="plc", command="emergency_stop", arguments={"enabled": True})
    page.on("dialog", lambda dialog: dialog.accept())
    page.click("text=Release stop")
    page.wait_for_selector(".pill >> text=Ready")


def test_alarms_have_cause_and_remedy_and_are_acknowledged(look, server, fake):
    page = look("alarms")
    server.do(fake.raise_alarm("axis x: following error 2.5 mm > 1 mm"))
    page.wait_for_selector("text=P-ERR-70100")
    assert "Cause: The axis is blocked" in page.inner_text(".alarm")
    assert "Remedy: Look for what blocks it" in page.inner_text(".alarm")
    page.click("text=Acknowledge >> nth=0")
    page.wait_for_selector("text=Acknowledged by web")
    page.wait_for_selector(".alarm-count >> text=No alarms")


def are_off(page):
    return page.evaluate("[...document.querySelectorAll('fieldset.commands')].every(group => group.disabled)")


def test_the_command_is_taken_and_given(look):
    first, second = look(), look()
    assert are_off(first)
    first.click("text=Take command")
    first.wait_for_selector("text=You are the operator")
    assert not are_off(first)
    second.wait_for_selector("text=Ask for command")
    assert are_off(second)
    first.click("text=Give command")
    first.wait_for_selector("text=No operator")


def test_a_commissioner_takes_the_command_over(look, fake):
    first, second = look(command=True), look()
    asked = []
    second.on("dialog", lambda dialog: (asked.append(dialog.message), dialog.accept()))
    second.click("text=Take over")
    second.wait_for_selector("text=You are the operator")
    assert asked == ["Take the command from web? The jogs of that page end."]
    assert fake.has_received(type="take_command", force=True)
    first.wait_for_selector("text=Operator: web")


def test_an_operator_cannot_take_the_command_over(look, fake):
    fake.role = "operator"
    look(command=True)
    page = look()
    page.wait_for_selector("text=Ask for command")
    assert page.locator("text=Take over").is_hidden()


def test_a_user_logs_out(look, fake):
    fake.has_login = True
    page = look()
    page.click("text=Log out")
    page.wait_for_selector("h2:text-is('Login')")
    page.complaints.texts.clear()  # the browser logs each 401


def test_without_users_a_lost_login_is_renewed_by_the_page(look, server, fake):
    page = look()
    assert page.locator("text=Log out").is_hidden()
    fake.needs_welcome, fake.logged_in = True, False  # the page of the server gives a new cookie
    page.evaluate("app.connection._socket.close()")
    until(page, "app.store.link !== 'open'")
    until(page, "app.store.link === 'open'")
    page.wait_for_selector(".positions")
    page.complaints.texts.clear()


def test_alarms_are_bounded_and_the_newest_are_shown(look, server, fake):
    page = look("alarms")

    async def flood():
        for i in range(1100):
            await fake.raise_alarm(f"alarm {i}")

    server.do(flood())
    page.wait_for_selector(".alarm >> text=alarm 1099")
    until(page, "app.store.alarms.length === 1000")
    assert page.locator(".alarm").count() == 200
    page.wait_for_selector("text=800 older")
