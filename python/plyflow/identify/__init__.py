"""From compaction tests to material parameters: section 3.2's straight lines, then least squares on the curves."""
