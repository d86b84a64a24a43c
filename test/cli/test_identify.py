"""`cnc_ptp identify`: from the simulated plant, from recordings, and what is refused."""

import math
import re

import numpy as np
import pytest
import yaml
from commands_support import MILL, PTP, call, changed_mill, paste, recording_of
from long_support import long_sets

from cnc_ptp.parameters import load_machine, read_machine
from cnc_ptp.parameters.check.stability import stability_limit
from cnc_ptp.recording.reader import read_recording


def plant_friction(machine, axis, speed):
    """Coulomb + Stribeck + viscous friction of the simulated plant, Nm at mm/s."""
    plant = read_machine(str(machine)).axes[axis].control.plant
    stribeck = (plant.static - plant.coulomb) * math.exp(-((speed / plant.stribeck_velocity) ** 2))
    return plant.coulomb + stribeck + plant.viscous * speed


def table_of(machine, axis):
    """Velocities in mm/s and torques in Nm of a machine's compensation table."""
    control = read_machine(str(machine)).axes[axis].control
    return control.friction.velocities, [current / control.scaling.torque for current in control.friction.currents]


@pytest.fixture(scope="module")
def friction_run(tmp_path_factory):
    """The friction of x at five speeds: result, machine file with the table, recording of the run."""
    folder = tmp_path_factory.mktemp("friction")
    speeds = [word for speed in (0.2, 1.5, 4, 50, 400) for word in ("--velocity", speed)]
    table, recording = folder / "table.yaml", folder / "run.mcap"
    result = call("identify", "friction", "x", "--machine", MILL, "-o", table, "--record", recording, *speeds)
    return result, table, recording, folder


def test_the_table_is_the_curve_of_the_plant(friction_run):
    result, table, _, folder = friction_run
    assert result.exit_code == 0, result.output
    pasted = paste(MILL, table.read_text(), folder / "pasted.yaml")
    velocities, torques = table_of(pasted, "x")
    assert velocities == (0.2, 1.5, 4.0, 50.0, 400.0)
    for speed, torque in zip(velocities, torques, strict=True):
        assert torque == pytest.approx(plant_friction(MILL, "x", speed), rel=0.03)
    friction = read_machine(str(pasted)).axes["x"].control.friction
    assert friction.active


def test_what_is_printed_says_what_was_measured(friction_run):
    result, table, _, _ = friction_run
    lines = result.stdout.splitlines()
    assert lines[0].split() == [
        "v",
        "mm/s",
        "M(+v)",
        "Nm",
        "M(-v)",
        "Nm",
        "friction",
        "Nm",
        "scatter",
        "load",
        "Nm",
        "time",
        "s",
    ]
    assert [float(line.split()[0]) for line in lines[1:6]] == [0.2, 1.5, 4.0, 50.0, 400.0]
    for line in lines[1:6]:
        speed, forth, back, friction, scatter, load, seconds = map(float, line.split())
        assert friction == pytest.approx((forth - back) / 2, abs=1e-4)
        assert (
            abs(load) < 0.01
            and scatter < 0.01
            and seconds == pytest.approx(2 * min(0.5, max(0.1, 50 / speed)), abs=0.01)
        )
    assert lines[-1] == f"{table}: to be pasted into the machine file"
    assert table.read_text().startswith(f"# Friction of axis x, from 5 speeds in both directions in a run of {MILL}.\n")


def test_the_recording_of_the_run_gives_the_same_table(friction_run):
    _, table, recording, folder = friction_run
    again = folder / "again.yaml"
    result = call("identify", "friction", "x", "--recording", recording, "--machine", MILL, "-o", again)
    assert result.exit_code == 0, result.output
    assert yaml.safe_load(again.read_text()) == yaml.safe_load(table.read_text())
    assert (
        call("identify", "friction", "x", "--recording", recording, "-o", again).exit_code == 0
    )  # its own machine file
    assert yaml.safe_load(again.read_text()) == yaml.safe_load(table.read_text())


def test_a_recording_tells_what_it_lacks_and_the_scenario_drives_it(friction_run, tmp_path):
    _, _, recording, _ = friction_run
    result = call("identify", "friction", "x", "--recording", recording)
    lines = result.stdout.splitlines()
    missing = next(line for line in lines if line.startswith("missing speeds: "))
    shown = missing.removeprefix("missing speeds: ").removesuffix(" mm/s; this scenario drives them:")
    speeds = [float(word) for word in shown.split(", ")]
    assert all(
        min(abs(math.log(speed / found)) for found in (0.2, 1.5, 4.0, 50.0, 400.0)) > math.log(1.6) for speed in speeds
    )
    scenario = [line for line in lines if line.startswith("- {at: ")]
    assert len(scenario) == 2 * len(speeds)
    path = tmp_path / "missing.yaml"
    path.write_text("\n".join(scenario[:6]))
    run = call("simulate", MILL, "--scenario", path, "--record", tmp_path / "missing.mcap")
    assert run.exit_code == 0 and "refused" not in run.output
    found = call("identify", "friction", "x", "--recording", tmp_path / "missing.mcap")
    assert [float(line.split()[0]) for line in found.stdout.splitlines()[1:4]] == speeds[:3]


def test_the_table_is_printed_without_an_output_file(friction_run):
    _, table, recording, _ = friction_run
    result = call("identify", "friction", "x", "--recording", recording)
    printed = result.stdout[result.stdout.index("# Friction of axis x") :]
    assert yaml.safe_load(printed) == yaml.safe_load(table.read_text())


def test_the_run_is_without_compensation_and_replays_to_the_bit(friction_run):
    _, _, recording, _ = friction_run
    states = read_recording(recording).states["/x/state"]
    assert not np.any(states["friction_current"]) and not np.any(states["error_id"])
    assert call("replay", recording).exit_code == 0


def test_the_drive_of_z_is_a_first_order_lag_of_3_ms(tmp_path):
    """z has no friction: Ta, Kv = 1 / (4 (Ta + T/2)) and inertia come out exactly."""
    path = tmp_path / "z.yaml"
    result = call("identify", "dynamics", "z", "--machine", MILL, "-o", path)
    assert result.exit_code == 0, result.output
    lines = {line[:20].strip(): line[20:] for line in result.stdout.splitlines()}
    assert lines["time constant Ta"] == "3.000 ± 0.000 ms"
    assert lines["gain"].startswith("1.0000 ")
    assert lines["Kv proposed"] == "71.4 1/s (damping 1)"
    assert lines["Kv now"] == "50 1/s (P-AXIS-00099)"
    written = yaml.safe_load(path.read_text())["/z"]["ros__parameters"]
    assert written["getriebe"]["0"]["kv"] == 7143
    assert written["getriebe"]["0"]["load"] == pytest.approx(0.0015, rel=1e-3)
    assert written["vorsteuer"] == {"vs_a_faktor": 3000, "vs_a_nenner": 1}
    pasted = read_machine(str(paste(MILL, path.read_text(), tmp_path / "pasted.yaml"))).axes["z"].control
    assert pasted.kv == 71.43 and pasted.feedforward.time_constant == 0.003


@pytest.mark.parametrize(
    ("velocity", "torque"),
    [([], ["S-0-0084"]), (["S-0-0040"], []), ([], []), (["S-0-0040"], ["S-0-0084"])],
)
def test_whatever_the_telegram_carries_back_the_drive_is_the_same(velocity, torque, tmp_path):
    """Without S-0-0040 the actual velocity is the way of the last cycle, half a cycle older."""
    telegram = {"commands": ["S-0-0036"], "feedback": ["S-0-0051", *velocity, *torque]}
    antr = {"telegram": telegram, "v_reso_num": 10000, "v_reso_denom": 10000}
    machine = changed_mill(tmp_path / "sercos.yaml", "z", kenngr={"antr_typ": 2}, antr=antr)
    path = tmp_path / "z.yaml"
    result = call("identify", "dynamics", "z", "--machine", machine, "-o", path)
    assert result.exit_code == 0, result.output
    lines = {line[:20].strip(): line[20:] for line in result.stdout.splitlines()}
    assert float(lines["time constant Ta"].split()[0]) == pytest.approx(3.0, abs=0.01)
    assert lines["dead time"] == "0 cycles (0 ms)"
    gear = yaml.safe_load(path.read_text())["/z"]["ros__parameters"]["getriebe"]["0"]
    assert ("load" in gear) == bool(torque)
    assert gear.get("load", 0.0015) == pytest.approx(0.0015, rel=0.005)


def test_the_cascaded_drive_of_x_with_friction(tmp_path):
    path, recording = tmp_path / "x.yaml", tmp_path / "x.mcap"
    result = call("identify", "dynamics", "x", "--machine", MILL, "-o", path, "--record", recording)
    assert result.exit_code == 0, result.output
    assert "warning" not in result.stdout
    written = yaml.safe_load(path.read_text())["/x"]["ros__parameters"]
    assert written["vorsteuer"]["vs_a_faktor"] == pytest.approx(3000, rel=0.02)
    assert written["getriebe"]["0"]["load"] == pytest.approx(0.002, rel=0.01)
    # Seen from outside the limit is a guess, but no wild one; the proposal is far below.
    limit = float(re.search(r"Kv limit +about (\d+) 1/s", result.stdout)[1])
    axis = read_machine(str(MILL)).axes["x"].control
    assert 0.5 < limit / stability_limit(axis.plant, 0.001) < 1.5
    assert written["getriebe"]["0"]["kv"] < 100 * limit / 3
    again = call("identify", "dynamics", "x", "--recording", recording)
    assert yaml.safe_load(again.stdout[again.stdout.index("# Drive of axis x") :]) == yaml.safe_load(path.read_text())


@pytest.mark.parametrize(("speed", "heavier"), [(5, False), *long_sets([(20, True)])])
def test_a_recording_of_slow_motions_says_that_its_results_are_rough(speed, heavier, tmp_path):
    """Friction shapes slow motions: Ta is off, the inertia may be, but not farther than they say."""
    recording, path = tmp_path / "slow.mcap", tmp_path / "x.yaml"
    run = call("identify", "friction", "x", "--machine", MILL, "--velocity", speed, "--record", recording)
    result = call("identify", "dynamics", "x", "--recording", recording, "-o", path)
    assert (run.exit_code, result.exit_code) == (0, 0)
    lines = {line[:20].strip(): line[20:] for line in result.stdout.splitlines()}
    found, plus_minus = map(float, re.match(r"(\S+) ± (\S+) ms$", lines["time constant Ta"]).groups())
    assert 0.3 < found - 3.0 < plus_minus
    if heavier:
        found, plus_minus = map(float, re.match(r"(\S+) ± (\S+) kg·m² ", lines["inertia"]).groups())
        assert abs(found - 0.002) <= plus_minus
    else:
        text = "not found: no torque in the recording, too little acceleration, or friction hides it"
        assert lines["inertia"] == text and "load:" not in path.read_text()
    misfit = float(lines["misfit"].split()[0])
    rough = (
        f"axis x: rough results: misfit {misfit:.2f} % (above 1 %: friction or limits shape the motion besides the drive), "
        f"highest velocity {speed} mm/s (below 10 % of the 500 mm/s that the axis can reach); check them with a faster "
        "recording"
    )
    assert next(line for line in result.stdout.splitlines() if line.startswith("warning")) == f"warning: {rough}"
    assert f"# warning: {rough}\n" in path.read_text()


def test_bus_delay_shows_as_dead_time(tmp_path):
    machine = changed_mill(tmp_path / "late.yaml", "z", simulation={"bus_delay_cycles": 3})
    result = call("identify", "dynamics", "z", "--machine", machine)
    assert "dead time           3 cycles (3 ms)" in result.stdout
    assert "vs_a_faktor: 6000" in result.stdout


def test_a_gain_near_the_limit_is_warned_about(tmp_path):
    fast = changed_mill(tmp_path / "fast.yaml", "z", getriebe={"0": {"kv": 20000}})
    result = call("identify", "dynamics", "z", "--machine", fast)
    assert "warning: axis z: Kv 200 1/s is above 142.9 1/s; the axis overshoots" in result.stdout


@pytest.mark.parametrize("kind", ["friction", "dynamics"])
@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        (
            ["q", "--machine", MILL],
            f"P-ERR-27001 q is no axis of the machine {MILL}; nothing was started. Axes: x, y, z",
        ),
        (
            ["X", "--machine", MILL],
            f"P-ERR-27001 X is no axis of the machine {MILL}, did you mean x? nothing was started. Axes: x, y, z",
        ),
        (
            ["s", "--machine", MILL],
            f"P-ERR-27001 s is a spindle of the machine {MILL}; nothing was started. Axes: x, y, z",
        ),
        (
            ["x", "--machine", "nowhere.yaml"],
            "P-ERR-26110 machine file nowhere.yaml cannot be read: No such file or directory; nothing was started",
        ),
        (
            ["x", "--recording", "nowhere.mcap"],
            "P-ERR-26001 recording nowhere.mcap: cannot be opened: No such file or directory; nothing was read, check the path",
        ),
        (
            ["x", "--machine", MILL, "-o", "/nowhere/t.yaml"],
            "P-ERR-27030 /nowhere/t.yaml cannot be written: there is no folder /nowhere, make it or give another name; "
            "nothing was started",
        ),
        (
            ["x", "--machine", MILL, "-o", MILL],
            f"P-ERR-27030 {MILL} would overwrite the machine file {MILL}; nothing was started",
        ),
        (
            ["x", "--machine", MILL, "--record", MILL],
            f"P-ERR-27030 {MILL} would overwrite the machine file {MILL}; nothing was started",
        ),
    ],
)
def test_refused_before_anything_starts(kind, arguments, text):
    result = call("identify", kind, *arguments)
    assert (result.exit_code, result.stderr.strip()) == (2, text)


@pytest.mark.parametrize("kind", ["friction", "dynamics"])
def test_both_outputs_in_one_file(kind, tmp_path):
    path, other, link = tmp_path / "o.yaml", tmp_path / "sub" / ".." / "o.yaml", tmp_path / "link.yaml"
    other.parent.parent.mkdir()
    link.symlink_to(path)
    for record in (path, other, link):
        result = call("identify", kind, "x", "--machine", MILL, "-o", path, "--record", record)
        text = f"P-ERR-27030 {record} would overwrite the output file {path}; nothing was started\n"
        assert (result.exit_code, result.stdout, result.stderr) == (2, "", text)
    assert not path.exists()


@pytest.mark.parametrize("kind", ["friction", "dynamics"])
def test_wrong_usage(kind):
    result = call("identify", kind, "x")
    assert result.exit_code == 2 and "--machine (drives the axis offline) or --recording is needed." in result.stderr
    result = call("identify", kind, "x", "--recording", "a.mcap", "--record", "b.mcap")
    assert result.exit_code == 2 and "--record and --recording exclude each other" in result.stderr
    assert call("identify", kind).exit_code == 2


def test_a_table_of_one_point_is_warned_about():
    line = "warning: the table has one point, its friction counts at all velocities; drive more of them"
    result = call("identify", "friction", "x", "--machine", MILL, "--velocity", 5)
    assert result.exit_code == 0 and result.stdout.splitlines().count(line) == 1
    result = call("identify", "friction", "x", "--machine", MILL, "--velocity", 5, "--velocity", 50)
    assert result.exit_code == 0 and "one point" not in result.output


def test_velocities_are_for_a_run():
    result = call("identify", "friction", "x", "--recording", "a.mcap", "--velocity", 7)
    assert result.exit_code == 2 and result.stderr.endswith(
        "\nError: --velocity and --recording exclude each other: a recording is evaluated without a run.\n"
    )


@pytest.mark.parametrize("kind", ["friction", "dynamics"])
def test_a_machine_file_that_is_not_that_of_the_recording(kind, tmp_path):
    """Units, ranges and scales would be those of another axis; the same text, or one for a recording without, is fine."""
    path = standing(tmp_path / "a.mcap")
    for machine in (PTP, changed_mill(tmp_path / "m.yaml", "x")):
        result = call("identify", kind, "x", "--recording", path, "--machine", machine)
        text = (
            f"P-ERR-27040 recording {path} was made with another machine file than {machine}; nothing was made, leave "
        )
        assert (result.exit_code, result.stdout, result.stderr) == (2, "", f"{text}--machine out\n")
    assert "does not move" in call("identify", kind, "x", "--recording", path, "--machine", MILL).stderr
    path = standing(tmp_path / "b.mcap", machine="")
    assert "does not move" in call("identify", kind, "x", "--recording", path, "--machine", MILL).stderr


@pytest.mark.parametrize("option", ["--help", "-h"])
@pytest.mark.parametrize("kind", ["friction", "dynamics"])
def test_help(kind, option):
    result = call("identify", kind, option)
    assert result.exit_code == 0 and "Usage:" in result.output


def standing(path, axis="x", machine=None):
    return recording_of(
        path, axis, {"set_position": np.zeros(500)}, machine=MILL.read_text() if machine is None else machine
    )


@pytest.mark.parametrize("kind", ["friction", "dynamics"])
def test_recordings_that_are_no_use(kind, tmp_path):
    path = tmp_path / "a.mcap"
    standing(path)
    result = call("identify", kind, "x", "--recording", path)
    assert (result.exit_code, result.stderr) == (
        2,
        "P-ERR-27004 axis x: does not move in the recorded 0.5 s; nothing was made\n",
    )
    result = call("identify", kind, "y", "--recording", path)
    text = f"P-ERR-27002 recording {path} holds no states of axis y; nothing was made. Axes in it: x\n"
    assert (result.exit_code, result.stderr) == (2, text)
    standing(path, machine="")
    result = call("identify", kind, "x", "--recording", path)
    text = f"P-ERR-27040 recording {path} holds no machine file; nothing was made, give --machine\n"
    assert (result.exit_code, result.stderr) == (2, text)
    result = call("identify", kind, "x", "--recording", path, "--machine", MILL, "-o", path)
    assert result.stderr == f"P-ERR-27030 {path} would overwrite the recording {path}; nothing was started\n"
    path.write_bytes(b"no mcap")
    result = call("identify", kind, "x", "--recording", path)
    assert result.exit_code == 2 and result.stderr.startswith("P-ERR-2600")


def test_a_torque_in_coarse_steps_is_warned_about(tmp_path):
    """10 digits at 4 Nm: 0.948 Nm are 2 digits, 0.8 Nm, however steady they are."""
    telegram = {"commands": ["S-0-0036", "S-0-0081"], "feedback": ["S-0-0051", "S-0-0084"]}
    antr = {"torque_scale_num": 10, "telegram": telegram, "v_reso_num": 10000, "v_reso_denom": 10000}
    machine = changed_mill(tmp_path / "coarse.yaml", "x", kenngr={"antr_typ": 2}, antr=antr)
    path = tmp_path / "x.yaml"
    speeds = ["--velocity", 2, "--velocity", 300]
    result = call("identify", "friction", "x", "--machine", machine, "-o", path, *speeds)
    assert result.exit_code == 0, result.output
    for line in result.stdout.splitlines()[1:3]:
        speed, _, _, friction, scatter, _, _ = map(float, line.split())
        assert abs(friction - plant_friction(machine, "x", speed)) <= scatter == 0.2
    warning = (
        "warning: axis x: scatter above 3 % of the friction at 2, 300 mm/s; half a digit of the torque, which counts as "
        "scatter, is 0.2 Nm there: more digits per Nm in drive and P-AXIS-00325, 00326, 00392"
    )
    assert result.stdout.splitlines()[3] == warning
    assert f"# {warning}\n" in path.read_text()


def test_a_torque_that_scatters_is_warned_about(tmp_path):
    speeds = np.concatenate([np.r_[np.zeros(100), np.full(700, v), np.zeros(100)] for v in (5, -5, 20, -20)])
    noise = np.where(np.abs(speeds) == 5.0, 1.0, 0.01) * np.random.default_rng(1).standard_normal(len(speeds))
    columns = {"set_velocity": speeds, "actual_velocity": speeds, "actual_torque": 0.8 * np.sign(speeds) + noise}
    columns["actual_position"] = np.cumsum(speeds) * 1e-3
    path = recording_of(tmp_path / "a.mcap", "x", columns, machine=MILL.read_text())
    result = call("identify", "friction", "x", "--recording", path)
    assert result.exit_code == 0, result.output
    text = "axis x: scatter above 3 % of the friction at 5 mm/s; measure longer, or without disturbances"
    assert f"warning: {text}" in result.stdout.splitlines()
    assert f"# warning: {text}" in result.stdout.splitlines()


@pytest.mark.long
def test_axes_without_friction_have_no_table():
    """z has a drive of first order: what its torque shows at constant velocity is rounding."""
    result = call("identify", "friction", "z", "--machine", MILL)
    text = (
        r"P-ERR-27008 axis z: no friction was found: the largest torque at constant velocity is \d\S*e-\d+, below half a digit "
        r"of the finest table \(2e-06 with P-COMP-00045 = 1\); no table was made\n"
    )
    assert (result.exit_code, result.stdout) == (2, "")
    assert re.fullmatch(text, result.stderr)


def test_a_speed_without_friction_is_named(tmp_path):
    """A recording in which the torque at 20 mm/s acts forwards both ways: less friction than none."""
    speeds = np.concatenate([np.r_[np.zeros(100), np.full(700, v), np.zeros(100)] for v in (5, -5, 20, -20)])
    torque = np.where(np.abs(speeds) == 5.0, 0.8, -0.1) * np.sign(speeds)
    columns = {"set_velocity": speeds, "actual_velocity": speeds, "actual_torque": torque}
    columns["actual_position"] = np.cumsum(speeds) * 1e-3
    path = recording_of(tmp_path / "a.mcap", "x", columns, machine=MILL.read_text())
    result = call("identify", "friction", "x", "--recording", path)
    assert result.exit_code == 0, result.output
    assert "left out, no friction there (0 or less): 20 mm/s" in result.stdout.splitlines()
    written = yaml.safe_load(result.stdout[result.stdout.index("# Friction of axis x") :])
    assert written["/x"]["ros__parameters"]["frict_comp"]["table"] == {"0": {"in": 5000, "out": 2000}}
    assert written["/x"]["ros__parameters"]["frict_comp"]["scaling_factor"] == 100


def test_speeds_that_cannot_be_driven():
    result = call("identify", "friction", "x", "--machine", MILL, "--velocity", 501)
    text = "P-ERR-27011 axis x: the velocity 501 mm/s is not above 0 and up to 500 mm/s (P-AXIS-00212); nothing was started\n"
    assert (result.exit_code, result.stderr) == (2, text)


def test_a_trial_is_no_faster_than_the_following_error_allows(tmp_path):
    strict = changed_mill(tmp_path / "strict.yaml", "x", getriebe={"0": {"slep_max": 20000}})
    result = call("identify", "friction", "x", "--machine", strict, "--velocity", 80)
    text = (
        "P-ERR-27011 axis x: the velocity 80 mm/s is not above 0 and up to 75 mm/s (there the lag is 75 % of P-AXIS-00168); "
        "nothing was started\n"
    )
    assert (result.exit_code, result.stderr) == (2, text)


def test_a_run_that_fails_is_status_1_and_tells_why(tmp_path):
    """A drive that is weaker than the friction of its axis."""
    weak = changed_mill(tmp_path / "weak.yaml", "x", simulation={"torque_limit": 0.5})
    for kind in ("friction", "dynamics"):
        result = call("identify", kind, "x", "--machine", weak)
        assert result.exit_code == 1
        assert "error: P-ERR-17744 axis x: following error" in result.stderr
        assert result.stdout == ""


@pytest.mark.parametrize(
    ("kind", "commands", "reason"),
    [
        (16, None, "is virtual, there is no drive to identify (P-AXIS-00020)"),
        (8, ["607A"], "its drive closes the position loop itself and is commanded positions (P-AXIS-00020)"),
        (
            3,
            ["XERR", "NSOLL_B"],
            "its drive closes the position loop itself and is commanded the following error (P-AXIS-00020)",
        ),
        (8, ["6071"], "its drive is commanded torques and has no velocity loop to identify (P-MACH-00020)"),
    ],
)
def test_drives_without_velocity_command_are_refused(kind, commands, reason, tmp_path):
    antr = {"telegram": {"commands": commands}} if commands else {}
    changes = {"kenngr": {"antr_typ": kind}, "antr": antr, "vorsteuer": {"vorsteuerung": "NONE"}}
    result = call("identify", "dynamics", "z", "--machine", changed_mill(tmp_path / "z.yaml", "z", **changes))
    text = f"P-ERR-27014 axis z: {reason}; nothing was started\n"
    assert (result.exit_code, result.stdout, result.stderr) == (2, "", text)


def test_an_axis_that_is_switched_off_gets_its_enable(tmp_path):
    machine = changed_mill(tmp_path / "off.yaml", "z", simulation={"powered_at_start": False})
    load_machine(machine.read_text(), "off.yaml")
    assert call("identify", "dynamics", "z", "--machine", machine).exit_code == 0


def test_an_ideal_rotary_axis():
    result = call("identify", "dynamics", "c", "--machine", PTP)
    assert result.exit_code == 0, result.output
    assert "time constant Ta    0.000 ± 0.000 ms" in result.stdout
    assert "kg·m² (P-AXIS-00391)" in result.stdout


@pytest.mark.parametrize("what", ["friction", "dynamics"])
def test_a_recording_that_was_cut_off_is_told(what, friction_run, tmp_path):
    """Half a file: what is there is evaluated, and the user knows."""
    _, _, recording, _ = friction_run
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(recording.read_bytes()[: recording.stat().st_size * 2 // 3])
    result = call("identify", what, "x", "--recording", cut, "--machine", MILL)
    missing = read_recording(cut).missing
    assert missing
    assert f"warning: {cut} was cut off ({missing}); only what it holds is evaluated" in result.stderr
    whole = call("identify", what, "x", "--recording", recording)
    assert "was cut off" not in whole.output + whole.stderr
