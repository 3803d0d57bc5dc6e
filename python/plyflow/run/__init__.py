"""A case run, a law run, an increment run again."""
