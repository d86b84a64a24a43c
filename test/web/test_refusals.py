"""What the server refuses besides: each text once."""

import asyncio
import os
import signal

import pytest
from web_support import MILL, site

from cnc_ptp.errors import CncError
from cnc_ptp.web.commissioning.tasks import Tasks
from cnc_ptp.web.faces.machine_face import offline_face
from cnc_ptp.web.faces.program_watch import Load
from cnc_ptp.web.options import require_packages
from cnc_ptp.web.programs.programs import ProgramFolder


def run(story, **options):
    async def told():
        async with site(**options) as here:
            await story(here)

    asyncio.run(told())


async def refused(page, kind, **fields):
    answer = await page.ask(kind, **fields)
    assert not answer["ok"]
    return answer["number"], answer["text"]


def test_packages_that_are_missing(monkeypatch):
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    with pytest.raises(CncError) as error:
        require_packages()
    end = "nothing was started, install with: pip install 'cnc_ptp[web]'"
    assert (error.value.number, error.value.message) == (26230, f"web: aiohttp and argon2 not installed; {end}")


def test_no_program_folder(tmp_path):
    with pytest.raises(CncError) as error:
        ProgramFolder(f"{tmp_path}/none")
    text = f"programs: there is no folder {tmp_path}/none; nothing was started"
    assert (error.value.number, error.value.message) == (26252, text)


def test_an_upload_in_place_of_a_link(tmp_path):
    (tmp_path / "link.nc").symlink_to("/etc/passwd")
    with pytest.raises(CncError) as error:
        ProgramFolder(str(tmp_path)).save("link.nc", b"M30\n", replace=True)
    text = "program 'link.nc' is a link or a folder; nothing was written"
    assert (error.value.number, error.value.message) == (26240, text)


def test_messages_with_wrong_values():
    async def story(here):
        page = await here.page()
        text = "acknowledge: there is no alarm 7; nothing was done"
        assert await refused(page, "acknowledge", alarm=7) == (26233, text)
        text = "identify: what = 'weight' is not friction or dynamics; nothing was done"
        assert await refused(page, "identify", axis="x", what="weight") == (26233, text)
        text = "circle: plane = 'AB' is not XY, ZX or YZ; nothing was done"
        assert await refused(page, "circle", radius=10, feed=1000, plane="AB") == (26233, text)
        text = "seek: this machine runs, it is no recording; nothing was done"
        assert await refused(page, "seek", time=1) == (26248, text)

    run(story)


def test_requests_with_wrong_values():
    async def story(here):
        token = {"X-Token": await here.token()}

        async def text_of(path, **query):
            answer = await here.client.get(path, params=query)
            error = await answer.json()
            return error["number"], error["text"]

        text = "recorded samples: this machine runs; nothing was done; use the scope"
        assert await text_of("/api/recorded", signals="x.set_position") == (26248, text)
        text = "channel channel has no program; nothing was read"
        assert await text_of("/api/backplot") == (26242, text)
        assert (await text_of("/api/backplot", channel="x"))[0] == 26111
        assert (await text_of("/api/parameters", unit="q"))[0] == 26111
        answer = await here.client.post("/api/login", json={"user": "a", "password": "b"}, headers=token)
        text = "this server has no users; nothing was done; load the page again"
        assert ((await answer.json())["number"], (await answer.json())["text"]) == (26238, text)

    run(story)


def test_many_uploads(tmp_path):
    async def story(here):
        token = {"X-Token": await here.token()}
        for number in range(40):
            answer = await here.client.post(f"/api/programs?name=p{number}.nc", data=b"M30\n", headers=token)
            if answer.status != 200:
                break
        text = "upload: too many programs in a short time; nothing was written; wait"
        assert (answer.status, (await answer.json())["number"], (await answer.json())["text"]) == (429, 26234, text)

    run(story, programs=str(tmp_path))


def test_no_machine_yet():
    def connect():
        if not may_come:
            asyncio.run(asyncio.sleep(0.2))
        return offline_face(MILL)

    may_come = []

    async def story(here):
        page = await here.page(commands=False)
        why = page.hello["why"]
        text = "no machine is found; the page is filled as soon as there is one"
        assert (why["number"], why["text"]) == (26244, text)

    run(story, connect=connect, waits=False)


def test_a_mistake_of_ours_is_told(monkeypatch, capsys):
    async def story(here):
        page = await here.page()
        monkeypatch.setattr(here.hub.face, "state", lambda: 1 / 0)
        gone = await page.wait_for("gone")
        text = "the server has failed: ZeroDivisionError('division by zero'); the machine continues"
        assert (gone["number"], gone["text"]) == (26171, text)
        assert await page.wait_for("back")

    run(story)
    assert "ZeroDivisionError" in capsys.readouterr().err


def test_a_program_that_cannot_be_drawn():
    async def story(here):
        page = await here.page()
        assert (await page.ask("load", name="part.nc", text="G1 X10 F600\nM30\n"))["ok"]
        await page.wait_for("program")
        path = here.hub.programs.loaded["channel"].path
        here.hub.programs.take("channel", Load(path, "G1 X1O F600\n"))
        answer = await here.client.get("/api/backplot")
        error = await answer.json()
        assert error["number"] == 26253
        assert error["text"].startswith("backplot of ") and error["text"].endswith("; nothing is shown")
        here.hub.programs.take("channel", Load(path, "G1 X10 F600\nM30\n"))
        [drawing] = here.hub.office._pool._processes
        os.kill(drawing, signal.SIGKILL)
        answer = await here.client.get("/api/backplot")
        text = f"backplot of {path}: the process that draws has ended; ask again"
        error = await answer.json()
        assert (error["number"], error["text"]) == (26253, text)
        assert (await here.client.get("/api/backplot")).status == 200

    run(story)


@pytest.mark.long
def test_tasks_that_are_not_possible(tmp_path):
    with pytest.raises(CncError) as error:
        Tasks(None).identify({"type": "identify", "axis": "x", "what": "friction"}, ["x"])
    text = "the server does not know the machine file; nothing was done; start it with --machine FILE"
    assert (error.value.number, error.value.message) == (26256, text)

    async def story(here):
        page = await here.page()
        task = (await page.ask("circle", radius=1e9, feed=1000))["task"]
        text = "another task runs; nothing was done; wait for its end, or cancel it"
        await page.wait_for("progress")
        assert await refused(page, "identify", axis="x", what="friction") == (26256, text)
        result = await page.wait_for("result")
        text = f"task {task} has ended with status 2; nothing was found"
        assert (result["ok"], result["number"], result["text"]) == (False, 26256, text)
        assert "radius" in result["output"]
        assert await refused(page, "cancel_task", task=task) == (26256, f"task {task} does not run; nothing was done")
        text = f"task {task} has no result; nothing was done"
        assert await refused(page, "accept", task=task, file="a.yaml") == (26256, text)

    run(story)


def test_a_snapshot_without_recorder():
    async def story(here):
        await here.token()
        answer = await (await here.client.get("/api/snapshot.mcap")).json()
        text = "snapshot: there is no recorder; nothing was written; run with --keep SECONDS"
        assert (answer["number"], answer["text"]) == (26258, text)

    run(story)
