"""Behaviours of scenes, compiled once."""

from __future__ import annotations

import pytest

from mgis.door import Door
from plyflow.hosts.mgis.behaviour import behaviour_of, compiled


@pytest.fixture(scope="session")
def bdf1() -> Door:
    behaviour = behaviour_of("bdf1")
    return Door(compiled(behaviour), behaviour.name)
