#!/usr/bin/env bash
# From a bare clone to a snake that has learned to crawl: installs, trains for five minutes at most,
# evaluates on unseen seeds and says where to look. Arguments go to scripts/quickstart.py (--help).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/environment.sh
install_into_venv train,viz
exec .venv/bin/python scripts/quickstart.py "$@"
