"""Lowering: symbolic scalars to ordered assignments; tensors stay combinations of generators until the last step."""
