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
"""Logins that are remembered, the newest ones."""


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
        key = secrets.token_urlsafe(32)
        self._logins[key] = Login(user, role, self._now(), self._now(), hash=hash)
        while len(self._logins) > MOST:
            del self._logins[next(iter(self._logins))]
        return key

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
        if login.has_logged_out:
            return True
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
