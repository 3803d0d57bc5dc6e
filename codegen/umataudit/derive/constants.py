"""Table 4: what transverse isotropy forces."""

from __future__ import annotations

import sympy as sp

from umataudit.derive.derivation import Defined, Derivation, Printed, Step, derives, equals

_ISOTROPY = (Defined("transverse isotropy about the fibre (section 4.1): directions 2 and 3 are alike"),)


@derives("T4.E3", "T4.nu13", "T4.G12")
def alike(printed: Printed) -> Derivation:
    """The constant of direction 3 equals that of direction 2 (G12 equals G13)."""
    partner = {"T4.E3": "E2", "T4.nu13": "nu12", "T4.G12": "G13"}[printed.relation.id]
    result = printed.table_4[partner]
    return equals(printed, result, _ISOTROPY, (Step(f"equals ${partner}$ of the table", result),))


@derives("T4.G23")
def transverse_shear(printed: Printed) -> Derivation:
    """Stiffness 2323 from an isotropic transverse plane: rotate a shear by 45 degrees."""
    e, nu, g = sp.symbols("E2 nu23 G23", positive=True)
    half = 1 / sp.sqrt(2)
    turn = sp.Matrix([[half, -half], [half, half]])
    stress = turn * sp.diag(1, -1) * turn.T
    strain = turn * sp.diag((1 + nu) / e, -(1 + nu) / e) * turn.T
    (formula,) = sp.solve(sp.simplify(2 * strain[0, 1] * g - stress[0, 1]), g)
    result = formula.subs({e: printed.table_4["E2"], nu: printed.table_4["nu23"]})
    steps = (
        Step("stresses 1, -1 along 2, 3, turned by 45 degrees: a pure shear; its strain gives $G23$", formula),
        Step("with $E2$ and $nu23$ of the table, MPa", result),
    )
    return equals(printed, result, (*_ISOTROPY, "the shear modulus of an isotropic plane is $E/(2 (1 + nu))$"), steps)


@derives("T4.definite")
def definiteness(printed: Printed) -> Derivation:
    """Sylvester's criterion for the normal compliance; nu_12 is the major ratio, or the one ratio of Bonet and Burton."""
    major = printed.under == "major"
    e1, e2, nu12, nu23 = (printed.table_4[n] for n in ("E1", "E2", "nu12", "nu23"))
    across = -nu12 / e1 if major else -nu12 / e2
    compliance = sp.Matrix([[1 / e1, across, across], [across, 1 / e2, -nu23 / e2], [across, -nu23 / e2, 1 / e2]])
    minors = [compliance[:n, :n].det() for n in (1, 2, 3)]
    result = sp.sign(min(minors))
    one_ratio = "one Poisson's ratio, as in the formulas of Bonet and Burton (1998)"
    premises = (
        "$nu_12$ is the major Poisson's ratio" if major else one_ratio,
        "leading minors of the compliance must be positive (Sylvester)",
    )
    steps = (
        *(Step(f"leading minor {i}", minor) for i, minor in enumerate(minors, 1)),
        Step("Bonet and Burton's $m = 1 - nu - 2 n nu^2$ with $n = E1/E2$", 1 - nu12 - 2 * e1 / e2 * nu12**2),
        Step("the same $m$ with the inverse, $n = E2/E1$: definite", 1 - nu12 - 2 * e2 / e1 * nu12**2),
        Step("$1 - nu_23 - 2 nu_12^2 E2/E1$, with the major ratio", 1 - nu23 - 2 * nu12**2 * e2 / e1),
    )
    return equals(printed, result, premises, steps)
