// What Python has put into the page of a study (cosim/giveway/study/page_data.py), as typed columns.

import { unpacked } from "../parts/page";

export interface Limit {
  at: number;
  words: string;
}

interface StoredTexts {
  texts: string[];
  codes: number;
}

interface StoredColumn {
  label: string;
  unit: string;
  scale: number;
  role: "quantity" | "objective" | "constraint" | "shown";
  kind: "real" | "integer" | "boolean" | "choice";
  choices: string[];
  log: boolean;
  sense: -1 | 0 | 1;
  limits: Limit[];
  values: number;
}

interface StoredCase {
  name: string;
  step_s: number;
  step_count: number;
  transient_limit_n: number;
  lasting_limit_n: number;
  plan: number | null;
  push: number | null;
  common: Record<string, number>;
  differing: Record<string, number>;
  refused: StoredTexts | null;
  checks: string | null;
}

export interface Shown {
  unit: string;
  scale: number;
  limits: Limit[];
}

export interface StudyData {
  name: string;
  total: number;
  count: number;
  designs: string;
  flags: string;
  rank: string;
  columns: StoredColumn[];
  warnings: StoredTexts;
  reasons: StoredTexts;
  chosen: number | null;
  /** The best ranked, that one first. */
  best: number[];
  chosen_words: string;
  runs: {
    method: "event-exact" | "fixed-step";
    plant_step_s: number | null;
    checked: string[];
    cases: StoredCase[];
  };
  /** Of the parameters that shapes are drawn from. */
  starts: Record<string, number>;
  force: Shown;
  time: Shown;
  arrays: (string | { levels: string; codes: string })[];
}

export const FEASIBLE = 1;
export const FRONT = 2;
export const KNOWN = 4;

/** A quantity or a goal of all designs, in the unit that the user wrote. */
export interface Column {
  index: number;
  label: string;
  unit: string;
  role: StoredColumn["role"];
  kind: StoredColumn["kind"];
  choices: string[];
  log: boolean;
  sense: -1 | 0 | 1;
  limits: Limit[];
  values: Float64Array;
  /** Ends of the finite values, and of the limits near them. */
  low: number;
  high: number;
  /** Limits beyond those ends. */
  far: Limit[];
}

export interface Case {
  name: string;
  step_s: number;
  step_count: number;
  transient_limit_n: number;
  lasting_limit_n: number;
  plan: Float64Array | undefined;
  push: Float64Array | undefined;
  common: Record<string, number>;
  differing: [string, Float64Array][];
  refused: (row: number) => string;
  /** Of the stored run; 0: none. */
  check: (row: number) => number;
}

/** All designs of the page; a row is a design, which has its number in the study. */
export class Study {
  readonly count: number;
  readonly number: Int32Array;
  readonly flags: Uint8Array;
  /** Place in the ranking, from 0 on; -1: none. */
  readonly rank: Int32Array;
  readonly columns: Column[];
  readonly cases: Case[];
  readonly warning: (row: number) => string;
  readonly reason: (row: number) => string;
  readonly has_warnings: boolean;
  /** Row of the design beside which others are shown; -1: none. */
  readonly chosen: number;
  private readonly _arrays: (Float64Array | undefined)[];

  constructor(readonly data: StudyData) {
    this._arrays = data.arrays.map(() => undefined);
    this.number = unpacked(data.designs) as Int32Array;
    this.flags = unpacked(data.flags) as Uint8Array;
    this.rank = unpacked(data.rank) as Int32Array;
    this.count = this.number.length;
    this.columns = data.columns.map((stored, index) => this._column(stored, index));
    this.cases = data.runs.cases.map((stored) => this._case(stored));
    this.warning = this._texts(data.warnings);
    this.reason = this._texts(data.reasons);
    this.has_warnings = data.warnings.texts.some((text) => text !== "");
    this.chosen = data.chosen === null ? -1 : this.row_of(data.chosen);
  }

  /** Row of the design with this number; -1: it is not in the page. */
  row_of(number: number): number {
    return this.number.indexOf(number);
  }

  /** What of the design is shown first: objectives, two of them if possible. */
  first_pair(): [number, number] {
    const order = ["objective", "constraint", "quantity", "shown"];
    const real = this.columns.filter((column) => column.low < column.high);
    const from = real.length > 1 ? real : this.columns;
    const sorted = [...from].sort((a, b) => order.indexOf(a.role) - order.indexOf(b.role));
    return [sorted[0]?.index ?? 0, sorted[1]?.index ?? 0];
  }

  private _array(index: number): Float64Array {
    const found = this._arrays[index] ?? decoded(this.data.arrays[index] ?? "f8:");
    this._arrays[index] = found;
    return found;
  }

  private _column(stored: StoredColumn, index: number): Column {
    const own = this._array(stored.values);
    const values = stored.scale === 1 ? own : own.map((value) => in_unit(value, stored.scale));
    return { ...stored, index, values, ...range_of(values, stored) };
  }

  private _texts(stored: StoredTexts | null): (row: number) => string {
    if (stored === null) {
      return () => "";
    }
    const codes = this._array(stored.codes);
    return (row) => stored.texts[codes[row] ?? 0] ?? "";
  }

  private _case(stored: StoredCase): Case {
    const checks = stored.checks === null ? null : (unpacked(stored.checks) as Int32Array);
    return {
      ...stored,
      plan: stored.plan === null ? undefined : this._array(stored.plan),
      push: stored.push === null ? undefined : this._array(stored.push),
      differing: Object.entries(stored.differing).map(([name, index]) => [name, this._array(index)]),
      refused: this._texts(stored.refused),
      check: (row) => checks?.[row] ?? 0,
    };
  }
}

function decoded(stored: string | { levels: string; codes: string }): Float64Array {
  if (typeof stored === "string") {
    return unpacked(stored) as Float64Array;
  }
  const levels = unpacked(stored.levels) as Float64Array;
  return Float64Array.from(unpacked(stored.codes), (code) => levels[code] ?? NaN);
}

/** As Python shows it: 15 digits, so that a value there and back is what was written. */
export function in_unit(value: number, scale: number): number {
  return scale === 1 || !Number.isFinite(value) ? value / scale : Number((value / scale).toPrecision(15));
}

function range_of(values: Float64Array, stored: StoredColumn): { low: number; high: number; far: Limit[] } {
  let [low, high] = [Infinity, -Infinity];
  for (const value of values) {
    if (Number.isFinite(value)) {
      low = Math.min(low, value);
      high = Math.max(high, value);
    }
  }
  if (low > high) {
    [low, high] = [0, 1];
  }
  const reach = high - low;
  const near = stored.limits.filter(({ at }) => at >= low - reach && at <= high + reach);
  const far = stored.limits.filter((limit) => !near.includes(limit));
  low = Math.min(low, ...near.map(({ at }) => at));
  high = Math.max(high, ...near.map(({ at }) => at));
  return { low, high, far };
}

/** A number with four digits, as the tables of Python have it; "-": it did not happen. */
export function number_text(value: number): string {
  if (Number.isNaN(value)) {
    return "-";
  }
  const exponent = value === 0 || !Number.isFinite(value) ? 0 : Math.floor(Math.log10(Math.abs(value)));
  return exponent >= -5 && exponent < 15 ? String(Number(value.toPrecision(4))) : value.toExponential(3);
}

/** What the design of this row has in a column. */
export function cell_text(column: Column, row: number): string {
  const value = column.values[row] ?? NaN;
  if (column.kind === "choice") {
    return column.choices[value] ?? "-";
  }
  if (column.kind === "boolean") {
    return value ? "true" : "false";
  }
  return column.kind === "integer" ? String(value) : number_text(value);
}

/** "detection time (ms)" */
export function titled(column: { label: string; unit: string }): string {
  return column.unit ? `${column.label} (${column.unit})` : column.label;
}
