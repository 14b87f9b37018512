// What a run shows: curves, numbers and the scene.
import type { Library } from "../../giveway_batch.js";
import type { Panel, Series, Tone } from "../parts/curves";
import type { Run, Spec } from "../engine/engine";
import { SCENE_TRACES, type Motion } from "../parts/scene";
import { shape_of } from "../parts/shapes";
import type { Complete } from "./design";

export const STEP_S = 0.001;
const WHEELS = [0, 1, 2] as const;
const FORCE = "testbed.truth.contact_force";
const TRACES = [
  ...SCENE_TRACES, FORCE, "controller.estimate.force", "testbed.truth.vx", "testbed.truth.vy", "testbed.truth.omega",
  ...WHEELS.map((wheel) => `testbed.sensor.torque[${wheel}]`),
];
const [PUSHED_N, SHOWN_DIRECTIONS_N] = [2, 2];

export function spec_of({ design, sent, region }: Complete): Spec {
  const limits = region ? { transient_limit_n: region.transient_n, lasting_limit_n: region.lasting_n } : {};
  return { step_s: STEP_S, step_count: Math.round(design.duration_s / STEP_S), settings: sent, traces: TRACES, ...limits };
}

export interface Shown {
  complete: Complete;
  run: Run;
  motion: Motion;
  /** For all its curves, ms. */
  time_ms: Float64Array;
}

export function shown_of(complete: Complete, run: Run, title: string): Shown {
  const count = run.traces[FORCE]?.length ?? 0;
  const time_s = Float64Array.from({ length: count }, (_, k) => k * STEP_S);
  const contact_s = run.metrics["contact time"] ?? NaN;
  const detected_s = contact_s + (run.metrics["detection time"] ?? NaN) / 1000;
  const motion = { title, time_s, traces: run.traces, robot: shape_of(complete.settings), contact_s, detected_s };
  return { complete, run, motion, time_ms: time_s.map((time) => 1000 * time) };
}

type Curve = (row: number, trace: (name: string) => number) => number;

function curve(shown: Shown, rows: number, of: Curve): Float64Array {
  const { traces } = shown.run;
  const found = new Float64Array(rows).fill(NaN);
  let row = 0;
  const trace = (name: string) => Number(traces[name]?.[row] ?? NaN);
  for (const last = Math.min(rows, shown.time_ms.length); row < last; row++) {
    found[row] = of(row, trace);
  }
  return found;
}

const degrees = (angle: number) => (180 / Math.PI) * (angle - 2 * Math.PI * Math.round(angle / (2 * Math.PI)));

const felt_force: Curve = (_, at) => at("controller.estimate.force");
const true_force: Curve = (_, at) => at(FORCE);
const largest_torque: Curve = (_, at) => Math.max(...WHEELS.map((wheel) => Math.abs(at(`testbed.sensor.torque[${wheel}]`))));
const true_direction: Curve = (_, at) =>
  at(FORCE) < SHOWN_DIRECTIONS_N
    ? NaN
    : degrees(Math.atan2(at("testbed.truth.contact_force_y"), at("testbed.truth.contact_force_x")) - at("testbed.truth.theta"));
const felt_direction: Curve = (_, at) =>
  at("controller.estimate.valid") ? degrees(Math.atan2(at("controller.estimate.force_y"), at("controller.estimate.force_x"))) : NaN;
const speed: Curve = (_, at) => Math.hypot(at("testbed.truth.vx"), at("testbed.truth.vy"));
const compression: Curve = (_, at) => 1000 * at("testbed.truth.bumper_compression");
const place_error: Curve = (_, at) => {
  if (!at("controller.estimate.valid") || at(FORCE) < PUSHED_N) return NaN;
  const [c, s] = [Math.cos(at("testbed.truth.theta")), Math.sin(at("testbed.truth.theta"))];
  const [x, y] = [at("controller.estimate.point_x"), at("controller.estimate.point_y")];
  const dx = at("testbed.truth.x") + c * x - s * y - at("testbed.truth.contact_point_x");
  const dy = at("testbed.truth.y") + s * x + c * y - at("testbed.truth.contact_point_y");
  return 1000 * Math.hypot(dx, dy);
};
const way: Curve = (_, at) => 1000 * Math.hypot(at("testbed.truth.x"), at("testbed.truth.y"));

/** The curves of one design, or of two. */
export function panels(all: readonly Shown[]): { x: Float64Array; panels: Panel[] } {
  const x = all.reduce<Float64Array>((longest, { time_ms }) => (time_ms.length > longest.length ? time_ms : longest), new Float64Array(0));
  const [first] = all;
  const both = all.length > 1;
  const tones: Tone[] = ["first", "second"];
  const name = (i: number) => (both ? `${"AB"[i]}: ` : "");
  const each = (label: string, of: Curve): Series[] =>
    all.map((shown, i) => ({ label: `${name(i)}${label}`, values: curve(shown, x.length, of), tone: tones[i] as Tone }));
  const against = (what: string, truth: Curve, felt: Curve): Series[] =>
    all.flatMap((shown, i): Series[] => [
      { label: `${name(i)}${what}, true`, values: curve(shown, x.length, truth), tone: both ? (tones[i] as Tone) : "truth" },
      { label: `${name(i)}estimated`, values: curve(shown, x.length, felt), tone: both ? (tones[i] as Tone) : "estimate", dash: true },
    ]);
  const marks = all.flatMap((shown, i) => {
    const { contact_s, detected_s } = shown.motion;
    const tone = both ? tones[i] : undefined;
    const found = [
      { label: `${name(i)}contact`, x: 1000 * contact_s, tone },
      { label: `${name(i)}noticed`, x: 1000 * detected_s, tone },
    ];
    return found.filter((mark) => !Number.isNaN(mark.x) && !(both && mark.label.endsWith("contact")));
  });
  const torques: Series[] = both || !first
    ? each("largest of three", largest_torque)
    : WHEELS.map((wheel): Series => ({
        label: `wheel ${wheel}`,
        values: curve(first, x.length, (_, at) => at(`testbed.sensor.torque[${wheel}]`)),
        tone: (["first", "second", "third"] as const)[wheel],
      }));
  return {
    x,
    panels: [
      { title: "Contact force", unit: "N", series: against("force", true_force, felt_force), limits: force_limits(all), marks },
      { title: "Wheel torque as measured", unit: "N.m", series: torques, limits: torque_limits(all) },
      { title: "Direction of the force on the robot", unit: "deg", free: true, series: against("direction", true_direction, felt_direction) },
      { title: "Error of the estimated place", unit: "mm", series: each("distance", place_error) },
      { title: "Bumper compression", unit: "mm", series: each("compression", compression), limits: travel_limits(all) },
      { title: "Speed of the robot", unit: "m/s", series: each("speed", speed), limits: speed_limits(all) },
      { title: "Way of the robot", unit: "mm", series: each("way", way) },
    ],
  };
}

type Limits = { label: string; value: number }[];

/** Each once, if both designs have the same. */
function distinct(limits: Limits): Limits {
  return limits.filter(({ label, value }, i) => limits.findIndex((other) => other.label === label && other.value === value) === i);
}

const force_limits = (all: readonly Shown[]): Limits =>
  distinct(all.flatMap(({ complete: { region } }) =>
    region ? [{ label: `${region.name}: ${region.transient_n} N, transient`, value: region.transient_n },
      { label: `${region.name}: ${region.lasting_n} N, lasting`, value: region.lasting_n }] : []));

const limit_of = (all: readonly Shown[], parameter: string, words: string, unit: string, factor = 1): Limits =>
  distinct(all.map(({ complete: { settings } }) => {
    const value = factor * Number(settings[parameter]);
    return { label: `${words}, ${Number(value.toPrecision(4))} ${unit}`, value };
  }));

const torque_limits = (all: readonly Shown[]): Limits =>
  limit_of(all, "testbed.electronics.torque_range", "the sensor's range", "N m");
const travel_limits = (all: readonly Shown[]): Limits =>
  limit_of(all.filter(({ complete }) => complete.settings["testbed.bumper.kind"] !== 0), "testbed.bumper.travel", "whole travel", "mm", 1000);
const speed_limits = (all: readonly Shown[]): Limits =>
  limit_of(all, "controller.admittance.speed_limit", "limit of the reaction", "m/s");

export interface Line {
  name: string;
  unit: string;
  decimals: number | null;
  description: string;
  values: number[];
  truths: number[];
}

const [OF_COLLISION, OF_DESIGN] = [1, 2];

/** The numbers of a collision, in the order in which tables have them. */
export function lines(library: Library, all: readonly Shown[]): Line[] {
  const judged = all.some(({ complete }) => complete.region);
  return library.metrics
    .filter(({ shown, name }) => (shown & OF_COLLISION) !== 0 || (shown & OF_DESIGN && (judged || !name.endsWith("share"))))
    .sort((one, other) => one.line - other.line)
    .map(({ name, unit, decimals, description }) => ({
      name, unit, decimals, description,
      values: all.map(({ run }) => run.metrics[name] ?? NaN),
      truths: all.map(({ run }) => run.truths[name] ?? NaN),
    }));
}
