"""Drive formats: the manuals' examples to the digit, both ways, and what happens at the ends of the ranges."""

from __future__ import annotations

import random

import pytest
from format_support import control_of, da_volts, format_of

from cnc_ptp.control.drive_format import CounterFormat, CounterReader, Digits

RPM = 6.0
"""deg/s"""
MM_PER_MIN = 1.0 / 60.0
SERVO_MOTOR = (
    "antr.feed_const_num: 50000",  # 5 mm a revolution
    "antr.feed_const_denom: 1",
    "getriebe.0.incr_per_rev: 1048576",
    "getriebe.0.gear_fact_num: 3",
    "getriebe.0.gear_fact_denom: 1",
    "getriebe.0.load: 4.8e-5",
    "antr.acc_reference_value: 0.45",
    "antr.torque_scale_num: 500",
    "antr.torque_scale_denom: 1",
)
"""TF5200 feedforward 4.2 (the load as docs/control.md has it)."""


# ---------------------------------------------------------------- examples of the manuals


def test_feedforward_4_1_velocity() -> None:
    """A spindle pitch of 10 mm and digits of 1e-4 rpm: 10000 digits are 10 mm/min."""
    form = format_of("antr.v_time_base: 0", "antr.v_reso_num: 10000", "antr.v_reso_denom: 10000")
    assert form.velocity.encode(10.0 * MM_PER_MIN) == 10_000
    assert form.additive_velocity.encode(-10.0 * MM_PER_MIN) == -10_000
    assert form.velocity.decode(10_000) == pytest.approx(10.0 * MM_PER_MIN, rel=1e-15)


def test_feedforward_4_1_velocity_with_gear() -> None:
    """With a gear of 3 the same digits are 3.333 mm/min."""
    form = format_of("antr.v_time_base: 0", "antr.v_reso_num: 10000", "antr.v_reso_denom: 3333")
    assert form.velocity.encode(3.333 * MM_PER_MIN) == 10_000
    assert form.velocity.decode(10_000) * 60.0 == pytest.approx(3.333, rel=1e-15)


def test_feedforward_4_2_resolution() -> None:
    """2^20 · 3 / 50000 = 62.91456 increments per 0.1 µm."""
    form = format_of(*SERVO_MOTOR)
    assert form.position.scale == 629_145.6  # a mm
    assert form.actual_position.encode(5.0) == 3 * 2**20  # one turn of the output is three of the motor
    assert form.lag.encode(-5.0 / 3.0) == -(2**20)


def test_feedforward_4_2_torque() -> None:
    """M = J 2π i / h a = 0.18096 Nm at 1 m/s², of which 0.45 Nm are 500 digits."""
    control, form = control_of(*SERVO_MOTOR), format_of(*SERVO_MOTOR)
    torque = control.scaling.torque_per_acceleration * 1000.0
    assert torque == pytest.approx(0.180956, abs=5e-7)
    assert form.additive_torque.encode(0.45) == 500
    assert form.additive_torque.encode(torque) == 201
    assert form.additive_torque.encode(1.2 * torque) == 241  # the weight 12/10 of the example
    assert form.actual_torque.decode(500) == pytest.approx(0.45, rel=1e-15)


def test_spindle_2_2_4_1_sensorless_spindle_at_a_terminal() -> None:
    """32767 digits give 10 V and 3000 rpm."""
    form = format_of(
        "kenngr.antr_typ: 6",
        "antr.operation_mode: OPEN_POSITION_LOOP_NO_FEEDBACK",
        "antr.v_time_base: 0",
        "antr.v_reso_num: 32767",
        "antr.v_reso_denom: 1080000000",
        spindle=True,
    )
    assert form.velocity.encode(3000.0 * RPM) == 32_767
    assert form.velocity.encode(-1500.0 * RPM) == -16_384  # half of it, 16383.5, to the even side
    assert da_volts(form.velocity.encode(3000.0 * RPM)) == 10.0
    assert form.velocity.decode(32_767) == pytest.approx(3000.0 * RPM, rel=1e-15)


def test_spindle_2_2_4_2_speed_feedback() -> None:
    """1 digit is 1 rpm."""
    form = format_of(
        "kenngr.antr_typ: 8", "antr.v_time_base: 0", "antr.v_reso_num: 1", "antr.v_reso_denom: 360000", spindle=True
    )
    assert [form.velocity.encode(rpm * RPM) for rpm in (1.0, 750.0, -12_000.0)] == [1, 750, -12_000]
    assert form.actual_velocity.decode(3000) == 3000.0 * RPM


@pytest.mark.parametrize(("spindle", "speed"), [(False, 1000.0 / 60.0), (True, 1000.0 / 60.0)])
def test_da_word_at_1_m_per_min_or_1000_deg_per_min(spindle: bool, speed: float) -> None:
    """P-AXIS-00129 / P-AXIS-00128 bits, 2000 by default."""
    assert format_of("kenngr.antr_typ: 1", spindle=spindle).velocity.encode(speed) == 2000
    gains = ("kenngr.antr_typ: 6", "getriebe.0.multi_gain_z: 7001", "getriebe.0.multi_gain_n: 2")
    assert format_of(*gains, spindle=spindle).velocity.encode(2.0 * speed) == 7001


# ---------------------------------------------------------------- scales


@pytest.mark.parametrize(
    ("base", "cycle_time_us", "digits"), [(0, 1000, 60_000), (1, 1000, 1000), (2, 1000, 1), (2, 4000, 4)]
)
def test_time_base_of_the_velocity(base: int, cycle_time_us: int, digits: int) -> None:
    """1 mm in a minute, a second or a sampling interval is 1000 digits; 1 mm/s then is …"""
    lines = (f"antr.v_time_base: {base}", "antr.v_reso_num: 1000", "antr.v_reso_denom: 1000")
    assert format_of(*lines, cycle_time_us=cycle_time_us).velocity.encode(1.0) == digits


def test_each_gear_has_its_scales() -> None:
    gears = [f"getriebe.1.{name}" for name in ("gear_fact_num: 6", "incr_per_rev: 1048576", "load: 9.6e-5")]
    lines = (*SERVO_MOTOR, *gears, "getriebe.1.multi_gain_z: 4000")
    first, second = (control_of(*lines, gear=gear).scaling for gear in (0, 1))
    assert second.position == 2.0 * first.position
    assert second.torque_per_acceleration == pytest.approx(4.0 * first.torque_per_acceleration, rel=1e-15)
    assert second.analogue == 2.0 * first.analogue


def test_forces_of_a_linear_motor_and_torques_of_a_rotary_axis() -> None:
    """Without a feed constant: F = m a with m in kg, M = J α with α in rad/s²."""
    linear = control_of("getriebe.0.load: 20.0").scaling.torque_per_acceleration
    rotary = control_of("getriebe.0.load: 20.0", "kenngr.achs_typ: ACHSTYP_ROTATOR").scaling.torque_per_acceleration
    assert linear * 1000.0 == pytest.approx(20.0, rel=1e-15)  # 1 m/s²
    assert rotary * 57.29577951308232 == pytest.approx(20.0, rel=1e-15)  # 1 rad/s²


def test_a_zero_denominator_of_the_torque_puts_nothing_out() -> None:
    form = format_of("antr.torque_scale_denom: 0")
    assert (form.additive_torque.encode(1e9), form.actual_torque.decode(5000)) == (0, 0.0)


# ---------------------------------------------------------------- ends of the ranges


@pytest.mark.parametrize(("bits", "lowest", "highest"), [(16, -32_768, 32_767), (32, -(2**31), 2**31 - 1)])
def test_digits_stay_within_their_length(bits: int, lowest: int, highest: int) -> None:
    digits = Digits(scale=10.0, bits=bits)
    values = [highest / 5.0, -0.26, lowest / 5.0]
    assert digits.encode_all(values) == [highest, -3, lowest]
    assert digits.encode_all(values[1:2]) == [-3] and digits.encode_all([]) == []
    assert digits.encode(highest / 10.0) == highest
    assert digits.encode(lowest / 10.0) == lowest
    assert digits.encode(1e15) == highest
    assert digits.encode(-1e15) == lowest


def test_lengths_of_objects() -> None:
    form = format_of("kenngr.antr_typ: 2")
    assert (form.velocity.bits, form.position.bits, form.torque.bits, form.additive_torque.bits) == (32, 32, 16, 16)
    assert (form.actual_position.bits, form.actual_velocity.bits, form.actual_torque.bits) == (32, 32, 16)
    assert format_of("kenngr.antr_typ: 1").velocity.bits == 16
    short = format_of(
        "kenngr.antr_typ: 2",
        "antr.sercos.mdt.0: {nc_ref: S_0_0036, ident_len: 2}",
        "antr.sercos.mdt.1: {ident_nr: 81, ident_len: 4}",
        "antr.sercos.at.0: {nc_ref: S_0_0051, ident_len: 4}",
        "antr.sercos.at.1: {nc_ref: S_0_0040, ident_len: 2}",
    )
    assert (short.velocity.bits, short.additive_torque.bits, short.actual_velocity.bits) == (16, 32, 16)


def test_reverse_is_a_sign_of_the_format() -> None:
    assert format_of("getriebe.0.reverse: 1", spindle=True).sign == -1
    assert format_of(spindle=True).sign == 1


@pytest.mark.parametrize(
    ("increments", "signed", "unsigned"),
    [(0, 0, 0), (2**31 - 1, 2**31 - 1, 2**31 - 1), (2**31, -(2**31), 2**31), (-1, -1, 2**32 - 1), (2**32 + 5, 5, 5)],
)
def test_a_counter_runs_over(increments: int, signed: int, unsigned: int) -> None:
    counter = CounterFormat(scale=1.0)
    assert counter.encode(float(increments)) == counter.signed(increments) == signed
    assert counter.unsigned(increments) == unsigned


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("as_unsigned", [False, True])
def test_a_reader_follows_a_counter_over_its_ends(seed: int, as_unsigned: bool) -> None:
    """Hundreds of ranges far, both ways, from anywhere: the position is right to half an increment."""
    draw = random.Random(seed)
    counter = CounterFormat(scale=1000.0, bits=16)
    position = draw.uniform(-1e6, 1e6)
    reader = CounterReader(counter, position=position)
    assert reader.position == pytest.approx(position, abs=0.0005 + 1e-9)
    for _ in range(3000):
        position += draw.uniform(-30.0, 32.0)
        word = counter.encode(position)
        shown = reader.read(counter.unsigned(word) if as_unsigned else word)
        assert shown == pytest.approx(position, abs=0.0005 + 1e-9)
        assert shown == reader.position


@pytest.mark.parametrize("seed", range(3))
def test_digits_there_and_back_are_right_to_half_a_digit(seed: int) -> None:
    draw = random.Random(seed)
    for _ in range(300):
        digits = Digits(scale=10.0 ** draw.uniform(-2.0, 5.0), bits=32)
        value = draw.uniform(-1.0, 1.0) * 2**31 / digits.scale
        assert abs(digits.decode(digits.encode(value)) - value) <= 0.5000001 / digits.scale
        word = draw.randrange(-(2**31), 2**31)
        assert digits.encode(digits.decode(word)) == word
