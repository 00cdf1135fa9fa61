"""Visualisation: recordings for rerun, and pictures and videos drawn offscreen.

``import elastica_gym`` imports nothing from here; rerun and MuJoCo are imported only when needed:
``pip install 'elastica-gym[viz]'``.
"""

from .frames import FAST, FINE, Camera, Figure, Quality, Stage, framing, render_frames, write_video
from .recording import read_positions, record_rollout, write_recording
from .rollout import Policy, Recorder, Rollout, run_rollout
from .view import View

__all__ = [
    "FAST",
    "FINE",
    "Camera",
    "Figure",
    "Policy",
    "Quality",
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
