"""Counterparts of the paper's figures from the model, and the paper's claims as computed checks."""
