"""plyflow: generate, drive and audit the UMAT; the package that a user imports and types."""
