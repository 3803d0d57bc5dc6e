"""An independent witness of the default scene in arbitrary precision (mpmath).

Every function is written from the equations of the model, shares no code with the symbolic compiler, and
takes the very doubles that the UMAT is given: they are converted exactly, so that any difference is the
UMAT's rounding.
Units N, mm, s, MPa; axis 1 is the fibre, axes 2 and 3 span the transverse plane.
"""

from oracle.conditioning import ulp_sensitivity
from oracle.law_1d import law_1d
from oracle.properties import PROPERTY_NAMES, ElasticConstants, Properties, elastic_constants
from oracle.response import Energies, StateVariables, ddsdde, energies, kirchhoff, second_piola, state_variables, stress
from oracle.states import State, crossing_states, properties_of, random_states

__all__ = [
    "PROPERTY_NAMES",
    "ElasticConstants",
    "Energies",
    "Properties",
    "State",
    "StateVariables",
    "crossing_states",
    "ddsdde",
    "elastic_constants",
    "energies",
    "kirchhoff",
    "law_1d",
    "properties_of",
    "random_states",
    "second_piola",
    "state_variables",
    "stress",
    "ulp_sensitivity",
]
