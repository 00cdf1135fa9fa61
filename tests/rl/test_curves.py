"""Learning curves: titles, first values and layout."""

import numpy as np
import pytest
import yaml

from elastica_gym.rl import curves
from elastica_gym.rl.run_files import EVALUATIONS, METRICS, Table
from tests.agents.commands import FORWARD


@pytest.fixture
def run_folder(tmp_path):
    """Create the folder of a run with a given configuration and tables."""

    def make(name, tables, **config):
        folder = tmp_path / name
        folder.mkdir()
        told = {"env": FORWARD, "algo": "ppo", "seed": 3, "steps": 100, "hyperparameters": {}} | config
        (folder / "config.yml").write_text(yaml.safe_dump(told))
        for file, successes in tables.items():
            table = Table(folder / file)
            for steps, success in enumerate(successes):
                table.append({"steps": 10 * (steps + 1), "return": 1.0, "distance": 0.5, "success": success})
            table.close()
        return folder

    return make


def test_titles_come_from_the_configuration_and_not_from_the_folder(run_folder):
    table = {METRICS: [0.0, 1.0]}
    plain = run_folder("ppo-3-20260101", table)
    taught = run_folder("dagger-2", table, imitate=128_000, steps=0, start_from="octopus_fetch_dagger", seed=1000)
    both = run_folder("both", table, imitate=500, start_from="/somewhere/runs/ppo-0")
    assert curves.title_of([plain]) == "SnakeForward-v1, PPO, seed 3"
    assert curves.title_of([taught]) == (
        "SnakeForward-v1, imitation over 128,000 steps, from octopus_fetch_dagger, seed 1000"
    )
    assert curves.title_of([both]) == "SnakeForward-v1, imitation over 500 steps, then PPO, from ppo-0, seed 3"
    again = run_folder("again", table, seed=1)
    assert curves.title_of([plain, again]) == "SnakeForward-v1, PPO, seeds 1, 3"
    assert curves.plot_run(taught).get_suptitle() == curves.title_of([taught])
    assert curves.plot_runs([plain, again]).get_suptitle() == curves.title_of([plain, again])


def test_the_curve_of_an_imitation_run_is_that_of_its_evaluations(run_folder):
    run = run_folder("dagger", {EVALUATIONS: [0.2, 0.6, 0.8]}, imitate=100, steps=0)
    assert curves.curve_of(run)["success"].tolist() == [0.2, 0.6, 0.8]
    (line,) = curves.plot_runs([run]).axes[2].get_lines()
    assert line.get_ydata()[0] == pytest.approx(0.2) and line.get_ydata()[-1] == pytest.approx(0.8)


def test_a_curve_does_not_begin_before_episodes_have_ended(run_folder):
    run = run_folder("run", {METRICS: [float("nan"), float("nan"), 0.5, 1.0]})
    (line,) = curves.plot_runs([run]).axes[2].get_lines()
    seen = np.isfinite(line.get_ydata())
    assert not seen[line.get_xdata() < 30.0].any() and seen[line.get_xdata() >= 30.0].all()


def test_labels_are_inside_the_figure(run_folder):
    run = run_folder("run", {METRICS: [0.5, 1.0]}, imitate=128_000, start_from="octopus_fetch_dagger")
    assert_inside(curves.plot_run(run))


def assert_inside(figure):
    """Check that no title or label of a figure is cut off."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    width, height = canvas.get_width_height()
    texts = [text for ax in figure.axes for text in (ax.title, ax.xaxis.label, ax.yaxis.label)]
    texts += figure.texts if figure._suptitle is None else [figure._suptitle]
    for text in filter(lambda text: text.get_text(), texts):
        box = text.get_window_extent()
        assert box.x0 >= 0.0 and box.y0 >= 0.0 and box.x1 <= width and box.y1 <= height, text.get_text()
