#!/usr/bin/env bash
# What has to be on the machine before the rest can be fetched and built. The tests need more: tests/system_packages.sh.
set -euo pipefail
# shellcheck source=cmake/packages.sh
source "$(dirname "$0")/packages.sh"

python=${PYTHON:-python3}

cargo_is_recent() { # Debian 12's own cargo (0.66) cannot read the registry
    local minor
    minor=$(cargo --version | sed -n 's/^cargo 1\.\([0-9]*\)\..*/\1/p')
    [ "${minor:-0}" -ge 78 ]
}

need g++ g++ --version
need cargo-web cargo_is_recent
# The pages are bundled by what npm brings.
need nodejs node --version
need npm npm --version
need python3 "$python" -c 'import sys; sys.exit(sys.version_info < (3, 11))'
need python3-venv "$python" -c 'import ensurepip, venv'
install_missing
