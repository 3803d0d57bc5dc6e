"""Printed against derived: identities with a numeric witness, verdicts, and what compiled blocks must return."""

from umatgen.audit.blocks import UnknownBlockError
from umatgen.audit.effect import Effect, Variant
from umatgen.audit.entries import BlockLink, Entry, audit_relations
from umatgen.audit.states import (
    BlockCall,
    SceneNotComparableError,
    State,
    block_calls,
    not_comparable,
    property_symbol,
    random_states,
)
from umatgen.audit.verdict import Finding, Judged, Verdict, judge

__all__ = [
    "BlockCall", "BlockLink", "Effect", "Entry", "Finding", "Judged", "SceneNotComparableError", "State", "UnknownBlockError",
    "Variant", "Verdict", "audit_relations", "block_calls", "judge", "not_comparable", "property_symbol", "random_states",
]  # fmt: skip
