// One axis: from values to pixels and back, and the numbers that stand at it.

import { number_text, type Column } from "./study_data";

export interface Axis {
  /** Pixel of a value. */
  at: (value: number) => number;
  value: (pixel: number) => number;
  ticks: { at: number; text: string }[];
}

/** An axis of `column` from pixel `start` to pixel `end`, with about one tick in `every` pixels. */
export function axis_of(column: Column, start: number, end: number, every: number): Axis {
  const log = column.log && column.low > 0;
  const map = log ? Math.log : (value: number) => value;
  const back = log ? Math.exp : (value: number) => value;
  const margin = column.low < column.high ? 0.03 * (map(column.high) - map(column.low)) : 0.5;
  const [low, high] = [map(column.low) - margin, map(column.high) + margin];
  const at = (value: number) => start + ((map(value) - low) / (high - low)) * (end - start);
  const value = (pixel: number) => back(low + ((pixel - start) / (end - start)) * (high - low));
  const most = Math.max(2, Math.floor(Math.abs(end - start) / every));
  const named = column.kind === "choice" || column.kind === "boolean";
  const values = named
    ? names_of(column, most)
    : log
      ? spread(column.low, column.high, most, back, map)
      : steps(column.low, column.high, most);
  const round = !log && column.high > column.low; // as `steps` makes them
  const text = (one: number) => (named ? name_of(column, one) : round ? String(one) : number_text(one));
  return { at, value, ticks: values.map((one) => ({ at: one, text: text(one) })) };
}

function name_of(column: Column, value: number): string {
  return column.kind === "choice" ? (column.choices[value] ?? "") : value ? "true" : "false";
}

function names_of(column: Column, most: number): number[] {
  const every = Math.max(1, Math.ceil((column.high - column.low + 1) / most));
  const found = [];
  for (let value = column.low; value <= column.high; value += every) {
    found.push(value);
  }
  return found;
}

/** Round numbers, so many at most. */
export function steps(low: number, high: number, most: number): number[] {
  if (!(high > low)) {
    return [low];
  }
  const rough = (high - low) / most;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = ([1, 2, 5, 10].find((factor) => factor * power >= rough) ?? 10) * power;
  const found = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k++) {
    found.push(Number((k * step).toPrecision(12)));
  }
  return found;
}

function spread(
  low: number,
  high: number,
  most: number,
  back: (value: number) => number,
  map: (value: number) => number,
): number[] {
  const count = Math.min(most, 4);
  return Array.from({ length: count }, (_, k) => back(map(low) + (k / (count - 1)) * (map(high) - map(low))));
}
