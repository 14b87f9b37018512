"""The share of a collision's impulse that the estimator sees, with and without the force that stuck rollers carry.

The paper's estimator assumes that the real acceleration is the planned one, and its friction law is zero at rest: in
5.2 it misses a third of the impulse. With bristles for the rollers and the measured acceleration it sees all of it, at
rest and in motion, through the noise of the sensors.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from giveway.experiments import Experiment, motionless
from giveway.experiments.reproduction.findings import Effort, Findings, Picture, Row, Target

if TYPE_CHECKING:
    from giveway.experiments.impulse_trials import Seen
    from giveway.scenario.scenario import Scenario

JUDGED_S = 0.08
"""When the share is taken, after the contact, s: about when 5.2's bumpers are noticed."""
TARGET = Target(minimum=0.95)
SEEDS, FEW_SEEDS = 40, 4
CONTACT_S = 0.2  # 5.2's contact comes before
DRAWN = ("paper", "measured", "bristles")
ROWS = (*DRAWN, "soft")


def hits() -> dict[str, Scenario]:
    """The collisions by name: 5.2 with its three bumpers, and 5.3."""
    from giveway.experiments import moving
    from giveway.experiments.impulse_trials import SHOWN_S

    still = {
        "at rest, no bumper": "none",
        "at rest, spring": "spring",
        "at rest, magnetic": "magnetic",
    }
    short = {name: motionless.scenario(bumper, CONTACT_S + SHOWN_S + 0.01) for name, bumper in still.items()}
    return short | {"moving, magnetic": moving.scenario("magnetic", SHOWN_S + 0.05)}


def reproduce(effort: Effort) -> Findings:
    """Shares by 80 ms after the contact, for every hit and form of the estimator, and the impulses over time."""
    from giveway.experiments.figures.impulse_share import draw
    from giveway.experiments.impulse_trials import FORMS, run_forms

    seeds = effort.pick(SEEDS, FEW_SEEDS)
    forms = list(FORMS.values())
    noisy: dict[str, dict[str, Seen]] = {}
    quiet: dict[str, Seen] = {}
    scenarios = hits()
    for done, (name, scenario) in enumerate(scenarios.items()):

        def report(share: float, done: int = done) -> None:
            effort.progress((done + share) / len(scenarios))

        found = run_forms(scenario, forms, seeds, threads=effort.threads, progress=report)
        noisy[name] = dict(zip(FORMS, found, strict=True))
        quiet[name] = run_forms(scenario, [FORMS["bristles"]], 1, noise=False, threads=effort.threads)[0]
    picture = Picture(
        "impulse_share",
        "What the estimator sees of a hit's impulse",
        f"Mean over {seeds} noises, bands from lowest to highest. The line marks when the share is taken. No reaction, "
        "so that every form sees the same hit.",
        draw({name: {FORMS[form].label: seen[form] for form in DRAWN} for name, seen in noisy.items()}, JUDGED_S),
    )
    notes = [_note(name, noisy[name], quiet[name]) for name in noisy]
    return Findings([row for name, seen in noisy.items() for row in _rows(name, seen)], [picture], notes)


def _rows(name: str, seen: dict[str, Seen]) -> list[Row]:
    from giveway.experiments.impulse_trials import FORMS

    return [
        Row(
            f"share of the impulse, {name}: {FORMS[form].label}",
            float(seen[form].share(JUDGED_S).mean()),
            "1",
            "assumed",
            target=TARGET if form == "bristles" else None,
            reason=_reason(seen) if form == "bristles" else "",
            decimals=3,
        )
        for form in ROWS
    ]


def _reason(seen: dict[str, Seen]) -> str:
    """For a missed target: the result with another corner frequency of the rate filters."""
    from giveway.experiments.impulse_trials import HIGH_CUTOFF_RADPS, LOW_CUTOFF_RADPS

    slow, fast = (seen[form].share(JUDGED_S) for form in ("slow", "fast"))
    return (
        f"The corner of the rate filters decides, between lag and encoder steps: {slow.mean():.3f} at "
        f"{LOW_CUTOFF_RADPS:g} rad/s, {fast.mean():.3f} at {HIGH_CUTOFF_RADPS:g}"
    )


def _note(name: str, seen: dict[str, Seen], quiet: Seen) -> str:
    from giveway.experiments.impulse_trials import CUTOFF_RADPS, HIGH_CUTOFF_RADPS, LOW_CUTOFF_RADPS

    noisy = seen["bristles"]
    share, without = noisy.share(JUDGED_S), float(quiet.share(JUDGED_S)[0])
    corners = ", ".join(
        f"{seen[form].share(JUDGED_S).mean():.3f} ± {seen[form].share(JUDGED_S).std():.3f} at {cutoff:g} rad/s"
        for form, cutoff in (("slow", LOW_CUTOFF_RADPS), ("bristles", CUTOFF_RADPS), ("fast", HIGH_CUTOFF_RADPS))
    )
    return (
        f"Bristles, {name}: {share.min():.3f} to {share.max():.3f} over {len(share)} noises, {without:.3f} without "
        f"noise and with fine encoders, which so cost {without - share.mean():+.3f}. The seen impulse is ahead of the "
        f"true one by at most {noisy.excess().mean():.2f} N s. By corner of the rate filters: {corners}."
    )


EXPERIMENT = Experiment(
    name="impulse_share",
    summary="How much of a hit's impulse the estimator sees by 80 ms, with and without bristles for the rollers.",
    section="5.1",
    reproduce=reproduce,
)
