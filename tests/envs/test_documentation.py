"""The docstrings are the specification: they say what is so."""

import importlib
import re

import numpy as np

from elastica_gym.envs import document
from elastica_gym.envs.registration import SHIPPED, task_of


def _specification(env):
    """The docstring of a task's module, or of one from elsewhere what is written from its declaration."""
    if task_of(env.spec.id) not in SHIPPED.values():
        return document(env.task)
    return importlib.import_module(type(env).__module__.rsplit(".", 1)[0] + "." + _module(env)).__doc__


def _module(env):
    return re.sub(r"(?<!^)(?=[A-Z])", "_", env.task.name).lower()


def _index_rows(text):
    """First and last index, and range, of each row of the observation table."""
    section = text.split("Observation\n")[1].split("Rewards\n")[0]
    rows = re.findall(r"^\| (\d+)(?:-(\d+))? \|.*\| (-?\d+) to (-?\d+) \|$", section, re.M)
    return [(int(first), int(last or first), float(low), float(high)) for first, last, low, high in rows]


def test_observation_table_covers_every_index_with_its_range(env_id, make_vec):
    env = make_vec(env_id)
    space, expected = env.single_observation_space, 0
    for first, last, low, high in _index_rows(_specification(env)):
        assert first == expected
        np.testing.assert_array_equal(space.low[first : last + 1], low)
        np.testing.assert_array_equal(space.high[first : last + 1], high)
        expected = last + 1
    assert expected == space.shape[0]


def test_what_is_written_from_a_declaration_covers_it_too(any_id):
    task, expected = task_of(any_id), 0
    names = [name for name, *_ in task.observations(task.make_body())]
    for first, last, _, _ in _index_rows(document(task)):
        assert first == expected
        # a row is of one kind, as the numbers that it counts
        assert len({name.split("/")[0] for name in names[first : last + 1]}) == 1
        expected = last + 1
    assert expected == len(names)


def test_reward_table_gives_the_weights(env_id, make_vec):
    env = make_vec(env_id)
    section = _specification(env).split("Rewards\n")[1].split("Starting state\n")[0]
    rows = re.findall(r"^\| (\w+) \| (-?[\d.]+) \|", section, re.M)
    assert {name: float(weight) for name, weight in rows} == env.task.reward_weights


def test_the_reasons_to_end_have_the_numbers_that_are_documented(env_id, make_vec):
    env = make_vec(env_id)
    text = " ".join(_specification(env).split()).split("``termination_reason``, a number: ")[1].split(".")[0]
    documented = {name: int(number) for number, name in re.findall(r"(\d+) (\w+)", text)}
    reasons = dict(zip(env.termination_reasons, range(len(env.termination_reasons)), strict=True))
    if not env.task.ends_on_success:
        reasons.pop("success")
    assert documented == reasons
