"""A Dask scheduler here and workers as SLURM jobs, by dask-jobqueue. Ctrl-C ends all of them.

    python slurm_workers.py --jobs 20 --cores 32 --walltime 04:00:00 --queue compute
    giveway sweep STUDY.toml --dask tcp://HERE:8786

Workers whose time is up leave before SLURM kills them, and jobs are replaced; what they had is computed by others.
"""

from __future__ import annotations

import argparse
import contextlib
import signal
import sys

from dask_jobqueue import SLURMCluster

LEAVE_S, STAGGER_S = 120, 60  # before the end of a job; not all at once


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--cores", type=int, default=1, help="of each job: one worker with as many threads")
    parser.add_argument("--memory", default="4GB", help="of each job")
    parser.add_argument("--walltime", default="01:00:00", help="of each job, H:M:S")
    parser.add_argument("--queue", help="partition")
    parser.add_argument("--account")
    parser.add_argument("--interface", help="network of scheduler and workers, such as ib0")
    parser.add_argument("--python", default=sys.executable, help="with giveway and distributed, on the nodes")
    parser.add_argument("--port", type=int, default=8786, help="of the scheduler")
    parser.add_argument("--show", action="store_true", help="show the job script and end")
    arguments = parser.parse_args()
    hours, minutes, seconds = (int(part) for part in arguments.walltime.split(":"))
    lifetime_s = max(60, 3600 * hours + 60 * minutes + seconds - LEAVE_S)
    with SLURMCluster(
        cores=arguments.cores,
        processes=1,
        memory=arguments.memory,
        walltime=arguments.walltime,
        queue=arguments.queue,
        account=arguments.account,
        interface=arguments.interface,
        python=arguments.python,
        scheduler_options={"port": arguments.port, "dashboard": False},
        worker_extra_args=["--lifetime", f"{lifetime_s}s", "--lifetime-stagger", f"{STAGGER_S}s", "--no-dashboard"],
    ) as cluster:
        if arguments.show:
            print(cluster.job_script())
            return
        cluster.adapt(minimum_jobs=arguments.jobs, maximum_jobs=arguments.jobs)  # a job that ended is replaced
        print(f"giveway sweep STUDY.toml --dask {cluster.scheduler_address}", flush=True)
        with contextlib.suppress(KeyboardInterrupt):
            signal.pause()


if __name__ == "__main__":
    main()
