// Shapes of robot, slider and bumper from above, from the testbed's parameters.

export type Settings = Readonly<Record<string, number | boolean>>;
export type Point = readonly [number, number];

export interface RobotShape {
  /** Corners, base frame, m. */
  outline: Point[];
  wheel: { radius: number; distance: number; width: number };
  /** What collides; none without a slider. */
  obstacle: Obstacle | null;
  /** A bumper on the robot. */
  plate: { ends: [Point, Point]; inward: Point; foot: Point } | null;
}

export interface Obstacle {
  /** Direction of travel, world frame. */
  rail: Point;
  radius: number;
  edge: boolean;
  sprung: boolean;
  /** From the tip of the nose to spring and body, m. */
  front: number;
  body: number;
}

const [EDGE_DEPTH, RIGID, CLOSED, PLATE] = [0.06, 0.1, 0.02, 0.2];

export function outline_of(settings: Settings): Point[] {
  const count = Number(settings["testbed.outline.count"]);
  const at = (axis: string, i: number) => Number(settings[`testbed.outline.${axis}[${i}]`]);
  return Array.from({ length: count }, (_, i): Point => [at("x", i), at("y", i)]);
}

/** All of it, from settings by full name ("testbed.wheel.radius"); every parameter of the testbed must be there. */
export function shape_of(settings: Settings): RobotShape {
  const of = (name: string) => Number(settings[`testbed.${name}`]);
  const outline = outline_of(settings);
  const mounted = of("bumper.kind") !== 0 && of("bumper.mount") === 1;
  const sprung = of("bumper.kind") !== 0 && !mounted;
  const edge = of("contact.nose_shape") === 1;
  const radius = of("contact.nose_radius");
  const front = edge ? EDGE_DEPTH : 2 * radius;
  const [angle, azimuth] = [of("slider.direction"), of("bumper.mount_azimuth")];
  const at: Point = [of("bumper.mount_x"), of("bumper.mount_y")];
  const inward: Point = [-Math.cos(azimuth), -Math.sin(azimuth)];
  const across: Point = [(PLATE / 2) * inward[1], (-PLATE / 2) * inward[0]];
  const deep = mounted ? depth(at, inward, outline) : 0;
  return {
    outline,
    wheel: { radius: of("wheel.radius"), distance: of("wheel.distance"), width: of("wheel.width") },
    obstacle: settings["testbed.slider.present"]
      ? {
          rail: [Math.cos(angle), Math.sin(angle)], radius, edge, sprung, front,
          body: front + (sprung ? CLOSED + of("bumper.travel") : RIGID),
        }
      : null,
    plate: mounted
      ? {
          ends: [[at[0] + across[0], at[1] + across[1]], [at[0] - across[0], at[1] - across[1]]],
          inward,
          foot: [at[0] + deep * inward[0], at[1] + deep * inward[1]],
        }
      : null,
  };
}

/** From a point outside along `inward` to the first side, m. */
function depth(from: Point, inward: Point, outline: Point[]): number {
  const found = outline.flatMap(([ax, ay], i) => {
    const [bx, by] = outline[(i + 1) % outline.length] as Point;
    const determinant = inward[0] * (ay - by) - inward[1] * (ax - bx);
    const [dx, dy] = [ax - from[0], ay - from[1]];
    const distance = (dx * (ay - by) - dy * (ax - bx)) / determinant;
    const share = (inward[0] * dy - inward[1] * dx) / determinant;
    return determinant !== 0 && distance >= 0 && share >= 0 && share <= 1 ? [distance] : [];
  });
  return found.length > 0 ? Math.min(...found) : Math.hypot(...from);
}
