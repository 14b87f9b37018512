// From a hit at a point of the outline to the slider's parameters, as giveway/scenario/approach.py has it for a robot at rest.
import type { Library } from "../../giveway_batch.js";
import { outline_of, type Point, type Settings } from "../parts/shapes";
import type { Hit } from "./design";
import type { Values } from "./tables";

const GAP_M = 0.01; // between a bumper on the robot, bottomed, and the outline

/** A point of the outline and its side's outward normal; `around` is a share of the whole way. */
export function point_of(outline: readonly Point[], around: number): { point: Point; normal: Point } {
  const sides = outline.map((start, i) => {
    const end = outline[(i + 1) % outline.length] as Point;
    const along: Point = [end[0] - start[0], end[1] - start[1]];
    return { start, along, length: Math.hypot(...along) };
  });
  const whole = sides.reduce((sum, { length }) => sum + length, 0);
  let rest = (((around % 1) + 1) % 1) * whole;
  const side = sides.find(({ length }) => (rest < length ? true : ((rest -= length), false))) ?? (sides[0] as (typeof sides)[0]);
  const share = Math.min(1, rest / side.length);
  return {
    point: [side.start[0] + share * side.along[0], side.start[1] + share * side.along[1]],
    normal: [side.along[1] / side.length, -side.along[0] / side.length],
  };
}

/** The share of the way around that is nearest to a point of the base frame. */
export function nearest(outline: readonly Point[], to: Point): number {
  let [best, found, before] = [Infinity, 0, 0];
  const lengths = outline.map((start, i) => {
    const end = outline[(i + 1) % outline.length] as Point;
    return Math.hypot(end[0] - start[0], end[1] - start[1]);
  });
  outline.forEach((start, i) => {
    const end = outline[(i + 1) % outline.length] as Point;
    const length = lengths[i] as number;
    const [ax, ay] = [(end[0] - start[0]) / length, (end[1] - start[1]) / length];
    // Not at a corner itself, which belongs to two sides.
    const margin = Math.min(0.002, length / 4);
    const along = Math.min(length - margin, Math.max(margin, (to[0] - start[0]) * ax + (to[1] - start[1]) * ay));
    const distance = Math.hypot(start[0] + along * ax - to[0], start[1] + along * ay - to[1]);
    if (distance < best) [best, found] = [distance, before + along];
    before += length;
  });
  return found / before;
}

/** `slider.*`, and of a bumper on the robot its place, for a hit of the resting robot. */
export function slider_of(library: Library, settings: Settings, hit: Hit): Values {
  const of = (name: string) => Number(settings[`testbed.${name}`]);
  const { point, normal } = point_of(outline_of(settings), hit.around);
  const mounted = of("bumper.kind") !== 0 && of("bumper.mount") === 1;
  const front = mounted ? of("bumper.travel") + GAP_M : 0;
  const touch: Point = [point[0] + front * normal[0], point[1] + front * normal[1]];
  const [c, s] = [Math.cos(of("start.theta")), Math.sin(of("start.theta"))];
  const turned = ([x, y]: Point): Point => [c * x - s * y, s * x + c * y];
  const [out, arm] = [turned(normal), turned(touch)];
  const direction = Math.atan2(-out[1], -out[0]) + (hit.angle_deg * Math.PI) / 180;
  const along: Point = [Math.cos(direction), Math.sin(direction)];
  const radius = of("contact.nose_radius");
  const rope = settings["testbed.rope.attached"] === true;
  const found = library.run_up({
    end_speed_mps: hit.speed_mps, duration_s: rope ? 0 : hit.time_s, rope_attached: rope,
    slider_mass: of("slider.mass"), slider_friction: of("slider.friction"), slider_friction_speed: of("slider.friction_speed"),
    slider_damping: of("slider.damping"), rope_hanging_mass: of("rope.hanging_mass"), rope_stiffness: of("rope.stiffness"),
    rope_damping: of("rope.damping"), rope_drop_height: of("rope.drop_height"),
  });
  return {
    "testbed.slider.present": true,
    "testbed.slider.direction": direction - 2 * Math.PI * Math.round(direction / (2 * Math.PI)),
    "testbed.slider.target_x": of("start.x") + arm[0] + radius * (out[0] + along[0]),
    "testbed.slider.target_y": of("start.y") + arm[1] + radius * (out[1] + along[1]),
    "testbed.slider.run_up": found.travel_m,
    "testbed.slider.speed": found.start_speed_mps,
    ...(mounted
      ? { "testbed.bumper.mount_x": touch[0], "testbed.bumper.mount_y": touch[1], "testbed.bumper.mount_azimuth": Math.atan2(normal[1], normal[0]) }
      : {}),
  };
}
