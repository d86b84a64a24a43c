"""`cnc_ptp curve fit`: tables, lines that a machine runs on, pictures, and what is refused."""

import math
import random
import re

import pytest
import yaml
from commands_support import MILL, call, changed_mill, paste

from cnc_ptp.commands.commissioning.curve_report import curve_yaml, rounded
from cnc_ptp.commissioning.curve_fit import curve_fault, fit_curve
from cnc_ptp.commissioning.curve_points import CurvePoint
from cnc_ptp.commissioning.faults import CURVE_RISES
from cnc_ptp.errors import CncError
from cnc_ptp.parameters import CurveParameters, ParameterError, read_machine
from cnc_ptp.plots.colours import DARK
from cnc_ptp.recording.reader import read_recording

POINTS = [(12_000, 16_000), (24_000, 8000), (36_000, 4000), (48_000, 2000)]
NUMBER = r"(-?\d+(?:\.\d+)?)"
ROW = re.compile(rf"\s*{NUMBER}\s+{NUMBER}\s+{NUMBER}\s+{NUMBER}\s+{NUMBER}\s+{NUMBER}(  below n_grenz, not fitted)?")


def options(points):
    return [word for speed, acceleration in points for word in ("--point", f"{speed}:{acceleration}")]


def fit(kind, points, *arguments):
    return call("curve", "fit", kind, *options(points), *arguments)


def rows(text):
    """The table: °/s, rpm, point, curve, off, off in %."""
    return [
        [float(word) for word in match.groups()[:6]] for line in text.splitlines() if (match := ROW.fullmatch(line))
    ]


def lines_of(text):
    """The lines for the machine file behind the table."""
    return yaml.safe_load(text.partition("\n\n")[2])


def spindle_machine(folder, **sections):
    """The mill with a spindle that turns up to 9000 rpm."""
    limits = {"0": {"dynamik": {"vb_max": 54_000_000}, **sections}}
    return changed_mill(folder / "spindle.yaml", "s", getriebe=limits)


def test_the_manual_s_polynomial_is_told_to_its_digits():
    """Page 44."""
    result = fit("polynomial", POINTS, "--a-min", 2000)
    assert result.exit_code == 0, result.output
    head = result.stdout.splitlines()[:7]
    assert head == [
        "Acceleration curve: polynomial through 4 points",
        "a = a_konst + b1·Δn + b2·Δn² + b3·Δn³ with Δn = n - n_grenz",
        "n_grenz  12000 °/s (2000 rpm)",
        "a_konst  16000 °/s²",
        "b1       -0.888888888889 1/s",
        "b2       2.08333333333e-05 1/°",
        "b3       -1.92901234568e-10 s/°²",
    ]
    assert rows(result.stdout) == [[n, n / 6.0, a, a, 0.0, 0.0] for n, a in POINTS]
    assert "warning" not in result.stdout


def test_the_manual_s_hyperbola_and_what_four_points_make_of_it():
    """Page 46: three points are its curve, the fourth lies 6 % beside; in the table when all are asked for."""
    three, four = fit("hyperbola", POINTS[:3]), fit("hyperbola", POINTS)
    assert three.stdout.splitlines()[4:7] == [
        "b1       22857.1428571 °/s²",
        "b2       0.416666666667",
        "b3       0.0285714285714",
    ]
    assert [row[4] for row in rows(three.stdout)] == [0.0, 0.0, 0.0]
    assert four.stdout.startswith("Acceleration curve: hyperbola least squares over 4 points\n")
    assert [row[4] for row in rows(four.stdout)] == [0.0, 22.255, -59.29, 48.746]


@pytest.mark.parametrize("kind", ["polynomial", "hyperbola"])
def test_a_machine_takes_the_lines_and_the_time_is_that_of_its_spindle(kind, tmp_path):
    """The coefficients come to the kernel as they are printed; speed reached after the time that was printed."""
    points = POINTS if kind == "polynomial" else POINTS[:3]
    result = fit(kind, points, "--a-min", 2000, "--top-speed", 36_000)
    assert result.exit_code == 0, result.output
    pasted = paste(spindle_machine(tmp_path), result.stdout.partition("\n\n")[2], tmp_path / "pasted.yaml")
    written = lines_of(result.stdout)["/s"]["ros__parameters"]["getriebe"]["0"]["beschl_kennlinie"]
    curve = read_machine(str(pasted)).spindles["s"].gears[1].curve
    b1, b2, b3 = (written[name] for name in ("b1", "b2", "b3"))
    assert curve == CurveParameters(kind, 2000.0, 12_000.0, 16_000.0, b1, b2, b3, 0.0, 0.0, 0.0)
    scenario, recording = tmp_path / "run.yaml", tmp_path / "run.mcap"
    scenario.write_text("- {at: 0, to: s, do: start, direction: cw, speed_rpm: 6000}\n")
    run = call("simulate", pasted, "--scenario", scenario, "--duration", 8, "--record", recording)
    assert run.exit_code == 0, run.output
    speeds = read_recording(recording).states["/s/state"]["set_speed_rpm"]
    told = float(re.search(r"from 0 to 36000 °/s in (\d+\.\d+) s", result.stdout)[1])
    assert math.ceil(1000.0 * told - 0.5) <= int((speeds < 6000.0).sum()) <= math.ceil(1000.0 * told + 0.5) + 1


def test_speeds_in_rpm_and_from_a_file_are_the_same_points(tmp_path):
    csv = tmp_path / "motor.csv"
    csv.write_text("speed_rpm,acceleration_deg_s2\n" + "".join(f"{n / 6},{a}\n" for n, a in POINTS))
    wanted = fit("polynomial", POINTS, "--top-speed", 54_000)
    rpm = fit("polynomial", [(n // 6, a) for n, a in POINTS], "--unit", "rpm", "--top-speed", 9000, "--limit", 2000)
    assert rpm.stdout == wanted.stdout
    assert call("curve", "fit", "polynomial", "--csv", csv, "--top-speed", 54_000).stdout == wanted.stdout


def test_points_below_the_limit_are_shown():
    result = fit("polynomial", [(6000, 15_000), *POINTS], "--limit", 12_000)
    assert result.exit_code == 0, result.output
    assert "below n_grenz, not fitted" in result.stdout.splitlines()[8]
    assert rows(result.stdout)[0] == [6000.0, 1000.0, 15_000.0, 16_000.0, 1000.0, 6.67]
    assert "warning: the curve lies +6.7 % off the point at 6000 °/s" in result.stdout


def test_what_deserves_a_look():
    result = fit("hyperbola", POINTS, "--a-min", 2500, "--top-speed", 60_000)
    assert [line for line in result.stdout.splitlines() if line.startswith("warning")] == [
        "warning: a_min 2500 °/s² (P-AXIS-00010) is above the point at 48000 °/s, the drive has 2000 °/s² there",
        "warning: no point lies between 48000 °/s and the largest speed 60000 °/s",
    ]


def test_gear_spindle_and_file_of_the_lines(tmp_path):
    output = tmp_path / "curve.yaml"
    result = fit("polynomial", POINTS, "--spindle", "main", "--gear", 2, "-o", output)
    assert result.stdout.splitlines()[-1] == f"{output}: to be pasted into the machine file"
    assert "ros__parameters" not in result.stdout
    curve = yaml.safe_load(output.read_text())["/main"]["ros__parameters"]["getriebe"]["2"]["beschl_kennlinie"]
    assert list(curve) == ["typ", "n_grenz", "a_konst", "a_min", "b1", "b2", "b3"]
    assert (curve["typ"], curve["n_grenz"], curve["a_konst"], curve["a_min"]) == (2, 12_000_000, 16_000, 0)


def test_pictures(tmp_path):
    pictures = [tmp_path / f"curve.{kind}" for kind in ("svg", "png", "html")]
    outputs = [word for picture in pictures for word in ("-o", picture)]
    result = fit("polynomial", POINTS, "--a-min", 2000, *outputs)
    assert result.exit_code == 0, result.output
    svg, png, page = (picture.read_bytes() for picture in pictures)
    for text in (b"speed in rpm", b"n_grenz", b"a_min", b"polynomial through 4 points"):
        assert text in svg
    style, body = svg.decode().split("</style>")
    assert "prefers-color-scheme: dark" in style
    assert set(re.findall(r"#[0-9a-f]{6}", body)) <= set(DARK)
    assert png.startswith(b"\x89PNG\r\n")
    assert page.startswith(b"<!DOCTYPE html>")
    assert "b3       -1.92901234568e-10 s/°²" in page.decode()
    fit("polynomial", POINTS, "--a-min", 2000, "-o", tmp_path / "again.svg")
    assert (tmp_path / "again.svg").read_bytes() == svg


def test_a_curve_that_no_spindle_can_run_on_is_shown_but_not_written(tmp_path):
    """A pole: the table and the picture help to see why; status 1, no lines."""
    picture, lines = tmp_path / "pole.html", tmp_path / "pole.yaml"
    points = [(1000, 800), (2000, 800 / 0.85), (3000, 800 / 0.6)]
    result = fit("hyperbola", points, "--top-speed", 5000, "-o", picture, "-o", lines)
    text = "P-ERR-27049 the hyperbola has a pole at 4582.58 °/s, below the largest speed 5000 °/s; no lines for the machine file were made\n"
    assert (result.exit_code, result.stderr) == (1, text)
    assert len(rows(result.stdout)) == 3
    assert "from 0 to" not in result.stdout
    assert picture.exists() and not lines.exists()


def as_written(curve):
    """With the digits of the lines for the machine file."""
    return curve._replace(b1=rounded(curve.b1), b2=rounded(curve.b2), b3=rounded(curve.b3))


@pytest.mark.long
def test_what_the_command_accepts_the_machine_accepts(tmp_path):
    """Random points, some with a floor: the same verdict about poles and zeros; only a rise is refused here alone."""
    draw, verdicts = random.Random(22), []
    template = {"getriebe": {"0": {"dynamik": {"vb_max": 5_000_000}, "vb_eilgang": 600_000, "vb_reflow": 200_000}}}
    machine = changed_mill(tmp_path / "spindle.yaml", "s", **template)
    while len(verdicts) < 40:
        kind = draw.choice(["polynomial", "hyperbola"])
        accelerations = [draw.uniform(100.0, 2000.0) for _ in range(4)]
        points = [CurvePoint(1000.0 * n, a) for n, a in enumerate(accelerations, start=1)]
        try:
            found = fit_curve(kind, points, top_speed=5000.0, minimum=float(draw.choice([0, 50])))
        except CncError:
            continue
        fault = curve_fault(found)
        pasted = paste(machine, curve_yaml(found, "s", 0), tmp_path / "pasted.yaml")
        if fault is None or fault.number == CURVE_RISES:
            assert read_machine(str(pasted)).spindles["s"].gears[1].curve == as_written(found.parameters)
        else:
            with pytest.raises(ParameterError, match=f"the {kind} gives .* °/s² at"):
                read_machine(str(pasted))
        verdicts.append(fault and fault.number)
    assert {None, 27048, 27049, 27050} <= set(verdicts)


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        (["--point", "12000"], "P-ERR-27041 point '12000': it is not SPEED:ACCELERATION, two numbers; nothing was fitted\n"),
        (options(POINTS[:3]), "P-ERR-27044 the polynomial needs a point at the limit speed and 3 above it, 2 above it given; nothing was fitted\n"),
        (["--csv", "/nowhere.csv"], "P-ERR-26110 point file /nowhere.csv cannot be read: No such file or directory; nothing was started\n"),
        ([*options(POINTS), "-o", "curve.pdf"], "P-ERR-27030 curve.pdf: its name must end in .svg, .png or .html (picture), .yaml or .yml (lines for the machine file); nothing was started\n"),
        ([*options(POINTS), "--spindle", "s 1"], "P-ERR-27051 spindle name 's 1' must be lower-case letters, digits and _, beginning with a letter; nothing was fitted\n"),
        ([*options(POINTS), "--spindle", ""], "P-ERR-27051 spindle name '' must be lower-case letters, digits and _, beginning with a letter; nothing was fitted\n"),
        ([*options(POINTS), "--spindle", "plc"], "P-ERR-27051 spindle name 'plc' is taken by another node; nothing was fitted\n"),
        ([*options(POINTS), "-o", "/nowhere/a.yaml"], "P-ERR-27030 /nowhere/a.yaml cannot be written: there is no folder /nowhere, make it or give another name; nothing was started\n"),
    ],
)  # fmt: skip
def test_refused(arguments, text):
    result = call("curve", "fit", "polynomial", *arguments)
    assert (result.exit_code, result.stderr, result.stdout) == (2, text, "")


def test_the_points_are_not_overwritten(tmp_path):
    csv = tmp_path / "points.yaml"
    csv.write_text("speed_rpm,acceleration_deg_s2\n")
    result = call("curve", "fit", "polynomial", "--csv", csv, "-o", csv)
    text = f"P-ERR-27030 {csv} would overwrite the point file {csv}; nothing was started\n"
    assert (result.exit_code, result.stderr) == (2, text)


@pytest.mark.parametrize(
    "arguments",
    [[], [*options(POINTS), "--csv", MILL], [*options(POINTS), "--a-min", -1], [*options(POINTS), "--gear", 6]],
)
def test_wrong_usage(arguments):
    result = call("curve", "fit", "polynomial", *arguments)
    assert result.exit_code == 2 and "Usage:" in result.stderr


def test_help_says_how_many_points():
    text = " ".join(call("curve", "fit", "--help").output.split())
    assert (
        "3 points make the polynomial and 2 the hyperbola, exactly; with more of them the curve is the least squares"
        in text
    )
