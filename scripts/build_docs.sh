#!/usr/bin/env bash
# Builds the documentation site into docs/_build/html, to be opened from disk. Warnings are errors.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/environment.sh
install_into_venv train,viz,docs
.venv/bin/python -m sphinx -W --keep-going -q -b html docs docs/_build/html
echo "Open docs/_build/html/index.html"
