"""Evaluate a policy: ``python -m agents.evaluate --run DIR``, ``--pretrained NAME`` or ``--policy NAME --env ID``."""

import dataclasses
import json
import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..console.bad_input import (
    BadInputError,
    choose_environment,
    make_folder,
    require_extra,
)
from ..rl.evaluation import Evaluation, evaluate, print_table
from ..rl.films import record, recording_name
from ..rl.seeds import TEST
from . import parse

if TYPE_CHECKING:
    from ..rl.policy_sources import Source


@dataclasses.dataclass
class EvaluateArguments:
    """Evaluate a trained run, a pretrained policy or a baseline on episodes with the seeds seed, seed + 1, ..."""

    run: Path | None = None
    """Folder of a run of agents.train."""
    pretrained: str | None = None
    """Instead of a run: the name of a policy in agents/pretrained."""
    policy: str | None = None
    """Any policy: a baseline (zero, random, scripted, seed_gait), the folder of a run, a shipped policy, a gait.yml of
    agents.search, or a Python file with a function policy(observation), as for scripts/score.py."""
    env: str | None = None
    """Environment id, optionally with the module that registers it, as in my_module:my_lab/SnakeTurn-v0; by default the
    one that the policy was trained or searched on."""
    spread: str | None = None
    """Distribution of initial states, for tasks with several: arc, anywhere or default in OctopusReach."""
    episodes: int = 50
    """Number of episodes."""
    seed: int = TEST.start
    """Seed of the first episode; by default a test seed, used neither for training nor for choosing
    (`elastica_gym.rl.seeds`)."""
    record: Path | None = None
    """Folder for a rerun recording of the first episode."""
    video: Path | None = None
    """File for a film of the first episode, ending in .mp4 or .gif."""
    json: Path | None = None
    """File for the results as JSON: means, each episode, arguments, machine and versions."""
    threads: int = 2
    """Threads for the physics."""


def main() -> None:
    """Run the command line."""
    arguments = parse(
        "evaluate",
        EvaluateArguments,
        "--pretrained snake_reach_ppo --episodes 100",
        "--policy scripted --env elastica_gym/OctopusGrab-v1 --video grab.mp4",
        "--run runs/SnakeForward-v1/RUN --json numbers.json",
    )
    require_extra("train")
    from ..progress import Bar

    if arguments.video is not None:
        from ..rl.films import SIZE, check_film

        check_film(arguments.video, SIZE)
    for folder in (arguments.record, arguments.json and arguments.json.parent):
        if folder is not None:
            make_folder(folder)
    with Bar(f"evaluating {arguments.episodes} episodes") as bar:
        policy, env_id, env_kwargs = _source(arguments)
        result = evaluate(
            policy,
            env_id,
            episodes=arguments.episodes,
            seed=arguments.seed,
            n_threads=arguments.threads,
            env_kwargs=env_kwargs,
            show=bar.show,
        )
    name = arguments.policy or arguments.pretrained or str(arguments.run)
    print_table(f"{name} on {env_id}, {arguments.episodes} episodes from seed {arguments.seed}", result)
    if arguments.json is not None:
        write_json(arguments.json, arguments, result, policy=name, env=env_id, env_kwargs=env_kwargs)
    if arguments.record is not None:
        path = arguments.record / recording_name(env_id, arguments.seed)
        record(policy, env_id, seed=arguments.seed, path=path, env_kwargs=env_kwargs)
    if arguments.video is not None:
        from ..rl.films import film

        film(policy, env_id, arguments.video, seed=arguments.seed, env_kwargs=env_kwargs)


def write_json(path: Path, arguments: EvaluateArguments, result: Evaluation, **what: Any) -> None:
    """Write means, each episode, arguments, machine and versions as JSON, and print the path."""
    from ..rl import machine

    given = {key: str(value) if isinstance(value, Path) else value for key, value in vars(arguments).items()}
    everything = {
        **what,
        **result.summary(),
        "per_episode": result.per_episode(),
        "arguments": given,
        **machine.describe(),
    }
    path.write_text(json.dumps(_without_nan(everything), indent=2, allow_nan=False) + "\n")
    print(f"wrote {path}")


def _without_nan(value: Any) -> Any:
    """Replace non-finite numbers by None, since JSON has none."""
    if isinstance(value, dict):
        return {key: _without_nan(each) for key, each in value.items()}
    if isinstance(value, (list, tuple)):
        return [_without_nan(each) for each in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _source(arguments: EvaluateArguments) -> "Source":
    if sum(given is not None for given in (arguments.run, arguments.pretrained, arguments.policy)) != 1:
        raise BadInputError("Give either --run DIR, --pretrained NAME or --policy NAME.")
    if arguments.env is not None:
        from ..rl.policies import BASELINES

        # a baseline does not look at observations, so it takes them in any form
        choose_environment(arguments.env, goals=arguments.policy in BASELINES)
    # torch takes seconds to import: check the arguments first
    from ..rl import policy_sources

    if arguments.policy is not None:
        source = policy_sources.find(arguments.policy, arguments.env)
    elif arguments.pretrained is not None:
        source = policy_sources.from_pretrained(arguments.pretrained, arguments.env)
    else:
        assert arguments.run is not None
        source = policy_sources.from_run(arguments.run, arguments.env)
    return policy_sources.with_spread(source, arguments.spread)
