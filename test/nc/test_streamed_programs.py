"""Programs that are read while they are executed: the blocks and faults of those that are read at once."""

from pathlib import Path

import pytest
from nc_support import HERE, channel_of, files_of, vocabulary_of

from cnc_ptp.nc.canonical import BUSY, CanonicalBlock, LinearMove
from cnc_ptp.nc.canonical_text import format_block
from cnc_ptp.nc.faults import ProgramError
from cnc_ptp.nc.interpreter import interpret
from cnc_ptp.nc.plain_channel import plain_channel
from cnc_ptp.nc.streamed_program import LINES_AT_ONCE, StreamedProgram, stream_program

GOOD = sorted((HERE / "golden").glob("*.nc"))
BAD = sorted((HERE / "bad").glob("*.nc"))
NEVER_READ = (
    "end_only_skippable",
    "goto_into_other_loop",
    "iso_end_of_subroutine_missing",
    "iso_program_twice",
    "second_main_program",
    "second_main_program_nameless",
)
"""Their faults are in lines behind the end, or do not matter because a line is not executed."""


def opened(text: str, file: str = "a.nc") -> StreamedProgram:
    return stream_program(text, file, files=files_of(text), vocabulary=vocabulary_of(text))


def stream(text: str, file: str) -> list[str]:
    channel = channel_of(text)
    blocks = interpret(opened(text, file), (0.0,) * len(channel.axes), channel)
    return [format_block(block) for block in blocks]


def run(text: str) -> list[CanonicalBlock]:
    return list(interpret(opened(text), (0.0, 0.0), plain_channel("XY"), runs=True))


def targets(blocks: list[CanonicalBlock]) -> list[float]:
    return [block.motion.target[0] for block in blocks if block.motion is not None]  # type: ignore[union-attr]


@pytest.mark.parametrize("path", GOOD, ids=lambda path: path.stem)
def test_canonical_stream_is_the_golden_one(path: Path) -> None:
    assert stream(path.read_text(), path.name) == path.with_suffix(".txt").read_text().splitlines()


@pytest.mark.parametrize("path", BAD, ids=lambda path: path.stem)
def test_bad_program_raises_the_text_of_its_first_line(path: Path) -> None:
    text = path.read_text()
    if path.stem in NEVER_READ:
        stream(text, path.name)
        return
    with pytest.raises(ProgramError) as caught:
        stream(text, path.name)
    if path.stem in (
        "iso_return_only",
        "iso_number_twice_before",
    ):  # the first program is the main one, so M99 is the fault
        assert caught.value.number == 21018
    else:
        assert str(caught.value) == text.split("\n")[0].removeprefix("; ")


def test_nothing_is_read_before_it_is_needed() -> None:
    program = opened("%L UP\nX1\nM29\n%MAIN\nG00 X2\nLL UP\nX1 Q\nM30")
    assert program.lines == 4
    stream_of = interpret(program, (0.0,), plain_channel("X"))
    assert next(stream_of).source.line == 5 and program.lines == 5
    assert next(stream_of).source.line == 2 and program.lines == 6
    with pytest.raises(ProgramError, match=r"a.nc line 7 column 4 'X1 Q'"):
        next(stream_of)


def test_a_fault_before_the_main_program_is_found_at_once() -> None:
    with pytest.raises(ProgramError, match=r"a.nc line 2 column 4 'X1 Q'"):
        opened("%L UP\nX1 Q\nM29\n%MAIN\nM30")
    with pytest.raises(ProgramError, match=r"21014 .*: no main program"):
        opened("; only a comment")


def test_what_lies_far_ahead_is_read_in_slices() -> None:
    """A label, a subroutine and the end of a condition behind many lines; comments take time, too."""
    far = "; comment\n" * (3 * LINES_AT_ONCE)
    for text in (
        f"G00 X1\n$GOTO N9\n{far}X5\nN9: X2\nM30",
        f"G00 X1\nLL UP\nM30\n{far}%L UP\nX2\nM29\n",
        f"G00 X1\n$IF 0\n{far}X5\n$ELSE\nX2\n$ENDIF\nM30",
    ):
        blocks = run(text)
        assert 3 <= sum(block is BUSY for block in blocks) <= 5
        assert targets(blocks) == [1.0, 2.0]


def test_a_loop_over_more_lines_than_are_kept() -> None:
    body = "".join(f"X{n}\n" for n in range(1, 12_001))
    found = targets(run(f"G00\n$FOR P1 = 1, 2, 1\n{body}$ENDFOR\nM30"))
    assert found == [float(n) for n in range(1, 12_001)] * 2


def test_how_much_was_executed_never_decreases() -> None:
    text = "G00 X1\n$FOR P1 = 1, 3, 1\nX2\nX1\n$ENDFOR\nX5\nM30"
    program = opened(text)
    places = [program.place() for _ in interpret(program, (0.0,), plain_channel("X"))]
    assert places == sorted(places) and places[0] == 7 and program.size == len(text)


@pytest.mark.long
def test_structures_of_lines_that_have_been_executed_are_forgotten() -> None:
    """30,000 conditions on end; a loop is repeated though much of what follows it is known."""
    body = "\n".join(["$IF P1", "P2 = P2 + 1", "$ENDIF"] * 30_000)
    text = "%L SUB\n$IF P1\nP3 = P3 + 1\n$ENDIF\nM29\n%MAIN\nP1 = 1\nP2 = 0\nP3 = 0\nLL SUB\n"
    text += f"{body}\n$FOR P4 = 1, 3, 1\n$IF P4 == 2\nLL SUB\n$ENDIF\n$ENDFOR\nX[P2 + P3] F1\nM30"
    program = opened(text)
    (*_, last, _) = [block for block in interpret(program, (0.0,), plain_channel("X")) if block is not BUSY]
    assert isinstance(last.motion, LinearMove) and last.motion.target == (30_002.0,)
    assert len(program.structure_of) < 25_000


def test_structures_are_kept_where_a_jump_may_lead_back() -> None:
    body = "\n".join(["$IF P1", "P2 = P2 + 1", "$ENDIF"] * 12_000)
    text = f"P1 = 1\nP2 = 0\nP3 = 0\n[AGAIN]\n{body}\nP3 = P3 + 1\n$IF P3 < 2\n$GOTO [AGAIN]\n$ENDIF\nG01 X[P2] F1\nM30"
    blocks = [block for block in interpret(opened(text), (0.0,), plain_channel("X")) if block is not BUSY]
    assert targets(blocks) == [24_000.0]
