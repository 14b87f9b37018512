"""How a quantity spreads: distributions of scipy.stats, truncated where the study says, as maps from [0, 1]."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from giveway.base.checks import finite
from giveway.base.errors import GivewayError, UnknownNameError
from giveway.base.units import WrittenUnit
from giveway.study.quantities import Quantity

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from giveway.study.parts import PartChoice

__all__ = ["DISTRIBUTIONS", "Spread", "Tolerance", "Varied", "check_spread"]

SIGMAS = 3.0  # where a normal distribution is truncated if the study does not say
# Per distribution: the keys it needs besides low and high, and whether these are needed, too.
DISTRIBUTIONS: Mapping[str, tuple[tuple[str, ...], bool]] = {
    "uniform": ((), True),
    "loguniform": ((), True),
    "triangular": (("mode",), True),
    "normal": (("mean", "sigma"), False),
    "lognormal": (("mean", "sigma"), False),
}
SHARE_MIN = 2.0**-53  # what has no end is not asked for its end


@dataclass(frozen=True)
class Spread:
    """A distribution between ``low`` and ``high``, or without end; ``mode``, ``mean``, ``sigma`` where it has them."""

    kind: str
    low: float
    high: float
    mode: float = 0.0
    mean: float = 0.0
    sigma: float = 1.0

    def at(self, share: NDArray[np.float64]) -> NDArray[np.float64]:
        """The values below which the shares (0 to 1) lie."""
        from scipy import stats

        width = self.high - self.low
        distribution: Any
        if self.kind == "uniform":
            distribution = stats.uniform(self.low, width)
        elif self.kind == "loguniform":
            distribution = stats.loguniform(self.low, self.high)
        elif self.kind == "triangular":
            distribution = stats.triang((self.mode - self.low) / width, self.low, width)
        else:
            if not self.bounded:
                share = np.clip(share, SHARE_MIN, 1.0 - SHARE_MIN)
            if self.kind == "lognormal":
                return np.asarray(np.clip(np.exp(self._logarithm().at(share)), self.low, self.high))
            cut = (self.low - self.mean) / self.sigma, (self.high - self.mean) / self.sigma
            distribution = stats.truncnorm(*cut, self.mean, self.sigma)
        # The inverse of a truncated distribution may leave its range by a rounding error.
        return np.asarray(np.clip(distribution.ppf(share), self.low, self.high))

    @property
    def bounded(self) -> bool:
        """Both ends are finite."""
        return math.isfinite(self.low) and math.isfinite(self.high)

    def _logarithm(self) -> Spread:
        """The normal distribution of the logarithm of a lognormal one."""
        variance = math.log1p((self.sigma / self.mean) ** 2)
        mean, low = math.log(self.mean) - 0.5 * variance, -math.inf if self.low <= 0.0 else math.log(self.low)
        return Spread("normal", low, math.log(self.high), mean=mean, sigma=math.sqrt(variance))


@dataclass(frozen=True)
class Varied:
    """A quantity that differs from design to design: either between ``levels``, or over ``spread``.

    ``nominal`` is what it has while another one varies; None: what the scenario has. All values are in the quantity's
    unit; ``written`` is the user's. ``field`` is its table of the study file; ``parts``: its values are parts.
    """

    quantity: Quantity
    nominal: float | None = None
    levels: tuple[float, ...] = ()
    spread: Spread | None = None
    written: WrittenUnit | None = None
    field: str = ""
    parts: PartChoice | None = None

    @property
    def sets(self) -> tuple[Quantity, ...]:
        """The quantities to which it gives values: itself, or what its parts set."""
        return (self.quantity,) if self.parts is None else tuple(one.quantity for one in self.parts.settings)

    @property
    def columns(self) -> tuple[int, ...]:
        """Columns of the run table that it decides."""
        return tuple(column for quantity in self.sets for column in quantity.columns)

    @property
    def unit(self) -> WrittenUnit:
        """The unit in which its values are shown."""
        return self.written or WrittenUnit(self.quantity.unit)

    def text(self, value: float) -> str:
        """``value`` as the user would write it, in `unit`."""
        return self.quantity.text(self.unit.of(value) if self.quantity.kind == "real" else value)

    def at(self, share: NDArray[np.float64]) -> NDArray[np.float64]:
        """The values of the shares (0 to 1)."""
        if self.spread is None:
            last = len(self.levels) - 1
            which = np.minimum((share * len(self.levels)).astype(np.intp), last)
            return np.asarray(np.array(self.levels)[which])
        if self.quantity.kind == "real":
            return self.spread.at(share)
        return np.asarray(np.rint(self.spread.at(share)))


@dataclass(frozen=True)
class Tolerance:
    """How a quantity deviates from what the design says: ``value (1 + d)`` if ``relative``, else ``value + d``.

    If it ``replaces`` the value, ``spread`` is that of the quantity itself; NaN stands for the design's own value.
    """

    quantity: Quantity
    relative: bool
    spread: Spread
    written: WrittenUnit | None = None
    replaces: bool = False

    @property
    def unit(self) -> WrittenUnit:
        """The unit in which an absolute deviation is shown."""
        return self.written or WrittenUnit(self.quantity.unit)


def check_spread(
    field: str, quantity: Quantity, kind: str, values: Mapping[str, float], ends: tuple[float, float] | None = None
) -> Spread:
    """The spread of ``kind`` with the checked ``values`` (low, high, mode, mean, sigma), errors named ``field.key``.

    ``ends``: where a normal or lognormal one ends that states no low and high; None: three sigma from its mean.
    """
    if kind not in DISTRIBUTIONS:
        raise UnknownNameError(f"{field}.distribution", kind, DISTRIBUTIONS)
    needed, ends_needed = DISTRIBUTIONS[kind]
    for key in (*needed, *(("low", "high") if ends_needed else ())):
        if key not in values:
            raise GivewayError(f"{field}.{key}", "nothing", f"a finite number; {kind} needs it")
    for key in values:
        if key not in (*needed, "low", "high"):
            raise GivewayError(f"{field}.{key}", values[key], f"nothing: {kind} has no {key}")
    given = dict(values)
    if not ends_needed:
        if given["sigma"] <= 0.0:
            raise GivewayError(f"{field}.sigma", given["sigma"], "above 0")
        if kind == "lognormal" and given["mean"] <= 0.0:
            raise GivewayError(f"{field}.mean", given["mean"], "above 0: of a lognormal distribution")
        low, high = ends or (given["mean"] - SIGMAS * given["sigma"], given["mean"] + SIGMAS * given["sigma"])
        given.setdefault("low", max(low, 0.0) if kind == "lognormal" else low)
        given.setdefault("high", high)
    if not given["low"] < given["high"]:
        raise GivewayError(f"{field}.high", given["high"], f"above low, {given['low']:g}: the range is empty")
    if kind == "loguniform" and given["low"] <= 0.0:
        raise GivewayError(f"{field}.low", given["low"], "above 0: the range is logarithmic")
    if kind == "triangular":
        finite(f"{field}.mode", given["mode"], given["low"], given["high"])
    if quantity.kind not in ("real", "integer"):
        raise GivewayError(f"{field}.low", given["low"], f"values = [...] with some of {quantity.allowed}")
    return Spread(kind, **{key: float(value) for key, value in given.items()})
