from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

import pytest
from selenium.webdriver import Chrome

from browsing import chromium
from plyflow.umat.prepare import Umat, generate_scene, prepare_umat


@pytest.fixture(scope="session")
def umat() -> Umat:
    return prepare_umat()


@pytest.fixture(scope="session")
def bdf1() -> Umat:
    """The paper's backward difference, of first order."""
    return prepare_umat("bdf1")


@pytest.fixture(scope="session")
def manifest() -> dict[str, Any]:
    return dict(json.loads(json.dumps(generate_scene("default")[1])))


@pytest.fixture(scope="session")
def browser() -> Iterator[Chrome]:
    """A headless Chromium, started where a test asks for it."""
    with chromium() as started:
        yield started
