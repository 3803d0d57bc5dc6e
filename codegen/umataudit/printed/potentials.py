"""Section 4.1 to 4.3: thermodynamic frame, elastic and viscous potential (Eqs. 7 to 14), as printed."""

from __future__ import annotations

from umataudit.printed.relation import meaning, ocr, printed, relation

_RESIN = "eta_micro without eta_resin, which b holds"
_I1S = "1/2*((I1 - 1) - sqrt((I1 - 1)**2 - 4*I3))"

FRAME = (
    relation("7", "section 4.1, Eq. (7)", "psi", "the potential is the sum of an elastic and a viscous part",
             printed("psi_e + psi_v"),
             meaning("psi_e + psi_v", "", "a formal sum of an energy and a power, of which only the derivatives in Eq. 8 are used",
                     units_count=False)),
    relation("8", "section 4.1, Eq. (8)", "S", "second Piola-Kirchhoff stress from the two potentials",
             printed("2*(Pe + Pv)")),
    relation("9", "section 4.1, Eq. (9)", "stress", "Cauchy stress by push-forward of Eq. 8",
             printed("2/J*(F @ Pe @ transpose(F) + F @ Pv @ transpose(F))")),
    relation("10-I2", "section 4.2, below Eq. (10)", "I2", "second invariant of C",
             printed("1/2*(tr(C)**2 - tr(C @ C))")),
    relation("10-I3", "section 4.2, below Eq. (10)", "I3", "third invariant, J^2 = det C", printed("J**2")),
    relation(
        "10", "section 4.2, Eq. (10)", "psi_e", "transversely isotropic neo-Hookean potential (Bonet and Burton)",
        printed(
            "1/2*mu_T*(I1 - 3) - mu_T*ln(J) + 1/2*lam_e*(J - 1)**2"
            " + ((mu_T - mu_L) + alpha_e/4*ln(J) + beta_e/8*(I4 - 1))*(I4 - 1) + 1/2*(mu_T - mu_L)*(I5 - 1)"
        ),
        note="the sign of the last term is wrong whatever the constants mean; alpha/4 is wrong only for Spencer's alpha: the paper"
        " does not define alpha, and with one of twice that value alpha/4 holds",
    ),
    relation("4.3-I1", "section 4.3, first paragraph", "I1",
             "'the sum of the square of the eigenvalues of the deformation gradient', which is the trace of F F",
             printed("tr(F @ F)"),
             meaning("tr(transpose(F) @ F)", "", "eigenvalues of the stretch tensor U, whose squares sum to tr(F^T F)")),
    relation("4.3-J2", "section 4.3, first paragraph", "J2", "invariant of the rate", printed("1/2*tr(Cdot @ Cdot)")),
    relation("11", "section 4.3, Eq. (11)", "Pv", "pull-back of Eq. 9",
             printed("J/2*(inv(F) @ stress @ transpose(inv(F)))")),
)  # fmt: skip

VISCOUS = (
    relation("12-rate", "section 4.3, above Eq. (12)", "eps_dot", "Hencky strain rate of the stretch lambda",
             ocr("lam/lam", "as recovered, without the dot"), ocr("lam_dot/lam", "with a dot over the numerator")),
    relation("12-C", "section 4.3, above Eq. (12)", "C",
             "squeezing, axis 1 compaction, axis 3 inextensible fibre", printed("diag(lam**2, I3/lam**2, 1)")),
    relation("12-Cdot", "section 4.3, above Eq. (12)", "Cdot", "its rate at constant I3",
             printed("diag(2*lam_dot*lam, -2*I3*lam_dot/lam**3, 0)")),
    relation("12-I1", "section 4.3, above Eq. (12)", "I1", "first invariant in squeezing",
             ocr("C11 + I3/C11 + I3/2 + 1", "as recovered, with a stray I3/2"), ocr("C11 + I3/C11 + 1", "without it")),
    relation(
        "12-J2", "section 4.3, above Eq. (12)", "J2", "rate invariant in squeezing",
        ocr("1/2*(C11/C11**2)**2*((I1 - 1)**2 - 2*I3)", "as recovered, without a dot"),
        ocr("1/2*(Cdot11/C11**2)**2*((I1 - 1)**2 - 2*I3)", "with a dot over the numerator"),
        note="the recovered line has lost its dot, and the I1 beside it has gained a stray I3/2; if the square in the denominator"
        " came in that way too, the page is right",
    ),
    relation("12", "section 4.3, Eq. (12)", "dpsi_v", "gradient of the viscous potential, from Eqs. 1, 5 and 11",
             printed("-J/(2*lam**2)*eta_micro*eta_ply*exp(b)*(-eps_dot)**(a + 1)"),
             meaning("-J/(2*lam**2)*eta_micro_r*eta_ply*exp(b)*(-eps_dot)**(a + 1)", "resin in b", _RESIN)),
    relation("13-I1s", "section 4.3, below Eq. (13)", "I1s", "squared compaction stretch from I1 and I3", printed(_I1S)),
    relation("13-real", "section 4.3, below Eq. (13)", "I1s",
             "the same for any state, for instance C = (1 + delta) 1", printed(_I1S),
             note="the paper derives it for an inextensible fibre, C33 = 1, where it is real (13-I1s); a finite element passes other"
             " states too"),
    relation(
        "13", "section 4.3, Eq. (13)", "psi_v", "viscous potential before locking",
        printed(
            "(w0/h0)**2*(sqrt(chi_l)/chi_f)*(4*J*k*exp(b)/(a + 2))*(1/I1s)**(-3/2)"
            "*((k/(sqrt(I1s) - k/sqrt(chi_f)))**2 + 3*chi_f)*(1/(2*((I1 - 1)**2 + 2*I3)))**((a + 2)/2)*J2**((a + 2)/2)"
        ),
        note="the line of J2 above it has the minus before 2 I3",
    ),
    relation("4.3-stress", "section 4.3, first sentence", "sigma",
             "'under pure compression in the transverse direction' the potentials give back Eqs. 1 to 6 (squeezing)",
             printed("-eta_micro_r*eta_ply*exp(b)*(-eps_dot)**(a + 1)"),
             meaning("-eta_micro_r*eta_ply*exp(b)*(-eps_dot)**(a + 1)", "difference",
                     "sigma is sigma_11 - sigma_22: the multiplier frees the edge")),
    relation("14-C", "section 4.3, above Eq. (14)", "C", "bleeding: the width stays that of the lock",
             printed("diag(lam**2, chi_l, 1)")),
    relation("14-Cdot", "section 4.3, above Eq. (14)", "Cdot", "its rate", printed("diag(2*lam_dot*lam, 0, 0)")),
    relation("14-I1", "section 4.3, above Eq. (14)", "I1", "first invariant in bleeding", printed("C11**2 + chi_l + 1")),
    relation(
        "14-J2", "section 4.3, above Eq. (14)", "J2", "rate invariant in bleeding",
        ocr("C11**2", "as recovered, without a dot"), ocr("Cdot11**2", "with a dot"),
    ),
    relation("14-I1b", "section 4.3, below Eq. (14)", "C11", "I1^b = I1 - (1 + chi_l) is C11 after locking",
             printed("I1 - (1 + chi_l)")),
    relation(
        "14", "section 4.3, Eq. (14)", "psi_v", "viscous potential after locking",
        printed(
            "(l0*w0/(d*h0))**2*(chi_l/chi_f)*(4*J*k*exp(b)/(a + 2))*(1/I1b)*(k/(sqrt(I1b) - k/sqrt(chi_f)))**2"
            "*(1/(2*I1b**2))**((a + 2)/2)*J2**((a + 2)/2)"
        ),
    ),
)  # fmt: skip

RELATIONS = FRAME + VISCOUS
