#!/usr/bin/env bash
# From a fresh clone to a snake that has learned to crawl: installs, trains for at most five minutes,
# evaluates on unseen seeds and prints the paths of the results. Arguments go to scripts/quickstart.py (--help).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/environment.sh
install_into_venv train,viz
exec .venv/bin/python scripts/quickstart.py "$@"
