"""A policy in a separate process that only receives observations and returns actions.

Messages are arrays in NumPy's file format, without pickled objects. A one-dimensional array of n numbers begins n
episodes and is echoed; observations (n, d) are answered with actions (n, 42), or with the text of an error.
"""

import io
import multiprocessing
import signal
from contextlib import suppress
from multiprocessing.connection import Connection
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import numpy as np

from ..console.bad_input import BadInputError
from ..rl.policy_file import FilePolicy

LOADING_TIME = 180.0
"""Time limit for loading a policy and beginning episodes [s]"""
ACTING_TIME = 60.0
"""Time limit for the actions of one control step of all episodes [s]"""
LONGEST_ANSWER = 1 << 26
"""Maximum size of a response [bytes]"""


class PolicyError(Exception):
    """The policy crashed, was too slow, or did not return actions; the message says which."""


class PolicyProcess:
    """Runs a policy in a separate process; a context manager.

    Parameters
    ----------
    path
        A Python file, see `FilePolicy`; the folder of a run; its ``model.zip``; or the zip of a pretrained policy,
        next to its card.
    loading_time, acting_time
        Time limits of the policy [s].
    """

    def __init__(self, path: Path, *, loading_time: float = LOADING_TIME, acting_time: float = ACTING_TIME):
        if not path.exists():
            raise BadInputError(f"There is no policy {path}; give a Python file, a run's folder or its zip.")
        context = multiprocessing.get_context("spawn")
        self._loading_time, self._acting_time = loading_time, acting_time
        self._pipe, far_end = context.Pipe()
        self._process = context.Process(target=_serve, args=(far_end, path), daemon=True)
        self._process.start()
        far_end.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._pipe.close()
        self._process.kill()
        self._process.join()

    def begin(self, n: int) -> None:
        """Begin n parallel episodes."""
        self._ask(np.zeros(n), self._loading_time, "to load")

    def __call__(self, observations: np.ndarray, shape: tuple[int, ...]) -> np.ndarray:
        """Return the actions, of a given shape, for observations (n, d).

        Raises
        ------
        PolicyError
            If the policy crashes, is too slow, or returns anything but finite numbers of that shape.
        """
        actions = self._ask(observations, self._acting_time, "for its actions")
        if actions.shape != shape:
            raise PolicyError(f"the policy returned actions of shape {actions.shape}, not {shape}")
        if not np.issubdtype(actions.dtype, np.floating) or not np.isfinite(actions).all():
            raise PolicyError("the policy returned actions that are not finite numbers")
        return actions

    def _ask(self, message: np.ndarray, patience: float, what: str) -> np.ndarray:
        # a process that has ended may have left its error in the pipe
        with suppress(OSError):
            self._pipe.send_bytes(_to_bytes(message))
        try:
            if not self._pipe.poll(patience):
                raise PolicyError(f"the policy took more than {patience:g} s {what}")
            answer = _from_bytes(self._pipe.recv_bytes(LONGEST_ANSWER))
            if answer.dtype.kind == "U":
                raise PolicyError(str(answer))
            return answer
        except ValueError as error:
            raise PolicyError(f"the policy's process did not return an array: {error}") from None
        except (EOFError, OSError) as error:
            self._process.join(5.0)
            if self._process.is_alive():
                raise PolicyError(f"the policy's process does not respond: {error}") from None
        raise PolicyError(f"the policy's process has ended (status {self._process.exitcode}); see above for why")


def _serve(pipe: Connection, path: Path) -> None:
    """Respond to messages until the pipe is closed."""
    # the parent process handles Ctrl-C
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        policy = _load(path)
        while True:
            message = _from_bytes(pipe.recv_bytes())
            if message.ndim == 1:
                policy.reset([0] * message.size)
                pipe.send_bytes(_to_bytes(message))
            else:
                pipe.send_bytes(_to_bytes(np.asarray(policy(message, None))))
    except EOFError:
        return
    except BadInputError as error:
        pipe.send_bytes(_to_bytes(np.array(str(error))))


def _load(path: Path) -> Any:
    if path.suffix == ".py":
        return FilePolicy(path)
    # slow to import, and not needed for Python files
    from ..rl.cards import load_pretrained
    from ..rl.policies import load_run

    if path.suffix == ".zip" and path.with_suffix(".yml").exists():
        return load_pretrained(path.stem, path.parent)[0]
    return load_run(path.parent if path.suffix == ".zip" else path)[0]


def _to_bytes(array: np.ndarray) -> bytes:
    file = io.BytesIO()
    np.save(file, array, allow_pickle=False)
    return file.getvalue()


def _from_bytes(data: bytes) -> np.ndarray:
    return np.load(io.BytesIO(data), allow_pickle=False)
