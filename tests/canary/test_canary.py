"""The canary has nothing to say of a right host, and names the mistake of each wrong one, once."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from canary.planted_hosts import ASSUMED, changed, host, iterations, late
from plyflow.cli import main
from plyflow.diagnose.mistakes import COMPONENTS
from plyflow.hosts.canary.trials import trials

NOTHING = "three increments seen, nothing to report"
SWAPPED = [0, 1, 2, 5, 4, 3]
HALF = np.array([1.0, 1.0, 1.0, 0.5, 0.5, 0.5])
NAN = np.full((3, 3), np.nan)
# Host, and what the canary says of it.
HOSTS: dict[str, tuple[dict[str, Any], str]] = {
    "F is null": ({"change": changed(f1=lambda c: np.zeros((3, 3)))}, "DFGRD1 is null"),
    "F is the identity": ({"change": changed(f0=lambda c: np.eye(3), f1=lambda c: np.eye(3))}, "DFGRD1 is the identity although"),
    "F is not finite": ({"change": changed(f1=lambda c: NAN)}, "DFGRD0 or DFGRD1 is not finite"),
    "F is turned inside out": ({"change": changed(f1=lambda c: -c.f1)}, "det DFGRD1 is not positive"),
    "F is transposed": ({"change": changed(f0=lambda c: c.f0.T, f1=lambda c: c.f1.T)}, "DFGRD0 and DFGRD1 are transposed"),
    "F0 is not the last F1": ({"change": late(changed(f0=lambda c: 1.001 * c.f0))}, "DFGRD0 is not the DFGRD1 of the last"),
    "F0 is the identity": ({"change": changed(f0=lambda c: np.eye(3))}, "DFGRD0 is not the DFGRD1 of the last"),
    "the first F0 is no identity": ({"change": changed(f0=lambda c: 1.01 * c.f0)}, "DFGRD0 is not the identity in the first"),
    "tensor shears": ({"change": changed(strain_increment=lambda c: HALF * c.strain_increment)}, "DSTRAN has tensor shears"),
    "shears 23, 13, 12": (
        {"change": changed(strain_increment=lambda c: c.strain_increment[SWAPPED])}, "the shears of DSTRAN are in another order"),
    "twice the strain": ({"change": changed(strain_increment=lambda c: 2.0 * c.strain_increment)}, "DSTRAN is not the strain"),
    "DROT is no rotation": ({"change": changed(rotation=lambda c: np.zeros((3, 3)))}, "DROT is no rotation"),
    "DROT is not finite": ({"change": changed(rotation=lambda c: NAN)}, "DROT is not finite"),
    "DROT is the identity": ({"change": changed(rotation=lambda c: np.eye(3))}, "DROT is the identity although"),
    "DROT is transposed": ({"change": changed(rotation=lambda c: c.rotation.T)}, "DROT is transposed"),
    "another DROT": ({"change": changed(rotation=lambda c: c.rotation @ c.rotation @ c.rotation)}, "DROT is not the rotation of"),
    "time runs backwards": ({"change": late(changed(dt=lambda c: -c.dt))}, "DTIME is negative"),
    "step time beyond the total": ({"change": changed(time=lambda c: (c.time[0] + 1.0, c.time[1]))}, "TIME(1), the time in the step"),
    "increments from 0": ({"change": changed(increment=lambda c: c.increment - 1)}, "KSTEP and KINC count from 1"),
    "increments stay at 1": ({"change": changed(increment=lambda c: 1)}, "KINC stays at 1"),
    "the state is not carried": ({"carries": False}, "STATEV came back as zero"),
    "the state is altered": ({"change": late(changed(state=lambda c: 1.1 * c.state))}, "STATEV came back altered"),
    "the state is handed on between iterations": ({"keeps_attempt": True}, "STATEV is not that of the start"),
    "the state is not set back after a cutback": ({"keeps_attempt": True, "ask": True}, "STATEV is not that of the start"),
    "plane stress": ({"change": changed(ndi=lambda c: 2)}, "NDI, NSHR, NTENS are not"),
    "PNEWDT ignored": ({"ask": True, "ignores_ratio": True}, "PNEWDT is ignored"),
}  # fmt: skip


@pytest.mark.parametrize("ask", [False, True])
def test_of_a_right_host_there_is_nothing_to_report(ask: bool, tmp_path: Path) -> None:
    said = host(tmp_path / "canary.so", ask=ask)
    assert said.count("canary:") == 1
    assert NOTHING in said


@pytest.mark.parametrize("mistake", HOSTS)
def test_a_mistake_of_the_host_is_named_once(mistake: str, tmp_path: Path) -> None:
    options, expected = HOSTS[mistake]
    said = host(tmp_path / "canary.so", **options)
    assert said.count(f"canary: {expected}") == 1
    assert NOTHING not in said


def test_the_shears_are_where_the_order_says(tmp_path: Path) -> None:
    assert COMPONENTS[3:] == ("12", "13", "23")
    swapped = {"change": changed(strain_increment=lambda c: c.strain_increment[SWAPPED])}
    assert "5: 23 13 12) (value 5.0" in host(tmp_path / "canary.so", **swapped)


@pytest.mark.parametrize("assumed", ASSUMED)
def test_the_host_needs_fewest_iterations_with_the_rate_that_it_assumes(assumed: int, tmp_path: Path) -> None:
    counts = {rate: iterations(tmp_path / f"{rate}.so", rate, assumed) for rate in ASSUMED}
    best = counts.pop(assumed)
    assert 2 * best < min(counts.values())


def test_driver_calculix_and_opengeosys_are_told_what_they_do(tmp_path: Path) -> None:
    found = {(one.host, one.rate): one for one in trials(tmp_path)}
    # DDSDDE is that of the Jaumann rate of the Kirchhoff stress, over J; the MGIS behaviour takes it from there.
    for name in ("driver", "OpenGeoSys"):
        best, *others = (found[name, rate].iterations or np.inf for rate in (1, 2, 3))
        assert best <= 5.0
        assert min(others) > 2.0 * best
        assert found[name, 1].said == (NOTHING,)
        assert found[f"{name}, half an increment asked for", 1].said == (NOTHING,)
    # CalculiX's door for Abaqus UMATs, 2.20: strains of its own, no DROT, and it goes on.
    assert any("DROT is no rotation" in said for said in found["CalculiX", 1].said)
    assert any("PNEWDT is ignored" in said for said in found["CalculiX, half an increment asked for", 1].said)
    # OpenGeoSys's F-bar scales the start by the volume ratio of the end.
    assert any("DFGRD0 is not the DFGRD1" in said for said in found["OpenGeoSys, F-bar, held", 1].said)


def test_the_command_writes_source_library_and_how_to_use_them(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["canary", "-o", str(tmp_path)]) == 0
    names = {Path(line).name for line in capsys.readouterr().out.split()}
    assert {"canary.for", "canary.inp", "libPlyflowCanary.so", "libPFCANARY.so", "PlyflowCanary.c"} <= names
    assert names == {path.name for path in tmp_path.iterdir()}
    assert ".TRUE." in (tmp_path / "canary.for").read_text()
