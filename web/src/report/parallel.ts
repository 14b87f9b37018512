// Parallel coordinates: every column is an axis, one below the other, and every design a line through all of them.

import { element } from "../parts/page";
import { axis_of, type Axis } from "./axis";
import { colour, Layer, pixel_of, Stencil, Surface } from "./paint";
import { drawing_order, fitting, FONT, kind_of, type Marked, type Pen } from "./scatter";
import type { Range, Selection } from "./selection";
import { titled, type Column, type Study } from "./study_data";
import { drawn_svg } from "./svg";

const [SIDE, ROW, HEAD, FOOT] = [16, 74, 30, 26]; // margins, distance of the axes, what is above the first, below the last
const NEAR = 16; // pixels between pointer and axis
const FEW = 400; // lines, up to which each is drawn by itself
const STEPS_MAX = 6e6; // pixels that are touched for a picture; of more lines every second pixel, and so on

export class Parallel {
  private readonly _surface: Surface;
  private readonly _order: Int32Array;
  private readonly _inputs: [HTMLInputElement, HTMLInputElement][] = [];
  private readonly _behind = new Layer();
  private readonly _layer = new Layer();
  private readonly _titles = new Stencil();
  private _behind_is = "";
  private _counted = new Uint16Array();
  private _at: Float32Array[] = [];
  private _axes: Axis[] = [];
  private _drag: { column: number; from: number; moved: boolean } | undefined;

  constructor(
    where: HTMLElement,
    private readonly _study: Study,
    private readonly _selection: Selection,
    private readonly _marked: Marked,
  ) {
    this._order = drawing_order(_study);
    this._surface = new Surface(where, "", () => this._resized());
    const { canvas } = this._surface;
    canvas.classList.add("parallel");
    canvas.style.height = `${HEAD + FOOT + ROW * (_study.columns.length - 1)}px`;
    where.append(this._ranges());
    canvas.addEventListener("pointerdown", (event) => this._press(event));
    canvas.addEventListener("pointermove", (event) => this._move(event));
    canvas.addEventListener("pointerup", (event) => this._release(event));
    canvas.addEventListener("pointercancel", () => (this._drag = undefined));
    _selection.on_change(() => this.draw());
  }

  /** Ranges as numbers, for those who have no mouse, or want exact ones. */
  private _ranges(): HTMLElement {
    const body = element("tbody");
    for (const column of this._study.columns) {
      const inputs = ["lowest", "highest"].map((which) => {
        const name = `${which} ${titled(column)}`;
        const input = element("input", { type: "number", step: "any", "aria-label": name });
        input.addEventListener("change", (event) => this._typed(column, event.timeStamp));
        return input;
      }) as [HTMLInputElement, HTMLInputElement];
      this._inputs.push(inputs);
      const cells = inputs.map((input) => element("td", {}, input));
      body.append(element("tr", {}, element("th", { scope: "row" }, titled(column)), ...cells));
    }
    const heads = ["", "from", "to"].map((text) => element("th", { scope: "col" }, text));
    const table = element("table", {}, element("thead", {}, element("tr", {}, ...heads)), body);
    const box = element("div", { class: "scroll", tabindex: 0, role: "region", "aria-label": "ranges" }, table);
    return element("details", { class: "ranges" }, element("summary", {}, "Ranges as numbers"), box);
  }

  private _typed(column: Column, at_ms: number): void {
    const [from, to] = this._inputs[column.index] as [HTMLInputElement, HTMLInputElement];
    const empty = from.value === "" && to.value === "";
    const low = from.value === "" ? -Infinity : from.valueAsNumber;
    const high = to.value === "" ? Infinity : to.valueAsNumber;
    this._selection.set([[column.index, empty ? undefined : [low, high]]], at_ms);
  }

  private _resized(): void {
    const { width } = this._surface;
    this._axes = this._study.columns.map((column) => axis_of(column, SIDE, width - SIDE, 80));
    this._at = this._study.columns.map((column, k) => {
      const axis = this._axes[k] as Axis;
      return Float32Array.from(column.values, (value) => (Number.isFinite(value) ? axis.at(value) : NaN));
    });
    this.draw();
  }

  private _y(index: number): number {
    return HEAD + ROW * index;
  }

  draw(): void {
    const { pen, ratio, width } = this._surface;
    if (width < 3 * SIDE || !this._axes.length) {
      return;
    }
    pen.setTransform(1, 0, 0, 1, 0, 0);
    pen.clearRect(0, 0, pen.canvas.width, pen.canvas.height);
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    const { count, is_all } = this._selection;
    if (!is_all) {
      this._all_faint().draw(pen);
    }
    if (count <= FEW) {
      this._each(pen, this._order.filter((row) => this._selection.mask[row] === 1));
    } else {
      const { mask } = this._selection;
      this._density(this._layer, this._order.filter((row) => mask[row] === 1), 1); // prettier-ignore
      this._layer.draw(pen);
    }
    this._line(pen, this._marked.chosen, colour("limit"), 2.4);
    this._line(pen, this._marked.picked, colour("ink"), 2.4);
    this._titles.draw(this._surface, "", (on) => this._draw_axes(on, width));
    this._draw_ranges(pen, width);
    this._tell();
  }

  private _tell(): void {
    const { count } = this._selection;
    this._surface.canvas.setAttribute(
      "aria-label",
      `Parallel coordinates of ${this._study.columns.length} columns: ${count} of ${this._study.count} designs ` +
        `selected. Ranges can be typed below.`,
    );
    this._study.columns.forEach(({ index }, k) => {
      const range = this._selection.range(index);
      const inputs = this._inputs[k];
      if (inputs && document.activeElement !== inputs[0] && document.activeElement !== inputs[1]) {
        const text = (value: number | undefined) =>
          value === undefined || !Number.isFinite(value) ? "" : String(Number(value.toPrecision(6)));
        [inputs[0].value, inputs[1].value] = [text(range?.[0]), text(range?.[1])];
      }
    });
  }

  /** All designs in the background, drawn once for every size and theme. */
  private _all_faint(): Layer {
    const { width, ratio } = this._surface;
    const key = `${width} ${ratio} ${colour("quiet")}`;
    if (this._behind_is !== key) {
      this._behind_is = key;
      this._density(this._behind, this._order, 0.25);
    }
    return this._behind;
  }

  /** How many lines go through each pixel, as strength of colour; `strength`: of the strongest. */
  private _density(layer: Layer, among: Int32Array, strength: number): void {
    const [wide, high] = [Math.round(this._surface.width), Math.round(this._surface.height)];
    const paints = [colour("quiet"), colour("first"), colour("good")];
    const pixels = layer.clear(wide, high);
    for (const kind of [0, 1, 2]) {
      const rows = among.filter((row) => kind_of(this._study.flags[row] ?? 0) === kind);
      if (rows.length) {
        // The front is few lines: each of them is to be seen.
        const full = kind === 2 ? 1 : Math.max(4, rows.length / 60);
        blend(pixels, this._counts(rows, wide, high), paints[kind] ?? "#888", strength, full);
      }
    }
    layer.keep();
  }

  private _counts(rows: Int32Array, wide: number, high: number): Uint16Array {
    if (this._counted.length !== wide * high) {
      this._counted = new Uint16Array(wide * high);
    }
    const counts = this._counted.fill(0);
    const gaps = this._at.length - 1;
    const work = rows.length * gaps * ROW;
    const step = Math.max(1, Math.round(work / STEPS_MAX));
    const joined = work * (1 + wide / (3 * ROW)) < STEPS_MAX; // with every pixel of flat lines, too
    for (let gap = 0; gap < gaps; gap++) {
      const [from, to] = [this._at[gap] as Float32Array, this._at[gap + 1] as Float32Array];
      const top = Math.round(this._y(gap));
      for (const row of rows) {
        const [x0, x1] = [from[row] ?? NaN, to[row] ?? NaN];
        if (x0 !== x0 || x1 !== x1) {
          continue;
        }
        const slope = ((x1 - x0) / ROW) * step;
        let x = x0 + 0.5;
        for (let y = top; y < top + ROW; y += step) {
          counts[y * wide + (x | 0)]!++;
          if (joined) {
            const [low, high] = slope < 0 ? [(x + slope) | 0, x | 0] : [x | 0, (x + slope) | 0];
            for (let between = low + 1; between < high; between++) {
              counts[y * wide + between]!++;
            }
          }
          x += slope;
        }
      }
    }
    return counts;
  }

  private _each(pen: Pen, rows: Int32Array): void {
    const paints = [colour("quiet"), colour("first"), colour("good")];
    pen.globalAlpha = rows.length > 60 ? 0.35 : 0.8;
    for (const row of rows) {
      this._line(pen, row, paints[kind_of(this._study.flags[row] ?? 0)] ?? "#888", 1.2);
    }
    pen.globalAlpha = 1;
  }

  private _line(pen: Pen, row: number, paint: string, width: number): void {
    if (row < 0) {
      return;
    }
    pen.strokeStyle = paint;
    pen.lineWidth = width;
    pen.beginPath();
    let broken = true;
    this._at.forEach((at, k) => {
      const x = at[row] ?? NaN;
      if (Number.isNaN(x)) {
        broken = true;
      } else if (broken) {
        pen.moveTo(x, this._y(k));
        broken = false;
      } else {
        pen.lineTo(x, this._y(k));
      }
    });
    pen.stroke();
  }

  private _draw_axes(pen: Pen, width: number): void {
    pen.font = FONT;
    this._study.columns.forEach((column, k) => {
      const [axis, y] = [this._axes[k] as Axis, this._y(k)];
      plate(pen, colour("card"), SIDE - 4, y - 25, Math.min(width - 2 * SIDE, pen.measureText(titled(column)).width) + 8);
      pen.strokeStyle = pen.fillStyle = colour("ink");
      pen.lineWidth = 1.4;
      pen.beginPath();
      pen.moveTo(SIDE, y);
      pen.lineTo(width - SIDE, y);
      pen.stroke();
      pen.textAlign = "left";
      pen.textBaseline = "bottom";
      const title = fitting(pen, titled(column), width - 2 * SIDE);
      pen.fillText(title, SIDE, y - 9);
      this._limits(pen, column, axis, y, width, SIDE + pen.measureText(title).width + 10);
      this._ticks(pen, axis, y, width);
    });
  }

  private _ticks(pen: Pen, axis: Axis, y: number, width: number): void {
    pen.textAlign = "center";
    pen.textBaseline = "top";
    let until = -Infinity;
    for (const { at, text } of axis.ticks) {
      const x = axis.at(at);
      const half = pen.measureText(text).width / 2 + 3;
      if (x - half > until && x - half >= 0 && x + half <= width) {
        plate(pen, colour("card"), x - half, y + 4, 2 * half, 15);
        pen.fillStyle = colour("quiet");
        pen.fillText(text, x, y + 5);
        until = x + half;
      }
    }
  }

  /** Limits as marks on the axis, in words beside its title. */
  private _limits(pen: Pen, column: Column, axis: Axis, y: number, width: number, left: number): void {
    pen.strokeStyle = colour("limit");
    pen.lineWidth = 3;
    for (const { at } of column.limits.filter((limit) => !column.far.includes(limit))) {
      pen.beginPath();
      pen.moveTo(axis.at(at), y - 8);
      pen.lineTo(axis.at(at), y + 8);
      pen.stroke();
    }
    const words = column.limits.map((limit) => limit.words).join("; ");
    if (words && left < width - SIDE - 60) {
      const text = fitting(pen, words, width - SIDE - left);
      plate(pen, colour("card"), left - 3, y - 25, pen.measureText(text).width + 6);
      pen.fillStyle = colour("limit");
      pen.fillText(text, left, y - 9);
    }
  }

  private _draw_ranges(pen: Pen, width: number): void {
    this._study.columns.forEach(({ index }, k) => {
      const range = this._selection.range(index);
      if (range) {
        this._draw_range(pen, this._axes[k] as Axis, this._y(k), width, range);
      }
    });
  }

  private _draw_range(pen: Pen, axis: Axis, y: number, width: number, range: Range): void {
    const inside = (x: number) => Math.max(SIDE - 8, Math.min(width - SIDE + 8, x));
    const [left, right] = [inside(axis.at(range[0]) || 0), inside(axis.at(range[1]) || width)];
    pen.fillStyle = colour("accent");
    pen.globalAlpha = 0.75;
    pen.beginPath();
    pen.rect(left, y - 5, Math.max(2, right - left), 10);
    pen.fill();
    pen.globalAlpha = 1;
  }

  private _press(event: PointerEvent): void {
    const [x, y] = this._surface.place(event);
    const column = Math.round((y - HEAD) / ROW);
    if (column >= 0 && column < this._axes.length && Math.abs(y - this._y(column)) <= NEAR) {
      this._drag = { column, from: x, moved: false };
      this._surface.canvas.setPointerCapture(event.pointerId);
    }
  }

  private _move(event: PointerEvent): void {
    const [x, y] = this._surface.place(event);
    const column = Math.round((y - HEAD) / ROW);
    this._surface.canvas.style.cursor = this._drag || Math.abs(y - this._y(column)) <= NEAR ? "ew-resize" : "";
    if (!this._drag) {
      return;
    }
    this._drag.moved ||= Math.abs(x - this._drag.from) > 3;
    if (this._drag.moved) {
      const axis = this._axes[this._drag.column] as Axis;
      const [a, b] = [axis.value(this._drag.from), axis.value(x)];
      this._selection.set([[this._drag.column, a < b ? [a, b] : [b, a]]], event.timeStamp);
    }
  }

  private _release(event: PointerEvent): void {
    if (this._drag && !this._drag.moved) {
      this._selection.set([[this._drag.column, undefined]], event.timeStamp);
    }
    this._drag = undefined;
  }

  /** The picture as it is; of many lines the selected ones, up to a few thousand. */
  svg(): string {
    const { width, height } = this._surface;
    const rows = this._order.filter((row) => this._selection.mask[row] === 1);
    const every = Math.ceil(rows.length / 3000);
    return drawn_svg(width, height, (pen) => {
      this._each(pen, rows.filter((_, k) => k % every === 0));
      this._draw_axes(pen, width);
      this._draw_ranges(pen, width);
    });
  }
}

function plate(pen: Pen, paint: string, x: number, y: number, width: number, height = 17): void {
  pen.fillStyle = paint;
  pen.globalAlpha = 0.82;
  pen.beginPath();
  pen.rect(x, y, width, height);
  pen.fill();
  pen.globalAlpha = 1;
}

/** Colours pixels by how many lines cross them; `full`: so many are as strong as it gets. */
function blend(pixels: Uint32Array, counts: Uint16Array, paint: string, strength: number, full: number): void {
  const levels = new Uint32Array(256);
  for (let count = 1; count < 256; count++) {
    const share = Math.min(1, Math.log1p(count) / Math.log1p(full));
    levels[count] = pixel_of(paint, strength * (0.12 + 0.88 * share));
  }
  for (let at = 0; at < counts.length; at++) {
    const count = counts[at] as number;
    if (count) {
      pixels[at] = levels[Math.min(count, 255)] as number;
    }
  }
}
