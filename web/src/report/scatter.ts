// Any two columns against each other: one point per design, limits as named lines, a brush, a click.

import { element } from "../parts/page";
import { axis_of, type Axis } from "./axis";
import { colour, Layer, pixel_of, Stencil, Surface } from "./paint";
import type { Range, Selection } from "./selection";
import { FEASIBLE, FRONT, titled, type Column, type Study } from "./study_data";
import { drawn_svg } from "./svg";

const [LEFT, RIGHT, TOP, BOTTOM] = [64, 14, 14, 44];
const NEAR = 14; // pixels between pointer and point
const MANY = 2500; // points, from which on they are small squares
const DRAG = 4; // pixels that make a click a brush

export interface Marked {
  /** Row of the design beside which others are shown; -1: none. */
  chosen: number;
  picked: number;
}

export class Scatter {
  x: number;
  y: number;
  private readonly _surface: Surface;
  private readonly _order: Int32Array;
  private readonly _layer = new Layer();
  private _spots: [Int16Array, Int16Array] = [new Int16Array(), new Int16Array()];
  private readonly _faint = new Layer();
  private _faint_is = "";
  private readonly _below = new Stencil();
  private readonly _above = new Stencil();
  private _start: [number, number] | undefined;
  private _dragged = false;
  private _hovered = -1;

  constructor(
    where: HTMLElement,
    private readonly _study: Study,
    private readonly _selection: Selection,
    private readonly _marked: Marked,
    private readonly _on: { hover: (row: number, event?: MouseEvent) => void; pick: (row: number) => void },
  ) {
    [this.x, this.y] = _study.first_pair();
    this._order = drawing_order(_study);
    const controls = element("div", { class: "buttons" });
    controls.append(this._chooser("horizontal", "x"), this._chooser("vertical", "y"));
    where.append(controls);
    this._surface = new Surface(where, "", () => this.draw());
    this._surface.canvas.tabIndex = 0;
    this._surface.canvas.classList.add("scatter");
    this._listen();
    _selection.on_change(() => this.draw());
  }

  private _column(which: "x" | "y"): Column {
    return this._study.columns[this[which]] as Column;
  }

  private _chooser(label: string, which: "x" | "y"): HTMLElement {
    const select = element("select", {}) as HTMLSelectElement;
    for (const column of this._study.columns) {
      select.append(element("option", { value: String(column.index) }, titled(column)));
    }
    select.value = String(this[which]);
    select.addEventListener("change", () => {
      this[which] = Number(select.value);
      this.draw();
    });
    return element("label", { class: "chooser" }, `${label} `, select);
  }

  private _axes(): [Axis, Axis] {
    const { width, height } = this._surface;
    const x = axis_of(this._column("x"), LEFT, width - RIGHT, 90);
    return [x, axis_of(this._column("y"), height - BOTTOM, TOP, 50)];
  }

  draw(): void {
    const { _surface: surface } = this;
    if (surface.width < LEFT + RIGHT + 20) {
      return;
    }
    const { pen, ratio, width, height } = surface;
    const [x, y] = this._axes();
    surface.canvas.setAttribute("aria-label", this._words());
    pen.setTransform(1, 0, 0, 1, 0, 0);
    pen.clearRect(0, 0, pen.canvas.width, pen.canvas.height);
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    const key = `${this.x} ${this.y}`;
    this._below.draw(surface, key, (on) => frame(on, [x, y], width, height));
    this._points(x, y);
    this._front(x, y);
    this._above.draw(surface, key, (on) => {
      limits(on, this._column("x"), x, "x", width, height);
      limits(on, this._column("y"), y, "y", width, height);
      titles(on, this._column("x"), this._column("y"), width, height);
    });
    this._rings(x, y);
    this._box(x, y);
  }

  private _points(x: Axis, y: Axis): void {
    const { pen } = this._surface;
    const [xs, ys] = [this._column("x").values, this._column("y").values];
    const { mask } = this._selection;
    const { flags, count } = this._study;
    const paints = [colour("quiet"), colour("first"), colour("good")];
    if (count < MANY) {
      for (const row of this._order) {
        const [px, py] = [x.at(xs[row] ?? NaN), y.at(ys[row] ?? NaN)];
        if (Number.isFinite(px + py)) {
          const kind = kind_of(flags[row] ?? 0);
          pen.globalAlpha = mask[row] ? (kind ? 0.85 : 0.55) : 0.12;
          pen.fillStyle = paints[kind] ?? "#888";
          pen.beginPath();
          pen.arc(px, py, kind === 2 ? 4.5 : 3.5, 0, 7);
          pen.fill();
        }
      }
      pen.globalAlpha = 1;
      return;
    }
    this._squares(x, y, paints);
  }

  /** Thousands of points, as squares of a few pixels: all of them faint, drawn once, and the selected ones above. */
  private _squares(x: Axis, y: Axis, paints: string[]): void {
    const { pen, ratio } = this._surface;
    const { mask } = this._selection;
    const key = `${this.x} ${this.y} ${pen.canvas.width} ${pen.canvas.height} ${paints.join()}`;
    if (this._faint_is !== key) {
      this._faint_is = key;
      this._spots = [spots(this._column("x"), x, ratio), spots(this._column("y"), y, ratio)];
      this._fill(this._faint, this._order, paints.map((paint) => pixel_of(paint, 0.13))); // prettier-ignore
    }
    if (!this._selection.is_all) {
      this._faint.draw(pen);
    }
    const rows = this._selection.is_all ? this._order : this._order.filter((row) => mask[row] === 1);
    this._fill(this._layer, rows, paints.map((paint, kind) => pixel_of(paint, kind ? 1 : 0.5))); // prettier-ignore
    this._layer.draw(pen);
  }

  private _fill(layer: Layer, rows: Int32Array, paints: number[]): void {
    const { canvas, ratio } = this._surface;
    const [wide, high] = [canvas.width, canvas.height];
    const pixels = layer.clear(wide, high);
    const size = Math.max(2, Math.round(2.4 * ratio));
    const [xs, ys] = this._spots;
    const { flags } = this._study;
    for (const row of rows) {
      const [px, py] = [(xs[row] as number) - (size >> 1), (ys[row] as number) - (size >> 1)];
      if (px >= 0 && py >= 0 && px < wide - size && py < high - size) {
        const paint = paints[kind_of(flags[row] as number)] as number;
        for (let k = 0; k < size; k++) {
          const first = (py + k) * wide + px;
          for (let at = first; at < first + size; at++) {
            pixels[at] = paint;
          }
        }
      }
    }
    layer.keep();
  }

  /** The front of two objectives is a line. */
  private _front(x: Axis, y: Axis): void {
    const objectives = this._study.columns.filter((column) => column.role === "objective");
    const shown = [this._column("x"), this._column("y")];
    if (objectives.length !== 2 || this.x === this.y || shown.some((column) => column.role !== "objective")) {
      return;
    }
    const { pen } = this._surface;
    const [xs, ys] = [this._column("x").values, this._column("y").values];
    const rows = [...this._order].filter((row) => (this._study.flags[row] ?? 0) & FRONT);
    rows.sort((a, b) => (xs[a] ?? 0) - (xs[b] ?? 0));
    pen.strokeStyle = colour("good");
    pen.lineWidth = 1.2;
    pen.beginPath();
    rows.forEach((row) => pen.lineTo(x.at(xs[row] ?? NaN), y.at(ys[row] ?? NaN)));
    pen.stroke();
  }

  /** Rings around the designs that are shown below, and the one under the pointer. */
  private _rings(x: Axis, y: Axis): void {
    const { pen } = this._surface;
    const [xs, ys] = [this._column("x").values, this._column("y").values];
    const rings: [number, string, number][] = [
      [this._marked.chosen, colour("limit"), 8],
      [this._marked.picked, colour("ink"), 11],
      [this._hovered, colour("ink"), 5],
    ];
    for (const [row, paint, radius] of rings) {
      const [px, py] = [x.at(xs[row] ?? NaN), y.at(ys[row] ?? NaN)];
      if (row >= 0 && Number.isFinite(px + py)) {
        pen.strokeStyle = paint;
        pen.lineWidth = 2.2;
        pen.beginPath();
        pen.arc(px, py, radius, 0, 7);
        pen.stroke();
      }
    }
  }

  private _box(x: Axis, y: Axis): void {
    const [rx, ry] = [this._selection.range(this.x), this._selection.range(this.y)];
    if (!rx && !ry) {
      return;
    }
    const { pen, width, height } = this._surface;
    const [left, right] = rx ? rx.map(x.at) : [LEFT, width - RIGHT];
    const [bottom, top] = ry ? ry.map(y.at) : [height - BOTTOM, TOP];
    pen.fillStyle = pen.strokeStyle = colour("accent");
    pen.lineWidth = 1.2;
    pen.beginPath();
    pen.rect(left ?? 0, top ?? 0, (right ?? 0) - (left ?? 0), (bottom ?? 0) - (top ?? 0));
    pen.globalAlpha = 0.08;
    pen.fill();
    pen.globalAlpha = 1;
    pen.stroke();
  }

  private _words(): string {
    const [x, y] = [titled(this._column("x")), titled(this._column("y"))];
    const { count } = this._selection;
    const keys = "Arrow keys go from design to design, Enter shows one below.";
    return `${y} over ${x}: ${count} of ${this._study.count} designs selected. ${keys}`;
  }

  private _listen(): void {
    const { canvas } = this._surface;
    canvas.addEventListener("pointerdown", (event) => {
      this._start = this._surface.place(event);
      this._dragged = false;
      canvas.setPointerCapture(event.pointerId);
    });
    canvas.addEventListener("pointermove", (event) => (this._start ? this._drag(event) : this._hover(event)));
    canvas.addEventListener("pointerup", (event) => this._released(event));
    canvas.addEventListener("pointercancel", () => (this._start = undefined));
    canvas.addEventListener("pointerleave", () => this.point_at(-1));
    canvas.addEventListener("keydown", (event) => this._key(event));
    canvas.addEventListener("blur", () => this.point_at(-1));
  }

  private _drag(event: PointerEvent): void {
    const [x0, y0] = this._start ?? [0, 0];
    const [x1, y1] = this._surface.place(event);
    this._dragged ||= Math.hypot(x1 - x0, y1 - y0) > DRAG;
    if (!this._dragged) {
      return;
    }
    this.point_at(-1);
    const [x, y] = this._axes();
    const range = (axis: Axis, a: number, b: number): Range => {
      const [va, vb] = [axis.value(a), axis.value(b)];
      return va < vb ? [va, vb] : [vb, va];
    };
    const ranges: [number, Range][] = [
      [this.x, range(x, x0, x1)],
      [this.y, range(y, y0, y1)],
    ];
    this._selection.set(ranges, event.timeStamp);
  }

  private _released(event: PointerEvent): void {
    if (this._start && !this._dragged) {
      const row = this._nearest(event);
      if (row >= 0) {
        this._on.pick(row);
      } else if (this._selection.range(this.x) || this._selection.range(this.y)) {
        this._selection.set([[this.x, undefined], [this.y, undefined]], event.timeStamp); // prettier-ignore
      }
    }
    this._start = undefined;
  }

  private _hover(event: PointerEvent): void {
    this.point_at(this._nearest(event), event);
  }

  /** Marks the design of this row, and says so; -1: none. */
  point_at(row: number, event?: MouseEvent): void {
    if (row !== this._hovered || event) {
      const changed = row !== this._hovered;
      this._hovered = row;
      this._on.hover(row, event);
      if (changed) {
        this.draw();
      }
    }
  }

  private _nearest(event: MouseEvent): number {
    const [px, py] = this._surface.place(event);
    const [x, y] = this._axes();
    const [xs, ys] = [this._column("x").values, this._column("y").values];
    let [best, found] = [NEAR * NEAR, -1];
    for (const row of this._order) {
      const [dx, dy] = [x.at(xs[row] ?? NaN) - px, y.at(ys[row] ?? NaN) - py];
      const far = dx * dx + dy * dy;
      if (far <= best && this._selection.mask[row]) {
        [best, found] = [far, row];
      }
    }
    return found;
  }

  private _key(event: KeyboardEvent): void {
    const step = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1 }[event.key];
    if (event.key === "Enter" && this._hovered >= 0) {
      this._on.pick(this._hovered);
    } else if (event.key === "Escape") {
      this._selection.set([[this.x, undefined], [this.y, undefined]], event.timeStamp); // prettier-ignore
    } else if (step) {
      event.preventDefault();
      const xs = this._column("x").values;
      const rows = [...this._order].filter((row) => this._selection.mask[row] && Number.isFinite(xs[row] ?? NaN));
      rows.sort((a, b) => (xs[a] ?? 0) - (xs[b] ?? 0));
      const here = rows.indexOf(this._hovered);
      const next = here < 0 ? (step > 0 ? 0 : rows.length - 1) : (here + step + rows.length) % rows.length;
      this.point_at(rows[next] ?? -1);
    }
  }

  /** The picture as it is, as text of an SVG file. */
  svg(): string {
    const { width, height } = this._surface;
    const [x, y] = this._axes();
    const [xs, ys] = [this._column("x").values, this._column("y").values];
    const paints = [colour("quiet"), colour("first"), colour("good")];
    const points = [...this._order].map((row) => ({
      x: x.at(xs[row] ?? NaN),
      y: y.at(ys[row] ?? NaN),
      paint: paints[kind_of(this._study.flags[row] ?? 0)] ?? "#888",
      share: this._selection.mask[row] ? 0.8 : 0.12,
    }));
    return drawn_svg(width, height, (pen) => {
      frame(pen, [x, y], width, height);
      for (const point of points.filter((one) => Number.isFinite(one.x + one.y))) {
        pen.globalAlpha = point.share;
        pen.fillStyle = point.paint;
        pen.beginPath();
        pen.arc(point.x, point.y, 2.5, 0, 7);
        pen.fill();
      }
      pen.globalAlpha = 1;
      limits(pen, this._column("x"), x, "x", width, height);
      limits(pen, this._column("y"), y, "y", width, height);
      titles(pen, this._column("x"), this._column("y"), width, height);
    });
  }
}

/** What the pens of a canvas and of an SVG file have in common. */
export type Pen = Pick<
  CanvasRenderingContext2D,
  | "beginPath" | "moveTo" | "lineTo" | "arc" | "rect" | "stroke" | "fill" | "fillText" | "save" | "restore" | "clip"
  | "translate" | "rotate" | "setLineDash" | "measureText"
> & { fillStyle: unknown; strokeStyle: unknown; lineWidth: number; globalAlpha: number; font: string;
  textAlign: CanvasTextAlign; textBaseline: CanvasTextBaseline }; // prettier-ignore

/** Pixels of all designs along an axis; -1: none. */
function spots(column: Column, axis: Axis, ratio: number): Int16Array {
  return Int16Array.from(column.values, (value) => (Number.isFinite(value) ? Math.round(axis.at(value) * ratio) : -1));
}

/** 0: a limit is not met; 1: allowed; 2: on the front. */
export function kind_of(flags: number): 0 | 1 | 2 {
  return flags & FRONT ? 2 : flags & FEASIBLE ? 1 : 0;
}

/** Rows in the order in which they are drawn: the front last, above all others. */
export function drawing_order(study: Study): Int32Array {
  const rows = Int32Array.from({ length: study.count }, (_, row) => row);
  return rows.sort((a, b) => kind_of(study.flags[a] ?? 0) - kind_of(study.flags[b] ?? 0) || a - b);
}

export const FONT = "12px system-ui, sans-serif";

function frame(pen: Pen, [x, y]: [Axis, Axis], width: number, height: number): void {
  pen.font = FONT;
  pen.lineWidth = 1;
  pen.strokeStyle = colour("line");
  pen.fillStyle = colour("quiet");
  pen.textAlign = "center";
  pen.textBaseline = "top";
  let until = -Infinity;
  for (const { at, text } of x.ticks) {
    const px = x.at(at);
    segment(pen, px, TOP, px, height - BOTTOM);
    const wide = pen.measureText(text).width / 2 + 4;
    if (px - wide > until && px + wide < width) {
      pen.fillText(text, px, height - BOTTOM + 5);
      until = px + wide;
    }
  }
  pen.textAlign = "right";
  pen.textBaseline = "middle";
  for (const { at, text } of y.ticks) {
    const py = y.at(at);
    segment(pen, LEFT, py, width - RIGHT, py);
    pen.fillText(fitting(pen, text, LEFT - 26), LEFT - 6, py);
  }
}

function titles(pen: Pen, x: Column, y: Column, width: number, height: number): void {
  pen.font = FONT;
  pen.fillStyle = colour("ink");
  pen.textAlign = "center";
  pen.textBaseline = "bottom";
  pen.fillText(fitting(pen, titled(x), width - 8), Math.max(LEFT, width / 2), height - 4);
  pen.save();
  pen.translate(4, (height - BOTTOM) / 2);
  pen.rotate(-Math.PI / 2);
  pen.textBaseline = "top";
  pen.fillText(fitting(pen, titled(y), height - BOTTOM - 8), 0, 0);
  pen.restore();
}

/** Limits as named lines; one that is far from the data is named at the edge. */
function limits(pen: Pen, column: Column, axis: Axis, which: "x" | "y", width: number, height: number): void {
  pen.font = FONT;
  pen.strokeStyle = pen.fillStyle = colour("limit");
  pen.lineWidth = 1.3;
  pen.setLineDash([6, 3]);
  const near = column.limits.filter((limit) => !column.far.includes(limit));
  const at_edge = column.far.map(({ at, words }) => {
    const above = at > column.high;
    return { words: `${words}: ${above ? "above" : "below"} this range`, value: above ? column.high : column.low };
  });
  for (const { at } of near) {
    const pixel = axis.at(at);
    which === "x" ? segment(pen, pixel, TOP, pixel, height - BOTTOM) : segment(pen, LEFT, pixel, width - RIGHT, pixel);
  }
  pen.setLineDash([]);
  const named = [...near.map(({ at, words }) => ({ words, value: at })), ...at_edge];
  for (const { words, value } of named) {
    const pixel = axis.at(value);
    pen.textBaseline = "bottom";
    pen.textAlign = "right";
    pen.save();
    if (which === "x") {
      pen.translate(Math.max(pixel, LEFT + 14) - 2, TOP + 2);
      pen.rotate(-Math.PI / 2);
      pen.fillText(fitting(pen, words, height - TOP - BOTTOM), 0, 0);
    } else {
      pen.fillText(fitting(pen, words, width - LEFT - RIGHT), width - RIGHT - 2, Math.max(pixel, TOP + 16) - 2);
    }
    pen.restore();
  }
}

function segment(pen: Pen, x0: number, y0: number, x1: number, y1: number): void {
  pen.beginPath();
  pen.moveTo(x0, y0);
  pen.lineTo(x1, y1);
  pen.stroke();
}

/** `text`, shortened in its middle if there is no room for it. */
export function fitting(pen: Pen, text: string, width: number): string {
  if (pen.measureText(text).width <= width) {
    return text;
  }
  for (let keep = text.length - 1; keep > 4; keep--) {
    const short = `${text.slice(0, Math.ceil(keep / 2))}…${text.slice(text.length - Math.floor(keep / 2))}`;
    if (pen.measureText(short).width <= width) {
      return short;
    }
  }
  return "…";
}
