#!/usr/bin/env bash
# python.sh VERSION: prints the path of such a Python, say 3.12: of the command, of uv's, or of pyenv's.
set -euo pipefail
version=$1
for candidate in "python$version" "$(uv python find "$version" 2> /dev/null || true)" \
    $(ls -d "$(pyenv root 2> /dev/null || echo "$HOME/.pyenv")"/versions/"$version".*/bin/"python$version" 2> /dev/null); do
    if [ -n "$candidate" ] && "$candidate" -c "import ensurepip, sys; assert sys.version.startswith('$version.')" 2> /dev/null; then
        "$candidate" -c 'import sys; print(sys.executable)'
        exit 0
    fi
done
echo "no Python $version: install python$version, or let uv or pyenv install it (\`uv python install $version\`)" >&2
exit 1
