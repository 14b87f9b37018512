#!/usr/bin/env bash
# Prints the path of a Python 3.12: the command python3.12, uv's, or pyenv's.
set -euo pipefail
for candidate in python3.12 "$(uv python find 3.12 2> /dev/null || true)" \
    $(ls -d "$(pyenv root 2> /dev/null || echo "$HOME/.pyenv")"/versions/3.12*/bin/python3.12 2> /dev/null); do
    if [ -n "$candidate" ] && "$candidate" -c 'import sys; assert sys.version_info[:2] == (3, 12)' 2> /dev/null; then
        "$candidate" -c 'import sys; print(sys.executable)'
        exit 0
    fi
done
echo "no Python 3.12: install python3.12, or let uv or pyenv install it (\`uv python install 3.12\`)" >&2
exit 1
