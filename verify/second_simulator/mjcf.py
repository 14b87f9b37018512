"""The robot, the floor and the slider as a MuJoCo model, from the testbed's parameters alone.

Every roller is a body on a hinge. What the robot file does not say is assumed here:

- A roller (`roller.rows`, `roller.per_row`, `roller.row_distance`) is an ellipsoid that touches the circle of the wheel
  in its middle, and is `roller.radius_dip` within it where the next row takes over. Its friction is its own
  (`roller.friction_scatter`, drawn from `roller.seed`).
- Its friction is that of a joint in MuJoCo, which sticks or slips. How strong it is: `file`, as the testbed's, (28) and
  stiction below `roller.stribeck_speed`, set anew twice a millisecond; `coulomb`, `roller.coulomb_torque` whatever the
  speed. The robot file gives it for a wheel: two rollers that both bear share it as they share the load. With `each`
  they do not, and have all of it.
- Presliding: the cage of a wheel's rollers hangs on the hub by a spring along the axle
  (`roller.presliding_stiffness`, `roller.presliding_damping`), so that stuck rollers yield as the bristles of the
  testbed do before they slip.
- A wheel is a disc of its inertia, which gives its mass; the base is less by three of them. The rollers' mass is that
  of the hub.
- A wheel's vertical stiffness is that of its suspension for the most part. The roller's own contact is 20 times as
  stiff, so that a wheel stands on one roller, and on two for a few degrees around the hand-over.
- Contacts and stops are springs with linear dampers. Where the testbed has Hunt and Crossley's damper, the linear one
  is as strong at the force stated beside it.
- Friction that holds creeps in MuJoCo, here by less than a micrometre per second.

MuJoCo's constraints are not given by stiffness and damping but by a reference acceleration and a share of the inertia
that it estimates itself; `_contact` and
`_reference` turn the one into the other, exactly for a constraint at rest.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import mujoco
import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["BUMPERS", "FRICTION", "GRAVITY_MPS2", "WHEELS", "SecondRobot", "build"]

WHEELS = 3
AZIMUTHS_RAD = tuple(2.0 * math.pi * wheel / WHEELS for wheel in range(WHEELS))
BUMPERS = ("none", "spring", "magnetic")
FRICTION = FILE, COULOMB, EACH = "file", "coulomb", "each"
GRAVITY_MPS2 = 9.81
TOP_M = 0.65  # of the body, above the floor
FAR_M = 100.0  # where the slider waits

SPECK_KG, SPECK_KGM2 = 1e-3, 1e-7  # of bodies whose mass counts elsewhere
GRIP_RATIO = 1e5  # how much harder the floor holds sideways than it bears
CONTACT_RESISTANCE = 2.0  # 1/kg: a contact's own inertia in MuJoCo, 0.5 kg
ROLLER_STIFFNESS, ROLLER_DAMPING = 20.0, 0.3  # of the wheel's vertical stiffness; of critical, for the wheel alone
STICK_RATE = 1000.0  # 1/s: how soon a stuck joint stops
STICK_SHARE = 0.9999  # MuJoCo's largest
STICK_INERTIA = 100.0  # times MuJoCo's estimate of a joint's inertia


@dataclass(frozen=True)
class SecondRobot:
    """A compiled model and where its parts are.

    Attributes:
        parameters: of the testbed, by name.
        rotor, wheel: per wheel, index of the joint's coordinate and of its speed.
        slider, plate: likewise; the plate is None without a bumper.
    """

    model: Any
    bumper: str
    parameters: Mapping[str, Any]
    rotor: tuple[NDArray[np.int64], NDArray[np.int64]]
    wheel: tuple[NDArray[np.int64], NDArray[np.int64]]
    suspension: NDArray[np.int64]
    slider: tuple[int, int]
    plate: tuple[int, int] | None
    base_body: int
    rail_body: int
    nose_geom: int
    body_geom: int
    floor_geom: int
    wheel_of_body: NDArray[np.int64]  # -1: of none
    friction: str
    xml: str = field(repr=False)

    @property
    def sag_m(self) -> float:
        """How deep the floor's springs are pressed at rest."""
        p = self.parameters
        return float(p["base.mass"]) * GRAVITY_MPS2 / (WHEELS * float(p["wheel.floor_stiffness"]))


def build(parameters: Mapping[str, Any], bumper: str, step_s: float, friction: str = FILE) -> SecondRobot:
    """The model with ``bumper`` ("none", "spring" or "magnetic") on the slider."""
    xml = _xml(parameters, bumper, step_s)
    model = mujoco.MjModel.from_xml_string(xml)
    names = [f"rotor{wheel}" for wheel in range(WHEELS)], [f"wheel{wheel}" for wheel in range(WHEELS)]
    joints = [[model.joint(name) for name in group] for group in names]
    rotor, wheel = (
        (np.array([j.qposadr[0] for j in group]), np.array([j.dofadr[0] for j in group])) for group in joints
    )
    slider = model.joint("slider")
    plate = model.joint("plate") if bumper != "none" else None
    robot = SecondRobot(
        model=model,
        bumper=bumper,
        parameters=dict(parameters),
        rotor=rotor,
        wheel=wheel,
        suspension=np.array([model.joint(f"suspension{wheel}").qposadr[0] for wheel in range(WHEELS)]),
        slider=(int(slider.qposadr[0]), int(slider.dofadr[0])),
        plate=None if plate is None else (int(plate.qposadr[0]), int(plate.dofadr[0])),
        base_body=model.body("base").id,
        rail_body=model.body("rail").id,
        nose_geom=model.geom("nose").id,
        body_geom=model.geom("body").id,
        floor_geom=model.geom("floor").id,
        wheel_of_body=np.array([_wheel_of(model.body(i).name) for i in range(model.nbody)]),
        friction=friction,
        xml=xml,
    )
    _harden(robot)
    return robot


def _outline(p: Mapping[str, Any]) -> list[tuple[float, float]]:
    return [(p[f"outline.x[{i}]"], p[f"outline.y[{i}]"]) for i in range(int(p["outline.count"]))]


def rollers(p: Mapping[str, Any]) -> int:
    """Of a wheel."""
    return int(p["roller.rows"]) * int(p["roller.per_row"])


def roller_half_length_m(p: Mapping[str, Any]) -> float:
    """Of the ellipsoid that has the wheel's radius in its middle, and the dip where the next row takes over."""
    turn, roller = math.pi / rollers(p), p["roller.radius"]
    reach = p["wheel.radius"] - p["roller.radius_dip"] - (p["wheel.radius"] - roller) * math.cos(turn)
    return math.sqrt(reach**2 - (roller * math.cos(turn)) ** 2) / math.sin(turn)


def _xml(p: Mapping[str, Any], bumper: str, step_s: float) -> str:
    corners = " ".join(f"{x:.17g} {y:.17g} {z:.17g}" for x, y in _outline(p) for z in (p["outline.clearance"], TOP_M))
    spring = p["drivetrain.stiffness"]
    tendons = "\n".join(
        f'<fixed name="twist{i}" stiffness="{spring:.17g}" damping="{p["drivetrain.damping"]:.17g}" springlength="0">'
        f'<joint joint="rotor{i}" coef="1"/><joint joint="wheel{i}" coef="-1"/></fixed>'
        for i in range(WHEELS)
    )
    imu = f"{math.cos(0.5 * p['imu.azimuth']):.17g} 0 0 {math.sin(0.5 * p['imu.azimuth']):.17g}"
    wheels = "\n".join(_wheel(p, wheel) for wheel in range(WHEELS))
    wheel_kg, (tilt, yaw) = wheel_mass_kg(p), _body_inertia(p)
    mass = p["base.mass"] - WHEELS * wheel_kg
    # The wheels' mass is lower than the rest of the base's.
    height = (p["base.mass"] * p["base.com_height"] - WHEELS * wheel_kg * p["wheel.radius"]) / mass
    return f"""<mujoco model="second simulator">
<option timestep="{step_s:.17g}" integrator="implicitfast" cone="elliptic" impratio="{GRIP_RATIO:.17g}"
  gravity="0 0 {-GRAVITY_MPS2:.17g}" iterations="50" tolerance="1e-10"/>
<asset><mesh name="prism" vertex="{corners}"/></asset>
<worldbody>
<geom name="floor" type="plane" size="50 50 1" contype="1" conaffinity="0" priority="1"
  friction="{p["wheel.grip_friction"]:.17g} 0 0" condim="3"/>
<body name="base"><freejoint name="base"/>
<inertial pos="0 0 {height:.17g}" mass="{mass:.17g}" diaginertia="{tilt:.17g} {tilt:.17g} {yaw:.17g}"/>
<geom name="body" type="mesh" mesh="prism" mass="0" contype="2" conaffinity="0" priority="1" condim="1"/>
<site name="imu" pos="{p["imu.x"]:.17g} {p["imu.y"]:.17g} {p["imu.height"]:.17g}" quat="{imu}"/>
{wheels}
</body>
<body name="rail" pos="{FAR_M} 0 {p["contact.height"]:.17g}">{_slider(p, bumper)}</body>
</worldbody>
<tendon>
{tendons}
</tendon>
<sensor><accelerometer name="acceleration" site="imu"/><gyro name="rate" site="imu"/></sensor>
</mujoco>"""


def wheel_mass_kg(p: Mapping[str, Any]) -> float:
    """Of a disc with the wheel's inertia."""
    return float(2.0 * p["wheel.inertia"] / p["wheel.radius"] ** 2)


def _body_inertia(p: Mapping[str, Any]) -> tuple[float, float]:
    """Tilt and yaw inertia of the base without its wheels, about its own centre of mass."""
    wheel_kg, distance = wheel_mass_kg(p), p["wheel.distance"]
    mass = p["base.mass"] - WHEELS * wheel_kg
    below = p["base.com_height"] - p["wheel.radius"]
    yaw = p["base.yaw_inertia"] - WHEELS * (wheel_kg * distance**2 + 0.5 * p["wheel.inertia"])
    # Discs about a horizontal axis: half of them stand across it, on the average of any axis.
    own = WHEELS * (0.75 * p["wheel.inertia"] + 0.5 * wheel_kg * distance**2 + wheel_kg * below**2)
    above = WHEELS * wheel_kg * below / mass
    return float(p["base.tilt_inertia"] - own - mass * above**2), float(yaw)


def _wheel(p: Mapping[str, Any], wheel: int) -> str:
    """Local x points outwards along the axle; a positive angle drives the base towards local y."""
    radius, roller, azimuth = p["wheel.radius"], p["roller.radius"], AZIMUTHS_RAD[wheel]
    centre, spin = radius - roller, p["wheel.inertia"]
    half = roller_half_length_m(p)
    bodies = []
    rows, per_row = int(p["roller.rows"]), int(p["roller.per_row"])
    scatter = np.random.default_rng((int(p["roller.seed"]), wheel)).uniform(-1.0, 1.0, (rows, per_row))
    for row in range(rows):
        for number in range(per_row):
            angle = 2.0 * math.pi * (number + row / rows) / per_row - 0.5 * math.pi
            friction = p["roller.coulomb_torque"] * (1.0 + p["roller.friction_scatter"] * scatter[row, number])
            c, s = math.cos(angle), math.sin(angle)
            name = f"{wheel}_{row}_{number}"
            bodies.append(
                f'<body name="roller{name}" pos="{row_place_m(p, row):.17g} {centre * c:.17g} '
                f'{centre * s:.17g}" zaxis="0 {-s:.17g} {c:.17g}">'
                f'<inertial pos="0 0 0" mass="{SPECK_KG}" diaginertia="{_three(p["roller.inertia"])}"/>'
                f'<joint name="roller{name}" type="hinge" axis="0 0 1" '
                f'frictionloss="{friction:.17g}"/>'
                f'<geom type="ellipsoid" size="{roller:.17g} {roller:.17g} {half:.17g}" mass="0" contype="0" '
                f'conaffinity="1"/></body>'
            )
    inertia = spin - rollers(p) * SPECK_KG * centre**2
    hub_kg = wheel_mass_kg(p) - rollers(p) * SPECK_KG
    load_n = p["base.mass"] * GRAVITY_MPS2 / WHEELS
    suspension = p["wheel.floor_stiffness"] / (1.0 - 1.0 / ROLLER_STIFFNESS)
    place = (
        f"{p['wheel.distance'] * math.cos(azimuth):.17g} {p['wheel.distance'] * math.sin(azimuth):.17g} {radius:.17g}"
    )
    turned = f"{math.cos(0.5 * azimuth):.17g} 0 0 {math.sin(0.5 * azimuth):.17g}"
    friction = p["drivetrain.gear_coulomb"]
    return (
        f'<body name="rotor{wheel}" pos="{place}" quat="{turned}">'
        f'<inertial pos="0 0 0" mass="{SPECK_KG}" diaginertia="{_three(SPECK_KGM2)}"/>'
        f'<joint name="rotor{wheel}" type="hinge" axis="-1 0 0" armature="{p["drivetrain.motor_inertia"]:.17g}" '
        f'frictionloss="{friction:.17g}" damping="{p["drivetrain.gear_viscous"]:.17g}"/></body>\n'
        f'<body name="hub{wheel}" pos="{place}" quat="{turned}">'
        f'<joint name="suspension{wheel}" type="slide" axis="0 0 1" stiffness="{suspension:.17g}" '
        f'damping="{p["wheel.floor_damping"] * load_n:.17g}"/>'
        f'<inertial pos="0 0 0" mass="{hub_kg:.17g}" diaginertia="{inertia:.17g} {0.5 * spin:.17g} {0.5 * spin:.17g}"/>'
        f'<joint name="wheel{wheel}" type="hinge" axis="-1 0 0"/>\n'
        f'<body name="cage{wheel}"><inertial pos="0 0 0" mass="{SPECK_KG}" diaginertia="{_three(SPECK_KGM2)}"/>'
        f'<joint name="cage{wheel}" type="slide" axis="1 0 0" '
        f'stiffness="{p[f"roller.presliding_stiffness[{wheel}]"]:.17g}" '
        f'damping="{p["roller.presliding_damping"]:.17g}"/>\n' + "\n".join(bodies) + "</body></body>"
    )


def row_place_m(p: Mapping[str, Any], row: float) -> float:
    """Of a row, outwards along the axle from the wheel's middle."""
    return float((row - 0.5 * (p["roller.rows"] - 1)) * p["roller.row_distance"])


def _slider(p: Mapping[str, Any], bumper: str) -> str:
    """It slides along local x; its nose's tip is at the rail's origin at travel 0 with the bumper extended."""
    radius = p["contact.nose_radius"]
    mass = p["slider.mass"] - (0.0 if bumper == "none" else p["bumper.plate_mass"])
    nose = (
        f'<geom name="nose" type="sphere" pos="{-radius:.17g} 0 0" size="{radius:.17g}" mass="0" contype="0" '
        f'conaffinity="2" condim="1"/>'
    )
    if bumper == "none":
        inner = nose
    else:
        rate, preload = p["bumper.spring_rate"], p["bumper.preload"]
        inner = (
            f'<body name="plate"><inertial pos="0 0 0" mass="{p["bumper.plate_mass"]:.17g}" '
            f'diaginertia="{_three(SPECK_KGM2)}"/>'
            f'<joint name="plate" type="slide" axis="-1 0 0" '
            f'stiffness="{rate:.17g}" springref="{-preload / rate:.17g}" '
            f'damping="{p["bumper.damping"]:.17g}" frictionloss="{p["bumper.guide_friction"]:.17g}" limited="true" '
            f'range="0 {p["bumper.travel"]:.17g}"/>{nose}</body>'
        )
    return (
        f'<body name="slider"><inertial pos="0 0 0" mass="{mass:.17g}" diaginertia="{_three(SPECK_KGM2)}"/>'
        f'<joint name="slider" type="slide" axis="1 0 0" frictionloss="{p["slider.friction"]:.17g}" '
        f'damping="{p["slider.damping"]:.17g}"/>{inner}</body>'
    )


def _wheel_of(body: str) -> int:
    return int(body.removeprefix("roller").split("_")[0]) if body.startswith("roller") else -1


def _three(value: float) -> str:
    return " ".join([f"{value:.17g}"] * 3)


def _harden(robot: SecondRobot) -> None:
    """Stiffness and damping of contacts and stops, and friction that holds, in MuJoCo's terms."""
    model, p = robot.model, robot.parameters
    stiffness = ROLLER_STIFFNESS * p["wheel.floor_stiffness"]
    damping = 2.0 * ROLLER_DAMPING * math.sqrt(stiffness * wheel_mass_kg(p))
    _contact(model, "floor", model.body("roller0_0_0").id, stiffness, damping)
    # The cover's loss over a whole hit is the same: restitution 1 - 2/3 c v of Hunt and Crossley's law, at 0.5 m/s, for
    # the mass of slider and base.
    mass = 1.0 / (1.0 / p["slider.mass"] + 1.0 / p["base.mass"])
    restitution = 1.0 - 2.0 / 3.0 * p["contact.damping"] * 0.5
    log = -math.log(restitution) / math.pi
    damping = 2.0 * log / math.hypot(1.0, log) * math.sqrt(p["contact.stiffness"] * mass)
    _contact(
        model, "body", model.body("slider" if robot.plate is None else "plate").id, p["contact.stiffness"], damping
    )
    if robot.plate is not None:
        joint = model.joint("plate").id
        mass = p["bumper.plate_mass"]
        stiffness = p["bumper.stop_stiffness"]
        held_n = p["bumper.preload"] + (p["bumper.latch_force"] if robot.bumper == "magnetic" else 0.0)
        impedance = 0.5
        inverse = float(model.dof_invweight0[robot.plate[1]]) / STICK_INERTIA  # as it is left below
        resistance = (1.0 - impedance) / impedance * inverse
        model.jnt_solref[joint] = _reference(stiffness, p["bumper.stop_damping"] * held_n, resistance, impedance)
        model.jnt_solimp[joint] = impedance, impedance, 1.0, 0.5, 1.0
    for joint in range(model.njnt):
        dof = int(model.jnt_dofadr[joint])
        if model.dof_frictionloss[dof] > 0.0:
            model.dof_invweight0[dof] /= STICK_INERTIA
            model.dof_solref[dof] = 0.0, -STICK_RATE * STICK_SHARE  # MuJoCo divides by the share
            model.dof_solimp[dof] = STICK_SHARE, STICK_SHARE, 1.0, 0.5, 1.0


def _contact(model: Any, geom: str, other_body: int, stiffness: float, damping: float) -> None:
    """Stiffness and damping of the contact between ``geom``, which has priority, and a geom of ``other_body``."""
    number = model.geom(geom).id
    inverse = float(model.body_invweight0[other_body, 0] + model.body_invweight0[int(model.geom_bodyid[number]), 0])
    impedance = inverse / (inverse + CONTACT_RESISTANCE)
    model.geom_solref[number] = _reference(stiffness, damping, CONTACT_RESISTANCE, impedance)
    model.geom_solimp[number] = impedance, impedance, 1.0, 0.5, 1.0


def _reference(stiffness: float, damping: float, resistance: float, impedance: float) -> tuple[float, float]:
    """MuJoCo's solref for a spring (N/m) and damper (N s/m).

    force = (reference acceleration - acceleration) / resistance; MuJoCo divides both numbers by the impedance.
    """
    return -stiffness * resistance * impedance, -damping * resistance * impedance
