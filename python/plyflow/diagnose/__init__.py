"""Anybody's UMAT through the driver: its path, its DDSDDE against differences, and which common mistake fits."""
