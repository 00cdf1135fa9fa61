"""The mirror symmetry of animals: how their observations and actions transform under it."""

from dataclasses import dataclass

import numpy as np

from ..engine.model import Array, Index

COUNTED = ("position", "velocity", "curvature", "roll", "contact", "touch")
"""Readings that are numbered along the body"""


@dataclass(frozen=True, kw_only=True)
class Mirror:
    """A vertical mirror through an animal's middle.

    It changes the sign of a vector's component across it, and of a pseudovector's, such as angular velocity, other
    components. Couples, curvature and roll follow from the frames of the rod: a mirrored frame is made right-handed
    by reversing its tangent if the rod is then numbered from the other end, else its binormal.

    Attributes
    ----------
    across : str
        The axis of the heading's frame that is across the mirror: forward or right.
    arms : tuple of str
        The two arms that it exchanges, numbering the rod from the other end; empty if it exchanges none.
    is_later : bool
        Whether the image observes the clock half a period later. An undulating body bends to one side and half a period
        later to the other, so only such a mirror leaves it unchanged; without the delay, a straight body must stay
        straight.
    """

    across: str
    arms: tuple[str, ...] = ()
    is_later: bool = False

    def image(self, names: tuple[str, ...]) -> tuple[Index, Array]:
        """Return the index and the sign of each number's mirror image.

        Parameters
        ----------
        names : tuple of str
            Observations (``observation_names`` of an environment) or actions (`.muscles.activation_names`).

        Returns
        -------
        tuple
            Index (d,) and sign (d,): the mirror image of values v is ``v[index] * sign``.
        """
        place = {name: i for i, name in enumerate(names)}
        index = np.array([place[self._twin(name, names)] for name in names])
        return index, np.array([-1.0 if self._is_turned(name) else 1.0 for name in names])

    def _twin(self, name: str, names: tuple[str, ...]) -> str:
        """Return the name of a number's mirror image."""
        if not self.arms:
            return name
        parts = name.split("/")
        if parts[0] in COUNTED:
            last = max(int(each.split("/")[1]) for each in names if each.startswith(f"{parts[0]}/"))
            parts[1] = str(last - int(parts[1]))
        other = dict(zip(self.arms, reversed(self.arms), strict=True))
        return "/".join(other.get(part, part) for part in parts)

    def _is_turned(self, name: str) -> bool:
        parts = name.split("/")
        if "spin" in parts:
            return parts[-1] != self.across
        if parts[0] == "clock":
            return self.is_later
        if parts[0] == "roll":
            return parts[-1] == "binormal" and not self.arms
        about_normal = "normal" in parts and not self.arms
        return parts[-1] in (self.across, "twist") or "tangent" in parts or about_normal
