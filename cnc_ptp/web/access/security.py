"""What a server that others reach must have: TLS and users."""

from __future__ import annotations

import ipaddress
import ssl

from cnc_ptp.errors import CncError
from cnc_ptp.web.numbers import NO_CERTIFICATE, NOT_SECURED

NOTHING = "nothing was started"


def is_loopback(host: str) -> bool:
    """Only this computer reaches it."""
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"


def require_secured(host: str, certificate: str | None, key: str | None, users: str | None) -> None:
    """Raises CncError 26232 for an address that can be reached by others, without TLS or users."""
    needed = {"--tls-cert": certificate, "--tls-key": key, "--users": users}
    missing = [option for option, value in needed.items() if value is None]
    if missing and not is_loopback(host):
        verb = "is" if len(missing) == 1 else "are"
        reason = f"web: {host} can be reached by others, and {', '.join(missing)} {verb} missing"
        raise CncError(NOT_SECURED, reason, f"{NOTHING}; off loopback it needs TLS and users")
    if (certificate is None) != (key is None):
        raise CncError(NOT_SECURED, "web: --tls-cert and --tls-key belong together", NOTHING)


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
