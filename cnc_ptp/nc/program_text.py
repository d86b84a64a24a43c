"""The text of a program, line by line: from memory, or from a file of any size."""

from typing import BinaryIO, ClassVar, Final

END: Final = -1
"""Offset behind the last line."""


class ProgramText:
    """Lines by their offset, in memory."""

    kept: ClassVar[int] = 100_000
    """Lines that a program keeps as they were read; those behind them are read again each time."""

    def __init__(self, text: str) -> None:
        self._text = text.removeprefix("\ufeff").replace("\r\n", "\n").replace("\r", "\n")

    @property
    def size(self) -> int:
        """Its characters."""
        return len(self._text)

    def line_at(self, offset: int) -> tuple[str, int]:
        """The line that begins at an offset, and the offset of the next one, END behind the last line."""
        end = self._text.find("\n", offset)
        if end < 0:
            return self._text[offset:], END
        return self._text[offset:end], end + 1


class ProgramFile(ProgramText):
    """Lines of a file that is read as it is executed; it must not change meanwhile."""

    kept: ClassVar[int] = 10_000

    def __init__(self, stream: BinaryIO) -> None:
        """`stream` as opened in mode rb; its owner closes it."""
        super().__init__("")
        self._stream = stream
        self._offset = 0
        self._stream.seek(0)

    def line_at(self, offset: int) -> tuple[str, int]:
        if offset != self._offset:
            self._stream.seek(offset)
        line = self._stream.readline()
        self._offset = offset + len(line)
        begin = 3 if offset == 0 and line.startswith(b"\xef\xbb\xbf") else 0
        text = line[begin:].decode("utf-8", errors="replace").rstrip("\r\n")
        return text, self._offset if line.endswith(b"\n") else END
