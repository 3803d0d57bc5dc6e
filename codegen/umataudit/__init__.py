"""Printed against derived: identities with a numeric witness, verdicts, and what compiled blocks must return.

Importing `derive` registers the derivations.
"""

from umataudit import derive
from umataudit.effect import Effect, Variant
from umataudit.entries import BlockLink, Entry, audit_relations
from umataudit.printed import PAPER
from umataudit.states import (
    BlockCall,
    State,
    UnknownBlockError,
    block_calls,
    property_symbol,
    random_states,
)
from umataudit.verdict import Finding, Judged, Verdict, judge

__all__ = [
    "PAPER", "BlockCall", "BlockLink", "Effect", "Entry", "Finding", "Judged", "State", "UnknownBlockError",
    "Variant", "Verdict", "audit_relations", "block_calls", "derive", "judge", "property_symbol", "random_states",
]  # fmt: skip
