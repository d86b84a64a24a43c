"""The file of users: names, roles, salted hashes of passwords; tokens of machines."""

from __future__ import annotations

import hashlib
import os
import re
import secrets
import stat
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml
from argon2 import PasswordHasher
from argon2.exceptions import Argon2Error, InvalidHashError

from cnc_ptp import yaml_text
from cnc_ptp.errors import CncError, nearest_name
from cnc_ptp.web.access.rights import ROLES
from cnc_ptp.web.numbers import BAD_USERS

NAME = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_.@-]{0,31}")
SHORTEST_PASSWORD, LONGEST_PASSWORD = 8, 256
"""Characters; an argon2 hash of more would cost the server more."""
TOKEN_BYTES = 32
HASHER = PasswordHasher()
"""argon2id with the defaults of argon2-cffi, which are those of RFC 9106 for little memory."""
UNCHANGED = "nothing was changed"


@dataclass(frozen=True, slots=True)
class User:
    """One who may log in, or the token of a machine."""

    name: str
    role: str
    hash: str


class Users:
    """What the file says; it is read again when it has changed."""

    def __init__(self, file: str) -> None:
        """Raises CncError 26246."""
        self._file = Path(file)
        self._read_at = -1.0
        self._users: dict[str, User] = {}
        self._tokens: dict[str, User] = {}
        self._decoy = HASHER.hash(secrets.token_hex())
        self.read()

    def read(self) -> None:
        """Raises CncError 26246 for a file that cannot be used."""
        content = read_users(self._file)
        self._users, self._tokens = content["users"], content["tokens"]
        self._read_at = self._file.stat().st_mtime

    def _read_if_changed(self) -> None:
        try:
            if self._file.stat().st_mtime != self._read_at:
                self.read()
        except (CncError, OSError):
            self._users, self._tokens = {}, {}  # nobody, rather than former users
            self._read_at = -1.0

    def find(self, name: str, *, is_machine: bool = False) -> User | None:
        """A user, or a machine with its token; None for one who is none any longer."""
        self._read_if_changed()
        return (self._tokens if is_machine else self._users).get(name)

    def check(self, name: str, password: str) -> User | None:
        """The user with this password; takes as long for a name that there is not."""
        self._read_if_changed()
        user = self._users.get(name)
        try:
            given = password[:LONGEST_PASSWORD].encode(errors="surrogatepass")
            HASHER.verify(self._decoy if user is None else user.hash, given)
        except (Argon2Error, InvalidHashError):
            return None
        return user

    def of_token(self, token: str) -> User | None:
        """The machine with this token. Tokens are random and long: a plain hash cannot be guessed back."""
        self._read_if_changed()
        wanted = token_hash(token)
        return next((user for user in self._tokens.values() if secrets.compare_digest(user.hash, wanted)), None)


def token_hash(token: str) -> str:
    return hashlib.sha256(token.encode(errors="surrogatepass")).hexdigest()


def read_users(file: Path) -> dict[str, dict[str, User]]:
    """`users` and `tokens` by name. Raises CncError 26246."""
    try:
        mode = file.stat().st_mode
        content = yaml_text.load(file.read_text(encoding="utf-8")) or {}
    except OSError as error:
        raise unusable(file, str(error.strerror)) from None
    except (UnicodeDecodeError, yaml.YAMLError):
        raise unusable(file, "it is no YAML") from None
    if mode & (stat.S_IWGRP | stat.S_IWOTH):
        raise unusable(file, f"others may write it (mode {stat.S_IMODE(mode):o}); make it 600")
    if not isinstance(content, dict):
        raise unusable(file, "it has no users and tokens by name")
    return {kind: read_entries(file, kind, content.get(kind)) for kind in ("users", "tokens")}


def read_entries(file: Path, kind: str, entries: Any) -> dict[str, User]:
    if entries is None:
        return {}
    if not isinstance(entries, dict):
        raise unusable(file, f"{kind} are no names with role and hash")
    found = {}
    for name, fields in entries.items():
        if not isinstance(fields, dict) or not isinstance(fields.get("hash"), str) or fields.get("role") not in ROLES:
            raise unusable(file, f"{kind}: '{name}' has no role ({', '.join(ROLES)}) or no hash")
        found[str(name)] = User(str(name), fields["role"], fields["hash"])
    return found


def unusable(file: Path, reason: str) -> CncError:
    return CncError(BAD_USERS, f"users file {file} cannot be used: {reason}", "nothing was started")


# changes by the command line


def add_user(file: Path, name: str, role: str, password: str) -> None:
    """Adds a user, or gives one another role and password. Raises CncError 26246."""
    require_name(name)
    if not SHORTEST_PASSWORD <= len(password) <= LONGEST_PASSWORD:
        reason = f"a password has {SHORTEST_PASSWORD} to {LONGEST_PASSWORD} characters, not {len(password)}"
        raise CncError(BAD_USERS, f"user {name}: {reason}", UNCHANGED)
    try:
        text = password.encode()
    except UnicodeEncodeError:
        raise CncError(BAD_USERS, f"user {name}: the password is not UTF-8", UNCHANGED) from None
    change(file, "users", name, {"role": role, "hash": HASHER.hash(text)})


def add_token(file: Path, name: str, role: str) -> str:
    """A new token for a machine, which is shown once. Raises CncError 26246."""
    require_name(name)
    token = secrets.token_urlsafe(TOKEN_BYTES)
    change(file, "tokens", name, {"role": role, "hash": token_hash(token)})
    return token


def remove(file: Path, name: str) -> None:
    """A user or a token. Raises CncError 26246 for a name that there is not."""
    known = read_users(file)
    kinds = [kind for kind, entries in known.items() if name in entries]
    if not kinds:
        names = [each for entries in known.values() for each in entries]
        raise CncError(BAD_USERS, f"users file {file} has no '{name}'{nearest_name(name, names)}", UNCHANGED)
    for kind in kinds:
        change(file, kind, name, None)


def require_name(name: str) -> None:
    """Raises CncError 26246."""
    if NAME.fullmatch(name) is None:
        raise CncError(BAD_USERS, f"'{name[:40]}' is no name: letters, digits, _ . @ -", UNCHANGED)


def change(file: Path, kind: str, name: str, entry: dict[str, str] | None) -> None:
    """Writes the file again, whole or not at all, readable by its owner alone. Raises CncError 26246."""
    known = read_users(file) if file.exists() else {"users": {}, "tokens": {}}
    other = "tokens" if kind == "users" else "users"
    if entry is not None and name in known[other] and name not in known[kind]:  # recordings name who gave a command
        raise CncError(BAD_USERS, f"users file {file} has '{name}' among its {other} already", UNCHANGED)
    content: dict[str, dict[str, Any]] = {
        each: {user.name: {"role": user.role, "hash": user.hash} for user in users.values()}
        for each, users in known.items()
    }
    content[kind].pop(name, None)
    if entry is not None:
        content[kind][name] = entry
    try:
        write_whole(file, content)
    except OSError as error:
        reason = f"users file {file} cannot be written: {error.strerror}"
        raise CncError(BAD_USERS, reason, UNCHANGED) from None


def write_whole(file: Path, content: dict[str, dict[str, Any]]) -> None:
    """Or not at all."""
    number, other = tempfile.mkstemp(dir=file.resolve().parent, prefix=".users-")  # mode 600
    try:
        with os.fdopen(number, "w", encoding="utf-8") as stream:
            yaml.safe_dump(content, stream, sort_keys=True)
        os.replace(other, file)
    except BaseException:
        Path(other).unlink(missing_ok=True)
        raise
