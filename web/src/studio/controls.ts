// The parameters of a design: groups that open, each with its rows of slider, number and unit.
import { element, unit_of } from "../parts/page";
import { allowed, fits, groups, type Value, type Values, type Variable } from "./tables";

export interface ControlsOptions {
  variables: readonly Variable[];
  /** A value that was moved to; `done`: the move is over. */
  on_set: (name: string, value: Value | undefined, done: boolean) => void;
}

const STEPS = 1000;
const REACH = 5; // of a slider, times and over the present base value

/** Where a slider goes: within the range, around the base value if that is small in it. */
class Scale {
  private readonly low: number;
  private readonly high: number;
  private readonly even: boolean;

  constructor(private readonly variable: Variable, base: number) {
    const { minimum, maximum } = variable;
    const low = Number.isFinite(minimum) ? minimum : -1e6;
    const high = Number.isFinite(maximum) ? maximum : 1e6;
    if (base > 0 && base * REACH < high) {
      [this.low, this.high] = [Math.max(low, base / REACH), base * REACH];
      this.even = this.low <= 0;
      if (low > base / REACH) this.low = low;
    } else {
      [this.low, this.high, this.even] = [low, high, true];
    }
  }

  value(step: number): number {
    const share = step / STEPS;
    const raw = this.even || this.low <= 0 ? this.bent(share) : this.low * (this.high / this.low) ** share;
    const rounded = Number(raw.toPrecision(4));
    const { minimum, maximum, type } = this.variable;
    return Math.min(maximum, Math.max(minimum, type === "integer" ? Math.round(rounded) : rounded));
  }

  step(value: number): number {
    const share = this.even || this.low <= 0 ? this.unbent(value) : Math.log(value / this.low) / Math.log(this.high / this.low);
    return Math.round(STEPS * Math.min(1, Math.max(0, Number.isFinite(share) ? share : 0)));
  }

  /** Wide ranges through zero: fine in the middle. */
  private bent(share: number): number {
    if (this.low >= 0 || this.high <= 0) {
      return this.low + (this.high - this.low) * share ** (this.high - this.low > 1000 ? 3 : 1);
    }
    const from_middle = 2 * share - 1;
    return from_middle ** 3 * (from_middle < 0 ? -this.low : this.high);
  }

  private unbent(value: number): number {
    if (this.low >= 0 || this.high <= 0) {
      const share = (value - this.low) / (this.high - this.low);
      return this.high - this.low > 1000 ? Math.cbrt(share) : share;
    }
    return (1 + Math.cbrt(value / (value < 0 ? -this.low : this.high))) / 2;
  }
}

interface Row {
  show(value: Value, base: Value, changed: boolean): void;
  element: HTMLElement;
}

export class Controls {
  private readonly rows = new Map<string, Row>();
  private readonly find = element("input", { type: "search", placeholder: "find a parameter", "aria-label": "find a parameter", input: () => this.filter() });
  private readonly boxes: { box: HTMLDetailsElement; variables: Variable[]; body: HTMLElement; count: HTMLElement }[];
  private values: Values = {};
  private base: Values = {};
  private changes: Values = {};

  constructor(where: HTMLElement, private readonly options: ControlsOptions) {
    this.boxes = groups(options.variables).map(({ title, variables }) => {
      const [body, count] = [element("div"), element("span", { class: "note" })];
      const head = element("summary", {}, `${title} `, count);
      const box = element("details", { class: "group" }, head, body);
      box.addEventListener("toggle", () => box.open && this.fill(variables, body));
      return { box, variables, body, count };
    });
    where.append(element("p", {}, this.find), ...this.boxes.map(({ box }) => box));
  }

  /** Shows a design: all values, those without its changes, and the changes. */
  show(values: Values, base: Values, changes: Values): void {
    [this.values, this.base, this.changes] = [values, base, changes];
    for (const [name, row] of this.rows) this.update(name, row);
    for (const { variables, count } of this.boxes) {
      const number = variables.filter(({ name }) => name in changes).length;
      count.textContent = number > 0 ? `${variables.length}, ${number} changed` : `${variables.length}`;
    }
  }

  /** Opens the group of a parameter, and goes to it. */
  go_to(name: string): void {
    const found = this.boxes.find(({ variables }) => variables.some((variable) => variable.name === name));
    if (found) {
      this.fill(found.variables, found.body);
      found.box.open = true;
      this.rows.get(name)?.element.scrollIntoView({ block: "nearest" });
    }
  }

  private update(name: string, row: Row): void {
    row.show(this.values[name] ?? 0, this.base[name] ?? 0, name in this.changes);
  }

  private fill(variables: readonly Variable[], body: HTMLElement): void {
    for (const variable of variables) {
      if (!this.rows.has(variable.name)) {
        const row = this.row(variable);
        this.rows.set(variable.name, row);
        body.append(row.element);
        this.update(variable.name, row);
      }
    }
  }

  private filter(): void {
    const words = this.find.value.trim().toLowerCase();
    for (const { box, variables, body } of this.boxes) {
      const found = variables.filter(({ name, description }) => `${name} ${description}`.toLowerCase().includes(words));
      box.hidden = found.length === 0;
      if (words) {
        this.fill(found, body);
        box.open = found.length > 0;
      }
      for (const { name } of variables) {
        const row = this.rows.get(name);
        if (row) row.element.hidden = !found.some((one) => one.name === name);
      }
    }
  }

  private row(variable: Variable): Row {
    const { name } = variable;
    const id = `p-${name.replace(/[^\w]/g, "-")}`;
    const set = (value: Value | undefined, done: boolean) => this.options.on_set(name, value, done);
    const reset = element("button", { type: "button", class: "reset", click: () => set(undefined, true), "aria-label": `${name} back`, title: "back to what it was" }, "↺");
    const label = element("label", { for: id }, name.replace(/^testbed\.|^controller\./, ""));
    const about = element("p", { class: "note", id: `${id}-about` }, `${variable.description} (${allowed(variable)})`);
    const { parts, show } = this.inputs(variable, id, set);
    const row = element("div", { class: "parameter", "data-name": name }, label, ...parts, reset, about);
    return {
      element: row,
      show: (value, base, changed) => {
        row.classList.toggle("changed", changed);
        reset.disabled = !changed;
        show(value, base);
      },
    };
  }

  private inputs(variable: Variable, id: string, set: (value: Value | undefined, done: boolean) => void) {
    const { name, choices } = variable;
    const described = { "aria-describedby": `${id}-about` };
    if (variable.type === "boolean") {
      const box: HTMLInputElement = element("input", { id, type: "checkbox", ...described, change: () => set(box.checked, true) });
      return { parts: [box], show: (value: Value) => (box.checked = value === true) };
    }
    if (choices) {
      const options = choices.map((choice, i) => element("option", { value: i }, choice));
      const list: HTMLSelectElement = element("select", { id, ...described, change: () => set(Number(list.value), true) }, ...options);
      return { parts: [list], show: (value: Value) => (list.value = String(value)) };
    }
    let scale = new Scale(variable, 0);
    let last: Value = 0;
    const slider: HTMLInputElement = element("input", {
      type: "range", min: 0, max: STEPS, step: 1, "aria-label": `${name}, slider`,
      input: () => set(scale.value(Number(slider.value)), false), change: () => set(scale.value(Number(slider.value)), true),
    });
    const field: HTMLInputElement = element("input", {
      id, type: "text", inputmode: "decimal", autocomplete: "off", ...described,
      change: () => {
        const value = field.value.trim() === "" ? NaN : Number(field.value);
        field.setAttribute("aria-invalid", String(!fits(variable, value)));
        if (fits(variable, value)) set(value, true);
      },
    });
    const unit = element("span", { class: "unit" }, unit_of(variable.unit, ""));
    const show = (value: Value, base: Value) => {
      if (base !== last) [scale, last] = [new Scale(variable, Number(base)), base];
      if (document.activeElement !== slider) slider.value = String(scale.step(Number(value)));
      slider.setAttribute("aria-valuetext", `${value}${unit_of(variable.unit, " ")}`);
      if (document.activeElement !== field) {
        field.value = field.title = String(value);
        field.removeAttribute("aria-invalid");
      }
    };
    return { parts: [slider, field, unit], show };
  }
}
