#!/usr/bin/env bash
# What the tests need from Debian, besides what the build needs (cmake/system_packages.sh).
set -euo pipefail
# shellcheck source=cmake/packages.sh
source "$(dirname "$0")/../cmake/packages.sh"

compiles() { # compiles HEADER: the C++ compiler finds it
    echo "#include <$1>" | g++ -I/usr/include/eigen3 -fsyntax-only -x c++ -
}

need libgtest-dev compiles gtest/gtest.h
need libeigen3-dev compiles Eigen/Core
# 32-bit x86: the sources in the controller FMU are compiled for it.
need g++-i686-linux-gnu i686-linux-gnu-g++ --version
# Cortex-M: c_core's bits, its cost and the firmware example are tested there.
need gcc-arm-none-eabi arm-none-eabi-gcc --version
need libnewlib-arm-none-eabi test -e /usr/lib/arm-none-eabi/newlib/libc.a
need qemu-system-arm qemu-system-arm --version
# The pages of web/ are tested in a browser.
need chromium chromium --version
install_missing
