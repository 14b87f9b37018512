// Which designs are selected: those within a range of every column that has one. All views share one selection.

import { FEASIBLE, FRONT, type Study } from "./study_data";

export type Range = [number, number];
export type Only = "all" | "allowed" | "front";

const KEPT = 1000; // measured times

export class Selection {
  /** 1: the design of this row is selected. */
  readonly mask: Uint8Array;
  /** The selected rows, ascending. */
  rows: Int32Array;
  only: Only = "all";
  private readonly _ranges = new Map<number, Range>();
  private readonly _views: (() => void)[] = [];
  private _waiting = false;
  private _began = NaN;

  constructor(private readonly _study: Study) {
    this.mask = new Uint8Array(_study.count).fill(1);
    this.rows = Int32Array.from(this.mask, (_, row) => row);
  }

  get count(): number {
    return this.rows.length;
  }

  /** `draw` is called once per frame in which the selection has changed. */
  on_change(draw: () => void): void {
    this._views.push(draw);
  }

  range(column: number): Range | undefined {
    return this._ranges.get(column);
  }

  get is_all(): boolean {
    return this._ranges.size === 0 && this.only === "all";
  }

  /** Ranges by column; undefined: none. `at_ms`: when the user did that (an event's time stamp). */
  set(ranges: [number, Range | undefined][], at_ms = performance.now()): void {
    for (const [column, range] of ranges) {
      if (range === undefined) {
        this._ranges.delete(column);
      } else {
        this._ranges.set(column, range);
      }
    }
    this._changed(at_ms);
  }

  show_only(only: Only): void {
    this.only = only;
    this._changed(performance.now());
  }

  clear(): void {
    this._ranges.clear();
    this.only = "all";
    this._changed(performance.now());
  }

  private _changed(at_ms: number): void {
    this._began = Number.isNaN(this._began) ? at_ms : this._began;
    if (!this._waiting) {
      this._waiting = true;
      requestAnimationFrame(() => this._draw());
    }
  }

  private _draw(): void {
    this._waiting = false;
    this._mark();
    this._views.forEach((draw) => draw());
    const began = this._began;
    this._began = NaN;
    // What was drawn is on the screen when the next task runs: that is what the user waits for.
    const { port1, port2 } = new MessageChannel();
    port1.onmessage = () => {
      if (performance.getEntriesByName("brush").length >= KEPT) {
        performance.clearMeasures("brush");
      }
      performance.measure("brush", { start: began });
      port1.close();
    };
    port2.postMessage(null);
  }

  private _mark(): void {
    const { mask, _study: study } = this;
    const wanted = this.only === "front" ? FRONT : this.only === "allowed" ? FEASIBLE : 0;
    for (let row = 0; row < mask.length; row++) {
      mask[row] = ((study.flags[row] ?? 0) & wanted) === wanted ? 1 : 0;
    }
    for (const [index, [low, high]] of this._ranges) {
      const values = study.columns[index]?.values ?? new Float64Array();
      for (let row = 0; row < mask.length; row++) {
        const value = values[row] ?? NaN;
        if (!(value >= low && value <= high)) {
          mask[row] = 0;
        }
      }
    }
    const rows = new Int32Array(mask.length);
    let count = 0;
    for (let row = 0; row < mask.length; row++) {
      if (mask[row]) {
        rows[count++] = row;
      }
    }
    this.rows = rows.subarray(0, count);
  }
}
