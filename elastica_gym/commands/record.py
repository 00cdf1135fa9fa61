"""Record episodes of a policy as a Minari dataset."""

import dataclasses
import importlib.util
import re
from typing import Any

import numpy as np

from ..console.bad_input import BadInputError, check_bounds, choose_environment
from ..rl.seeds import TEST
from . import parse

NEEDED = ("minari", "h5py", "jax")
"""Packages that Minari records with"""
NAME = re.compile(r"([\w-]+/)*[\w-]+-v\d+")
"""Names that Minari takes"""


@dataclasses.dataclass
class RecordArguments:
    """Record episodes of a policy as a dataset for offline reinforcement learning, in Minari's format.

    Datasets are kept where the environment variable MINARI_DATASETS_PATH says, by default in ~/.minari/datasets.
    """

    policy: str
    """zero, random, scripted or seed_gait; a shipped policy; the folder of a run; a gait (.yml) or a policy (.py)."""
    dataset: str
    """Name of the dataset, which ends in its version, such as snake-forward/expert-v0."""
    env: str | None = None
    """Environment id; by default the one that the policy was trained on."""
    episodes: int = 100
    """Number of episodes."""
    seed: int = TEST.stop
    """Seed of the first episode; by default one that is used neither for training nor for tests."""


def main() -> None:
    """Run the command line."""
    arguments = parse(
        "record",
        RecordArguments,
        "--policy scripted --env elastica_gym/SnakeReach-v1 --episodes 100 --dataset snake-reach/scripted-v0",
        "--policy snake_forward_ppo --dataset snake-forward/expert-v0",
    )
    check_bounds(dataclasses.asdict(arguments), {"episodes": 1, "seed": 0})
    if missing := [name for name in NEEDED if importlib.util.find_spec(name) is None]:
        raise BadInputError(f"{', '.join(missing)} not installed: pip install 'minari[hdf5,create]'")
    if not NAME.fullmatch(arguments.dataset):
        raise BadInputError(f"dataset must be a name with a version such as snake/expert-v0, got {arguments.dataset!r}")
    if arguments.env is not None:
        choose_environment(arguments.env)
    import minari

    if arguments.dataset in minari.list_local_datasets():
        raise BadInputError(f"dataset {arguments.dataset!r} exists already: choose another version")
    returns = record(arguments)
    print(f"recorded {len(returns)} episodes, mean return {np.mean(returns):.3f}, as {arguments.dataset}")
    print(f"Load it with: minari.load_dataset({arguments.dataset!r})")


def record(arguments: RecordArguments) -> list[float]:
    """Record the episodes, and return the return of each."""
    import gymnasium
    import minari

    from ..progress import track
    from ..rl import machine, policy_sources

    policy, env_id, env_kwargs = policy_sources.find(arguments.policy, arguments.env)
    plain: Any = gymnasium.make(env_id, **env_kwargs)
    env = minari.DataCollector(plain, record_infos=True)
    returns = []
    for seed in track(range(arguments.seed, arguments.seed + arguments.episodes), "recording"):
        observation, _ = env.reset(seed=seed)
        policy.reset([seed])
        total, over = 0.0, False
        while not over:
            action = policy(observation[None], plain.unwrapped.batch)[0]
            observation, reward, terminated, truncated, _ = env.step(np.clip(action, -1.0, 1.0).astype(np.float32))
            total, over = total + float(reward), terminated or truncated
        returns.append(total)
    env.create_dataset(
        dataset_id=arguments.dataset,
        eval_env=env_id.rpartition(":")[2],
        algorithm_name=arguments.policy,
        description=f"{arguments.episodes} episodes of {arguments.policy} from seed {arguments.seed}; "
        f"elastica-gym {machine.versions().get('elastica-gym', 'source')}, commit {machine.commit()}",
    )
    env.close()
    return returns
