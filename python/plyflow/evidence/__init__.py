"""The two standing orders as commands: numerical stability, and error against run time."""
