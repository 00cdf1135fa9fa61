"""The goals, for an episode that achieves them all and variations that narrowly miss."""

import numpy as np
import pytest

from elastica_gym.envs import handling
from elastica_gym.hackathon import scoring
from elastica_gym.hackathon.scoring import GOALS, Samples, goals_held, score

DT = 0.01
END = 12.0
clock = np.arange(round(END / DT) + 1) * DT


def along(*points):
    """Interpolate (time, value) points over time."""
    return np.interp(clock, *zip(*points, strict=True))


def between(begin, end):
    return (clock > begin - 1e-9) & (clock < end + 1e-9)


def course(x):
    return np.stack([x, np.zeros_like(x)], axis=1)[:, None]


def perfect(**changed):
    """One episode: crawl to the object by 3 s, hold it with the first arm from 4 s to 5 s, be home by 10 s."""
    grip = along((3.0, 0.0), (3.9, 0.0), (4.0, 220.0), (5.0, 220.0), (5.1, 160.0))
    fields = dict(
        time=clock,
        counted=np.ones((clock.size, 1), dtype=bool),
        head=course(along((0.0, 0.0), (3.0, 0.22), (5.0, 0.22), (10.0, 0.05))),
        centre=course(along((0.0, 0.0), (3.0, 0.12), (5.0, 0.12), (10.0, 0.0))),
        head_gap=along((0.0, 0.225), (3.0, 0.005))[:, None],
        touched=(clock >= 3.5)[:, None],
        base=course(along((0.0, 0.4), (5.0, 0.4), (10.0, 0.25))),
        tilt=np.full((clock.size, 1), np.radians(5.0)),
        spans=np.radians(np.stack([grip, np.zeros_like(grip)], axis=1))[:, None],
        counts=np.where(grip > 0.0, 20, 0)[:, None, None] * np.array([1, 0]),
    )
    return Samples(**{**fields, **changed})


def held(samples):
    """Return the goals that an episode achieves."""
    return [goal for goal, ok in zip(GOALS, goals_held(samples)[:, 0], strict=True) if ok]


def up_to(goal):
    return list(GOALS[: GOALS.index(goal)])


def with_spans(degrees, *, first=0, counts=20):
    """An episode in which one arm spans an angle over time, and the other nothing."""
    spans, numbers = np.zeros((clock.size, 1, 2)), np.zeros((clock.size, 1, 2), dtype=np.int64)
    spans[:, 0, first] = np.radians(degrees)
    numbers[:, 0, first] = np.where(degrees > 0.0, counts, 0)
    return perfect(spans=spans, counts=numbers)


def test_all_goals():
    assert held(perfect()) == list(GOALS)


def test_nothing_happens():
    still = perfect()
    assert held(Samples(clock, *(np.repeat(field[:1], clock.size, axis=0) for field in still[1:]))) == []


def test_nothing_counts_after_the_end():
    for end, goal in ((2.0, "crawl"), (4.4, "move"), (8.4, "return")):
        counted = (clock <= end)[:, None]
        assert held(perfect(counted=counted)) == up_to(goal)


# crawl


def test_the_head_has_to_come_far_enough():
    assert held(perfect(head=course(along((0.0, 0.0), (3.0, 0.199), (10.0, 0.0))))) == []


def test_the_body_has_to_come_along():
    """The head is thrown forward while the arms stay behind."""
    assert held(perfect(centre=course(along((0.0, 0.0), (3.0, 0.099), (10.0, 0.0))))) == []


def test_head_and_body_come_far_at_the_same_time():
    late = course(along((0.0, 0.0), (9.0, 0.0), (12.0, 0.2)))
    assert held(perfect(centre=late)) == []


# reach


def test_the_head_has_to_come_near():
    assert held(perfect(head_gap=along((0.0, 0.225), (3.0, 0.0501))[:, None])) == up_to("reach")
    assert "reach" in held(perfect(head_gap=along((0.0, 0.225), (3.0, 0.05))[:, None]))


# move


def test_an_object_that_was_never_touched():
    assert held(perfect(touched=np.zeros((clock.size, 1), dtype=bool))) == up_to("move")


def test_an_object_that_slides_after_a_blow():
    assert held(perfect(touched=between(5.0, 6.0)[:, None])) == up_to("move")


def test_an_object_that_is_touched_now_and_then():
    """Touched in every second sample: no displacement lies between two touches."""
    assert held(perfect(touched=(np.arange(clock.size) % 2 == 0)[:, None])) == up_to("move")


def test_an_object_that_is_moved_while_tipped_over():
    assert held(perfect(tilt=np.radians(along((3.0, 0.0), (5.0, 46.0)))[:, None])) == up_to("move")
    assert held(perfect(tilt=np.radians(along((3.0, 0.0), (5.0, 44.0)))[:, None])) == list(GOALS)


def test_an_object_that_is_shaken():
    """A path of five metres, to and fro by 0.08 m."""
    shaken = 0.4 + 0.04 * np.sin(2.0 * np.pi * 4.0 * clock)
    assert np.abs(np.diff(shaken[clock >= 3.5])).sum() > 5.0
    assert held(perfect(base=course(shaken))) == up_to("move")


def test_the_object_has_to_be_moved_far_enough():
    assert held(perfect(base=course(along((5.0, 0.35), (10.0, 0.251))))) == up_to("move")
    assert held(perfect(base=course(along((5.0, 0.352), (10.0, 0.25))))) == list(GOALS)


def test_pushes_add_up():
    touched = (between(5.0, 7.0) | between(8.0, 10.0))[:, None]
    assert "move" in held(perfect(touched=touched))


# grab


@pytest.mark.parametrize("first", [0, 1])
def test_either_arm_may_grab(first):
    degrees = np.degrees(perfect().spans[:, 0, 0])
    assert held(with_spans(degrees, first=first)) == list(GOALS)


def test_an_arm_that_does_not_reach_round():
    assert held(with_spans(np.where(clock >= 4.0, 199.9, 0.0))) == up_to("grab")
    assert held(with_spans(np.where(clock >= 4.0, 200.0, 0.0))) == list(GOALS)


def test_too_few_elements():
    degrees = np.where(clock >= 4.0, 250.0, 0.0)
    assert held(with_spans(degrees, counts=4)) == up_to("grab")
    assert held(with_spans(degrees, counts=5)) == list(GOALS)


@pytest.mark.parametrize(("seconds", "grabs"), [(0.48, False), (0.49, False), (0.5, True), (0.51, True)])
def test_a_grab_takes_half_a_second(seconds, grabs):
    degrees = np.where(between(4.0, 4.0 + seconds), 220.0, np.where(clock > 4.0, 160.0, 0.0))
    assert held(with_spans(degrees)) == (list(GOALS) if grabs else up_to("grab"))


def test_a_grab_with_a_break():
    """Three seconds of grip with every 49th sample missing."""
    degrees = np.where(between(4.0, 7.0) & (np.arange(clock.size) % 49 > 0), 220.0, np.where(clock > 4.0, 199.0, 0.0))
    assert held(with_spans(degrees)) == up_to("grab")


def test_a_break_by_number_of_elements():
    samples = with_spans(np.where(clock >= 4.0, 220.0, 0.0))
    samples.counts[::49, 0, 0] = 4
    assert held(samples) == up_to("grab")


def test_arms_do_not_add_up():
    half = np.radians(np.where(clock >= 4.0, 130.0, 0.0))
    counts = np.full((clock.size, 1, 2), 20)
    assert held(perfect(spans=np.stack([half, half], axis=1)[:, None], counts=counts)) == up_to("grab")


def test_arms_do_not_take_turns():
    """Each holds for 0.4 s at a time, so that one of them always holds."""
    turn = (clock // 0.4).astype(int) % 2
    spans = np.radians(220.0) * np.stack([turn == 0, turn == 1], axis=1)[:, None]
    counts = np.full((clock.size, 1, 2), 20)
    assert held(perfect(spans=spans, counts=counts)) == up_to("grab")


# return


@pytest.mark.parametrize(("lapse", "keeps"), [(0.1, True), (0.2, True), (0.21, False), (1.0, False)])
def test_a_grip_that_is_lost(lapse, keeps):
    """From the last good sample to the first good one is one sample more than the lapse."""
    grip = np.degrees(perfect().spans[:, 0, 0])
    degrees = np.where((clock > 6.0 + 1e-9) & (clock < 6.0 + lapse + 1e-9), 149.0, grip)
    assert held(with_spans(degrees)) == (list(GOALS) if keeps else up_to("return"))


def test_a_grip_that_slips_again_and_again():
    """Many lapses, each short enough."""
    grip = np.degrees(perfect().spans[:, 0, 0])
    degrees = np.where((clock > 5.0) & (np.arange(clock.size) % 20 > 0), 0.0, grip)
    assert held(with_spans(degrees)) == list(GOALS)


def test_a_grip_that_is_lost_has_to_be_grabbed_again():
    grip = np.degrees(perfect().spans[:, 0, 0])
    lost = np.where(between(6.0, 6.3), 0.0, grip)
    for seconds, returns in ((0.49, False), (0.5, True)):
        again = np.where(between(8.0, 8.0 + seconds), 210.0, lost)
        assert held(with_spans(again)) == (list(GOALS) if returns else up_to("return"))


def test_the_other_arm_may_not_return_the_object():
    samples = perfect()
    late = clock > 6.0
    samples.spans[late, 0, 1] = samples.spans[late, 0, 0]
    samples.spans[late, 0, 0] = 0.0
    assert held(samples) == up_to("return")


def test_the_head_has_to_come_home():
    away = course(along((0.0, 0.0), (3.0, 0.22), (5.0, 0.22), (10.0, 0.101)))
    assert held(perfect(head=away)) == up_to("return")


def test_home_is_not_enough_without_the_object():
    """It was moved, but left behind."""
    assert held(perfect(base=course(along((5.0, 0.5), (10.0, 0.36))))) == up_to("return")


def test_the_object_has_to_be_held_at_home():
    """Held until 0.1 s before it is home, and flung the rest of the way."""
    samples = perfect()
    home = np.argmax(samples.head[:, 0, 0][clock > 5.0] <= 0.1) + np.argmax(clock > 5.0)
    samples.spans[home - 10 :] = 0.0
    assert held(samples) == up_to("return")


def test_an_animal_that_never_left_does_not_return():
    """All other goals first, with the head at home, then a crawl after the grip is lost."""
    head = course(along((0.0, 0.0), (11.0, 0.0), (12.0, 0.25)))
    centre = course(along((0.0, 0.0), (11.0, 0.0), (12.0, 0.15)))
    grip = np.where(between(4.0, 10.5), 220.0, 0.0)
    samples = with_spans(grip)._replace(head=head, centre=centre)
    assert held(samples) == up_to("return")
    # with the grip kept, but the head no longer at home
    assert held(with_spans(np.where(clock > 4.0, 220.0, 0.0))._replace(head=head, centre=centre)) == up_to("return")


# all goals


def test_a_goal_holds_only_with_those_before_it():
    assert held(perfect(head_gap=np.ones((clock.size, 1)))) == ["crawl"]


def test_episodes_do_not_mix():
    good, bad = perfect(), perfect(touched=np.zeros((clock.size, 1), dtype=bool))
    both = Samples(clock, *(np.concatenate(pair, axis=1) for pair in zip(good[1:], bad[1:], strict=True)))
    np.testing.assert_array_equal(goals_held(both), np.concatenate([goals_held(good), goals_held(bad)], axis=1))


def test_non_finite_samples_achieve_nothing():
    for name in ("head", "centre", "head_gap", "base", "tilt", "spans"):
        broken = perfect()
        getattr(broken, name)[1:] = np.nan
        assert held(broken) == up_to(
            {"head": "crawl", "centre": "crawl", "head_gap": "reach", "base": "move", "tilt": "move", "spans": "grab"}[
                name
            ]
        )


def test_samples_may_be_finer():
    """Goals do not depend on the time between samples."""
    coarse = perfect()
    finer = Samples(*(np.repeat(field, 2, axis=0) for field in coarse))
    finer = finer._replace(time=np.repeat(clock, 2) + np.tile([0.0, 0.5 * DT], clock.size))
    assert held(finer) == list(GOALS)


def points(default, arc=0.0, anywhere=0.0, n=100):
    def held_in(goals, n_held, n):
        mask = np.zeros((5, n), dtype=bool)
        mask[:goals, :n_held] = True
        return mask

    return score(
        {"default": default, "arc": held_in(5, round(arc * n), n), "anywhere": held_in(5, round(anywhere * n), n)}
    )


@pytest.mark.parametrize(("goals", "total"), [(0, 0.0), (1, 5.0), (2, 12.5), (3, 20.0), (4, 30.0), (5, 50.0)])
def test_points(goals, total):
    default = np.zeros((5, 5), dtype=bool)
    default[:goals] = True
    assert points(default)["total"] == total
    # each goal must be achieved from all five initial states
    default[:goals, 3] = False
    assert points(default)["total"] == 0.0


def test_points_for_targets():
    everything = np.ones((5, 5), dtype=bool)
    result = points(everything, arc=0.5, anywhere=0.25)
    assert result["general"] == pytest.approx(12.5 + 6.25)
    assert result["total"] == pytest.approx(50.0 + 18.75)
    assert points(everything, 1.0, 1.0)["total"] == 100.0
    four = np.ones((5, 8), dtype=bool)
    four[4] = False
    assert score({"default": everything, "arc": four, "anywhere": four})["general"] == 0.0


def test_task_and_scorer_have_the_same_bounds():
    """They are defined twice, to keep rewards and points independent."""
    assert (handling.WRAPPED, handling.FEWEST, handling.GRABBING_TIME) == (
        scoring.GRAB,
        scoring.GRAB_COUNT,
        scoring.GRAB_TIME,
    )
    assert (handling.KEPT, handling.SLACK_TIME) == (scoring.HOLD, scoring.LAPSE)
    assert (handling.MOVED, handling.UPRIGHT) == (scoring.MOVE, scoring.UPRIGHT)
    assert handling.CRAWLED == (scoring.CRAWL_HEAD, scoring.CRAWL_CENTRE)
    assert (handling.AT_HOME, handling.BROUGHT) == (scoring.HOME, scoring.BESIDE)
