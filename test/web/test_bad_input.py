"""What pages, browsers and networks do wrong, and how each of it ends."""

import asyncio
from contextlib import suppress
from itertools import pairwise

import pytest
from aiohttp import WSMsgType, WSServerHandshakeError
from aiohttp.test_utils import unused_port
from web_support import MILL, site

from cnc_ptp.errors import CncError
from cnc_ptp.web.access.security import require_secured, tls_context
from cnc_ptp.web.faces.machine_face import offline_face
from cnc_ptp.web.options import WebOptions, listen
from cnc_ptp.web.programs.programs import ProgramFolder

LONGEST_GAP = 1.0
"""Seconds between two positions, 0.04 where nothing else runs: computers of tests are busy."""


def run(story, **options):
    async def told():
        async with site(**options) as here:
            await story(here)

    asyncio.run(told())


async def end_of(socket):
    """The messages until the socket is closed, and its code."""
    found = []
    while True:
        message = await asyncio.wait_for(socket.receive(), 10.0)
        if message.type is not WSMsgType.TEXT:
            return found, socket.close_code
        found.append(message.json())


def test_the_port_is_taken():
    port = unused_port()
    with listen("127.0.0.1", port), pytest.raises(CncError) as refused:
        listen("127.0.0.1", port)
    text = f"web: 127.0.0.1 port {port}: another program listens there; nothing was started, give another one"
    assert (refused.value.number, refused.value.message) == (26231, text)


@pytest.mark.parametrize(
    ("sent", "text"),
    [
        ("{", "message '{' is not JSON; nothing was done"),
        ('{"type": NaN}', "message '{\"type\": NaN}' is not JSON; nothing was done"),
        ("[]", "message '[]' is not an object; nothing was done"),
        ('{"id": 1}', "message '{\"id\": 1}' has no type; nothing was done"),
        ('{"type": "jog"}', "jog: axis is missing; nothing was done"),
        ('{"type": "jog", "axis": 3}', "jog: axis = '3' is not a text; nothing was done"),
        (
            '{"type": "jog", "axis": "x", "velocity": 1e999}',
            "jog: velocity = 'inf' is not a number; nothing was done",
        ),
    ],
)
def test_a_message_that_is_none(sent, text):
    async def story(here):
        page = await here.page()
        await page.socket.send_str(sent)
        error = await page.wait_for("error")
        assert (error["number"], error["text"]) == (26233, text)
        assert (await page.ask("ping"))["ok"]

    run(story)


def test_a_message_of_an_unknown_type():
    async def story(here):
        page = await here.page()
        answer = await page.ask("comand")
        begin = "message of the unknown type 'comand'; did you mean command?; nothing was done. Known: command, jog,"
        assert (answer["number"], answer["text"][: len(begin)]) == (26233, begin)

    run(story)


def test_ten_thousand_messages_at_once():
    async def story(here):
        page = await here.page()
        for _ in range(10_000):
            if page.socket.closed:
                break
            try:
                await page.send(type="ping", id=1)
            except ConnectionError:
                break
        messages, code = await end_of(page.socket)
        errors = [message for message in messages if message["type"] == "error"]
        assert [(error["number"], error["text"]) for error in errors] == [
            (26234, "more than 200 messages a second; the page is cut off")
        ]
        assert code == 1008
        assert (await (await here.page()).ask("ping"))["ok"]

    run(story)


async def flood(page):
    """10,000 messages in a second, also after the page was cut off: it does not listen."""
    with suppress(ConnectionError):
        for _ in range(100):
            for _ in range(100):
                await page.send(type="ping", id=1)
            await asyncio.sleep(0.01)


async def watch_positions(page, seen):
    """When positions of x have come, and where x was."""
    while True:
        message = await page.wait_for("state", lambda state: "set_position" in state["units"].get("x", {}))
        seen.append((asyncio.get_running_loop().time(), message["units"]["x"]["set_position"]))


def test_another_page_goes_on_getting_positions_while_one_sends_ten_thousand_messages_a_second():
    async def story(here):
        operator, other, page = await here.page(), await here.page(commands=False), await here.page(commands=False)
        assert (await operator.command("x", "move_velocity", velocity=1.0))["ok"]
        seen, now = [], asyncio.get_running_loop().time
        watching = asyncio.create_task(watch_positions(other, seen))
        begin = now()
        await flood(page)
        end = now()
        watching.cancel()
        assert (await end_of(page.socket))[1] == 1008
        times, places = zip(*seen, strict=True)
        assert [*places] == sorted({*places})
        assert max(later - earlier for earlier, later in pairwise([begin, *times, end])) < LONGEST_GAP

    run(story)


@pytest.mark.parametrize("size", [(1 << 20) + 1, 8 << 20])
def test_a_message_of_more_than_a_mebibyte(size):
    async def story(here):
        page, other = await here.page(), await here.page(commands=False)
        await page.socket.send_str('{"type": "ping", "id": 1, "text": "' + "x" * (size - 40) + '"}' + " " * 40)
        messages, code = await end_of(page.socket)
        errors = [message for message in messages if message["type"] == "error"]
        text = "a message of the page is larger than 1048576 bytes; it was not read, and the page is cut off"
        assert [(error["number"], error["text"]) for error in errors] == [(26205, text)]
        assert errors[0]["remedy"].startswith("Load a large program from the program folder")
        assert code == 1009
        await other.wait_for("operator", lambda message: message["holder"] is None)
        assert (await other.ask("take_command"))["ok"]

    run(story)


def test_a_message_of_a_mebibyte():
    async def story(here):
        page = await here.page()
        begin = '{"type": "ping", "id": 77}'
        await page.socket.send_str(begin + " " * ((1 << 20) - len(begin)))
        assert (await page.wait_for("answer", lambda answer: answer["id"] == 77))["ok"]

    run(story)


def test_a_first_message_that_is_too_large():
    async def story(here):
        await here.token()
        socket = await here.client.ws_connect("/ws")
        await socket.send_str("x" * (2 << 20))
        messages, code = await end_of(socket)
        assert [message["number"] for message in messages] == [26205] and code == 1009
        assert not here.hub.sessions

    run(story)


@pytest.mark.parametrize("path", ["/", "/api/session", "/api/programs", "/ws"])
def test_a_forged_origin(path):
    async def story(here):
        await here.token()
        answer = await here.client.get(path, headers={"Origin": "http://evil.example"})
        own = f"http://{here.client.host}:{here.client.port}"
        text = f"origin 'http://evil.example' is not {own}; nothing was done"
        assert (answer.status, (await answer.json())["number"], (await answer.json())["text"]) == (403, 26237, text)

    run(story)


def test_a_name_that_was_bent_to_this_computer():
    async def story(here):
        answer = await here.client.get("/", headers={"Host": "evil.example:8080"})
        text = "host 'evil.example' is none of localhost, 127.0.0.1, ::1; nothing was done"
        assert (answer.status, (await answer.json())["text"]) == (403, text)

    run(story)


@pytest.mark.parametrize(
    ("first", "number", "text"),
    [
        ({"type": "hello", "token": "guessed"}, 26238, "the token of the page is wrong; nothing was done; load the page again"),
        ({"type": "take_command"}, 26233, "the first message is not hello; nothing was done"),
        ({"type": "hello"}, 26233, "hello: token is missing; nothing was done"),
    ],
)  # fmt: skip
def test_a_wrong_token(first, number, text):
    async def story(here):
        await here.token()
        socket = await here.client.ws_connect("/ws")
        await socket.send_json(first)
        messages, code = await end_of(socket)
        assert [(message["number"], message["text"]) for message in messages] == [(number, text)]
        assert code == 1008 and not here.hub.sessions

    run(story)


def test_no_cookie():
    async def story(here):
        for path in ("/api/programs", "/api/backplot", "/ws"):
            answer = await here.client.get(path)
            text = "there is no login, or it has ended; nothing was done; log in"
            assert (answer.status, (await answer.json())["text"]) == (401, text)

    run(story)


BAD_NAME = (
    "is no name of a program: up to 80 ASCII letters, digits, blanks and _ . + -, "
    "beginning with a letter, digit or _, ending in .nc, .ngc, .cnc, .tap, .mpf, .spf"
)


@pytest.mark.parametrize(
    "name",
    [
        "../part.nc",
        " a.nc",
        "\u00e4.nc",
        "a" * 78 + ".nc",
        "a/b.nc",
        "/etc/x.nc",
        "<script>.nc",
        ".nc",
        "part.py",
        "..",
        "",
        "a\0.nc",
    ],
)
def test_a_name_that_no_program_may_have(name, tmp_path):
    async def story(here):
        headers = {"X-Token": await here.token()}
        answer = await here.client.post("/api/programs", params={"name": name}, data=b"M30\n", headers=headers)
        error = await answer.json()
        assert (answer.status, error["number"]) == (400, 26240)
        assert error["text"] == f"'{name[:80]}' {BAD_NAME}; nothing was read or written"
        assert [*folder.iterdir()] == []

    folder = tmp_path / "programs"
    folder.mkdir()
    run(story, programs=str(folder))


@pytest.mark.parametrize("name", ["part 2.nc", "_a+b-c.1.NC", f"{'a' * 77}.nc"])
def test_a_name_that_a_program_may_have(name, tmp_path):
    assert ProgramFolder(str(tmp_path)).save(name, b"M30\n") == (name, 4)


def test_reading_and_loading_outside_of_the_folder(tmp_path):
    async def story(here):
        page = await here.page()
        for name in ("../secret.nc", "secret.nc", "link.nc"):
            assert not (await page.ask("load", name=name))["ok"]
        answer = await here.client.get("/api/programs/..%2Fsecret.nc")
        assert (answer.status, (await answer.json())["number"]) == (400, 26240)
        answer = await here.client.get("/api/programs/link.nc")
        text = "program 'link.nc' is not in the program folder; nothing was read"
        assert (answer.status, (await answer.json())["text"]) == (404, text)
        refused = await page.command("channel", "load", program="/etc/passwd")
        text = "channel channel: load refused: pages do not give this command; nothing was done"
        assert (refused["number"], refused["text"]) == (26249, text)
        refused = await page.command("x", "couple_cam", master="y", file="/etc/passwd")
        text = "axis x: couple_cam refused: pages do not give the argument 'file'; nothing was done"
        assert (refused["number"], refused["text"]) == (26249, text)

    folder = tmp_path / "programs"
    folder.mkdir()
    (tmp_path / "secret.nc").write_text("M30\n")
    (folder / "link.nc").symlink_to(tmp_path / "secret.nc")
    run(story, programs=str(folder))


def test_an_upload(tmp_path):
    async def story(here):
        token = {"X-Token": await here.token()}
        for headers, status in (({}, 401), ({"X-Token": "guessed"}, 401), (token, 200), (token, 409)):
            answer = await here.client.post("/api/programs?name=a.nc", data=b"M30\n", headers=headers)
            assert answer.status == status
        text = "program 'a.nc' is in the folder already; nothing was written"
        assert ((await answer.json())["number"], (await answer.json())["text"]) == (26257, text)
        await here.page()  # with the command
        answer = await here.client.post("/api/programs?name=a.nc&replace=1", data=b"G4 X1\nM30\n", headers=token)
        assert await answer.json() == {"name": "a.nc", "size": 10}
        assert (tmp_path / "a.nc").read_bytes() == b"G4 X1\nM30\n"
        answer = await here.client.post("/api/programs?name=b.nc", data=b"\xff\xfe", headers=token)
        assert (await answer.json())["text"] == "program 'b.nc' is no text in UTF-8; nothing was written"

    run(story, programs=str(tmp_path))


def test_an_upload_of_200_megabytes(tmp_path):
    size = 200 << 20

    async def endless():
        for _ in range(200):
            yield bytes(1 << 20)

    async def story(here):
        token = {"X-Token": await here.token(), "Content-Length": str(size)}
        try:
            answer = await here.client.post("/api/programs?name=big.nc", data=endless(), headers=token)
        except (ConnectionError, OSError):
            return  # the server has closed before it had read all of it
        finally:
            assert [*tmp_path.iterdir()] == []
        text = f"a program of {size} bytes is larger than {32 << 20} bytes; nothing was written"
        assert (answer.status, (await answer.json())["number"], (await answer.json())["text"]) == (413, 26241, text)

    run(story, programs=str(tmp_path))


def test_two_operators():
    async def story(here):
        anna, bert = await here.page(), await here.page(commands=False)
        refused = await bert.command("x", "move_absolute", target=1)
        holder = f"web (page {anna.hello['page']})"
        text = f"axis x: move_absolute: this page does not hold the command, {holder} holds it; nothing was done"
        assert (refused["number"], refused["text"]) == (26236, text)
        refused = await bert.ask("take_command")
        text = f"take_command: {holder} holds the command; nothing was done; ask for the command, or wait until it is given"
        assert (refused["number"], refused["text"]) == (26236, text)
        refused = await bert.ask("give_command")
        assert refused["number"] == 26236
        assert (await bert.command("x", "halt")).get("number") != 26236  # everybody may stop
        assert (await bert.ask("ask_command"))["ok"]
        asked = await anna.wait_for("operator", lambda message: message["asking"])
        assert asked["asking"]["page"] == bert.hello["page"]
        assert (await anna.ask("give_command"))["ok"]
        assert (await bert.wait_for("operator", lambda message: not message["asking"] and message["holder"]))["holder"][
            "page"
        ] == bert.hello["page"]
        assert (await bert.command("x", "move_absolute", target=1))["ok"]
        refused = await anna.command("x", "move_absolute", target=1)
        assert refused["number"] == 26236

    run(story)


def test_the_operator_leaves():
    async def story(here):
        anna, bert = await here.page(), await here.page(commands=False)
        await anna.socket.close()
        await bert.wait_for("operator", lambda message: message["holder"] is None)
        assert (await bert.ask("take_command"))["ok"]

    run(story)


def test_the_machine_ends_while_the_page_is_open():
    async def story(here):
        page = await here.page()
        here.hub.face._machine.plc.stop_all()
        gone = await page.wait_for("gone")
        assert (gone["number"], gone["text"]) == (26171, "the machine has ended: its run has ended; its units stand")
        answer = await page.command("x", "halt")
        assert (answer["number"], answer["text"]) == (
            26171,
            "the machine has ended: its run has ended; nothing was sent",
        )
        assert (await page.wait_for("back")) and (await page.wait_for("hello"))["machine"]

    run(story)


def test_the_page_is_opened_before_the_machine():
    machines = []

    def connect():
        if not machines:
            raise CncError(26135, "no machine is running on ROS domain 0", "nothing was sent")
        return machines.pop()

    async def story(here):
        page = await here.page(commands=False)
        assert page.hello["machine"] is None
        assert (await page.ask("take_command"))["ok"]
        answer = await page.command("x", "halt")
        assert answer["number"] == 26244
        machines.append(offline_face(MILL))
        await page.wait_for("back")
        assert (await page.wait_for("hello"))["machine"]["name"] == "mill"
        assert (await page.command("x", "move_absolute", target=1))["ok"]

    run(story, connect=connect, waits=False)


def test_a_scope_of_what_there_is_not():
    async def story(here):
        page = await here.page()
        answer = await page.ask("scope", signals=["x.set_postion"])
        text = "scope: there is no signal 'x.set_postion'; did you mean x.set_position?; nothing was done"
        assert (answer["number"], answer["text"]) == (26250, text)
        answer = await page.ask("scope", signals=["x.set_position"] * 33)
        assert (answer["number"], answer["text"]) == (26251, "scope: 33 signals are more than 32; nothing was done")

    run(story)


def test_headers_of_every_answer():
    async def story(here):
        for path in ("/", "/api/session", "/static/index.html", "/nothing"):
            answer = await here.client.get(path)
            assert answer.headers["Content-Security-Policy"].startswith("default-src 'self';")
            assert answer.headers["X-Content-Type-Options"] == "nosniff"
        here.client.session.cookie_jar.clear()
        cookie = (await here.client.get("/")).headers["Set-Cookie"]
        assert "HttpOnly" in cookie and "SameSite=Strict" in cookie

    run(story)


@pytest.mark.parametrize(
    ("options", "text"),
    [
        (("0.0.0.0", None, None, None), "web: 0.0.0.0 can be reached by others, and --tls-cert, --tls-key, --users are missing; nothing was started; off loopback it needs TLS and users"),
        (("192.168.0.5", "c.pem", "k.pem", None), "web: 192.168.0.5 can be reached by others, and --users is missing; nothing was started; off loopback it needs TLS and users"),
        (("127.0.0.1", "c.pem", None, None), "web: --tls-cert and --tls-key belong together; nothing was started"),
    ],
)  # fmt: skip
def test_an_address_that_others_reach(options, text):
    with pytest.raises(CncError) as refused:
        host, certificate, key, users = options
        require_secured(WebOptions(host=host, certificate=certificate, key=key, users=users))
    assert (refused.value.number, refused.value.message) == (26232, text)


def test_a_certificate_that_is_none(tmp_path):
    file = str(tmp_path / "c.pem")
    with pytest.raises(CncError) as refused:
        tls_context(file, file)
    text = f"web: certificate {file} with key {file} cannot be used: No such file or directory; nothing was started"
    assert (refused.value.number, refused.value.message) == (26247, text)


def test_a_page_that_says_nothing(monkeypatch):
    async def story(here):
        await here.token()
        socket = await here.client.ws_connect("/ws")
        messages, code = await end_of(socket)
        assert [message["text"] for message in messages] == ["no hello within 0.1 s; nothing was done"]
        assert code == 1008

    monkeypatch.setattr("cnc_ptp.web.server.FIRST_MESSAGE", 0.1)
    run(story)


def test_too_many_pages(monkeypatch):
    async def story(here):
        await here.page()
        answer = await here.client.get("/ws")
        assert (answer.status, (await answer.json())["text"]) == (
            503,
            "the limit of open pages is reached, 1; nothing was done; close one",
        )

    monkeypatch.setattr("cnc_ptp.web.server.MOST_SESSIONS", 1)
    run(story)


def test_sockets_that_have_not_said_hello_are_pages_too(monkeypatch):
    """However many come at once; the place of one that has ended is free."""

    async def story(here):
        await here.token()
        opened = await asyncio.gather(*(here.client.ws_connect("/ws") for _ in range(5)), return_exceptions=True)
        sockets = [each for each in opened if not isinstance(each, Exception)]
        refused = [each.status for each in opened if isinstance(each, WSServerHandshakeError)]
        assert (len(sockets), refused) == (2, [503] * 3)
        await sockets[0].close()
        while (await here.client.get("/ws")).status == 503:
            await asyncio.sleep(0.01)
        await here.page()

    monkeypatch.setattr("cnc_ptp.web.server.MOST_SESSIONS", 2)
    run(story)


def test_texts_of_programs_are_texts():
    async def story(here):
        page = await here.page()
        text = "(<script>alert(1)</script>)\nG4 X5\nM30\n"
        assert (await page.ask("load", name="part.nc", text=text))["ok"]
        await page.wait_for("program")
        answer = await here.client.get("/api/programs/part.nc")
        assert answer.headers["Content-Type"] == "text/plain; charset=utf-8", await answer.text()
        assert await answer.text() == text

    run(story)
