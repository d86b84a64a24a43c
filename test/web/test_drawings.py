"""Backplots: what nobody wants any more ends, and holds up no other one."""

import asyncio
import signal
import subprocess
import sys

import numpy as np
import psutil
import pytest
from web_support import MILL, site

from cnc_ptp.errors import CncError
from cnc_ptp.web.faces.machine_face import offline_face
from cnc_ptp.web.faces.program_watch import Load
from cnc_ptp.web.programs.backplot import COLUMNS, HEAD, LOOK_EVERY, MOST_POINTS, Drawing, draw
from cnc_ptp.web.programs.drawing_office import KEPT, SLOTS, Cancelled, DrawingOffice

ENDLESS = "P1 = 0\n$WHILE P1 >= 0\nP1 = P1 + 1\nG01 X[P1/1000] F1000\nX0\n$ENDWHILE\nM30\n"
SHORT = "G01 X10 F1000\nX20\nM30\n"
CUT_OFF = 2
PATIENCE = 30.0


@pytest.fixture(scope="module")
def face():
    face = offline_face(MILL, stands=True)
    yield face
    face.close()


def drawing(face, text, file="part.nc", channel="channel"):
    return Drawing(channel, face.kinds, face.sets, face.cycle_time, text, file)


def test_a_drawing_that_is_no_longer_wanted_ends_with_the_next_look(face):
    looks = iter([True, True, False])
    drawn = draw(drawing(face, ENDLESS), is_wanted=lambda: next(looks))
    _, points, flags, _ = HEAD.unpack_from(drawn)
    assert flags == CUT_OFF
    assert LOOK_EVERY < points <= 2 * LOOK_EVERY + 1


def test_a_break_of_the_path_has_its_line(face):
    drawn = draw(drawing(face, "G01 X10 F1000\nG74 X1\nX20\nX30\nM30\n"))
    lines = np.frombuffer(drawn, dtype="<f4", offset=HEAD.size).reshape(-1, COLUMNS)
    assert [*lines[:, -1]] == [0, 1, 2, 3, 4]
    assert [*np.isnan(lines[:, 0])] == [False, False, True, False, False]


async def begun(office):
    """The process that draws is at work."""
    while not (office._orders and office._pool and office._pool._pending_work_items):
        await asyncio.sleep(0.01)


@pytest.mark.parametrize("waiting", [0, 2])
def test_a_newer_program_of_a_channel_ends_the_drawing_of_an_older_one(face, waiting):
    """`waiting`: further ones in between, which need not even begin."""

    async def story():
        office = DrawingOffice()
        texts = [ENDLESS, *(f"( {number} )\n{ENDLESS}" for number in range(waiting))]
        older = []
        for number, text in enumerate(texts):
            older.append(asyncio.create_task(office.draw(drawing(face, text, f"old{number}.nc"))))
            await begun(office)
        orders = [*office._orders.values()]
        assert len(orders) == 1
        newest = await asyncio.wait_for(office.draw(drawing(face, SHORT)), PATIENCE)
        assert HEAD.unpack_from(newest) == (1, 3, 0, 0)
        refusals = await asyncio.gather(*older, return_exceptions=True)
        for number, refused in enumerate(refusals):
            text = f"backplot of old{number}.nc: the channel has another program, or other offsets; nothing is shown"
            assert (refused.number, refused.message) == (26253, text)
        drawn = await orders[0].task
        assert drawn == b"" or HEAD.unpack_from(drawn)[1] < MOST_POINTS
        office.close()

    asyncio.run(story())


def test_programs_of_another_channel_or_of_a_recording_end_nothing(face):
    async def story():
        office = DrawingOffice()
        first = asyncio.create_task(office.draw(drawing(face, SHORT)))
        await begun(office)
        again = asyncio.create_task(office.draw(drawing(face, f"{SHORT}\n"), replaces=False))
        drawn = [HEAD.unpack_from(each)[1] for each in await asyncio.gather(first, again)]
        assert drawn == [3, 3]
        office.close()

    asyncio.run(story())


def test_the_same_drawing_is_made_once_and_few_are_kept(face):
    async def story():
        office = DrawingOffice()
        both = await asyncio.gather(*(office.draw(drawing(face, SHORT)) for _ in range(2)))
        assert both[0] is both[1]
        for number in range(KEPT + 1):
            await office.draw(drawing(face, f"{SHORT}( {number} )\n"))
        assert len(office._orders) == KEPT
        office.close()

    asyncio.run(story())


def test_numbers_of_cancelled_drawings():
    before = Cancelled.numbers
    try:
        numbers = [0] * SLOTS
        Cancelled.share(numbers)
        numbers[5 % SLOTS] = 5
        assert [Cancelled.has(number) for number in (4, 5, 6, 5 + SLOTS)] == [False, True, False, False]
    finally:
        Cancelled.share(before)


KILLED = """
import os, signal
from cnc_ptp.web.programs.drawing_office import DrawingOffice
print(DrawingOffice()._started().submit(os.getpid).result(), flush=True)
os.kill(os.getpid(), signal.SIGKILL)
"""


def test_the_process_that_draws_ends_with_a_server_that_is_killed():
    server = subprocess.run([sys.executable, "-c", KILLED], stdout=subprocess.PIPE, text=True, timeout=PATIENCE)
    assert server.returncode == -signal.SIGKILL
    number = int(server.stdout)  # it has come to its end: nobody holds its output any longer
    assert not psutil.pid_exists(number) or psutil.Process(number).status() == psutil.STATUS_ZOMBIE


def test_a_page_gets_the_drawing_of_its_newest_program():
    async def story():
        async with site() as here:
            await here.page(commands=False)
            here.hub.programs.take("channel", Load("old.nc", ENDLESS))
            old = asyncio.create_task(here.client.get("/api/backplot"))
            await begun(here.hub.office)
            here.hub.programs.take("channel", Load("new.nc", SHORT))
            new = await asyncio.wait_for(here.client.get("/api/backplot"), PATIENCE)
            assert HEAD.unpack_from(await new.read())[1] == 3
            error = await (await old).json()
            text = "backplot of old.nc: the channel has another program, or other offsets; nothing is shown"
            assert (error["number"], error["text"]) == (26253, text)

    asyncio.run(story())


def test_a_program_that_is_refused_is_told_with_its_reason(face):
    async def story():
        office = DrawingOffice()
        with pytest.raises(CncError) as refused:
            await office.draw(drawing(face, "G1 X1O F600\n"))
        assert refused.value.number == 26253
        assert refused.value.message.startswith("backplot of part.nc: ")
        assert refused.value.message.endswith("; nothing is shown")
        assert office._orders == {}
        office.close()

    asyncio.run(story())
