#!/usr/bin/env bash
# What has to be on the machine before the rest can be fetched and built.
set -euo pipefail
# shellcheck source=cmake/packages.sh
source "$(dirname "$0")/packages.sh"

python=${PYTHON:-python3}

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
# 32-bit x86: the sources in the controller FMU are compiled for it.
need g++-i686-linux-gnu i686-linux-gnu-g++ --version
# Cortex-M: c_core's bits, its cost and the firmware example are tested there.
need gcc-arm-none-eabi arm-none-eabi-gcc --version
need libnewlib-arm-none-eabi test -e /usr/lib/arm-none-eabi/newlib/libc.a
need qemu-system-arm qemu-system-arm --version
install_missing
