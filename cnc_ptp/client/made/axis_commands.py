"""The commands of an axis as methods. Made by cnc_ptp/client/make_commands.py; do not edit."""

from __future__ import annotations

from typing import Literal

from cnc_ptp.client.asking import Asking, Rows
from cnc_ptp.client.job import Answer, Job

BufferMode = Literal["aborting", "buffered", "blending_low", "blending_previous", "blending_next", "blending_high"]


class AxisCommands(Asking):
    """What an axis can be told. A refusal raises the error of the unit; nothing has changed then."""

    def power(self, enabled: bool) -> Answer:
        """Enable.

        enabled  on or off
        """
        return self._answer("power", enabled=enabled)

    def reset(self) -> Answer:
        """Leaves ErrorStop at a standstill; a stop in DiscreteMotion and ContinuousMotion."""
        return self._answer("reset")

    def set_feed_release(self, forward: bool, backward: bool) -> Answer:
        """Feed release of each direction.

        forward  positive direction released
        backward  negative direction released
        """
        return self._answer("set_feed_release", forward=forward, backward=backward)

    def feed_hold(self, enabled: bool) -> Answer:
        """Stops positioning and path on their ramps, and resumes them.

        enabled  on or off
        """
        return self._answer("feed_hold", enabled=enabled)

    def move_absolute(
        self,
        target: float,
        *,
        velocity: float | None = None,
        acceleration: float | None = None,
        deceleration: float | None = None,
        jerk: float | None = None,
        buffer_mode: BufferMode | None = None,
    ) -> Job:
        """Positioning to a target.

        target [mm, °]  position of the axis
        velocity [mm/s, °/s]  largest velocity; left out: the smaller of P-AXIS-00212 and P-MACH-00008
        acceleration [mm/s², °/s²]  largest acceleration; left out: P-AXIS-00001
        deceleration [mm/s², °/s²]  largest deceleration; left out: P-AXIS-00002
        jerk [mm/s³, °/s³]  largest jerk; left out: P-AXIS-00001 / P-AXIS-00196
        buffer_mode  how it follows an active motion ([ptp.md](ptp.md#buffer-modes)); left out: only from
            Standstill
        """
        return self._job(
            "move_absolute",
            target=target,
            velocity=velocity,
            acceleration=acceleration,
            deceleration=deceleration,
            jerk=jerk,
            buffer_mode=buffer_mode,
        )

    def move_relative(
        self,
        distance: float,
        *,
        velocity: float | None = None,
        acceleration: float | None = None,
        deceleration: float | None = None,
        jerk: float | None = None,
        buffer_mode: BufferMode | None = None,
    ) -> Job:
        """Positioning over a distance from the set position.

        distance [mm, °]  signed
        velocity [mm/s, °/s]  largest velocity; left out: the smaller of P-AXIS-00212 and P-MACH-00008
        acceleration [mm/s², °/s²]  largest acceleration; left out: P-AXIS-00001
        deceleration [mm/s², °/s²]  largest deceleration; left out: P-AXIS-00002
        jerk [mm/s³, °/s³]  largest jerk; left out: P-AXIS-00001 / P-AXIS-00196
        buffer_mode  how it follows an active motion ([ptp.md](ptp.md#buffer-modes)); left out: only from
            Standstill
        """
        return self._job(
            "move_relative",
            distance=distance,
            velocity=velocity,
            acceleration=acceleration,
            deceleration=deceleration,
            jerk=jerk,
            buffer_mode=buffer_mode,
        )

    def move_modulo(
        self,
        position: float,
        *,
        velocity: float | None = None,
        acceleration: float | None = None,
        deceleration: float | None = None,
        jerk: float | None = None,
        buffer_mode: BufferMode | None = None,
    ) -> Job:
        """Positioning within a turn, modulo axes.

        position [°, mm]  sign = direction, magnitude = turns and position within the turn
        velocity [mm/s, °/s]  largest velocity; left out: the smaller of P-AXIS-00212 and P-MACH-00008
        acceleration [mm/s², °/s²]  largest acceleration; left out: P-AXIS-00001
        deceleration [mm/s², °/s²]  largest deceleration; left out: P-AXIS-00002
        jerk [mm/s³, °/s³]  largest jerk; left out: P-AXIS-00001 / P-AXIS-00196
        buffer_mode  how it follows an active motion ([ptp.md](ptp.md#buffer-modes)); left out: only from
            Standstill
        """
        return self._job(
            "move_modulo",
            position=position,
            velocity=velocity,
            acceleration=acceleration,
            deceleration=deceleration,
            jerk=jerk,
            buffer_mode=buffer_mode,
        )

    def move_additive(
        self,
        distance: float,
        *,
        velocity: float | None = None,
        acceleration: float | None = None,
        deceleration: float | None = None,
        jerk: float | None = None,
        buffer_mode: BufferMode | None = None,
    ) -> Job:
        """Positioning over a distance from the target of the last positioning.

        distance [mm, °]  signed
        velocity [mm/s, °/s]  largest velocity; left out: the smaller of P-AXIS-00212 and P-MACH-00008
        acceleration [mm/s², °/s²]  largest acceleration; left out: P-AXIS-00001
        deceleration [mm/s², °/s²]  largest deceleration; left out: P-AXIS-00002
        jerk [mm/s³, °/s³]  largest jerk; left out: P-AXIS-00001 / P-AXIS-00196
        buffer_mode  how it follows an active motion ([ptp.md](ptp.md#buffer-modes)); left out: only from
            Standstill
        """
        return self._job(
            "move_additive",
            distance=distance,
            velocity=velocity,
            acceleration=acceleration,
            deceleration=deceleration,
            jerk=jerk,
            buffer_mode=buffer_mode,
        )

    def move_velocity(
        self,
        velocity: float,
        *,
        acceleration: float | None = None,
        deceleration: float | None = None,
        jerk: float | None = None,
        buffer_mode: BufferMode | None = None,
    ) -> Job:
        """Moves at a velocity until another motion comes.

        velocity [mm/s, °/s]  sign = direction
        acceleration [mm/s², °/s²]  largest acceleration; left out: P-AXIS-00001
        deceleration [mm/s², °/s²]  largest deceleration; left out: P-AXIS-00002
        jerk [mm/s³, °/s³]  largest jerk; left out: P-AXIS-00001 / P-AXIS-00196
        buffer_mode  how it follows an active motion ([ptp.md](ptp.md#buffer-modes)); left out: only from
            Standstill
        """
        return self._job(
            "move_velocity",
            velocity=velocity,
            acceleration=acceleration,
            deceleration=deceleration,
            jerk=jerk,
            buffer_mode=buffer_mode,
        )

    def move_superimposed(
        self,
        distance: float,
        *,
        velocity_difference: float | None = None,
        acceleration: float | None = None,
        deceleration: float | None = None,
        jerk: float | None = None,
    ) -> Job:
        """Adds a distance to the basic motion.

        distance [mm, °]  signed
        velocity_difference [mm/s, °/s]  largest velocity of the addition; left out: what P-AXIS-00212 leaves
            beside the basic motion
        acceleration [mm/s², °/s²]  largest acceleration; left out: P-AXIS-00001
        deceleration [mm/s², °/s²]  largest deceleration; left out: P-AXIS-00002
        jerk [mm/s³, °/s³]  largest jerk; left out: P-AXIS-00001 / P-AXIS-00196
        """
        return self._job(
            "move_superimposed",
            distance=distance,
            velocity_difference=velocity_difference,
            acceleration=acceleration,
            deceleration=deceleration,
            jerk=jerk,
        )

    def halt_superimposed(self) -> Job:
        """Ends the superimposed motion on its ramp."""
        return self._job("halt_superimposed")

    def set_position(self, position: float, *, relative: bool | None = None) -> Answer:
        """Other coordinates for the axis, which does not move.

        position [mm, °]  the actual position from now on
        relative  `position` is a distance from the actual one; left out: off
        """
        return self._answer("set_position", position=position, relative=relative)

    def set_override(self, percent: float) -> Answer:
        """Override of PTP motion.

        percent [%]  override
        """
        return self._answer("set_override", percent=percent)

    def set_override_type(self, type: int) -> Answer:
        """To which velocity the override applies.

        type  1 … 4
        """
        return self._answer("set_override_type", type=type)

    def stop(self) -> Job:
        """Stops on the ramp; new targets wait until the axis is at a standstill."""
        return self._job("stop")

    def hold_stop(self, enabled: bool) -> Answer:
        """Keeps the axis in Stopping: what would move it is refused (22165) until it is off; MC_Stop.

        enabled  on or off
        """
        return self._answer("hold_stop", enabled=enabled)

    def halt(self) -> Job:
        """Stops on the ramp; a new target acts immediately."""
        return self._job("halt")

    def jog(self, velocity: float) -> Job:
        """Moves at a velocity until the next one; 0 ends the jog.

        velocity [mm/s, °/s]  sign = direction
        """
        return self._job("jog", velocity=velocity)

    def home(self, *, position: float | None = None) -> Job:
        """Homing (G74): reference cam, zero pulse; by the drive with P-AXIS-00299 = DRIVE_CONTROLLED.

        position [mm, °]  position of the reference point; left out: P-AXIS-00152
        """
        return self._job("home", position=position)

    def emergency_stop(self, *, deceleration: float | None = None, jerk: float | None = None) -> Job:
        """Stops on a ramp of its own, never weaker than that of the start.

        deceleration [mm/s², °/s²]  of the stop; left out: that of the start
        jerk [mm/s³, °/s³]  of the stop; left out: that of the start
        """
        return self._job("emergency_stop", deceleration=deceleration, jerk=jerk)

    def new_target(self, target: float) -> Job:
        """New target on the fly.

        target [mm, °]  position of the axis
        """
        return self._job("new_target", target=target)

    def new_velocity_and_target(self, velocity: float, target: float, activation_position: float) -> Job:
        """New target immediately, new velocity from a position on.

        velocity [mm/s, °/s]  from the activation position on
        target [mm, °]  position of the axis
        activation_position [mm, °]  where the new velocity starts to act
        """
        return self._job(
            "new_velocity_and_target",
            velocity=velocity,
            target=target,
            activation_position=activation_position,
        )

    def compensation_start(
        self,
        length: float,
        difference: float,
        process_velocity: float,
        velocity_increase: float,
        *,
        acceleration: float | None = None,
        deceleration: float | None = None,
    ) -> Answer:
        """Position compensation: an additional distance within a length of the motion.

        length [mm, °]  length of the basic motion in which the difference is made
        difference [mm, °]  additional distance, signed
        process_velocity [mm/s, °/s]  velocity of the basic motion
        velocity_increase [mm/s, °/s]  largest velocity of the compensation
        acceleration [mm/s², °/s²]  of the compensation alone; left out: P-AXIS-00001
        deceleration [mm/s², °/s²]  of the compensation alone; left out: P-AXIS-00002
        """
        return self._answer(
            "compensation_start",
            length=length,
            difference=difference,
            process_velocity=process_velocity,
            velocity_increase=velocity_increase,
            acceleration=acceleration,
            deceleration=deceleration,
        )

    def compensation_stop(self) -> Answer:
        """Ends the compensation on its ramp."""
        return self._answer("compensation_stop")

    def external_enable(self, mode: Literal["absolute", "relative"], *, target: float | None = None) -> Job:
        """External setpoints on.

        mode  what the setpoints count from
        target [mm, °]  where the setpoints end; left out: not monitored
        """
        return self._job("external_enable", mode=mode, target=target)

    def external_disable(self) -> Job:
        """External setpoints off."""
        return self._job("external_disable")

    def external_setpoints(self, setpoints: Rows | None = None, *, file: str | None = None) -> Answer:
        """External setpoints, one per cycle.

        setpoints  rows cycle, position, velocity, acceleration, direction; or `file`
        file  CSV file; left out: the rows are in the command
        """
        return self._answer("external_setpoints", setpoints=setpoints, file=file)

    def couple(self, master: str, factor: float) -> Job:
        """Linear slave.

        master  name of the master
        factor  coupling factor, signed
        """
        return self._job("couple", master=master, factor=factor)

    def couple_gantry(self, master: str, difference_limit: float) -> Job:
        """Gantry: linear slave of factor 1 with monitored actual positions.

        master  name of the master
        difference_limit [mm, °]  largest difference of the actual positions
        """
        return self._job("couple_gantry", master=master, difference_limit=difference_limit)

    def couple_cyclic(self, master: str, acc_bound: float) -> Job:
        """Slave with a factor that is set cyclically.

        master  name of the master
        acc_bound [mm/s², °/s²]  largest acceleration by a change of the factor
        """
        return self._job("couple_cyclic", master=master, acc_bound=acc_bound)

    def couple_flying_saw(
        self,
        master: str,
        factor: float,
        master_position: float,
        slave_position: float,
        *,
        velocity: float | None = None,
        acceleration: float | None = None,
        deceleration: float | None = None,
        jerk: float | None = None,
    ) -> Job:
        """Synchronises with a moving master from given positions on.

        master  name of the master
        factor  coupling factor, signed
        master_position [mm, °]  master, when both are synchronous
        slave_position [mm, °]  slave, when both are synchronous
        velocity [mm/s, °/s]  largest velocity; left out: the smaller of P-AXIS-00212 and P-MACH-00008
        acceleration [mm/s², °/s²]  largest acceleration; left out: P-AXIS-00001
        deceleration [mm/s², °/s²]  largest deceleration; left out: P-AXIS-00002
        jerk [mm/s³, °/s³]  largest jerk; left out: P-AXIS-00001 / P-AXIS-00196
        """
        return self._job(
            "couple_flying_saw",
            master=master,
            factor=factor,
            master_position=master_position,
            slave_position=slave_position,
            velocity=velocity,
            acceleration=acceleration,
            deceleration=deceleration,
            jerk=jerk,
        )

    def couple_cam(
        self,
        master: str,
        table: Rows | None = None,
        *,
        file: str | None = None,
        cyclic: bool = True,
        master_offset: float | None = None,
        master_scaling: float | None = None,
        slave_scaling: float | None = None,
        slave_offset: float | None = None,
    ) -> Job:
        """Follows a cam table.

        master  name of the master
        table  points [master, slave]; or `file`
        file  CSV file; left out: the rows are in the command
        cyclic  whether the table is repeated
        master_offset [mm, °]  of the table; left out: 0
        master_scaling  of the table, not 0; left out: 1
        slave_scaling  of the table, not 0; left out: 1
        slave_offset [mm, °]  of the table; left out: from the positions when coupled
        """
        return self._job(
            "couple_cam",
            master=master,
            table=table,
            file=file,
            cyclic=cyclic,
            master_offset=master_offset,
            master_scaling=master_scaling,
            slave_scaling=slave_scaling,
            slave_offset=slave_offset,
        )

    def change_cam(self, table: Rows | None = None, *, file: str | None = None) -> Answer:
        """New table at the end of the active one.

        table  points [master, slave]; or `file`
        file  CSV file; left out: the rows are in the command
        """
        return self._answer("change_cam", table=table, file=file)

    def set_coupling_factor(self, factor: float) -> Answer:
        """New factor of a linear slave.

        factor  coupling factor, signed
        """
        return self._answer("set_coupling_factor", factor=factor)

    def set_cyclic_factor(self, factor: float) -> Answer:
        """New factor of a cyclic slave.

        factor  coupling factor, signed
        """
        return self._answer("set_cyclic_factor", factor=factor)

    def decouple(self, *, target: float | None = None, velocity: float | None = None) -> Job:
        """Ends the coupling, in motion too.

        target [mm, °]  where the axis goes; left out: none: the motion is endless
        velocity [mm/s, °/s]  of the axis from now on; left out: unchanged
        """
        return self._job("decouple", target=target, velocity=velocity)

    def write_parameter(self, parameter: str, value: float) -> Answer:
        """Changes a parameter until the end of the run.

        parameter  P number or name: P-AXIS-00099, P-COMP-00046.2, getriebe[0].kv
        value  in the unit of its list
        """
        return self._answer("write_parameter", parameter=parameter, value=value)

    def set_feedforward(self, *, enabled: bool | None = None, weight_percent: float | None = None) -> Answer:
        """Switches and weights feedforward.

        enabled  on or off; left out: unchanged
        weight_percent [%]  weight of feedforward, 0 … 100; left out: unchanged
        """
        return self._answer("set_feedforward", enabled=enabled, weight_percent=weight_percent)

    def reset_feedforward(self) -> Answer:
        """Feedforward off, weight 100 %."""
        return self._answer("reset_feedforward")

    def set_friction_compensation(self, enabled: bool) -> Answer:
        """Switches friction compensation.

        enabled  on or off
        """
        return self._answer("set_friction_compensation", enabled=enabled)

    def read_drive_parameter(self, idn: str) -> Answer:
        """Reads a parameter of a SERCOS drive; the answer holds it.

        idn  `S-0-` and four digits
        """
        return self._answer("read_drive_parameter", idn=idn)

    def write_drive_parameter(self, idn: str, value: int) -> Answer:
        """Writes a parameter of a SERCOS drive; S-0-0148 = 3 lets the drive home the axis.

        idn  `S-0-` and four digits
        value  in digits of the drive
        """
        return self._answer("write_drive_parameter", idn=idn, value=value)
