"""Animals are their own mirror images: what their numbers become in the mirror."""

from dataclasses import dataclass

import numpy as np

from ..engine.model import Array, Index

COUNTED = ("position", "velocity", "curvature", "roll", "contact", "touch")
"""Readings that are counted along the body"""


@dataclass(frozen=True, kw_only=True)
class Mirror:
    """A mirror that stands upright in an animal's middle.

    Of vectors, it changes the sign of the component across it; of what turns, such as angular velocity, that of the
    others. Couples, curvature and roll follow from the frames of the rod: mirrored, a frame is made right-handed by
    turning its tangent round where the rod is then counted from the other end, and its binormal where it is not.

    Attributes
    ----------
    across : str
        The axis of the heading's frame that is across the mirror: forward or right.
    arms : tuple of str
        The two arms that it exchanges, counting the rod from the other end; empty where it exchanges none.
    is_later : bool
        Whether the image feels the clock half a period later. What undulates bends to one side and half a period later
        to the other, so it is its own image in such a mirror only; in one without, what is straight must stay straight.
    """

    across: str
    arms: tuple[str, ...] = ()
    is_later: bool = False

    def image(self, names: tuple[str, ...]) -> tuple[Index, Array]:
        """Return where the mirror image has each number, and with which sign.

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
        """Return the name of what the mirror shows in place of a number."""
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
