"""Looking at animals: recordings for rerun, and pictures and videos drawn offscreen.

Nothing here is imported by ``import elastica_gym``, and rerun and MuJoCo only when they are needed:
``pip install 'elastica-gym[viz]'``.
"""

from .frames import Camera, Figure, Stage, framing, render_frames, write_video
from .recording import read_positions, record_rollout, write_recording
from .rollout import Policy, Recorder, Rollout, run_rollout
from .view import View

__all__ = [
    "Camera",
    "Figure",
    "Policy",
    "Recorder",
    "Rollout",
    "Stage",
    "View",
    "framing",
    "read_positions",
    "record_rollout",
    "render_frames",
    "run_rollout",
    "write_recording",
    "write_video",
]
