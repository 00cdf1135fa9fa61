"""Films and recordings of an episode: H.264 video, animated GIF, or rerun file."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..console.bad_input import BadInputError, choose, make_folder, missing_extra, require_extra

if TYPE_CHECKING:
    from .policies import Policy

SUFFIXES = (".mp4", ".gif")
COLORS = 64
"""Colours of a GIF: more increase its size and hardly improve it"""
SIZE = (640, 360)
"""Default width and height of a film [pixels]"""
FAR = 3.0
"""Extent of the head's path beyond which the camera moves with the animal [body lengths]"""
LARGEST_SIDE = 2048
"""Maximum width or height [pixels]"""


def check_film(path: Path, size: tuple[int, int]) -> None:
    """Check that a film can be made, before running an episode: packages, folder, file, renderer.

    Raises
    ------
    BadInputError
        If not; the message gives the reason.
    """
    choose("kind of film", path.suffix, SUFFIXES)
    if not all(1 <= side <= LARGEST_SIDE and side % 2 == 0 for side in size):
        raise BadInputError(f"size must be two even numbers up to {LARGEST_SIDE}, got {size[0]} {size[1]}")
    require_extra("viz")
    make_folder(path.parent)
    from ..viz import Stage

    try:
        Stage(width=size[0], height=size[1]).close()
    except RuntimeError as error:
        raise BadInputError(f"no film: {error}") from error


def film(
    policy: "Policy",
    env_id: str,
    path: Path,
    *,
    seed: int,
    every: int = 1,
    size: tuple[int, int] = SIZE,
    shortest: float = 0.0,
    fine: bool = False,
    env_kwargs: dict[str, Any] | None = None,
) -> Path:
    """Run an episode, or more in a row, render them to a file, and print the path.

    Parameters
    ----------
    policy
        Policy to run.
    env_id
        Environment id.
    path
        Output file, ending in .mp4 or .gif.
    seed
        Seed of the episode.
    every
        Control steps between frames; the film plays in real time.
    size
        Width and height [pixels], even numbers.
    shortest
        Duration up to which episodes of the next seeds follow [s].
    fine
        Whether to draw smooth edges and shadows, which takes six times as long.
    env_kwargs
        Arguments of the environment.
    """
    from ..progress import Bar
    from ..viz import FAST, FINE, render_frames, write_video

    check_film(path, size)
    frames: list[np.ndarray] = []
    played, next_seed = 0.0, seed
    while not frames or played < shortest:
        policy.reset([next_seed])
        rollout = run_shown(policy, env_id, seed=next_seed, env_kwargs=env_kwargs or {})
        moments = range(0, len(rollout.step), every)
        with Bar(f"drawing {len(moments)} frames") as bar:
            follows = np.ptp(rollout.head, axis=0).max() > FAR * rollout.body_length
            frames.extend(
                render_frames(
                    rollout,
                    moments,
                    follows=follows,
                    width=size[0],
                    height=size[1],
                    quality=FINE if fine else FAST,
                    show=bar.show,
                )
            )
        seconds = every * float(np.diff(rollout.sim_time).mean())
        played, next_seed = played + rollout.duration, next_seed + 1
    if path.suffix == ".gif":
        _write_gif(np.stack(frames), path, seconds)
    else:
        write_video(np.stack(frames), path, fps=1.0 / seconds)
    seeds = f"seed {seed}" if next_seed == seed + 1 else f"seeds {seed} to {next_seed - 1}"
    print(f"filmed {path} ({path.stat().st_size / 1e6:.1f} MB, {played:.1f} s, {seeds})")
    return path


def run_shown(policy: "Policy", env_id: str, *, seed: int, env_kwargs: dict[str, Any]) -> Any:
    """Run one episode with a policy that has been reset, show progress, and return the rollout."""
    from ..progress import Bar
    from ..viz import run_rollout

    with Bar(f"running the episode of seed {seed}") as bar:

        def act(observations: np.ndarray, batch: Any) -> np.ndarray:
            bar.show(batch.elapsed[0] / batch.max_episode_steps)
            return policy(observations, batch)

        return run_rollout(env_id, act, seed=seed, **env_kwargs)


def _write_gif(frames: np.ndarray, path: Path, seconds: float) -> None:
    """Write frames (T, height, width, 3) as a looping GIF, each shown for `seconds`."""
    from PIL import Image

    pictures = [Image.fromarray(frame) for frame in frames]
    # one palette for all frames prevents flicker
    palette = Image.fromarray(np.concatenate(frames[:: max(1, len(frames) // 8)])).quantize(COLORS)
    pictures = [picture.quantize(palette=palette, dither=Image.Dither.NONE) for picture in pictures]
    pictures[0].save(path, save_all=True, append_images=pictures[1:], duration=1000.0 * seconds, loop=0, optimize=True)


def record(policy: "Policy", env_id: str, *, seed: int, path: Path, env_kwargs: dict[str, Any]) -> Path | None:
    """Record the episode with `seed` for rerun; if rerun is missing, print how to install it and return None."""
    if message := missing_extra("viz"):
        print(f"no recording: {message}")
        return None
    from ..viz import write_recording

    make_folder(path.parent)
    policy.reset([seed])
    write_recording(run_shown(policy, env_id, seed=seed, env_kwargs=env_kwargs), path)
    print(f"recorded {path}")
    return path


def recording_name(env_id: str, seed: int) -> str:
    """Return the file name of the recording of an episode."""
    return f"{env_id.rpartition('/')[2]}-seed{seed}.rrd"
