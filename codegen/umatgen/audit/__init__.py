"""Printed against derived: identities with a numeric witness, verdicts, and what compiled blocks must return."""

from umatgen.audit.blocks import UnknownBlockError
from umatgen.audit.effect import Effect, Variant
from umatgen.audit.entries import BlockLink, Entry, audit_relations
from umatgen.audit.states import BlockCall, State, block_calls, random_states
from umatgen.audit.verdict import Finding, Judged, Verdict, judge

__all__ = [
    "BlockCall", "BlockLink", "Effect", "Entry", "Finding", "Judged", "State", "UnknownBlockError", "Variant", "Verdict",
    "audit_relations", "block_calls", "judge", "random_states",
]  # fmt: skip
