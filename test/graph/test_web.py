"""The web face with a graph: `run --web`, the server killed in a jog, the graph that ends before its pages."""

import asyncio
import signal
import ssl
import subprocess
import time

import psutil
import pytest
import trustme
from aiohttp import ClientSession, CookieJar
from aiohttp.test_utils import unused_port
from graph_support import Running, command, small_machine, verified
from web_support import Page

from cnc_ptp.client import Machine
from cnc_ptp.errors import CncError
from cnc_ptp.recording.reader import read_recording


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("web")


@pytest.fixture(scope="module")
def machine(folder):
    return small_machine(folder)


async def open_page(session, port):
    """A page that has its machine and holds the command."""
    address = f"http://127.0.0.1:{port}"
    await session.get(address)
    token = (await (await session.get(f"{address}/api/session")).json())["token"]
    page = Page(await session.ws_connect(f"{address}/ws"))
    await page.send(type="hello", token=token)
    page.hello = await page.wait_for("hello", lambda hello: hello["machine"])
    assert (await page.ask("take_command"))["ok"]
    return page


async def press(page, seconds, velocity=5):
    """A key that is held; what comes meanwhile is kept. As JSON of a browser the velocity has no fraction."""
    begin, sequence = time.monotonic(), 0
    while time.monotonic() - begin < seconds:
        sequence += 1
        await page.send(type="jog", axis="x", velocity=velocity, sequence=sequence, time=time.monotonic() * 1e3)
        await asyncio.sleep(0.05)


def server_of(run):
    """The process of the pages."""
    return next(child for child in psutil.Process(run.process.pid).children() if "--listening" in child.cmdline())


def test_a_machine_is_operated_and_its_server_killed(ros_domain, machine, folder):
    port = unused_port()
    recording = folder / "run.mcap"

    async def story(run):
        async with ClientSession(cookie_jar=CookieJar(unsafe=True)) as session:
            page = await open_page(session, port)
            assert (await page.ask("scope", signals=["x.set_position", "y.set_position"]))["ok"]
            answer = await page.command("x", "move_absolute", target=3)
            assert answer["ok"], answer
            await page.state_of("x", lambda x: x.get("set_position") == 3.0)
            frames = [await page.frame() for _ in range(5)]
            cycles = [cycle for first, values in frames for cycle in range(first, first + values.shape[1])]
            assert cycles == [*range(cycles[0], cycles[0] + len(cycles))]
            refused = await page.command("x", "move_absolute", target=1e6)
            assert refused["number"] and refused["remedy"]
            held = asyncio.create_task(press(page, 10.0))
            await page.state_of("x", lambda x: x.get("set_velocity") == 5.0)
            server_of(run).send_signal(signal.SIGKILL)
            with pytest.raises((ConnectionError, AssertionError)):
                await held
                await page.next()
            await asyncio.sleep(1.5)

    with Running(machine, "--composed", "--web", str(port), "--stay", "--record", str(recording)) as run:
        wait_for_server(run)
        asyncio.run(story(run))
        run.process.send_signal(signal.SIGINT)
        output = run.finish(0)
    assert (
        "warning: P-WARN-26211 web: the process of the pages has ended (status -9); the machine continues, "
        "`cnc_ptp web` serves pages of it again\n"
    ) in output
    verified(recording)
    recorded = read_recording(recording)
    told = [event.text for event in recorded.events if event.source == "web"]
    assert told[:2] == ["web (page 1): take_command", "web: axis x: move_absolute, carried out"]
    assert told[2].startswith("web: axis x: move_absolute, refused with P-ERR-")
    assert told[3:] == ["web: axis x: jog with 5 begins"]
    assert [event.error_id for event in recorded.events if event.source == "plc" and event.error_id] == [26134]
    assert recorded.states["/x/state"]["set_velocity"][-1] == 0.0


def test_a_program_waits_for_a_page_and_a_page_takes_a_snapshot(ros_domain, machine, folder):
    """M6 to the page and its acknowledgement back over the graph; a reset; then the last seconds as a recording."""
    port = unused_port()
    recording, snapshot, earlier = (folder / f"{name}.mcap" for name in ("waits", "snapshot", "earlier"))
    program = "N10 M6\nN20 G1 X2 F6000\nN30 M6\nN40 G1 X4\nM30\n"

    async def story():
        async with ClientSession(cookie_jar=CookieJar(unsafe=True)) as session:
            page = await open_page(session, port)
            assert (await page.command("plc", "auto_acknowledge", enabled=False))["ok"]
            assert (await page.ask("load", name="part.nc", text=program))["ok"]
            assert (await page.command("channel", "start"))["ok"]
            first = await page.wait_for("handshake")
            assert (first["kind"], first["number"], first["line"], first["acknowledge_needed"]) == ("M", 6, 1, True)
            answer = await page.command("plc", "acknowledge", id=first["id"])
            assert answer["ok"] and answer["cycle"] > first["cycle"]
            assert (await page.wait_for("handshake_done"))["id"] == first["id"]
            second = await page.wait_for("handshake")
            assert second["id"] != first["id"] and second["line"] == 3
            assert (await page.command("channel", "reset"))["ok"]
            assert (await page.wait_for("handshake_done"))["id"] == second["id"]
            refused = await page.command("plc", "acknowledge", id=second["id"])
            assert refused["number"] == 22013
            reply = await session.get(f"http://127.0.0.1:{port}/api/snapshot.mcap?seconds=1")
            assert reply.status == 200, await reply.text()
            snapshot.write_bytes(await reply.read())
            until = answer["cycle"] * 1e-3
            before = await session.get(f"http://127.0.0.1:{port}/api/snapshot.mcap?seconds=0.1&until={until}")
            assert before.status == 200, await before.text()
            earlier.write_bytes(await before.read())
            return first["cycle"], answer["cycle"], int(reply.headers["X-First-Cycle"])

    with Running(machine, "--composed", "--web", str(port), "--stay", "--keep", "5", "--record", str(recording)) as run:
        wait_for_server(run)
        asked, acknowledged, begin = asyncio.run(story())
        run.process.send_signal(signal.SIGINT)
        run.finish(0)
    verified(recording)
    states = read_recording(recording).states["/x/state"]
    moved = states["cycle"][states["set_position"] != 0.0]
    assert asked < acknowledged < moved[0]
    assert states["set_position"][-1] == 2.0
    taken = verified(snapshot).states["/x/state"]
    assert set(taken["set_position"]) <= set(states["set_position"]) and len(taken) >= 1000
    assert taken["cycle"][0] == begin
    assert verified(earlier).states["/x/state"]["cycle"][-1] == acknowledged - 1


def test_a_run_is_killed_and_its_server_ends(ros_domain, machine):
    with Running(machine, "--composed", "--web", str(unused_port()), "--stay") as run:
        wait_for_server(run)
        server = server_of(run)
        run.process.kill()
        server.wait(30)


def test_pages_that_are_older_than_the_graph_and_outlive_it(ros_domain, machine):
    """`cnc_ptp web` alone: a page without a machine, one that comes, its end, and the next one."""
    port = unused_port()
    server = subprocess.Popen(command("web", "--port", port), stdout=subprocess.PIPE, text=True)

    async def operate(page):
        await page.wait_for("back")
        hello = await page.wait_for("hello", lambda hello: hello["machine"])
        assert [unit["name"] for unit in hello["machine"]["units"] if unit["kind"] == "axis"] == ["x", "y"]
        assert (await page.ask("take_command"))["ok"]
        answer = await page.command("x", "move_absolute", target=2)
        assert answer["ok"], answer
        await page.state_of("x", lambda x: x.get("set_position") == 2.0)

    async def end(page, run):
        run.process.send_signal(signal.SIGINT)
        gone = await page.wait_for("gone")
        assert gone["number"] == 26171 and gone["text"].startswith("the machine has ended"), gone
        refused = await page.command("x", "move_absolute", target=1)
        assert not refused["ok"] and refused["number"] == 26171, refused
        assert await asyncio.to_thread(run.process.wait, 30) == 0

    async def story():
        async with ClientSession(cookie_jar=CookieJar(unsafe=True)) as session:
            address = f"http://127.0.0.1:{port}"
            await session.get(address)
            token = (await (await session.get(f"{address}/api/session")).json())["token"]
            page = Page(await session.ws_connect(f"{address}/ws"))
            await page.send(type="hello", token=token)
            hello = await page.wait_for("hello")
            assert hello["machine"] is None and hello["why"]["number"] in (26135, 26244), hello
            refused = await page.command("x", "move_absolute", target=1)
            assert not refused["ok"] and refused["number"] == 26244, refused
            for _ in range(2):
                with Running(machine, "--stay") as run:
                    await operate(page)
                    await end(page, run)

    try:
        assert f"http://localhost:{port}" in server.stdout.readline()
        asyncio.run(story())
        server.send_signal(signal.SIGTERM)
        assert server.wait(15) == 0
    finally:
        server.kill()


PALLETS = """    pzv_grp: {"1": {achse: {"0": {versatz: 15000}}}}
    spdl_anzahl: 1
"""
"""Clamp position 1: X 1.5 mm."""


def test_a_server_that_begins_late_knows_what_was_before(ros_domain, machine, folder):
    """Alarms, offsets, the tool, and the function that waits; so a taught offset is known, and the program goes on.

    The next server, once it was killed, knows who has acknowledged the alarm.
    """
    pallets = folder / "pallets.yaml"
    pallets.write_text(machine.read_text().replace("    spdl_anzahl: 1\n", PALLETS))

    def before():
        with Machine.connect(timeout=30.0) as m:
            with pytest.raises(CncError):
                m.x.move_absolute(1e6)
            m.channel.set_clamp_position(1)
            m.channel.set_zero_offset(2, "X", 4)
            m.plc.auto_acknowledge(False)
            m.channel.load("part.nc", text="N10 T2\nN20 M6\nN30 G1 X2 F6000\nM30\n")
            m.channel.start()
            m.run_for(2.0)  # what has come then is behind the last blocks that are kept

    async def story(port):
        async with ClientSession(cookie_jar=CookieJar(unsafe=True)) as session:
            page = await open_page(session, port)
            await page.state_of("channel", lambda channel: channel.get("tool") == 2)
            offsets = page.hello["offsets"].get("channel", {})
            if offsets.get("clamp_index") != 1:
                offsets = await page.wait_for("offsets", lambda offsets: offsets["clamp_index"] == 1)
            assert offsets["clamp_offset"][0] == 1.5
            [alarm] = page.hello["alarms"] or [await page.wait_for("event", lambda event: event.get("alarm"))]
            assert (alarm["source"], alarm["acknowledged"]) == ("x", False)
            assert (await page.ask("acknowledge", alarm=alarm["alarm"]))["ok"]
            [waiting] = page.hello["handshakes"] or [await page.wait_for("handshake")]
            assert (waiting["kind"], waiting["number"], waiting["line"]) == ("M", 6, 2)
            assert (await page.command("plc", "acknowledge", id=waiting["id"]))["ok"]
            await page.state_of("channel", lambda channel: channel.get("active") is False)  # x is at 3.5
            assert (await page.command("channel", "teach_zero_offset", index=3, axis="X"))["ok"]
            told = await page.wait_for("zero_offsets", lambda told: any(row["index"] == 3 for row in told["offsets"]))
            assert {row["name"]: row["values"]["X"] for row in told["offsets"]}.items() >= {
                "G55": 4.0,
                "G56": 2.0,
            }.items()
            servers[0].kill()
            servers[0].wait()
            assert await acknowledged_by(session, start()) == "web"

    async def acknowledged_by(session, port):
        page = await open_page(session, port)
        [alarm] = page.hello["alarms"] or [await page.wait_for("event", lambda event: event.get("alarm"))]
        return alarm["acknowledged_by"] or (await page.wait_for("acknowledged"))["user"]

    def start():
        port = unused_port()
        server = subprocess.Popen(command("web", "--port", port), stdout=subprocess.PIPE, text=True)
        servers.append(server)
        assert f"http://localhost:{port}" in server.stdout.readline()
        return port

    servers = []
    try:
        with Running(pallets, "--composed", "--stay"):
            before()
            asyncio.run(asyncio.wait_for(story(start()), 60.0))
    finally:
        for server in servers:
            server.kill()


def test_pages_of_a_run_with_tls_on_another_address(ros_domain, machine, folder):
    """127.0.0.2 is an address of its own; who may log in does not matter there."""
    authority, port = trustme.CA(), unused_port()
    certificate, key = folder / "cert.pem", folder / "key.pem"
    made = authority.issue_cert("127.0.0.2")
    certificate.write_bytes(b"".join(blob.bytes() for blob in made.cert_chain_pems))
    key.write_bytes(made.private_key_pem.bytes())
    trusted = ssl.create_default_context()
    authority.configure_trust(trusted)

    async def status():
        async with ClientSession(cookie_jar=CookieJar(unsafe=True)) as session:
            return (await session.get(f"https://127.0.0.2:{port}", ssl=trusted)).status

    words = ("--web-host", "127.0.0.2", "--web-tls-cert", str(certificate), "--web-tls-key", str(key))
    with Running(machine, "--composed", "--web", str(port), *words, "--stay") as run:
        wait_for_server(run, f"pages: https://127.0.0.2:{port} ")
        assert asyncio.run(status()) == 200


def wait_for_server(run, told="pages: "):
    """It has told its address."""
    for line in run.process.stdout:
        if line.startswith(told):
            return
    raise AssertionError("no server")
