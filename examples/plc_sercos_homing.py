"""TX1250 4.2 as a PLC program: the PLC lets a SERCOS drive home its axis, and tells the three errors of the manual.

    cnc_ptp simulate examples/sercos.yaml --plc examples/plc_sercos_homing.py

The axis follows its drive from S-0-0148 = 3 on, and takes its reference over when the drive has set S-0-0403. The
command `home` does all this by itself; here each step is that of the PLC. It waits for the answer of one command
before it gives the next one, as a step chain in IEC 61131-3 does.
"""

from collections.abc import Generator

PARAMETER_SCALING = 0x08  # bit of S-0-0044
EXECUTED, ACTIVE = 0x3, 0x7  # acknowledgement of S-0-0148
UM_PER_MIN = 60_000  # digits of S-0-0041 for 1 mm/s, with preferred scaling
TENTHS_OF_UM = 10_000  # digits of S-0-0052 for 1 mm
POLL_CYCLES = 10

SCALING_ERROR = 0xFFFFFFFF
ABORTED_ERROR = 0xFFFFFFFE
REFERENCE_ERROR = 0xFFFFFFFD


class Plc:
    """Homes the axis x once, moves it, and ends the run."""

    velocity = 40.0  # mm/s
    position = 100.0  # mm: what the reference point gets

    def __init__(self, io) -> None:
        self.axis = io.axis("x")
        self.error = 0
        self.commanded = False  # S-0-0148 is 3
        self.referenced = False  # S-0-0403
        self.steps = self.sequence(io)

    def cycle(self, io) -> None:
        """One step further, once in each PLC cycle."""
        next(self.steps, None)

    def sequence(self, io) -> Generator[None, None, None]:
        """The step chain: each `yield` waits for the next PLC cycle."""
        yield from self.home()
        if self.error:
            text = yield from self.read("S-0-0095")
            io.event(f"homing of x: error 16#{self.error:X}, the drive says: {text}")
            yield from self.end()
        else:
            io.event(f"x is homed, its reference point is at {self.position:g} mm")
            yield from self.command("move_absolute", target=self.position + 20.0)
        io.done()

    def home(self) -> Generator[None, None, None]:
        """Starts the procedure command, waits for its end, and looks whether the drive is referenced."""
        scaling = yield from self.read("S-0-0044")
        if scaling & PARAMETER_SCALING:
            self.error = SCALING_ERROR
            return
        yield from self.write("S-0-0041", round(self.velocity * UM_PER_MIN))
        yield from self.write("S-0-0052", round(self.position * TENTHS_OF_UM))
        yield from self.write("S-0-0148", 3)  # set and enable
        self.commanded = True
        state = ACTIVE
        while state == ACTIVE:
            for _ in range(POLL_CYCLES):
                yield
            state = yield from self.read("S-0-0148")
        if state != EXECUTED:
            self.error = ABORTED_ERROR
            return
        status = yield from self.read("S-0-0403")
        self.referenced = bool(status & 1)
        if not self.referenced:
            self.error = REFERENCE_ERROR
            return
        yield from self.end()

    def end(self) -> Generator[None, None, None]:
        """Takes the procedure command back: the axis is in Standstill again."""
        yield from self.write("S-0-0148", 0)
        self.commanded = False

    def read(self, idn):
        answer = yield from self.command("read_drive_parameter", idn=idn)
        return answer.values[idn]

    def write(self, idn, value):
        yield from self.command("write_drive_parameter", idn=idn, value=value)

    def command(self, name, **arguments):
        """Gives a command and waits for its answer. A refusal here is a fault of this program."""
        ticket = self.axis.give(name, **arguments)
        answer = None
        while answer is None:
            yield
            answer = self.axis.answer(ticket)
        if answer.error_id:
            raise RuntimeError(answer.message)
        return answer
