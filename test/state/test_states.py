"""Stored states: whatever was stored, new units continue from it as the run did, to the bit."""

from __future__ import annotations

import json
import math
import random
import struct

import pytest
from machine_support import MILL, ROOT
from state_support import Run, outputs_of, require_same_continuation, texts

from cnc_ptp.channel.channel_unit import ChannelUnit
from cnc_ptp.errors import CncError
from cnc_ptp.machine.offline import OfflineMachine
from cnc_ptp.machine.wiring import build_units
from cnc_ptp.parameters import load_machine
from cnc_ptp.plc.scenario import Entry
from cnc_ptp.protocol.blocks import Command
from cnc_ptp.state import decoding, machine_state
from cnc_ptp.state.decoding import Decoder
from cnc_ptp.state.encoding import Encoder, LongLists
from cnc_ptp.state.machine_state import StateStore
from cnc_ptp.state.roots import Roots

SPINDLES, FIGURES = "examples/spindles/", "examples/figures/"
RUNS = [
    Run("config/mill.yaml", "examples/bracket.nc", "examples/bracket_overrides.yaml"),
    Run("config/mill.yaml", "examples/pocket.nc"),
    Run("config/mill.yaml", "examples/plate.ngc", dialect="iso"),
    Run("config/mill.yaml", "examples/tapping.nc"),
    Run("config/lathe.yaml", "examples/caxis.nc"),
    Run("config/lathe.yaml", "examples/turned_part.nc"),
    Run("config/lathe.yaml", "examples/threads/chain.nc"),
    Run("examples/probe.yaml", "examples/probe.nc"),
    Run("examples/homing.yaml", "examples/homing.nc"),
    Run("examples/sercos.yaml", scenario="examples/sercos_homing.yaml"),
    Run("config/ptp.yaml", scenario="examples/trajectory.yaml"),
    Run("config/ptp.yaml", scenario=FIGURES + "ptp_external_setpoints.yaml"),
    Run("config/ptp.yaml", scenario=FIGURES + "ptp_compensation_partial.yaml"),
    Run("config/ptp.yaml", scenario=FIGURES + "slave_cam.yaml"),
    Run("config/ptp.yaml", scenario=FIGURES + "slave_flying_saw.yaml"),
    Run("config/gantry.yaml", scenario=FIGURES + "slave_gantry.yaml"),
    Run("config/spindle_curves.yaml", scenario=FIGURES + "spindle_curve_points.yaml"),
    Run(SPINDLES + "plc_spindle.yaml", SPINDLES + "din.nc", SPINDLES + "plc.yaml"),
    Run(SPINDLES + "two_channels.yaml", SPINDLES + "channel1.nc", SPINDLES + "two_channels_start.yaml"),
    Run(SPINDLES + "synchronous.yaml", SPINDLES + "override.nc", SPINDLES + "override.yaml"),
    Run(SPINDLES + "gears_programmed.yaml", SPINDLES + "gears_programmed.nc"),
]


@pytest.mark.parametrize("run", RUNS, ids=lambda run: run.name)
def test_new_units_continue_a_stored_run_to_the_bit(run: Run) -> None:
    machine = run.parameters()
    require_same_continuation(machine, run.entries(machine), seed=run.name, places=3, follow=30, seconds=12.0)


WAITING = """
#VAR
V.P.N
#ENDVAR
V.P.N = 0
$WHILE V.P.N < 8
V.P.N = V.P.N + 1
G01 X[10*V.P.N] Y10 F3000
V.P.N = V.P.N + V.A.ACT_POS.X / 1000
G01 X[V.A.ACT_POS.X + 3] Y[V.P.N]
G01 X0
G04 0.05
$ENDWHILE
M30
"""


def entries(text: str) -> list[Entry]:
    load = Command("channel", "load", {"program": "waiting.nc", "text": text})
    return [Entry(0.0, load), Entry(0.0, Command("channel", "start", {}))]


def test_a_program_that_reads_what_only_the_run_knows_continues_where_it_was() -> None:
    require_same_continuation(MILL, entries(WAITING), seed="waits", places=8, follow=60, seconds=10.0)


def test_a_program_that_is_read_while_it_runs_continues_where_it_was() -> None:
    text = (ROOT / "config" / "mill.yaml").read_text(encoding="utf-8")
    machine = load_machine(text, "mill.yaml", changes={"channel": {"interpreter.checked_text": 20}})
    require_same_continuation(machine, entries(WAITING), seed="streamed", places=6, follow=60, seconds=10.0)


def test_manual_blocks_keep_their_state() -> None:
    texts = ["G91 G01 X5 F2000", "G54 Y3", "G90 G00 X[V.A.ACT_POS.X]", "G00 X0"]
    given = [Entry(0.2 + at, Command("channel", "mdi", {"text": text})) for at, text in enumerate(texts)]
    require_same_continuation(MILL, given, seed="manual", places=8, follow=60, seconds=4.0)


def a_state(store: StateStore) -> bytes:
    offline, _ = outputs_of(MILL, entries("G01 X50 Y20 F3000\nM30"), 0.3)
    for _ in range(30):
        offline.tick()
    return store.encode(offline)


def test_storing_changes_nothing_and_the_same_state_has_the_same_bytes() -> None:
    store = StateStore(MILL)
    assert a_state(store) == a_state(store)
    assert a_state(StateStore(MILL)) == a_state(store)


def test_a_state_with_a_byte_changed_or_cut_is_refused() -> None:
    store = StateStore(MILL)
    state = a_state(store)
    generator = random.Random(19)
    for place in [*range(machine_state.HEAD), *generator.sample(range(len(state)), 200)]:
        changed = bytearray(state)
        changed[place] ^= 1 << generator.randrange(8)
        with pytest.raises(CncError) as refused:
            store.restore(bytes(changed))
        assert refused.value.number in (26151, 26152)
    for length in [*range(machine_state.HEAD + 3), *generator.sample(range(len(state)), 50)]:
        with pytest.raises(CncError) as refused:
            store.restore(state[:length])
        assert refused.value.number == 26151


def sealed(text: bytes) -> bytes:
    """A state with content that no encoder has made."""
    import zstandard

    rest = zstandard.compress(text)
    head = machine_state.MAGIC + machine_state.LAYOUT.to_bytes(2, "little") + machine_state.kernel_digest()
    return head + machine_state.check_sum(rest) + rest


WRONG = {
    b"": "it is no JSON: Expecting value: line 1 column 1 (char 0)",
    b"[]": "it is no list of cycle, root, shapes and rows",
    b"[0,[0],[],[]]": "its root is no row",
    b"[0,[0],[],{}]": "it has no lists of rows and shapes",
    b'[0,[0],{},{"0":1}]': "it has no lists of rows and shapes",
    b"[0,[0],[],null]": "it has no lists of rows and shapes",
    b'[0,[0],[],[["z"]]]': "row 0 has no form: ['z']",
    b'[0,[0],[],["l"]]': "row 0 has no form: 'l'",
    b'[0,[0],[],[["t",[7]]]]': "row 0 has no form: ['t', [7]]",
    b'[0,[0],[],[["d",1,2,3]]]': "row 0 has no form: ['d', 1, 2, 3]",
    b'[0,[0],[],[["o",0]]]': "row 0 has no form: ['o', 0]",
    b'[0,[0],[],[["R","os"]]]': "row 0 has no form: ['R', 'os']",
    b'[0,[0],[[1,[]]],[["l"]]]': "a shape is [1, []]",
    b'[0,[0],[["a",[1]]],[["l"]]]': "a shape is ['a', [1]]",
    b'[0,[0],[],[["F","os","system"]]]': "os has no system: there is no root os",
    b'[0,[0],[],[["F","builtins","exec"]]]': "builtins has no exec: 'exec'",
    b'[0,[0],[],[["F","cnc_ptp.compiled.build","os.system"]]]': (
        "cnc_ptp.compiled.build has no os.system: there is no root cnc_ptp.compiled.build"
    ),
    b'[0,[0],[],[["F","cnc_ptp.machine.plc_file","read_plc"]]]': (
        "cnc_ptp.machine.plc_file has no read_plc: there is no root cnc_ptp.machine.plc_file"
    ),
    b'[0,[0],[],[["F","cnc_ptp.errors","get_close_matches"]]]': (
        "cnc_ptp.errors has no get_close_matches: cnc_ptp.errors has no get_close_matches of its own"
    ),
    b'[0,[0],[],[["F","cnc_ptp.nc.nope","system"]]]': (
        "cnc_ptp.nc.nope has no system: No module named 'cnc_ptp.nc.nope'"
    ),
    b'[0,[0],[["subprocess:Popen",["args"]]],[["o",0,1]]]': (
        "subprocess:Popen is no class of the kernel: there is no root subprocess"
    ),
    b'[0,[0],[["cnc_ptp.errors:nearest_name",["a"]]],[["o",0,1]]]': (
        "cnc_ptp.errors:nearest_name is no class of the kernel"
    ),
    b'[0,[0],[],[["n","cnc_ptp.errors:CncError",1]]]': "cnc_ptp.errors:CncError is no tuple",
    b'[0,[0],[],[["e","cnc_ptp.protocol.blocks:Severity","LOUD"]]]': (
        "cnc_ptp.protocol.blocks:Severity has no member LOUD"
    ),
    b'[0,[0],[],[["a","<f8",[3],"AAAA"]]]': "an array: buffer size must be a multiple of element size",
    b'[0,[0],[],[["b","A"]]]': (
        "bytes: Invalid base64-encoded string: number of data characters (1) cannot be 1 more than a multiple of 4"
    ),
    b'[0,[0],[],[["m",1,"nope"]]]': "a method: 'int' object has no attribute 'nope'",
    b'[0,[0],[],[["p",1,[1],[2]],["t"],["d"]]]': "a partial: the first argument must be callable",
    b'[0,[0],[],[["p",1,[1],[1]],["t"]]]': "row 1 holds no names",
    b'[0,[0],[],[["g",["machine","nope"]]]]': (
        "nothing is at ['machine', 'nope']: 'MachineParameters' object has no attribute 'nope'"
    ),
    b'[0,[0],[],[["x","77"]]]': "its text 77 is missing",
    b'[0,[0],[],[["f",[1]],["l"]]]': "a set: unhashable type: 'list'",
    b'[0,[0],[],[["s",[1]],["l"]]]': "a set: unhashable type: 'list'",
    b'[0,[0],[],[["d",[1],1],["l"]]]': "a dict: unhashable type: 'list'",
    b'[0,[0],[],[["t",[0]]]]': "row 0 is a part of itself",
    b'[0,[0],[],[["L",1,["a"]]]]': "nothing is at ['a']: 'int' object has no attribute 'state'",
    b'[0,[0],[["cnc_ptp.motion.profile:Profile",["nope"]]],[["o",0,1]]]': (
        "Profile.nope: 'Profile' object has no attribute 'nope'"
    ),
    b'[0,[0],[],[["l"]]]': "its root does not hold units and their blocks",
    b'[0,[0],[],[["l",[1],[1]],["d","x",1]]]': "its root does not hold units and their blocks",
}
"""What no encoder makes, and why it is refused."""


@pytest.mark.parametrize("content", WRONG, ids=lambda content: content.decode())
def test_content_of_another_maker_is_refused(content: bytes) -> None:
    text = refusal(StateStore(MILL), sealed(content))
    assert text == f"P-ERR-26151 checkpoint: the state is damaged: {WRONG[content]}; nothing was restored"


def test_a_mistake_of_the_decoder_is_not_taken_for_a_damaged_state(monkeypatch: pytest.MonkeyPatch) -> None:
    store = StateStore(MILL)
    state = a_state(store)

    def broken(_decoder: object, _row: object) -> None:
        raise AttributeError("a mistake")

    monkeypatch.setitem(decoding.MAKE, "t", broken)
    with pytest.raises(AttributeError, match="a mistake"):
        store.restore(state)


def test_a_program_with_another_text_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """By its digest; and were that the same, because the program is not what it was."""
    offline = OfflineMachine(MILL, build_units(MILL, scenario=entries(WAITING.ljust(600))))
    for _ in range(40):
        offline.tick()
    store = StateStore(MILL)
    state = store.encode(offline)
    assert len(store.texts) == 1
    (digest,) = store.texts
    store.texts[digest] = "G01 X10 F100\nM30".ljust(600)
    assert refusal(store, state) == (
        f"P-ERR-26151 checkpoint: the state is damaged: its text {digest} is another one; nothing was restored"
    )
    monkeypatch.setattr(decoding, "digest_of", lambda _text: digest)
    assert refusal(store, state).startswith(
        "P-ERR-26151 checkpoint: the state is damaged: the interpreter cannot be made again"
    )


def test_the_texts_of_the_refusals() -> None:
    store = StateStore(MILL)
    state = a_state(store)
    assert refusal(store, b"abc") == (
        "P-ERR-26151 checkpoint: the state is damaged: its 3 bytes do not begin as those of a state; nothing was restored"
    )
    assert refusal(store, state[:-1]) == (
        "P-ERR-26151 checkpoint: the state is damaged: its check sum is wrong; nothing was restored"
    )
    assert refusal(store, state[:4] + b"\x02\x00" + state[6:]) == (
        "P-ERR-26152 checkpoint: the state has layout 2, this version reads layout 1; nothing was restored"
    )
    assert refusal(store, state[:6] + bytes(16) + state[22:]) == (
        "P-ERR-26152 checkpoint: the state is that of a kernel with other sources; nothing was restored"
    )


SKIPPED = "\n".join(f"{'/' * (place % 3 == 0)} G01 X{place % 40} Y{place % 7} F3000" for place in range(2000)) + "\nM30"


def commands(*given: tuple[float, str, dict[str, object]]) -> list[Entry]:
    return [Entry(at, Command("channel", command, arguments)) for at, command, arguments in given]


LONG_RUNS = {
    "from its beginning": entries(SKIPPED),
    "without the skipped blocks, which count again meanwhile": [
        *commands((0.0, "block_skip", {"enabled": True})),
        *entries(SKIPPED),
        *commands((0.3, "block_skip", {"enabled": False})),
    ],
    "from a line": [entries(SKIPPED)[0], *commands((0.1, "start", {"line": 700}))],
    "manual": commands((0.0, "mdi", {"text": SKIPPED.replace("M30", "")})),
}


@pytest.mark.parametrize("given", LONG_RUNS.values(), ids=LONG_RUNS.keys())
def test_blocks_of_a_long_program_are_made_again(given: list[Entry]) -> None:
    require_same_continuation(MILL, given, seed="long", places=4, follow=40, seconds=6.0)
    offline = OfflineMachine(MILL, build_units(MILL, scenario=given))
    store, sizes, counts = StateStore(MILL), [], []
    for _ in range(3):
        for _ in range(50):
            offline.tick()
        sizes.append(len(store.encode(offline)))
        counts.append(len(store.texts))
    assert counts == [counts[0]] * 3 and max(sizes) < 60_000


def test_what_was_prepared_is_no_part_of_a_state() -> None:
    """Neither before its start nor behind it; a channel that lacks it interprets the program when it starts."""
    units = build_units(MILL, scenario=[*entries(SKIPPED)[:1], *commands((0.2, "start", {}))])
    channel = units["channel"]
    assert isinstance(channel, ChannelUnit)
    channel.prepare("waiting.nc", SKIPPED)
    prepared = OfflineMachine(MILL, units)
    store = StateStore(MILL)
    for _ in range(2):
        for _ in range(15):
            prepared.tick()
        state = store.encode(prepared, with_plc=True)
        assert len(state) < 60_000
        restored = OfflineMachine(MILL, build_units(MILL))
        restored.go_on_from(*store.restore(state))
        assert [texts(restored.tick()) for _ in range(40)] == [texts(prepared.tick()) for _ in range(40)]


def test_a_long_program_with_another_text_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    offline = OfflineMachine(MILL, build_units(MILL, scenario=entries(SKIPPED)))
    for _ in range(50):
        offline.tick()
    store = StateStore(MILL)
    state = store.encode(offline)
    [digest] = [digest for digest, text in store.texts.items() if text == SKIPPED]
    monkeypatch.setattr(decoding, "digest_of", lambda _text: digest)
    for text, fault in (("M30", "; nothing"), ("G01 X9999 F3000\nM30", ": P-ERR-120002 waiting.nc line 1")):
        store.texts[digest] = text.ljust(600)
        assert refusal(store, state).startswith(
            f"P-ERR-26151 checkpoint: the state is damaged: the list of blocks cannot be made again{fault}"
        )


def test_very_many_floats_are_kept_beside_the_state_to_the_bit(monkeypatch: pytest.MonkeyPatch) -> None:
    numbers = [math.nan, -0.0, math.inf, 5e-324, *(place / 3 for place in range(1000))]
    roots, texts = Roots({}), dict[str, str]()
    encoder = Encoder(roots, texts)
    value = encoder.encode([numbers, numbers, numbers[:999], [*numbers[1:], 1]])
    written = json.dumps(encoder.rows)
    one, same, few, mixed = Decoder(json.loads(written), encoder.shapes, roots, texts).decode(value)
    assert one is same and struct.pack("1004d", *one) == struct.pack("1004d", *numbers)
    assert struct.pack("999d", *few) == struct.pack("999d", *numbers[:999])
    assert mixed == [*numbers[1:], 1] and type(mixed[-1]) is int
    [digest] = texts
    for wrong, why in (
        ("AAAA", "buffer size must be a multiple of element size"),
        ("?", "Only base64 data is allowed"),
    ):
        monkeypatch.setattr(decoding, "digest_of", lambda _: digest)
        with pytest.raises(CncError) as refused:
            Decoder(json.loads(written), encoder.shapes, roots, {digest: wrong}).decode(value)
        assert str(refused.value) == (
            f"P-ERR-26151 checkpoint: the state is damaged: a list of floats: {why}; nothing was restored"
        )


def test_floats_that_have_changed_are_kept_again() -> None:
    numbers = [place / 3 for place in range(1000)]
    texts: dict[str, str] = {}
    lists: LongLists = {}
    roots = Roots({})
    for _ in range(2):
        encoder = Encoder(roots, texts, lists=lists)
        encoder.encode(numbers)
        lists = encoder.lists
        assert len(texts) == len(lists) == 1
    numbers[3] = -0.0
    encoder = Encoder(roots, texts, lists=lists)
    value = encoder.encode(numbers)
    again = Decoder(encoder.rows, encoder.shapes, roots, texts).decode(value)
    assert len(texts) == 2 and math.copysign(1.0, again[3]) == -1.0


def test_long_lists_that_are_gone_are_forgotten() -> None:
    """Of a machine with many cycles in a block each block has some."""
    text = (ROOT / "config" / "mill.yaml").read_text()
    machine = load_machine(text.replace("block_cycles: 10", "block_cycles: 400"), "mill.yaml")
    offline = OfflineMachine(machine, build_units(machine, scenario=entries(SKIPPED)))
    store, counts = StateStore(machine), []
    for _ in range(4):
        offline.tick()
        offline.tick()
        store.encode(offline)
        counts.append(len(store._lists))
    assert counts[0] > 2 and counts == [counts[0]] * 4


def refusal(store: StateStore, state: bytes) -> str:
    with pytest.raises(CncError) as refused:
        store.restore(state)
    return str(refused.value)


def test_what_has_no_form_is_refused_with_its_place() -> None:
    offline = OfflineMachine(MILL, build_units(MILL))
    offline.runner("x").unit.check_override = lambda command, percent: None
    with pytest.raises(CncError) as refused:
        StateStore(MILL).encode(offline)
    assert str(refused.value) == (
        "P-ERR-26150 checkpoint: the state holds a function at [][x].unit.check_override; no state was stored"
    )
