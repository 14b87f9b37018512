// A design computed in this page: the nominal run of one collision, with the study's own settings and method.

import type { Engine, Run, Spec } from "../engine/engine";
import { SCENE_TRACES, type Motion } from "../parts/scene";
import { shape_of } from "../parts/shapes";
import { check_of } from "./check";
import type { Case, Study } from "./study_data";

const CURVES = [
  "testbed.truth.contact_force",
  "controller.estimate.force",
  "testbed.truth.bumper_compression",
  "testbed.truth.first_contact_time",
] as const;
const TRACES = [...new Set([...CURVES, ...SCENE_TRACES])];

export interface Computed {
  row: number;
  run: Run;
  motion: Motion;
  /** Time since the contact, or since the beginning if there is none, s. */
  time_s: Float64Array;
  /** Whether the metrics that the study judges have the bits that it has stored; undefined: it has stored none. */
  same: boolean | undefined;
}

/** What the engine is asked for the design of this row. */
export function spec_of(study: Study, one: Case, row: number): Spec {
  const { method, plant_step_s } = study.data.runs;
  return {
    step_s: one.step_s,
    step_count: one.step_count,
    settings: settings_of(one, row),
    ...(one.plan && { plan: one.plan }),
    ...(one.push && { push: one.push }),
    traces: TRACES,
    transient_limit_n: one.transient_limit_n,
    lasting_limit_n: one.lasting_limit_n,
    method,
    ...(method === "fixed-step" && plant_step_s !== null && { plant_step_s }),
  };
}

export function settings_of(one: Case, row: number): Record<string, number> {
  return { ...one.common, ...Object.fromEntries(one.differing.map(([name, values]) => [name, values[row] ?? NaN])) };
}

/** Computes it beside the page. */
export async function compute(engine: Engine, study: Study, case_index: number, row: number): Promise<Computed> {
  const one = study.cases[case_index] as Case;
  const refused = one.refused(row);
  if (refused) {
    throw new Error(refused);
  }
  const run = await engine.run(spec_of(study, one, row));
  const seconds = Float64Array.from({ length: one.step_count + 1 }, (_, k) => k * one.step_s);
  const first = run.traces["testbed.truth.first_contact_time"] as Float64Array;
  const contact = Math.max(first[first.length - 1] ?? 0, 0);
  const time_s = seconds.map((time) => time - contact);
  const title = `design ${study.number[row]}`;
  const robot = shape_of({ ...study.data.starts, ...settings_of(one, row) });
  const contact_s = Number.isNaN(run.metrics["contact time"] ?? NaN) ? NaN : 0;
  const detected_s = contact_s + (run.metrics["detection time"] ?? NaN) / 1000;
  const motion = { title, time_s, traces: run.traces, robot, contact_s, detected_s };
  return { row, run, motion, time_s, same: is_same(study, one, row, run) };
}

function is_same(study: Study, one: Case, row: number, run: Run): boolean | undefined {
  const stored = one.check(row) >>> 0;
  if (stored === 0) {
    return undefined;
  }
  const value = (name: string) =>
    name.endsWith(" (true)") ? run.truths[name.slice(0, -" (true)".length)] : run.metrics[name];
  return check_of(study.data.runs.checked.map((name) => value(name) ?? NaN)) === stored;
}
