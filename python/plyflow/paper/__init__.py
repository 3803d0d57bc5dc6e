"""Figures, tables and the self-contained HTML report of the compaction programme."""
