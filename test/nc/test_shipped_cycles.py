"""The cycles that ship: what they refuse, and the motions of each, computed by hand."""

import pytest
from nc_support import HERE, lines, run

from cnc_ptp.machine.program_files import called_programs
from cnc_ptp.nc.canonical import LinearMove
from cnc_ptp.nc.parser import parse_all

BEFORE = "M03 S100\nG00 Z5\nG01 F600\n"


def cycle(call: str) -> list[str]:
    """The blocks behind `call`, at Z5, with feed 10 mm/s."""
    return lines(f"{BEFORE}{call}\nM30", files=called_programs(call, [str(HERE / "library")]))[2:-1]


@pytest.mark.parametrize("code", [81, 82, 83, 85, 86, 87, 88, 89])
@pytest.mark.parametrize(("depth", "plane"), [("5", "2"), ("2", "2"), ("-3", "-4")])
def test_a_depth_above_the_retract_plane_is_refused(code: int, depth: str, plane: str) -> None:
    third = ", 1" if code in (82, 83, 88, 89) else ""
    reason = f"PM1 = depth is not below the retract plane, PV1 = {depth}, PV2 = {plane}"
    assert cycle(f"G{code}[{depth}, {plane}{third}]") == [f"error {code} '#ERROR {code} of the program: {reason}'"]


@pytest.mark.parametrize("peck", ["0", "-1"])
def test_deep_drilling_needs_a_peck_depth(peck: str) -> None:
    text = f"#ERROR 83 of the program: PM1 = peck depth is not above 0, PV1 = {peck}"
    assert cycle(f"G83[-5, 2, {peck}]") == [f"error 83 '{text}'"]


def test_a_code_whose_program_is_nowhere_is_refused() -> None:
    """P-CHAN-00161 names it; without that all codes have a program that ships."""
    _, errors = parse_all("G00 X1 G81[-10]\nM30", "a.nc", files={}, cycles={"G81": "own.nc"})
    reason = (
        "G81 calls own.nc (P-CHAN-00161), which is in no search folder; put a program of this name beside the main one"
    )
    assert [str(error) for error in errors] == [f"P-ERR-21598 a.nc line 1 column 8 'G00 X1 G81[-10]': {reason}"]


def z(*moves: float | str) -> list[str]:
    """Rapid moves, and with an F behind the number those at the feed."""
    return [
        f"line (0, 0, {move[:-1]}) feed 10" if isinstance(move, str) else f"rapid (0, 0, {move:g})" for move in moves
    ]


@pytest.mark.parametrize(
    ("call", "expected"),
    [
        ("G81[-4, 2]", z(2, "-4F", 2)),
        ("G82[-4, 2, 0.5]", [*z(2, "-4F"), "dwell 0.5 s", *z(2)]),
        ("G83[-5, 2, 3]", z(2, "-1F", 2, -0.5, "-4F", 2, -3.5, "-5F", 2)),
        ("G85[-4, 2]", z(2, "-4F", "2F")),
        ("G86[-4, 2]", [*z(2, "-4F"), "S[M5]", *z(2), "S[M3 REV100]"]),
        ("G87[-4, 2]", [*z(2, "-4F"), "S[M5]", "M00", *z(2), "S[M3 REV100]"]),
        ("G88[-4, 2, 0.2]", [*z(2, "-4F"), "dwell 0.2 s", "S[M5]", "M00", *z(2), "S[M3 REV100]"]),
        ("G89[-4, 2, 0.2]", [*z(2, "-4F"), "dwell 0.2 s", *z("2F")]),
    ],
)
def test_motions(call: str, expected: list[str]) -> None:
    assert cycle(call) == expected


@pytest.mark.parametrize(("plane", "place"), [(17, 2), (18, 1), (19, 0)])
@pytest.mark.parametrize(
    "call",
    [
        "G81[-4, 2]",
        "G82[-4, 2, 0.5]",
        "G83[-5, 2, 3]",
        "G85[-4, 2]",
        "G86[-4, 2]",
        "G88[-4, 2, 0.2]",
        "G89[-4, 2, 0.2]",
    ],
)
def test_the_drilling_axis_is_normal_to_the_plane(plane: int, place: int, call: str) -> None:
    """DIN 66025: the motions of G17, which are along Z, in the other axis; the call leaves the plane as it was."""
    text = f"M03 S100\nF600\nG{plane}\nG91 G00 {'XYZ'[place]}5\n{call}\nX1 Y1 Z1\nM30"
    turned = [block.motion for block in run(text, files=called_programs(call, [str(HERE / "library")]))]
    along_z = run(text.replace(f"G{plane}", "G17").replace(f"{'XYZ'[place]}5", "Z5"), files=called_programs(call, [""]))

    def moved(target: tuple[float, ...]) -> tuple[float, ...]:
        others = list(target[:2])
        return (*others[:place], target[2], *others[place:])

    expected = [block.motion for block in along_z]
    for one, other in zip(turned, expected, strict=True):
        if isinstance(other, LinearMove):
            assert isinstance(one, LinearMove) and one == other._replace(target=moved(other.target))
        else:
            assert one == other
    assert isinstance(turned[-2], LinearMove) and turned[-2].target[place] in (3.0, -3.0)


# threads

LATHE = {"axes": ("X", "Z"), "start": (30.0, 62.0)}


def threading(arguments: str) -> list[str]:
    """The blocks of the cycle from X30 Z62 on."""
    call = f"L CYCLE [NAME=threading.nc {arguments}]"
    return lines(f"M03 S100\n{call}\nM30", files=called_programs(call, [str(HERE / "library")]), **LATHE)[1:-1]


def test_passes_of_a_thread_get_deeper_by_the_square_root_of_their_number() -> None:
    """Depth 0.8 from 0.4 on: 0.4, 0.566, 0.693, 0.8, and one pass more."""
    found = threading("@X=20 @Z=32 @LEAD=1.5 @DEPTH=0.8 @FIRST=0.4 @SPRING=1")
    depths = ("19.6", "19.434315", "19.30718", "19.2", "19.2")
    passes = [
        [f"rapid ({x}, 62)", f"thread ({x}, 32) spindle S turns 20 lead 1.5", "rapid (21, 32)", "rapid (21, 62)"]
        for x in depths
    ]
    assert found == ["rapid (21, 62)", *[line for each in passes for line in each]]


def test_the_retract_of_an_inside_thread_ends_with_its_cycle() -> None:
    """Else it would lead into the workpiece outside; X of a mirrored program is mirrored for it, too."""
    inside = "L CYCLE [NAME=threading.nc @X=20 @Z=32 @LEAD=3 @DEPTH=-0.8 @FIRST=0.8]"
    outside = "L CYCLE [NAME=threading.nc @X=20 @Z=32 @LEAD=3 @DEPTH=0.8 @FIRST=0.8]"
    files = called_programs(f"{inside}\n{outside}", [str(HERE / "library")])
    for mirror, way in (("", "-1.8"), ("G18 G22 X-30\n", "1.8")):
        text = f"M03 S100\n{mirror}{inside}\n{outside}\nG33 Z20 K3\nM30"
        threads = [line for line in lines(text, files=files, **LATHE) if line.startswith("thread")]
        assert [line.partition(" retract ")[2] for line in threads] == [f"{way} by axis 0", "", ""]


def test_flank_infeed_taper_starts_and_chamfer_of_a_thread() -> None:
    """Inside, from Z62 to Z32: cuts at 0.5 and 1; at 45 deg the first starts 0.5 mm farther away."""
    arguments = "@X=20 @Z=32 @LEAD=3 @DEPTH=-0.8 @FIRST=0.5657 @ANGLE=45 @TAPER=-3 @CHAMFER=3 @STARTS=2 @CLEAR=2"
    broken_off = " retract -2.8 by axis 0"  # depth and CLEAR, towards the turning centre
    found = threading(arguments)
    assert all(line.endswith(broken_off) for line in found if line.startswith("thread"))
    found = [line.removesuffix(broken_off) for line in found]
    assert found[0] == "rapid (15, 62)"
    first = [
        "rapid (15, 62.2343)",
        "rapid (20.58913, 62.2343)",
        "thread (17.8657, 35) spindle S turns 9.0781 lead 3",
        "thread (17, 32) spindle S turns 1 lead 3",
        "rapid (15, 32)",
    ]
    assert found[1:6] == first
    assert found[6:9] == [first[0], first[1], first[2] + " offset 180"]
    assert found[11:14] == ["rapid (15, 62)", "rapid (20.8, 62)", "thread (18.1, 35) spindle S turns 9 lead 3"]
    assert found[-1] == "rapid (15, 62)"


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        ("@X=20 @Z=62 @LEAD=3 @DEPTH=1 @FIRST=0.5", "PM1 = the thread has no length: it begins at its end, PV1 = 62"),
        (
            "@X=20 @Z=32 @LEAD=3 @DEPTH=1 @FIRST=2",
            "PM1 = depth of the first cut is not above 0 and up to the depth, PV1 = 2, PV2 = 1",
        ),
        (
            "@X=20 @Z=32 @LEAD=3 @DEPTH=1 @FIRST=0.5 @CHAMFER=1",
            "PM1 = chamfer is not longer than the depth, PV1 = 1, PV2 = 1",
        ),
    ],
)
def test_threads_that_the_cycle_refuses(arguments: str, reason: str) -> None:
    assert threading(arguments) == [f"error 76 '#ERROR 76 of the program: {reason}'"]
