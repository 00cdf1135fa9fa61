"""The training loop: Stable-Baselines3's algorithms, run one iteration at a time.

An iteration ends with an update of the networks. Metrics, evaluations, checkpoints and stops happen only between
iterations, so that a resumed run continues bit for bit.
"""

import pickle
import random
import signal
import sys
import threading
import time
from collections.abc import Callable
from contextlib import nullcontext
from pathlib import Path
from types import FrameType
from typing import TYPE_CHECKING, Any

import numpy as np
import torch
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.logger import KVWriter, Logger, TensorBoardOutputFormat
from stable_baselines3.common.off_policy_algorithm import OffPolicyAlgorithm
from stable_baselines3.common.running_mean_std import RunningMeanStd
from stable_baselines3.common.vec_env import VecNormalize

from ..console.bad_input import BadInputError
from ..envs import observation_names
from ..files import write_atomically
from ..progress import Bar
from . import cards, curves, transfer
from .algorithms import ALGORITHMS
from .budget import Budget
from .checkpoints import checkpoint_folders, last_whole_checkpoint, write_checkpoint
from .episodes import Episodes
from .evaluation import evaluate
from .films import record, recording_name
from .hyperparameters import algorithm_arguments, algorithm_class, normalize_arguments
from .imitation import CRITIC_UPDATES, critic_alone, imitate
from .policies import TrainedPolicy, load_model, load_normalization, load_run, use_one_thread
from .run_files import BEST, EVALUATIONS, METRICS, TENSORBOARD, Table, read_table
from .seeds import training_seeds
from .vec_env import BatchVecEnv, make_batch_vec_env

if TYPE_CHECKING:
    from ..viz.viewer import LiveView

REPLAY_ARRAYS = ("observations", "next_observations", "actions", "rewards", "dones", "timeouts")


class Training:
    """A training run: new, or resumed from its last intact checkpoint.

    Parameters
    ----------
    folder
        The run's existing folder.
    config
        Contents of ``config.yml``.
    tensorboard
        Whether to write event files for TensorBoard into the run's folder.
    resume
        Whether to continue from the folder's last intact checkpoint.
    """

    def __init__(
        self,
        folder: Path,
        config: dict[str, Any],
        *,
        resume: bool,
        tensorboard: bool = False,
    ):
        self.folder = folder
        self.config = config
        use_one_thread()
        values = config["hyperparameters"]
        self.adapter = self._make_environment(n_envs=values.get("n_envs", 1), n_threads=config["threads"])
        checkpoint = self._find_checkpoint() if resume else None
        saved: dict[str, Any] = {"seconds": 0.0, "table_sizes": (0, 0), "imitated": 0}
        self.model = self._new_model() if checkpoint is None else self._load_model(checkpoint)
        self._known_env: str | None = None
        if checkpoint is None and config.get("start_from"):
            self._known_env = self._take_over(config["start_from"])
        # the model seeded them with consecutive seeds, most of which other runs would share
        self.adapter.seed(training_seeds(config["seed"], 0, self.adapter.num_envs))
        outputs: list[KVWriter] = [TensorBoardOutputFormat(str(folder / TENSORBOARD))] if tensorboard else []
        self.model.set_logger(Logger(folder=None, output_formats=outputs))
        self.episodes = Episodes(longest=self.adapter.batch.max_episode_steps, window=self.model._stats_window_size)
        if checkpoint is not None:
            saved = self._load_state(checkpoint)
        self.metrics = Table(folder / METRICS, size=saved["table_sizes"][0])
        self.evaluations = Table(folder / EVALUATIONS, size=saved["table_sizes"][1])
        self._points_passed = 0
        self._imitated: int = saved["imitated"]
        self._critic_first = CRITIC_UPDATES * self.model.n_steps * self.adapter.num_envs if config.get("imitate") else 0
        self._seconds_before: float = saved["seconds"]
        self._checkpoint_at = 0.0
        self._stop = False

    # Creating, saving and restoring

    def _find_checkpoint(self) -> Path | None:
        checkpoints = self.folder / "checkpoints"
        found = last_whole_checkpoint(checkpoints)
        if found is None and checkpoint_folders(checkpoints):
            raise BadInputError(f"The run {self.folder} has no intact checkpoint to resume from.")
        if found is None:
            print("The run ended before its first checkpoint; starting from the beginning.")
        return found

    def _make_environment(self, *, n_envs: int, n_threads: int) -> BatchVecEnv:
        env_kwargs = self.config["hyperparameters"].get("env_kwargs") or {}
        try:
            return make_batch_vec_env(self.config["env"], n_envs=n_envs, n_threads=n_threads, **env_kwargs)
        except (TypeError, ValueError) as error:
            raise BadInputError(f"The environment refuses its arguments: {error}") from error

    def _new_model(self) -> Any:
        values = self.config["hyperparameters"]
        normalize = normalize_arguments(values)
        try:
            env = self.adapter if normalize is None else VecNormalize(self.adapter, **normalize)
            return algorithm_class(self.config["algo"])(
                env=env, seed=self.config["seed"], device="cpu", **algorithm_arguments(values)
            )
        except (TypeError, ValueError, AssertionError) as error:
            raise BadInputError(f"Stable-Baselines3 refuses the hyperparameters: {error}") from error

    def _take_over(self, start: str) -> str:
        """Start from the networks and statistics of another run or a pretrained policy, and return its environment id.

        Exploration is reset. New observations have zero weights at first.
        """
        other, known, env_id, algo = _networks(start)
        now = self.adapter.batch.observation_names
        weights = {name: value for name, value in other.policy.state_dict().items() if name != "log_std"}
        try:
            where = transfer.places(observation_names(env_id), now)
            shapes = {name: value.shape for name, value in self.model.policy.state_dict().items()}
            weights = transfer.widened(weights, shapes, where)
            absent, unknown = self.model.policy.load_state_dict(weights, strict=False)
        except (RuntimeError, ValueError) as error:
            absent, unknown = [str(error)], []
        if set(absent) - {"log_std"} or unknown:
            raise BadInputError(
                f"The networks of {start}, {algo} on {env_id}, do not fit: {', '.join([*absent, *unknown])}"
            )
        normalize = self.model.get_vec_normalize_env()
        if normalize is not None and known is not None:
            normalize.obs_rms = transfer.statistics(known, len(now), where)
        return env_id

    def _load_model(self, checkpoint: Path) -> Any:
        env: Any = self.adapter
        if normalize_arguments(self.config["hyperparameters"]) is not None:
            env = load_normalization(checkpoint / "vecnormalize.pkl")
            env.set_venv(self.adapter)
        return load_model(checkpoint / "model.zip", self.config["algo"], env=env, force_reset=False)

    def _save_files(self, folder: Path) -> None:
        self._save_policy(folder)
        normalize = self.model.get_vec_normalize_env()
        state = {
            "environment": self.adapter.get_state(),
            "discounted_returns": None if normalize is None else normalize.returns,
            "torch": torch.get_rng_state(),
            "numpy": np.random.get_state(),
            "python": random.getstate(),
            "action_space": self.model.action_space.np_random.bit_generator.state,
            "imitated": self._imitated,
            "episodes": self.episodes.get_state(),
            "seconds": self.budget.seconds,
            "table_sizes": (self.metrics.size, self.evaluations.size),
        }
        (folder / "state.pkl").write_bytes(pickle.dumps(state))
        if isinstance(self.model, OffPolicyAlgorithm):
            self._save_replay_buffer(folder / "replay_buffer.npz")

    def _load_state(self, checkpoint: Path) -> dict[str, Any]:
        state = pickle.loads((checkpoint / "state.pkl").read_bytes())
        self.adapter.set_state(state["environment"])
        self.episodes.set_state(state["episodes"])
        normalize = self.model.get_vec_normalize_env()
        if normalize is not None:
            normalize.returns = state["discounted_returns"]
        if isinstance(self.model, OffPolicyAlgorithm):
            self._load_replay_buffer(checkpoint / "replay_buffer.npz")
        # generators last: creating a model seeds them
        torch.set_rng_state(state["torch"])
        np.random.set_state(state["numpy"])
        random.setstate(state["python"])
        self.model.action_space.np_random.bit_generator.state = state["action_space"]
        return state

    def _save_replay_buffer(self, path: Path) -> None:
        buffer = self.model.replay_buffer
        filled = buffer.size()
        np.savez(path, pos=buffer.pos, full=buffer.full, **{k: getattr(buffer, k)[:filled] for k in REPLAY_ARRAYS})

    def _load_replay_buffer(self, path: Path) -> None:
        buffer = self.model.replay_buffer
        with np.load(path) as saved:
            for name in REPLAY_ARRAYS:
                getattr(buffer, name)[: len(saved[name])] = saved[name]
            buffer.pos, buffer.full = int(saved["pos"]), bool(saved["full"])

    # Running

    def run(self, live: "LiveView | None" = None) -> bool:
        """Train until the budget is spent or a stop is requested, then save. Return whether the budget is spent.

        Parameters
        ----------
        live
            A viewer that shows evaluations while training goes on, or None.
        """
        self._live = live
        # Python handles signals in the main thread only
        numbers = (signal.SIGINT, signal.SIGTERM) if threading.current_thread() is threading.main_thread() else ()
        previous = {number: signal.signal(number, self._ask_to_stop) for number in numbers}
        try:
            with Bar("training", file=sys.stdout) as self.display:
                self._compile()
                self.budget = Budget(
                    steps=self.config["steps"],
                    minutes=self.config["minutes"],
                    seconds_before=self._seconds_before,
                    free_steps=self._imitated,
                )
                if self.config.get("imitate") and not self._imitated:
                    self._imitate()
                finished = self._loop()
                self._finish()
        finally:
            for number, handler in previous.items():
                signal.signal(number, handler)
            self.metrics.close()
            self.evaluations.close()
            self.adapter.close()
            self.model.logger.close()
        return finished

    def _compile(self) -> None:
        """Step one environment, so that compilation does not count as training time."""
        env = self._make_environment(n_envs=1, n_threads=1)
        env.reset()
        env.step(np.zeros((1, *env.action_space.shape), np.float32))  # type: ignore[misc]
        env.close()

    def _imitate(self) -> None:
        """Imitate the task's script, with evaluations."""

        def after_round(part: float) -> bool:
            self._evaluate_when_due(part)
            return not self._stop

        imitate(
            self.model,
            self.adapter,
            steps=self.config["imitate"],
            show=self.display.show,
            after_round=after_round,
            goes_on=self._known_env == self.config["env"],
        )
        self._imitated = 0 if self._stop else self.model.num_timesteps
        self.budget.free_steps = self.model.num_timesteps
        self._pass_points(self.spent)

    def _loop(self) -> bool:
        iterate = ALGORITHMS[self.config["algo"]].iterate
        callback = self._begin()
        duration = 0.0
        self._evaluate_when_due(self.spent)
        while self.budget.fraction(self.model.num_timesteps, seconds_ahead=duration) < 1.0 and not self._stop:
            started, steps_before = time.monotonic(), self.model.num_timesteps
            is_fitting = steps_before - self._imitated < self._critic_first
            with critic_alone(self.model) if is_fitting else nullcontext():
                iterate(self.model, callback, self.budget)
            duration = time.monotonic() - started
            self._measure((self.model.num_timesteps - steps_before) / duration)
            self._evaluate_when_due(self.spent)
            if self.budget.seconds - self._checkpoint_at > 60.0 * self.config["checkpoint_minutes"]:
                self._checkpoint()
        return not self._stop

    def _begin(self) -> BaseCallback:
        resumed = self.model.num_timesteps > 0
        _, callback = self.model._setup_learn(
            self.config["steps"] or 2**62, callback=self.episodes, reset_num_timesteps=not resumed
        )
        self._checkpoint_at = self.budget.seconds
        if resumed:
            self._pass_points(self.spent)
        return callback

    def _ask_to_stop(self, number: int, frame: FrameType | None) -> None:
        if self._stop:
            raise KeyboardInterrupt
        self._stop = True
        self.display.say("Stopping after this update; interrupt once more to stop at once.")

    def _measure(self, steps_per_second: float) -> None:
        """Append the metrics of this iteration to metrics.csv and display them."""
        row = {
            "steps": self.model.num_timesteps,
            "seconds": self.budget.seconds,
            "steps_per_second": steps_per_second,
            "return": self.episodes.mean("r"),
            "length": self.episodes.mean("l"),
            "distance": self.episodes.mean("distance"),
            "success": self.episodes.mean("success"),
            **{term: self.episodes.mean(term) for term in self.adapter.term_keys},
            **dict.fromkeys(ALGORITHMS[self.config["algo"]].update_columns),
            **{key.removeprefix("train/"): _plain(v) for key, v in self.model.logger.name_to_value.items()},
        }
        self._log({"rollout/ep_rew_mean": row["return"], "rollout/ep_len_mean": row["length"],
                   "rollout/success_rate": row["success"], "time/fps": steps_per_second})  # fmt: skip
        self.metrics.append(row)
        self._show(lambda live: live.log_numbers(row["steps"], _numbers("training", row)))
        shown = ("steps", "steps_per_second", "return", "distance", "success")
        self.display.show(self.spent, {key.replace("steps_per_second", "steps/s"): row[key] for key in shown})

    def _log(self, values: dict[str, float]) -> None:
        """Write values, and what the algorithm has recorded, to the logger's outputs."""
        for name, value in values.items():
            if np.isfinite(value):
                self.model.logger.record(name, value)
        self.model.logger.dump(self.model.num_timesteps)

    def _show(self, show: Callable[["LiveView"], None]) -> None:
        """Send something to the viewer, if there is one; its failures never stop a training."""
        if self._live is None:
            return
        try:
            show(self._live)
        except Exception as error:
            self._live = None
            self.display.say(f"The viewer is no longer used: {error}")

    def _show_episode(self, live: "LiveView") -> None:
        """Show the first episode of the evaluation, played once more."""
        from ..viz import run_rollout

        policy, seed = self._policy(), self.config["evaluation_seed"]
        policy.reset([seed])
        kwargs = self.config["hyperparameters"].get("env_kwargs") or {}
        rollout = run_rollout(self.config["env"], policy, seed=seed, **kwargs)
        live.log_episode(rollout, f"evaluation at {self.model.num_timesteps:,} steps")

    @property
    def spent(self) -> float:
        """The fraction of the budget spent; imitation counts only in minutes."""
        return self.budget.fraction(self.model.num_timesteps)

    def _evaluate_when_due(self, part: float) -> None:
        """Evaluate at the start and at equal intervals of the budget or of imitation."""
        points = self.config["evaluations"]
        if points and part * points >= self._points_passed:
            self._evaluate()
            self._pass_points(part)

    def _pass_points(self, part: float) -> None:
        self._points_passed = int(part * self.config["evaluations"]) + 1

    def _evaluate(self) -> None:
        result = evaluate(
            self._policy(),
            self.config["env"],
            episodes=self.config["evaluation_episodes"],
            seed=self.config["evaluation_seed"],
            n_threads=self.config["threads"],
            env_kwargs=self.config["hyperparameters"].get("env_kwargs"),
        )
        row = result.row(self.model.num_timesteps, self.budget.seconds)
        if row["return"] > read_table(self.folder / EVALUATIONS).get("return", np.array([-np.inf])).max():
            self._save_best()
        self.evaluations.append(row)
        scores = {"mean_reward": row["return"], "mean_ep_length": row["length"], "success_rate": row["success"]}
        self._log({f"eval/{name}": value for name, value in scores.items()})
        self._show(lambda live: live.log_numbers(row["steps"], _numbers("evaluation", row)))
        self._show(self._show_episode)
        self.display.say(
            f"evaluation at {self.model.num_timesteps:,} steps: return {row['return']:.3f} ± {row['return_ci95']:.3f}, "
            f"distance {row['distance']:.3f} m, success {row['success']:.0%}"
        )

    def _policy(self) -> TrainedPolicy:
        return TrainedPolicy(self.model, self.model.get_vec_normalize_env())

    def _checkpoint(self) -> None:
        write_checkpoint(self.folder / "checkpoints", self.model.num_timesteps, self._save_files)
        self._checkpoint_at = self.budget.seconds

    def _finish(self) -> None:
        """Save a checkpoint for ``--resume``, the model, the learning curve, and recordings of the best model."""
        # a run stopped during imitation restarts from the beginning
        if self._imitated or not self.config.get("imitate"):
            self._checkpoint()
        self._save_policy(self.folder)
        figure = curves.plot_run(self.folder)
        write_atomically(self.folder / "learning_curve.png", lambda path: curves.save(figure, path))
        if not self._stop:
            self._record()

    def _save_best(self) -> None:
        """Save the current policy in a folder that can be used like a run."""
        folder = self.folder / BEST
        folder.mkdir(exist_ok=True)
        self._save_policy(folder)
        config = (self.folder / "config.yml").read_bytes()
        write_atomically(folder / "config.yml", lambda path: path.write_bytes(config))

    def _save_policy(self, folder: Path) -> None:
        write_atomically(folder / "model.zip", self.model.save)
        normalize = self.model.get_vec_normalize_env()
        if normalize is not None:
            write_atomically(folder / "vecnormalize.pkl", normalize.save)

    def _record(self) -> None:
        folder = self.folder / "recordings"
        folder.mkdir(exist_ok=True)
        seed, env_kwargs = self.config["evaluation_seed"], self.config["hyperparameters"].get("env_kwargs") or {}
        best = self.folder / BEST
        policy = load_run(best)[0] if best.exists() else self._policy()
        for i in range(self.config["recordings"]):
            path = folder / recording_name(self.config["env"], seed + i)
            record(policy, self.config["env"], seed=seed + i, path=path, env_kwargs=env_kwargs)

    @property
    def last_checkpoint(self) -> Path | None:
        """The newest checkpoint, or None."""
        folders = checkpoint_folders(self.folder / "checkpoints")
        return folders[-1] if folders else None


def _plain(value: Any) -> int | float:
    return value if isinstance(value, int) else float(value)


def _numbers(group: str, row: dict[str, Any]) -> dict[str, float]:
    """Return the finite numbers of a row by entity, ``reward_x`` as ``group/reward/x``."""
    kept = {key: value for key, value in row.items() if key not in ("steps", "seconds") and value is not None}
    return {
        f"{group}/{key.replace('reward_', 'reward/', 1) if key.startswith('reward_') else key}": float(value)
        for key, value in kept.items()
        if np.isfinite(value)
    }


def _networks(start: str) -> tuple[Any, RunningMeanStd | None, str, str]:
    """Return model, statistics, environment id and algorithm of a pretrained policy or of a run."""
    if start in cards.names():
        policy, card = cards.load_pretrained(start)
        known = None if policy.normalization is None else transfer.counted(policy.normalization, card["steps"])
        return policy.model, known, card["environment"], card["algorithm"]
    policy, config = load_run(Path(start))
    known = None if policy.normalization is None else policy.normalization.obs_rms
    return policy.model, known, config["env"], config["algo"]
