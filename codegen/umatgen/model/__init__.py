"""The constitutive model: one concept a file, in the paper's letters, every relation with its equation number."""
