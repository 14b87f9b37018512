// Curves over one common axis: panels of series with zoom, values under the pointer, limits, marks, SVG and CSV.
import uPlot from "uplot";
import { element, on_scheme, shown, theme, unit_of } from "./page";
import { csv, save } from "./save";
import { curve_svg } from "./curve_svg";

/** Colours of the theme, by what they mean. */
export type Tone = "truth" | "estimate" | "limit" | "first" | "second" | "third" | "fourth" | "quiet";

export interface Series {
  label: string;
  values: ArrayLike<number>;
  tone: Tone;
  dash?: boolean;
}

export interface Panel {
  title: string;
  unit: string;
  /** The axis need not show its zero. */
  free?: boolean;
  series: Series[];
  /** Horizontal lines that name a value. */
  limits?: { label: string; value: number }[];
  /** Vertical lines, named below the plot. */
  marks?: { label: string; x: number; tone?: Tone }[];
}

export interface CurvesOptions {
  x_label: string;
  x_unit: string;
  /** What files of it are called. */
  name: string;
  height?: number;
}

const DASH = [6, 4];
const HEIGHT = 190;
const QUIET_MS = 200; // nobody listens to a description while it changes
let groups = 0;

/** Panels one below or beside the other; the pointer's line and the zoom are common. */
export class Curves {
  /** Hears where the pointer is on the axis; nothing when it has left. */
  on_cursor: ((x: number | null) => void) | undefined;
  private readonly box: HTMLElement;
  private readonly group: string;
  private x: ArrayLike<number> = [];
  private panels: Panel[] = [];
  private drawn: Drawn[] = [];
  private now: number | null = null;
  private zoomed: [number, number] | null = null;
  private setting = false;

  constructor(where: HTMLElement, readonly options: CurvesOptions) {
    this.box = element("div", { class: "curves" });
    this.group = `curves ${groups++}`;
    where.append(this.box);
    on_scheme(() => this.rebuild());
    new ResizeObserver(() => this.resize()).observe(this.box);
  }

  /** Shows these; quick if panels and series are called as before. */
  set(x: ArrayLike<number>, panels: Panel[]): void {
    const same = panels.length === this.drawn.length && panels.every((panel, i) => this.drawn[i]?.fits(panel));
    this.x = x;
    this.panels = panels;
    if (!same) {
      this.rebuild();
      return;
    }
    this.setting = true;
    panels.forEach((panel, i) => this.drawn[i]?.show(x, panel, this.zoomed));
    this.setting = false;
    this.place();
  }

  /** Puts a line at a moment; nothing takes it away. */
  cursor(x: number | null): void {
    this.now = x;
    this.place();
  }

  /** Zooms all panels; nothing shows all. */
  zoom(range: [number, number] | null): void {
    if (this.setting) {
      return;
    }
    this.setting = true;
    this.zoomed = range;
    this.drawn.forEach((one) => one.zoom(range, this.x));
    this.setting = false;
    this.place();
  }

  private place(): void {
    this.drawn.forEach((one) => one.place(this.now));
  }

  private resize(): void {
    this.drawn.forEach((one) => one.resize());
    this.place();
  }

  private rebuild(): void {
    this.drawn.forEach((one) => one.end());
    this.box.replaceChildren();
    this.drawn = this.panels.map((panel) => new Drawn(this.box, panel, this.x, this.options, this.group, this));
    this.setting = true;
    this.drawn.forEach((one) => one.zoom(this.zoomed, this.x));
    this.setting = false;
    this.resize(); // the first one had the room of all
  }
}

/** What is not known is null to uPlot. */
function with_gaps(values: ArrayLike<number>): ArrayLike<number | null> {
  for (let i = 0; i < values.length; i++) {
    if (Number.isNaN(values[i])) {
      return Array.from(values, (value) => (Number.isNaN(value) ? null : value));
    }
  }
  return values;
}

/** One panel. */
class Drawn {
  private readonly plot: uPlot;
  private readonly figure: HTMLElement;
  private readonly area: HTMLElement;
  private readonly now = element("div", { class: "now", hidden: true });
  private readonly moments = element("p", { class: "moments" });
  private readonly seen: IntersectionObserver;
  private in_view = true;
  /** What is to be drawn when the panel comes into view. */
  private late: (() => void) | undefined;
  private described = 0;

  constructor(
    where: HTMLElement, private panel: Panel, private x: ArrayLike<number>, private readonly options: CurvesOptions,
    group: string, private readonly all: Curves,
  ) {
    this.area = element("div", { tabindex: 0, role: "img", keydown: (event: KeyboardEvent) => this.key(event) });
    const buttons = element(
      "span", { class: "buttons" },
      element("button", { type: "button", click: () => this.save_svg(), "aria-label": `${panel.title} as SVG` }, "SVG"),
      element("button", { type: "button", click: () => this.save_csv(), "aria-label": `${panel.title} as CSV` }, "CSV"),
    );
    const title = element("span", {}, `${panel.title}${unit_of(panel.unit)}`);
    this.figure = element("figure", { class: "curve" }, element("figcaption", {}, title, buttons), this.area, this.moments);
    where.append(this.figure);
    this.plot = new uPlot(this.plot_options(group), this.columns(), this.area);
    this.plot.over.append(this.now);
    this.describe();
    this.seen = new IntersectionObserver((entries) => this.came(entries.at(-1)?.isIntersecting ?? true), { rootMargin: "80px" });
    this.seen.observe(this.figure);
  }

  private came(in_view: boolean): void {
    this.in_view = in_view;
    if (in_view) {
      this.late?.();
      this.late = undefined;
    }
  }

  fits(panel: Panel): boolean {
    const names = (one: Panel) => [one.title, one.unit, ...one.series.map((s) => `${s.label} ${s.tone} ${s.dash}`)].join("|");
    return names(panel) === names(this.panel);
  }

  show(x: ArrayLike<number>, panel: Panel, zoomed: [number, number] | null): void {
    this.panel = panel;
    this.x = x;
    this.late = () => {
      this.plot.setData(this.columns(), zoomed === null);
      if (zoomed !== null) {
        this.plot.setScale("x", { min: zoomed[0], max: zoomed[1] });
      }
    };
    this.came(this.in_view);
    clearTimeout(this.described);
    this.described = window.setTimeout(() => this.describe(), QUIET_MS);
  }

  zoom(range: [number, number] | null, x: ArrayLike<number>): void {
    this.late?.();
    this.late = undefined;
    const [min, max] = range ?? [x[0] ?? 0, x[x.length - 1] ?? 1];
    this.plot.setScale("x", { min, max });
  }

  place(x: number | null): void {
    const at = x === null ? NaN : this.plot.valToPos(x, "x");
    const hidden = !(at >= 0 && at <= this.plot.bbox.width / (devicePixelRatio || 1));
    if (this.now.hidden !== hidden) this.now.hidden = hidden;
    if (!hidden) this.now.style.transform = `translateX(${at}px)`;
  }

  resize(): void {
    this.plot.setSize({ width: this.width(), height: this.options.height ?? HEIGHT });
  }

  end(): void {
    this.seen.disconnect();
    clearTimeout(this.described);
    this.plot.destroy();
  }

  private width(): number {
    return Math.max(200, Math.floor(this.area.clientWidth || 380));
  }

  private columns(): uPlot.AlignedData {
    return [this.x, ...this.panel.series.map(({ values }) => with_gaps(values))] as unknown as uPlot.AlignedData;
  }

  private plot_options(group: string): uPlot.Options {
    const axis = { stroke: theme("quiet"), grid: { stroke: theme("grid"), width: 1 }, ticks: { stroke: theme("line"), width: 1 } };
    const font = "12px system-ui, sans-serif";
    const { x_label, x_unit } = this.options;
    return {
      width: this.width(),
      height: this.options.height ?? HEIGHT,
      scales: { x: { time: false }, y: { range: (_, low, high) => this.range(low, high) } },
      cursor: { sync: { key: group }, drag: { x: true, y: false, setScale: true }, points: { size: 6 } },
      axes: [
        { ...axis, font, label: `${x_label}${unit_of(x_unit)}`, labelFont: font, labelSize: 20, size: 28 },
        { ...axis, font, size: 54, values: (_, ticks) => ticks.map((tick) => String(Number(tick.toPrecision(6)))) },
      ],
      series: [
        { label: x_label, value: (_, value) => (value === null ? "–" : `${shown(value)}${unit_of(x_unit, " ")}`) },
        ...this.panel.series.map((series): uPlot.Series => ({
          label: series.label,
          stroke: theme(series.tone),
          width: 1.6,
          dash: series.dash ? DASH : undefined,
          points: { show: false },
          value: (_, value) => (value === null ? "–" : `${shown(value)}${unit_of(this.panel.unit, " ")}`),
        })),
      ],
      legend: { live: true, isolate: false, markers: { show: true } },
      hooks: {
        draw: [(plot) => this.lines(plot)],
        setCursor: [(plot) => this.all.on_cursor?.(plot.cursor.left! >= 0 ? plot.posToVal(plot.cursor.left!, "x") : null)],
        setScale: [(plot, key) => key === "x" && this.told(plot)],
      },
    };
  }

  /** A zoom of this panel is that of all. */
  private told(plot: uPlot): void {
    const { min, max } = plot.scales.x ?? {};
    if (min === undefined || max === undefined || min === null || max === null) {
      return;
    }
    const whole = min <= (this.x[0] ?? 0) && max >= (this.x[this.x.length - 1] ?? 1);
    this.all.zoom(whole ? null : [min, max]);
  }

  /** Room for every curve; limits that are near are in view, too. */
  private range(low: number | null, high: number | null): [number, number] {
    let [from, to] = [low ?? 0, high ?? 1];
    if (!this.panel.free) [from, to] = [Math.min(from, 0), Math.max(to, 0)];
    for (const { value } of this.panel.limits ?? []) {
      if (value <= 2.5 * to && value >= 2.5 * from) {
        [from, to] = [Math.min(from, value), Math.max(to, value)];
      }
    }
    const room = 0.06 * (to - from || 1);
    return [from < 0 || this.panel.free ? from - room : from, to + room];
  }

  private lines(plot: uPlot): void {
    const { ctx, bbox } = plot;
    const ratio = devicePixelRatio || 1;
    ctx.save();
    ctx.beginPath();
    ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
    ctx.clip();
    ctx.font = `${11 * ratio}px system-ui, sans-serif`;
    ctx.lineWidth = 1.2 * ratio;
    const stroke = (from: [number, number], to: [number, number], colour: string, dash: number[]) => {
      ctx.strokeStyle = ctx.fillStyle = colour;
      ctx.setLineDash(dash.map((length) => length * ratio));
      ctx.beginPath();
      ctx.moveTo(...from);
      ctx.lineTo(...to);
      ctx.stroke();
    };
    for (const { label, value } of this.panel.limits ?? []) {
      const y = plot.valToPos(value, "y", true);
      stroke([bbox.left, y], [bbox.left + bbox.width, y], theme("limit"), [8, 4]);
      ctx.textAlign = "right";
      const above = y - bbox.top > 16 * ratio;
      ctx.fillText(label, bbox.left + bbox.width - 4 * ratio, above ? y - 4 * ratio : y + 13 * ratio);
    }
    for (const { x, tone } of this.panel.marks ?? []) {
      const at = plot.valToPos(x, "x", true);
      stroke([at, bbox.top], [at, bbox.top + bbox.height], theme(tone ?? "quiet"), [3, 3]);
    }
    ctx.restore();
  }

  /** For those who do not see it: what is shown, and between which values it runs. */
  private describe(): void {
    const ranges = this.panel.series.map(({ label, values }) => {
      let [low, high] = [Infinity, -Infinity];
      for (let i = 0; i < values.length; i++) {
        const value = values[i] as number;
        if (value < low) low = value;
        if (value > high) high = value;
      }
      return low > high ? `${label} not known` : `${label} ${shown(low)} to ${shown(high)}${unit_of(this.panel.unit, " ")}`;
    });
    const limits = (this.panel.limits ?? []).map(({ label }) => label);
    const how = "Arrow keys move the line, plus and minus zoom, 0 shows all.";
    const unit = unit_of(this.options.x_unit, " ");
    const moments = (this.panel.marks ?? []).map(({ label, x }) => `${label} at ${shown(x)}${unit}`).join(", ");
    this.moments.textContent = moments && `Vertical lines: ${moments}.`;
    this.area.setAttribute("aria-label", `${this.panel.title}: ${[...ranges, ...limits].join("; ")}. ${how}`);
  }

  private key(event: KeyboardEvent): void {
    const { plot } = this;
    const [left, width] = [plot.cursor.left ?? -1, plot.over.clientWidth];
    const step = width / (event.shiftKey ? 10 : 100);
    const [min, max] = [plot.scales.x?.min ?? 0, plot.scales.x?.max ?? 1];
    const middle = left >= 0 ? plot.posToVal(left, "x") : (min + max) / 2;
    const zoom = (share: number) => this.all.zoom([middle - (middle - min) * share, middle + (max - middle) * share]);
    const move = (by: number) => {
      const to = Math.min(width, Math.max(0, (left < 0 ? width / 2 : left) + by));
      plot.setCursor({ left: to, top: plot.over.clientHeight / 2 });
    };
    const done: Record<string, () => void> = {
      ArrowLeft: () => move(-step), ArrowRight: () => move(step), "+": () => zoom(0.7), "-": () => zoom(1.4),
      "0": () => this.all.zoom(null),
    };
    if (done[event.key] && !event.ctrlKey && !event.metaKey) {
      done[event.key]?.();
      event.preventDefault();
    }
  }

  private file(): string {
    return `${this.options.name} ${this.panel.title}`.toLowerCase().replace(/[^a-z0-9]+/g, "_");
  }

  private save_csv(): void {
    const x = { label: this.options.x_label, unit: this.options.x_unit, values: this.x };
    const rest = this.panel.series.map(({ label, values }) => ({ label, unit: this.panel.unit, values }));
    save(`${this.file()}.csv`, csv([x, ...rest]), "text/csv");
  }

  private save_svg(): void {
    const { min, max } = this.plot.scales.x ?? {};
    const { min: low, max: high } = this.plot.scales.y ?? {};
    const box = { x: [min ?? 0, max ?? 1], y: [low ?? 0, high ?? 1] } as const;
    save(`${this.file()}.svg`, curve_svg(this.x, this.panel, this.options, box), "image/svg+xml");
  }
}
