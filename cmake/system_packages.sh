#!/usr/bin/env bash
# What has to be on the machine before the rest can be fetched and built: as root on Debian it is
# installed, otherwise a message names what is missing.
set -euo pipefail

python=${PYTHON:-python3}
missing=()

need() { # need PACKAGE COMMAND...: the package, unless the command succeeds
    local package=$1
    shift
    "$@" >/dev/null 2>&1 || missing+=("$package")
}

cargo_is_recent() { # Debian 12's own cargo (0.66) cannot read the registry
    local minor
    minor=$(cargo --version | sed -n 's/^cargo 1\.\([0-9]*\)\..*/\1/p')
    [ "${minor:-0}" -ge 78 ]
}

compiles() { # compiles HEADER: the C++ compiler finds it
    echo "#include <$1>" | g++ -I/usr/include/eigen3 -fsyntax-only -x c++ -
}

need g++ g++ --version
need cargo-web cargo_is_recent
need libgtest-dev compiles gtest/gtest.h
need libeigen3-dev compiles Eigen/Core
need python3 "$python" -c 'import sys; sys.exit(sys.version_info < (3, 11))'
need python3-venv "$python" -c 'import ensurepip, venv'

if [ ${#missing[@]} -eq 0 ]; then
    exit 0
fi
if [ "$(id -u)" -ne 0 ] || ! command -v apt-get >/dev/null; then
    echo "error: missing on this machine: ${missing[*]}" >&2
    echo "On Debian 12: sudo apt-get install ${missing[*]}" >&2
    exit 1
fi
echo "Installing ${missing[*]}"
export DEBIAN_FRONTEND=noninteractive
apt-get update -qq
apt-get install -qq -y --no-install-recommends "${missing[@]}" >/dev/null
