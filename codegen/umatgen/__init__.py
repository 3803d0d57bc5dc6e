"""umatgen: the symbolic compiler from the paper's potentials to Fortran UMAT source.

SymPy in, Fortran text out: nothing here calls a compiler, reads a path of the host or drives a material point.
The stages are named, in order, in :mod:`umatgen.pipeline`.
"""

__version__ = "0.1.0"
