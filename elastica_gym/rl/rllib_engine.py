"""Training with RLlib's PPO: several processes collect experience, on one machine or on a cluster.

RLlib trains the same environments, as its environment runners make the batch of ``gymnasium.make_vec``. The networks
are those of Stable-Baselines3's ``MlpPolicy``, before training and after: evaluations, checkpoints and the final model
are saved as those of a Stable-Baselines3 model, so that every command reads the run. A resumed run continues with the
networks, the optimiser and the statistics of its checkpoint, but with new episodes, so not bit for bit.

Ray is imported only when a run is created.
"""

import contextlib
import pickle
import shutil
import signal
import sys
import tempfile
import time
from pathlib import Path
from types import FrameType
from typing import TYPE_CHECKING, Any

import numpy as np
from stable_baselines3.common.vec_env import VecNormalize

from ..console.bad_input import BadInputError, choose
from ..files import write_atomically
from ..progress import Bar
from . import curves
from .checkpoints import checkpoint_folders, last_whole_checkpoint, write_checkpoint
from .cluster import connected, require_ray
from .evaluation import evaluate
from .hyperparameters import algorithm_arguments, algorithm_class, normalize_arguments
from .policies import TrainedPolicy, use_one_thread
from .run_files import BEST, EVALUATIONS, METRICS, Table, read_table
from .seeds import training_seeds
from .vec_env import make_batch_vec_env

if TYPE_CHECKING:
    from ..viz.viewer import LiveView

MAPPED = {
    "batch_size": "minibatch_size",
    "n_epochs": "num_epochs",
    "gamma": "gamma",
    "gae_lambda": "lambda_",
    "clip_range": "clip_param",
    "ent_coef": "entropy_coeff",
    "vf_coef": "vf_loss_coeff",
    "max_grad_norm": "grad_clip",
}
"""Hyperparameters of ``configs/ppo.yml`` and RLlib's names for them"""
ELSEWHERE = ("n_envs", "n_timesteps", "n_steps", "learning_rate", "policy", "normalize", "policy_kwargs", "env_kwargs")
"""Hyperparameters that are used in another way than as arguments of ``PPOConfig.training``"""
ACTIVATIONS = {"Tanh": "tanh", "ReLU": "relu", "SiLU": "silu"}
NETWORKS = {
    "encoder.actor_encoder.net.mlp": "mlp_extractor.policy_net",
    "encoder.critic_encoder.net.mlp": "mlp_extractor.value_net",
    "pi.net.mlp.0": "action_net",
    "vf.net.mlp.0": "value_net",
    "pi.log_std": "log_std",
}
"""Parts of RLlib's networks, and of Stable-Baselines3's"""
MODULE = "default_policy"


def own_hyperparameters(values: dict[str, Any]) -> dict[str, Any]:
    """Return the hyperparameters that RLlib can follow, from those of Stable-Baselines3's PPO.

    Policies are plain networks, and rewards are not normalised. A limit of the policy change (``target_kl``), decaying
    clip ranges, and other keys without a counterpart are left out.
    """
    kept = {key: value for key, value in values.items() if key in MAPPED or key in ELSEWHERE}
    if isinstance(kept.get("clip_range"), str):
        kept["clip_range"] = float(kept["clip_range"].removeprefix("lin_"))
    normalize = normalize_arguments(values)
    scaled = normalize is not None and normalize.get("norm_obs", True)
    return {**kept, "policy": "MlpPolicy", "normalize": "dict(norm_obs=True, norm_reward=False)" if scaled else False}


def left_out(values: dict[str, Any]) -> list[str]:
    """Return the hyperparameters that RLlib does not follow, as sentences for the user."""
    kept = own_hyperparameters(values)
    found = [f"{key}={value}" for key, value in values.items() if key not in kept and value is not None]
    found += [f"policy={values['policy']}"] if values["policy"] != kept["policy"] else []
    normalize = normalize_arguments(values)
    return found + (["norm_reward=True"] if normalize is not None and normalize.get("norm_reward", True) else [])


def training_arguments(values: dict[str, Any], *, steps: int) -> dict[str, Any]:
    """Return the keyword arguments of ``PPOConfig.training``."""
    arguments = {new: values[old] for old, new in MAPPED.items() if old in values}
    rate = values.get("learning_rate", 3e-4)
    if isinstance(rate, str):
        rate = [[0, float(rate.removeprefix("lin_"))], [steps, 0.0]]
    # Stable-Baselines3 neither limits the value error nor penalises the change of the policy
    return {
        **arguments,
        "lr": rate,
        "train_batch_size_per_learner": values.get("n_envs", 1) * values.get("n_steps", 2048),
        "vf_clip_param": float("inf"),
        "use_kl_loss": False,
    }


def layers(values: dict[str, Any]) -> tuple[list[int], str]:
    """Return sizes and activation of the networks.

    Raises
    ------
    BadInputError
        If policy and value network differ, or the activation is another than `ACTIVATIONS`.
    """
    kwargs = algorithm_arguments(values).get("policy_kwargs") or {}
    sizes = kwargs.get("net_arch", [64, 64])
    if isinstance(sizes, dict):
        if sizes.get("pi", []) != sizes.get("vf", []):
            raise BadInputError(f"net_arch must have the same layers in pi and vf with --engine rllib, got {sizes}")
        sizes = sizes.get("pi", [])
    activation = kwargs.get("activation_fn")
    name = choose("activation of --engine rllib", activation.__name__ if activation else "Tanh", ACTIVATIONS)
    return list(sizes), ACTIVATIONS[name]


def seed_environments(*, env_runner: Any, env: Any, **kwargs: Any) -> None:
    """Give the environments of a runner seeds that no other runner, run or evaluation uses (`.seeds`)."""
    first = max(0, env_runner.worker_index - 1) * env.num_envs
    env.reset(seed=training_seeds(env_runner.config.seed, first, env.num_envs))
    # RLlib would seed them again, with consecutive numbers that overlap between runners
    env_runner._seed = None


def measure_episode(*, episode: Any, metrics_logger: Any, **kwargs: Any) -> None:
    """Record how an episode ended."""
    info = episode.get_infos(-1)
    metrics_logger.log_value("distance", float(info["distance"]), window=100)
    metrics_logger.log_value("success", float(info["is_success"]), window=100)


class RllibTraining:
    """A training run with RLlib: new, or resumed from its last intact checkpoint.

    Parameters
    ----------
    folder : Path
        The run's existing folder.
    config : dict
        Contents of ``config.yml``.
    resume : bool
        Whether to continue from the folder's last intact checkpoint.
    address : str, optional
        Of a Ray cluster; by default Ray runs on the cores of this machine.
    """

    def __init__(self, folder: Path, config: dict[str, Any], *, resume: bool, address: str | None = None):
        require_ray("ray", "ray.rllib")
        self.folder, self.config = folder, config
        self.values: dict[str, Any] = config["hyperparameters"]
        use_one_thread()
        self._closing = contextlib.ExitStack()
        self._make_twin()
        # one core more, for the learner
        self._closing.enter_context(connected(address, cores=config["env_runners"] + 1))
        self.algorithm = self._ppo().build_algo()
        self._closing.callback(self.algorithm.stop)
        checkpoint = last_whole_checkpoint(folder / "checkpoints") if resume else None
        saved: dict[str, Any] = {"steps": 0, "seconds": 0.0, "table_sizes": (0, 0)}
        if checkpoint is None:
            self._start_from_twin()
        else:
            saved = self._load(checkpoint)
        self.steps: int = saved["steps"]
        self.metrics = Table(folder / METRICS, size=saved["table_sizes"][0])
        self.evaluations = Table(folder / EVALUATIONS, size=saved["table_sizes"][1])
        self._started = time.monotonic() - saved["seconds"]
        self._checkpoint_at = self.seconds
        self._points_passed = int(self.spent * config["evaluations"]) + 1 if checkpoint else 0
        self._stop = False

    @property
    def seconds(self) -> float:
        """Time spent [s]."""
        return time.monotonic() - self._started

    @property
    def spent(self) -> float:
        """Fraction of the budget spent."""
        return min(1.0, self.steps / self.config["steps"])

    @property
    def last_checkpoint(self) -> Path | None:
        """The newest checkpoint, or None."""
        folders = checkpoint_folders(self.folder / "checkpoints")
        return folders[-1] if folders else None

    # Creating, saving and restoring

    def _make_twin(self) -> None:
        """Create the Stable-Baselines3 model that has the first networks, and that is evaluated and saved."""
        env: Any = make_batch_vec_env(
            self.config["env"], n_envs=1, n_threads=1, **(self.values.get("env_kwargs") or {})
        )
        self._closing.callback(env.close)
        normalize = normalize_arguments(self.values)
        self.normalization = None if normalize is None else VecNormalize(env, training=False, **normalize)
        arguments = algorithm_arguments(self.values) | {"n_steps": 2, "batch_size": 2}
        self.twin = algorithm_class("ppo")(
            env=self.normalization or env, seed=self.config["seed"], device="cpu", **arguments
        )

    def _ppo(self) -> Any:
        from ray.rllib.algorithms.ppo import PPOConfig
        from ray.rllib.connectors.env_to_module import MeanStdFilter
        from ray.rllib.core.rl_module.default_model_config import DefaultModelConfig

        sizes, activation = layers(self.values)
        runners = self.config["env_runners"]
        kwargs = {**(self.values.get("env_kwargs") or {}), "n_threads": 1}
        filters = {"env_to_module_connector": lambda env, spaces, device: MeanStdFilter()} if self.normalization else {}
        return (
            PPOConfig()
            # with the module that registers the ids, which runners must import
            .environment(_importable(self.config["env"]), env_config=kwargs)
            .env_runners(
                num_env_runners=runners,
                num_envs_per_env_runner=-(-self.values.get("n_envs", 1) // max(1, runners)),
                # the batch's default, AutoresetMode.NEXT_STEP, is the one that RLlib expects
                gym_env_vectorize_mode="vector_entry_point",
                rollout_fragment_length="auto",
                **filters,
            )
            .rl_module(
                model_config=DefaultModelConfig(
                    fcnet_hiddens=sizes,
                    fcnet_activation=activation,
                    head_fcnet_hiddens=[],
                    vf_share_layers=False,
                    free_log_std=True,
                )
            )
            .learners(num_learners=0, num_gpus_per_learner=0)
            .training(**training_arguments(self.values, steps=self.config["steps"]))
            .callbacks(on_environment_created=seed_environments, on_episode_end=measure_episode)
            .debugging(seed=self.config["seed"], log_level="ERROR")
            .reporting(min_time_s_per_iteration=0, metrics_num_episodes_for_smoothing=100)
        )  # fmt: skip

    def _module_state(self) -> dict[str, Any]:
        state = self.algorithm.learner_group.get_state("learner/rl_module")
        return state["learner"]["rl_module"][MODULE]

    def _start_from_twin(self) -> None:
        """Give RLlib's learner and runners the first networks of the twin."""
        import torch

        known, state = self.twin.policy.state_dict(), self._module_state()
        for name, other in _pairs(state):
            state[name] = known[other].numpy() if isinstance(state[name], np.ndarray) else torch.clone(known[other])
        self.algorithm.learner_group.set_state({"learner": {"rl_module": {MODULE: state}}})
        self.algorithm.env_runner_group.sync_weights(from_worker_or_learner_group=self.algorithm.learner_group)

    def _update_twin(self) -> None:
        """Copy RLlib's networks and observation statistics into the twin."""
        import torch

        state = self._module_state()
        self.twin.policy.load_state_dict({other: torch.as_tensor(state[name]) for name, other in _pairs(state)})
        self.twin.num_timesteps = self.steps
        if self.normalization is None:
            return
        from ray.rllib.connectors.env_to_module import MeanStdFilter
        from ray.rllib.utils.filter import RunningStat

        for connector in self.algorithm.env_runner._env_to_module.connectors:
            if isinstance(connector, MeanStdFilter):
                for agent in connector.get_state().values():
                    known: Any = self.normalization.obs_rms
                    seen = RunningStat.from_state(agent["running_stats"][0])
                    if seen.n > 1:
                        known.mean, known.var, known.count = seen.mean, seen.var, float(seen.n)

    def _save_policy(self, folder: Path) -> None:
        write_atomically(folder / "model.zip", self.twin.save)
        if self.normalization is not None:
            normalization = self.normalization
            write_atomically(folder / "vecnormalize.pkl", lambda path: normalization.save(str(path)))

    def _save_files(self, folder: Path) -> None:
        self._save_policy(folder)
        with tempfile.TemporaryDirectory() as temporary:
            self.algorithm.save_to_path(temporary)
            shutil.make_archive(str(folder / "rllib"), "tar", temporary)
        sizes = (self.metrics.size, self.evaluations.size)
        state = {"steps": self.steps, "seconds": self.seconds, "table_sizes": sizes}
        (folder / "state.pkl").write_bytes(pickle.dumps(state))

    def _load(self, checkpoint: Path) -> dict[str, Any]:
        with tempfile.TemporaryDirectory() as temporary:
            shutil.unpack_archive(checkpoint / "rllib.tar", temporary, filter="data")
            self.algorithm.restore_from_path(temporary)
        return pickle.loads((checkpoint / "state.pkl").read_bytes())

    # Running

    def run(self, live: "LiveView | None" = None) -> bool:
        """Train until the budget is spent or a stop is requested, then save. Return whether the budget is spent.

        A viewer is accepted as in `.training.Training.run`, but nothing is shown in it.
        """
        previous = {number: signal.signal(number, self._ask_to_stop) for number in (signal.SIGINT, signal.SIGTERM)}
        try:
            with Bar("training", file=sys.stdout) as self.display:
                self._evaluate_when_due()
                while self.spent < 1.0 and not self._stop:
                    self._iterate()
                    self._evaluate_when_due()
                    if self.seconds - self._checkpoint_at > 60.0 * self.config["checkpoint_minutes"]:
                        self._checkpoint()
                self._finish()
        finally:
            for number, handler in previous.items():
                signal.signal(number, handler)
            self.close()
        return not self._stop

    def close(self) -> None:
        """Stop the processes of this run, and close its files."""
        self._closing.close()
        self.metrics.close()
        self.evaluations.close()

    def _ask_to_stop(self, number: int, frame: FrameType | None) -> None:
        if self._stop:
            raise KeyboardInterrupt
        self._stop = True
        self.display.say("Stopping after this update; interrupt once more to stop at once.")

    def _iterate(self) -> None:
        """Collect a batch and update the networks from it."""
        started, before = time.monotonic(), self.steps
        result = self.algorithm.train()
        runners, learner = result["env_runners"], result["learners"].get(MODULE, {})
        self.steps = before + int(runners["num_env_steps_sampled"])
        row = {
            "steps": self.steps,
            "seconds": self.seconds,
            "steps_per_second": (self.steps - before) / (time.monotonic() - started),
            "return": float(runners.get("episode_return_mean", np.nan)),
            "length": float(runners.get("episode_len_mean", np.nan)),
            "distance": float(runners.get("distance", np.nan)),
            "success": float(runners.get("success", np.nan)),
            "entropy": float(learner.get("entropy", np.nan)),
            "value_loss": float(learner.get("vf_loss", np.nan)),
        }
        self.metrics.append(row)
        shown = ("steps", "steps_per_second", "return", "distance", "success")
        self.display.show(self.spent, {key.replace("steps_per_second", "steps/s"): row[key] for key in shown})

    def _evaluate_when_due(self) -> None:
        points = self.config["evaluations"]
        if not points or self.spent * points < self._points_passed:
            return
        self._points_passed = int(self.spent * points) + 1
        self._update_twin()
        result = evaluate(
            TrainedPolicy(self.twin, self.normalization),
            self.config["env"],
            episodes=self.config["evaluation_episodes"],
            seed=self.config["evaluation_seed"],
            n_threads=self.config["threads"],
            env_kwargs=self.values.get("env_kwargs"),
        )
        row = result.row(self.steps, self.seconds)
        if row["return"] > read_table(self.folder / EVALUATIONS).get("return", np.array([-np.inf])).max():
            best = self.folder / BEST
            best.mkdir(exist_ok=True)
            self._save_policy(best)
            config = (self.folder / "config.yml").read_bytes()
            write_atomically(best / "config.yml", lambda path: path.write_bytes(config))
        self.evaluations.append(row)
        self.display.say(
            f"evaluation at {self.steps:,} steps: return {row['return']:.3f} ± {row['return_ci95']:.3f}, "
            f"distance {row['distance']:.3f} m, success {row['success']:.0%}"
        )

    def _checkpoint(self) -> None:
        self._update_twin()
        write_checkpoint(self.folder / "checkpoints", self.steps, self._save_files)
        self._checkpoint_at = self.seconds

    def _finish(self) -> None:
        self._checkpoint()
        self._save_policy(self.folder)
        figure = curves.plot_run(self.folder)
        write_atomically(self.folder / "learning_curve.png", lambda path: curves.save(figure, path))


def _pairs(state: dict[str, Any]) -> list[tuple[str, str]]:
    """Return the names of each parameter in RLlib's state and in Stable-Baselines3's."""
    found = []
    for name in state:
        for part, other in NETWORKS.items():
            if name == part or name.startswith(f"{part}."):
                found.append((name, name.replace(part, other, 1)))
    return found


def _importable(env_id: str) -> str:
    return env_id if ":" in env_id else f"elastica_gym:{env_id}"
