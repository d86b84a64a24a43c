"""What a program says never reaches a terminal as control characters."""

from cnc_ptp.nc.faults import visible
from cnc_ptp.nc.parser import parse_all


def test_control_characters_of_a_line_are_shown_not_sent() -> None:
    (error,) = parse_all("G0 X1 \x1b[31mHELLO\x1b]0;pwn\x07\nM30", "a.nc")[1]
    assert str(error).isprintable() and "\\x1b[31mHELLO\\x1b]0;pwn\\x07" in str(error)
    assert error.text.isprintable()


def test_text_that_can_be_printed_is_left_as_it_is() -> None:
    assert visible("G01 X1 ; Bohrung Ø 5 µm") == "G01 X1 ; Bohrung Ø 5 µm"
    assert visible("G01\tX1\r") == "G01\tX1\\r"
