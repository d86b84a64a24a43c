"""Looks at every request before anything else does: its host, its origin; and at every response."""

from __future__ import annotations

from collections.abc import Awaitable, Callable, Collection
from dataclasses import dataclass
from urllib.parse import urlsplit

from aiohttp import hdrs, web
from aiohttp.typedefs import Middleware

from cnc_ptp.errors import CncError
from cnc_ptp.web.numbers import (
    NO_COMMAND_RIGHT,
    NO_PROGRAM,
    NOT_LOGGED_IN,
    TOO_MANY_LOGINS,
    TOO_MANY_MESSAGES,
    TOO_MANY_SESSIONS,
    WRONG_ORIGIN,
    WRONG_ROLE,
)
from cnc_ptp.web.protocol import NOTHING, error_fields

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
STATUS = {
    NOT_LOGGED_IN: 401,
    WRONG_ORIGIN: 403,
    WRONG_ROLE: 403,
    NO_COMMAND_RIGHT: 403,
    NO_PROGRAM: 404,
    TOO_MANY_LOGINS: 429,
    TOO_MANY_MESSAGES: 429,
    TOO_MANY_SESSIONS: 503,
}
"""Number of an error -> status of HTTP; 400 for others."""
Handler = Callable[[web.Request], Awaitable[web.StreamResponse]]


@dataclass(frozen=True, slots=True)
class Names:
    """The names under which the server may be asked, whatever their port."""

    names: Collection[str] = LOCAL_NAMES

    def require_host(self, request: web.Request) -> None:
        """Raises CncError 26237: another name may have been rebound to this computer (DNS rebinding)."""
        host = host_name(request.headers.get(hdrs.HOST, ""))
        if host not in [name.lower() for name in self.names]:
            raise CncError(WRONG_ORIGIN, f"host '{host[:60]}' is none of {', '.join(self.names)}", NOTHING)

    @staticmethod
    def require_origin(request: web.Request) -> None:
        """Raises CncError 26237 for a request that a page of another origin has made."""
        origin = request.headers.get(hdrs.ORIGIN)
        own = f"{request.scheme}://{request.headers.get(hdrs.HOST, '')}"
        if origin is not None and origin != own:
            raise CncError(WRONG_ORIGIN, f"origin '{origin[:60]}' is not {own}", NOTHING)


def host_name(host: str) -> str:
    try:
        return (urlsplit(f"//{host}").hostname or "").lower()
    except ValueError:
        return host


def make_guard(names: Names) -> Middleware:
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


def refuse(error: CncError, status: int = 0) -> web.Response:
    return web.json_response(error_fields(error), status=status or STATUS.get(error.number, 400))
