"""The appendix, the programme of section 2 and the cross-references, as printed."""

from __future__ import annotations

from umataudit.printed.relation import REFERENCE, WORDS, meaning, printed, relation

PROGRAMME = (
    relation("2-level", "section 2", "last_level", "scale-up: five steps from 80 N by 40 N to the 240 N of the other loading",
             printed("240")),
    relation("2-pressure", "section 2", "pressure_ratio", "60 N on 15 x 15 mm and 240 N on 30 x 30 mm: the same pressure",
             printed("1")),
    relation("2-duration", "section 2", "duration", "'test duration did not exceed 15 min'", printed("15*60"), sort=WORDS,
             note="the same section has 'loaded to 60 N in 1200 s'; the programme is taken as meant"),
)  # fmt: skip

APPENDIX = (
    relation("A.1-A0", "appendix, above Eq. (A.1)", "A0", "area of the unit cell of one fibre of radius r",
             printed("pi*r**2/(2*V0)"), meaning("pi*r**2/(2*V0)", "half", "half a cell")),
    relation("A.1-Af", "appendix, above Eq. (A.1)", "Af", "area of the unit cell at the compaction limit",
             printed("pi*r**2/(2*Vf)"), meaning("pi*r**2/(2*Vf)", "half", "half a cell")),
    relation("A.1-alpha", "appendix, below Eq. (A.1)", "alpha", "angle at locking from that at the compaction limit",
             printed("arcsin(A0/Af*sin(alpha_f))")),
    relation("A.1-alpha_f", "appendix, below Eq. (A.1)", "alpha_f", "angle at the compaction limit",
             printed("A0/(A0 + Af)*arctan(d/(4*Af))")),
    relation("A.1", "appendix, Eq. (A.1)", "gamma_lock", "shear angle at locking (V0 = 50 %, d the fibre diameter)",
             printed("arcsin((4*A0/d**2 - sin(2*alpha))/(1 - cos(2*alpha)))")),
    relation("A.1-Vf", "appendix, below Eq. (A.1)", "Vf",
             "fibre fraction at the compaction limit, 'in order to keep the number of parameters as low as possible'",
             printed("k**2"),
             meaning("k**2", "square fibre", "an approximation, as the paper says: a square fibre that covers the share k of both"
                     " faces of its cell, in place of the fraction at which Eq. 5b is singular")),
    relation("A.1-trend", "appendix, third paragraph", "trend",
             "after locking 'the fibre volume fraction starts decreasing' (-1; an increase is +1)", printed("-1"), sort=WORDS),
)  # fmt: skip

REFERENCES = (
    relation("ref-ab", "section 3.2, first sentence", "number", "'the rate term parameters a and b defined in Eq. (5)'",
             printed("5"), sort=REFERENCE),
    relation("ref-sigma", "section 4.1, below Eq. (9)", "number", "'In Eq. (8), sigma^e and sigma^v are ... stress tensors'",
             printed("8"), sort=REFERENCE),
    relation("ref-integrate", "section 4.3, above Eq. (13)", "number", "'obtained by integrating Eq. (11)' with eta_micro, eta_ply",
             printed("11"), sort=REFERENCE, note="the sentence has eta_UD, a letter defined nowhere; eta_micro is what Eq. 12 has"),
    relation("ref-lock", "section 5.3, last paragraph", "number", "'the locking criterion ... presented in Eq. (5)'",
             printed("5"), sort=REFERENCE),
    relation("ref-tables", "section 5.1, first sentence (and 5.3)", "number",
             "'the model parameters presented in Table 1 and 2': sum of the table numbers", printed("1 + 2"), sort=REFERENCE),
    relation("ref-section", "section 4.2, first sentence (and 4.1)", "number", "'the 1D model introduced in Section 2'",
             printed("2"), sort=REFERENCE),
)  # fmt: skip

RELATIONS = PROGRAMME + APPENDIX + REFERENCES
