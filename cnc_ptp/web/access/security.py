"""What a server that others reach must have: TLS and users."""

from __future__ import annotations

import ipaddress
import ssl

from cnc_ptp.errors import CncError
from cnc_ptp.web.numbers import NO_CERTIFICATE, NOT_SECURED
from cnc_ptp.web.options import WebOptions

NOTHING = "nothing was started"


def is_loopback(host: str) -> bool:
    """Only this computer reaches it."""
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"


def require_secured(options: WebOptions, prefix: str = "--") -> None:
    """Raises CncError 26232 for an address that can be reached by others, without TLS or users.

    `prefix`: that of the options in the texts.
    """
    needed = {"tls-cert": options.certificate, "tls-key": options.key, "users": options.users}
    missing = [f"{prefix}{option}" for option, value in needed.items() if value is None]
    if missing and not is_loopback(options.host):
        verb = "is" if len(missing) == 1 else "are"
        reason = f"web: {options.host} can be reached by others, and {', '.join(missing)} {verb} missing"
        raise CncError(NOT_SECURED, reason, f"{NOTHING}; off loopback it needs TLS and users")
    if (options.certificate is None) != (options.key is None):
        raise CncError(NOT_SECURED, f"web: {prefix}tls-cert and {prefix}tls-key belong together", NOTHING)


def tls_context(certificate: str | None, key: str | None) -> ssl.SSLContext | None:
    """None without a certificate. Raises CncError 26247 for one that cannot be used."""
    if certificate is None:
        return None
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    context.minimum_version = ssl.TLSVersion.TLSv1_2
    try:
        context.load_cert_chain(certificate, key, password="")
    except (OSError, ssl.SSLError) as error:
        reason = error.reason if isinstance(error, ssl.SSLError) else error.strerror
        text = f"web: certificate {certificate} with key {key} cannot be used: {reason}"
        raise CncError(NO_CERTIFICATE, text, NOTHING) from None
    return context
