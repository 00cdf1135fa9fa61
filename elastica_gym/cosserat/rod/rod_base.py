"""Base class of rods."""

from .energy import RodEnergy
from .knot_theory import KnotTheory


class RodBase(RodEnergy, KnotTheory):
    """Base class of rods."""

    n_elems: int
    n_nodes: int
    ring_rod_flag: bool
