"""Passwords are hashed quickly: what an argon2 hash costs is not what these tests are about."""

import pytest
from argon2 import PasswordHasher

from cnc_ptp.web.access import users


@pytest.fixture(scope="session", autouse=True)
def quick_hashes():
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(users, "HASHER", PasswordHasher(time_cost=1, memory_cost=8, parallelism=1))
        yield
