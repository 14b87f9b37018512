"""What things cost (`giveway bench`): one co-simulated second, collisions per second, integration methods."""

from giveway.bench.co_simulation import Timing, measure

__all__ = ["Timing", "measure"]
