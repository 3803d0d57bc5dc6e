"""Numerics that hold: families of stiff, extreme and refused states, measured and reported."""
