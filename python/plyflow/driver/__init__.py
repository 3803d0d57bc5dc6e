"""The Python face of the Fortran driver."""
