// The studio: choose, drag, see. Designs are computed while a slider moves.
import "./studio.css";
import { engine, Latest, type Engine } from "../engine/engine";
import { Curves } from "../parts/curves";
import { data, element, shown, start, theme, unit_of } from "../parts/page";
import { save } from "../parts/save";
import { Scene } from "../parts/scene";
import { outline_of, type Point } from "../parts/shapes";
import { Controls } from "./controls";
import { base_of, complete, DURATION, from_hash, History, HIT_LIMITS, start_design, to_hash, type Complete, type Design, type Hit } from "./design";
import { ssv, toml, traces_csv } from "./exports";
import { nearest, point_of } from "./hit";
import { lines, panels, shown_of, spec_of, type Shown } from "./results";
import type { Tables, Value } from "./tables";

interface State {
  designs: Design[];
  active: number;
}

const NAMES = ["A", "B"] as const;
const HIT_WORDS: Record<keyof Hit, string> = {
  around: "place around the outline", angle_deg: "angle from straight in", speed_mps: "speed at the contact",
  time_s: "time of the contact",
};
const LINK_AFTER_MS = 300;

class Studio {
  private readonly history: History<State>;
  private readonly scene: Scene;
  private readonly curves: Curves;
  private readonly controls: Controls;
  private readonly latest: Latest[];
  private readonly parts = parts_of(document);
  private readonly hit_fields = new Map<keyof Hit, HTMLInputElement>();
  private completes: (Complete | undefined)[] = [];
  private results: (Shown | undefined)[] = [];
  private moving = false;
  private faults: string[] = [];
  private link = 0;

  constructor(private readonly tables: Tables, private readonly engine: Engine) {
    this.history = new History<State>(this.from_address());
    this.latest = NAMES.map(() => new Latest(engine));
    this.scene = new Scene(this.parts.scene, { label: "The collision from above. Drag around the robot to move the hit; space plays." });
    this.scene.on_time = (time_s) => this.curves.cursor(1000 * time_s);
    this.scene.on_draw = (pen, index, scale) => this.draw_aim(pen, index, scale);
    this.curves = new Curves(this.parts.curves, { x_label: "time", x_unit: "ms", name: "giveway studio" });
    this.controls = new Controls(this.parts.parameters, {
      variables: tables.variables,
      on_set: (name, value, done) => this.set_parameter(name, value, done),
    });
    this.fill_choices();
    this.fill_hit();
    this.listen();
  }

  /** Computes and shows what the address says. */
  async open(): Promise<void> {
    await this.show();
    const detected = this.results.flatMap((one) => (one ? [one.motion.detected_s] : [])).find((time) => !Number.isNaN(time));
    this.scene.seek(detected === undefined ? 0 : detected + 0.01); // opens on something worth seeing
  }

  private get state(): State {
    return this.history.now;
  }

  private get design(): Design {
    return this.state.designs[this.state.active] as Design;
  }

  private from_address(): State {
    const { designs, refused } = from_hash(this.tables, location.hash);
    this.faults = refused;
    return { designs, active: 0 };
  }

  /** A change of the active design. `done`: it is over, the next one is one more to undo. */
  private change(part: Partial<Design>, done: boolean): void {
    const designs = this.state.designs.map((design, i) => (i === this.state.active ? { ...design, ...part } : design));
    this.set({ ...this.state, designs }, done);
  }

  private set(state: State, done: boolean): void {
    this.faults = [];
    this.history.set(state, !this.moving);
    this.moving = !done;
    void this.show();
  }

  private set_parameter(name: string, value: Value | undefined, done: boolean): void {
    const changes = { ...this.design.changes };
    if (value === undefined || (value === base_of(this.tables, this.design)[name] && !name.includes("slider."))) {
      delete changes[name];
    } else {
      changes[name] = value;
    }
    this.change({ changes }, done);
  }

  private set_hit(part: Partial<Hit>, done: boolean): void {
    // What was set by hand about the slider's rail gives way to the hit.
    const changes = { ...this.design.changes };
    for (const name of ["slider.direction", "slider.target_x", "slider.target_y", "slider.run_up", "slider.speed",
      "bumper.mount_x", "bumper.mount_y", "bumper.mount_azimuth"]) {
      delete changes[`testbed.${name}`];
    }
    this.change({ hit: { ...this.design.hit, ...part }, changes }, done);
  }

  /** Computes all designs that have changed, and shows them. */
  private async show(): Promise<void> {
    const { designs } = this.state;
    this.parts.curves.dataset.settled = "false";
    this.results.length = this.completes.length = designs.length;
    const jobs = designs.map((design, i) => (this.completes[i]?.design === design ? undefined : this.compute(design, i)));
    const found = await Promise.all(jobs);
    if (found.every((one) => one !== "overtaken")) this.redraw();
  }

  private async compute(design: Design, i: number): Promise<"shown" | "overtaken" | "refused"> {
    try {
      const whole = complete(this.tables, this.engine.library, design);
      this.completes[i] = whole;
      const run = await this.latest[i]?.run(spec_of(whole));
      if (!run || i >= this.state.designs.length) {
        return "overtaken";
      }
      this.results[i] = shown_of(whole, run, this.title(whole, i));
      return "shown";
    } catch (error) {
      if (this.state.designs[i] === design) {
        this.completes[i] = undefined;
        this.fault(`Design ${NAMES[i]}: ${error instanceof Error ? error.message : String(error)}`);
      }
      return "refused";
    }
  }

  private title({ design, settings }: Complete, i: number): string {
    const kind = this.tables.variables.find(({ name }) => name === "testbed.bumper.kind");
    const bumper = kind?.choices?.[Number(settings["testbed.bumper.kind"])];
    const robot = this.tables.robots[design.robot]?.title;
    const words = `${bumper === "none" ? "no" : bumper} bumper, ${robot}`;
    return this.state.designs.length > 1 ? `${NAMES[i]}: ${words}` : words;
  }

  private fault(text: string): void {
    this.faults.push(text);
    this.show_faults();
  }

  private show_faults(): void {
    this.parts.faults.hidden = this.faults.length === 0;
    this.parts.faults.textContent = this.faults.join("\n");
  }

  /** Everything but the curves, which come when they are computed. */
  private show_controls(): void {
    const { design, parts, state } = this;
    const whole = this.completes[state.active];
    const base = base_of(this.tables, design);
    this.controls.show(whole?.settings ?? { ...base, ...design.changes }, base, design.changes);
    parts.robot.value = design.robot;
    parts.preset.value = design.preset;
    parts.region.value = design.region;
    parts.duration.value = String(design.duration_s);
    parts.bumper.value = String(design.changes["testbed.bumper.kind"] ?? base["testbed.bumper.kind"]);
    const rope = (design.changes["testbed.rope.attached"] ?? base["testbed.rope.attached"]) === true;
    for (const [key, field] of this.hit_fields) {
      field.disabled = key === "time_s" && rope;
      if (document.activeElement !== field || field.type === "range") field.value = String(design.hit[key]);
      const text = `${shown(design.hit[key], key === "around" ? 3 : null)}${unit_of(HIT_LIMITS[key].unit, " ")}`;
      const output = field.nextElementSibling as HTMLOutputElement;
      output.value = key === "time_s" && rope ? "from the weight" : text;
      field.setAttribute("aria-valuetext", text);
    }
    parts.undo.disabled = !this.history.can_undo;
    parts.redo.disabled = !this.history.can_redo;
    parts.tabs.forEach((tab, i) => {
      tab.hidden = i >= state.designs.length;
      tab.setAttribute("aria-pressed", String(i === state.active));
    });
    parts.second.textContent = state.designs.length > 1 ? "Remove B" : "Compare with a second design";
    this.show_faults();
    clearTimeout(this.link);
    this.link = window.setTimeout(() => this.write_address(), LINK_AFTER_MS);
  }

  private write_address(): void {
    const text = `#${to_hash(this.tables, this.state.designs)}`;
    if (text !== location.hash) history.replaceState(null, "", text);
    const shown_now = this.completes.every((whole, i) => whole === undefined || this.results[i]?.complete === whole);
    this.parts.curves.dataset.settled = String(shown_now);
  }

  /** All that is shown, at once: a frame comes soon enough. */
  private redraw(): void {
    this.show_controls();
    const all = this.results.filter((one) => one !== undefined);
    if (all.length === 0) {
      return;
    }
    this.scene.set(all.map(({ motion }) => motion), this.dragging);
    const { x, panels: found } = panels(all);
    this.curves.set(x, found);
    this.show_numbers(all);
    // For tests and the benchmark: how often it was drawn; and `settled`: nothing is under way.
    this.parts.curves.dataset.drawn = String(Number(this.parts.curves.dataset.drawn ?? 0) + 1);
  }

  private show_numbers(all: readonly Shown[]): void {
    const found = lines(this.engine.library, all);
    const names = [all.length, ...found.map(({ name }) => name)].join("|");
    const { numbers } = this.parts;
    if (numbers.dataset.names !== names) {
      numbers.dataset.names = names;
      const heads = all.map((_, i) => element("th", { scope: "col" }, all.length > 1 ? `${NAMES[i]}` : "value"));
      const rows = found.map(({ name, unit, description }) =>
        element("tr", { title: description }, element("th", { scope: "row" }, `${name}${unit_of(unit)}`), ...all.map(() => element("td"))),
      );
      const head = element("thead", {}, element("tr", {}, element("th", { scope: "col" }, "quantity"), ...heads));
      const caption = element("caption", {}, "In brackets: the true value.");
      numbers.replaceChildren(caption, head, element("tbody", {}, ...rows));
    }
    found.forEach(({ decimals, values, truths }, line) => {
      const cells = numbers.tBodies[0]?.rows[line]?.cells;
      values.forEach((value, i) => {
        const truth = truths[i] ?? NaN;
        const text = `${shown(value, decimals)}${Number.isNaN(truth) ? "" : ` (${shown(truth, decimals)})`}`;
        const cell = cells?.[i + 1];
        if (cell && cell.textContent !== text) cell.textContent = text;
      });
    });
  }

  // The hit, on the canvas.

  private dragging = false;

  private draw_aim(pen: CanvasRenderingContext2D, index: number, scale: number): void {
    const whole = this.completes[index];
    if (!whole) {
      return;
    }
    const { settings, design } = whole;
    const of = (name: string) => Number(settings[`testbed.start.${name}`]);
    const { point } = point_of(outline_of(settings), design.hit.around);
    const [c, s] = [Math.cos(of("theta")), Math.sin(of("theta"))];
    pen.beginPath();
    pen.arc(of("x") + c * point[0] - s * point[1], of("y") + s * point[0] + c * point[1], 9 / scale, 0, 7);
    pen.strokeStyle = theme("accent");
    pen.setLineDash([4 / scale, 3 / scale]);
    pen.lineWidth = 1.5 / scale;
    pen.stroke();
    pen.setLineDash([]);
  }

  private drag(event: PointerEvent, done: boolean): void {
    const whole = this.completes[this.state.active];
    if (!whole) {
      return;
    }
    const { settings } = whole;
    const at = this.scene.floor(event.clientX, event.clientY);
    const [dx, dy] = [at[0] - Number(settings["testbed.start.x"]), at[1] - Number(settings["testbed.start.y"])];
    const theta = Number(settings["testbed.start.theta"]);
    const [c, s] = [Math.cos(theta), Math.sin(theta)];
    const base: Point = [c * dx + s * dy, c * dy - s * dx];
    this.set_hit({ around: Number(nearest(outline_of(settings), base).toFixed(4)) }, done);
  }

  private listen(): void {
    const { canvas } = this.scene;
    const { parts } = this;
    canvas.addEventListener("pointerdown", (event) => {
      if (event.button !== 0) {
        return;
      }
      this.scene.pause();
      this.dragging = true;
      canvas.setPointerCapture(event.pointerId);
      const cell = canvas.clientWidth / Math.max(1, this.state.designs.length);
      const index = Math.min(this.state.designs.length - 1, Math.floor((event.clientX - canvas.getBoundingClientRect().left) / cell));
      if (index !== this.state.active) this.choose(index);
      this.drag(event, false);
    });
    canvas.addEventListener("pointermove", (event) => this.dragging && this.drag(event, false));
    const end = (event: PointerEvent) => {
      if (this.dragging) {
        this.dragging = false;
        this.drag(event, true);
      }
    };
    canvas.addEventListener("pointerup", end);
    canvas.addEventListener("pointercancel", end);
    parts.undo.addEventListener("click", () => this.undo());
    parts.redo.addEventListener("click", () => this.redo());
    document.addEventListener("keydown", (event) => {
      const text = event.target instanceof HTMLInputElement && event.target.type === "text";
      if ((event.ctrlKey || event.metaKey) && !text && "zZyY".includes(event.key)) {
        if (event.key.toLowerCase() === "y" || event.shiftKey) this.redo();
        else this.undo();
        event.preventDefault();
      }
    });
    parts.tabs.forEach((tab, i) => tab.addEventListener("click", () => this.choose(i)));
    parts.second.addEventListener("click", () => this.second());
    parts.again.addEventListener("click", () => this.set({ designs: [start_design(this.tables)], active: 0 }, true));
    parts.toml.addEventListener("click", () => this.export((whole) => [toml(this.tables, whole, to_hash(this.tables, [whole.design])), "toml", "application/toml"]));
    parts.ssv.addEventListener("click", () => this.export((whole) => [ssv(this.tables, whole), "ssv", "application/xml"]));
    parts.csv.addEventListener("click", () => this.export((_, { run }) => [traces_csv(run, (name) => this.unit(name)), "csv", "text/csv"]));
    addEventListener("hashchange", () => {
      const state = this.from_address();
      this.history.set(state, true);
      void this.show();
    });
  }

  private unit(name: string): string {
    return this.tables.traces[name] ?? "";
  }

  private export(write: (whole: Complete, result: Shown) => [string, string, string]): void {
    const result = this.results[this.state.active];
    const whole = this.completes[this.state.active];
    if (result && whole && result.complete === whole) {
      const [text, ending, mime] = write(whole, result);
      save(`studio${this.state.designs.length > 1 ? `_${NAMES[this.state.active]}` : ""}.${ending}`, text, mime);
    }
  }

  private undo(): void {
    this.history.undo();
    this.moving = false;
    void this.show();
  }

  private redo(): void {
    this.history.redo();
    this.moving = false;
    void this.show();
  }

  private choose(active: number): void {
    this.history.set({ ...this.state, active }, false);
    this.show_controls();
  }

  private second(): void {
    const [first] = this.state.designs as [Design];
    const two = this.state.designs.length > 1;
    this.completes.length = this.results.length = 0; // their titles change
    this.set(two ? { designs: [first], active: 0 } : { designs: [first, { ...first }], active: 1 }, true);
  }

  // What stands on the page once.

  private fill_choices(): void {
    const { parts, tables } = this;
    const options = (list: HTMLSelectElement, all: readonly (readonly [string, string])[]) =>
      list.append(...all.map(([value, words]) => element("option", { value }, words)));
    options(parts.robot, Object.entries(tables.robots).map(([name, { title }]) => [name, title]));
    const kinds = tables.variables.find(({ name }) => name === "testbed.bumper.kind")?.choices ?? [];
    options(parts.bumper, kinds.map((kind, i) => [String(i), kind]));
    options(parts.preset, [["default", "default"], ["paper", "of the paper"]]);
    options(parts.region, [["", "no limits"], ...tables.regions.map(({ name }): [string, string] => [name, name])]);
    parts.robot.addEventListener("change", () => this.change({ robot: parts.robot.value }, true));
    parts.preset.addEventListener("change", () => this.change({ preset: parts.preset.value as Design["preset"] }, true));
    parts.region.addEventListener("change", () => this.change({ region: parts.region.value }, true));
    parts.bumper.addEventListener("change", () => this.set_parameter("testbed.bumper.kind", Number(parts.bumper.value), true));
    parts.duration.addEventListener("change", () => {
      const value = Number(parts.duration.value);
      if (value >= DURATION.low && value <= DURATION.high) {
        this.change({ duration_s: value }, true);
      } else {
        this.fault(`duration = ${parts.duration.value} is not allowed: a number from ${DURATION.low} to ${DURATION.high} s`);
      }
    });
  }

  private fill_hit(): void {
    const steps: Record<keyof Hit, number> = { around: 0.001, angle_deg: 1, speed_mps: 0.01, time_s: 0.01 };
    for (const key of Object.keys(HIT_LIMITS) as (keyof Hit)[]) {
      const { low, high } = HIT_LIMITS[key];
      const field: HTMLInputElement = element("input", {
        id: `hit-${key}`, type: "range", min: low, max: key === "around" ? 0.999 : high, step: steps[key],
        input: () => this.set_hit({ [key]: Number(field.value) }, false), change: () => this.set_hit({ [key]: Number(field.value) }, true),
      });
      this.hit_fields.set(key, field);
      const label = element("label", { for: `hit-${key}` }, HIT_WORDS[key]);
      this.parts.hit.append(element("div", { class: "parameter" }, label, field, element("output", { for: `hit-${key}` })));
    }
  }
}

/** The elements of the page, by their ids. */
function parts_of(page: Document) {
  const by = <T extends HTMLElement>(id: string) => page.getElementById(id) as T;
  return {
    scene: by("scene"), curves: by("curves"), parameters: by("parameters"), hit: by("hit"), numbers: by<HTMLTableElement>("numbers"),
    faults: by("faults"), robot: by<HTMLSelectElement>("robot"), bumper: by<HTMLSelectElement>("bumper"),
    preset: by<HTMLSelectElement>("preset"), region: by<HTMLSelectElement>("region"), duration: by<HTMLInputElement>("duration"),
    undo: by<HTMLButtonElement>("undo"), redo: by<HTMLButtonElement>("redo"), second: by<HTMLButtonElement>("second"),
    again: by<HTMLButtonElement>("again"), toml: by<HTMLButtonElement>("toml"), ssv: by<HTMLButtonElement>("ssv"),
    csv: by<HTMLButtonElement>("csv"), tabs: NAMES.map((name) => by<HTMLButtonElement>(`design-${name}`)),
  };
}

start(async () => {
  const studio = new Studio(data<Tables>(), await engine());
  await studio.open();
});
