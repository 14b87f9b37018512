#!/usr/bin/env bash
# What `make importers` needs beside Python packages: Java, for VDMCheck2.
set -euo pipefail
# shellcheck source=cmake/packages.sh
source "$(dirname "$0")/../cmake/packages.sh"

need default-jre-headless java -version
install_missing
