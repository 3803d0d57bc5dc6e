"""UMATs compiled for the tests of the driver, and the executable built without Python."""

from __future__ import annotations

import ctypes
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

from plyflow.driver.drive import UmatAddress

SOURCES = Path(__file__).parent / "umats"
PROJECT = Path(__file__).parents[2]


@pytest.fixture(scope="session")
def umat(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], UmatAddress]:
    """Give the addresses of a test UMAT by the name of its source."""
    folder = tmp_path_factory.mktemp("umats")
    loaded: dict[str, tuple[UmatAddress, ctypes.CDLL]] = {}

    def load(name: str) -> UmatAddress:
        if name not in loaded:
            library = folder / f"{name}.so"
            command = ["gfortran", "-shared", "-fPIC", "-O1", "-o", str(library), str(SOURCES / f"{name}.f")]
            subprocess.run(command, check=True)
            handle = ctypes.CDLL(str(library))
            addresses = [_address(handle, symbol) for symbol in ("umat_", "plyflow_standin_take")]
            loaded[name] = (UmatAddress(addresses[0], addresses[1], str(library)), handle)
        return loaded[name][0]

    return load


def _address(handle: ctypes.CDLL, symbol: str) -> int:
    if not hasattr(handle, symbol):
        return 0
    return ctypes.cast(getattr(handle, symbol), ctypes.c_void_p).value or 0


@pytest.fixture(scope="session")
def executable(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Build plyflow-driver from a copy of its sources, as a user without Python would."""
    folder = tmp_path_factory.mktemp("executable")
    shutil.copy(PROJECT / "CMakeLists.txt", folder)
    shutil.copytree(PROJECT / "driver", folder / "driver")
    subprocess.run(["cmake", "-S", str(folder), "-B", str(folder / "build")], check=True, capture_output=True)
    subprocess.run(["cmake", "--build", str(folder / "build")], check=True, capture_output=True)
    return folder / "build" / "plyflow-driver"
