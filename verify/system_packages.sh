#!/usr/bin/env bash
# The tools of `make verify`. Each rung names the tools it calls, and fails if one is missing.
set -euo pipefail
# shellcheck source=cmake/packages.sh
source "$(dirname "$0")/../cmake/packages.sh"

has() { # has COMMAND: it can be called
    command -v "$1"
}

# The packages that the build itself needs (cmake/system_packages.sh) are already installed.
need clang-19 has clang-19
need llvm-19 has llvm-cov-19
need frama-c-base has frama-c
need libclang-rt-19-dev test -e /usr/lib/llvm-19/lib/clang/19/lib/linux/libclang_rt.fuzzer-x86_64.a
need valgrind has valgrind
need qemu-user has qemu-aarch64
need gcc-mingw-w64-x86-64 has x86_64-w64-mingw32-gcc
for machine in i686:i386 aarch64:arm64 riscv64:riscv64 arm:armhf s390x:s390x; do
    triplet=${machine%%:*}-linux-gnu
    [ "$triplet" = arm-linux-gnu ] && triplet=arm-linux-gnueabihf
    need "gcc-$triplet" has "$triplet-gcc"
    need "libc6-dev-${machine##*:}-cross" test -e "/usr/$triplet/include/stdint.h"
done
need wine64 test -x /usr/lib/wine/wine64
install_missing
