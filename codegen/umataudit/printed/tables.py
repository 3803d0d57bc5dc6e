"""Numbers of Tables 2, 3 and 4 as printed (units MPa, mm, s; temperatures in deg C)."""

from __future__ import annotations

from dataclasses import dataclass

from umataudit.printed.relation import NUMBER, meaning, ocr, printed, relation


@dataclass(frozen=True)
class Column:
    """One temperature column of Table 2 or 3; numbers as decimal text."""

    material: str
    temperature: int
    k: str
    a: str
    b_squeeze: str
    b_bleed: str


def _columns(material: str, k: str, a: str, b_squeeze: str, b_bleed: str) -> tuple[Column, ...]:
    rows = zip(range(30, 100, 10), k.split(), a.split(), b_squeeze.split(), b_bleed.split(), strict=True)
    return tuple(Column(material, *row) for row in rows)


COLUMNS = (
    *_columns(
        "IM7-8552",
        "0.933 0.895 0.86 0.836 0.813 0.801 0.795",
        "-0.954 -0.932 -0.909 -0.888 -0.866 -0.844 -0.822",
        "-18.15 -16.90 -15.63 -15.18 -14.93 -14.87 -14.98",
        "-34.88 -33.63 -32.36 -31.91 -31.66 -31.59 -31.71",
    ),
    *_columns(
        "IMA-M21",
        "0.96 0.8925 0.83 0.805 0.8 0.795 0.79",
        "-0.934 -0.818 -0.752 -0.731 -0.752 -0.8 -0.864",
        "-17.89 -15.78 -14.44 -13.9 -13.84 -13.98 -14.58",
        "-34.62 -32.51 -31.17 -30.63 -30.56 -30.70 -31.31",
    ),
)
TABLE_4 = {
    "E1": "25", "E2": "1.0e-6", "E3": "1.0e-6", "nu12": "0.01", "nu13": "0.01", "nu23": "0.01",
    "G13": "0.495e-6",
}  # fmt: skip

RELATIONS = (
    relation("T4.E3", "section 5.1, Table 4", "E3", "modulus along axis 3", printed("1.0e-6")),
    relation("T4.nu13", "section 5.1, Table 4", "nu13", "Poisson's ratio 13", printed("0.01")),
    relation("T4.G12", "section 5.1, Table 4", "G12", "printed '0.495-6'",
             ocr("0.495 - 6", "as recovered, a difference"), ocr("0.495e-6", "an e is missing")),
    relation("T4.G23", "section 5.1, Table 4", "G23", "shear modulus across the fibre", printed("1.0"), sort=NUMBER,
             note="'e-6' may have been lost, but 1.0e-6 would still be 2.02 times the derived value; Eq. 10 has no place for a"
             " G23 of its own"),
    relation("T4.definite", "sections 4.2 and 5.1, Table 4", "minor_sign",
             "the constants admit an elastic potential: sign of the smallest leading minor of the compliance",
             printed("1"), meaning("1", "major", "nu_12 is the major Poisson's ratio, -nu_12/E_1 in the compliance")),
)  # fmt: skip
