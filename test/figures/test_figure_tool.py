"""The tool that makes figures of scenarios: heads, refusals, pictures, command line."""

import re
from dataclasses import replace
from pathlib import Path

import pytest
from click.testing import CliRunner
from figure_support import SCENARIOS, head_and_scenario, run_of, texts_of
from machine_support import MachineBench

from cnc_ptp.plots.colours import BAND, DARK
from cnc_ptp.plots.panels import UNIT_KINDS
from cnc_ptp.plots.sheet import number, wrapped
from cnc_ptp.plots.svg import svg_text
from figures import __main__ as command
from figures.external_profile import FILE, csv_text
from figures.kinds import KINDS, draw
from figures.picture import label_rows
from figures.run import DrawnUnit, Marker, run_figure
from figures.scenario_head import ROOT, FigureError, FigureScenario, read_head

HEAD = {"title": "A move", "caption": "One millimetre.", "machine": "config/ptp.yaml", "axes": "x"}
MOVE = "- {at: 0.05, to: x, do: move_absolute, target: 1}\n"
PICTURES = ROOT / "docs" / "figures"
PANELS = ["position in mm", "velocity in mm/s", "acceleration in mm/s²", "following error in mm", "time in s"]


def written(folder: Path, head: dict[str, str], scenario: str = MOVE) -> Path:
    return head_and_scenario(folder, head, scenario)


def fault_of(file: Path) -> str:
    with pytest.raises(FigureError) as caught:
        run_figure(read_head(file))
    return str(caught.value)


# heads


def test_head_gives_title_caption_machine_and_axes(tmp_path):
    file = tmp_path / "two_axes.yaml"
    file.write_text(
        "# title: Two: axes\n# caption: The first line\n#   and the second: both.\n# machine: config/ptp.yaml\n# axes: x, y\n"
        f"{MOVE}# caption: not in the head\n"
    )
    caption = "The first line and the second: both."
    assert read_head(file) == FigureScenario(file, "Two: axes", caption, "config/ptp.yaml", ("x", "y"))
    assert read_head(file).name == "two_axes"


@pytest.mark.parametrize("key", HEAD)
def test_head_without_a_key(tmp_path, key):
    head = {name: value for name, value in HEAD.items() if name != key}
    where = "figure move.yaml: the head (comment lines at the top of the file) has no"
    assert fault_of(written(tmp_path, head)) == f"{where} '{key}: ...'; no picture was drawn"
    assert fault_of(written(tmp_path, {**HEAD, key: ""})) == f"{where} '{key}: ...'; no picture was drawn"


def test_head_with_an_unknown_key(tmp_path):
    keys = "title, caption, machine, axes, panels, program, plc, signals, kind, turns, over, points, errors"
    expected = f"'axis: x' in the head is not one of {': ..., '.join(keys.split(', '))}: ..."
    assert fault_of(written(tmp_path, {**HEAD, "axis": "x"})) == f"figure move.yaml: {expected}; no picture was drawn"


def test_head_with_a_key_twice(tmp_path):
    file = written(tmp_path, HEAD, "# title: Another\n" + MOVE)
    assert fault_of(file) == "figure move.yaml: 'title' occurs twice in the head; no picture was drawn"


# runs


def test_file_that_cannot_be_read(tmp_path):
    file = tmp_path / "move.yaml"
    reason = f"P-ERR-26110 scenario {file} cannot be read: No such file or directory; nothing was started"
    assert fault_of(file) == f"figure move.yaml: {reason}; no picture was drawn"


def test_axis_that_the_machine_does_not_have(tmp_path):
    expected = (
        "figure move.yaml: axis 'w' does not exist in config/ptp.yaml, known are x, y, z, c; no picture was drawn"
    )
    assert fault_of(written(tmp_path, {**HEAD, "axes": "w"})) == expected


def test_machine_that_does_not_exist(tmp_path):
    text = fault_of(written(tmp_path, {**HEAD, "machine": "config/no_such_machine.yaml"}))
    assert text.startswith("figure move.yaml: P-ERR-")
    assert "config/no_such_machine.yaml" in text


def test_scenario_with_an_unknown_command(tmp_path):
    text = fault_of(written(tmp_path, HEAD, "- {at: 0, to: x, do: jump}\n"))
    assert "move.yaml:5: axis x: unknown command 'jump'" in text


def test_a_refused_command_is_no_figure(tmp_path):
    text = fault_of(written(tmp_path, HEAD, MOVE + "- {at: 0.06, to: x, do: set_override, percent: 101}\n"))
    assert text.startswith("figure move.yaml: P-ERR-23006 axis x: set_override refused: percent = 101.0 ")
    assert text.endswith("; nothing was changed; no picture was drawn")


def test_a_fault_is_no_figure(tmp_path):
    silence = "- {at: 0.06, to: plc, do: set_life_sign, enabled: off}\n"
    text = fault_of(written(tmp_path, HEAD, "- {at: 0.05, to: x, do: move_absolute, target: 5000}\n" + silence))
    assert text.startswith("figure move.yaml: P-ERR-26101 axis x: no block of 'plc' came within the watchdog time; ")


def test_commands_of_the_set_up_are_not_marked():
    assert run_of("ptp_override_20_100").markers == (
        Marker(0.05, "move absolute 5000"),
        Marker(1.5, "set override 100 %"),
    )


def test_setpoints_that_come_block_by_block_are_marked_once():
    texts = [marker.text for marker in run_of("ptp_external_setpoints").markers]
    assert texts == ["external enable 600", "external setpoints", "external disable"]


@pytest.mark.parametrize(
    ("title", "unit"),
    [("velocity", "deg/s"), ("torque", "Nm"), ("friction current", "digits of the drive")],
)
def test_panels_have_the_unit_of_their_fields(title, unit):
    assert DrawnUnit("axis", "deg", "Nm").unit_of(UNIT_KINDS["axis"].panels[title].fields[0]) == unit


# pictures


@pytest.fixture(scope="module")
def override_picture():
    figure = read_head(SCENARIOS / "ptp_override_100_75_100.yaml")
    return svg_text(draw(figure, run_of(figure.name)), title=figure.title)


def test_picture_names_panels_units_commands_and_values(override_picture):
    texts = texts_of(override_picture)
    assert set(PANELS) <= set(texts)
    assert texts.count("set") == texts.count("actual") == 3
    assert {"set override 75 %", "override 75 %", "5000", "2000", "−5000"} <= set(texts)
    assert "Override 100 % to 75 % and back" in texts


def test_picture_is_the_same_each_time_and_has_no_date(override_picture):
    figure = read_head(SCENARIOS / "ptp_override_100_75_100.yaml")
    assert svg_text(draw(figure, run_figure(figure)), title=figure.title) == override_picture
    assert "date" not in override_picture
    assert "Matplotlib v" not in override_picture
    assert not re.search(r"\d\.\d{3,}[ \"]", override_picture)


def test_every_colour_has_one_for_dark_pages(override_picture):
    body = override_picture.split("</style>")[1]
    colours = set(re.findall(r"#[0-9a-f]{6}", body))
    assert colours <= set(DARK)
    assert len(colours) >= 10
    for light in colours:
        assert f'[style*="stroke: {light}"]{{stroke:{DARK[light]}!important}}' in override_picture


def test_several_axes_are_named_and_have_a_colour_each(tmp_path):
    y = "- {at: 0.05, to: y, do: move_absolute, target: -2}\n"
    figure = read_head(written(tmp_path, {**HEAD, "axes": "x, y"}, MOVE + y))
    texts = texts_of(svg_text(draw(figure, run_figure(figure)), title=figure.title))
    assert texts.count("x set") == texts.count("y actual") == 3
    assert {"1", "−2"} <= set(texts)
    assert "x: move absolute 1, y: move absolute −2" in texts


def test_a_status_is_tinted():
    figure = read_head(SCENARIOS / "ptp_compensation_full.yaml")
    svg = svg_text(draw(figure, run_of(figure.name)), title=figure.title)
    assert texts_of(svg).count("compensating") == 1
    assert svg.split("</style>")[1].count(f"fill: {BAND}") == 4  # once in each panel


def test_caption_keeps_numbers_with_their_units():
    words = "w" * 125
    assert wrapped(f"{words} J = 50000 mm/s³ at 75 % and 3 s.") == [
        words,
        "J\u00a0=\u00a050000\u00a0mm/s³ at 75\u00a0% and 3\u00a0s.",
    ]


def test_labels_that_would_overlap_stand_in_rows():
    run = run_of("ptp_dynamics_1_1")
    markers = (
        Marker(0.1, "a long text of a command"),
        Marker(0.15, "another"),
        Marker(0.6, "third"),
        Marker(1.24, "last"),
    )
    labels = label_rows(replace(run, markers=markers), run.cycles)
    assert [(label.row, label.at_left) for label in labels] == [(0, False), (1, False), (0, False), (0, False)]
    at_the_edge = (Marker(1.24, "a text that has no room at the right"),)
    labels = label_rows(replace(run, markers=at_the_edge), run.cycles)
    assert labels[0].at_left


def test_errors_are_no_picture_unless_the_head_asks_for_them(tmp_path):
    fault = "- {at: 0.1, to: x, do: external_enable, mode: absolute}\n" + (
        "- {at: 0.2, to: x, do: external_setpoints, setpoints: [[0, 50, 0, 0, 1]]}\n"
    )
    with pytest.raises(FigureError, match=r"axis x: external setpoint 50\.0 mm is 50 mm away.*no picture was drawn"):
        run_figure(read_head(written(tmp_path, HEAD, fault)))
    shown = run_figure(read_head(written(tmp_path, {**HEAD, "errors": "shown"}, fault)))
    assert [marker.text for marker in shown.markers][-1] == "x: error 23033"


def test_errors_of_the_head_have_one_value(tmp_path):
    with pytest.raises(FigureError, match="'errors: yes' in the head must be 'errors: shown'"):
        read_head(written(tmp_path, {**HEAD, "errors": "yes"}))


def test_commands_of_the_machinery_are_not_marked(tmp_path):
    couple = "- {at: 0.05, to: y, do: couple, master: x, factor: -0.5}\n"
    run = run_figure(read_head(written(tmp_path, {**HEAD, "axes": "x, y"}, couple)))
    assert [marker.text for marker in run.markers] == ["y: couple −0.5"]


@pytest.mark.parametrize(
    ("value", "text"), [(2000.0, "2000"), (1696.77, "1696.8"), (3.394, "3.39"), (-5000.0, "−5000"), (-0.001, "0")]
)
def test_values_are_short(value, text):
    assert number(value) == text


# the folder


def test_every_scenario_has_its_picture_and_every_picture_its_scenario():
    scenarios = {file.stem for file in SCENARIOS.glob("*.yaml")}
    assert {picture.stem for picture in PICTURES.iterdir()} == scenarios


@pytest.mark.parametrize("scenario", sorted(SCENARIOS.glob("*.yaml")), ids=lambda path: path.stem)
def test_scenario_is_a_figure(scenario):
    figure = read_head(scenario)
    assert figure.machine_path.is_file()
    picture = (PICTURES / f"{figure.name}.svg").read_text(encoding="utf-8")
    assert figure.title in texts_of(picture)
    titles = {text.split(" in ")[0] for text in texts_of(picture)}
    assert figure.kind in KINDS
    if figure.kind == "time":
        assert {*(figure.panels or UNIT_KINDS["axis"].usual), "time"} <= titles
    assert len(picture.encode()) < 100_000


def test_setpoints_of_the_external_example_are_those_of_the_script():
    assert FILE.read_text(encoding="utf-8") == csv_text()


# the command


def test_command_draws_what_is_named_and_says_what_changed(tmp_path):
    arguments = ["ptp_dynamics_1_1", "--pictures", str(tmp_path)]
    first = CliRunner().invoke(command.main, arguments)
    assert first.exit_code == 0
    assert re.fullmatch(r"ptp_dynamics_1_1: 1\.\d\d s of machine time, \d\d kB, written\n", first.output)
    second = CliRunner().invoke(command.main, arguments)
    assert second.output == first.output.replace("written", "unchanged")
    assert set(PANELS) <= set(texts_of((tmp_path / "ptp_dynamics_1_1.svg").read_text(encoding="utf-8")))


def test_command_draws_the_others_when_one_fails(tmp_path):
    written(tmp_path, HEAD)
    (tmp_path / "bad.yaml").write_text(MOVE)
    result = CliRunner().invoke(command.main, ["--scenarios", str(tmp_path), "--pictures", str(tmp_path / "svg")])
    assert result.exit_code == 1
    assert result.output.startswith(
        "figure bad.yaml: the head (comment lines at the top of the file) has no 'title: ...'"
    )
    assert [file.name for file in (tmp_path / "svg").iterdir()] == ["move.svg"]


def test_command_refuses_unknown_names(tmp_path):
    result = CliRunner().invoke(command.main, ["nothing", "--scenarios", str(tmp_path)])
    assert result.exit_code == 2
    assert f"there is no scenario {tmp_path}/nothing.yaml; nothing was drawn" in " ".join(result.output.split())


def test_columns_of_panels_have_a_number_for_each_cycle() -> None:
    """Answers and events of jobs, which are lists of a block too, are none."""
    scenario = (
        "- {at: 0, to: x, do: move_absolute, target: 1}\n- {at: 0, to: s, do: start, direction: cw, speed_rpm: 9}"
    )
    bench = MachineBench(None, scenario).run(0.1)
    for unit, kind in (("x", "axis"), ("s", "spindle")):
        for block in bench.blocks[unit]:
            for name in UNIT_KINDS[kind].columns:
                column = getattr(block, name)
                assert len(column) == block.count and all(isinstance(value, int | float) for value in column), name
