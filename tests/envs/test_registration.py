"""External tasks, and the ids of external and own tasks. The contract's tests include an external one."""

from dataclasses import replace

import gymnasium
import numpy as np
import pytest

import elastica_gym
from elastica_gym.envs import GOAL_IDS, IDS, BatchEnv, SingleEnv, registered_ids, task_of

from .toy import AWAY, TOY, TOY_GOAL


def test_ids_and_tasks_belong_together(any_id):
    assert any_id in registered_ids()
    for env in (gymnasium.make(any_id).unwrapped.batch, gymnasium.make_vec(any_id, num_envs=1).unwrapped):
        assert env.task is task_of(any_id)
        env.close()


def test_an_external_task_is_the_registered_one():
    assert task_of(TOY) is AWAY
    assert task_of(f"{__package__}.toy:{TOY}") is AWAY
    assert {TOY, TOY_GOAL, *IDS, *GOAL_IDS} <= set(registered_ids())


def test_ids_of_other_packages_are_not_ours():
    assert "CartPole-v1" not in registered_ids()
    for env_id in ("CartPole-v1", "elastica_gym/SnakeForward-v7"):
        with pytest.raises(ValueError, match=rf"env_id must be one of .*{IDS[0]}.*, not '{env_id}'"):
            task_of(env_id)


def test_an_id_may_alias_another_with_other_arguments():
    long = "tests/SnakeForwardLong-v0"
    spec = gymnasium.spec(IDS[0])
    gymnasium.register(
        long,
        entry_point=spec.entry_point,
        vector_entry_point=spec.vector_entry_point,
        kwargs={**spec.kwargs, "duration": 30.0},
    )
    try:
        assert task_of(long) is task_of(IDS[0]) and long in registered_ids()
        assert gymnasium.make(long).unwrapped.batch.max_episode_steps == 600
    finally:
        del gymnasium.registry[long]


def test_a_saved_spec_makes_the_same_environment(any_id):
    """As in Minari data sets, which store specs as JSON."""
    text = gymnasium.make(any_id, duration=0.5).spec.to_json()
    env = gymnasium.make(gymnasium.envs.registration.EnvSpec.from_json(text))
    assert env.unwrapped.batch.task is task_of(any_id) and env.unwrapped.batch.max_episode_steps == 10


def test_a_spec_of_an_unregistered_task_names_the_missing_import():
    for make in (gymnasium.make, gymnasium.make_vec):
        with pytest.raises(ValueError, match="not 'mine/Lost-v0': import the module that registers it"):
            make(IDS[0], task="mine/Lost-v0")


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"initial_states": {}}, "initial_states must have at least one"),
        ({"reward_weights": {"away": 1.0}}, "reward_weights must have a weight for each of .*diverged, not for away"),
        ({"failures": {"success": AWAY.succeeds}}, "failures must have other names than running, .*, not success"),
    ],
)
def test_invalid_declarations_raise(changed, message):
    with pytest.raises(ValueError, match=message):
        replace(AWAY, **changed)


def test_a_goal_observation_of_another_width_than_declared_raises():
    wrong = replace(AWAY, observe_goal=lambda situation: np.stack(situation.goal, axis=1))
    for env in (BatchEnv(wrong), SingleEnv(wrong)):
        with pytest.raises(ValueError, match=r"observe_goal of SnakeAway must return \(1, 1\), .* not \(1, 3\)"):
            env.reset(seed=0)


def test_registering_is_public():
    assert elastica_gym.register is elastica_gym.envs.register
