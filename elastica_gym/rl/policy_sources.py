"""Policies by what a user names: a run, a pretrained policy, a baseline, a gait file or a Python file."""

from pathlib import Path
from typing import Any, NamedTuple

from ..console.bad_input import BadInputError, choose, choose_environment, environment_ids, require_extra
from ..envs import task_of
from . import cards
from .policies import BASELINES, Policy, baseline, load_run


class Source(NamedTuple):
    """A policy and the environment it is meant for."""

    policy: Policy
    env_id: str
    """Id of the environment"""
    env_kwargs: dict[str, Any]
    """Arguments that the policy was trained with"""


def with_spread(source: Source, spread: str | None) -> Source:
    """Return a source whose initial states are drawn in another of the task's ways, or as it is for None."""
    if spread is None:
        return source
    choose("spread", spread, task_of(source.env_id).initial_states)
    return source._replace(env_kwargs={**source.env_kwargs, "spread": spread})


def find(name: str, env_id: str | None) -> Source:
    """Return the policy called ``name``: a run's folder, a pretrained policy, a baseline, a gait or a Python file.

    Raises
    ------
    BadInputError
        If there is no such policy, or it needs an environment and ``env_id`` is None.
    """
    if name in cards.names():
        return from_pretrained(name, env_id)
    if Path(name).is_dir():
        return from_run(Path(name), env_id)
    if name not in BASELINES and Path(name).suffix not in (".yml", ".py"):
        choose("policy", name, [*BASELINES, *cards.names()])
    return _from_name(name, env_id)


def from_run(run: Path, env_id: str | None) -> Source:
    """Return the policy of a run, on the environment it was trained on unless another is given."""
    require_extra("train")
    policy, config = load_run(run)
    known = env_id or choose_environment(config["env"])
    return Source(policy, known, config["hyperparameters"].get("env_kwargs") or {})


def from_pretrained(name: str, env_id: str | None) -> Source:
    """Return a pretrained policy, on the environment it was trained on unless another is given."""
    require_extra("train")
    policy, card = cards.load_pretrained(name)
    return Source(policy, env_id or choose_environment(card["environment"]), card["env_kwargs"])


def _from_name(name: str, env_id: str | None) -> Source:
    """Return a baseline, or the policy of a gait file (.yml) or of a Python file (.py)."""
    from ..scripted.families import load_gait

    if Path(name).suffix == ".yml":
        gait, searched_on = load_gait(Path(name))
        return Source(gait, env_id or choose_environment(searched_on), {})
    if env_id is None:
        raise BadInputError(f"{name} needs --env, one of {', '.join(environment_ids())}.")
    if Path(name).suffix == ".py":
        return Source(_of_file(Path(name)), env_id, {})
    if name == "seed_gait" and task_of(env_id).make_body().name != "snake":
        raise BadInputError(f"seed_gait is the snake's published gait; {env_id} is not a snake's.")
    return Source(baseline(name), env_id, {})


def _of_file(path: Path) -> Policy:
    """Return the policy of a Python file, as the score takes it, in this process."""
    from .policy_file import FilePolicy

    if not path.is_file():
        raise BadInputError(f"There is no policy file {path}.")
    return FilePolicy(path)
