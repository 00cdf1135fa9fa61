"""Pictures of environments' current states, as their ``render`` returns them."""

import numpy as np

from .frames import FAST, Camera, Image, Stage, figures, following, outline
from .rollout import Batch, Recorder


class View:
    """Draws the current states of a batch's environments, each with a camera that follows its animal.

    If numbers are not finite, as after a divergence, the last picture is drawn again, or bare ground if there is none.
    The batch is not changed.

    Parameters
    ----------
    env : Batch
        Pictures have its ``render_size``.
    """

    def __init__(self, env: Batch) -> None:
        width, height = env.render_size
        self._aspect = width / height
        self._stage = Stage(width=width, height=height, unit=env.body.sensors.length, quality=FAST)
        self._recorders = [Recorder(env, i, keep=1) for i in range(env.num_envs)]

    def draw(self) -> tuple[Image, ...]:
        """Return a picture of each environment, (height, width, 3) uint8."""
        return tuple(self._draw(recorder) for recorder in self._recorders)

    def _draw(self, recorder: Recorder) -> Image:
        rollout = recorder.capture().rollout()
        if not np.isfinite(outline(rollout, [0])).all():
            return self._stage.draw([], Camera(look_at=np.zeros(3), distance=4.0 * rollout.body_length))
        return self._stage.draw(figures(rollout, 0), following(rollout, 0, self._aspect))

    def close(self) -> None:
        """Free the renderer."""
        self._stage.close()
