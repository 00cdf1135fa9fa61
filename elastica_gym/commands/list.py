"""List what there is to train and to play."""

import dataclasses

from . import invocation, parse


@dataclasses.dataclass
class ListArguments:
    """List the environments, with the sizes of their observations and actions, and the shipped policies."""


def main() -> None:
    """Run the command line."""
    from rich.console import Console
    from rich.table import Table

    from ..envs import observation_names, registered_ids, task_of
    from ..rl import cards
    from ..rl.policies import BASELINES

    parse("list", ListArguments, "")
    console = Console()
    table = Table("environment", "observation", "action", "task")
    table.columns[0].no_wrap = True
    for env_id in registered_ids():
        task = task_of(env_id)
        summary = " ".join(task.description.strip().partition("\n\n")[0].split()).partition(": ")[2]
        table.add_row(env_id, str(len(observation_names(env_id))), str(task.make_body().n_activations), summary)
    console.print(table)
    table = Table("shipped policy", "trained on", "success", "return", "distance [m]")
    for name in cards.names():
        card = cards.read_card(name)
        score = card["score"]
        numbers = (f"{score['success_rate']:.0%}", f"{score['return_mean']:.1f}", f"{score['distance_mean']:.2f}")
        table.add_row(name, card["environment"].rpartition("/")[2], *numbers)
    console.print(table)
    console.print(f"Baselines: {', '.join(BASELINES)}.")
    console.print(f"Watch one: {invocation('play')} snake_reach_ppo", highlight=False)
