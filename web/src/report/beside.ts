// A design beside the chosen one: both computed here, with their numbers, curves and motion.

import { engine } from "../engine/engine";
import { Curves, type Panel } from "../parts/curves";
import { element, unit_of } from "../parts/page";
import { csv, save } from "../parts/save";
import { Scene } from "../parts/scene";
import { compute, type Computed } from "./design_run";
import type { Marked } from "./scatter";
import { cell_text, in_unit, number_text, titled, type Limit, type Study } from "./study_data";

const [BEFORE_S, AFTER_S] = [0.02, 0.25]; // shown around the contact
const OF_TABLES = 1 | 2; // metrics of a collision and of a bumper's design, as giveway_batch.h numbers them

export class Beside {
  private readonly _head = element("h3", { tabindex: -1 });
  private readonly _said = element("p", { class: "note", role: "status" });
  private readonly _numbers = element("div", { class: "scroll", tabindex: 0, role: "region", "aria-label": "numbers" });
  private readonly _curves: Curves;
  private readonly _scene: Scene;
  private readonly _case: HTMLSelectElement;
  private readonly _whole = element("input", { type: "checkbox" });
  private _asked = 0;
  private _found: Computed[] = [];

  constructor(
    private readonly _where: HTMLElement,
    private readonly _study: Study,
    private readonly _marked: Marked,
    pick: (row: number) => void,
  ) {
    this._case = element("select", { "aria-label": "collision shown", change: () => void this.show() });
    _study.cases.forEach(({ name }, k) => this._case.append(element("option", { value: k }, name)));
    this._whole.addEventListener("change", () => this._draw());
    const out = element("button", { type: "button", click: () => this._save() }, "CSV");
    out.setAttribute("aria-label", "numbers of these designs as CSV");
    const controls = element("p", { class: "buttons" }, element("label", {}, this._whole, " the whole run"), out);
    if (_study.cases.length > 1) {
      controls.prepend(element("span", {}, "collision ", this._case));
    }
    for (const number of _study.data.best.slice(1)) {
      const click = () => pick(_study.row_of(number));
      controls.append(element("button", { type: "button", click }, `design ${number}`));
    }
    const scene = element("div");
    const curves = element("div");
    const moving = element("div", {}, scene, curves);
    _where.append(this._head, this._said, controls, element("div", { class: "side-by-side" }, moving, this._numbers));
    this._scene = new Scene(scene, { label: "The collision from above", height: 320 });
    const time = _study.data.time;
    this._curves = new Curves(curves, { x_label: "time since the contact", x_unit: time.unit, name: _study.data.name });
    this._scene.on_time = (time_s) => this._curves.cursor(this._shown_time(time_s));
    this._curves.on_cursor = (x) => x !== null && this._scene.seek(this._since_start(x));
  }

  /** Seconds since the contact in the unit of the curves; `scale` is that unit in ms. */
  private _in_unit(time_s: number): number {
    return (1000 * time_s) / this._study.data.time.scale;
  }

  private _shown_time(time_s: number): number {
    const one = this._found[0];
    return one ? this._in_unit(time_s + (one.time_s[0] ?? 0)) : 0;
  }

  private _since_start(x: number): number {
    const one = this._found[0];
    return one ? (x * this._study.data.time.scale) / 1000 - (one.time_s[0] ?? 0) : 0;
  }

  /** Computes and shows what is marked; a newer request replaces an older one. */
  async show(): Promise<void> {
    const asked = ++this._asked;
    const rows = [...new Set([this._marked.chosen, this._marked.picked])].filter((row) => row >= 0);
    const { chosen_words } = this._study.data;
    const names = rows.map((row) => `design ${this._study.number[row]}${row === this._marked.chosen ? `, ${chosen_words}` : ""}`);
    this._head.textContent = rows.length ? names.join("; beside it ") : "Click a design to compute it here";
    this._head.textContent = this._head.textContent.replace(/^d/, "D");
    this._said.textContent = rows.length ? "computing…" : "";
    const failed: string[] = [];
    const found: Computed[] = [];
    const with_it = await engine();
    const began = performance.now();
    const work = rows.map((row) => compute(with_it, this._study, Number(this._case.value), row));
    for (const [k, one] of (await Promise.allSettled(work)).entries()) {
      if (one.status === "fulfilled") {
        found.push(one.value);
      } else {
        failed.push(`Design ${this._study.number[rows[k] ?? -1]} cannot be computed: ${one.reason?.message ?? one.reason}`);
      }
    }
    if (asked !== this._asked) {
      return;
    }
    this._found = found;
    const took = performance.now() - began;
    this._said.textContent = [...failed, ...(found.length ? [this._check(found, took)] : [])].join(". ");
    this._where.dataset.shown = found.map((one) => this._study.number[one.row]).join(" ");
    this._where.dataset.same = found.map((one) => String(one.same)).join(" ");
    this._draw();
    this._table(with_it.library.metrics);
  }

  private _check(found: Computed[], took_ms: number): string {
    const words = `Computed in this page in ${took_ms.toFixed(0)} ms with the study's settings and method`;
    if (found.every((one) => one.same === true)) {
      return `${words}; what the study judges has the bits that it has stored.`;
    }
    const other = found.filter((one) => one.same === false).map((one) => this._study.number[one.row]);
    if (other.length) {
      return `${words}; of design ${other.join(" and ")} not all bits are those that the study has stored: another build, or Adams or BDF.`;
    }
    return `${words}; the study has stored no such run of one of them to compare with.`;
  }

  private _draw(): void {
    const found = this._found;
    if (!found.length) {
      this._curves.set([0, 1], []);
      this._scene.set([]);
      return;
    }
    const rows = this._window();
    const x = Float64Array.from(rows, (k) => this._in_unit(found[0]?.time_s[k] ?? NaN));
    this._curves.set(x, this._panels(rows));
    this._scene.set(found.map((one) => one.motion));
    this._scene.seek(-(found[0]?.time_s[0] ?? 0));
  }

  /** Rows of the first run around its contact, or all of them. */
  private _window(): number[] {
    const time = this._found[0]?.time_s ?? new Float64Array();
    const rows = Array.from(time, (_, k) => k);
    if (this._whole.checked) {
      return rows;
    }
    return rows.filter((k) => (time[k] ?? 0) >= -BEFORE_S && (time[k] ?? 0) <= AFTER_S);
  }

  private _panels(rows: number[]): Panel[] {
    const { force, time } = this._study.data;
    const limits = (some: Limit[]) => some.map(({ at, words }) => ({ label: words, value: at }));
    const curve = (name: string, scale: number) => (one: Computed) => {
      const values = one.run.traces[name] as Float64Array;
      const shift = this._shift(one);
      return rows.map((k) => in_unit(values[k + shift] ?? NaN, scale));
    };
    const tones = ["first", "second"] as const;
    const series = (name: string, scale: number) =>
      this._found.map((one, k) => {
        const values = curve(name, scale)(one);
        return { label: one.motion.title, values, tone: tones[k] ?? ("third" as const) };
      });
    const marks = [
      ...this._found.flatMap((one, k) => {
        const at = one.run.metrics["detection time"] ?? NaN;
        const tone = tones[k] ?? ("third" as const);
        return Number.isFinite(at) ? [{ label: `${one.motion.title} noticed`, x: in_unit(at, time.scale), tone }] : [];
      }),
      ...time.limits.map(({ at, words }) => ({ label: words, x: at, tone: "limit" as const })),
    ];
    const unnamed = marks.map((mark) => ({ ...mark, label: "" })); // the first panel says what they are
    return [
      {
        title: "contact force",
        unit: force.unit,
        series: series("testbed.truth.contact_force", force.scale),
        limits: limits(force.limits),
        marks,
      },
      { title: "estimated force", unit: force.unit, series: series("controller.estimate.force", force.scale), marks: unnamed },
      {
        title: "bumper compression",
        unit: "mm",
        series: series("testbed.truth.bumper_compression", 1e-3),
        marks: unnamed,
      },
      { title: "the robot gives way", unit: "mm", series: this._travel(rows, tones), marks: unnamed },
    ];
  }

  /** Rows by which a run's contact is later than that of the first one. */
  private _shift(one: Computed): number {
    const first = this._found[0];
    const step = (one.time_s[1] ?? 1) - (one.time_s[0] ?? 0);
    return Math.round(((first?.time_s[0] ?? 0) - (one.time_s[0] ?? 0)) / step);
  }

  private _travel(rows: number[], tones: readonly ("first" | "second")[]): Panel["series"] {
    return this._found.map((one, k) => {
      const [x, y] = ["x", "y"].map((axis) => one.run.traces[`testbed.truth.${axis}`] as Float64Array);
      const at = Math.max(0, one.time_s.findIndex((time) => time >= 0));
      const shift = this._shift(one);
      const values = rows.map((row) => {
        const [dx, dy] = [(x?.[row + shift] ?? NaN) - (x?.[at] ?? 0), (y?.[row + shift] ?? NaN) - (y?.[at] ?? 0)];
        return 1000 * Math.hypot(dx, dy);
      });
      return { label: one.motion.title, values, tone: tones[k] ?? "second" };
    });
  }

  private _lines(metrics: readonly { name: string; unit: string; decimals: number | null; shown: number; has_truth: boolean }[]) {
    return metrics.filter((metric) => metric.shown & OF_TABLES || this._study.data.runs.checked.includes(metric.name));
  }

  /** Quantities and metrics of both, and their difference. */
  private _table(metrics: Parameters<Beside["_lines"]>[0]): void {
    const found = this._found;
    if (!found.length) {
      this._numbers.replaceChildren();
      return;
    }
    const both = found.length > 1;
    const body = element("tbody");
    const line = (name: string, cells: string[]) =>
      body.append(element("tr", {}, element("th", { scope: "row" }, name), ...cells.map((text) => element("td", {}, text))));
    for (const column of this._study.columns.filter(({ role }) => role === "quantity")) {
      const values = found.map((one) => column.values[one.row] ?? NaN);
      const change = column.kind === "real" || column.kind === "integer" ? difference(values, null) : "";
      line(titled(column), [...found.map((one) => cell_text(column, one.row)), ...(both ? [change] : [])]);
    }
    for (const metric of this._lines(metrics)) {
      const values = found.map((one) => one.run.metrics[metric.name] ?? NaN);
      if (values.every(Number.isNaN)) {
        continue;
      }
      const cells = found.map((one, k) => {
        const truth = metric.has_truth ? (one.run.truths[metric.name] ?? NaN) : NaN;
        const text = fixed(values[k] ?? NaN, metric.decimals);
        return Number.isNaN(truth) ? text : `${text} (${fixed(truth, metric.decimals)})`;
      });
      line(`${metric.name}${unit_of(metric.unit)}`, [...cells, ...(both ? [difference(values, metric.decimals)] : [])]);
    }
    const names = [...found.map((one) => one.motion.title), ...(both ? ["difference"] : [])];
    const head = element("tr", {}, element("td"), ...names.map((text) => element("th", { scope: "col" }, text)));
    const caption = element("caption", {}, "Estimated or measured at nominal values; the true value in brackets.");
    this._numbers.replaceChildren(element("table", {}, caption, element("thead", {}, head), body));
  }

  /** Every metric with all of its digits. */
  private _save(): void {
    const names = Object.keys(this._found[0]?.run.metrics ?? {});
    const truths = Object.keys(this._found[0]?.run.truths ?? {});
    const columns = [
      { label: "metric", values: [...names, ...truths.map((name) => `${name} (true)`)] },
      ...this._found.map(({ motion, run }) => ({
        label: motion.title,
        values: [...names.map((name) => run.metrics[name] ?? NaN), ...truths.map((name) => run.truths[name] ?? NaN)],
      })),
    ];
    save("designs_metrics.csv", csv(columns), "text/csv");
  }
}

function fixed(value: number, decimals: number | null): string {
  return Number.isNaN(value) ? "-" : decimals === null ? value.toPrecision(2) : value.toFixed(decimals);
}

/** How much more the second one has, with as many decimals as both. */
function difference(values: number[], decimals: number | null): string {
  const [one = NaN, other = NaN] = values;
  const by = other - one;
  const text = decimals === null ? number_text(by) : by.toFixed(decimals);
  return Number(text) === 0 ? "0" : by > 0 ? `+${text}` : text;
}
