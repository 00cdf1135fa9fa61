"""Shared parts of the cases: a result with its theory, and a picture of both."""

import argparse
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np


@dataclass(frozen=True)
class Result:
    """A measurement and its theory.

    Attributes
    ----------
    title, x_label, y_label : str
        Title and axis labels of the picture.
    x, measured : np.ndarray
        Measured points, (n,); for several curves, (n,) and (n, c).
    exact_x, exact : np.ndarray
        Theoretical curve, (m,); for several, (m,) and (m, c).
    error : float
        Error of the measurement.
    bound : float
        Upper bound of the error.
    labels : tuple of str
        Labels of the measured curves.
    reference : str
        Label of the theory.
    scale : str
        Scale of both axes of the picture, "linear" or "log".
    """

    title: str
    x_label: str
    y_label: str
    x: np.ndarray
    measured: np.ndarray
    exact_x: np.ndarray
    exact: np.ndarray
    error: float
    bound: float
    labels: tuple[str, ...] = ("measured",)
    reference: str = "theory"
    scale: str = "linear"


def show(measure: Callable[[], Result], name: str) -> None:
    """Run a case from the command line: print its error, and write a picture."""
    parser = argparse.ArgumentParser(description=measure.__doc__)
    parser.add_argument("--out", type=Path, default=Path("cases"), help="folder for the picture (default: cases)")
    arguments = parser.parse_args()
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot as plt

    result = measure()
    figure, axes = plt.subplots(figsize=(6.0, 4.0), layout="constrained")
    theory = axes.plot(result.exact_x, result.exact, color="black", linewidth=1.0, zorder=3)
    theory[0].set_label(result.reference)
    for curve, label in zip(np.atleast_2d(result.measured.T), result.labels, strict=True):
        axes.plot(result.x, curve, "o", markersize=4, label=label)
    axes.set(title=result.title, xlabel=result.x_label, ylabel=result.y_label, xscale=result.scale, yscale=result.scale)
    axes.legend(frameon=False)
    arguments.out.mkdir(parents=True, exist_ok=True)
    path = arguments.out / f"{name}.png"
    figure.savefig(path, dpi=150)
    verdict = "within" if result.error <= result.bound else "ABOVE"
    print(f"{result.title}: error {result.error:.2e}, {verdict} {result.bound:g}; {path}")
