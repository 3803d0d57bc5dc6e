"""CalculiX's tables are read as they are printed."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from plyflow.errors import RunError
from plyflow.hosts.calculix.output import read_increments, read_tables

DAT = """
 displacements (vx,vy,vz) for set NALL and time  0.1000000E+01

         1  0.000000E+00 -2.500000E-01  1.202148-105
        12  1.000000E+00  0.000000E+00  3.000000E+00

 total force (fx,fy,fz) for set NTOP and time  0.1000000E+01

       -1.592661E-02 -2.795900E-03 -4.013483E-01

 internal state variables (elem, integ.pnt.,values) for set BODY and time  0.1000000E+01

         1   1  1.000000E+00  2.000000E+00
         1   2  3.000000E+00  4.000000E+00

 displacements (vx,vy,vz) for set NALL and time  0.2000000E+01

         1  5.000000E+00  0.000000E+00  0.000000E+00
        12  6.000000E+00  0.000000E+00         NaN

 heat flux that nobody asked for

         1  9.000000E+00
"""
STA = """SUMMARY OF JOB INFORMATION
  STEP      INC     ATT  ITRS     TOT TIME     STEP TIME      INC TIME
     1          1     1     2  0.100000E+01  0.100000E+01  0.100000E+01
     1          2     1U    4  0.100000E+01  0.100000E+01  0.100000E+01
     1          2     2     3  0.152208E+01  0.152208E+01  0.522078E+00
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "job.dat").write_text(DAT)
    (tmp_path / "job.sta").write_text(STA)
    return tmp_path


def test_tables_are_keyed_by_quantity_and_set(folder: Path) -> None:
    tables = read_tables(folder / "job.dat")
    assert set(tables) == {("U", "NALL"), ("TOTAL", "NTOP"), ("SDV", "BODY")}
    moved = tables["U", "NALL"]
    assert moved.time == pytest.approx([1.0, 2.0])
    assert moved.keys == ((1,), (12,))
    assert moved.of(1) == pytest.approx(np.array([[0.0, -0.25, 0.0], [5.0, 0.0, 0.0]]))
    assert tables["SDV", "BODY"].of(1, 2) == pytest.approx(np.array([[3.0, 4.0]]))
    assert tables["TOTAL", "NTOP"].values[0, 0] == pytest.approx([-1.592661e-2, -2.7959e-3, -0.4013483])


def test_an_exponent_of_three_digits_and_nan_are_read(folder: Path) -> None:
    moved = read_tables(folder / "job.dat")["U", "NALL"]
    assert moved.of(1)[0, 2] == 1.202148e-105
    assert np.isnan(moved.of(12)[1, 2])


def test_a_point_that_was_not_printed_is_refused(folder: Path) -> None:
    with pytest.raises(KeyError, match="is not printed"):
        read_tables(folder / "job.dat")["U", "NALL"].of(3)


def test_failed_attempts_are_told_from_increments(folder: Path) -> None:
    table = read_increments(folder / "job.sta")
    assert list(table["failed"]) == [False, True, False]
    assert list(table["iterations"]) == [2, 4, 3]
    assert table["increment_size"].iloc[-1] == 0.522078


def test_a_job_without_output_is_named(tmp_path: Path) -> None:
    with pytest.raises(RunError, match=r"CalculiX wrote no job\.dat"):
        read_tables(tmp_path / "job.dat")
