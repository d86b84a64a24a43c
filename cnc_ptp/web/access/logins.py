"""Who is logged in: cookies of browsers, and how long they last."""

from __future__ import annotations

import secrets
import time
from collections.abc import Callable
from dataclasses import dataclass, field

IDLE_TIME = 30 * 60.0
"""Seconds without anything from a browser after which its login ends …"""
LONGEST_TIME = 12 * 3600.0
"""… and after which it ends in any case."""
MOST = 1000
"""Logins that are remembered: those with open pages, and those that were used last."""


@dataclass(slots=True)
class Login:
    """A browser: its user, and the token that its pages prove themselves with."""

    user: str
    role: str
    begin: float
    used: float
    token: str = field(default_factory=lambda: secrets.token_urlsafe(24))
    """Against forged requests: pages of other origins cannot read it."""
    has_logged_out: bool = False
    hash: str = ""
    """Of its password or token: with another one, the login ends."""
    is_machine: bool = False
    """By a token that it sends with each request, it is no browser."""
    pages: int = 0
    """Open ones, also those that have not said hello yet."""

    def is_of(self, other: Login) -> bool:
        """The same browser; or the same machine, which has a login of its own in each request."""
        is_machine = self.is_machine and other.is_machine
        return self is other or (is_machine and (self.user, self.hash) == (other.user, other.hash))


class Logins:
    """By the value of their cookie, which nobody can guess."""

    def __init__(
        self,
        *,
        idle_time: float = IDLE_TIME,
        longest_time: float = LONGEST_TIME,
        now: Callable[[], float] = time.monotonic,
    ) -> None:
        """Times in s."""
        self._idle_time, self._longest_time = idle_time, longest_time
        self._now = now
        self._logins: dict[str, Login] = {}

    def begin(self, user: str, role: str, hash: str = "") -> str:
        """A new login: the value of its cookie."""
        while len(self._logins) >= MOST and (oldest := self._used_longest_ago()) is not None:
            del self._logins[oldest]
        key = secrets.token_urlsafe(32)
        self._logins[key] = Login(user, role, self._now(), self._now(), hash=hash)
        return key

    def _used_longest_ago(self) -> str | None:
        """None where all have open pages."""
        without_page = (key for key, login in self._logins.items() if not login.pages)
        return min(without_page, key=lambda key: self._logins[key].used, default=None)

    def find(self, key: str) -> Login | None:
        """The login of a cookie, which counts as used; None for one that has ended or never was."""
        login = self._logins.get(key)
        if login is None:
            return None
        if self.has_ended(login):
            del self._logins[key]
            return None
        login.used = self._now()
        return login

    def has_ended(self, login: Login) -> bool:
        """A machine proves itself with each request, and with `hello`: it ends with its token (Access.is_valid)."""
        if login.has_logged_out:
            return True
        if login.is_machine:
            return False
        return self._now() - login.used >= self._idle_time or self._now() - login.begin >= self._longest_time

    def of_machine(self, user: str, role: str, hash: str) -> Login:
        """One that is not remembered."""
        return Login(user, role, self._now(), self._now(), hash=hash, is_machine=True)

    def use(self, login: Login) -> None:
        """Its user has done something."""
        login.used = self._now()

    def end(self, key: str) -> None:
        login = self._logins.pop(key, None)
        if login is not None:
            login.has_logged_out = True  # also for the pages that are open
