"""A rod twisted far beyond buckling coils around itself; twist and writhe add up to the turns of its ends.

Self contact keeps it from passing through itself, which would change the sum by two. Twist, writhe and link are those
of Klenin and Langowski (2000).
"""

import numpy as np
from case import Result, show

from elastica_gym.cosserat import (
    BaseSystemCollection,
    CallBackBaseClass,
    CallBacks,
    Constraints,
    Contact,
    CosseratRod,
    HelicalBucklingBC,
    PositionVerlet,
    RodSelfContact,
    compute_link,
    compute_twist,
    compute_writhe,
    integrate,
    stable_time_step,
)

N, LENGTH, RADIUS, DENSITY, YOUNG, SLACK, TURNS = 100, 1.0, 0.0125, 1000.0, 1e6, 0.6, 6.0
TWISTING_TIME, DURATION, DAMPING = 5.0, 6.0, 3.0
"""Time until which the ends turn, total duration [s], and decay rate of motion [1/s]"""


class Simulator(BaseSystemCollection, Constraints, Contact, CallBacks):
    """A rod with self contact and turned ends, and a callback."""


class CurveCallBack(CallBackBaseClass):
    """Records time, nodes, normals and radii."""

    def __init__(self, every: int, seen: list) -> None:
        self.every, self.seen = every, seen

    def make_callback(self, system: CosseratRod, time: float, current_step: int) -> None:
        """Append copies."""
        self.seen.append((time, system.position_collection.copy(), system.director_collection[0].copy(), system.radius))


def wind() -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return times [s], (m,), nodes [m], (m, 3, N + 1), normals, (m, 3, N), and radii [m], (m, N)."""
    nu = DAMPING * DENSITY * np.pi * RADIUS**2
    rod = CosseratRod.straight_rod(
        N,
        np.zeros(3),
        np.array([0.0, 0.0, 1.0]),
        np.array([0.0, 1.0, 0.0]),
        LENGTH,
        RADIUS,
        DENSITY,
        nu=nu,
        nu_for_torques=0.25 * nu * RADIUS**2,
        youngs_modulus=YOUNG,
        shear_modulus=YOUNG / 3.0,
    )
    rod.velocity_collection[1] = 1e-2 * np.sin(np.pi * rod.position_collection[2] / LENGTH)
    simulator = Simulator()
    simulator.append(rod)
    simulator.constrain(rod).using(
        HelicalBucklingBC,
        constrained_position_idx=(0, -1),
        constrained_director_idx=(0, -1),
        twisting_time=TWISTING_TIME,
        slack=SLACK,
        number_of_rotations=TURNS,
    )
    simulator.detect_contact_between(rod, rod).using(RodSelfContact, k=1e3, nu=0.0)
    steps = int(DURATION / (0.5 * stable_time_step(rod)))
    seen: list[tuple] = []
    simulator.collect_diagnostics(rod).using(CurveCallBack, steps // 60, seen)
    simulator.finalize()
    integrate(PositionVerlet(), simulator, DURATION, steps, progress_bar=False)
    times, nodes, normals, radii = (np.array(each) for each in zip(*seen, strict=True))
    return times, nodes, normals, radii


def measure() -> Result:
    """Return twist, writhe and link over time; in theory their sum, the link, equals the turns of the ends."""
    times, nodes, normals, radii = wind()
    imposed = -TURNS * np.minimum(1.0, times / TWISTING_TIME)
    twist, _ = compute_twist(nodes, normals)
    writhe = compute_writhe(nodes, LENGTH, "next_tangent")
    link = compute_link(nodes, normals, radii, LENGTH, "next_tangent")
    error = max(np.abs(twist + writhe - imposed).max(), np.abs(link - imposed).max())
    return Result(
        "Plectoneme",
        "time [s]",
        "turns",
        times,
        np.stack([twist, writhe, link], axis=1),
        times,
        imposed,
        float(error),
        1e-2,
        labels=("twist", "writhe", "link"),
    )


if __name__ == "__main__":
    show(measure, "plectoneme")
