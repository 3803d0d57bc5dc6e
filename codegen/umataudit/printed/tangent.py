"""Section 4.4: choice of the potential, stress and tangent (Eqs. 15 to 17), as printed."""

from __future__ import annotations

from umataudit.printed.relation import meaning, ocr, printed, relation

_BRACKET = "(a + 2)/dt*f*J2**(a/2)*(a/2*J2**(-1)*dyad(Cdot, Cdot) + identity4)"

RELATIONS = (
    relation("4.4-rule", "section 4.4, first paragraph", "stage_test",
             "Eq. 14 when 'the logarithmic strain in the compaction direction is greater than the strain at locking'",
             printed("eps - eps_l"), meaning("-eps + eps_l", "", "greater in magnitude (as in the caption of Fig. 5)")),
    relation("15-f", "section 4.4, above Eq. (15)", "psi_v", "form of both potentials",
             ocr("f*J2**((alpha_e + 2)/2)", "as recovered, with an alpha in the exponent"),
             ocr("f*J2**((a + 2)/2)", "with the rate exponent a")),
    relation("15", "section 4.4, Eq. (15)", "S", "second Piola-Kirchhoff stress",
             printed("Se + (a + 2)*f*J2**(a/2)*Cdot")),
    relation("16-f", "section 4.4, Eq. (16)", "dS_dC", "derivative of Eq. 15 to C at the end of the increment",
             printed(f"Ce + {_BRACKET}"), meaning(f"Ce + {_BRACKET}", "frozen", "f(I1, I3) is held fixed")),
    relation("16", "section 4.4, Eq. (16)", "C4", "the tangent that Eq. 17 pushes forward, f held fixed",
             printed(f"Ce + {_BRACKET}"),
             note="as the derivative to C the printed form is right (16-f); the factor 2 is missing between Eqs. 16 and 17, in"
             " either of them"),
    relation("17-push", "section 4.4, below Eq. (17)", "c4", "push-forward of the tangent",
             printed("1/J*F[i,l]*F[j,l]*F[k,K]*F[l,L]*C4[I,J,K,L]"),
             ocr("1/J*F[i,I]*F[j,I]*F[k,K]*F[l,L]*C4[I,J,K,L]", "l after F_i and F_j taken for a capital I"),
             note="l and I are hard to tell apart in the recovered text; if the page has a J after F_j, it is right"),
    relation("17-C'", "section 4.4, below Eq. (17)", "cp4", "stress terms of the Jaumann rate",
             printed("1/2*(delta[i,k]*stress[j,l] + delta[i,l]*stress[j,k] + delta[j,k]*stress[i,l]"
                     " + delta[j,l]*stress[i,k])")),
    relation("17", "section 4.4, Eq. (17)", "jaumann", "Jaumann rate of the Kirchhoff stress",
             printed("J*ddot(c4 + cp4, D)")),
)  # fmt: skip
