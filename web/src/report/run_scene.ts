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
  /** On the axis of `time`; null: it did not happen. */
  contact: number | null;
  detected: number | null;
}

export function motion_of({ label, time, traces, robot, contact, detected }: SceneData): Motion {
  return { title: label, time_s: time, traces, robot, contact_s: contact ?? NaN, detected_s: detected ?? NaN };
}
