"""Numbers of Tables 2, 3 and 4 as printed (units MPa, mm, s; temperatures in deg C), kept as decimal text."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Column:
    """One temperature column of Table 2 or 3."""

    material: str
    temperature: int
    k: str
    a: str
    b_squeeze: str
    b_bleed: str


_ROWS = {
    "IM7-8552": (
        "0.933 0.895 0.86 0.836 0.813 0.801 0.795",
        "-0.954 -0.932 -0.909 -0.888 -0.866 -0.844 -0.822",
        "-18.15 -16.90 -15.63 -15.18 -14.93 -14.87 -14.98",
        "-34.88 -33.63 -32.36 -31.91 -31.66 -31.59 -31.71",
    ),
    "IMA-M21": (
        "0.96 0.8925 0.83 0.805 0.8 0.795 0.79",
        "-0.934 -0.818 -0.752 -0.731 -0.752 -0.8 -0.864",
        "-17.89 -15.78 -14.44 -13.9 -13.84 -13.98 -14.58",
        "-34.62 -32.51 -31.17 -30.63 -30.56 -30.70 -31.31",
    ),
}
COLUMNS = tuple(
    Column(material, *column)
    for material, rows in _ROWS.items()
    for column in zip(range(30, 100, 10), *(row.split() for row in rows), strict=True)
)
TABLES = ("Tables 2, 3", "Table 4")
TABLE_4 = {
    "E1": "25", "E2": "1.0e-6", "E3": "1.0e-6", "nu12": "0.01", "nu13": "0.01", "nu23": "0.01", "G13": "0.495e-6",
}  # fmt: skip
