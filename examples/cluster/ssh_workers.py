"""A Dask scheduler on the first machine and a worker on each of the others, over SSH. Ctrl-C ends all of them.

    python ssh_workers.py head node1 node2 --python /opt/giveway/.venv/bin/python
    giveway sweep STUDY.toml --dask tcp://head:8786

Names, ports, users and keys come from ~/.ssh/config, known machines from ~/.ssh/known_hosts.
"""

from __future__ import annotations

import argparse
import contextlib
import signal
import sys

from distributed import SSHCluster


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("hosts", nargs="+", metavar="HOST", help="the scheduler's, then one or more of workers")
    parser.add_argument("--python", default=sys.executable, help="Python with giveway and distributed, on all of them")
    parser.add_argument("--threads", type=int, help="of each worker; without it: all processors")
    parser.add_argument("--port", type=int, default=8786, help="of the scheduler")
    arguments = parser.parse_args()
    with SSHCluster(
        arguments.hosts if len(arguments.hosts) > 1 else arguments.hosts * 2,
        worker_options={"nthreads": arguments.threads, "memory_limit": 0},
        scheduler_options={"port": arguments.port, "dashboard": False},
        remote_python=arguments.python,
    ) as cluster:
        print(f"giveway sweep STUDY.toml --dask {cluster.scheduler_address}", flush=True)
        with contextlib.suppress(KeyboardInterrupt):
            signal.pause()


if __name__ == "__main__":
    main()
