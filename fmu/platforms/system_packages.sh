#!/usr/bin/env bash
# The programs that run FMUs of other platforms, for `make platforms`.
set -euo pipefail
# shellcheck source=cmake/packages.sh
source "$(dirname "$0")/../../cmake/packages.sh"

need wine64 test -x /usr/lib/wine/wine64
need qemu-user qemu-aarch64 --version
need libc6-arm64-cross test -e /usr/aarch64-linux-gnu/lib/ld-linux-aarch64.so.1
install_missing
