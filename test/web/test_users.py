"""Logins: users, roles, tokens of machines, sessions that end; TLS."""

import asyncio
import os
import pty
import ssl
import subprocess
import sys
import time
from functools import partial
from itertools import count
from types import SimpleNamespace

import aiohttp
import pytest
import trustme
from aiohttp import WSMsgType, web
from click.testing import CliRunner
from web_support import PASSWORD, Page, log_in, page_of, site, users_file

from cnc_ptp.cli import main
from cnc_ptp.errors import CncError
from cnc_ptp.web.access.access import Access
from cnc_ptp.web.access.logins import IDLE_TIME, LONGEST_TIME, MOST, Logins
from cnc_ptp.web.access.security import tls_context
from cnc_ptp.web.access.users import Users, add_token, add_user, read_users, remove
from cnc_ptp.web.hub import LOGINS_PERIOD
from cnc_ptp.web.rate import Rate


@pytest.fixture
def users(tmp_path):
    return users_file(tmp_path)


def run(story, **options):
    async def told():
        async with site(**options) as here:
            await story(here)

    asyncio.run(told())


def test_roles(users):
    async def story(here):
        vera = await page_of(here, "vera")
        assert (vera.hello["user"], vera.hello["role"]) == ("vera", "viewer")
        refused = await vera.ask("take_command")
        text = "take_command: vera is viewer; it takes the role operator; nothing was done"
        assert (refused["number"], refused["text"]) == (26235, text)
        refused = await vera.command("x", "halt")
        assert refused["number"] == 26235
        otto = await page_of(here, "otto")
        assert (await otto.ask("take_command"))["ok"]
        refused = await otto.command("x", "write_parameter", parameter="P-AXIS-00099", value=1)
        text = "axis x: write_parameter: otto is operator; it takes the role commissioner; nothing was done"
        assert (refused["number"], refused["text"]) == (26235, text)
        refused = await otto.ask("identify", axis="x", what="friction")
        assert refused["number"] == 26235
        assert (await otto.command("x", "move_absolute", target=1))["ok"]
        assert ("otto", "x", "move_absolute") in here.hub.face.users
        events = [await otto.wait_for("event", lambda event: event["text"].startswith("otto")) for _ in range(3)]
        assert [event["text"] for event in events] == [
            f"otto (page {otto.hello['page']}): take_command",
            "otto: axis x: write_parameter, P-ERR-26235",
            "otto: axis x: move_absolute, carried out",
        ]

    run(story, users=users)


async def page_of_machine(here, token):
    page = Page(await here.client.ws_connect("/ws", headers={"Authorization": f"Bearer {token}"}))
    await page.send(type="hello", token=token)
    page.hello = await page.wait_for("hello")
    return page


def test_a_page_without_login(users):
    async def story(here):
        assert (await here.client.get("/")).status == 200
        for path in ("/api/session", "/api/programs", "/ws", "/api/backplot", "/api/parameters"):
            assert (await here.client.get(path)).status == 401

    run(story, users=users)


@pytest.mark.parametrize(("name", "password"), [("otto", "wrong password"), ("nobody", PASSWORD), ("otto", "")])
def test_a_wrong_password(users, name, password):
    async def story(here):
        answer = await log_in(here, name, password)
        text = "name or password is wrong; nothing was done"
        assert (answer.status, (await answer.json())["text"]) == (401, text)

    run(story, users=users)


def test_many_attempts(users, monkeypatch):
    async def story(here):
        for _ in range(5):
            assert (await log_in(here, "otto", "wrong password")).status == 401
        answer = await log_in(here, "otto")
        text = "too many attempts to log in; nothing was done; wait a minute"
        assert (answer.status, (await answer.json())["number"], (await answer.json())["text"]) == (429, 26255, text)
        assert (await log_in(here, "cora")).status == 200

    monkeypatch.setattr("cnc_ptp.web.access.access.LOGINS_PER_SECOND", 1e-3)
    run(story, users=users)


def test_logging_out_ends_pages(users):
    async def story(here):
        page = await page_of(here, "otto")
        token = (await (await here.client.get("/api/session")).json())["token"]
        assert (await here.client.post("/api/logout")).status == 401
        assert (await here.client.post("/api/logout", headers={"X-Token": token})).status == 200
        error = await page.wait_for("error")
        assert (error["number"], error["text"]) == (26239, "the login of otto has ended; the page is cut off; log in")
        while not page.socket.closed:
            await page.socket.receive()
        assert (await here.client.get("/api/session")).status == 401

    run(story, users=users)


def test_a_user_who_is_removed(users):
    async def story(here):
        page = await page_of(here, "otto")
        remove(users, "otto")
        assert (await page.wait_for("error"))["number"] == 26239

    run(story, users=users)


@pytest.mark.parametrize(("role", "password"), [("viewer", PASSWORD), ("operator", "another password")])
def test_a_user_with_another_role_or_password(users, role, password):
    async def story(here):
        page = await page_of(here, "otto")
        add_user(users, "otto", role, password)
        assert (await page.wait_for("error"))["number"] == 26239
        assert (await here.client.get("/api/session")).status == 401

    run(story, users=users)


@pytest.mark.parametrize("change", [lambda file: remove(file, "cell"), lambda file: add_token(file, "cell", "viewer")])
def test_a_token_that_is_taken_back_ends_its_socket(users, change):
    token = add_token(users, "cell", "operator")

    async def story(here):
        page = await page_of_machine(here, token)
        change(users)
        assert (await page.wait_for("error"))["number"] == 26239

    run(story, users=users)


def test_a_login_ends_while_there_is_no_machine(users):
    def none():
        raise CncError(26108, "no machine", "none")

    async def story(here):
        page = await page_of(here, "otto")
        remove(users, "otto")
        assert (await page.wait_for("error"))["number"] == 26239

    run(story, users=users, connect=none, waits=False)


def test_a_program_is_replaced_by_the_machine_that_commands(users, tmp_path):
    """Each of its requests has a login of its own; not by another machine, nor with the command of a browser."""
    programs = tmp_path / "programs"
    programs.mkdir()
    cell, robot = add_token(users, "cell", "operator"), add_token(users, "robot", "operator")

    async def story(here):
        async def status_of(token, query=""):
            headers = {"Authorization": f"Bearer {token}"}
            path = f"/api/programs?name=part.nc{query}"
            return (await here.client.post(path, data=b"M30\n", headers=headers)).status

        assert await status_of(cell) == 200
        page = await page_of(here, "otto")
        assert (await page.ask("take_command"))["ok"]
        assert await status_of(cell, "&replace=1") == 403
        assert (await page.ask("give_command"))["ok"]
        machine = await page_of_machine(here, cell)
        assert await status_of(cell, "&replace=1") == 403
        assert (await machine.ask("take_command"))["ok"]
        assert await status_of(cell, "&replace=1") == 200
        assert await status_of(robot, "&replace=1") == 403

    run(story, users=users, programs=str(programs))


def test_wrong_passwords_do_not_lock_others_out(users, monkeypatch):
    monkeypatch.setattr("cnc_ptp.web.access.access.LOGINS_PER_SECOND", 1e-3)

    async def story():
        access = Access(Users(str(users)))
        for _ in range(5):
            with pytest.raises(CncError, match="name or password is wrong"):
                await access.log_in("otto", "wrong password", "192.0.2.1")
        with pytest.raises(CncError, match="too many attempts"):
            await access.log_in("otto", PASSWORD, "192.0.2.1")
        assert await access.log_in("otto", PASSWORD, "192.0.2.2")

    asyncio.run(story())


def test_a_password_of_half_characters(users):
    async def story(here):
        content = '{"user": "otto", "password": "\\ud800"}'
        answer = await here.client.post("/api/login", data=content)
        assert answer.status == 401

    run(story, users=users)


@pytest.mark.parametrize("content", [b"\xff\xfe", b'{"user": "\xff"}', b"{"])
def test_a_login_that_is_no_text(users, content):
    async def story(here):
        answer = await here.client.post("/api/login", data=content)
        shown = content.decode(errors="replace")
        assert answer.status == 400
        assert (await answer.json())["text"] == f"message {shown!r} is not JSON; nothing was done"

    run(story, users=users)


def test_without_users_a_page_is_logged_in_again():
    """The server has begun again, or its cookie was lost: the page asks for its session, and goes on."""

    async def story(here):
        here.client.session.cookie_jar.clear()
        assert (await here.client.get("/api/programs")).status == 401
        answer = await here.client.get("/api/session")
        assert (answer.status, (await answer.json())["role"]) == (200, "commissioner")
        assert f"cnc_ptp_{here.client.port}=" in answer.headers["Set-Cookie"]
        assert (await here.client.get("/api/programs")).status == 200

    run(story)


def test_without_users_a_login_has_no_end():
    logins = Access().logins
    logins._now = lambda: 1e9
    key = logins.begin("web", "commissioner")
    logins._now = lambda: 2e9
    assert logins.find(key)


def test_a_token_of_a_machine(users):
    token = add_token(users, "cell", "operator")

    async def story(here):
        page = await page_of_machine(here, token)
        assert (page.hello["user"], page.hello["role"]) == ("cell", "operator")
        answer = await here.client.get("/api/programs", headers={"Authorization": "Bearer guessed"})
        assert (answer.status, (await answer.json())["text"]) == (401, "the token is not known; nothing was done")

    run(story, users=users)


@pytest.mark.parametrize("hours", [1, 13])
def test_the_socket_of_a_machine_lasts_as_long_as_its_token(users, hours):
    token = add_token(users, "cell", "operator")

    async def story(here):
        page = await page_of_machine(here, token)
        here.access.logins._now = lambda: time.monotonic() + hours * 3600.0
        await asyncio.sleep(2 * LOGINS_PERIOD)
        assert (await page.ask("take_command"))["ok"]
        remove(users, "cell")
        assert (await page.wait_for("error"))["number"] == 26239

    run(story, users=users)


def test_logins_that_are_used_or_have_open_pages_are_remembered():
    """Requests without a cookie, of whomever, do not end them."""

    async def story(here):
        await here.page()
        [shown] = here.access.logins._logins
        here.access.logins._now = partial(next, count(time.monotonic()))
        used, left = (here.access.logins.begin("web", "commissioner") for _ in range(2))
        for _ in range(2 * MOST):
            here.access.logins.begin("web", "commissioner")
            assert here.access.logins.find(used)
        assert len(here.access.logins._logins) == MOST and here.access.logins.find(left) is None
        assert (await here.client.get("/api/programs")).status == 200
        assert shown in here.access.logins._logins

    run(story)


def test_logins_end():
    clock = SimpleNamespace(now=0.0)
    logins = Logins(now=lambda: clock.now)
    idle, busy = logins.begin("a", "viewer"), logins.begin("b", "viewer")
    for _ in range(3):
        clock.now += 0.6 * IDLE_TIME
        assert logins.find(busy)
    assert logins.find(idle) is None
    while clock.now < LONGEST_TIME:
        assert logins.find(busy)
        clock.now += 0.6 * IDLE_TIME
    assert logins.find(busy) is None


def test_a_rate():
    clock = SimpleNamespace(now=0.0)
    rate = Rate(2.0, 3.0, now=lambda: clock.now)
    assert [rate.permits() for _ in range(4)] == [True, True, True, False]
    clock.now += 0.5
    assert [rate.permits() for _ in range(2)] == [True, False]


def test_the_file_has_no_password(users):
    content = users.read_text()
    assert PASSWORD not in content and content.count("$argon2id$") == 3
    assert os.stat(users).st_mode & 0o077 == 0


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        ("users: [", "it is no YAML"),
        ("users: {anna: {role: 2001-13-45, hash: abc}}", "it is no YAML"),
        ("users: {anna: {role: !!bool x, hash: abc}}", "it is no YAML"),
        (f"users: {'[' * 3000}", "it is no YAML"),
        ("users: &a {anna: *a}", "it is no YAML"),
        ("- 1", "it has no users and tokens by name"),
        ("users: [a]", "users are no names with role and hash"),
        ("users: {a: {role: king, hash: x}}", "users: 'a' has no role (viewer, operator, commissioner) or no hash"),
    ],
)
def test_a_file_that_cannot_be_used(tmp_path, content, reason):
    file = tmp_path / "users.yaml"
    file.write_text(content)
    with pytest.raises(CncError) as refused:
        Users(str(file))
    text = f"users file {file} cannot be used: {reason}; nothing was started"
    assert (refused.value.number, refused.value.message) == (26246, text)


def test_a_file_that_others_may_write(users):
    users.chmod(0o666)
    with pytest.raises(CncError) as refused:
        read_users(users)
    reason = "others may write it (mode 666); make it 600"
    assert refused.value.message == f"users file {users} cannot be used: {reason}; nothing was started"


def test_a_file_that_is_not_there(tmp_path):
    with pytest.raises(CncError) as refused:
        Users(str(tmp_path / "none.yaml"))
    text = f"users file {tmp_path}/none.yaml cannot be used: No such file or directory; nothing was started"
    assert refused.value.message == text


@pytest.mark.parametrize(
    ("words", "status", "text"),
    [
        (["add", "anna", "--role", "operator", "--password", "short"], 2,
         "P-ERR-26246 user anna: a password has 8 to 256 characters, not 5; nothing was changed"),
        (["add", "a b", "--role", "operator", "--password", PASSWORD], 2,
         "P-ERR-26246 'a b' is no name: letters, digits, _ . @ -; nothing was changed"),
        (["add", "anna", "--role", "operator", "--password", PASSWORD], 0, "anna is operator"),
        (["list"], 0, "user   operator      otto"),
        (["remove", "vera"], 0, "vera is removed"),
    ],
)  # fmt: skip
def test_the_command(users, words, status, text):
    result = CliRunner().invoke(main, ["users", *words, "--users", str(users)])
    assert result.exit_code == status
    assert text in result.output.splitlines()


@pytest.mark.parametrize("ending", ["\n", "\r\nmore", ""])
def test_a_password_from_a_pipe(users, ending):
    words = ["users", "add", "anna", "--role", "operator", "--users", str(users)]
    result = CliRunner().invoke(main, words, input=f"{PASSWORD}{ending}")
    assert (result.exit_code, result.output) == (0, "anna is operator\n")
    assert Users(str(users)).check("anna", PASSWORD)


@pytest.mark.parametrize(
    ("given", "reason"),
    [("<&-", "a password has 8 to 256 characters, not 0"), ("<latin", "the password is not UTF-8")],
)
def test_a_password_that_is_none(users, tmp_path, given, reason):
    (tmp_path / "latin").write_bytes(b"\xfc" * 8)
    words = [sys.executable, "-m", "cnc_ptp", "users", "add", "anna", "--role", "operator", "--users", str(users)]
    done = subprocess.run(
        ["sh", "-c", f'exec "$@" {given}', "sh", *words], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stderr) == (2, f"P-ERR-26246 user anna: {reason}; nothing was changed\n")
    assert "anna" not in read_users(users)["users"]


def test_a_password_of_somebody_at_a_terminal(users):
    """It is asked for twice, and not shown."""
    command = [sys.executable, "-m", "cnc_ptp", "users", "add", "anna", "--role", "viewer", "--users", str(users)]
    own, other = pty.openpty()
    with subprocess.Popen(command, stdin=other, stdout=other, stderr=other, start_new_session=True) as asking:
        os.close(other)
        seen = ""
        for prompt in ("Password: ", "Repeat for confirmation: "):
            while not seen.endswith(prompt):
                seen += os.read(own, 1000).decode()
            os.write(own, f"{PASSWORD}\n".encode())
        while "anna is viewer" not in seen:
            seen += os.read(own, 1000).decode()
    os.close(own)
    assert asking.returncode == 0 and PASSWORD not in seen
    assert read_users(users)["users"]["anna"].role == "viewer"


@pytest.mark.parametrize("words", [["add", "--password", PASSWORD], ["token"]], ids=lambda words: words[0])
def test_a_folder_that_is_not_there(tmp_path, words):
    file = tmp_path / "none" / "users.yaml"
    result = CliRunner().invoke(main, ["users", *words, "anna", "--role", "viewer", "--users", str(file)])
    assert result.exit_code == 2
    text = f"users file {file} cannot be written: No such file or directory; nothing was changed"
    assert result.output == f"P-ERR-26246 {text}\n"


def test_a_user_and_a_token_cannot_have_one_name(users):
    add_token(users, "cell", "operator")
    before = users.read_bytes()
    for add, kind in (
        (lambda: add_token(users, "otto", "viewer"), "'otto' among its users"),
        (lambda: add_user(users, "cell", "viewer", PASSWORD), "'cell' among its tokens"),
    ):
        with pytest.raises(CncError) as refused:
            add()
        assert refused.value.number == 26246
        assert refused.value.message == f"users file {users} has {kind} already; nothing was changed"
    assert users.read_bytes() == before


def test_removing_nobody(users):
    with pytest.raises(CncError) as refused:
        remove(users, "oto")
    text = f"users file {users} has no 'oto'; did you mean otto?; nothing was changed"
    assert refused.value.message == text


def test_tls(users, tmp_path):
    authority = trustme.CA()
    made = authority.issue_cert("127.0.0.1")
    certificate, key = tmp_path / "c.pem", tmp_path / "k.pem"
    certificate.write_bytes(b"".join(blob.bytes() for blob in made.cert_chain_pems))
    key.write_bytes(made.private_key_pem.bytes())

    async def story(here):
        runner = web.AppRunner(here.client.server.app)
        await runner.setup()
        served = web.TCPSite(runner, "127.0.0.1", 0, ssl_context=tls_context(str(certificate), str(key)))
        await served.start()
        port = served._server.sockets[0].getsockname()[1]
        trusted = ssl.create_default_context()
        authority.configure_trust(trusted)
        async with aiohttp.ClientSession(cookie_jar=aiohttp.CookieJar(unsafe=True)) as session:
            address = f"https://127.0.0.1:{port}"
            answer = await session.post(
                f"{address}/api/login",
                json={"user": "otto", "password": PASSWORD},
                ssl=trusted,
                headers={"Origin": address},
            )
            assert answer.status == 200 and "Secure" in answer.headers["Set-Cookie"]
            token = (await (await session.get(f"{address}/api/session", ssl=trusted)).json())["token"]
            socket = await session.ws_connect(f"{address}/ws", ssl=trusted)
            await socket.send_json({"type": "hello", "token": token})
            assert (await socket.receive()).type is WSMsgType.TEXT
            await socket.close()
        await served.stop()

    run(story, users=users)
