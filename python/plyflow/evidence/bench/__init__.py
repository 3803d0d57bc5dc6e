"""Work-precision: error against run time and increments, peers on the same material, instructions a call."""
