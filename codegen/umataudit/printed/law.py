"""Section 3: Table 1 and Eqs. 1 to 6, with the lines around them, as printed."""

from __future__ import annotations

from umataudit.printed.relation import WORDS, meaning, ocr, printed, relation

_CONSTANT_WIDTH = "the width under the plates stays w0 (material leaves them)"
_ROW_1 = (
    "the width under the plates stays w0, as in row 2 at n = 1; the words of the row, taken as constant volume, would give"
    " exp(-4 eps), as Eq. 4a has it"
)
_SHARE = (
    "k dimensionless, share of the cell face that the fibre covers at locking; gap/d = (sqrt(chi_f) exp(eps) - k)/k. Both are"
    " read back from Eq. 5: the paper claims 'a suitable form', not a solution"
)
_MICRO_A = "eta_res*2*sqrt(chi_l)*exp(eps)*k*((k/(sqrt(chi_f)*exp(eps) - k))**2 + 3)"
_MICRO_B = "eta_res*2*(l0/d)**2*k*(k/(sqrt(chi_f)*exp(eps) - k))**2"

RELATIONS = (
    relation(
        "T1.1", "section 3.1, Table 1, row 1 (Rogers)", "eta_strain",
        "Newtonian fluid, 'volume of squeezing fluid under loading plates remains constant', no slip",
        printed("eta_micro*(w0/h0)**2*exp(-2*eps)"),
        meaning("eta_micro*(w0/h0)**2*exp(-2*eps)", "constant width", _ROW_1),
    ),
    relation(
        "T1.2", "section 3.1, Table 1, row 2 (Wang and Gutowski)", "eta_app",
        "power-law fluid: eta_rate eta_strain, with eta_rate = f(n) times the rate to the n - 1 (rate by its magnitude)",
        printed("f_n*(-eps_dot)**(n - 1)*m*(w0/h0)**(n + 1)*exp(-eps*(n + 1))"),
        meaning("f_n*(-eps_dot)**(n - 1)*m*(w0/h0)**(n + 1)*exp(-eps*(n + 1))", "constant width", _CONSTANT_WIDTH),
    ),
    relation(
        "T1.3", "section 3.1, Table 1, row 3 (Kelly)", "",
        "percolation flow: 'a polynomial function of fibre volume fraction', 'interpolates between stress level at very "
        "slow and very high strain rates'",
    ),
    relation("1-rate", "section 3.1, below Eq. 1", "eps_dot", "rate of the Hencky strain ln(h/h0)", printed("h_dot/h")),
    relation(
        "1", "section 3.1, Eq. (1)", "sigma", "stress as the product of a strain and a rate term with the rate",
        printed("eta_strain*eta_rate*eps_dot"),
    ),
    relation(
        "2", "section 3.1, Eq. (2)", "eta_rate", "power law of the rate",
        printed("exp(b)*(-eps_dot)**a"),
        meaning("exp(b_bar)*(-eps_dot)**a", "bar", "the exponent is b-bar, as the line below Eq. 2 calls it"),
        note="the bar may have been lost in the recovered text",
    ),
    relation("3", "section 3.1, Eq. (3)", "sigma", "eta_strain as the product of a ply and a fibre term",
             printed("eta_micro*eta_ply*eta_rate*eps_dot")),
    relation("4-strain", "section 3.1, above Eq. (4)", "eps_transverse",
             "before locking the transverse strain is equal and opposite to the compaction strain", printed("-eps")),
    relation(
        "4a", "section 3.1, Eq. (4a)", "eta_ply", "ply term before locking, from Rogers' solution",
        printed("2*(w0/h0)**2*exp(-4*eps)"),
        meaning("2*(w0/h0)**2*exp(-4*eps)", "factor", "up to a constant factor, which the fitted b takes up"),
    ),
    relation(
        "4b", "section 3.1, Eq. (4b)", "eta_ply", "ply term after locking, width fixed at the lock",
        printed("2*(w0/h0)**2*exp(-2*(eps + eps_l))"),
        meaning("2*(w0/h0)**2*exp(-2*(eps + eps_l))", "factor", "up to a constant factor, which the fitted b takes up"),
    ),
    relation("4-lock", "section 3.1, below Eq. (4)", "ply_jump",
             "eta_ply 'ensures a smooth transition': ratio of (4b) to (4a) at locking", printed("1")),
    relation(
        "4-power", "section 3.1, Eq. (4a) beside Eq. (2)", "eta_ply",
        "width over thickness enters squared, whatever the rate exponent a",
        printed("2*(w0/h0)**2*exp(-4*eps)"),
        meaning("2*(w0/h0)**2*exp(-4*eps)", "newtonian", "the ply term is that of a Newtonian fluid, a = 0"),
    ),
    relation("5a", "section 3.1, Eq. (5a)", "eta_micro", "fibre term before locking",
             printed(_MICRO_A), meaning(_MICRO_A, "share", _SHARE)),
    relation("5b", "section 3.1, Eq. (5b)", "eta_micro", "fibre term after locking",
             printed(_MICRO_B), meaning(_MICRO_B, "share", _SHARE)),
    relation(
        "5-k", "section 3.1, below Eq. (5)", "k",
        "k is 'the product of d by the distance between fibres in the compaction direction' of the initial cell",
        printed("d*a_y"), meaning("d/a_y", "", "the ratio of the two lengths, up to a number"),
    ),
    relation("5-chi_l", "section 3.1, below Eq. (5)", "chi_l", "aspect ratio of the unit cell at locking",
             printed("exp(-2*eps_l)")),
    relation(
        "5-chi_f", "section 3.1, below Eq. (5)", "chi_ratio",
        "chi_l is about 0.7 chi_f, from fibre fractions of 50 % and 'about 70 %'",
        printed("0.7"), meaning("0.7", "rounded", "rounded to the one decimal that is printed"),
    ),
    relation("5-lock", "section 3.1, above Eq. (3) and in the conclusion", "lock_jump",
             "'a smooth transition between the two flow regimes': ratio of bleeding to squeezing stress at locking",
             printed("1"), sort=WORDS,
             note="the thickness and eta_ply (4-lock) are continuous; it is eta_micro, and with it stress or creep rate, that jumps"),
    relation("5-increase", "section 3.1, above Eq. (5)", "lock_sign",
             "at locking the change of flow direction leads 'to a further increase in viscosity' (+1; a decrease is -1)",
             printed("1"),
             meaning("1", "fibre term", "the viscosity is eta_micro of Eq. 5, which the paragraph is about, not the stress"),
             sort=WORDS),
    relation(
        "6", "section 3.1, Eq. (6)", "eps_l", "strain at locking, from the edge or from the bulk",
        printed("maximum(-ln(sqrt(2/3*(h0/w0)*tan(gamma_lock) + 1)), 2/3*eps_bulk)"),
    ),
    relation(
        "3.2-axis", "section 3.2, ordinate of Fig. 6a", "ordinate",
        "over the rate, in a log-log diagram, a straight line of slope a and intercept b (recovered: nu/E in the numerator)",
        ocr("-sigma/(eta_ply*eta_micro)", "numerator: the stress"),
        ocr("sigma/eps_dot/(eta_ply*eta_micro)", "numerator: the stress over the rate"),
    ),
    relation("3.2-b", "section 3.2", "b", "'we write b = b-bar . ln(eta_res)'", printed("b_bar*ln(eta_res)"),
             note="the sign between the two is recovered as a dot; a plus on the page would be the derived form"),
    relation("T2-3.b", "section 3.2 and Tables 2, 3", "free_sets",
             "'two distinct set of parameters a and b are obtained (one for squeezing and one bleeding)'", printed("2"),
             meaning("2", "distinct", "distinct in value, not independent: b differs by one constant, a is printed once for both"),
             sort=WORDS),
    relation("T2-3.Vf", "appendix, below Eq. (A.1), with Tables 2, 3", "share_in_range",
             "V_f = k^2 gives 60 % to 70 % above 50 C: share of the tables' columns for which it does", printed("1")),
)  # fmt: skip
