#!/usr/bin/env bash
# What the engines of bench/requirements.in need from Debian.
set -euo pipefail
# shellcheck source=cmake/packages.sh
source "$(dirname "$0")/../cmake/packages.sh"

has_library() { # has_library NAME: the loader finds it
    ldconfig -p | grep -q "$1"
}

need libtbb12 has_library libtbb.so.12
install_missing
