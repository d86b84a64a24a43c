"""Logins in a browser, on the true server: users and their roles, wrong passwords, too many attempts, logins that end."""

import pytest
from web_browser_support import DESKTOP, PATIENCE, InThread, until
from web_support import EXAMPLES, MILL, PASSWORD, users_file

from cnc_ptp.web.access.access import Access
from cnc_ptp.web.access.guard import Names
from cnc_ptp.web.access.users import Users, add_user, remove
from cnc_ptp.web.faces.machine_face import offline_face
from cnc_ptp.web.hub import Hub
from cnc_ptp.web.programs.programs import ProgramFolder
from cnc_ptp.web.server import Server


@pytest.fixture
def users(tmp_path):
    return users_file(tmp_path)


@pytest.fixture
def visit(browser, users):
    """Opens the login in a browser of its own."""
    hub = Hub(lambda: offline_face(MILL), name="mill", folder=ProgramFolder(EXAMPLES), machine_file=MILL)
    with InThread(Server(hub, Access(Users(str(users))), Names()).app) as server:
        pages = []

        def open_one(name="operate"):
            page = browser.new_page(viewport=DESKTOP)
            page.set_default_timeout(PATIENCE)
            page.goto(f"{server.url}#{name}")
            page.wait_for_selector("h2:text-is('Login')")
            pages.append(page)
            return page

        yield open_one
        for page in pages:
            page.close()


def fill(page, user, password):
    page.fill("[name=user]", user)
    page.fill("[name=password]", password)
    page.click("button:text-is('Log in')")


def log_in(page, user, password=PASSWORD):
    fill(page, user, password)
    until(page, "app.store.link === 'open' && app.store.machine !== null")


def test_a_viewer_looks_and_commands_nothing(visit):
    page = visit()
    log_in(page, "vera")
    page.wait_for_selector(".positions .big >> text=/[0-9]/")
    assert page.evaluate("[app.store.user, app.store.role]") == ["vera", "viewer"]
    assert page.locator("button:text-is('Take command')").is_hidden()
    assert page.locator("button:text-is('Emergency stop')").is_disabled()
    assert page.evaluate("[...document.querySelectorAll('fieldset.commands')].every((group) => group.disabled)")


def test_an_operator_commands_and_changes_no_parameter(visit):
    page = visit("commission")
    log_in(page, "otto")
    page.click("text=Take command")
    page.wait_for_selector("text=You are the operator")
    page.click("[role=tab]:text-is('PTP test')")
    page.wait_for_selector("button.primary:text-is('Start'):enabled")
    page.click("[role=tab]:text-is('Identify')")
    page.wait_for_selector("button.primary:text-is('Start'):disabled")


def test_a_commissioner_takes_the_command_from_an_operator(visit):
    operator, page = visit(), visit("commission")
    log_in(operator, "otto")
    operator.click("text=Take command")
    operator.wait_for_selector("text=You are the operator")
    assert operator.locator("button:text-is('Take over')").is_hidden()
    log_in(page, "cora")
    page.wait_for_selector("text=Operator: otto")
    asked = []
    page.on("dialog", lambda dialog: (asked.append(dialog.message), dialog.accept()))
    page.click("button:text-is('Take over')")
    page.wait_for_selector("text=You are the operator")
    assert asked == ["Take the command from otto? The jogs of that page end."]
    operator.wait_for_selector("text=Operator: cora")
    page.click("[role=tab]:text-is('Identify')")
    page.wait_for_selector("button.primary:text-is('Start'):enabled")


@pytest.mark.parametrize(("user", "password"), [("otto", "wrong password"), ("nobody", PASSWORD)])
def test_a_wrong_name_or_password(visit, user, password):
    page = visit()
    fill(page, user, password)
    page.wait_for_selector(".refusal:text-is('name or password is wrong; nothing was done')")
    assert (page.input_value("[name=user]"), page.input_value("[name=password]")) == (user, "")
    log_in(page, "otto")
    page.wait_for_selector(".positions")


def test_too_many_attempts(visit, monkeypatch):
    monkeypatch.setattr("cnc_ptp.web.access.access.LOGINS_PER_SECOND", 1e-3)
    page = visit()
    for _ in range(5):
        fill(page, "otto", "wrong password")
        page.wait_for_selector(".refusal:text-is('name or password is wrong; nothing was done')")
        page.evaluate("document.querySelector('.refusal').textContent = ''")
    fill(page, "otto", PASSWORD)
    page.wait_for_selector(".refusal:text-is('too many attempts to log in; nothing was done; wait a minute')")
    log_in(page, "cora")  # others are not locked out


def test_a_login_ends_for_all_pages_of_its_browser(visit):
    page = visit()
    log_in(page, "otto")
    with page.context.expect_page() as opened:
        page.evaluate("() => void window.open(location.href, '_blank', 'noopener')")
    other = opened.value
    other.set_default_timeout(PATIENCE)
    until(other, "window.app && app.store.link === 'open'")
    page.click("button:text-is('Log out')")
    for each in (page, other):
        each.wait_for_selector("h2:text-is('Login')")


@pytest.mark.parametrize("change", ["removed", "another role"])
def test_a_user_who_is_removed_or_changed_logs_in_again(visit, users, change):
    page = visit()
    log_in(page, "otto")
    if change == "removed":
        remove(users, "otto")
    else:
        add_user(users, "otto", "viewer", PASSWORD)
    page.wait_for_selector(".notice >> text=the login of otto has ended; the page is cut off; log in")
    page.wait_for_selector("h2:text-is('Login')")
    if change == "removed":
        fill(page, "otto", PASSWORD)
        page.wait_for_selector(".refusal:text-is('name or password is wrong; nothing was done')")
    else:
        log_in(page, "otto")
        assert page.evaluate("app.store.role") == "viewer"
