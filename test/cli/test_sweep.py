"""`cnc_ptp sweep`: what it prints, what it refuses, and its page."""

import re

import pyarrow.parquet as pq
import pytest
from commands_support import MILL, call
from sweep_support import LARGEST, PROGRAM, Here, program_in, sweep_in

from cnc_ptp.sweep.page import sweep_page
from cnc_ptp.sweep.results import Results, Row

END = "; nothing was started"
KV = "x.getriebe.0.kv=4000,5000"


@pytest.fixture(autouse=True)
def no_workers(monkeypatch):
    """The runs are computed in this process."""
    monkeypatch.setattr("cnc_ptp.commands.run.sweep.Pool", lambda workers, scheduler: Here())


def sweep(folder, *options, program=PROGRAM, output="sweep.parquet", vary=KV, goal=LARGEST):
    words = ["sweep", MILL, "--program", program_in(folder, program), "--vary", vary, "--goal", goal]
    return call(*words, "-o", folder / output, *options)


def test_results_are_printed_and_a_second_call_computes_nothing(tmp_path):
    page = tmp_path / "sweep.html"
    options = ["--goal", "max:program_time", "--page", page]
    result = sweep(tmp_path, *options)
    assert result.exit_code == 0
    first, least, largest, front = result.output.splitlines()
    assert re.fullmatch(rf"{re.escape(str(tmp_path))}/sweep\.parquet: 2 variants; \d+\.\d s", first)
    table = pq.read_table(tmp_path / "sweep.parquet").to_pydict()
    assert least == f"least {LARGEST} {table[LARGEST][1]:.6g}: variant 1, x.getriebe.0.kv=5000"
    assert largest == f"largest program_time {table['program_time'][0]:.6g}: variant 0, x.getriebe.0.kv=4000"
    assert front.startswith("Pareto front: ")
    assert "<h2>Parallel coordinates</h2>" in page.read_text()
    again = sweep(tmp_path, *options)
    assert "2 variants, 2 of them before; " in again.output and again.exit_code == 0


def test_failures_are_printed_and_only_failures_are_a_failure(tmp_path):
    soft = "axis X: 5 mm lies beyond the positive soft limit 2 mm (P-AXIS-00178)"
    some = sweep(tmp_path, vary="x.kenngr.swe_pos=20000,3000000")
    assert some.exit_code == 0 and ": 2 variants, 1 failed; " in some.output
    assert "failed: variant 0, x.kenngr.swe_pos=20000: P-ERR-120002 " in some.output and soft in some.output
    all_of_them = sweep(tmp_path, "--duration", 0.1, output="all.parquet")
    assert all_of_them.exit_code == 1 and ": 2 variants, 2 failed; " in all_of_them.output


def test_a_program_may_need_what_varies(tmp_path):
    """The machine file has no tolerance for this #HSC ON, both variants have one."""
    program = "#HSC ON [BSPLINE]\nG1 X1 Y1 F6000\nX2 Y0\n#HSC OFF\nM30\n"
    result = sweep(tmp_path, vary="channel.P-CHAN-90014=100,1000", program=program, goal="program_time")
    assert result.exit_code == 0 and "failed" not in result.output


def test_random_and_optimised(tmp_path):
    options = ["--random", 3, "--seed", 1]
    assert ": 3 variants; " in sweep(tmp_path, *options, vary="x.getriebe.0.kv=4000:5000").output
    optimised = sweep(tmp_path, "--optimise", 2, vary="x.getriebe.0.kv=4000:5000", output="o.parquet")
    assert ": 2 variants; " in optimised.output


@pytest.mark.parametrize(
    ("options", "text"),
    [
        (["--workers", "0"], "Invalid value for '--workers': 0 is not in the range x>=1."),
        (["--random", "0"], "Invalid value for '--random': 0 is not in the range x>=1."),
        (["--random", "2", "--optimise", "2"], "--random and --optimise exclude each other."),
        (["--workers", "2", "--scheduler", "tcp://a:1"], "--workers and --scheduler exclude each other: a scheduler has its own workers."),
    ],
)  # fmt: skip
def test_wrong_usage(tmp_path, options, text):
    result = sweep(tmp_path, *options)
    assert (result.exit_code, result.output.splitlines()[-1]) == (2, f"Error: {text}")


def test_something_must_run(tmp_path):
    result = call("sweep", MILL, "--vary", KV, "--goal", LARGEST, "-o", tmp_path / "s.parquet")
    assert (result.exit_code, result.output.splitlines()[-1]) == (2, "Error: --program or --scenario is needed.")


@pytest.mark.parametrize(
    ("output", "page", "text"),
    [
        ("sweep.csv", None, "{0}/sweep.csv: the file name of a sweep must end in .parquet"),
        (
            "none/sweep.parquet",
            None,
            "{0}/none/sweep.parquet cannot be written: there is no folder {0}/none, make it or give another name",
        ),
        ("sweep.parquet", "sweep.txt", "{0}/sweep.txt: the file name of a report must end in .html"),
    ],
)
def test_outputs_that_cannot_be(tmp_path, output, page, text):
    result = sweep(tmp_path, *(["--page", tmp_path / page] if page else []), output=output)
    assert (result.exit_code, result.output) == (2, f"P-ERR-27030 {text.format(tmp_path)}{END}\n")


def test_a_program_that_does_not_exist(tmp_path):
    result = call(
        "sweep", MILL, "--program", tmp_path / "a.nc", "--vary", KV, "--goal", LARGEST, "-o", tmp_path / "s.parquet"
    )
    text = f"P-ERR-26110 NC program {tmp_path}/a.nc cannot be read: No such file or directory; nothing was started\n"
    assert (result.exit_code, result.output) == (2, text)
    assert not [*tmp_path.glob("s.*")]


def test_a_program_that_no_variant_can_run(tmp_path):
    result = sweep(tmp_path, program="G1 X5000 F100\nM30\n")
    assert result.exit_code == 2 and result.output.startswith("P-ERR-120002 ")


@pytest.mark.parametrize(
    ("options", "text"),
    [
        ({"vary": "x.kv=1"}, "P-ERR-26178 --vary: axis x has no parameter 'kv'; nothing was started\n"),
        ({"goal": "maxi(1)"}, "P-ERR-26179 --goal: 'maxi(1)' has the function maxi, which does not exist, only max, min, mean, rms, std, last, abs; did you mean max?; nothing was started\n"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_printed(tmp_path, options, text):
    result = sweep(tmp_path, **options)
    assert (result.exit_code, result.output) == (2, text)


def test_a_page_without_a_sound_variant_and_with_markup_in_a_text(tmp_path):
    goals = sweep_in(tmp_path).goals
    rows = [Row(0, ("<b>",), (float("nan"),) * 2, 26187, "<script>")]
    page = sweep_page(Results(["a"], goals, rows), "s.parquet", "grid")
    assert "<td>P-ERR-26187 &lt;script&gt;</td>" in page and "&lt;b&gt;" in page
    assert "<h2>Pareto" not in page and "<h2>Parallel" not in page


def test_an_interrupt_before_the_first_variant(tmp_path, monkeypatch):
    monkeypatch.setattr("cnc_ptp.commands.run.sweep.Pool", lambda workers, scheduler: Here(after=0))
    result = sweep(tmp_path)
    assert result.stderr == "P-ERR-26106 the sweep was interrupted; no variant was finished\n"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["short.nc"]
