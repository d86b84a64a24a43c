"""What pages share: the command, the program folder, and what the machine tells all of them."""

import asyncio
import tempfile
from functools import partial
from types import SimpleNamespace

import pytest
from web_support import page_of, site, users_file

from cnc_ptp.protocol.blocks import AxisBlock, CommandRecord
from cnc_ptp.web.commissioning.tasks import Tasks
from cnc_ptp.web.faces.targets import Targets


@pytest.fixture
def users(tmp_path):
    return users_file(tmp_path)


def run(story, **options):
    async def told():
        async with site(**options) as here:
            await asyncio.wait_for(story(here), 60.0)

    asyncio.run(told())


def record(command, *, cycle=10, **arguments):
    return CommandRecord(cycle, "x", command, arguments, True, 0, "")


def test_the_target_of_an_axis():
    targets = Targets(["x"])
    block = AxisBlock(0, 20, set_position=[0.5 * n for n in range(20)])
    moving = AxisBlock(0, 5, set_position=[1.0] * 5, set_velocity=[2.0] * 5)
    standing = AxisBlock(0, 5, set_position=[1.0] * 5, set_velocity=[0.0] * 5)
    later = AxisBlock(20, 5, set_position=[1.0] * 5, set_velocity=[0.0] * 5)
    for given, blocks, wanted in (
        (record("move_absolute", target=5.0), [], 5.0),
        (record("move_additive", distance=2.0), [], 7.0),
        (record("move_relative", distance=2.0), [("x", block)], 6.5),
        (record("move_relative", distance=2.0), [("x", standing)], 3.0),
        (record("move_relative", distance=2.0), [("x", moving)], None),
        (record("move_relative", distance=2.0), [("x", later)], None),
        (record("move_additive", distance=2.0), [("x", standing)], None),
        (record("new_target", target=1.0), [], 1.0),
        (record("set_override", percent=50), [], 1.0),
        (record("halt"), [], None),
    ):
        targets.take_record(given, blocks)
        assert targets.fields("x") == {"target": wanted}, given
    refused = CommandRecord(10, "x", "move_absolute", {"target": 9.0}, False, 1, "")
    targets.take_record(refused, [])
    assert targets.fields("x") == {"target": None} and targets.fields("plc") == {}


def test_the_state_has_targets_and_the_emergency_stop():
    async def story(here):
        page = await here.page()
        state = await page.wait_for("state", lambda state: "plc" in state["units"])
        assert state["units"]["plc"]["emergency_stop"] is False
        assert state["units"]["x"]["target"] is None
        assert (await page.command("x", "move_absolute", target=1.5))["ok"]
        await page.state_of("x", lambda x: x.get("target") == 1.5)
        assert (await page.command("plc", "emergency_stop", enabled=True))["ok"]
        await page.state_of("plc", lambda plc: plc.get("emergency_stop") is True)
        other = await here.page(commands=False)
        await other.state_of("plc", lambda plc: plc.get("emergency_stop") is True)

    run(story)


def test_the_command_is_taken_from_a_page_that_was_left(users):
    async def story(here):
        otto = await page_of(here, "otto")
        assert (await otto.ask("take_command"))["ok"]
        operator = await otto.ask("take_command", force=True)
        text = "take_command: otto is operator; it takes the role commissioner; nothing was done"
        assert (operator["number"], operator["text"]) == (26235, text)
        ended = []
        here.hub.right.holder.end_jogs = lambda: ended.append(True)
        cora = await page_of(here, "cora")
        assert not (await cora.ask("take_command"))["ok"]
        assert (await cora.ask("take_command", force=True))["ok"]
        told = await otto.wait_for("operator", lambda told: told["holder"]["user"] == "cora")
        assert told["asking"] is None and ended == [True]
        text = f"cora (page {told['holder']['page']}): take_command"
        assert await otto.wait_for("event", lambda event: event["text"] == text)

    run(story, users=users)


def test_a_program_is_replaced_by_whoever_commands(tmp_path):
    async def story(here):
        page = await here.page(commands=False)
        token = {"X-Token": await here.token()}
        path = "/api/programs?name=part.nc"
        assert (await here.client.post(path, data=b"M30\n", headers=token)).status == 200
        answer = await here.client.post(f"{path}&replace=1", data=b"G1\n", headers=token)
        text = "upload: 'part.nc' is replaced only by a page that holds the command; nothing was written"
        error = await answer.json()
        assert (answer.status, error["number"], error["text"]) == (403, 26236, text)
        assert (await page.ask("take_command"))["ok"]
        assert (await here.client.post(f"{path}&replace=1", data=b"G1\n", headers=token)).status == 200
        assert (tmp_path / "part.nc").read_text() == "G1\n"
        for text in ("web: program part.nc uploaded, 4 bytes", "web: program part.nc replaced, 3 bytes"):
            assert await page.wait_for("event", lambda event, text=text: event["text"] == text)
        listed = await (await here.client.get("/api/programs")).json()
        assert ".tap" in listed["endings"] and ".txt" not in listed["endings"]

    run(story, programs=str(tmp_path))


def test_too_many_uploads_at_once(tmp_path, monkeypatch):
    monkeypatch.setattr("cnc_ptp.web.programs.program_routes.MOST_UPLOADS", 0)

    async def story(here):
        token = {"X-Token": await here.token()}
        answer = await here.client.post("/api/programs?name=part.nc", data=b"M30\n", headers=token)
        text = "upload: 0 others are on their way; nothing was written"
        assert (answer.status, (await answer.json())["text"]) == (429, text)

    run(story, programs=str(tmp_path))


def test_too_many_pages_of_one_user(users, monkeypatch):
    monkeypatch.setattr("cnc_ptp.web.server.MOST_OF_USER", 1)

    async def story(here):
        await page_of(here, "vera")
        answer = await here.client.get("/ws")
        text = "the limit of open pages of vera is reached, 1; nothing was done; close one"
        error = await answer.json()
        assert (answer.status, error["number"], error["text"]) == (503, 26245, text)
        await page_of(here, "otto")

    run(story, users=users)


def test_a_snapshot_is_sent_piece_by_piece_and_alone(monkeypatch, users):
    may_end = asyncio.Event()

    async def snapshot(file, seconds, until):
        assert (seconds, until) == (2.5, 7.25)
        await may_end.wait()
        with open(file, "wb") as stream:
            stream.write(b"x" * 600_000)
        return 1230

    async def story(here):
        monkeypatch.setattr(here.hub.face, "snapshot", snapshot)
        await page_of(here, "vera")
        answer = await here.client.get("/api/snapshot.mcap")
        text = "snapshot: vera is viewer; it takes the role operator; nothing was done"
        assert (answer.status, (await answer.json())["text"]) == (403, text)
        await page_of(here, "otto")
        first = asyncio.create_task(here.client.get("/api/snapshot.mcap?seconds=2.5&until=7.25"))
        await asyncio.sleep(0.2)
        answer = await here.client.get("/api/snapshot.mcap")
        text = "snapshot: others are being made or sent; nothing was done; wait for them"
        assert (answer.status, (await answer.json())["text"]) == (429, text)
        may_end.set()
        answer = await first
        assert await answer.read() == b"x" * 600_000 and answer.headers["X-Frame-Options"] == "DENY"
        assert answer.headers["X-First-Cycle"] == "1230"

    run(story, users=users)


def test_a_snapshot_that_is_taken_slowly_keeps_nobody_from_another_one(monkeypatch):
    async def snapshot(file, seconds, until):
        with open(file, "wb") as stream:
            stream.truncate(int(seconds))
        return 0

    async def story(here):
        monkeypatch.setattr(here.hub.face, "snapshot", snapshot)
        await here.token()
        slow = await here.client.get(f"/api/snapshot.mcap?seconds={24 << 20}")  # and reads no more than its head
        other = await here.client.get("/api/snapshot.mcap?seconds=7")
        assert (other.status, await other.read()) == (200, bytes(7))
        slow.close()

    run(story)


def test_snapshots_that_nobody_takes_are_few_and_are_given_up(monkeypatch, tmp_path):
    monkeypatch.setattr("cnc_ptp.web.data_routes.MOST_SNAPSHOTS", 1)
    monkeypatch.setattr("cnc_ptp.web.data_routes.LONGEST_STALL", 0.5)
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))

    async def snapshot(file, seconds, until):
        with open(file, "wb") as stream:
            stream.truncate(int(seconds))
        return 0

    async def story(here):
        monkeypatch.setattr(here.hub.face, "snapshot", snapshot)
        await here.token()
        slow = await here.client.get(f"/api/snapshot.mcap?seconds={24 << 20}")  # and reads no more than its head
        assert [*tmp_path.glob("cnc_ptp-*")] != []
        answer = await here.client.get("/api/snapshot.mcap?seconds=7")
        text = "snapshot: others are being made or sent; nothing was done; wait for them"
        assert (answer.status, (await answer.json())["text"]) == (429, text)
        async with asyncio.timeout(10.0):
            while [*tmp_path.glob("cnc_ptp-*")]:
                await asyncio.sleep(0.05)
        answer = await here.client.get("/api/snapshot.mcap?seconds=7")
        assert (answer.status, await answer.read()) == (200, bytes(7))
        slow.close()

    run(story)


def test_at_the_end_of_the_server_all_jogs_end_before_any_farewell():
    async def story(here):
        for commands in (True, False):
            await here.page(commands=commands)
        order = []
        for session in here.hub.sessions:
            session.end_jogs = lambda: order.append("jogs")
            session.close = partial(noted, order, session.close)
        await here.hub.end()
        assert order[:4] == ["jogs", "jogs", "close", "close"]

    async def noted(order, close, **options):
        order.append("close")
        await close(**options)

    run(story)


def test_too_many_requests():
    async def story(here):
        await here.token()
        answers = [await here.client.get("/api/parameters", params={"unit": "x"}) for _ in range(3)]
        assert [answer.status for answer in answers] == [200, 200, 429]
        text = "too many requests in a short time; nothing was read; wait"
        assert (await answers[-1].json())["text"] == text

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("cnc_ptp.web.data_routes.Rate", lambda *_: SimpleNamespace(permits=iter((1, 1, 0)).__next__))
        run(story)


def test_a_task_before_its_process_is_there(tmp_path):
    """Two pages begin one at once; and one is cancelled before it has begun."""

    async def story():
        tasks, told = Tasks(None), []
        number, task = tasks.begin(["--help"], told.append)
        with pytest.raises(Exception, match="another task runs"):
            tasks.begin(["--help"], told.append)
        tasks.cancel(number)
        await task
        [result] = [message for message in told if message["type"] == "result"]
        assert result["text"] == f"task {number} was cancelled; nothing was found"
        _, task = tasks.begin(["--help"], told.append)
        await task

    asyncio.run(story())


def test_a_task_without_a_process(monkeypatch):
    async def no_process(*arguments, **options):
        raise OSError("no memory")

    async def story():
        tasks, told = Tasks(None), []
        monkeypatch.setattr("asyncio.create_subprocess_exec", no_process)
        number, task = tasks.begin(["identify"], told.append)
        await task
        assert told == [
            {
                **told[0],
                "type": "result",
                "ok": False,
                "output": "OSError('no memory')",
                "text": f"task {number} has ended with status 1; nothing was found",
            }
        ]

    asyncio.run(story())


def test_a_report_in_pieces():
    """A warning first, the report later, more than a pipe takes."""

    async def story():
        told = []
        script = (
            "import sys,time;print('warning',file=sys.stderr,flush=True);time.sleep(0.3);"
            "print('friction of x: 40 %',file=sys.stderr,flush=True);time.sleep(0.3);print('r'*300000)"
        )
        process = await asyncio.create_subprocess_exec(
            "python3", "-c", script, stdout=asyncio.subprocess.PIPE, stderr=asyncio.subprocess.STDOUT
        )
        text = await Tasks._read(1, process, told.append)
        await process.wait()
        assert text.startswith("warning\nrrr") and text.count("r") > 300_000
        assert told[0] == {"type": "progress", "task": 1, "text": "warning"}
        assert told[1] == {"type": "progress", "task": 1, "text": "friction of x: 40 %", "percent": 40}

    asyncio.run(story())
