"""The one exception type of the kernel: a P-ERR number and a text: who, where, value, limit, effect."""


class CncError(Exception):
    """A refused command, program, parameter or run-time fault.

    `error_id` is the number that also goes into block, event and command messages; `message` is the text without it.
    Ranges: 21000 NC program, 22000 channel, 23000 axis, 24000 spindle, 25000 parameters and scenarios,
    26000 graph, recording and command line, 27000 commissioning; numbers that a manual names are kept.
    """

    def __init__(self, error_id: int, message: str) -> None:
        super().__init__(error_id, message)
        self.error_id = error_id
        self.message = message

    def __str__(self) -> str:
        return f"P-ERR-{self.error_id} {self.message}"
