"""Write the page of every environment: ``python scripts/document_environments.py`` writes docs/environments/."""

import argparse
from pathlib import Path

from elastica_gym.console.bad_input import make_folder, run_command
from elastica_gym.envs import GOAL_IDS, IDS, document, task_of

PAGES = Path(__file__).parents[1] / "docs" / "environments"


def main() -> None:
    """Run the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=PAGES, help="folder of the pages (default: %(default)s)")
    folder = make_folder(parser.parse_args().out)
    for env_id in (*IDS, *GOAL_IDS):
        task = task_of(env_id)
        (folder / f"{task.name}.md").write_text(document(task))
    print(f"wrote {len(IDS) + len(GOAL_IDS)} pages into {folder}")


if __name__ == "__main__":
    run_command(main)
