"""MCAP files of other programs: which commands refuse them, with which text (the table of docs/recordings.md)."""

from types import SimpleNamespace

import pytest
from commands_support import MILL, call, served
from mcap.writer import Writer
from recording_support import foreign_file, smooth_run

from cnc_ptp.commands.look.report import program_of
from cnc_ptp.parameters import read_machine
from cnc_ptp.plots.program_run import known_blocks
from cnc_ptp.protocol.blocks import CommandRecord

NOT_OURS = "P-ERR-26017 recording {foreign}: is not of cnc_ptp; nothing was drawn; `cnc_ptp export` reads its topics"
NOT_COMPARED = NOT_OURS.replace("drawn", "compared")
NO_MACHINE = "P-ERR-26011 recording {foreign}: holds no attachment 'machine.yaml'; nothing was read"
NOT_COMPUTED = (
    "P-ERR-26155 recording {foreign}: holds no attachment machine.yaml; nothing was computed, record it with cnc_ptp"
)


@pytest.mark.parametrize(
    ("words", "text"),
    [
        ("report {foreign} -o {new}.html", NOT_OURS),
        ("report {own} --compare {foreign} -o {new}.html", NOT_OURS),
        (
            "plot {foreign} x/set_velocity -o {new}.svg",
            "P-ERR-26011 recording {foreign}: holds no unit 'x' with states; there are none; nothing was drawn",
        ),
        ("diff {foreign} {own} -o {new}.html", NOT_COMPARED),
        ("diff {own} {foreign}", NOT_COMPARED),
        (
            "replay {foreign}",
            "P-ERR-26004 recording {foreign}: holds no attachment machine.yaml; it cannot be verified, record it with "
            "cnc_ptp",
        ),
        ("replay {foreign} --from 1 -o {new}.mcap", NOT_COMPUTED),
        ("replay {foreign} --checkpoints 1", NOT_COMPUTED),
        (
            "identify friction x --recording {foreign} -o {new}.yaml",
            "P-ERR-27040 recording {foreign} holds no machine file; nothing was made, give --machine",
        ),
        (
            "identify dynamics x --recording {foreign} --machine {machine} -o {new}.yaml",
            "P-ERR-27002 recording {foreign} holds no states of axis x; nothing was made. Axes in it: none",
        ),
    ],
)
def test_refused(words, text, tmp_path):
    own, foreign = tmp_path / "own.mcap", foreign_file(tmp_path / "foreign.mcap")
    smooth_run(own, 0.1)
    before = sorted(tmp_path.iterdir())
    names = {"own": own, "foreign": foreign, "machine": MILL, "new": tmp_path / "new"}
    result = call(*(word.format(**names) for word in words.split()))
    assert (result.exit_code, " ".join(result.stderr.split())) == (2, text.format(**names))
    assert sorted(tmp_path.iterdir()) == before


def test_not_served_to_browsers(tmp_path):
    foreign = foreign_file(tmp_path / "foreign.mcap")
    result = served(foreign)
    assert (result.returncode, result.stderr) == (2, NO_MACHINE.format(foreign=foreign) + "\n")


def test_taken(tmp_path):
    foreign = foreign_file(tmp_path / "foreign.mcap")
    table, saved = tmp_path / "point.csv", tmp_path / "saved.mcap"
    assert call("export", foreign, "--topic", "/point", "-o", table).exit_code == 0
    assert table.read_text().splitlines()[:2] == ["time,x,y,z", "0.0,0.0,1.0,0.0"]
    assert call("recover", foreign, "-o", saved).output == f"{saved}: 20 messages, 0 s to 1.9 s\n"


def test_no_message_of_ros(tmp_path):
    foreign, saved = tmp_path / "foreign.mcap", tmp_path / "saved.mcap"
    with foreign.open("wb") as stream:
        writer = Writer(stream)
        writer.start()
        channel = writer.register_channel("/note", "json", writer.register_schema("note", "jsonschema", b"{}"))
        writer.add_message(channel, 0, b"{}", 0)
        writer.finish()
    result = call("recover", foreign, "-o", saved)
    assert result.exit_code == 2 and result.stderr.startswith(
        f"P-ERR-26224 recording {foreign}: holds no message that can be saved; at offset "
    )
    assert " ".join(result.stderr.split()).endswith(": /note holds no messages of ROS 2; nothing was written")
    assert not saved.exists()


def test_records_of_foreign_programs_name_no_program():
    given = ("", "{", "[]", "{}", '{"program": "a.nc"}')
    records = [CommandRecord(0, "channel", "load", arguments, True, 0, "") for arguments in given]
    assert program_of(SimpleNamespace(commands=records)) == "a.nc"
    assert program_of(SimpleNamespace(commands=records[:-1])) == ""


NO_LOADS = (
    '{"program": "a.nc", "text": 5}',
    '{"program": "a.nc", "text": null}',
    '{"program": ["a.nc"], "text": "M30"}',
    '{"program": "a.nc", "text": "M30", "files": [1]}',
    '{"program": "a.nc", "text": "M30", "files": {"b.nc": 5}}',
    '{"program": "a.nc", "text": "M30", "dialect": ["iso"]}',
)


def test_records_of_foreign_programs_have_no_known_blocks():
    axes: dict[str, list[object]] = {axis: [] for axis in "xyz"}
    text = '{"program": "a.nc", "text": "M30"'
    loads = ("", "[" * 100_000, "[]", "{}", '{"text": "M30"}', text + ', "dialect": "none"}', *NO_LOADS)
    for load, start in [*((load, "{}") for load in loads), (text + "}", "["), (text + "}", '{"line": 3}')]:
        records = [
            CommandRecord(0, "channel", command, arguments, True, 0, "")
            for command, arguments in (("load", load), ("start", start))
        ]
        recorded = SimpleNamespace(commands=records, of_type=lambda _: axes)
        assert known_blocks(recorded, read_machine(MILL), "channel") is None
