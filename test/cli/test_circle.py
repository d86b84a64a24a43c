"""`cnc_ptp circle`: roundness and quadrant peaks of the simulated mill, pictures, and what is refused."""

import cmath
import math
import re
from types import SimpleNamespace

import numpy as np
import pytest
import yaml
from commands_support import MILL, PTP, call, changed_mill
from long_support import long_sets

from cnc_ptp.commands.commissioning.circle_report import CircleTest, Variant, VariantResult, comparison_lines
from cnc_ptp.plots.colours import DARK
from cnc_ptp.recording.reader import read_recording

RADIUS, FEED = 25.0, 2000.0
NUMBER = r"(-?\d+\.\d\d)"
ROW = re.compile(
    rf"^(.*?)\s*\b(ccw|cw)\s+{NUMBER}\s+{NUMBER}\s+{NUMBER}\s+{NUMBER}\s+{NUMBER}\s+{NUMBER}\s+{NUMBER}(?:\s+{NUMBER})?$"
)


def rows(result):
    """(variant, direction) -> G, F least, F most, four peaks, G(b) if given; µm."""
    table, variant = {}, ""
    for line in result.stdout.splitlines():
        if match := ROW.match(line):
            variant = match[1] or variant
            table[variant, match[2]] = [float(value) for value in match.groups()[2:] if value is not None]
    return table


@pytest.fixture(scope="module")
def comparison(tmp_path_factory):
    """All four variants of the mill with pictures of each kind."""
    folder = tmp_path_factory.mktemp("circle")
    pictures = [folder / f"circle.{ending}" for ending in ("svg", "png", "html")]
    outputs = [word for picture in pictures for word in ("-o", picture)]
    return call("circle", MILL, "--radius", RADIUS, "--feed", FEED, "--compare", "both", *outputs), pictures


NOTHING = "without feedforward, without friction compensation"
FORWARD = "with feedforward, without friction compensation"
FRICTION = "without feedforward, with friction compensation"
ALL = "with feedforward, with friction compensation"


@pytest.mark.long
def test_all_variants_and_directions_are_told(comparison):
    result, pictures = comparison
    assert result.exit_code == 0, result.output
    assert result.stdout.splitlines()[0] == "Circle test XY, R 25 mm about X 0 Y 0, F 2000 mm/min"
    assert set(rows(result)) == {(name, way) for name in (NOTHING, FORWARD, FRICTION, ALL) for way in ("ccw", "cw")}
    assert result.stdout.splitlines()[-3:] == [f"{picture} written" for picture in pictures]
    assert "warning" not in result.stdout


@pytest.mark.parametrize("way", ["ccw", "cw"])
def test_friction_compensation_makes_quadrant_peaks_5_times_smaller(comparison, way):
    table = rows(comparison[0])
    before, after = (max(map(abs, table[name, way][3:7])) for name in (FORWARD, ALL))
    assert before > 5.0 * after
    assert min(table[FORWARD, way][3:7]) > 5.0  # each quadrant has its peak, outward


@pytest.mark.parametrize("way", ["ccw", "cw"])
def test_feedforward_makes_a_circle_with_friction_compensation_10_times_rounder(comparison, way):
    """Not alone: without feedforward the compensation comes too early and makes peaks of its own …"""
    table = rows(comparison[0])
    assert table[FRICTION, way][0] > 10.0 * table[ALL, way][0]


@pytest.mark.parametrize("way", ["ccw", "cw"])
def test_feedforward_of_equal_axes_does_nothing_about_roundness(comparison, way):
    """… and without compensation the peaks of friction stay what they are: equal lags leave a circle round."""
    table = rows(comparison[0])
    assert table[FORWARD, way][0] == pytest.approx(table[NOTHING, way][0], rel=0.01)


def response(kv):
    """Of the sampled loop (held command, Ta = 3 ms, P controller of gain kv) to the circle's frequency.

    P(z) = ((T - L)(z - p) + L(1 - p)) / ((z - 1)(z - p)), G = Kv·P / (1 + Kv·P), z = e^(jwT), w = v / R.
    """
    pole, z = math.exp(-1.0 / 3.0), cmath.exp(1j * FEED / 60.0 / RADIUS * 1e-3)
    lag = 0.003 * (1.0 - pole)
    plant = ((0.001 - lag) * (z - pole) + lag * (1.0 - pole)) / ((z - 1.0) * (z - pole))
    return kv * plant / (1.0 + kv * plant)


@pytest.mark.long
def test_without_friction_the_lag_alone_makes_the_circle_smaller(tmp_path):
    """F = -R·(1 - |G|), circular deviation 0; feedforward brings the nominal radius back."""
    plain = {"simulation": {"model": "FIRST_ORDER"}}
    arguments = ["--radius", RADIUS, "--feed", FEED, "--no-friction", "--compare", "feedforward"]
    table = rows(call("circle", both(tmp_path, plain), *arguments))
    smaller = 1000.0 * RADIUS * (1.0 - abs(response(50.0)))
    assert smaller > 5.0
    assert set(table) == {(name, way) for name in (NOTHING, FORWARD) for way in ("ccw", "cw")}
    for (name, _), values in table.items():
        assert values[0] == pytest.approx(0.0, abs=0.06)
        assert values[1:3] == pytest.approx([-smaller if name == NOTHING else 0.0] * 2, abs=0.03)
        assert values[3:7] == pytest.approx([0.0] * 4, abs=0.03)


@pytest.mark.parametrize(("friction", "better"), [("--no-friction", 20.0), *long_sets([("--friction", 500.0)])])
def test_feedforward_itself_makes_axes_of_unequal_gain_10_times_rounder(friction, better, tmp_path):
    """Kv 50 and 30 1/s make an ellipse; its half axes are the singular values of both responses.

    (Those of a drive of first order: the cascaded one with friction differs by 2 %.)
    """
    machine = changed_mill(tmp_path / "unequal.yaml", "y", getriebe={"0": {"kv": 3000}})
    arguments = ["--radius", RADIUS, "--feed", FEED, "--direction", "ccw", "--compare", "feedforward"]
    table = rows(call("circle", machine, *arguments, friction))
    off, on = ((NOTHING, FORWARD), (FRICTION, ALL))[friction == "--friction"]
    x, y = response(50.0), response(30.0)
    long, short = np.linalg.svd([[x.real, -x.imag], [y.imag, y.real]], compute_uv=False)
    without, forwarded = table[off, "ccw"][0], table[on, "ccw"][0]
    assert without == pytest.approx(1000.0 * RADIUS * (long - short), rel=0.02)
    assert without > better * forwarded


def test_both_directions_need_a_ring_at_least_as_wide(comparison):
    table = rows(comparison[0])
    for name in (NOTHING, FORWARD, FRICTION, ALL):
        assert table[name, "ccw"][7] >= max(table[name, "ccw"][0], table[name, "cw"][0]) - 0.01
        assert len(table[name, "cw"]) == 7


def test_pictures(comparison):
    svg, png, page = (picture.read_bytes() for picture in comparison[1])
    assert svg.startswith(b"<?xml") and svg.count(b"without feedforward") == 4 and b"Circle test XY" in svg
    style, body = svg.decode().split("</style>")
    assert "prefers-color-scheme: dark" in style
    assert set(re.findall(r"#[0-9a-f]{6}", body)) <= set(DARK)
    assert png.startswith(b"\x89PNG\r\n")
    text = page.decode()
    assert text.startswith("<!DOCTYPE html>") and "default-src 'none'" in text
    assert not re.search(r'<(?:script|link|img)[^>]*(?:src|href)="http', text)
    assert "in µm. G: circular deviation" in text


def test_one_direction_without_comparison_and_a_chosen_magnification(tmp_path):
    picture, again = tmp_path / "a.svg", tmp_path / "b.svg"
    arguments = ["circle", MILL, "--radius", 5, "--feed", 3000, "--direction", "cw", "--no-friction", "--feedforward"]
    result = call(*arguments, "--magnification", 123, "-o", picture)
    assert result.exit_code == 0, result.output
    assert list(rows(result)) == [(FORWARD, "cw")]
    assert "against" not in result.stdout
    assert "magnified 123 times" in picture.read_text()
    call(*arguments, "--magnification", 123, "-o", again)
    assert picture.read_bytes() == again.read_bytes()


def test_another_plane_and_centre():
    result = call(
        "circle", MILL, "--radius", 5, "--feed", 3000, "--plane", "zx", "--centre", -20, 30, "--direction", "ccw"
    )
    assert result.exit_code == 0, result.output
    assert result.stdout.splitlines()[0] == "Circle test ZX, R 5 mm about Z -20 X 30, F 3000 mm/min"
    assert list(rows(result)) == [("without feedforward", "ccw")]


def test_a_feed_that_the_axes_cannot_hold_is_warned_about():
    result = call("circle", MILL, "--radius", 1, "--feed", 20000, "--direction", "ccw")
    assert result.exit_code == 0, result.output
    warning = next(line for line in result.stdout.splitlines() if line.startswith("warning"))
    lowest = float(re.search(r"the lowest is (\d+) mm/min", warning)[1])
    assert lowest <= 60.0 * math.sqrt(1800.0 * 1.0) * 1.01
    assert warning == (
        f"warning: the feed of 20000 mm/min was not reached everywhere, the lowest is {lowest:.0f} mm/min; the axes' "
        "acceleration is too small for this radius"
    )


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        (
            ["--radius", 0, "--feed", 2000],
            "P-ERR-27020 radius 0 mm is not within 0.001 ... 100000; nothing was started",
        ),
        (
            ["--radius", 1e-9, "--feed", 2000],
            "P-ERR-27020 radius 1e-09 mm is not within 0.001 ... 100000; nothing was started",
        ),
        (
            ["--radius", "nan", "--feed", 2000],
            "P-ERR-27020 radius nan mm is not within 0.001 ... 100000; nothing was started",
        ),
        (
            ["--radius", 25, "--feed", 2000, "--centre", "nan", 0],
            "P-ERR-27020 centre nan mm is not within -100000 ... 100000; nothing was started",
        ),
        (
            ["--radius", 25, "--feed", 2000, "--centre", 0, "-inf"],
            "P-ERR-27020 centre -inf mm is not within -100000 ... 100000; nothing was started",
        ),
        (
            ["--radius", 25, "--feed", 0],
            "P-ERR-27020 feed 0 mm/min is not above 0 and up to 100000; nothing was started",
        ),
        (
            ["--radius", 25, "--feed", -5],
            "P-ERR-27020 feed -5 mm/min is not above 0 and up to 100000; nothing was started",
        ),
        (
            ["--radius", 25, "--feed", 1e-3],
            "P-ERR-27020 radius 25 mm at feed 0.001 mm/min takes 3.76991e+07 s of machine time, the limit is 3600 s; "
            "nothing was started",
        ),
        (
            ["--radius", 25, "--feed", 5e-324, "--direction", "cw"],
            "P-ERR-27020 radius 25 mm at feed 4.94066e-324 mm/min takes inf s of machine time, the limit is 3600 s; "
            "nothing was started",
        ),
        (
            ["--radius", 25, "--feed", 2000, "--magnification", 0],
            "P-ERR-27020 magnification 0 is not above 0 and up to 100000; nothing was started",
        ),
        (
            ["--radius", 25, "--feed", 2000, "--plane", "XC"],
            "P-ERR-27024 plane XC is not one of XY, ZX, YZ; nothing was started",
        ),
        (
            ["--radius", 250, "--feed", 2000],
            "P-ERR-120002 circle.nc line 6 column 1 'N50 G03 I-176.776695297 J-176.776695297 F2000': axis Y: 250 mm lies "
            "beyond the positive soft limit 200 mm (P-AXIS-00178)",
        ),
        (
            ["--radius", 25, "--feed", 2000, "-o", "/nowhere/c.svg"],
            "P-ERR-27030 /nowhere/c.svg cannot be written: there is no folder /nowhere, make it or give another name; "
            "nothing was started",
        ),
        (
            ["--radius", 25, "--feed", 2000, "-o", "circle.pdf"],
            "P-ERR-27030 circle.pdf: the file name of a picture must end in .svg, .png or .html; nothing was started",
        ),
    ],
)
def test_refused_before_anything_starts(arguments, text):
    result = call("circle", MILL, *arguments)
    assert (result.exit_code, result.stderr.splitlines()[0]) == (2, text)
    assert result.stdout == ""


def test_a_circle_that_friction_swallows_is_not_evaluated():
    result = call("circle", MILL, "--radius", 0.001, "--feed", 10, "--direction", "ccw")
    text = r"P-ERR-27022 circle test: the turn in line 6 went \d+\.\d° of 360°; nothing was evaluated\n"
    assert (result.exit_code, result.stdout) == (2, "")
    assert re.fullmatch(text, result.stderr)


def test_machines_that_have_no_such_circle(tmp_path):
    result = call("circle", PTP, "--radius", 25, "--feed", 2000)
    text = "P-ERR-26112 the machine has no channel to run a circle; nothing was started\n"
    assert (result.exit_code, result.stderr) == (2, text)
    result = call("circle", "nowhere.yaml", "--radius", 25, "--feed", 2000)
    assert result.exit_code == 2 and result.stderr.startswith("P-ERR-26110 machine file nowhere.yaml cannot be read")
    two_axes = (
        MILL.read_text()
        .replace("achs_anzahl: 3", "achs_anzahl: 2")
        .replace('"2": {bezeichnung: Z, log_achs_nr: 3}', "")
    )
    flat = tmp_path / "flat.yaml"
    flat.write_text(two_axes)
    result = call("circle", flat, "--radius", 25, "--feed", 2000, "--plane", "YZ")
    text = "P-ERR-27024 channel channel has no axis Z for plane YZ; nothing was started. Axes: X, Y\n"
    assert (result.exit_code, result.stderr) == (2, text)
    turning = changed_mill(tmp_path / "turning.yaml", "z", kenngr={"achs_typ": "ACHSTYP_ROTATOR"})
    result = call("circle", turning, "--radius", 25, "--feed", 2000, "--plane", "ZX")
    text = "P-ERR-27024 axis z is rotary, a circle needs two linear axes; nothing was started\n"
    assert (result.exit_code, result.stderr) == (2, text)


@pytest.mark.parametrize("option", [["--compare", "feedforward"], ["--compare", "both"], ["--feedforward"]])
def test_feedforward_that_is_not_configured_is_nothing_to_compare(option, tmp_path):
    none = {"vorsteuer": {"vorsteuerung": "NONE"}}
    path = both(tmp_path, none)
    result = call("circle", path, "--radius", 25, "--feed", 2000, *option)
    text = "P-ERR-27023 axes x, y: feedforward has no effect, vorsteuer.vorsteuerung (P-AXIS-00223) is NONE; nothing was started\n"
    assert (result.exit_code, result.stderr) == (2, text)


@pytest.mark.parametrize("option", [["--compare", "friction"], ["--friction"]])
def test_friction_compensation_that_is_not_configured_is_nothing_to_compare(option, tmp_path):
    path = both(tmp_path, {"lr_param": {"frict_comp": 0}})
    result = call("circle", path, "--radius", 25, "--feed", 2000, *option)
    text = (
        "P-ERR-27023 axes x, y: friction compensation has no effect, it needs lr_param.frict_comp (P-AXIS-00522) and a "
        "table; nothing was started, see cnc_ptp identify friction\n"
    )
    assert (result.exit_code, result.stderr) == (2, text)


def test_one_axis_without_friction_compensation_is_told_and_the_other_is_compared(tmp_path):
    """The peaks of X at 0° and 180° become smaller, those of Y stay."""
    path = changed_mill(tmp_path / "one.yaml", "y", lr_param={"frict_comp": 0})
    options = ["--radius", 25, "--feed", 2000, "--direction", "ccw", "--feedforward"]
    result = call("circle", path, *options, "--compare", "friction")
    assert result.exit_code == 0, result.output
    assert result.stdout.splitlines()[-1] == (
        "warning: axis Y has no friction compensation, it needs lr_param.frict_comp (P-AXIS-00522) and a table; only the "
        "other axis was switched"
    )
    before, after = (rows(result)[name, "ccw"][3:7] for name in (FORWARD, ALL))
    assert before[0] > 5.0 * after[0] and before[2] > 5.0 * after[2]
    assert before[1] == pytest.approx(after[1], rel=0.1) and before[3] == pytest.approx(after[3], rel=0.1)


def test_an_axis_without_friction_compensation_that_is_not_switched_is_no_news(tmp_path):
    path = changed_mill(tmp_path / "one.yaml", "y", lr_param={"frict_comp": 0})
    result = call("circle", path, "--radius", 5, "--feed", 2000, "--direction", "ccw", "--no-friction")
    assert result.exit_code == 0 and "warning" not in result.output


def both(tmp_path, sections):
    """The mill with sections of x and y changed."""
    machines = [yaml.safe_load(changed_mill(tmp_path / f"{axis}.yaml", axis, **sections).read_text()) for axis in "xy"]
    machines[0]["/y"] = machines[1]["/y"]
    path = tmp_path / "both.yaml"
    path.write_text(yaml.safe_dump(machines[0]))
    return path


def test_a_run_that_fails_is_status_1_and_tells_why(tmp_path):
    weak = changed_mill(tmp_path / "weak.yaml", "x", simulation={"torque_limit": 0.5})
    result = call("circle", weak, "--radius", 25, "--feed", 20000)
    assert result.exit_code == 1
    assert "error: P-ERR-17744 axis x: following error" in result.stderr
    assert result.stdout == ""


def test_a_picture_that_cannot_be_written_after_all(tmp_path):
    path = tmp_path / "c.html"
    path.mkdir()
    result = call("circle", MILL, "--radius", 5, "--feed", 3000, "-o", path)
    assert result.exit_code == 2 and "is a directory" in result.stderr


@pytest.mark.parametrize("option", ["--help", "-h"])
def test_help(option):
    assert "Usage:" in call("circle", option).output
    assert call("circle", MILL).exit_code == 2
    assert call("circle", MILL, "--radius", 25, "--feed", 2000, "--compare", "all").exit_code == 2


@pytest.mark.parametrize(
    ("compare", "option", "name"),
    [
        ("friction", "--no-friction", "friction"),
        ("friction", "--friction", "friction"),
        ("feedforward", "--feedforward", "feedforward"),
        ("both", "--no-feedforward", "feedforward"),
        ("both", "--friction", "friction"),
    ],
)
def test_what_is_compared_is_not_chosen(compare, option, name):
    result = call("circle", MILL, "--radius", 25, "--feed", 2000, "--compare", compare, option)
    assert result.exit_code == 2
    assert result.stderr.endswith(
        f"\nError: --compare {compare} runs without and with {name}: --{name} and --no-{name} are for what is not "
        "compared.\n"
    )


@pytest.mark.parametrize(
    ("before", "after", "text"),
    [
        (0.01, 0.002, "5.0 times smaller"),
        (0.002, 0.0034, "1.7 times larger"),
        (0.002, 0.00202, "as large"),
        (0.00202, 0.002, "as large"),
        (0.0, 0.0, "as large"),
        (0.002, 0.0, "practically zero"),
        (0.0, 0.002, "from practically zero"),
        (0.03, 1e-8, "practically zero"),
        (1e-8, 0.03, "from practically zero"),
        (1e-9, 4e-6, "as large"),
        (0.03, 5e-6, "6000.0 times smaller"),
    ],
)
def test_better_and_worse_are_told_apart(before, after, text):
    """Circles with one peak, so G, |F| and the peak are that peak."""

    def result(height):
        circle = SimpleNamespace(circular_deviation=height, radial_low=0.0, radial_high=height, largest_peak=height)
        return VariantResult(Variant(False, height == after), (circle,), height, FEED)

    lines = list(comparison_lines(CircleTest(("X", "Y"), (0.0, 0.0), RADIUS, FEED, (result(before), result(after)))))
    changes = f"{1000 * before:9.2f} -> {1000 * after:.2f} µm, {text}"
    assert lines[1:] == [f"  {name:14}{changes}" for name in ("G", "largest |F|", "largest peak")]


@pytest.mark.long
@pytest.mark.parametrize(
    ("more", "files"),
    [([], ["run.mcap"]), (["--compare", "friction"], ["run_1.mcap", "run_2.mcap"])],
)
def test_the_runs_are_kept_and_replay_to_the_bit(more, files, tmp_path):
    """They show which feedforward and friction compensation were in force."""
    record = tmp_path / "run.mcap"
    result = call(
        "circle", MILL, "--radius", 5, "--feed", 6000, "--direction", "cw", "--feedforward", "--record", record, *more
    )
    assert result.exit_code == 0, result.output
    assert sorted(path.name for path in tmp_path.glob("*.mcap")) == files
    for number, file in enumerate(files):
        states = read_recording(tmp_path / file).states["/x/state"]
        assert states["feedforward_percent"][-1] == 100.0
        compensated = bool(states["status_bits"][-1] & 65536)
        assert compensated is (not more or number == 1)
        assert bool(np.any(states["friction_current"])) is compensated
        assert call("replay", tmp_path / file).exit_code == 0


def test_a_recording_that_would_overwrite_the_machine_is_refused():
    result = call("circle", MILL, "--radius", 5, "--feed", 6000, "--record", MILL)
    assert result.exit_code == 2
    assert f"P-ERR-27030 {MILL} would overwrite the machine file {MILL}; nothing was started" in result.stderr
