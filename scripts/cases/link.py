"""Twist and writhe of a coil change, but add up to its link (Klenin and Langowski 2000)."""

import numpy as np
from case import Result, show

from elastica_gym.cosserat import compute_link, compute_twist, compute_writhe

NODES = 161
TURNS = 4


def coil(height: float) -> tuple[np.ndarray, np.ndarray]:
    """Return nodes, (3, n + 1), and normals, (3, n), of a coil on the unit cylinder, wound without twist."""
    angle = np.linspace(0.0, 2.0 * np.pi * TURNS, NODES)
    nodes = np.array([np.cos(angle), np.sin(angle), height * angle / (2.0 * np.pi)])
    tangents = np.diff(nodes, axis=1)
    tangents /= np.linalg.norm(tangents, axis=0)
    middle = 0.5 * (angle[1:] + angle[:-1])
    outward = np.array([np.cos(middle), np.sin(middle), np.zeros(NODES - 1)])
    return nodes, outward - tangents * (outward * tangents).sum(axis=0)


def measure() -> Result:
    """Return twist over the height of a turn; theory is link minus writhe."""
    heights = np.linspace(0.3, 3.0, 10)
    curves = [coil(height) for height in heights]
    lines, normals = np.array([nodes for nodes, _ in curves]), np.array([d1 for _, d1 in curves])
    twist, _ = compute_twist(lines, normals)
    writhe = compute_writhe(lines, 1000.0, "next_tangent")
    link = compute_link(lines, normals, np.full((heights.size, NODES - 1), 1e-3), 1000.0, "next_tangent")
    error = float(np.abs(twist + writhe - link).max())
    return Result(
        "Twist of a coil, and its link minus its writhe",
        "height of a turn",
        "turns",
        heights,
        twist,
        heights,
        link - writhe,
        error,
        2e-2,
    )


if __name__ == "__main__":
    show(measure, "link")
