"""Which requests are answered: their host, their origin, who they are from."""

from __future__ import annotations

import secrets
from collections.abc import Awaitable, Callable, Collection
from dataclasses import dataclass
from urllib.parse import urlsplit

from aiohttp import hdrs, web

from cnc_ptp.errors import CncError
from cnc_ptp.web.logins import Login, Logins
from cnc_ptp.web.numbers import NOT_LOGGED_IN, WRONG_ORIGIN
from cnc_ptp.web.protocol import NOTHING, error_fields

COOKIE = "cnc_ptp"
TOKEN_HEADER = "X-Token"
LOCAL_USER = "web"
"""Of a page of this computer without a login."""
LOCAL_NAMES = ("localhost", "127.0.0.1", "::1")
HEADERS = {
    "Content-Security-Policy": "default-src 'self'; img-src 'self' data: blob:; object-src 'none'; base-uri 'none'; "
    "form-action 'self'; frame-ancestors 'none'",
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
}
Handler = Callable[[web.Request], Awaitable[web.StreamResponse]]


@dataclass(frozen=True, slots=True)
class Names:
    """The names under which the server may be asked, whatever their port."""

    names: Collection[str] = LOCAL_NAMES

    def require_host(self, request: web.Request) -> None:
        """Raises CncError 26237: another name may have been bent to this computer (DNS rebinding)."""
        host = urlsplit(f"//{request.headers.get(hdrs.HOST, '')}").hostname or ""
        if host.lower() not in self.names:
            raise CncError(WRONG_ORIGIN, f"host '{host[:60]}' is none of {', '.join(self.names)}", NOTHING)

    @staticmethod
    def require_origin(request: web.Request) -> None:
        """Raises CncError 26237 for a request that a page of another origin has made."""
        origin = request.headers.get(hdrs.ORIGIN)
        own = f"{request.scheme}://{request.headers.get(hdrs.HOST, '')}"
        if origin is not None and origin != own:
            raise CncError(WRONG_ORIGIN, f"origin '{origin[:60]}' is not {own}", NOTHING)


def make_middleware(names: Names) -> Callable[[web.Request, Handler], Awaitable[web.StreamResponse]]:
    """Checks every request; refusals become JSON with their number."""

    @web.middleware
    async def guard(request: web.Request, handler: Handler) -> web.StreamResponse:
        try:
            names.require_host(request)
            names.require_origin(request)
            response = await handler(request)
        except CncError as error:
            response = refuse(error)
        except web.HTTPException as error:
            error.headers.update(HEADERS)
            raise
        if not response.prepared:
            response.headers.update(HEADERS)
        return response

    return guard


STATUS = {WRONG_ORIGIN: 403, NOT_LOGGED_IN: 401}


def refuse(error: CncError, status: int = 0) -> web.Response:
    return web.json_response(error_fields(error), status=status or STATUS.get(error.number, 400))


class Access:
    """Finds out who a request is from."""

    def __init__(self, *, needs_login: bool) -> None:
        """Without a login every page of this computer is a commissioner."""
        self.needs_login = needs_login
        self.logins = Logins()

    def login_of(self, request: web.Request) -> Login:
        """Raises CncError 26238."""
        login = self.logins.find(request.cookies.get(COOKIE, ""))
        if login is None:
            raise CncError(NOT_LOGGED_IN, "there is no login, or it has ended", f"{NOTHING}; log in")
        return login

    def require_page(self, request: web.Request) -> Login:
        """The login of a request that changes something; it has the token of a page. Raises CncError 26238."""
        login = self.login_of(request)
        self.require_token(login, request.headers.get(TOKEN_HEADER, ""))
        return login

    @staticmethod
    def require_token(login: Login, token: str) -> None:
        if not secrets.compare_digest(token.encode(), login.token.encode()):
            raise CncError(NOT_LOGGED_IN, "the token of the page is wrong", f"{NOTHING}; load the page again")

    def welcome(self, request: web.Request, response: web.StreamResponse) -> None:
        """A page of this computer is logged in by looking at it, where no login is needed."""
        if not self.needs_login and self.logins.find(request.cookies.get(COOKIE, "")) is None:
            self.remember(request, response, self.logins.begin(LOCAL_USER, "commissioner"))

    @staticmethod
    def remember(request: web.Request, response: web.StreamResponse, key: str) -> None:
        secure = request.scheme == "https"
        response.set_cookie(COOKIE, key, httponly=True, samesite="Strict", secure=secure, path="/")
