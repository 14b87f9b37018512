// The motion of stored runs, as Python has sampled them (cosim/giveway/report/animation.py), for the view from above.

import type { Motion } from "../parts/scene";
import type { RobotShape } from "../parts/shapes";

export interface SceneData {
  label: string;
  /** Since the contact or the first push, s. */
  time: number[];
  /** By full name; what `SCENE_TRACES` says. */
  traces: Record<string, number[]>;
  robot: RobotShape;
}

export function motion_of({ label, time, traces, robot }: SceneData): Motion {
  return { title: label, time_s: time, traces, robot };
}
