"""The service channel of a SERCOS drive: its parameters (IDNs) are read and written in digits, one at a time."""

from __future__ import annotations

from cnc_ptp.control.drives.sercos import idns
from cnc_ptp.control.drives.sercos.homing_procedure import HomingProcedure, HomingSettings, Phase
from cnc_ptp.control.drives.sercos.idns import IDNS, homing_bits, is_name, scaling
from cnc_ptp.parameters.view.sercos_view import SercosParameters

NO_IDN = 0x1001
READ_ONLY = 0x7004
TOO_SMALL, TOO_LARGE, INVALID = 0x7006, 0x7007, 0x7008
CYCLIC = 0x700A
PROTECTED = 0x700C
ALREADY_ACTIVE = 0x7010
NOT_EXECUTABLE = 0x7012
"""Error codes of the SERCOS service channel."""

HELD_WHILE_HOMING = (
    idns.HOMING_VELOCITY,
    idns.HOMING_ACCELERATION,
    idns.JERK,
    idns.REFERENCE_DISTANCE,
    idns.HOMING_PARAMETER,
)
LINEAR_EXPONENT, ROTATIONAL_EXPONENT = -6, -4
"""S-0-0046 of preferred scaling: m/min, rpm."""


class ServiceError(Exception):
    """The drive refuses to read or write; nothing was changed."""

    def __init__(self, code: int, reason: str) -> None:
        super().__init__(code, reason)
        self.code = code
        self.reason = reason


class ServiceChannel:
    """Reads and writes the parameters of one drive."""

    def __init__(self, drive: SercosParameters, homing: HomingProcedure, *, own_motion: bool) -> None:
        """`own_motion`: the drive can move its axis on its own; one that takes torques cannot."""
        self.homing = homing
        self._own_motion = own_motion
        shift = -1 if drive.parameter_scaling else 0
        self.scaling = scaling(rotary=drive.rotary, exponent_shift=shift)
        kind = (idns.ROTATIONAL if drive.rotary else idns.LINEAR) | idns.AT_THE_LOAD
        exponent = (ROTATIONAL_EXPONENT if drive.rotary else LINEAR_EXPONENT) + shift
        digits = self.scaling
        self._values = {
            idns.HOMING_VELOCITY: digits.velocity.encode(drive.homing.fast),
            idns.HOMING_ACCELERATION: digits.acceleration.encode(drive.acceleration),
            idns.VELOCITY_SCALING: kind | (idns.PARAMETER_SCALING if drive.parameter_scaling else 0),
            idns.VELOCITY_FACTOR: 1,
            idns.VELOCITY_EXPONENT: exponent,
            idns.REFERENCE_DISTANCE: digits.position.encode(drive.homing.reference_position),
            idns.POSITION_WINDOW: digits.position.encode(drive.position_window),
            idns.POSITION_SCALING: kind,
            idns.STANDSTILL_WINDOW: digits.velocity.encode(homing.standstill_window),
            idns.HOMING_PARAMETER: homing_bits(drive),
            idns.ACCELERATION_SCALING: kind,
            idns.JERK: digits.acceleration.encode(drive.jerk),
        }

    # reading

    def read(self, idn: str) -> int | str:
        """Value of a parameter in its digits; S-0-0095 is a text. Raises ServiceError."""
        self._require_known(idn)
        if idn == idns.DIAGNOSIS:
            return self.homing.diagnosis
        value = self._values.get(idn)
        return self._live(idn) if value is None else value

    def _live(self, idn: str) -> int:
        homing, digits = self.homing, self.scaling
        live = {
            idns.VELOCITY_FEEDBACK: digits.velocity.encode(homing.velocity),
            idns.POSITION_COMMAND: digits.position.encode(homing.set_position),
            idns.POSITION_FEEDBACK: digits.position.encode(homing.position),
            idns.OVERRIDE: round(homing.override * 10_000.0),
            idns.HOMING: homing.acknowledgement,
            idns.HOME_SWITCH: int(homing.on_switch),
            idns.FEEDBACK_STATUS: idns.REFERENCED if homing.referenced else 0,
        }
        return live[idn]

    # writing

    def write(self, idn: str, value: int) -> None:
        """Writes a parameter in its digits. Raises ServiceError."""
        self.check(idn, value)
        if idn != idns.HOMING:
            self._values[idn] = value
        elif value == idns.SET_AND_ENABLE:
            self.homing.start(self._settings())
        elif value == idns.SET:
            self.homing.prepare()
        else:
            self.homing.cancel()

    def check(self, idn: str, value: int) -> None:
        """Raises the ServiceError with which the drive would refuse; changes nothing."""
        self._require_known(idn)
        low, high = IDNS[idn].low, IDNS[idn].high
        if idn == idns.OVERRIDE:
            raise ServiceError(CYCLIC, f"{idn} is written cyclically, by override and feed release of the axis")
        if low is None:
            raise ServiceError(READ_ONLY, f"{idn} ({IDNS[idn].text}) can only be read")
        if idn in HELD_WHILE_HOMING and self.homing.leads:
            raise ServiceError(PROTECTED, f"{idn} cannot be written while {idns.HOMING} is active")
        if idn == idns.HOMING:
            self._check_procedure(value)
        elif value < low:
            raise ServiceError(TOO_SMALL, f"{idn} = {value} is below its smallest value {low}")
        elif value > high:
            raise ServiceError(TOO_LARGE, f"{idn} = {value} is above its largest value {high}")
        if idn == idns.HOMING_PARAMETER:
            self._check_homing_parameter(value)

    def _require_known(self, idn: str) -> None:
        if idn in IDNS:
            return
        if not is_name(idn):
            raise ServiceError(NO_IDN, f"'{idn}' is not S-0- and four digits")
        raise ServiceError(NO_IDN, f"the drive has no {idn}, it has {', '.join(IDNS)}")

    def _check_procedure(self, value: int) -> None:
        if value not in (0, idns.SET, idns.SET_AND_ENABLE):
            raise ServiceError(INVALID, f"{idns.HOMING} = {value} is not 0 (cancel), 1 (set) or 3 (set and enable)")
        if value and self.homing.phase is Phase.CANCELLED:
            raise ServiceError(ALREADY_ACTIVE, f"{idns.HOMING} was cancelled and the drive still stops")
        if value and not self._own_motion:
            raise ServiceError(NOT_EXECUTABLE, f"{idns.HOMING} cannot be executed, the drive takes torques")

    def _check_homing_parameter(self, bits: int) -> None:
        """A switch at the drive, and a signal to look for; nothing else is supported."""
        supported = bits & ~idns.HOMING_BITS == 0 and bits & idns.SWITCH_AT_DRIVE
        if not supported:
            raise ServiceError(
                INVALID,
                f"{idns.HOMING_PARAMETER} = 0x{bits:x}: the drive supports 0x04 and, with it, 0x01, 0x20, 0x40, 0x80",
            )
        both = idns.WITHOUT_SWITCH | idns.WITHOUT_MARKER
        if bits & both == both:
            raise ServiceError(
                INVALID, f"{idns.HOMING_PARAMETER} = 0x{bits:x} leaves homing without a signal (0x20 and 0x40)"
            )

    def _settings(self) -> HomingSettings:
        values, digits = self._values, self.scaling
        return HomingSettings(
            velocity=digits.velocity.decode(values[idns.HOMING_VELOCITY]),
            acceleration=digits.acceleration.decode(values[idns.HOMING_ACCELERATION]),
            jerk=digits.acceleration.decode(values[idns.JERK]),
            reference=digits.position.decode(values[idns.REFERENCE_DISTANCE]),
            bits=values[idns.HOMING_PARAMETER],
        )
