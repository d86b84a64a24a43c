"""Pages of a recording."""

import asyncio
import os
import threading
from pathlib import Path

import numpy as np
import pytest
from recording_support import smooth_blocks
from web_support import MILL, site

from cnc_ptp.client import Machine
from cnc_ptp.commands.run.web import connector, print_address
from cnc_ptp.errors import CncError
from cnc_ptp.protocol.blocks import CommandRecord, Event
from cnc_ptp.recording.opened import OpenRecording
from cnc_ptp.recording.writer import Recording
from cnc_ptp.web.faces import recorded_file
from cnc_ptp.web.faces.program_watch import Load
from cnc_ptp.web.faces.recorded_face import recorded_face
from cnc_ptp.web.faces.recorded_file import RecordedFile
from cnc_ptp.web.faces.scope import HEAD, Signal
from cnc_ptp.wire.layout import Header, encode
from cnc_ptp.wire.schemas import parse_schema, schema_text

DIAGNOSTICS = "diagnostic_msgs/msg/DiagnosticArray"


@pytest.fixture(scope="module")
def recording(tmp_path_factory):
    file = tmp_path_factory.mktemp("recorded") / "run.mcap"
    with Machine.offline(MILL, record=file) as m:
        m.channel.load("part.nc", text="G1 X10 F600\nX20\nM30\n")
        m.channel.start().wait()
    return str(file)


@pytest.fixture(scope="module")
def failed(tmp_path_factory):
    """Two programs that fail, one after the other."""
    file = tmp_path_factory.mktemp("failed") / "run.mcap"
    with Machine.offline(MILL, record=file) as m:
        for target in (10, 20):
            job = m.channel.run("part.nc", text=f"N10 G1 X{target} F6000\nN20 G1 X=V.A.ACT_POS.X*100\nM30\n")
            with pytest.raises(CncError, match="line 2 "):
                job.wait()
            m.run_for(0.2)
            m.channel.reset().wait()
        m.run_for(0.2)
    return str(file)


def events_of(file):
    """Time in s, severity and text of all events, in the order of their cycles."""
    with OpenRecording(file) as opened:
        columns = opened.columns("/events", "cycle", "severity", "text")
        rows = zip(*(columns[name].tolist() for name in ("cycle", "severity", "text")), strict=True)
        return [(cycle * 1e-3, severity, text) for cycle, severity, text in sorted(rows, key=lambda row: row[0])]


def alarms_by(file, time):
    """Texts of the warnings and errors that had come by a time in s."""
    return [text for at, severity, text in events_of(file) if severity > 0 and at <= time + 1e-9]


def shown(past):
    """Number and text of each alarm."""
    return [(alarm["alarm"], alarm["text"]) for alarm in past["alarms"]]


def test_a_page_looks_at_any_time_and_plays(recording):
    async def story():
        async with site(connect=lambda: recorded_face(recording)) as here:
            page = await here.page(commands=False)
            machine = page.hello["machine"] or (await page.wait_for("hello"))["machine"]
            assert machine["recording"] and machine["end"] > 2.0
            assert (await page.ask("seek", time=1.5))["ok"]
            middle = await page.state_of("x", lambda x: 5.0 < x["set_position"] < 20.0)
            assert middle["state"] == "SynchronizedMotion"
            assert (await page.ask("play", speed=10))["ok"]
            await page.state_of("x", lambda x: x["set_position"] == 20.0)
            text = await (await here.client.get("/api/programs/part.nc")).text()
            assert text == "G1 X10 F600\nX20\nM30\n"

    asyncio.run(story())


def test_a_mistake_of_ours_is_told_without_a_machine(recording, monkeypatch, capsys):
    async def story():
        async with site(connect=lambda: recorded_face(recording)) as here:
            page = await here.page(commands=False)
            monkeypatch.setattr(here.hub, "_tell", lambda: 1 / 0)
            gone = await page.wait_for("gone")
            text = "the server has failed: ZeroDivisionError('division by zero'); the recording is opened again"
            assert (gone["number"], gone["text"]) == (26171, text)
            await page.wait_for("back")

    asyncio.run(story())
    assert "ZeroDivisionError" in capsys.readouterr().err


@pytest.mark.parametrize(("is_recording", "more"), [(True, ""), (False, "; the machine continues")])
def test_the_address_tells_what_continues(is_recording, more, capsys):
    print_address("http://localhost:8080", is_recording=is_recording)
    assert capsys.readouterr().out == f"pages: http://localhost:8080 (Ctrl-C ends them{more})\n"


def test_its_samples_and_its_parameters(recording):
    async def story():
        async with site(connect=lambda: recorded_face(recording)) as here:
            await here.page(commands=False)
            query = {"signals": "x.set_position,y.state", "from": "0", "to": "1", "points": "100"}
            data = await (await here.client.get("/api/recorded", params=query)).read()
            step, low, high, signals, samples = HEAD.unpack_from(data)
            assert (low, high, signals) == (0, 0, 2)
            assert len(data) == HEAD.size + signals * samples * 8 and samples <= 100 and step * samples >= 1000
            listed = await (await here.client.get("/api/parameters", params={"unit": "x"})).json()
            assert {"id", "name", "value", "min", "max", "change"} <= listed["parameters"][0].keys()

    asyncio.run(story())


def test_its_samples_are_not_rounded(recording):
    """As the recording has them, to the last bit; with 32 bits where a page draws only."""

    async def story():
        async with site(connect=lambda: recorded_face(recording)) as here:
            await here.page(commands=False)
            query = {"signals": "x.set_position", "from": "0.5", "to": "1", "points": "1000"}
            exact = await (await here.client.get("/api/recorded", params=query)).read()
            short = await (await here.client.get("/api/recorded", params={**query, "bits": "32"})).read()
            samples = np.frombuffer(exact, "<f8", offset=HEAD.size)
            with OpenRecording(recording) as opened:
                wanted = opened.columns("/x/state", "set_position", start=0.5, end=1.0)["set_position"]
            assert samples.tobytes() == wanted.tobytes() and len(samples) >= 500
            assert np.frombuffer(short, "<f4", offset=HEAD.size).tobytes() == wanted.astype("<f4").tobytes()
            assert (wanted != wanted.astype("<f4")).any()

    asyncio.run(story())


def frame_of(data):
    """Cycles between two samples, cycle of the first one, and the samples by signal."""
    step, low, high, signals, samples = HEAD.unpack_from(data)
    return step, low + (high << 32), np.frombuffer(data, "<f8", offset=HEAD.size).reshape(signals, samples)


def test_samples_are_of_every_cycle_as_far_as_is_asked(recording):
    """More than are asked for are thinned, and the frame says which cycles they are of."""

    async def story():
        async with site(connect=lambda: recorded_face(recording)) as here:
            await here.page(commands=False)

            async def read(**query):
                answer = await here.client.get("/api/recorded", params={"signals": "x.set_velocity,y.state", **query})
                return frame_of(await answer.read())

            with OpenRecording(recording) as opened:
                cycles, wanted = (
                    opened.columns("/x/state", name, start=0.1005)[name] for name in ("cycle", "set_velocity")
                )
            step, first, whole = await read(**{"from": "0.1005", "points": "100000"})
            assert (step, first, len(whole[0])) == (1, int(cycles[0]), len(cycles)) and first == 101
            assert whole[0].tobytes() == wanted.tobytes()
            step, first, some = await read(**{"from": "0.1005", "points": "700"})
            assert step == -(-len(cycles) // 700) > 1 and first == 101
            assert some.tobytes() == whole[:, ::step].tobytes()

    asyncio.run(story())


@pytest.mark.motion_unchecked("its blocks are those of no machine")
def test_what_no_unit_sends_is_left_out(tmp_path):
    """A state, a severity and a load that only somebody else can have published."""
    path = tmp_path / "run.mcap"
    blocks = [(name, block) for name, block in smooth_blocks(0.1) if name == "x"]
    blocks[3][1].state[:] = [99] * 10
    with Recording(path, Path(MILL).read_text()) as recording:
        for number in (0, 3):
            recording.event(Event(number, "x", number, 23001, "told"))
        for load in ("[]", '{"program": 5, "text": "M30"}', '{"program": "a.nc", "text": 5}'):
            recording.command(CommandRecord(0, "channel", "load", load, True, 0, ""))
        for name, block in blocks:
            recording.block(name, block)
    file = RecordedFile(str(path))
    assert [block.first_cycle for block in file.first.blocks["x"]] == [0, 10, 20, *range(40, 100, 10)]
    assert [event.severity for event in file.events] == [0] and file.programs == []
    file.close()


@pytest.mark.parametrize("fails", ["load_machine", "DecoderFactory"])
def test_a_recording_that_cannot_be_shown_is_not_kept_open(recording, monkeypatch, fails):
    """The server tries it again each second, and keeps the error, which keeps everything alive that it has met."""

    def fail(*_arguments):
        raise CncError(21001, "a fault in it", "nothing is shown")

    monkeypatch.setattr(recorded_file, fails, fail)
    before = sorted(os.listdir("/proc/self/fd"))
    with pytest.raises(CncError, match="a fault in it") as error:
        RecordedFile(recording)
    assert sorted(os.listdir("/proc/self/fd")) == before
    assert not [each for each in threading.enumerate() if each.name.startswith("columns")]
    assert error.value.number == 21001


def test_an_answer_has_a_limit(recording, monkeypatch):
    monkeypatch.setattr(recorded_file, "MOST_SAMPLES", 1000)
    file = RecordedFile(recording)
    signals = [Signal("x", "set_position"), Signal("y", "set_position")]
    step, first, some = frame_of(file.samples(signals, 0.0, 1.0, 10**9, bits=64))
    assert (step, first, some.shape) == (3, 0, (2, 334))
    file.close()


def test_a_cycle_that_a_unit_does_not_have_is_a_gap(recording, monkeypatch):
    """The samples of other units stay beside those of their own cycles."""
    file = RecordedFile(recording)
    read = file._recording.columns

    def without_some(topic, *names, **times):
        found = read(topic, *names, **times)
        kept = (found["cycle"] < 100) | (found["cycle"] >= 130) | (topic != "/x/state")
        return {name: found[name][kept] for name in names}

    signals = [Signal("x", "set_position"), Signal("y", "set_position"), Signal("x", "set_velocity")]
    whole = frame_of(file.samples(signals, 0.05, 0.2, 1000, bits=64))[2]
    monkeypatch.setattr(file._recording, "columns", without_some)
    step, first, samples = frame_of(file.samples(signals, 0.05, 0.2, 1000, bits=64))
    assert (step, first, samples.shape) == (1, 50, (3, 151))
    assert np.isnan(samples[0]).nonzero()[0].tolist() == [*range(50, 80)]
    assert samples[1].tobytes() == whole[1].tobytes()
    assert samples[2, 80:].tobytes() == whole[2, 80:].tobytes()
    file.close()


def test_a_page_has_the_alarms_of_its_time(failed):
    """Those up to it, each once and with the same number, wherever the page has looked before."""

    async def story():
        async with site(connect=lambda: recorded_face(failed)) as here:
            page = await here.page(commands=False)
            end = here.hub.face.end
            every, errors = events_of(failed), [at for at, severity, _ in events_of(failed) if severity == 2]
            whole = [*enumerate(alarms_by(failed, end), 1)]
            begin = await page.wait_for("past")
            assert shown(begin) == [*enumerate(alarms_by(failed, 0.0), 1)] and len(errors) >= 2

            assert (await page.ask("seek", time=end))["time"] == end
            past = await page.wait_for("past")
            assert shown(past) == whole
            assert [event["text"] for event in past["events"]] == [text for _, _, text in every]

            between = errors[-1] - 0.01
            assert (await page.ask("seek", time=between))["ok"]
            early = shown(await page.wait_for("past"))
            assert early == [*enumerate(alarms_by(failed, between), 1)] and 0 < len(early) < len(whole)

            assert (await page.ask("play", speed=20))["ok"]
            last = await page.wait_for("event", lambda event: event.get("alarm") == len(whole))
            told = [message for message in page.waiting if message["type"] == "event" and "alarm" in message]
            assert early + shown({"alarms": [*told, last]}) == whole

            assert (await page.ask("play", speed=0.0))["ok"]
            assert (await page.ask("seek", time=0.0))["ok"]
            assert shown(await page.wait_for("past")) == shown(begin)

    asyncio.run(story())


def test_an_alarm_stays_acknowledged_where_it_is_seen_again(failed):
    async def story():
        async with site(connect=lambda: recorded_face(failed)) as here:
            page = await here.page(commands=False)
            await page.wait_for("past")
            await page.ask("seek", time=here.hub.face.end)
            first, second = (await page.wait_for("past"))["alarms"][:2]
            assert (await page.ask("acknowledge", alarm=first["alarm"]))["ok"]
            for time in (0.0, here.hub.face.end):
                await page.ask("seek", time=time)
                past = await page.wait_for("past")
            again = past["alarms"][:2]
            assert again[0] == {**first, "acknowledged": True, "acknowledged_by": "web"}
            assert again[1] == second and not second["acknowledged"]

    asyncio.run(story())


def test_a_page_has_the_offsets_of_its_time(tmp_path):
    file = tmp_path / "run.mcap"
    with Machine.offline(MILL, record=file) as m:
        m.channel.set_zero_offset(2, "X", 12.5)
        m.run_for(0.2)
        m.channel.set_zero_offset(3, "Y", 4.0)  # never active
        m.channel.teach_zero_offset(4, value=-2.0)
        m.channel.load("part.nc", text="G55\nG1 X10 F600\nG54\nX10\nM30\n")  # 2.25 s, then 1.25 s
        m.channel.start().wait()

    async def story():
        async with site(connect=lambda: recorded_face(str(file))) as here:
            page = await here.page(commands=False)
            await page.wait_for("past")
            before = (await page.ask("offsets"))["offsets"]
            for time, index in ((1.0, 2), (here.hub.face.end - 0.5, 1), (1.5, 2)):
                await page.ask("seek", time=time)
                active = (await page.wait_for("past"))["offsets"]["channel"]
                assert (active["channel"], active["zero_index"]) == ("channel", index)
                assert active["zero_offset"][0] == (12.5 if index == 2 else 0.0)
                rows = {row["name"]: row["values"] for row in (await page.ask("offsets"))["offsets"]}
                assert rows["G55"]["X"] == 12.5 and rows["G56"]["Y"] == 4.0
                assert rows["G57"] == {"X": 2.0, "Y": 2.0, "Z": 2.0}
            await page.ask("seek", time=0.0)
            assert (await page.wait_for("past"))["offsets"].get("channel", {}).get("zero_index") != 2
            assert (await page.ask("offsets"))["offsets"] == before

    asyncio.run(story())


def report(name, blocks):
    """The bytes of a message of diagnostics."""
    values = [{"key": "blocks", "value": blocks}]
    status = {"level": 1, "name": name, "message": "late", "hardware_id": "", "values": values}
    schema = parse_schema(DIAGNOSTICS, schema_text(DIAGNOSTICS))
    return encode(schema, {"header": Header(), "status": [status]})


def test_a_page_has_the_figures_of_the_nodes_of_its_time(recording, tmp_path):
    file = tmp_path / "run.mcap"
    with OpenRecording(recording) as opened:
        machine = opened.attached("machine.yaml")
    with Recording(file, machine) as writing:
        for time, name, blocks in ((0.5, "x", "50"), (1.5, "x", "150"), (1.6, "y", "160"), (2.4, "x", "240")):
            writing.raw("/diagnostics", DIAGNOSTICS, report(name, blocks), round(time * 1e9))

    def figures(nodes):
        assert all((node["level"], node["text"]) == (1, "late") for node in nodes)
        return {node["name"]: node["values"] for node in nodes}

    async def story():
        face = recorded_face(str(file))
        assert figures(face.past().diagnostics) == {}
        await face.seek(2.0)
        assert figures(face.past().diagnostics) == {"x": {"blocks": "150"}, "y": {"blocks": "160"}}
        assert face.past() is None and face.news().diagnostics == ()
        face.play(1.0)
        await face._play_on(0.5)
        assert figures(face.news().diagnostics) == {"x": {"blocks": "240"}}
        face.close()

    asyncio.run(story())


def positions(page):
    """x of all states that have come and nobody has waited for."""
    states = [message["units"].get("x", {}) for message in page.waiting if message["type"] == "state"]
    return [state["set_position"] for state in states if "set_position" in state]


def test_each_page_has_its_own_time(recording):
    """What one plays, and where it looks, moves nothing on another."""

    async def story():
        async with site(connect=lambda: recorded_face(recording)) as here:
            playing, looking = await here.page(commands=False), await here.page(commands=False)
            begin = await playing.state_of("x", lambda x: True)
            assert begin["set_position"] == 0.0
            assert (await looking.ask("seek", time=1.5))["time"] == 1.5
            there = await looking.state_of("x", lambda x: 5.0 < x["set_position"] < 20.0)
            assert (await playing.ask("play", speed=20))["ok"]
            await playing.state_of("x", lambda x: x["set_position"] == 20.0)
            assert (await looking.ask("ping"))["ok"]
            assert set(positions(looking)) <= {there["set_position"]}
            assert (await looking.ask("seek", time=0.0))["time"] == 0.0
            await looking.state_of("x", lambda x: x["set_position"] == 0.0)
            assert (await playing.ask("ping"))["ok"]
            assert set(positions(playing)) <= {20.0}
            assert (await looking.ask("play", speed=0.0))["ok"]

    asyncio.run(story())


def test_each_page_has_the_program_of_its_time(tmp_path):
    file = tmp_path / "run.mcap"
    with Machine.offline(MILL, record=file) as m:
        for target in (10, 20):
            m.channel.load("part.nc", text=f"G1 X{target} F6000\nM30\n")
            m.channel.start().wait()

    async def furthest(here, **query):
        points = np.frombuffer(await (await here.client.get("/api/backplot", params=query)).read(), "<f4", offset=16)
        return points.reshape(-1, 5)[:, 0].max()

    async def story():
        async with site(connect=lambda: recorded_face(str(file))) as here:
            early, late = await here.page(commands=False), await here.page(commands=False)
            await early.ask("seek", time=0.05)
            await early.wait_for("program")
            await late.ask("seek", time=here.hub.face.end)
            await late.wait_for("program")
            drawn = [await furthest(here, page=page.hello["page"]) for page in (early, late)]
            assert drawn == [10.0, 20.0]
            assert await furthest(here) == 20.0
            text = await (await here.client.get(f"/api/programs/part.nc?page={early.hello['page']}")).text()
            assert text == "G1 X10 F6000\nM30\n"

    asyncio.run(story())


def test_the_end_of_a_recording_stays_until_it_is_played_again(recording):
    async def story():
        async with site(connect=lambda: recorded_face(recording)) as here:
            page = await here.page(commands=False)
            end = here.hub.face.end
            assert (await page.ask("seek", time=end + 1.0))["time"] == end
            assert (await page.ask("play", speed=0.0))["ok"]
            await page.state_of("x", lambda x: x["set_position"] == 20.0)
            assert (await page.ask("play", speed=1.0))["ok"]
            await page.state_of("x", lambda x: x["set_position"] < 10.0)

    asyncio.run(story())


def test_a_page_that_leaves_closes_no_file_of_another(recording):
    async def story():
        async with site(connect=lambda: recorded_face(recording)) as here:
            leaving, staying = await here.page(commands=False), await here.page(commands=False)
            await leaving.socket.close()
            while len(here.hub.sessions) > 1:
                await asyncio.sleep(0.01)
            assert (await staying.ask("seek", time=1.5))["ok"]
            await staying.state_of("x", lambda x: 5.0 < x["set_position"] < 20.0)

    asyncio.run(story())


def test_nothing_is_commanded(recording):
    async def story():
        async with site(connect=lambda: recorded_face(recording)) as here:
            page = await here.page()
            answer = await page.command("x", "halt")
            assert (answer["number"], answer["text"]) == (26248, "x: halt: this is a recording; nothing was done")

    asyncio.run(story())


def test_a_recording_without_a_text_reads_no_file(recording, tmp_path, monkeypatch):
    """The path of its program is one of another computer, or of today."""
    program = tmp_path / "part.nc"
    program.write_text("SECRET\n")

    def without_text(path):
        face = recorded_face(path)
        face.file.programs = [(cycle, unit, Load(str(program), None)) for cycle, unit, _ in face.file.programs]
        return face

    async def story():
        async with site(connect=lambda: without_text(recording), programs=str(tmp_path)) as here:
            page = await here.page(commands=False)
            await page.ask("seek", time=1.5)
            await page.state_of("channel", lambda channel: channel.get("program"))
            text = "program 'part.nc': the recording does not have its text; nothing was read"
            for path in ("/api/programs/part.nc", "/api/programs/part.nc?channel=channel", "/api/backplot"):
                answer = await here.client.get(path)
                assert (answer.status, (await answer.json())["text"]) == (404, text)

    asyncio.run(story())


def test_seeks_while_it_plays_read_one_after_the_other(recording):
    async def story():
        face = recorded_face(recording)
        running = asyncio.create_task(face.run())
        face.play(1.0)
        for _ in range(5):
            face.file._windows.clear()
            face._windows.clear()
            await asyncio.gather(*(face.seek(time) for time in (0.2, 1.4, 0.7)))
            assert 0.7 <= face.time < 1.4
            assert all(block.first_cycle * 1e-3 < 2.0 for block in face._windows[0].blocks["x"])
        running.cancel()
        face.close()

    asyncio.run(story())


def test_its_backplot_reads_only_what_it_has(tmp_path):
    file, called = tmp_path / "run.mcap", tmp_path / "sub.nc"
    called.write_text("G1 X77 F600\nM29\n")
    with Machine.offline(MILL, record=file) as m:
        m.channel.load(str(tmp_path / "part.nc"), text="L sub.nc\nM30\n")
        m.channel.start().wait()
    called.unlink()

    async def story():
        async with site(connect=lambda: recorded_face(str(file)), programs=str(tmp_path)) as here:
            page = await here.page(commands=False)
            await page.ask("seek", time=1.0)
            await page.wait_for("program")
            answer = await here.client.get("/api/backplot")
            points = np.frombuffer(await answer.read(), "<f4", offset=16).reshape(-1, 5)
            assert points[:, 0].max() == 77.0

    asyncio.run(story())


def test_another_connection_reads_it_again(recording):
    connect = connector(recording)
    first, second = connect(), connect()
    first.close()
    assert asyncio.run(second.seek(1.5)) is None
    second.close()


def test_no_snapshot_and_no_jog_of_a_recording(recording):
    async def story():
        async with site(connect=lambda: recorded_face(recording)) as here:
            page = await here.page()
            answer = await here.client.get("/api/snapshot.mcap")
            assert (await answer.json())["text"] == "snapshot: this is a recording; nothing was done"
            await page.send(type="jog", axis="x", velocity=1.0, sequence=1, time=0.0)
            assert (await page.wait_for("error"))["text"] == "x: jog: this is a recording; nothing was done"
            await page.socket.close()
            while here.hub.sessions:
                await asyncio.sleep(0.01)
            assert here.hub.right.holder is None

    asyncio.run(story())


def test_a_recording_that_was_cut_is_not_shown(recording, tmp_path):
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(Path(recording).read_bytes()[:-3000])
    with pytest.raises(CncError) as refused:
        recorded_face(str(cut))
    assert str(refused.value) == (
        f"P-ERR-26003 recording {cut}: the file was not closed; what was recorded after its last whole chunk is missing; "
        "nothing is shown, 'cnc_ptp recover' makes a file that can be shown"
    )
