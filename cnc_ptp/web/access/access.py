"""Who requests are from, and what they may do."""

from __future__ import annotations

import asyncio
import secrets
from math import inf

from aiohttp import hdrs, web

from cnc_ptp.errors import CncError
from cnc_ptp.web.access.logins import Login, Logins
from cnc_ptp.web.access.users import Users
from cnc_ptp.web.numbers import NOT_LOGGED_IN, TOO_MANY_LOGINS
from cnc_ptp.web.protocol import NOTHING
from cnc_ptp.web.rate import Rate

COOKIE = "cnc_ptp"
"""Begin of its name; the port follows, as browsers send a cookie to all ports of a host."""
TOKEN_HEADER = "X-Token"
BEARER = "Bearer "
LOCAL_USER = "web"
"""Of a page of this computer without a login."""
LOGINS_PER_SECOND, LOGIN_BURST = 0.2, 5
"""Attempts for one name from one address, and for all together ten times as many."""
MOST_NAMES = 1000
"""Whose attempts are counted."""


class Access:
    """Finds out who a request is from."""

    def __init__(self, users: Users | None = None) -> None:
        """Without users there is no login: every page of this computer is a commissioner."""
        self._users = users
        self.logins = Logins(idle_time=inf, longest_time=inf) if users is None else Logins()
        self._attempts: dict[tuple[str, str], Rate] = {}
        self._all_attempts = Rate(10 * LOGINS_PER_SECOND, 10 * LOGIN_BURST)
        self._one_at_a_time = asyncio.Semaphore(1)

    @property
    def needs_login(self) -> bool:
        return self._users is not None

    def login_of(self, request: web.Request) -> Login:
        """By cookie, or by the token of a machine. Raises CncError 26238."""
        header = request.headers.get(hdrs.AUTHORIZATION, "")
        if self._users is not None and header.startswith(BEARER):
            return self._of_token(self._users, header.removeprefix(BEARER).strip())
        login = self.logins.find(key_of(request))
        if login is None or not self.is_valid(login):
            raise CncError(NOT_LOGGED_IN, "there is no login, or it has ended", f"{NOTHING}; log in")
        return login

    def _of_token(self, users: Users, token: str) -> Login:
        user = users.of_token(token)
        if user is None:
            raise CncError(NOT_LOGGED_IN, "the token is not known", NOTHING)
        login = self.logins.of_machine(user.name, user.role, user.hash)
        login.token = token
        return login

    def is_valid(self, login: Login) -> bool:
        """It has not ended, and its user still has the same role, and password or token."""
        if self.logins.has_ended(login):
            return False
        user = None if self._users is None else self._users.find(login.user, is_machine=login.is_machine)
        return self._users is None or (user is not None and (user.role, user.hash) == (login.role, login.hash))

    def require_page(self, request: web.Request) -> Login:
        """The login of a request that changes something: with the token of a page. Raises CncError 26238."""
        login = self.login_of(request)
        if not login.is_machine:
            self.require_token(login, request.headers.get(TOKEN_HEADER, ""))
        return login

    @staticmethod
    def require_token(login: Login, token: str) -> None:
        """Raises CncError 26238."""
        if not secrets.compare_digest(token.encode(errors="surrogatepass"), login.token.encode()):
            raise CncError(NOT_LOGGED_IN, "the token of the page is wrong", f"{NOTHING}; load the page again")

    async def log_in(self, name: str, password: str, address: str) -> str:
        """The value of a cookie; `address` of whoever tries. Raises CncError 26238, and 26255 for too many attempts."""
        if self._users is None:
            raise CncError(NOT_LOGGED_IN, "this server has no users", f"{NOTHING}; load the page again")
        self._require_attempt(name, address)
        async with self._one_at_a_time:  # a check takes memory and time
            user = await asyncio.to_thread(self._users.check, name, password)
        if user is None:
            raise CncError(NOT_LOGGED_IN, "name or password is wrong", NOTHING)
        self._attempts.pop((name, address), None)
        return self.logins.begin(user.name, user.role, user.hash)

    def _require_attempt(self, name: str, address: str) -> None:
        while len(self._attempts) >= MOST_NAMES:
            del self._attempts[next(iter(self._attempts))]
        rate = self._attempts.setdefault((name, address), Rate(LOGINS_PER_SECOND, LOGIN_BURST))
        if not rate.permits() or not self._all_attempts.permits():
            raise CncError(TOO_MANY_LOGINS, "too many attempts to log in", f"{NOTHING}; wait a minute")

    def log_out(self, request: web.Request) -> None:
        self.logins.end(key_of(request))

    def welcome(self, request: web.Request) -> str | None:
        """A page of this computer is logged in by looking at it, where no login is needed: the value of its cookie."""
        if self.needs_login or self.logins.find(key_of(request)) is not None:
            return None
        return self.logins.begin(LOCAL_USER, "commissioner")

    @staticmethod
    def remember(request: web.Request, response: web.StreamResponse, key: str) -> None:
        secure = request.scheme == "https"
        response.set_cookie(cookie_name(request), key, httponly=True, samesite="Strict", secure=secure, path="/")


def cookie_name(request: web.Request) -> str:
    """With the port as the browser knows it."""
    return f"{COOKIE}_{request.url.port}"


def key_of(request: web.Request) -> str:
    return request.cookies.get(cookie_name(request), "")
