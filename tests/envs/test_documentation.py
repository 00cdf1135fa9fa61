"""The page of an environment is generated from its declaration and is correct."""

import re
from pathlib import Path

import numpy as np

from elastica_gym.envs import GOAL_IDS, IDS, document, task_of

ROOT = Path(__file__).parents[2]
PAGES = ROOT / "docs" / "environments"


def rows(text, section):
    """Return the cells of the rows of a section's table."""
    table = text.split(f"## {section}\n")[1].split("\n## ")[0]
    lines = [line for line in table.splitlines() if line.startswith("| ")][1:]
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines]


def test_every_id_has_an_up_to_date_page(monkeypatch):
    """Written by ``python scripts/document_environments.py``."""
    monkeypatch.syspath_prepend(str(ROOT / "scripts"))
    import document_environments

    pages = document_environments.pages()
    assert set(pages) == {"index", *(task_of(env_id).name for env_id in (*IDS, *GOAL_IDS))}
    assert {page.stem for page in PAGES.glob("*.md")} == set(pages)
    for name, text in pages.items():
        assert (PAGES / f"{name}.md").read_text() == text, "run scripts/document_environments.py"
    readme = (ROOT / "README.md").read_text()
    assert readme == document_environments.with_table(readme), "run scripts/document_environments.py"
    assert readme.count("\n") <= 150
    for env_id in (*IDS, *GOAL_IDS):
        assert 0 < (ROOT / "docs" / "images" / f"{task_of(env_id).name}.gif").stat().st_size <= 400_000


def test_the_page_covers_every_observation_with_its_range(env_id, make_vec):
    env = make_vec(env_id)
    space, expected = env.single_observation_space, 0
    for index, _, meaning, unit, bounds in rows(document(env.task), "Observation"):
        first, last = (int(index.split("-")[k]) for k in (0, -1))
        low, high = map(float, bounds.split(" to "))
        assert first == expected and meaning and unit
        np.testing.assert_array_equal(space.low[first : last + 1], np.float32(low))
        np.testing.assert_array_equal(space.high[first : last + 1], np.float32(high))
        expected = last + 1
    assert expected == space.shape[0]


def test_the_page_covers_every_action(env_id, make_vec):
    env, expected = make_vec(env_id), 0
    for index, _, arm in rows(document(env.task), "Action"):
        first, last = map(int, index.split("-"))
        assert first == expected
        assert all(f"/{arm}/" in name for name in env.single_action_space.names[first : last + 1])
        expected = last + 1
    assert expected == env.single_action_space.shape[0]


def test_the_page_gives_weight_and_formula_of_every_reward(env_id, make_vec):
    task = make_vec(env_id).task
    found = rows(document(task), "Rewards")
    assert {name: float(weight) for name, weight, _ in found} == task.reward_weights
    assert all(len(formula) > 10 and "(B" not in formula for _, _, formula in found)


def test_termination_reasons_have_the_documented_numbers(env_id, make_vec):
    env = make_vec(env_id)
    text = document(env.task).split("``termination_reason``, a number: ")[1].split(".")[0]
    documented = {name: int(number) for number, name in re.findall(r"(\d+) (\w+)", text)}
    reasons = dict(zip(env.termination_reasons, range(len(env.termination_reasons)), strict=True))
    if not env.task.ends_on_success:
        reasons.pop("success")
    assert documented == reasons
