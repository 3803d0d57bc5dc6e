"""The paper's relations exactly as printed, as data with their number and place: what the audit reads.

Source: Belnoue, Nixon-Pearson, Ivanov, Hallett, "A novel hyper-viscoelastic model for consolidation of toughened prepregs
under processing conditions", Mechanics of Materials (2016). The text was recovered by character recognition; where a
character is doubtful a relation has several readings.
"""

from umataudit.printed.formula import Formula, FormulaError
from umataudit.printed.relation import PAPER, Book, Reading, Relation, relation

__all__ = ["PAPER", "Book", "Formula", "FormulaError", "Reading", "Relation", "relation"]
