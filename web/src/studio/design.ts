// A design: robot, preset, hit and every changed parameter; its whole settings, and its text in the address.
import type { Library } from "../../giveway_batch.js";
import { slider_of } from "./hit";
import { allowed, fits, type Region, type Tables, type Value, type Values, type Variable } from "./tables";

export interface Hit {
  /** Share of the way around the outline, from corner 0, in [0, 1). */
  around: number;
  /** From straight into the side, degrees, positive: turned to the left. */
  angle_deg: number;
  /** Of the slider at the contact, m/s. */
  speed_mps: number;
  /** Of the contact, s; with the rope it follows from the speed. */
  time_s: number;
}

export interface Design {
  robot: string;
  preset: "default" | "paper";
  duration_s: number;
  /** Whose limits judge the force; none. */
  region: string;
  hit: Hit;
  changes: Values;
}

/** What one knows of a design before it is computed. */
export interface Complete {
  design: Design;
  /** Every parameter. */
  settings: Values;
  /** Those that the batch library has otherwise. */
  sent: Values;
  region: Region | undefined;
}

interface Limit {
  low: number;
  high: number;
  unit: string;
}

export const HIT_LIMITS: Record<keyof Hit, Limit> = {
  around: { low: 0, high: 1, unit: "1" },
  angle_deg: { low: -75, high: 75, unit: "deg" },
  speed_mps: { low: 0.05, high: 2, unit: "m/s" },
  time_s: { low: 0.11, high: 1, unit: "s" },
};
export const DURATION: Limit = { low: 0.3, high: 8, unit: "s" };

export function start_design(tables: Tables): Design {
  return {
    robot: Object.keys(tables.robots)[0] ?? "",
    preset: "default",
    duration_s: 0.6,
    region: "",
    hit: { around: 1 / 6, angle_deg: 0, speed_mps: 0.5, time_s: 0.15 },
    changes: { "testbed.rope.attached": false },
  };
}

/** Parameters before the changes: start values, robot, preset. */
export function base_of(tables: Tables, design: Design): Values {
  const values: Values = {};
  for (const { name, start } of tables.variables) {
    values[name] = start;
  }
  Object.assign(values, tables.robots[design.robot]?.values);
  if (design.preset === "paper") {
    for (const { name, paper } of tables.variables) {
      if (paper !== null) values[name] = paper;
    }
  }
  return values;
}

/** Every parameter of a design; what is not possible throws. */
export function complete(tables: Tables, library: Library, design: Design): Complete {
  const values = { ...base_of(tables, design), ...design.changes };
  const settings = { ...values, ...slider_of(library, values, design.hit), ...design.changes };
  const sent: Values = {};
  for (const { name, start } of tables.variables) {
    const value = settings[name];
    if (value !== undefined && value !== start) sent[name] = value;
  }
  return { design, settings, sent, region: tables.regions.find(({ name }) => name === design.region) };
}

// The address: robot=trikey&around=0.1667&speed_mps=0.5&testbed.bumper.latch_force=40; the second design's keys begin with "b.".

const SECOND = "b.";

export function to_hash(tables: Tables, designs: readonly Design[]): string {
  const text = new URLSearchParams();
  designs.forEach((design, i) => {
    const before = i === 0 ? "" : SECOND;
    const start = start_design(tables);
    text.set(`${before}robot`, design.robot);
    if (design.preset !== start.preset) text.set(`${before}preset`, design.preset);
    if (design.region !== start.region) text.set(`${before}region`, design.region);
    text.set(`${before}duration_s`, String(design.duration_s));
    for (const key of Object.keys(HIT_LIMITS) as (keyof Hit)[]) text.set(`${before}${key}`, String(design.hit[key]));
    for (const [name, value] of Object.entries(design.changes)) text.set(`${before}${name}`, String(value));
  });
  return text.toString();
}

/** The designs of an address, and what in it could not be used. */
export function from_hash(tables: Tables, hash: string): { designs: Design[]; refused: string[] } {
  const text = new URLSearchParams(hash.replace(/^#/, ""));
  const refused: string[] = [];
  const variables = new Map(tables.variables.map((variable) => [variable.name, variable]));
  const designs: Design[] = [start_design(tables)];
  for (const [key, value] of text) {
    const second = key.startsWith(SECOND);
    if (second && designs.length === 1) designs.push(start_design(tables));
    const said = set_one(tables, variables, designs[second ? 1 : 0] as Design, second ? key.slice(2) : key, value);
    if (said) refused.push(`${key} = ${value} is not allowed: ${said}`);
  }
  return { designs, refused };
}

/** Why not, if it cannot be used. */
function set_one(tables: Tables, variables: Map<string, Variable>, design: Design, key: string, text: string): string {
  const number = text.trim() === "" ? NaN : Number(text);
  const between = ({ low, high, unit }: Limit) => (number >= low && number <= high ? "" : `a number from ${low} to ${high} ${unit}`);
  const one_of = (names: readonly string[]) => (names.includes(text) ? "" : names.filter(Boolean).join(", "));
  let said = "";
  if (key === "robot") {
    said = one_of(Object.keys(tables.robots));
    if (!said) design.robot = text;
  } else if (key === "preset") {
    said = one_of(["default", "paper"]);
    if (!said) design.preset = text as Design["preset"];
  } else if (key === "region") {
    said = one_of(["", ...tables.regions.map(({ name }) => name)]);
    if (!said) design.region = text;
  } else if (key === "duration_s") {
    said = between(DURATION);
    if (!said) design.duration_s = number;
  } else if (key in HIT_LIMITS) {
    said = between(HIT_LIMITS[key as keyof Hit]);
    if (!said) design.hit[key as keyof Hit] = number;
  } else {
    const variable = variables.get(key);
    const value: Value = variable?.type === "boolean" && (text === "true" || text === "false") ? text === "true" : number;
    if (!variable) return "a parameter of testbed or controller, or of the hit";
    if (!fits(variable, value)) return allowed(variable);
    design.changes[key] = value;
  }
  return said;
}

/** What was, and what was taken back. */
export class History<State> {
  private past: State[] = [];
  private future: State[] = [];

  constructor(private present: State) {}

  get now(): State {
    return this.present;
  }

  get can_undo(): boolean {
    return this.past.length > 0;
  }

  get can_redo(): boolean {
    return this.future.length > 0;
  }

  /** A new state; `first`: the one that changed it is over, else it goes on (a slider that is being dragged). */
  set(state: State, first: boolean): void {
    if (first) this.past.push(this.present);
    this.future = [];
    this.present = state;
  }

  undo(): void {
    const before = this.past.pop();
    if (before !== undefined) {
      this.future.push(this.present);
      this.present = before;
    }
  }

  redo(): void {
    const next = this.future.pop();
    if (next !== undefined) {
      this.past.push(this.present);
      this.present = next;
    }
  }
}
