"""Random parameters, states, modes and inputs: all kinds and mounts, spinning, off centre, in and
out of contact."""

from __future__ import annotations

import math
from dataclasses import fields

import numpy as np
from kkt_reference import (
    KIND_MAGNETIC,
    KIND_NONE,
    LATCH_IDEALISED,
    MOUNT_ROBOT,
    STATES,
    Inputs,
    Modes,
    Parameters,
    Reference,
)

_NOT_SCALED = {
    "slider_direction",
    "slider_target_x",
    "slider_target_y",
    "bumper_mount_x",
    "bumper_mount_y",
    "bumper_mount_azimuth",
    "contact_friction",
    "wall_distance",
    "base_com_x",
    "base_com_y",
    "floor_slope",
    "floor_azimuth",
    "imu_x",
    "imu_y",
    "imu_azimuth",
}
_OF_LAWS = tuple(f"bumper_{what}_" for what in ("foam", "gas", "damper", "second", "first", "lever", "table"))


def parameters(rng: np.random.Generator, kind: int, mount: int, latch: int, roller: int) -> Parameters:
    p = Parameters(bumper_kind=kind, bumper_mount=mount, bumper_latch_model=latch, roller_model=roller)
    for f in fields(p):
        if (
            f.type == "float"
            and f.name not in _NOT_SCALED
            and not f.name.startswith(_OF_LAWS)
            and not f.name.startswith("fault")
        ):
            setattr(p, f.name, getattr(p, f.name) * rng.uniform(0.5, 2.0))
    p.roller_elastic_fraction = rng.uniform(0.1, 0.9)
    p.slider_damping = rng.uniform(0.0, 3.0)
    p.drivetrain_gear_stiction = p.drivetrain_gear_coulomb * rng.uniform(1.0, 1.5)
    p.contact_friction = rng.uniform(0.0, 0.6)
    p.wheel_load = rng.uniform(0.5, 1.5, 3).tolist()
    p.roller_presliding_stiffness = rng.uniform(1.0e4, 6.0e4, 3).tolist()
    if rng.random() < 0.1:
        p.wheel_traction[rng.integers(3)] = 0.0
    p.slider_present = int(rng.random() > 0.05)
    p.rope_attached = int(rng.random() > 0.2)
    p.slider_direction, p.bumper_mount_azimuth = rng.uniform(-math.pi, math.pi, 2)
    p.slider_target_x, p.slider_target_y = rng.uniform(-1.0, 1.0, 2)
    p.bumper_mount_x, p.bumper_mount_y = rng.uniform(-0.3, 0.3, 2)
    p.wall_present = int(rng.random() < 0.3)
    p.contact_height = rng.uniform(0.0, 2.0 * p.wheel_radius)
    p.outline_body, p.outline_wheels = ((1, 0), (1, 1), (0, 1))[rng.choice(3, p=(0.6, 0.2, 0.2))]
    if not (kind != KIND_NONE and mount == MOUNT_ROBOT):
        p.contact_nose_shape = int(rng.random() < 0.3)
    if rng.random() < 0.7:  # else the triangle
        angles = np.sort(rng.uniform(0.0, 2.0 * math.pi, rng.integers(5, 17)))
        angles[:3] = 0.0, 2.1, 4.2  # the centre stays inside
        angles = np.sort(angles)
        p.outline = list(zip((0.35 * np.cos(angles)).tolist(), (0.25 * np.sin(angles)).tolist(), strict=True))
    uneven(rng, p)
    if rng.random() < 0.5:
        p.roller_arrangement, p.roller_seed = 1, int(rng.integers(2**31))
        p.roller_rows, p.roller_per_row = int(rng.integers(1, 4)), int(rng.integers(20, 40))
        p.roller_friction_scatter = rng.uniform(0.0, 0.9)
        p.roller_radius_dip = rng.uniform(0.0, 0.8) * p.wheel_radius * (1.0 - math.cos(Reference(p).pitch / 2.0))
        p.roller_phase = rng.uniform(-0.5, 0.5, 3).tolist()
    return p


def uneven(rng: np.random.Generator, p: Parameters) -> None:
    """What differs from wheel to wheel, a centre of mass beside the wheels' centre, a floor that falls."""
    p.roller_friction_scale = rng.uniform(0.5, 1.5, 3).tolist()
    p.drivetrain_friction_scale = rng.uniform(0.5, 1.5, 3).tolist()
    p.base_com_x, p.base_com_y = rng.uniform(-0.05, 0.05, 2)
    p.floor_slope, p.floor_azimuth = rng.uniform(0.0, 0.1), rng.uniform(-math.pi, math.pi)
    p.imu_x, p.imu_y, p.imu_azimuth = rng.uniform(-0.3, 0.3, 3) * (1.0, 1.0, 10.0)


def state(rng: np.random.Generator, r: Reference) -> tuple[np.ndarray, Inputs, Modes]:
    p = r.p
    modes = Modes(rng.integers(-1, 2, 3).tolist(), *rng.integers(0, 2, 7).tolist())
    # The latch is a mode of the idealised model only; only that has no end stop.
    modes.latched *= int(r.ideal)
    modes.end_stop *= int(p.bumper_kind != KIND_NONE and not r.ideal)
    modes.bottom_stop *= int(p.bumper_kind != KIND_NONE)
    modes.walled *= int(p.wall_present and p.slider_present)
    x = np.zeros(STATES)
    x[2] = rng.uniform(-10.0, 10.0)
    x[3:5] = rng.normal(0.0, 0.3, 2)
    x[5] = rng.normal(0.0, 2.0)
    x[12:15] = rng.uniform(-20.0, 20.0, 3)
    if p.roller_arrangement:
        modes.roller = np.round((x[12:15] + p.roller_phase) / r.pitch).astype(int).tolist()
    x[6:9] = x[12:15] + rng.normal(0.0, 0.01, 3)
    x[9:12] = np.where(np.array(modes.gear) == 0, 0.0, rng.normal(0.0, 3.0, 3))
    level = p.roller_coulomb_torque / p.roller_radius / np.array(p.roller_presliding_stiffness)
    x[15:18] = level * rng.uniform(-1.2, 1.2, 3)
    if rng.random() < 0.3:  # near rest: within the bristle's elastic range
        x[3:6] *= 1e-3
    if p.slider_present:
        x[18], x[19] = rng.uniform(-0.1, 0.3), rng.normal(0.0, 0.5)
        if p.rope_attached:
            x[20], x[21] = x[18] + rng.normal(0.0, 3e-3), x[19] + rng.normal(0.0, 0.05)
        if not r.plate_locked(modes):
            x[22], x[23] = (
                rng.choice([rng.uniform(-2e-3, 2e-3), rng.uniform(0.0, 1.2 * p.bumper_travel)]),
                rng.normal(0.0, 0.5),
            )
    # Bring the robot to where the nose just touches it, from 5 mm short to 20 mm deep.
    depth = rng.uniform(-5e-3, 20e-3)
    nose_x, nose_y = r.nose(x)[0:2]
    _, _, _, _, out_x, out_y = r.plate(x)
    if r.on_robot:
        plate = np.array(r.plate(x)[0:2])
        away = p.contact_nose_radius - depth
        side = rng.normal(0.0, 0.1)
        wanted = np.array([nose_x - away * out_x - side * out_y, nose_y - away * out_y + side * out_x])
        x[0:2] += wanted - plate
    else:
        part = r.parts[rng.integers(len(r.parts))]
        k = rng.integers(len(part))
        corner, following = np.array(part[k]), np.array(part[(k + 1) % len(part)])
        along = following - corner
        normal = np.array([along[1], -along[0]]) / np.linalg.norm(along)
        if rng.random() < 0.4:  # a vertex: outside of it, in any direction between its edges' normals
            previous = corner - np.array(part[k - 1])
            other = np.array([previous[1], -previous[0]]) / np.linalg.norm(previous)
            share = rng.random()
            normal = share * normal + (1.0 - share) * other
            normal /= np.linalg.norm(normal)
            touch = corner
        else:
            touch = corner + rng.random() * along
        centre = touch + (p.contact_nose_radius - depth) * normal
        ct, st = math.cos(x[2]), math.sin(x[2])
        x[0] = nose_x - (ct * centre[0] - st * centre[1])
        x[1] = nose_y - (st * centre[0] + ct * centre[1])
    u = Inputs(
        tuple(rng.uniform(-30.0, 30.0, 3).tolist()),
        tuple(rng.normal(0.0, 30.0, 2).tolist()),
        tuple(rng.uniform(-0.3, 0.3, 2).tolist()),
    )
    return x, u, modes


def description(r: Reference, modes: Modes) -> str:
    p = r.p
    kind = {KIND_NONE: "none", KIND_MAGNETIC: "magnetic"}.get(p.bumper_kind, "spring")
    latch = "idealised" if p.bumper_latch_model == LATCH_IDEALISED else "continuous"
    mount = "robot" if p.bumper_mount == MOUNT_ROBOT else "slider"
    return (
        f"{kind} {latch} on {mount}, roller {p.roller_model}, traction {p.wheel_traction}, "
        f"slider {p.slider_present}, "
        f"rope {p.rope_attached}, {modes}"
    )
