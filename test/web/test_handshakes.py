"""Functions of programs that wait for a person: to the pages, and the acknowledgement back to the program."""

import asyncio

import pytest
from web_support import site, waiting_mill

from cnc_ptp.protocol.blocks import ChannelBlock, CommandRecord, HandshakeRequest
from cnc_ptp.web.faces.handshakes import Handshakes

X_MOVES = "N20 G1 X2 F6000\nN30 M30\n"
FUNCTIONS = {
    "M": ("N10 M6\n", [("M", 6, 0.0, "")]),
    "M of a spindle": ("N10 M3 S500\n", [("M", 3, 500.0, "s")]),
    "S": ("N10 M3 S500\nN15 S800\n", [("M", 3, 500.0, "s"), ("S", 0, 800.0, "s")]),
    "H": ("N10 H12\n", [("H", 12, 0.0, "")]),
}
"""What a program says, and what pages are told of it: kind, number, value, spindle; a direction has M19 alone."""


@pytest.fixture
def machine(tmp_path):
    return waiting_mill(tmp_path)


def run(story, machine):
    async def told():
        async with site(machine) as here:
            await asyncio.wait_for(story(here), 120.0)

    asyncio.run(told())


async def begin(page, text):
    """A program runs, and a person acknowledges."""
    assert (await page.command("plc", "auto_acknowledge", enabled=False))["ok"]
    assert (await page.ask("scope", signals=["x.set_position"], bits=64))["ok"]
    assert (await page.ask("load", name="part.nc", text=text))["ok"]
    started = await page.command("channel", "start")
    assert started["ok"], started


async def next_block(here):
    """The PLC has seen the last block then: it knows what has been withdrawn."""
    time = here.hub.face.time
    while here.hub.face.time == time:
        await asyncio.sleep(0.002)


async def first_motion(page):
    """The first cycle in which x is not where it was; all cycles before it have come."""
    before = None
    while True:
        first, values = await page.frame(64)
        assert before is None or first == before
        before = first + values.shape[1]
        moved = values[0].nonzero()[0]
        if len(moved):
            return first + int(moved[0])


@pytest.mark.parametrize("name", FUNCTIONS)
def test_a_function_appears_and_its_acknowledgement_releases_the_program(machine, name):
    functions, wanted = FUNCTIONS[name]

    async def story(here):
        page, other = await here.page(), await here.page(commands=False)
        await begin(page, functions + X_MOVES)
        for kind, number, value, spindle in wanted:
            request = await page.wait_for("handshake")
            assert request == {
                "type": "handshake", "cycle": request["cycle"], "id": request["id"], "channel": "channel", "kind": kind,
                "spindle": spindle, "number": number, "value": value, "line": request["line"],
                "acknowledge_needed": True, "position": 0.0, "direction": "",
                "synchronisation": request["synchronisation"],
            }  # fmt: skip
            assert await other.wait_for("handshake") == request
            answer = await page.command("plc", "acknowledge", id=request["id"])
            assert answer["ok"] and answer["cycle"] > request["cycle"]
            for each in (page, other):
                assert await each.wait_for("handshake_done") == {"type": "handshake_done", "id": request["id"]}
        assert await first_motion(page) > answer["cycle"]
        await page.state_of("x", lambda x: x["set_position"] == 2.0)
        newcomer = await here.page(commands=False)
        assert newcomer.hello["handshakes"] == []

    run(story, machine)


def test_a_tool_is_told_and_waits_for_nobody(machine):
    """T and D go to the PLC and are never waited for (MOS)."""

    async def story(here):
        page = await here.page()
        await begin(page, "N10 T2\n" + X_MOVES)
        await page.state_of("channel", lambda channel: channel.get("tool") == 2)
        await page.state_of("x", lambda x: x["set_position"] == 2.0)
        assert [message for message in page.waiting if message["type"] == "handshake"] == []

    run(story, machine)


@pytest.mark.parametrize("name", FUNCTIONS)
def test_a_reset_withdraws_what_waits(machine, name):
    functions, wanted = FUNCTIONS[name]

    async def story(here):
        page = await here.page()
        await begin(page, functions + X_MOVES)
        for number in range(len(wanted)):
            request = await page.wait_for("handshake")
            if number < len(wanted) - 1:
                assert (await page.command("plc", "acknowledge", id=request["id"]))["ok"]
                await page.wait_for("handshake_done")
        newcomer = await here.page(commands=False)
        told = {field: value for field, value in request.items() if field != "type"}
        assert newcomer.hello["handshakes"] == [told]
        assert (await page.command("channel", "reset"))["ok"]
        done = {"type": "handshake_done", "id": request["id"]}
        assert await page.wait_for("handshake_done") == await newcomer.wait_for("handshake_done") == done
        await next_block(here)
        refused = await page.command("plc", "acknowledge", id=request["id"])
        text = f"plc plc: acknowledge refused: no request {request['id']} waits; nothing was changed. Waiting: none"
        assert (refused["number"], refused["text"]) == (22013, text)
        while here.hub.face.state()["channel"]["active"]:
            await asyncio.sleep(0.01)
        assert here.hub.face.state()["x"]["set_position"] == 0.0
        later = await here.page(commands=False)
        assert later.hello["handshakes"] == []

    run(story, machine)


def test_only_the_page_with_the_command_acknowledges_and_only_once(machine):
    async def story(here):
        page, other = await here.page(), await here.page(commands=False)
        await begin(page, "N10 M6\n" + X_MOVES)
        request = await page.wait_for("handshake")
        refused = await other.command("plc", "acknowledge", id=request["id"])
        holder = f"web (page {page.hello['page']})"
        text = f"plc plc: acknowledge: this page does not hold the command, {holder} holds it; nothing was done"
        assert (refused["number"], refused["text"]) == (26236, text)
        wrong = request["id"] + 1000
        refused = await page.command("plc", "acknowledge", id=wrong)
        end = f"no request {wrong} waits; nothing was changed. Waiting: {request['id']}"
        assert (refused["number"], refused["text"]) == (22013, f"plc plc: acknowledge refused: {end}")
        assert (await page.command("plc", "acknowledge", id=request["id"]))["ok"]
        refused = await page.command("plc", "acknowledge", id=request["id"])
        assert refused["number"] == 22013

    run(story, machine)


def test_what_another_client_acknowledges_leaves_the_pages_too(machine):
    async def story(here):
        page = await here.page()
        await begin(page, "N10 M6\n" + X_MOVES)
        request = await page.wait_for("handshake")
        here.hub.face._machine.plc.acknowledge(request["id"])
        assert await page.wait_for("handshake_done") == {"type": "handshake_done", "id": request["id"]}
        await page.state_of("x", lambda x: x["set_position"] == 2.0)

    run(story, machine)


def m6(cycle, number):
    return HandshakeRequest(cycle, number, "channel", "M", "", 6, 0.0, 1, True)


def accepted(cycle, target, command, **arguments):
    return CommandRecord(cycle, target, command, arguments, True, 0, "")


def test_a_program_that_has_ended_waits_for_nothing():
    handshakes = Handshakes(["channel"])
    assert handshakes.take_request(m6(500, 7))
    assert handshakes.take_block("channel", ChannelBlock(500, 20, done=True)) == []  # from before it
    assert handshakes.take_block("channel", ChannelBlock(520, 20, done=False)) == []
    assert [*handshakes.waiting] == [7]
    assert handshakes.take_block("channel", ChannelBlock(540, 20, done=True)) == [7]
    assert handshakes.waiting == {}


def test_what_waits_is_known_in_whatever_order_a_server_that_begins_late_is_told():
    """7 was acknowledged, 8 withdrawn by a reset; the programs after it wait for 9."""
    told = [m6(500, 7), m6(600, 8), m6(900, 9)]
    told += [accepted(520, "plc", "acknowledge", id=7), accepted(700, "channel", "reset"), accepted(800, "x", "reset")]
    told.append(CommandRecord(950, "plc", "acknowledge", {"id": 9}, False, 22013, "refused"))
    told.append(accepted(960, "plc", "acknowledge", id=[9]))  # of somebody else
    for order in orders(told):
        handshakes = Handshakes(["channel"])
        for each in order:
            take = handshakes.take_request if isinstance(each, HandshakeRequest) else handshakes.take_record
            take(each)
        assert [*handshakes.waiting] == [9]


def orders(told):
    """As they are, backwards, and each of them first."""
    return [told, told[::-1], *([told[place], *told[:place], *told[place + 1 :]] for place in range(len(told)))]
