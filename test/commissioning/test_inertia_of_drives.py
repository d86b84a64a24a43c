"""Inertia of simulated drives, identified as `cnc_ptp identify dynamics` does it: its ± covers that of the plant."""

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
import yaml

from cnc_ptp.commands.commissioning import axis_data
from cnc_ptp.commands.commissioning.identify import DYNAMIC_SPEEDS, REST
from cnc_ptp.commissioning.dynamics import fit_drive
from cnc_ptp.commissioning.excitation import forth_and_back, highest_velocity
from cnc_ptp.commissioning.inertia import fit_inertia
from cnc_ptp.commissioning.timing import DYNAMIC_STEADY
from cnc_ptp.control.drives import choice
from cnc_ptp.control.drives.cascaded import CascadedDrive

MILL = Path(__file__).parents[2] / "config" / "mill.yaml"
SERCOS = {"commands": ["S-0-0036"], "feedback": ["S-0-0051", "S-0-0040", "S-0-0084"]}
MASS = {
    "antr": {"feed_const_num": None, "acc_reference_value": 1, "torque_scale_num": 1},
    "load": 300,
    "simulation": {
        "torque_limit": 5000,
        "friction": {"coulomb": 120, "static": 180, "stribeck_velocity": 2.0, "viscous": 60},
    },
}
AXES = {
    "screw": {},
    "mass": MASS,
    "rotary": {
        "kenngr": {"achs_typ": "ACHSTYP_ROTATOR"},
        "antr": {"feed_const_num": None},
        "load": 0.05,
        "simulation": {"friction": {"coulomb": 0.3, "static": 0.4, "stribeck_velocity": 2.0, "viscous": 0.05}},
    },
    "coarse": {
        "lr_param": {"frict_comp": 0},
        "kenngr": {"antr_typ": 2},
        "antr": {"telegram": SERCOS, "acc_reference_value": 1, "torque_scale_num": 20},
    },
    "position only": {
        "kenngr": {"antr_typ": 2},
        "lr_param": {"frict_comp": 0},
        "antr": {"telegram": {**SERCOS, "feedback": ["S-0-0051", "S-0-0084"]}, "torque_scale_num": 30000},
    },
    "sharp": {"simulation": {"current_time_constant": 0}},
    "without filter": {"simulation": {"drive_time_constant": 0}},
    "slow": {"simulation": {"drive_time_constant": 6000, "current_time_constant": 1000}},
}
"""The x axis of the mill as it is and with other parameters: a mass in N, deg, digits of 0.05 Nm, other drives."""


pytestmark = pytest.mark.interpreted


class MomentaryDrive(CascadedDrive):
    """Reports the torque at the end of the cycle instead of its mean."""

    __slots__ = ()

    def step(self, command, additive_velocity=0.0, additive_torque=0.0):
        super().step(command, additive_velocity, additive_torque)
        self.torque = self._motor * self._per_acceleration


def machine_file(folder, axis, cycle_time_us):
    machine = yaml.safe_load(MILL.read_text())
    machine["/machine"]["ros__parameters"]["cycle_time_us"] = cycle_time_us
    parameters = machine["/x"]["ros__parameters"]
    for section, values in AXES[axis].items():
        if section == "load":
            parameters["getriebe"]["0"]["load"] = values
        else:
            merged = {**parameters[section], **values}
            parameters[section] = {name: value for name, value in merged.items() if value is not None}
    path = folder / "machine.yaml"
    path.write_text(yaml.safe_dump(machine))
    return str(path)


@pytest.fixture(scope="module")
def driven(tmp_path_factory):
    """Trace of an axis and the k of its plant, N (Nm) a mm/s² (deg/s²)."""

    @cache
    def drive(axis, momentary, cycle_time_us=1000):
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(choice, "CascadedDrive", MomentaryDrive if momentary else CascadedDrive)
            data = axis_data.open_axis("x", machine_file(tmp_path_factory.mktemp("m"), axis, cycle_time_us), None)
            highest = highest_velocity(data.room, DYNAMIC_STEADY)
            speeds = [part * highest for part in DYNAMIC_SPEEDS]
            motions = forth_and_back(data.room, speeds, steady=DYNAMIC_STEADY, rest=0.5 * REST)
            trial, trace = axis_data.drive(data, motions, label="x", record=None)
        assert not trial.failed
        return trace, data.axis.control.plant.torque_per_acceleration

    return drive


def identified(trace, k):
    """Error and ± of k, as parts of it."""
    return of_k(trace, k, fit_drive(trace).time_constant)


def of_k(trace, k, lag):
    fit = fit_inertia(trace, time_constant=lag)
    return fit.torque_per_acceleration / k - 1.0, fit.deviation / k


@pytest.mark.parametrize("axis", ["screw", "mass", "rotary", "sharp", "slow"])
def test_mean_torques_give_the_inertia_of_the_plant(driven, axis):
    error, deviation = identified(*driven(axis, False))
    assert abs(error) <= deviation < 1e-7


@pytest.mark.parametrize("axis", ["screw", "mass", "rotary", "position only", "sharp", "slow"])
def test_momentary_torques_lack_what_the_deviation_says(driven, axis):
    """0.014 % to 1.4 % of k."""
    error, deviation = identified(*driven(axis, True))
    assert -deviation <= error < -deviation / 2.3


@pytest.mark.parametrize(("momentary", "largest"), [(False, 1e-4), (True, 5e-3)])
def test_the_deviation_covers_the_plant_whatever_the_digits(driven, momentary, largest):
    """In 95 % of 201 runs, widths of a digit from 0.01 % to 5 % of the largest torque."""
    runs = []
    for axis in ("screw", "mass", "rotary"):
        trace, k = driven(axis, momentary)
        top, lag = np.max(np.abs(trace.actual_torque)), fit_drive(trace).time_constant
        for digit in np.geomspace(1e-4, 0.05, 67) * top:
            runs.append(of_k(replace(trace, actual_torque=np.round(trace.actual_torque / digit) * digit), k, lag))
    assert sum(abs(error) <= deviation for error, deviation in runs) >= 191
    assert np.median([deviation for _, deviation in runs]) < largest


@pytest.mark.parametrize("cycle_time_us", [500, 2000])
def test_the_ripple_of_a_momentary_torque_grows_with_the_cycle(driven, cycle_time_us):
    """0.007 % of k are lost at 0.5 ms, 1.3 % at 2 ms."""
    error, deviation = identified(*driven("screw", True, cycle_time_us))
    assert -deviation <= error < -0.5 * deviation


def test_a_momentary_torque_of_a_drive_without_filter_says_nothing(driven):
    """It lacks 8 % of k, and nothing in the recording bounds that."""
    trace, _ = driven("without filter", True)
    assert fit_inertia(trace, time_constant=fit_drive(trace).time_constant) is None
    error, deviation = identified(*driven("without filter", False))
    assert abs(error) <= deviation < 1e-7


def noisy(trace, k, seeds):
    """Errors and ± of noisy copies: 0.2 mm/s (deg/s), 0.5 % of the largest torque."""
    torque, lag = 0.005 * np.max(np.abs(trace.actual_torque)), fit_drive(trace).time_constant
    for seed in seeds:
        velocities, torques = np.random.default_rng(seed).standard_normal((2, len(trace)))
        run = replace(
            trace,
            actual_velocity=trace.actual_velocity + 0.2 * velocities,
            actual_torque=trace.actual_torque + torque * torques,
        )
        yield of_k(run, k, lag)


@pytest.mark.parametrize(("momentary", "largest"), [(False, 9e-4), (True, 0.03)])
@pytest.mark.parametrize("axis", ["screw", "mass", "rotary", "coarse", "position only", "sharp", "slow"])
def test_the_deviation_covers_the_plant_in_95_of_100_noisy_runs(driven, axis, momentary, largest):
    """Behind noise a momentary torque of any drive may be that of a sharp one, which lacks 1.4 %: so much must ± be."""
    runs = np.array(list(noisy(*driven(axis, momentary), range(40))))
    assert np.sum(np.abs(runs[:, 0]) <= runs[:, 1]) >= 38
    assert np.median(runs[:, 1]) < largest
