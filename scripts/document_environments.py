"""Write the page of every environment, and their index: ``python scripts/document_environments.py``.

A page has the specification from the declaration of the task, the results of shipped policies from their cards, and
those of policies without training from docs/results/baselines.json, which `score_baselines.py` writes.
"""

import argparse
import json
from pathlib import Path
from typing import Any

from elastica_gym.console.bad_input import make_folder, run_command
from elastica_gym.envs import GOAL_IDS, IDS, document, observation_names, task_of
from elastica_gym.rl import cards

DOCS = Path(__file__).parents[1] / "docs"
README = DOCS.parent / "README.md"
BASELINES = DOCS / "results" / "baselines.json"
INDEX = "index"
BEGIN, END = "<!-- written by scripts/document_environments.py -->\n", "<!-- end -->"
"""What surrounds the table in the README"""
HINDSIGHT = "hindsight experience replay, see `elastica_gym.envs.goal`"


def main() -> None:
    """Run the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=DOCS / "environments", help="folder (default: %(default)s)")
    folder = make_folder(parser.parse_args().out)
    for name, text in pages().items():
        (folder / f"{name}.md").write_text(text)
    README.write_text(with_table(README.read_text()))
    print(f"wrote {len(pages())} pages into {folder}, and the table of {README}")


def pages() -> dict[str, str]:
    """Return the text of every page by its name."""
    ids = (*IDS, *GOAL_IDS)
    return {INDEX: index(ids), **{task_of(env_id).name: page(env_id) for env_id in ids}}


def page(env_id: str) -> str:
    """Return the page of an environment."""
    title, _, text = document(task_of(env_id)).partition("\n\n")
    summary, _, rest = text.partition("\n\n")
    return "\n\n".join([title, f"`{env_id}`: {summary}", _animation(env_id), *_results(env_id), rest])


def index(ids: tuple[str, ...]) -> str:
    """Return the page with the table of all environments."""
    rows = ["| environment | task | observation | action | shipped policy | score | minutes |", "|" + "---|" * 7]
    for env_id in ids:
        task = task_of(env_id)
        card = next(iter(cards.cards_of(env_id)), None)
        name = f"[{task.name}]({task.name}.md)"
        sizes = f"{len(observation_names(env_id))} | {task.make_body().n_activations}"
        score = f"`{card['name']}` | {best_score(card)} | {card['wall_time_minutes']:.0f}" if card else " | | "
        rows.append(f"| {name} | {_summary(task)} | {sizes} | {score} |")
    tree = ["```{toctree}", ":hidden:", "", *(task_of(env_id).name for env_id in ids), "```"]
    text = (
        "Scores are means over 100 unseen episodes; minutes are those that the shipped policy was trained for, on the "
        "machine that its card names, without those of a policy that it started from."
    )
    return "\n\n".join(["# Environments", text, "\n".join(rows), "\n".join(tree)]) + "\n"


def with_table(readme: str) -> str:
    """Return the README with its table of environments as it is now."""
    before, _, rest = readme.partition(BEGIN)
    _, end, after = rest.partition(END)
    rows = ["| | environment | task | observation, action | best score | minutes |", "|" + "---|" * 6]
    for env_id in (*IDS, *GOAL_IDS):
        task = task_of(env_id)
        card = next(iter(cards.cards_of(env_id)), None)
        score = f"{best_score(card)} | {card['wall_time_minutes']:.0f}" if card else " | "
        picture = f'<img src="docs/images/{task.name}.gif" width="150" alt="{task.name}">'
        link = f"[`{env_id}`](docs/environments/{task.name}.md)"
        sizes = f"{len(observation_names(env_id))}, {task.make_body().n_activations}"
        rows.append(f"| {picture} | {link} | {_summary(task)} | {sizes} | {score} |")
    return before + BEGIN + "\n" + "\n".join(rows) + "\n\n" + end + after


def _summary(task: Any) -> str:
    summary = document(task).split("\n\n")[1].removesuffix(".")
    return summary[:1].lower() + summary[1:]


def best_score(card: dict[str, Any]) -> str:
    """Return the number by which policies of a task are compared: the distance of crawls, else the success rate."""
    score = card["score"]
    if card["environment"].partition("/")[2].startswith(("SnakeForward", "OctopusCrawl")):
        return f"{score['distance_mean']:.2f} m"
    return f"{score['success_rate']:.0%}"


def _animation(env_id: str) -> str:
    name = task_of(env_id).name
    return f"![An episode of {name}](../images/{name}.gif)"


def _results(env_id: str) -> list[str]:
    """Return the scores of shipped policies and baselines, how the former were trained, and the learning curve."""
    found = cards.cards_of(env_id)
    rows = ["| policy | success | return | distance [m] | training steps | minutes |", "|" + "---|" * 6]
    for card in found:
        rows.append(_row(card["name"], card["score"], f"{card['steps']:,}", f"{card['wall_time_minutes']:.0f}"))
    for name, score in json.loads(BASELINES.read_text()).get(env_id, {"scores": {}})["scores"].items():
        rows.append(_row(name, score, "", ""))
    parts = ["## Results"]
    if len(rows) > 2:
        parts += ["On 100 unseen episodes, with 95 % intervals over episodes:", "\n".join(rows)]
    if found:
        trained = ["# trained and scored by", *(line for card in found for line in (card["command"], _scored(card)))]
        parts.append("```bash\n" + "\n".join(trained) + "\n```")
    else:
        parts.append(f"No policy ships for this environment; it is made for {HINDSIGHT}.")
    name = task_of(env_id).name
    if (DOCS / "images" / f"learning_{name}.png").exists():
        parts.append(f"![Learning curve of {name}](../images/learning_{name}.png)")
    return parts


def _scored(card: dict[str, Any]) -> str:
    return f"elastica-gym evaluate --policy {card['name']} --episodes {card['score']['episodes']}"


def _row(name: str, score: dict[str, Any], steps: str, minutes: str) -> str:
    low, high = score["success_interval95"]
    return (
        f"| `{name}` | {score['success_rate']:.0%} ({low:.0%} to {high:.0%}) "
        f"| {score['return_mean']:.1f} ± {score['return_ci95']:.1f} "
        f"| {score['distance_mean']:.2f} ± {score['distance_ci95']:.2f} | {steps} | {minutes} |"
    )


if __name__ == "__main__":
    run_command(main)
