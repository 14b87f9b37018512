"""Ctrl-C while Dask brings a result: no complaint of what was broken off."""

from __future__ import annotations

import gc
import os
import signal
import time
from typing import Any

import pytest
from cluster_processes import HOST
from giveway.cluster import pool
from giveway.study.golden import golden_works

distributed = pytest.importorskip("distributed")


def test_it_leaves_no_complaint(caplog: pytest.LogCaptureFixture) -> None:
    options = {"host": HOST, "dashboard_address": f"{HOST}:0", "memory_limit": 0, "silence_logs": 60}
    with (
        distributed.LocalCluster(n_workers=1, threads_per_worker=1, processes=True, **options) as cluster,
        pool.joined(cluster.scheduler_address, None, golden_works()) as workers,
    ):
        client, gather = workers._client, workers._client._gather

        async def late(*told: Any, **named: Any) -> Any:
            os.kill(os.getpid(), signal.SIGINT)
            time.sleep(0.5)  # the loop hears of it and of what follows at once, when the fetch is about to look
            return await gather(*told, **named)

        client._gather = late
        with pytest.raises(KeyboardInterrupt):
            workers.wait(60.0)
    gc.collect()
    assert [record for record in caplog.records if record.name == "asyncio"] == []
