// One panel of a figure that Python has drawn: zoom, values under the pointer, SVG and CSV.

import { element, unpacked } from "../parts/page";
import { csv, save } from "../parts/save";
import { steps } from "./axis";
import { colour, rgb, Surface } from "./paint";
import { fitting, FONT, type Pen } from "./scatter";
import { number_text } from "./study_data";
import { drawn_svg } from "./svg";

export interface Paint {
  colour: string;
  alpha: number;
}

interface AxisData {
  label: string;
  first: number;
  last: number;
  log: boolean;
  ticks: [number, string][] | null;
}

interface LineData extends Paint {
  label: string;
  width: number;
  dash: boolean;
  marker: number;
  hollow: boolean;
  x: string;
  y: string;
}

export interface AxesData {
  row: number;
  column: number;
  title: string;
  equal: boolean;
  x: AxisData;
  y: AxisData;
  areas: (Paint & { label: string; edge: (Paint & { width: number }) | null; x: string; y: string })[];
  lines: LineData[];
  clouds: Omit<LineData, "width" | "dash">[];
  segments: (Paint & { x: string; y: string })[];
  across: (Paint & { axis: "x" | "y"; at: number; label: string; dash: boolean })[];
  words: (Paint & {
    text: string; x: number; y: number; x_share: boolean; y_share: boolean; shift: [number, number];
    turned: boolean; side: string; upright: string;
  })[]; // prettier-ignore
  arrows: (Paint & { width: number; x: [number, number]; y: [number, number] })[];
}

/** A line or a cloud of points, as the pointer finds it. */
interface Series {
  data: LineData | AxesData["clouds"][number];
  x: ArrayLike<number>;
  y: ArrayLike<number>;
}

type Box = { x: [number, number]; y: [number, number] };

const [LEFT, RIGHT, TOP, BOTTOM] = [60, 12, 10, 42];
const HEIGHT = 260;
const NEAR = 24; // pixels between pointer and point
const SCALE = 4 / 3; // pixels of a point of type

export class Chart {
  /** Hears which value of the horizontal axis is pointed at. */
  on_x: ((x: number) => void) | undefined;
  private readonly _surface: Surface;
  private readonly _said = element("output", { class: "said" });
  private readonly _series: Series[];
  private readonly _areas: { data: AxesData["areas"][number]; x: ArrayLike<number>; y: ArrayLike<number> }[];
  private readonly _segments: { data: Paint; x: ArrayLike<number>; y: ArrayLike<number> }[];
  private readonly _whole: Box;
  private _box: Box;
  private _at: { series: number; point: number } | undefined;
  private _start: [number, number] | undefined;
  private _end: [number, number] | undefined;

  constructor(
    where: HTMLElement,
    private readonly _data: AxesData,
    private readonly _name: string,
  ) {
    this._whole = { x: [_data.x.first, _data.x.last], y: [_data.y.first, _data.y.last] };
    this._box = this._whole;
    const points = (one: { x: string; y: string }) => ({ x: unpacked(one.x), y: unpacked(one.y) });
    this._series = [..._data.lines, ..._data.clouds].map((data) => ({ data, ...points(data) }));
    this._areas = _data.areas.map((data) => ({ data, ...points(data) }));
    this._segments = _data.segments.map((data) => ({ data, ...points(data) }));
    const title = _data.title.replace(/\n/g, " ");
    const button = (what: string, click: () => void) =>
      element("button", { type: "button", click, "aria-label": `${this._called()} as ${what}` }, what);
    const buttons = element("span", { class: "buttons" }, button("SVG", () => this._save_svg()), button("CSV", () => this._save_csv()));
    where.append(element("figcaption", {}, element("span", {}, title), buttons));
    this._surface = new Surface(where, this._words(), () => this.draw());
    this._surface.canvas.tabIndex = 0;
    this._surface.canvas.classList.add("chart");
    if (!_data.equal) {
      this._surface.canvas.style.height = `${HEIGHT}px`;
    } else {
      const [wide, high] = [this._whole.x, this._whole.y].map(([a, b]) => Math.abs(b - a));
      this._surface.canvas.style.aspectRatio = `${Math.max(0.6, Math.min(2.2, (wide ?? 1) / (high ?? 1)))}`;
    }
    where.append(this._said);
    this._listen();
  }

  private _called(): string {
    return `${this._name}${this._data.title ? `, ${this._data.title.replace(/\n/g, " ")}` : ""}`;
  }

  private _words(): string {
    const names = this._series.map(({ data }) => data.label).filter(Boolean);
    const { x, y } = this._data;
    return (
      `${this._called()}: ${y.label} over ${x.label}${names.length ? `; ${[...new Set(names)].join(", ")}` : ""}. ` +
      "Arrow keys go from point to point, plus and minus zoom, 0 shows all."
    );
  }

  /** From values to pixels; equal axes keep their shape. */
  private _maps(): { x: (v: number) => number; y: (v: number) => number; back: (px: number, py: number) => [number, number] } {
    const { width, height } = this._surface;
    const [w, h] = [width - LEFT - RIGHT, height - TOP - BOTTOM];
    const of = (axis: AxisData) => (axis.log ? Math.log10 : (value: number) => value);
    const [fx, fy] = [of(this._data.x), of(this._data.y)];
    const [x0, x1] = this._box.x.map(fx) as [number, number];
    const [y0, y1] = this._box.y.map(fy) as [number, number];
    let [sx, sy] = [w / (x1 - x0), h / (y1 - y0)];
    let [left, low] = [LEFT, height - BOTTOM];
    if (this._data.equal) {
      const scale = Math.min(Math.abs(sx), Math.abs(sy));
      left += (w - scale * Math.abs(x1 - x0)) / 2;
      low -= (h - scale * Math.abs(y1 - y0)) / 2;
      [sx, sy] = [Math.sign(sx) * scale, Math.sign(sy) * scale];
    }
    const undo = (axis: AxisData, value: number) => (axis.log ? 10 ** value : value);
    return {
      x: (v) => left + (fx(v) - x0) * sx,
      y: (v) => low - (fy(v) - y0) * sy,
      back: (px, py) => [undo(this._data.x, x0 + (px - left) / sx), undo(this._data.y, y0 + (low - py) / sy)],
    };
  }

  draw(): void {
    const { pen, ratio, width } = this._surface;
    if (width < LEFT + RIGHT + 20) {
      return;
    }
    pen.setTransform(1, 0, 0, 1, 0, 0);
    pen.clearRect(0, 0, pen.canvas.width, pen.canvas.height);
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    this._framed(pen);
    this._pointed(pen);
  }

  private _framed(pen: Pen): void {
    const { width, height } = this._surface;
    pen.save();
    this._frame(pen);
    pen.beginPath();
    pen.rect(LEFT, TOP, width - LEFT - RIGHT, height - TOP - BOTTOM);
    pen.clip();
    this._content(pen);
    pen.restore();
  }

  private _frame(pen: Pen): void {
    const { width, height } = this._surface;
    const { x, y } = this._maps();
    pen.font = FONT;
    pen.lineWidth = 1;
    pen.textBaseline = "top";
    pen.textAlign = "center";
    pen.strokeStyle = colour("grid");
    pen.fillStyle = colour("quiet");
    let until = -Infinity;
    for (const [at, text] of ticks(this._data.x, this._box.x, (width - LEFT - RIGHT) / 70)) {
      const px = x(at);
      if (px >= LEFT - 1 && px <= width - RIGHT + 1) {
        segment(pen, px, TOP, px, height - BOTTOM);
        const half = pen.measureText(text).width / 2 + 3;
        if (px - half > until && px + half <= width) {
          pen.fillText(text, px, height - BOTTOM + 4);
          until = px + half;
        }
      }
    }
    pen.textBaseline = "middle";
    pen.textAlign = "right";
    for (const [at, text] of ticks(this._data.y, this._box.y, (height - TOP - BOTTOM) / 36)) {
      const py = y(at);
      if (py >= TOP - 1 && py <= height - BOTTOM + 1) {
        segment(pen, LEFT, py, width - RIGHT, py);
        pen.fillText(fitting(pen, text, LEFT - 22), LEFT - 5, py);
      }
    }
    pen.strokeStyle = colour("quiet");
    segment(pen, LEFT, height - BOTTOM, width - RIGHT, height - BOTTOM);
    segment(pen, LEFT, TOP, LEFT, height - BOTTOM);
    pen.fillStyle = colour("ink");
    pen.textAlign = "center";
    pen.textBaseline = "bottom";
    pen.fillText(fitting(pen, plain(this._data.x.label), width - 8), Math.max(LEFT, width / 2), height - 3);
    pen.save();
    pen.translate(2, (height - BOTTOM + TOP) / 2);
    pen.rotate(-Math.PI / 2);
    pen.textBaseline = "top";
    pen.fillText(fitting(pen, plain(this._data.y.label), height - BOTTOM - 4), 0, 0);
    pen.restore();
  }

  private _content(pen: Pen): void {
    const { x, y } = this._maps();
    for (const { data, x: xs, y: ys } of this._areas) {
      this._path(pen, xs, ys);
      pen.globalAlpha = data.alpha;
      pen.fillStyle = shade(data.colour);
      pen.fill();
      if (data.edge) {
        pen.globalAlpha = data.edge.alpha;
        pen.strokeStyle = shade(data.edge.colour);
        pen.lineWidth = data.edge.width * SCALE;
        pen.stroke();
      }
    }
    for (const { data, x: xs, y: ys } of this._segments) {
      this._path(pen, xs, ys);
      pen.globalAlpha = data.alpha;
      pen.strokeStyle = shade(data.colour);
      pen.lineWidth = 1.4;
      pen.stroke();
    }
    this._across(pen);
    for (const series of this._series) {
      this._draw_series(pen, series, x, y);
    }
    pen.globalAlpha = 1;
    for (const arrow of this._data.arrows) {
      draw_arrow(pen, shade(arrow.colour), [x(arrow.x[0]), y(arrow.y[0])], [x(arrow.x[1]), y(arrow.y[1])]);
    }
    this._texts(pen, x, y);
  }

  private _path(pen: Pen, xs: ArrayLike<number>, ys: ArrayLike<number>): void {
    const { x, y } = this._maps();
    pen.beginPath();
    let broken = true;
    for (let k = 0; k < xs.length; k++) {
      const [px, py] = [x(xs[k] as number), y(ys[k] as number)];
      if (!Number.isFinite(px + py)) {
        broken = true;
      } else if (broken) {
        pen.moveTo(px, py);
        broken = false;
      } else {
        pen.lineTo(px, py);
      }
    }
  }

  private _draw_series(pen: Pen, { data, x: xs, y: ys }: Series, x: (v: number) => number, y: (v: number) => number): void {
    pen.globalAlpha = data.alpha;
    pen.strokeStyle = pen.fillStyle = shade(data.colour);
    if ("width" in data && data.width > 0) {
      pen.setLineDash(data.dash ? [5, 4] : []);
      pen.lineWidth = data.width * SCALE * 0.9;
      this._path(pen, xs, ys);
      pen.stroke();
      pen.setLineDash([]);
    }
    if (data.marker > 0) {
      pen.lineWidth = 1.5;
      for (let k = 0; k < xs.length; k++) {
        const [px, py] = [x(xs[k] as number), y(ys[k] as number)];
        if (Number.isFinite(px + py)) {
          pen.beginPath();
          pen.arc(px, py, Math.max(1.2, (data.marker * SCALE) / 2), 0, 7);
          data.hollow ? pen.stroke() : pen.fill();
        }
      }
    }
  }

  private _across(pen: Pen): void {
    const { width, height } = this._surface;
    const { x, y } = this._maps();
    for (const line of this._data.across) {
      pen.globalAlpha = line.alpha;
      pen.strokeStyle = shade(line.colour);
      pen.lineWidth = 1.3;
      pen.setLineDash(line.dash ? [6, 4] : []);
      if (line.axis === "x") {
        segment(pen, x(line.at), TOP, x(line.at), height - BOTTOM);
      } else {
        segment(pen, LEFT, y(line.at), width - RIGHT, y(line.at));
      }
    }
    pen.setLineDash([]);
    pen.globalAlpha = 1;
  }

  private _texts(pen: Pen, x: (v: number) => number, y: (v: number) => number): void {
    const { width, height } = this._surface;
    pen.font = FONT;
    for (const word of this._data.words) {
      const px = word.x_share ? LEFT + word.x * (width - LEFT - RIGHT) : x(word.x);
      const py = word.y_share ? height - BOTTOM - word.y * (height - TOP - BOTTOM) : y(word.y);
      pen.fillStyle = shade(word.colour);
      pen.textBaseline = ({ top: "top", bottom: "bottom", center: "middle" } as const)[word.upright as "top"] ?? "bottom";
      pen.save();
      const text = fitting(pen, plain(word.text), (word.turned ? height : width) - LEFT - RIGHT);
      const half = pen.measureText(text).width;
      // A text near the edge goes to the side where there is room for it.
      const start = { center: -half / 2, right: -half, left: 0 }[word.side as "left"] ?? 0;
      const shift = word.turned ? 0 : Math.max(LEFT + 2, Math.min(width - RIGHT - half - 2, px + word.shift[0] + start));
      pen.textAlign = word.turned ? (word.upright === "top" ? "right" : "left") : "left";
      pen.translate(word.turned ? px - 2 : shift, Math.max(TOP + 12, py + word.shift[1]));
      if (word.turned) {
        pen.rotate(-Math.PI / 2);
        pen.textBaseline = "bottom";
      }
      pen.fillText(text, 0, 0);
      pen.restore();
    }
  }

  private _pointed(pen: CanvasRenderingContext2D): void {
    const { x, y } = this._maps();
    const series = this._at && this._series[this._at.series];
    if (this._at && series) {
      const { point } = this._at;
      pen.strokeStyle = colour("ink");
      pen.lineWidth = 2;
      pen.beginPath();
      pen.arc(x(series.x[point] as number), y(series.y[point] as number), 5, 0, 7);
      pen.stroke();
    }
    if (this._start && this._end) {
      const [[x0, y0], [x1, y1]] = [this._start, this._end];
      pen.strokeStyle = pen.fillStyle = colour("accent");
      pen.globalAlpha = 0.15;
      pen.fillRect(x0, y0, x1 - x0, y1 - y0);
      pen.globalAlpha = 1;
      pen.strokeRect(x0, y0, x1 - x0, y1 - y0);
    }
  }

  private _listen(): void {
    const { canvas } = this._surface;
    canvas.addEventListener("pointerdown", (event) => {
      this._start = this._surface.place(event);
      canvas.setPointerCapture(event.pointerId);
    });
    canvas.addEventListener("pointermove", (event) => {
      if (this._start) {
        this._end = this._surface.place(event);
        this.draw();
      } else {
        this._point(this._nearest(event));
      }
    });
    canvas.addEventListener("pointerup", () => this._zoomed());
    canvas.addEventListener("pointercancel", () => (this._start = this._end = undefined));
    canvas.addEventListener("pointerleave", () => this._point(undefined));
    canvas.addEventListener("dblclick", () => this._show(this._whole));
    canvas.addEventListener("keydown", (event) => this._key(event));
  }

  private _zoomed(): void {
    const [start, end] = [this._start, this._end];
    this._start = this._end = undefined;
    if (start && end && Math.abs(end[0] - start[0]) > 6 && Math.abs(end[1] - start[1]) > 6) {
      const { back } = this._maps();
      const [[xa, ya], [xb, yb]] = [back(...start), back(...end)];
      const along = (whole: [number, number], a: number, b: number): [number, number] => {
        const [low, high] = [Math.min(a, b), Math.max(a, b)];
        return whole[0] <= whole[1] ? [low, high] : [high, low];
      };
      this._show({ x: along(this._whole.x, xa, xb), y: along(this._whole.y, ya, yb) });
    } else {
      this.draw();
    }
  }

  private _show(box: Box): void {
    this._box = box;
    this.draw();
  }

  private _nearest(event: MouseEvent): { series: number; point: number } | undefined {
    const [px, py] = this._surface.place(event);
    const { x, y } = this._maps();
    let [best, found] = [NEAR * NEAR, undefined as { series: number; point: number } | undefined];
    this._series.forEach(({ x: xs, y: ys }, series) => {
      for (let point = 0; point < xs.length; point++) {
        const [dx, dy] = [x(xs[point] as number) - px, y(ys[point] as number) - py];
        if (dx * dx + dy * dy < best) {
          [best, found] = [dx * dx + dy * dy, { series, point }];
        }
      }
    });
    return found;
  }

  private _point(at: { series: number; point: number } | undefined): void {
    if (at?.series === this._at?.series && at?.point === this._at?.point) {
      return;
    }
    this._at = at;
    const series = at && this._series[at.series];
    if (at && series) {
      const [vx, vy] = [series.x[at.point] as number, series.y[at.point] as number];
      const name = series.data.label ? `${plain(series.data.label)}: ` : "";
      this._said.textContent = `${name}${valued(this._data.y, vy)} at ${valued(this._data.x, vx)}`;
      this.on_x?.(vx);
    } else {
      this._said.textContent = "";
    }
    this.draw();
  }

  private _key(event: KeyboardEvent): void {
    const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
    const other = { ArrowDown: 1, ArrowUp: -1 }[event.key];
    const factor = { "+": 0.7, "-": 1.4 }[event.key];
    if (event.ctrlKey || event.metaKey || !this._series.length) {
      return;
    }
    const at = this._at ?? { series: 0, point: -1 };
    if (step) {
      const count = this._series[at.series]?.x.length ?? 1;
      const by = step * (event.shiftKey ? Math.ceil(count / 20) : 1);
      this._point({ series: at.series, point: (at.point + by + count) % count });
    } else if (other) {
      this._point({ series: (at.series + other + this._series.length) % this._series.length, point: 0 });
    } else if (factor) {
      const around = ([a, b]: [number, number]): [number, number] => {
        const [middle, half] = [(a + b) / 2, ((b - a) / 2) * factor];
        return [middle - half, middle + half];
      };
      this._show({ x: this._data.x.log ? this._box.x : around(this._box.x), y: this._data.y.log ? this._box.y : around(this._box.y) });
    } else if (event.key === "0") {
      this._show(this._whole);
    } else {
      return;
    }
    event.preventDefault();
  }

  private _file(): string {
    return this._called().toLowerCase().replace(/[^a-z0-9]+/g, "_").slice(0, 60);
  }

  private _save_svg(): void {
    const { width, height } = this._surface;
    const text = drawn_svg(width, height, (pen) => this._framed(pen));
    save(`${this._file()}.svg`, text, "image/svg+xml");
  }

  /** Every series with its own x, with the seven digits that the page has. */
  private _save_csv(): void {
    const { x, y } = this._data;
    const digits = (values: ArrayLike<number>) => Array.from(values, (value) => Number(value.toPrecision(7)));
    const columns = this._series.flatMap(({ data, x: xs, y: ys }, k) => [
      { label: `${plain(data.label) || `series ${k + 1}`}: ${plain(x.label)}`, values: digits(xs) },
      { label: `${plain(data.label) || `series ${k + 1}`}: ${plain(y.label)}`, values: digits(ys) },
    ]);
    save(`${this._file()}.csv`, csv(columns), "text/csv");
  }
}

/** A colour of Python's figures, which are drawn for white paper, in this theme. */
export function shade(hex: string): string {
  if (!matchMedia("(prefers-color-scheme: dark)").matches) {
    return hex;
  }
  const [red, green, blue] = rgb(hex);
  const light = (0.3 * red + 0.6 * green + 0.1 * blue) / 255;
  const lift = (value: number) => Math.round(light > 0.8 ? 0.25 * value : value + (255 - value) * (light < 0.3 ? 0.7 : 0.45));
  return `rgb(${lift(red)} ${lift(green)} ${lift(blue)})`;
}

/** matplotlib's mathematics as far as our labels use it; `\$` is a dollar sign. */
export function plain(text: string): string {
  return text.replace(/\\\$|\$([^$]*)\$/g, (_, inner?: string) =>
    inner === undefined
      ? "$"
      : inner.replace(/\\sqrt\{([^}]*)\}/g, "√($1)").replace(/[_^]\{?(\w+)\}?/g, "$1").replace(/\\(\w+)/g, "$1"),
  );
}

function valued(axis: AxisData, value: number): string {
  const named = axis.ticks?.find(([at]) => Math.abs(at - value) < 1e-6);
  const unit = /\(([^()]+)\)\s*$/.exec(plain(axis.label));
  const name = plain(axis.label).replace(/\s*\([^()]+\)\s*$/, "");
  return named ? named[1] : `${name} ${number_text(value)}${unit ? ` ${unit[1]}` : ""}`;
}

function ticks(axis: AxisData, [first, last]: [number, number], most: number): [number, string][] {
  if (axis.ticks) {
    return axis.ticks;
  }
  const [low, high] = [Math.min(first, last), Math.max(first, last)];
  if (!axis.log) {
    return steps(low, high, Math.max(2, most)).map((at) => [at, String(at)]);
  }
  const found: [number, string][] = [];
  const decades = Math.log10(high / low);
  for (let power = Math.floor(Math.log10(low)); power <= Math.log10(high); power++) {
    for (const factor of decades > 3 ? [1] : [1, 2, 5]) {
      const at = factor * 10 ** power;
      if (at >= low && at <= high) {
        found.push([at, String(Number(at.toPrecision(3)))]);
      }
    }
  }
  return found;
}

function segment(pen: Pen, x0: number, y0: number, x1: number, y1: number): void {
  pen.beginPath();
  pen.moveTo(x0, y0);
  pen.lineTo(x1, y1);
  pen.stroke();
}

function draw_arrow(pen: Pen, paint: string, [x0, y0]: [number, number], [x1, y1]: [number, number]): void {
  const length = Math.hypot(x1 - x0, y1 - y0);
  if (!(length > 0)) {
    return;
  }
  const [ux, uy] = [(x1 - x0) / length, (y1 - y0) / length];
  const head = Math.min(9, length);
  pen.strokeStyle = pen.fillStyle = paint;
  pen.lineWidth = 1.8;
  segment(pen, x0, y0, x1 - ux * head * 0.7, y1 - uy * head * 0.7);
  pen.beginPath();
  pen.moveTo(x1, y1);
  pen.lineTo(x1 - ux * head - uy * head * 0.45, y1 - uy * head + ux * head * 0.45);
  pen.lineTo(x1 - ux * head + uy * head * 0.45, y1 - uy * head - ux * head * 0.45);
  pen.fill();
}
