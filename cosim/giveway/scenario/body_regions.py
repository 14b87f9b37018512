"""Judges a contact with a person by the force limits of a body region (ISO/TS 15066:2016, Annex A).

Two limits: the *peak* within the first 0.5 s of a contact (transient), and the *lasting* force after that, as in
clamping (quasi-static); where the area of the contact is known, its mean pressure likewise. `contact_peak` and
`speed_limit` are the standard's two-mass estimate of the first. The numbers are in `body_regions.toml`. They help to
judge a design, but do not replace the standard: `NOTICE` says so in every output.
"""

from __future__ import annotations

import functools
import math
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, TypeVar

from giveway.base.checks import finite
from giveway.base.errors import FileError, GivewayError, UnknownNameError

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import ArrayLike, NDArray

    TRANSIENT_S: float

__all__ = ["NOTICE", "TRANSIENT_S", "BodyRegion", "Judgement", "body_region", "body_regions", "contact_peak"]
__all__ += ["check_contact_area", "judge", "source", "speed_limit"]

CM2_PER_M2 = 1e4
CONTACT_AREA_M2 = (1e-6, 1.0)  # of the contact
SCHEMA_VERSION = 1
_FILE = Path(__file__).with_suffix(".toml")
_Stiffness = TypeVar("_Stiffness", float, "NDArray[np.float64]")


def __getattr__(name: str) -> float:
    """TRANSIENT_S: how long a contact counts as transient, s; a force that lasts longer is quasi-static."""
    if name != "TRANSIENT_S":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from giveway.library.recorded import windows

    return windows().transient_s


@dataclass(frozen=True)
class BodyRegion:
    """A part of the body.

    Attributes:
        name: what scenario files call it ("lower leg").
        covers: its parts.
        lasting_limit_n: highest quasi-static force, N.
        peak_limit_n: highest force within the first 0.5 s of a contact, N; 0 where no transient contact is allowed.
        lasting_pressure_limit, peak_pressure_limit: the same for the pressure, N/cm2, at the region's most sensitive
        spot. stiffness_npm: effective stiffness, N/m. mass_kg: effective mass, kg. source: the tables of the standard.
    """

    name: str
    covers: str
    lasting_limit_n: float
    peak_limit_n: float
    lasting_pressure_limit: float
    peak_pressure_limit: float
    stiffness_npm: float
    mass_kg: float
    source: str

    def stiffness_with(self, padding_npm: _Stiffness) -> _Stiffness:
        """Stiffness of the body in series with a cover of ``padding_npm``, N/m; infinite: none."""
        return 1.0 / (1.0 / self.stiffness_npm + 1.0 / padding_npm)

    def force_limits(self, contact_area_m2: float | None) -> tuple[float, float]:
        """Transient and lasting limit of the force, N; on ``contact_area_m2`` (m2) also those of the mean pressure."""
        peak, lasting = self.peak_limit_n, self.lasting_limit_n
        if contact_area_m2 is None:
            return peak, lasting
        area_cm2 = CM2_PER_M2 * contact_area_m2
        return min(peak, self.peak_pressure_limit * area_cm2), min(lasting, self.lasting_pressure_limit * area_cm2)


@dataclass(frozen=True)
class Judgement:
    """A force over time against the limits of a body region.

    Attributes:
        region: the body region.
        peak_n: largest force within the first 0.5 s of any contact, N; 0 without contact.
        peak_time_s: when; None without contact.
        lasting_n: largest force later than that in any contact, N; 0 if none lasted so long.
        lasting_time_s: when; None if none lasted so long.
        longest_contact_s: length of the longest contact, s.
        contact_area_m2: area of the contact, m2; None if it is not known, and the pressure neither.
        lasting_known: the trace continues for more than 0.5 s after the first touch, so the lasting force is known.
    """

    region: BodyRegion
    peak_n: float
    peak_time_s: float | None
    lasting_n: float
    lasting_time_s: float | None
    longest_contact_s: float
    contact_area_m2: float | None = None
    lasting_known: bool = True

    @property
    def peak_ok(self) -> bool:
        """The peak is within the transient limits; where no transient contact is allowed, there was none at all."""
        return self.peak_n <= self.region.force_limits(self.contact_area_m2)[0]

    @property
    def lasting_ok(self) -> bool:
        """The lasting force is within the quasi-static limits."""
        return self.lasting_n <= self.region.force_limits(self.contact_area_m2)[1]

    @property
    def peak_pressure(self) -> float | None:
        """Mean pressure at the peak of the force, N/cm2; None where the area is not known."""
        return None if self.contact_area_m2 is None else self.peak_n / (CM2_PER_M2 * self.contact_area_m2)

    @property
    def lasting_pressure(self) -> float | None:
        """Mean pressure of the lasting force, N/cm2; None where the area is not known."""
        return None if self.contact_area_m2 is None else self.lasting_n / (CM2_PER_M2 * self.contact_area_m2)

    @property
    def ok(self) -> bool:
        """Both limits are known to be kept."""
        return self.peak_ok and self.lasting_ok and self.lasting_known

    def __str__(self) -> str:
        """One line with the verdict, both forces and mean pressures, their limits, and the notice about the
        standard."""
        region = self.region
        allowed = f"{region.peak_limit_n:g} N" if region.peak_limit_n else "no transient contact"
        known = "within" if self.peak_ok and self.lasting_ok else "above"
        verdict = (
            f"{known} the limits" if self.lasting_known or known == "above" else "not known to be within the limits"
        )
        lasting = f"{self.lasting_n:.0f} N" if self.lasting_known else "not known, the run ended too soon"
        return (
            f"{region.name}: {verdict}: peak {self.peak_n:.0f} N (allowed: {allowed}), "
            f"lasting {lasting} (allowed: {region.lasting_limit_n:g} N){self._pressures()}. {NOTICE}"
        )

    def _pressures(self) -> str:
        region, area = self.region, self.contact_area_m2
        if area is None:
            return ""
        peak = f" (allowed: {region.peak_pressure_limit:g} N/cm2)" if region.peak_pressure_limit else ""
        lasting = f"{self.lasting_pressure:.1f} N/cm2" if self.lasting_known else "not known"
        return (
            f"; mean pressure on {CM2_PER_M2 * area:g} cm2: peak {self.peak_pressure:.1f} N/cm2{peak}, "
            f"lasting {lasting} (allowed: {region.lasting_pressure_limit:g} N/cm2)"
        )


def body_regions() -> Mapping[str, BodyRegion]:
    """All body regions by name, from head to foot."""
    return _read()[0]


def body_region(name: str) -> BodyRegion:
    """The body region called ``name``; UnknownNameError offers the nearest ones."""
    regions = body_regions()
    if name not in regions:
        raise UnknownNameError("body_region", name, regions)
    return regions[name]


def check_contact_area(area_m2: object) -> float:
    """``area_m2`` as a float, m2; GivewayError if it is not a number from 1e-6 to 1."""
    return finite("contact_area_m2", area_m2, *CONTACT_AREA_M2, "m2")


def source() -> str:
    """The source of the limits."""
    return str(_read()[1]["source"])


def judge(
    time_s: ArrayLike,
    force_n: ArrayLike,
    region: BodyRegion | str,
    *,
    touch_n: float = 0.0,
    contact_area_m2: float | None = None,
) -> Judgement:
    """Judge the magnitude of a contact force over time against the limits of ``region``.

    A contact begins when the force rises above ``touch_n`` and ends when it stays at or below it for 0.5 s: an earlier
    touch belongs to the same contact. So chatter is subject to the lower, lasting limit, and so is a second blow within
    one contact, which is on the safe side.

    Args:
        time_s: shape (n,), s, strictly rising.
        force_n: shape (n,), N, at least 0.
        region: a body region or its name.
        touch_n: force that counts as no contact, N, at least 0: above the noise of a measured trace.
        contact_area_m2: area over which the force spreads, m2, 1e-6 to 1; None: unknown, no pressure is judged. The
            pressure is the mean one: edges and hard spots press harder.
    """
    from giveway.library.recorded import judge_force

    chosen = body_region(region) if isinstance(region, str) else region
    finite("touch_n", touch_n, 0.0, math.inf, "N")
    if contact_area_m2 is not None:
        check_contact_area(contact_area_m2)
    time, force = _trace(time_s, force_n)
    found = judge_force(time, force, touch_n)
    return Judgement(
        chosen,
        found.transient_n,
        found.transient_time_s,
        found.lasting_n,
        found.lasting_time_s,
        found.longest_contact_s,
        contact_area_m2,
        found.lasting_known,
    )


def contact_peak(region: BodyRegion | str, speed_mps: float, robot_kg: float, padding_npm: float = math.inf) -> float:
    """Peak force of a free contact at ``speed_mps``, N: two masses and a spring, F = v sqrt(mu k).

    Args:
        region: a body region or its name.
        speed_mps: speed of the robot relative to the body, m/s, at least 0.
        robot_kg: moving mass of the robot, reflected rotors included, kg.
        padding_npm: stiffness of a cover or bumper in series with the body, N/m; infinite: none.
    """
    finite("speed_mps", speed_mps, 0.0, 100.0, "m/s")
    return speed_mps * _impedance(region, robot_kg, padding_npm)


def speed_limit(region: BodyRegion | str, robot_kg: float, padding_npm: float = math.inf) -> float:
    """Speed at which `contact_peak` reaches the transient limit of ``region``, m/s; 0 where none is allowed."""
    chosen = body_region(region) if isinstance(region, str) else region
    return chosen.peak_limit_n / _impedance(chosen, robot_kg, padding_npm)


def _impedance(region: BodyRegion | str, robot_kg: float, padding_npm: float) -> float:
    """sqrt(mu k), N s/m."""
    chosen = body_region(region) if isinstance(region, str) else region
    finite("robot_kg", robot_kg, 1e-3, 1e6, "kg")
    if padding_npm != math.inf:
        finite("padding_npm", padding_npm, 1e-3, 1e12, "N/m")
    mass = 1.0 / (1.0 / chosen.mass_kg + 1.0 / robot_kg)
    return math.sqrt(mass * chosen.stiffness_with(padding_npm))


def _trace(time_s: ArrayLike, force_n: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    import numpy as np

    time, force = np.asarray(time_s, dtype=np.float64), np.asarray(force_n, dtype=np.float64)
    if time.ndim != 1 or time.shape != force.shape:
        raise GivewayError("force_n", f"an array of shape {force.shape}", f"one force per time, shape {time.shape}")
    if not np.isfinite(time).all() or not (np.diff(time) > 0.0).all():
        raise GivewayError("time_s", "an array with a step that is not forward", "finite, strictly rising times in s")
    if not np.isfinite(force).all() or not (force >= 0.0).all():
        raise GivewayError("force_n", "an array with NaN, infinity or a negative force", "magnitudes in N, at least 0")
    return time, force


@functools.cache
def _read() -> tuple[Mapping[str, BodyRegion], dict[str, Any]]:
    document = tomllib.loads(_FILE.read_text(encoding="utf-8"))
    if document["schema_version"] != SCHEMA_VERSION:
        raise FileError(_FILE, f"schema_version is {document['schema_version']}", f"need {SCHEMA_VERSION}")
    regions = {
        entry["name"]: BodyRegion(
            name=entry["name"],
            covers=entry["covers"],
            lasting_limit_n=entry["force_limit_n"],
            peak_limit_n=entry["force_limit_n"] * entry["transient_factor"],
            lasting_pressure_limit=entry["pressure_limit_n_per_cm2"],
            peak_pressure_limit=entry["pressure_limit_n_per_cm2"] * entry["transient_factor"],
            stiffness_npm=entry["stiffness_npm"],
            mass_kg=entry["mass_kg"],
            source=entry["source"],
        )
        for entry in document["region"]
    }
    return MappingProxyType(regions), document


NOTICE: str = _read()[1]["notice"]
"""The notice about the standard; part of every output that shows a limit."""
