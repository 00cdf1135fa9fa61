"""Evaluate a policy: ``python -m agents.evaluate --run DIR``, ``--pretrained NAME`` or ``--policy NAME --env ID``."""

import dataclasses
import json
import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

from elastica_gym.console.bad_input import (
    BadInputError,
    choose,
    choose_environment,
    environment_ids,
    make_folder,
    require_extra,
    run_command,
)
from elastica_gym.rl.evaluation import Evaluation, evaluate, print_table
from elastica_gym.rl.films import record
from elastica_gym.rl.seeds import TEST

if TYPE_CHECKING:
    from elastica_gym.rl.policies import Policy


@dataclasses.dataclass
class EvaluateArguments:
    """Evaluate a trained run, a pretrained policy or a baseline on episodes with the seeds seed, seed + 1, ..."""

    run: Path | None = None
    """Folder of a run of agents.train."""
    pretrained: str | None = None
    """Instead of a run: the name of a policy in agents/pretrained."""
    policy: str | None = None
    """Instead of a run: zero, random, scripted, seed_gait, the gait.yml that agents.search wrote, or a Python file with
    a function policy(observation), as scripts/score.py takes it."""
    env: str | None = None
    """Environment id, before which may stand the module that registers it, as in my_module:my_lab/SnakeTurn-v0; by
    default the one that the policy was trained or searched on."""
    spread: str | None = None
    """How starts are drawn, for tasks that know several: of OctopusReach arc, anywhere or default."""
    episodes: int = 50
    """How many episodes."""
    seed: int = TEST.start
    """Seed of the first episode; by default one that nothing is trained or chosen with (`elastica_gym.rl.seeds`)."""
    record: Path | None = None
    """Folder for a rerun recording of the first episode."""
    video: Path | None = None
    """File for a film of the first episode, which ends in .mp4 or .gif."""
    json: Path | None = None
    """File for the numbers as JSON: means, each episode, and what they were computed with."""
    threads: int = 2
    """Threads for the physics."""


def main() -> None:
    """Run the command line."""
    require_extra("train")
    import tyro

    arguments = tyro.cli(EvaluateArguments)
    from elastica_gym.progress import Bar

    if arguments.video is not None:
        from elastica_gym.rl.films import SIZE, check_film

        check_film(arguments.video, SIZE)
    for folder in (arguments.record, arguments.json and arguments.json.parent):
        if folder is not None:
            make_folder(folder)
    with Bar(f"evaluating {arguments.episodes} episodes") as bar:
        policy, env_id, env_kwargs = _policy_and_environment(arguments)
        if arguments.spread is not None:
            env_kwargs = {**env_kwargs, "spread": choose("spread", arguments.spread, spreads(env_id))}
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
        record(policy, env_id, seed=arguments.seed, folder=arguments.record, env_kwargs=env_kwargs)
    if arguments.video is not None:
        from elastica_gym.rl.films import film

        film(policy, env_id, arguments.video, seed=arguments.seed, env_kwargs=env_kwargs)


def write_json(path: Path, arguments: EvaluateArguments, result: Evaluation, **what: Any) -> None:
    """Write means, what each episode came to, the arguments, and the machine and versions; say where that is."""
    from elastica_gym.rl import machine

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
    """Return what is written as JSON, which has no NaN, with null for each."""
    if isinstance(value, dict):
        return {key: _without_nan(each) for key, each in value.items()}
    if isinstance(value, (list, tuple)):
        return [_without_nan(each) for each in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _policy_and_environment(arguments: EvaluateArguments) -> "tuple[Policy, str, dict[str, Any]]":
    if sum(given is not None for given in (arguments.run, arguments.pretrained, arguments.policy)) != 1:
        raise BadInputError("Give either --run DIR, --pretrained NAME or --policy zero|random|scripted|seed_gait|FILE.")
    if arguments.env is not None:
        from elastica_gym.rl.policies import BASELINES

        # a policy that does not look at observations takes them in any form
        choose_environment(arguments.env, goals=arguments.policy in BASELINES)
    # torch takes seconds to import: not before the arguments are known to be good
    from elastica_gym.rl.cards import load_pretrained
    from elastica_gym.rl.policies import load_run

    if arguments.policy is not None:
        return *_baseline_and_environment(arguments.policy, arguments.env), {}
    policy: Policy
    if arguments.pretrained is not None:
        policy, card = load_pretrained(arguments.pretrained)
        env_id, env_kwargs = card["environment"], card["env_kwargs"]
    else:
        assert arguments.run is not None
        policy, config = load_run(arguments.run)
        env_id, env_kwargs = config["env"], config["hyperparameters"].get("env_kwargs") or {}
    return policy, arguments.env or choose_environment(env_id), env_kwargs


def _baseline_and_environment(name: str, env_id: str | None) -> "tuple[Policy, str]":
    from elastica_gym.envs import task_of
    from elastica_gym.rl.policies import baseline
    from elastica_gym.scripted.families import load_gait

    if Path(name).suffix == ".yml":
        gait, searched_on = load_gait(Path(name))
        return gait, env_id or choose_environment(searched_on)
    if env_id is None:
        raise BadInputError(f"--policy needs --env, one of {', '.join(environment_ids())}.")
    if Path(name).suffix == ".py":
        return _file_policy(Path(name)), env_id
    if name == "seed_gait" and task_of(env_id).make_body().name != "snake":
        raise BadInputError(f"seed_gait is the snake's published gait; {env_id} is not a snake's.")
    return baseline(name), env_id


def _file_policy(path: Path) -> "Policy":
    """Return the policy of a Python file, as the score takes it, in this process."""
    from elastica_gym.rl.policy_file import FilePolicy

    if not path.is_file():
        raise BadInputError(f"There is no policy file {path}.")
    return FilePolicy(path)


def spreads(env_id: str) -> tuple[str, ...]:
    """Return the ways in which an environment can draw its starts."""
    from elastica_gym.envs import task_of

    return tuple(task_of(env_id).initial_states)


if __name__ == "__main__":
    run_command(main)
