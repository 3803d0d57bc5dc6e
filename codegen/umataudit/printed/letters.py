"""The paper's letters: what each stands for, its unit, and the SymPy symbol behind it.

A letter that the model has too uses the model's symbol (`notation.TABLE`), so that a printed relation, a derived one and
the emitted one are expressions in the same symbols. Tensor letters become 3x3 matrices of symbols.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property

import sympy as sp

from umatgen.notation import TABLE

_SIGNS = {"positive": {"positive": True}, "negative": {"negative": True}, "real": {"real": True}}


@dataclass(frozen=True)
class Letter:
    """One letter of the paper.

    Parameters
    ----------
    name : how formulas in `printed` spell it; also its plain-text form.
    math : LaTeX.
    unit : unit as an expression in MPa, mm and s ("1" when there is none); with `logarithm` the unit of exp(letter).
    meaning : one line.
    sign : "positive", "negative" or "real".
    quantity : name in `notation.TABLE` when the model has it.
    shape : "" for a scalar, "general" or "symmetric" for a 3x3 tensor, "fourth" for one of fourth order.
    logarithm : whether the letter is the logarithm of something with a unit.
    """

    name: str
    math: str
    unit: str
    meaning: str
    sign: str = "positive"
    quantity: str = ""
    shape: str = ""
    logarithm: bool = False

    @cached_property
    def symbol(self) -> sp.Symbol:
        """SymPy symbol of a scalar letter."""
        if self.quantity:
            return TABLE.symbol(self.quantity)
        return sp.Symbol(self.name, **_SIGNS[self.sign])

    @cached_property
    def value(self) -> sp.Symbol | sp.Matrix:
        """Symbol of a scalar, 3x3 matrix of symbols of a tensor."""
        if not self.shape:
            return self.symbol
        if self.shape == "fourth":
            return sp.Array([_fourth(self.name, index) for index in range(81)], (3, 3, 3, 3))
        return sp.Matrix(3, 3, self.component)

    def component(self, i: int, j: int) -> sp.Symbol:
        """Symbol of one component (0-based) of a tensor letter."""
        if self.shape == "symmetric" and j < i:
            i, j = j, i
        return sp.Symbol(f"{self.name}_{i + 1}{j + 1}", real=True)


def _fourth(name: str, index: int) -> sp.Symbol:
    """Component of a fourth-order tensor with both minor symmetries."""
    i, j, k, m = index // 27, index // 9 % 3, index // 3 % 3, index % 3
    first, second = sorted((i, j)), sorted((k, m))
    digits = "".join(str(n + 1) for n in (*first, *second))
    return sp.Symbol(f"{name}_{digits}", real=True)


def _model(name: str, quantity: str, unit: str, math: str = "", logarithm: bool = False) -> Letter:
    known = TABLE[quantity]
    return Letter(name, math or known.math, unit, known.meaning, quantity=quantity, logarithm=logarithm)


def _letters() -> Iterable[Letter]:
    yield from (
        _model("w0", "w0", "mm"),
        _model("h0", "h0", "mm"),
        _model("k", "k_gap", "1"),
        _model("a", "a_rate", "1"),
        _model("b", "b_log", "MPa*s**(a+1)", "b", logarithm=True),
        _model("eps_l", "eps_lock", "1"),
        _model("chi_l", "chi_l", "1"),
        _model("chi_f", "chi_f", "1"),
        _model("J", "det_f", "1"),
        _model("I1", "i1", "1"),
        _model("I4", "i4", "1"),
        _model("I5", "i5", "1"),
        _model("J2", "j2", "1/s**2"),
        _model("I1s", "x_min", "1", "I_1^s"),
        _model("mu_T", "mu_t", "MPa"),
        _model("mu_L", "mu_l", "MPa"),
        _model("lam_e", "lambda_e", "MPa"),
        _model("alpha_e", "alpha_e", "MPa"),
        _model("beta_e", "beta_e", "MPa"),
        _model("dt", "dt", "s"),
    )
    yield from (
        Letter("sigma", r"\sigma", "MPa", "Cauchy stress along the compaction", "negative"),
        Letter("eps", r"\varepsilon", "1", "logarithmic (Hencky) compaction strain ln(h/h0)", "negative"),
        Letter("eps_dot", r"\dot\varepsilon", "1/s", "its rate", "negative"),
        Letter("h", "h", "mm", "current thickness"),
        Letter("h_dot", r"\dot h", "mm/s", "rate of the thickness", "negative"),
        Letter("w", "w", "mm", "current width"),
        Letter("eta_app", r"\eta_{app}", "MPa*s", "apparent viscosity"),
        Letter("eta_strain", r"\eta_{strain}", "MPa*s", "strain-dependent factor"),
        Letter("eta_rate", r"\eta_{rate}", "1", "rate-dependent factor"),
        Letter("eta_micro", r"\eta_{micro}", "MPa*s", "fibre-scale factor"),
        Letter("eta_micro_r", r"\eta_{micro}", "1", "fibre-scale factor without the resin viscosity"),
        Letter("eta_ply", r"\eta_{ply}", "1", "ply-scale factor"),
        Letter("eta_res", r"\eta_{resin}", "MPa*s", "viscosity of the resin"),
        Letter("m", r"\eta_{micro}", "MPa*s**n", "consistency of the power-law fluid, tau = m (shear rate)**n"),
        Letter("b_bar", r"\bar b", "s**a", "material parameter of Eq. 2", "real", logarithm=True),
        Letter("n", "n", "1", "exponent of the power-law fluid"),
        Letter("f_n", "f(n)", "1", "rate factor of the power-law fluid"),
        Letter("l0", "l_0", "mm", "fibre length"),
        Letter("d", "d", "mm", "edge length of the square fibre (section 3), fibre diameter (appendix)"),
        Letter("a_y", "a_y^i", "mm", "distance of the fibres along the compaction, initial cell"),
        Letter("eps_bulk", r"\varepsilon_{lock}", "1", "strain of the bulk at locking", "negative"),
        Letter("gamma_lock", r"\gamma_{lock}", "1", "largest shear at the ply edge"),
        Letter("lam", r"\lambda", "1", "stretch along the compaction"),
        Letter("lam_dot", r"\dot\lambda", "1/s", "its rate", "negative"),
        Letter("C11", "C_{11}", "1", "component of C along the compaction (axis 1 in the paper)"),
        Letter("Cdot11", r"\dot C_{11}", "1/s", "its rate", "negative"),
        Letter("I2", "I_2", "1", "second invariant of C"),
        Letter("I3", "I_3", "1", "det C"),
        Letter("I1b", "I_1^b", "1", "I1 - (1 + chi_l)"),
        Letter("f", "f", "MPa*s**(a+1)", "factor of the viscous potential, psi_v = f J2**((a+2)/2)"),
        Letter("psi_e", r"\psi^e", "MPa", "elastic potential"),
        Letter("psi_v", r"\psi^v", "MPa/s", "viscous potential"),
        Letter("alpha", r"\alpha", "1", "angle of the fibre columns"),
        Letter("alpha_f", r"\alpha_f", "1", "angle at the compaction limit"),
        Letter("A0", "A_0", "mm**2", "area of the unit cell at locking"),
        Letter("Af", "A_f", "mm**2", "area of the unit cell at the compaction limit"),
        Letter("V0", "V_0", "1", "initial fibre fraction"),
        Letter("Vf", "V_f", "1", "fibre fraction at the compaction limit"),
        Letter("r", "r", "mm", "fibre radius"),
        Letter("E2", "E_2", "MPa", "modulus across the fibre (Table 4)"),
        Letter("nu23", r"\nu_{23}", "1", "Poisson's ratio across the fibre (Table 4)"),
        Letter("X", "X", "1", "k/(sqrt(chi_f) exp(eps) - k): fibre edge over gap"),
        Letter("delta", r"\delta", "1", "small dilation"),
    )
    yield from (
        _model("chi_ratio", "chi_ratio", "1"),
        Letter("eps_transverse", r"\varepsilon_{trans}", "1", "transverse logarithmic strain"),
        Letter("ply_jump", r"\eta_{ply}^{(b)}/\eta_{ply}^{(a)}", "1", "ratio of Eq. 4b to Eq. 4a at locking"),
        Letter("lock_jump", r"\sigma^{(b)}/\sigma^{(a)}", "1", "ratio of bleeding to squeezing stress at locking"),
        Letter("lock_sign", r"\text{sign of the change at locking}", "1", "+1 up, -1 down"),
        Letter("ordinate", r"\text{ordinate}", "1", "ordinate of Fig. 6a"),
        Letter("free_sets", r"\text{sets of b}", "1", "number of sets of b"),
        Letter("share_in_range", r"\text{share of columns}", "1", "share of columns with 0.6 < V_f < 0.7"),
        Letter("psi", r"\psi", "MPa", "thermodynamic potential"),
        Letter("dpsi_v", r"\frac{\partial\psi^v}{\partial\dot C_{11}}", "MPa", "gradient of psi_v"),
        Letter("E3", "E_3", "MPa", "modulus along axis 3 (Table 4)"),
        Letter("nu13", r"\nu_{13}", "1", "Poisson's ratio 13 (Table 4)"),
        Letter("stage_test", r"\text{test for Eq. 14}", "1", "positive where Eq. 14 is to be used"),
        Letter("pressure_ratio", r"p_{60 N}/p_{240 N}", "1", "baseline over scale-up pressure at the last step"),
        Letter("last_level", r"\text{last level}", "1", "load of the fifth step in N, scale-up"),
        Letter("duration", r"\text{duration}", "s", "longest test"),
        Letter("G12", r"G_{12}", "MPa", "shear modulus along the fibre (Table 4)"),
        Letter("G23", r"G_{23}", "MPa", "shear modulus across the fibre (Table 4)"),
        Letter("minor_sign", r"\text{sign of the smallest minor}", "1", "of the compliance of Table 4"),
        Letter("trend", r"\text{sign of the change of } V", "1", "of the fibre fraction when compacting after locking"),
        Letter("number", r"\text{equation or section}", "1", "number that a cross-reference gives"),
    )
    yield from (
        Letter("F", r"\mathbf F", "1", "deformation gradient", shape="general"),
        Letter("C", r"\mathbf C", "1", "right Cauchy-Green tensor", shape="symmetric"),
        Letter("Cdot", r"\dot{\mathbf C}", "1/s", "its rate", shape="symmetric"),
        Letter("N0", r"\mathbf N_0", "1", "structural tensor of the fibre", shape="symmetric"),
        Letter("Se", r"\mathbf S^e", "MPa", "elastic second Piola-Kirchhoff stress", shape="symmetric"),
        Letter("Pe", r"\frac{\partial\psi^e}{\partial\mathbf C}", "MPa", "gradient of psi_e", shape="symmetric"),
        Letter("Pv", r"\frac{\partial\psi^v}{\partial\dot{\mathbf C}}", "MPa", "gradient of psi_v", shape="symmetric"),
        Letter("stress", r"\boldsymbol\sigma", "MPa", "Cauchy stress", shape="symmetric"),
        Letter("S", r"\mathbf S", "MPa", "second Piola-Kirchhoff stress", shape="symmetric"),
        Letter("jaumann", r"\boldsymbol\tau^{\nabla J}", "MPa/s", "Jaumann rate of J sigma", shape="symmetric"),
        Letter("dS_dC", r"\frac{\partial\mathbf S}{\partial\mathbf C}", "MPa", "derivative of S", shape="fourth"),
        Letter("D", r"\mathbf D", "1/s", "rate of deformation", shape="symmetric"),
        Letter("Ce", r"\mathbb C^e", "MPa", "elastic tangent", shape="fourth"),
        Letter("C4", r"\mathbb C", "MPa", "tangent of S", shape="fourth"),
        Letter("c4", r"\mathbb C", "MPa", "its push-forward", shape="fourth"),
        Letter("cp4", r"\mathbb C'", "MPa", "stress terms of the Jaumann rate", shape="fourth"),
    )


LETTERS = {letter.name: letter for letter in _letters()}


def sym(names: str) -> tuple[sp.Symbol, ...]:
    """Symbols of scalar letters, names separated by blanks."""
    return tuple(LETTERS[name].symbol for name in names.split())


def tensor(name: str) -> sp.Matrix:
    """The 3x3 matrix of a tensor letter."""
    return LETTERS[name].value
