"""The one symbol table: what a quantity is called in mathematics, in Python and in Fortran, its shape and its unit.

Every SymPy symbol used by the model is made here, and its SymPy name *is* its Fortran name, so that a printed
expression needs no renaming. Fortran does not tell upper from lower case: names equal when lower-cased are refused.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import sympy as sp


class NotationError(ValueError):
    """Two quantities would have the same Fortran name, or a name is not a Fortran name."""


@dataclass(frozen=True)
class Quantity:
    """One quantity of the model.

    Parameters
    ----------
    fortran : name in the emitted source and of the SymPy symbol.
    math : LaTeX of the paper's letter.
    unit : unit in the N, mm, s, MPa system; "-" when there is none.
    meaning : one line in the field's standard terms.
    shape : () for a scalar, (6,) for a symmetric tensor in Abaqus's order 11, 22, 33, 12, 13, 23, (3, 3) for F.
    sign : "positive" or "real": what SymPy may assume.
    """

    fortran: str
    math: str
    unit: str
    meaning: str
    shape: tuple[int, ...] = ()
    sign: str = "real"

    @property
    def symbol(self) -> sp.Symbol:
        """The SymPy symbol; two calls give the same symbol."""
        return sp.Symbol(self.fortran, real=True, positive=True if self.sign == "positive" else None)


class SymbolTable:
    """Quantities by Fortran name, in the order of declaration.

    Raises
    ------
    NotationError
        When a name is equal to another one after lower-casing, or is no Fortran name.
    """

    def __init__(self, quantities: Iterable[Quantity]) -> None:
        self._by_name: dict[str, Quantity] = {}
        for quantity in quantities:
            key = quantity.fortran.lower()
            if key in self._by_name:
                raise NotationError(
                    f"the names '{self._by_name[key].fortran}' and '{quantity.fortran}' are one name in Fortran; "
                    "rename one of them in umatgen/notation.py"
                )
            if not key.isidentifier() or not key.isascii() or len(key) > 31:
                raise NotationError(f"'{quantity.fortran}' is no Fortran name: ASCII letters, digits, '_', at most 31")
            self._by_name[key] = quantity

    def __getitem__(self, name: str) -> Quantity:
        return self._by_name[name.lower()]

    def __contains__(self, name: object) -> bool:
        return isinstance(name, str) and name.lower() in self._by_name

    def __iter__(self) -> Iterator[Quantity]:
        return iter(self._by_name.values())

    def symbol(self, name: str) -> sp.Symbol:
        """SymPy symbol of the quantity called `name` in Fortran."""
        return self[name].symbol


def _table() -> SymbolTable:
    positive = "positive"
    properties = [
        Quantity("w0", "w_0", "mm", "initial width of the tape or ply", sign=positive),
        Quantity("h0", "h_0", "mm", "initial thickness of the ply or ply block", sign=positive),
        Quantity("l0_over_d", "l_0/d", "-", "fibre length over edge length of the square fibre", sign=positive),
        Quantity("k_gap", "k", "-", "initial fibre gap parameter k", sign=positive),
        Quantity("a_rate", "a", "-", "rate exponent a; stress goes as rate**(a+1)"),
        Quantity("b_squeeze", "b_s", "ln(MPa s**(a+1))", "log viscosity b of the squeezing stage"),
        Quantity("b_bleed", "b_b", "ln(MPa s**(a+1))", "log viscosity b of the bleeding stage"),
        Quantity("eps_lock", r"\varepsilon^l", "-", "logarithmic compaction strain at locking, negative"),
        Quantity(
            "chi_ratio", r"\chi_l/\chi_f", "-", "ratio of the cell aspect ratios at lock and limit", sign=positive
        ),
        Quantity("e_l", "E_L", "MPa", "Young's modulus along the fibre", sign=positive),
        Quantity("e_t", "E_T", "MPa", "Young's modulus across the fibre", sign=positive),
        Quantity("nu_lt", r"\nu_{LT}", "-", "major Poisson's ratio"),
        Quantity("nu_tt", r"\nu_{TT}", "-", "Poisson's ratio in the transverse plane"),
        Quantity("g_lt", "G_{LT}", "MPa", "shear modulus along the fibre", sign=positive),
        Quantity("kappa", r"\kappa", "MPa", "penalty modulus of incompressibility before locking", sign=positive),
        Quantity("rate_floor", r"\dot\varepsilon_0", "1/s", "smallest rate told from zero", sign=positive),
        Quantity("dir_1", "n_1", "-", "fibre direction, component 1 (any length)"),
        Quantity("dir_2", "n_2", "-", "fibre direction, component 2"),
        Quantity("dir_3", "n_3", "-", "fibre direction, component 3"),
        Quantity("nor_1", "m_1", "-", "ply normal, component 1 (any length; the part across the fibre counts)"),
        Quantity("nor_2", "m_2", "-", "ply normal, component 2"),
        Quantity("nor_3", "m_3", "-", "ply normal, component 3"),
        Quantity(
            "strain_floor", r"\Delta\varepsilon_0", "-", "smallest strain increment told from zero", sign=positive
        ),
    ]
    kinematics = [
        Quantity("f0", "F_0", "-", "deformation gradient at the start of the increment", (3, 3)),
        Quantity("f1", "F_1", "-", "deformation gradient at the end of the increment", (3, 3)),
        Quantity("dt", r"\Delta t", "s", "time increment", sign=positive),
        Quantity("per_time", r"1/\Delta t", "1/s", "1/dt, or 0 where no time passes"),
        Quantity("dt_rate", r"dC_1/d\dot C", "s", "dC1 over dCdot: dt, less where the rate looks back", sign=positive),
        Quantity("det_f", "J", "-", "volume ratio, determinant of F", sign=positive),
        Quantity("i1", "I_1", "-", "trace of the right Cauchy-Green tensor C", sign=positive),
        Quantity("i4", "I_4", "-", "n.C.n, squared fibre stretch", sign=positive),
        Quantity("i5", "I_5", "-", "n.C.C.n", sign=positive),
        Quantity("a22", "A_{22}", "-", "transverse block of C, component 22", sign=positive),
        Quantity("a33", "A_{33}", "-", "transverse block of C, component 33", sign=positive),
        Quantity("a23", "A_{23}", "-", "transverse block of C, component 23"),
        Quantity("a_diff", r"\tfrac12(A_{22}-A_{33})", "-", "half the difference of the transverse diagonal"),
        Quantity("area2", "q", "-", "squared area ratio of the ply plane, or of the transverse plane", sign=positive),
        Quantity("radius", "r", "-", "radius of Mohr's circle of A", sign=positive),
        Quantity("cos2", r"\cos 2\theta", "-", "a_diff/radius, 0 where the transverse stretches coincide"),
        Quantity("sin2", r"\sin 2\theta", "-", "a23/radius, 0 where the transverse stretches coincide"),
        Quantity("x_end", "x", "-", "squared compaction stretch", sign=positive),
        Quantity("x_start", "x_0", "-", "squared compaction stretch at the start of the increment", sign=positive),
        Quantity("x_lock", "x_l", "-", "squared compaction stretch at the lock", sign=positive),
        Quantity("widening", "D_{22}", "-", "width at the lock over that at the start, where it is passed", sign=positive),
        Quantity("in_plane", "w_p", "-", "weight of the rates in the ply plane in J2: 0 where the lock is passed, else 1"),
        Quantity("tilt_1", "u_1", "-", "n . C^-1 N over N . C^-1 N"),
        Quantity("tilt_2", "u_2", "-", "t . C^-1 N over N . C^-1 N"),
        Quantity("c12", "C_{12}", "-", "n . C t"),
        Quantity("c13", "C_{13}", "-", "n . C N"),
        Quantity("stretch", r"\sqrt x", "-", "compaction stretch exp(eps)", sign=positive),
        Quantity("area", "A", "-", "area ratio in the ply plane, J/stretch", sign=positive),
        Quantity("excess", r"\langle\ln A+\varepsilon^l\rangle", "-", "strain by which the ply is wider than at its lock, or 0"),
        Quantity("a_norm2", "t^2-2q", "-", "A:A, squared norm of the transverse block", sign=positive),
        Quantity("j2", "J_2", "1/s**2", "(1/2) Cdot:Cdot", sign="positive"),
        Quantity("j2_floor", "j_0", "1/s**2", "max(rate_floor, strain_floor/dt)**2", sign="positive"),
        Quantity("j2_eff", "J_2+j_0", "1/s**2", "J2 with its floor", sign="positive"),
        Quantity("cdot", r"\dot C", "1/s", "(C1 - C0)/dt, tensor components", (6,)),
        Quantity("history", r"\theta", "-", "weight of the last increment, dt/(dt + its length); 0: none"),
    ]
    law = [
        Quantity("b_log", "b", "ln(MPa s**(a+1))", "log viscosity b of the stage in force"),
        Quantity("chi_l", r"\chi_l", "-", "cell aspect ratio at locking, exp(-2 eps_lock)", sign=positive),
        Quantity("root_chi_l", r"\sqrt{\chi_l}", "-", "exp(-eps_lock)", sign=positive),
        Quantity("chi_f", r"\chi_f", "-", "cell aspect ratio at the compaction limit", sign=positive),
        Quantity("stretch_limit", r"k/\sqrt{\chi_f}", "-", "compaction stretch at the limit", sign=positive),
        Quantity("gap", r"\sqrt x - k/\sqrt{\chi_f}", "-", "distance of the stretch from its limit", sign=positive),
        Quantity("g_visc", "g", "MPa s", "viscous factor, S_v = g Cdot", sign=positive),
        Quantity("mu_t", r"\mu_T", "MPa", "transverse shear modulus", sign=positive),
        Quantity("mu_l", r"\mu_L", "MPa", "longitudinal shear modulus", sign=positive),
        Quantity("lambda_e", r"\lambda", "MPa", "volumetric constant of Eq. 10"),
        Quantity("alpha_e", r"\alpha", "MPa", "coupling constant of Eq. 10"),
        Quantity("beta_e", r"\beta", "MPa", "fibre constant of Eq. 10"),
        Quantity("p_start", "p_0", "MPa", "constraint pressure carried over from the last increment"),
        Quantity("kappa_eff", r"\kappa", "MPa", "penalty modulus in force: kappa, or 0 once locked", sign="positive"),
        Quantity("kappa_held", r"\kappa_w", "MPa", "penalty modulus of the width: 0 before the lock, then kappa", sign="positive"),
    ]
    factors = [
        Quantity("closeness", r"k/(\sqrt{\chi_f}e^\varepsilon-k)", "-", "k/(sqrt(chi_f) exp(eps) - k)", sign=positive),
        Quantity("ply", r"\eta_{ply}", "-", "ply-scale factor of the viscosity", sign=positive),
        Quantity("micro", r"\eta_{micro}", "-", "fibre-scale factor of the viscosity", sign=positive),
        Quantity("j2_unit", "J_2/\\dot\\varepsilon^2", "-", "J2 of a unit compaction rate", sign=positive),
        Quantity("stretch_start", r"\\sqrt{x_0}", "-", "compaction stretch at the start of the increment", sign=positive),
        Quantity("lock_stretch", r"\\sqrt{x_l}", "-", "compaction stretch at the lock", sign=positive),
        Quantity("exponent", "m", "-", "1/(a + 1)", sign=positive),
        Quantity("delta", r"\\delta", "-", "stretch_start/stretch - 1"),
        Quantity("quotient", "q", "-", "delta over the strain ln(1 + delta)"),
        Quantity("quotient_slope", "q'", "-", "its derivative by delta"),
        Quantity("across", "w_2", "-", "share of C22**2 in A:A in the states of the squeeze law; 0 once locked"),
        Quantity("squeeze", "w", "-", "1 before the lock, 0 after it"),
        Quantity("path_mean", "M", "-", "mean of (eta/eta_end)**m over the strain path, over quotient"),
        Quantity("path_slope", "M'", "-", "its derivative by the stretch at the end"),
        Quantity("g_flow", "g", "MPa s", "viscous factor at the end of the path", sign=positive),
        Quantity("g_mean", "g R", "MPa s", "viscous factor of the mean over the path", sign=positive),
        Quantity("mean_stress", "s", "MPa", "mean effective viscous stress", sign=positive),
        Quantity("stress_last", "s'", "MPa", "mean effective viscous stress of the last increment", sign=positive),
        Quantity("rate_slowed", r"\\dot\\varepsilon", "1/s", "rate of ln(stretch) at the end under the mean stress"),
        Quantity("rate_end", r"\\dot\\varepsilon_1", "1/s", "rate of ln(stretch) at the end of the increment"),
        Quantity("dlnr", "r", "-", "d ln R/d stretch"),
        Quantity("dlnq", "p", "-", "d ln(strain rate in s over sqrt(J2/j2_unit))/d stretch"),
        Quantity("rate", r"e^b\dot\varepsilon^a", "MPa s", "rate factor of the viscosity, exp(b) rate**a", sign=positive),
    ]
    return SymbolTable([*properties, *kinematics, *law, *factors, *_results()])


def _results() -> list[Quantity]:
    """What stages hand on: spatial tensors, right factors of the tangent, state at start and end."""
    voigt: list[tuple[str, str, str]] = [
        ("b_left", "-", "F F^T"),
        ("fibre", "-", "z z, z = F n"),
        ("fibre_c", "-", "z (b z) + (b z) z"),
        ("transverse", "-", "F A F^T, A the transverse block of C"),
        ("m22", "-", "(F t)(F t)"),
        ("m33", "-", "(F N)(F N)"),
        ("m23", "-", "(F t)(F N) + (F N)(F t)"),
        ("normal", "-", "n n, n the unit normal of the deformed ply"),
        ("plane", "-", "I - n n, the projector on the ply plane"),
        ("y_rate", "1/s", "F Cdot F^T"),
        ("y_counted", "1/s", "F Cdot F^T of the rates that J2 counts"),
        ("r_visc", "MPa s", "(g/J) F (2 dln g/dC) F^T"),
        ("stress", "MPa", "Cauchy stress"),
    ]
    scalars: list[tuple[str, str, str]] = [
        ("p_stretch", "-", "stretch from I1 and I3"),
        ("p_norm2", "-", "(I1-1)**2 - 2 I3"),
        ("det_f_start", "-", "J at the start"),
        ("sine2", "-", "squared sine of the angle between fibre and normal"),
        ("width", "-", "stretch of the ply across the fibre: in-plane area ratio over fibre stretch"),
        ("eps_rate", "1/s", "rate of ln(stretch)"),
        ("energy", "MPa", "stored energy per reference volume"),
        ("pressure", "MPa", "constraint pressure, compression > 0"),
        ("power", "MPa/s", "viscous power per reference volume"),
    ]
    matrices = [("g0", "-", "F0 Q, Q = (n, t, N)"), ("g1", "-", "F1 Q")]
    shaped = [(voigt, (6,)), (scalars, ()), (matrices, (3, 3)), ([("ddsdde", "MPa", "(1/J) dtau/deps")], (6, 6))]
    return [Quantity(name, name, unit, meaning, shape) for rows, shape in shaped for name, unit, meaning in rows]


TABLE = _table()


def sym(*names: str) -> tuple[sp.Symbol, ...]:
    """Symbols of several quantities by Fortran name."""
    return tuple(TABLE.symbol(name) for name in names)


def describe(name: str) -> tuple[tuple[int, ...], str]:
    """Shape of a quantity, and its meaning with unit; slopes and coefficients are described by what they are of."""
    if name in TABLE:
        quantity = TABLE[name]
        return quantity.shape, f"{quantity.meaning} [{quantity.unit}]"
    for start, text in _DERIVED.items():
        if name.startswith(start):
            return (), text.format(name[len(start) :])
    return (), ""


_DERIVED = {
    "dlng_": "d ln g/d {}",
    "dflow_": "d ln g/d {} at the end of the path",
    "dstretch_d": "d p_stretch/d {}",
    "dnorm2_d": "d p_norm2/d {}",
    "c_": "coefficient of {} in tau [MPa]",
}
