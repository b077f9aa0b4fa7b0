"""Settings that every test shares."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import settings

from thurston_cl import device

# Before anything imports pyopencl, whose cache of programs could hide a kernel that no longer compiles.
os.environ["PYOPENCL_NO_CACHE"] = "1"

# The same examples in every run, and no time limits: the first call of a kernel compiles it.
settings.register_profile("thurston", deadline=None, derandomize=True, print_blob=False)
settings.load_profile("thurston")

ROOT = Path(__file__).parents[1]


@pytest.fixture(scope="session")
def opencl_device() -> device.Device:
    """The device that the tests run on (THURSTON_DEVICE names another); an error where none works."""
    return device.choose()


@pytest.fixture
def forget_devices(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Iterator[None]:
    """A process that has not looked at its devices yet, and forgets afterwards what it saw."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    for variable in ("THURSTON_DEVICE", "PYOPENCL_CTX"):
        monkeypatch.delenv(variable, raising=False)
    monkeypatch.setattr(device, "_probed", {})
    caches = (device._enumerate, device._select, device._open)
    for cache in caches:
        cache.cache_clear()
    yield
    for cache in caches:
        cache.cache_clear()
