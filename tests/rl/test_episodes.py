"""Means over training episodes, compared with means counted by hand."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from elastica_gym.rl.episodes import Episodes

LONGEST = 10


def play(episodes, lengths, steps):
    """Run environments with episodes of these lengths in turn; those shorter than `LONGEST` are successes."""
    begun, turns = [0] * len(lengths), [iter(each) for each in lengths]
    current = [next(turn) for turn in turns]
    for step in range(1, steps + 1):
        infos = []
        for i, turn in enumerate(turns):
            if step - begun[i] < current[i]:
                infos.append({})
                continue
            info = {"episode": {"r": float(current[i]), "l": current[i]}, "is_success": current[i] < LONGEST}
            infos.append(info)
            begun[i], current[i] = step, next(turn)
        episodes.add(infos)


def test_early_successes_do_not_count_before_the_failures_that_began_with_them():
    episodes = Episodes(longest=LONGEST, window=100)
    # half of the environments always succeed after 2 steps, the other half never do
    lengths = [[2] * 100] * 5 + [[LONGEST] * 100] * 5
    play(episodes, lengths, LONGEST - 1)
    assert np.isnan(episodes.mean("success"))
    episodes = Episodes(longest=LONGEST, window=100)
    play(episodes, lengths, LONGEST)
    assert episodes.mean("success") == 0.5 and episodes.mean("l") == 6.0


def test_the_success_rate_is_not_biased_towards_episodes_that_ended_first():
    rng, rates = np.random.default_rng(0), []
    for _ in range(300):
        lengths = rng.choice([2, LONGEST], size=(8, 40), p=[0.3, 0.7]).tolist()
        episodes = Episodes(longest=LONGEST, window=100)
        play(episodes, lengths, 14)
        rates.append(episodes.mean("success"))
    # of the episodes ended by then, two thirds are successes
    assert abs(np.mean(rates) - 0.3) < 0.05


LENGTHS = st.lists(st.integers(1, LONGEST), min_size=61, max_size=61)


@given(st.lists(LENGTHS, min_size=1, max_size=4), st.integers(0, 60))
def test_settled_episodes_are_all_that_began_early_enough(lengths, steps):
    episodes = Episodes(longest=LONGEST, window=1000)
    play(episodes, lengths, steps)
    wanted = []
    for each in lengths:
        begins = np.cumsum([0, *each])[:-1]
        wanted += [n for n, begin in zip(each, begins, strict=True) if begin <= steps - LONGEST]
    assert sorted(told["l"] for told in episodes.settled()) == sorted(wanted)


def test_only_the_last_episodes_count_and_a_state_is_restored():
    one, other = (Episodes(longest=LONGEST, window=3) for _ in range(2))
    play(one, [[1, 2, 3, 4, 5, 6] + [10] * 9], 40)
    assert [told["l"] for told in one.settled()] == [5, 6, 10]
    other.set_state(one.get_state())
    assert other.mean("l") == one.mean("l") == 7.0
