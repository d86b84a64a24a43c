"""--vary: ranges and parameters, and all that is refused before anything runs."""

import math

import numpy as np
import pytest
from commands_support import MILL
from scipy import stats
from sweep_support import machine

from cnc_ptp.errors import CncError
from cnc_ptp.parameters import load_machine, machine_text
from cnc_ptp.sweep.optimiser import OptimisedPlan
from cnc_ptp.sweep.plans import MOST_VARIANTS, grid, random_plan
from cnc_ptp.sweep.spread import Interval, Normal, Values, read_spread
from cnc_ptp.sweep.variation import check_variations, read_variations

END = "; nothing was started"


@pytest.fixture(scope="module")
def mill():
    return machine()


@pytest.mark.parametrize(
    ("text", "spread"),
    [
        ("1:2:5", Values((1.0, 1.25, 1.5, 1.75, 2.0), stepped=True)),
        ("3:1:3", Values((3.0, 2.0, 1.0), stepped=True)),
        ("7:7:1", Values((7.0,), stepped=True)),
        ("5", Values((5,))),
        ("1,2.5,-3e2", Values((1, 2.5, -300.0))),
        ("VEL,VEL | ACC,true", Values(("VEL", "VEL | ACC", True))),
        ("1:2", Interval(1.0, 2.0)),
        ("uniform:1:2", Interval(1.0, 2.0)),
        ("log:1:100", Interval(1.0, 100.0, log=True)),
        ("normal:5:0.5", Normal(5.0, 0.5)),
    ],
)
def test_forms_of_a_range(text, spread):
    assert read_spread(text) == spread


def test_logarithmic_steps_have_one_ratio():
    values = read_spread("log:1:1000:4").values
    assert values == pytest.approx((1.0, 10.0, 100.0, 1000.0), rel=1e-12)


FORMS = "a:b:n, log:a:b:n, a,b,c, a:b, uniform:a:b, log:a:b or normal:mean:sigma"


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("1:2:3:4", f"is none of {FORMS}"),
        ("normal:1", f"has 'normal' where a number is expected; a range is one of {FORMS}"),
        ("1:two:3", f"has 'two' where a number is expected; a range is one of {FORMS}"),
        ("1:inf:3", "has 'inf', which is not finite"),
        ("1:2:x", "has 'x' where the number of values is expected"),
        ("1:2:0", "is empty: 0 values"),
        ("1:2:100001", "has 100001 values, more than 100000"),
        ("1:2:1", "has 1 values from 1 to 2, which do not differ by the same step"),
        ("2:2:3", "has 3 values from 2 to 2, which do not differ by the same step"),
        ("2:2", "is empty: 2 is not below 2"),
        ("uniform:3:2", "is empty: 3 is not below 2"),
        ("log:0:2", "has a logarithm of 0, which is not above 0"),
        ("log:-1:2:3", "has a logarithm of -1, which is not above 0"),
        ("normal:1:0", "is empty: sigma 0 is not above 0"),
        ("", "has an empty value"),
        ("[1]", "has a value that is neither number nor text"),
    ],
)
def test_ranges_that_are_refused(mill, text, reason):
    with pytest.raises(CncError) as caught:
        read_variations([f"x.getriebe.0.kv={text}"], mill)
    assert str(caught.value) == f"P-ERR-26177 --vary: range '{text}' {reason}{END}"


KV = "axis list, P-AXIS-00099 getriebe[0].kv of /x"


@pytest.mark.parametrize(
    ("texts", "error"),
    [
        ([], "26177 --vary: there is nothing to vary: unit.parameter=range"),
        (["kv"], "26177 --vary: 'kv' is not of the form unit.parameter=range, as x.getriebe.0.kv=2000:8000:13"),
        (["x=1:2:3"], "26177 --vary: 'x=1:2:3' is not of the form unit.parameter=range, as x.getriebe.0.kv=2000:8000:13"),
        (["chanel.achse=1"], "26178 --vary: the machine has no unit 'chanel'; did you mean channel?"),
        (["x.getriebe.0.kvv=1"], "26178 --vary: axis /x has no parameter 'getriebe.0.kvv'; did you mean getriebe[i].kv (P-AXIS-00099)?"),
        (["x.spindel.0.bezeichnung=1"], "26178 --vary: axis /x has no parameter 'spindel.0.bezeichnung', P-CHAN-00007 belongs to channel nodes"),
        (["x.getriebe.0.kv=1:2:2", "x.P-AXIS-00099=3"], "26177 --vary: x.getriebe.0.kv varies 2 times"),
    ],
)  # fmt: skip
def test_parameters_that_are_refused(mill, texts, error):
    with pytest.raises(CncError) as caught:
        read_variations(texts, mill)
    assert str(caught.value) == f"P-ERR-{error}{END}"


@pytest.mark.parametrize(
    ("text", "error"),
    [
        ("x.getriebe.0.kv=-1:8000:4", f"26178 --vary: {KV}: value -1 is not above 0 (0.01/s)"),
        ("x.getriebe.0.kv=0:8000", f"26178 --vary: {KV}: value 0 is not above 0 (0.01/s)"),
        ("x.getriebe.0.kv=2000,fast", f"26178 --vary: {KV}: value 'fast' is text, an integer is needed"),
        ("x.getriebe.0.kv=2000,2000.5", f"26178 --vary: {KV}: value 2000.5 is a number, an integer is needed"),
        ("x.getriebe.0.kv=1:2:5", f"26177 --vary: {KV}: range '1:2:5' has 1 more than once"),
        ("x.kenngr.antr_typ=4,4", "26177 --vary: axis list, P-AXIS-00020 kenngr.antr_typ of /x: range '4,4' has 4 more than once"),
    ],
)  # fmt: skip
def test_values_beyond_the_limits_of_a_parameter(mill, text, error):
    with pytest.raises(CncError) as caught:
        check_variations(read_variations([text], mill), machine_text(MILL), str(MILL))
    assert str(caught.value) == f"P-ERR-{error}{END}"


def test_a_limit_that_is_another_parameter_counts_unless_that_varies(mill):
    rapid, limit = "x.getriebe.0.vb_eilgang=300000,600000", "x.getriebe.0.dynamik.vb_max=500000,700000"
    text = machine_text(MILL)
    with pytest.raises(CncError) as caught:
        check_variations(read_variations([rapid], mill), text, str(MILL))
    assert str(caught.value).startswith(
        "P-ERR-26178 --vary: axis list, P-AXIS-00209 getriebe[0].vb_eilgang of /x: value 600000 is above the maximum 500000 "
    )
    assert str(caught.value).endswith(END)
    check_variations(read_variations([rapid, limit], mill), text, str(MILL))


def test_an_empty_value_of_a_list(mill):
    with pytest.raises(CncError, match=r"--vary: range '' has an empty value"):
        read_variations(["x.getriebe.0.kv=1,,2"], mill)


def test_names_are_those_of_machine_files_lists_and_numbers(mill):
    texts = ["x.getriebe.0.kv=1", "y.getriebe[0].kv=1", "z.P-AXIS-00099=1", "machine.block_cycles=5"]
    names = ["x.getriebe.0.kv", "y.getriebe.0.kv", "z.getriebe.0.kv", "machine.block_cycles"]
    assert [variation.name for variation in read_variations(texts, mill)] == names


def test_a_changed_value_is_that_of_a_changed_file(tmp_path):
    text = machine_text(MILL)
    changed = load_machine(text, str(MILL), changes={"x": {"getriebe.0.kv": 7000, "vorsteuer.vs_a_faktor": 1}})
    written = text.replace("kv: 5000  # 50 1/s", "kv: 7000").replace(
        "vs_a_faktor: 3000}  # with G135", "vs_a_faktor: 1}", 1
    )
    assert written.count("7000") == text.count("7000") + 1
    assert changed.axes["x"] == load_machine(written, str(MILL)).axes["x"] != load_machine(text, str(MILL)).axes["x"]


def test_a_grid_has_all_combinations_in_their_order(mill):
    variations = read_variations(["x.getriebe.0.kv=2000:4000:3", "y.getriebe.0.kv=1,2"], mill)
    found = [tuple(variant) for variant in grid(variations).batches().__next__()]
    assert found == [(0, (2000, 1)), (1, (2000, 2)), (2, (3000, 1)), (3, (3000, 2)), (4, (4000, 1)), (5, (4000, 2))]


def test_too_many_variants(mill):
    texts = [f"{axis}.getriebe.0.kv=1000:1999:1000" for axis in "xy"]
    with pytest.raises(CncError) as caught:
        grid(read_variations(texts, mill))
    text = "P-ERR-26185 the sweep has 1000000 variants, more than 100000; nothing was started, give fewer values or --random N"
    assert str(caught.value) == text
    assert caught.value.values == {"limit": MOST_VARIANTS}
    with pytest.raises(CncError, match="26185 the sweep has 100001 variants"):
        random_plan(read_variations(["x.getriebe.0.kv=1:9"], mill), 100_001, 0)


@pytest.mark.parametrize(("text", "example"), [("1000:2000", "a:b:n"), ("normal:5000:10", "--random N")])
def test_a_grid_needs_values(mill, text, example):
    with pytest.raises(CncError) as caught:
        grid(read_variations([f"x.getriebe.0.kv={text}"], mill))
    reason = f"x.getriebe.0.kv={text} has no number of values, which a grid needs: {example}"
    assert str(caught.value) == f"P-ERR-26177 --vary: {reason}{END}"


def test_an_optimiser_needs_limits(mill):
    with pytest.raises(CncError) as caught:
        OptimisedPlan(read_variations(["x.getriebe.0.kv=normal:5000:10"], mill), [], 8, 0)
    reason = "x.getriebe.0.kv=normal:5000:10 has no limits, which --optimise needs: a:b"
    assert str(caught.value) == f"P-ERR-26177 --vary: {reason}{END}"


def values_of(plan):
    return np.array([variant.values for batch in plan.batches() for variant in batch], dtype=float)


def test_random_values_have_their_distributions(mill):
    texts = [
        "x.simulation.friction.coulomb=normal:0.8:0.1",
        "y.simulation.friction.coulomb=uniform:0.5:1.5",
        "x.simulation.torque_limit=log:1:100",
        "x.getriebe.0.kv=1000,3000",
    ]
    columns = values_of(random_plan(read_variations(texts, mill), 2000, 5)).T
    assert stats.kstest(columns[0], "norm", (0.8, 0.1)).pvalue > 0.01
    assert stats.kstest(columns[1], "uniform", (0.5, 1.0)).pvalue > 0.01
    assert stats.kstest(np.log(columns[2]), "uniform", (0.0, math.log(100.0))).pvalue > 0.01
    assert 900 < np.sum(columns[3] == 1000.0) < 1100


def test_random_values_depend_on_seed_and_number_alone(mill):
    variations = read_variations(["x.getriebe.0.kv=1000:9000", "x.simulation.torque_limit=1:100"], mill)
    few, many, others = (values_of(random_plan(variations, *each)) for each in ((5, 1), (9, 1), (5, 2)))
    assert (few == many[:5]).all() and (few != others).any()
    assert (few[:, 0] == np.round(few[:, 0])).all()


def test_a_random_value_beyond_the_limits_is_refused_before_the_first_run(mill):
    with pytest.raises(CncError) as caught:
        random_plan(read_variations(["x.getriebe.0.kv=normal:100:200"], mill), 50, 0)
    assert str(caught.value).startswith(f"P-ERR-26178 --vary: {KV}: value -")
    assert str(caught.value).endswith(f" is not above 0 (0.01/s){END}")
