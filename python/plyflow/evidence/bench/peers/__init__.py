"""Other ways to the same material: what the generated UMAT is measured against."""
