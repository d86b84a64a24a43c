"""A real drive's telegram between NC and drive: what gets through, how coarse, and over which ends."""

from __future__ import annotations

import math

import pytest
from format_support import control_of, da_volts

from cnc_ptp.control.drives import Drive, TelegramDrive, VirtualDrive, make_drive
from cnc_ptp.parameters.view.control_view import ControlParameters

T = 0.001
ENCODER = ("getriebe.0.wegaufz: 1", "getriebe.0.wegaufn: 10")
"""1 µm an increment."""
TORQUE = ("antr.acc_reference_value: 2", "antr.torque_scale_num: 100", "getriebe.0.load: 20.0")
"""50 digits a N; 20 kg."""
FULL_SERCOS = (
    "kenngr.antr_typ: 2",
    "antr.telegram.commands: [S-0-0036, S-0-0037, S-0-0081]",
    "antr.telegram.feedback: [S-0-0051, S-0-0040, S-0-0084]",
    *TORQUE,
)


def telegram_drive(*lines: str, spindle: bool = False) -> TelegramDrive:
    drive = make_drive(control_of(*lines, "simulation.drive_time_constant: 3000", spindle=spindle), T)
    assert isinstance(drive, TelegramDrive)
    return drive


def plain_drive(*lines: str) -> Drive:
    """The same drive in kernel units."""
    kept = [line for line in lines if not line.startswith(("kenngr.antr_typ", "antr.telegram"))]
    return make_drive(control_of(*kept, "simulation.drive_time_constant: 3000"), T)


def test_words_of_a_full_telegram() -> None:
    drive = telegram_drive(*FULL_SERCOS, "antr.v_reso_num: 600", "antr.v_reso_denom: 1000", *ENCODER)
    drive.step(10.004, -3.0, 0.03)
    # 600 digits a mm/min are 36000 a mm/s; 0.03 N are 1.5 digits, rounded to the even side
    assert (drive.command_word, drive.additive_velocity_word, drive.additive_torque_word) == (360_144, -108_000, 2)
    assert drive.velocity_word == round(drive.velocity * 36_000)
    assert drive.position_word == round(drive.position * 1000)
    assert drive.torque_word == round(drive.torque * 50)
    assert drive.has_torque


def test_actual_values_are_those_of_the_drive_to_half_a_digit() -> None:
    lines = (*FULL_SERCOS, "antr.v_reso_num: 600", "antr.v_reso_denom: 1000", "getriebe.0.wegaufn: 1")
    drive, plain = telegram_drive(*lines), plain_drive(*lines)
    for cycle in range(400):
        command = 40.0 * math.sin(0.02 * cycle)
        drive.step(command)
        plain.step(round(command * 36_000) / 36_000)
        assert drive.position == pytest.approx(plain.position, abs=0.5e-4 + 1e-12)
        assert drive.velocity == pytest.approx(plain.velocity, abs=0.5 / 36_000 + 1e-12)
        assert drive.torque == pytest.approx(plain.torque, abs=0.5 / 50 + 1e-12)


def test_what_the_telegram_does_not_carry_does_not_get_through() -> None:
    drive, bare = telegram_drive("kenngr.antr_typ: 8", *TORQUE), telegram_drive("kenngr.antr_typ: 8", *TORQUE)
    for cycle in range(50):
        drive.step(5.0 + 0.1 * cycle, 100.0, 100.0)
        bare.step(5.0 + 0.1 * cycle)
        assert (drive.position, drive.velocity) == (bare.position, bare.velocity)
        assert (drive.torque, drive.torque_word, drive.has_torque) == (0.0, 0, False)
        assert (drive.additive_velocity_word, drive.additive_torque_word) == (0, 0)


def test_without_a_velocity_object_the_velocity_is_the_way_of_a_cycle() -> None:
    drive = telegram_drive("kenngr.antr_typ: 8", *ENCODER)
    for _ in range(100):
        before = drive.position
        drive.step(12.3456)
        assert drive.velocity == pytest.approx((drive.position - before) / T, rel=1e-12)
    assert drive.velocity == pytest.approx(12.3456, abs=1.0)  # an increment of 1 µm in a cycle of 1 ms is 1 mm/s


def test_a_torque_scale_of_zero_gives_no_torque() -> None:
    drive = telegram_drive(*FULL_SERCOS, "antr.torque_scale_denom: 0")
    drive.step(100.0, 0.0, 5.0)
    assert (drive.torque, drive.has_torque, drive.additive_torque_word) == (0.0, False, 0)


def test_an_analogue_drive_turns_no_faster_than_ten_volts_say() -> None:
    """2000 bits at 1 m/min: 10 V are 16.3835 m/min."""
    drive = telegram_drive("kenngr.antr_typ: 1")
    for _ in range(200):
        drive.step(1000.0)
    assert (drive.command_word, da_volts(drive.command_word)) == (32_767, 10.0)
    assert drive.velocity == pytest.approx(16_383.5 / 60.0, abs=0.11)  # an increment of 0.1 µm in a cycle is 0.1 mm/s
    for _ in range(200):
        drive.step(-1000.0)
    assert (drive.command_word, da_volts(drive.command_word)) == (-32_768, -10.0)


def test_a_short_velocity_object_limits_the_velocity() -> None:
    lines = ("antr.sercos.mdt.0: {nc_ref: S_0_0036, ident_len: 2}", "antr.v_reso_num: 1", "antr.v_reso_denom: 60")
    drive = telegram_drive("kenngr.antr_typ: 2", *lines)  # 1 digit is 1 µm/s
    for _ in range(100):
        drive.step(50.0)
    assert drive.command_word == 32_767
    assert drive.velocity == pytest.approx(32.767, abs=0.2)


def test_an_endless_spindle_runs_over_the_end_of_its_counter() -> None:
    """1e6 increments a degree: the counter of 32 bits is full after 4295 °."""
    lines = ("kenngr.antr_typ: 8", "getriebe.0.wegaufz: 100", "antr.v_reso_num: 1", "antr.v_reso_denom: 1")
    drive = telegram_drive(*lines, spindle=True)
    words = []
    for _ in range(3000):
        drive.step(-5000.0)
        words.append(drive.position_word)
    assert drive.position == pytest.approx(-5000.0 * (3.0 - 0.003), abs=1e-3)
    assert max(words) - min(words) > 2**31
    assert all(-(2**31) <= word < 2**31 for word in words)


@pytest.mark.parametrize("kind", [2, 7, 8])
def test_a_drive_that_closes_the_position_loop_gets_the_counter(kind: int) -> None:
    name = "607A" if kind == 8 else "S-0-0047"
    lines = (f"kenngr.antr_typ: {kind}", f'antr.telegram.commands: ["{name}"]', "getriebe.0.kv: 4000", *ENCODER)
    drive = telegram_drive(*lines, "simulation.start_position: 3000")
    assert (drive.position, drive.command_word) == (3000.0, 3_000_000)
    for cycle in range(1000):
        drive.step(3000.0 + 0.05 * cycle)
    assert drive.command_word == 3_049_950
    assert 3000.0 + 0.05 * 999 - drive.position == pytest.approx(50.0 / 40.0, abs=0.06)  # v/Kv, and a cycle of way


def test_dynamic_servo_control() -> None:
    """PROFIdrive: the following error as XERR, the feedforward as NSOLL_B."""
    drive = telegram_drive("kenngr.antr_typ: 3", "getriebe.0.kv: 4000", *ENCODER)
    for _ in range(200):
        drive.step(0.25, 20.0)
    assert drive.command_word == 250
    assert drive.velocity == pytest.approx(0.25 * 40.0 + 20.0, rel=1e-3)


def test_reverse_turns_the_words_and_nothing_else() -> None:
    lines = ("kenngr.antr_typ: 6", "simulation.start_position: 10")
    forward, backward = (telegram_drive(*lines, f"getriebe.0.reverse: {sign}", spindle=True) for sign in (0, 1))
    for cycle in range(100):
        for drive in (forward, backward):
            drive.step(0.1 * cycle)
        assert backward.command_word == -forward.command_word
        assert backward.position_word == -forward.position_word
        assert (backward.position, backward.velocity) == (forward.position, forward.velocity)
    assert da_volts(forward.command_word) == pytest.approx(
        0.1 * 99 * 120.0 * 10.0 / 32_767, abs=1e-3
    )  # 120 bits for 1 °/s


@pytest.mark.parametrize("kind", [1, 2, 3, 4, 5, 6, 7, 8, 32])
def test_each_drive_type_moves_with_its_preset(kind: int) -> None:
    """With nothing but P-AXIS-00020: the position loop of the NC, or of the drive, holds v/Kv."""
    control = control_of(f"kenngr.antr_typ: {kind}", "getriebe.0.kv: 5000", "simulation.drive_time_constant: 3000")
    drive = make_drive(control, T)
    lag = 0.0
    for cycle in range(600):
        lag = 0.1 * cycle - drive.position
        drive.step(lag if control.drive.interface == "lag" else control.kv * lag)
    assert lag == pytest.approx(100.0 / 50.0, rel=1e-3)
    assert drive.velocity == pytest.approx(100.0, rel=1e-3)


def test_a_virtual_axis_has_no_telegram() -> None:
    control: ControlParameters = control_of("kenngr.antr_typ: 16")
    assert control.drive.interface == "none"
    assert isinstance(make_drive(control, T), VirtualDrive)
