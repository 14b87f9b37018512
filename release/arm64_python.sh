#!/usr/bin/env bash
# arm64_python.sh FOLDER: Debian's Python for ARM64, unpacked in FOLDER for qemu; nothing is installed on this machine.
# apt fetches and checks the packages, with this machine's sources and keys and a state of its own.
set -euo pipefail
folder=$1
if [ -e "$folder/unpacked" ]; then
    exit 0
fi
if ! command -v apt-get > /dev/null || ! command -v dpkg-deb > /dev/null; then
    echo "no Python for ARM64: apt-get and dpkg-deb are not on this machine; on Debian 12 they are" >&2
    exit 1
fi
rm -rf "$folder"
mkdir -p "$folder"/apt/{lists,archives}/partial "$folder/partial"
folder=$(cd "$folder" && pwd)
: > "$folder/apt/status" # nothing is installed, so that everything that is needed is fetched
options=(-qq -o APT::Architecture=arm64 -o APT::Architectures=arm64 -o APT::Sandbox::User=
    -o "Dir::State=$folder/apt" -o "Dir::State::status=$folder/apt/status" -o "Dir::State::lists=$folder/apt/lists"
    -o "Dir::Cache=$folder/apt" -o "Dir::Cache::archives=$folder/apt/archives")
apt-get "${options[@]}" update
# libstdc++6 is asked for by the wheels of other people.
apt-get "${options[@]}" install --yes --no-install-recommends --download-only python3 libstdc++6
for package in "$folder"/apt/archives/*.deb; do
    dpkg-deb --extract "$package" "$folder/partial"
done
rm -r "$folder/apt"
mv "$folder/partial" "$folder/unpacked"
