#!/usr/bin/env bash
# From a fresh clone to a scored policy in ten minutes: installs and runs the starter kit.
# Arguments go to scripts/starter_kit.py (--help).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/environment.sh
install_into_venv train,viz
exec .venv/bin/python scripts/starter_kit.py "$@"
