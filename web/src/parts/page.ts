// What every page needs: its data, elements, and an answer when something fails.

export type Typed = Float64Array<ArrayBuffer> | Float32Array<ArrayBuffer> | Int32Array<ArrayBuffer> | Uint8Array<ArrayBuffer>;

/** The data that Python has filled in. */
export function data<T>(): T {
  return JSON.parse(document.getElementById("data")?.textContent ?? "null") as T;
}

export function from_base64(text: string): Uint8Array<ArrayBuffer> {
  return Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
}

/** An array as page.py packs it: "f8:" and base64. */
export function unpacked(text: string): Typed {
  const bytes = from_base64(text.slice(3)).buffer;
  switch (text.slice(0, 3)) {
    case "f8:":
      return new Float64Array(bytes);
    case "f4:":
      return new Float32Array(bytes);
    case "i4:":
      return new Int32Array(bytes);
    case "u1:":
      return new Uint8Array(bytes);
    default:
      throw new Error(`no array: ${text.slice(0, 20)}`);
  }
}

export type Attributes = Record<string, string | number | boolean | ((event: never) => void)>;

/** An element; functions among the attributes listen to events, true is an attribute without a value. */
export function element<K extends keyof HTMLElementTagNameMap>(
  tag: K, attributes: Attributes = {}, ...children: (Node | string)[]
): HTMLElementTagNameMap[K] {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (typeof value === "function") {
      made.addEventListener(name, value as EventListener);
    } else if (value !== false) {
      made.setAttribute(name, value === true ? "" : `${value}`);
    }
  }
  made.append(...children);
  return made;
}

/** Runs the page, and marks it ready; a failure is said on the page. */
export function start(main: () => void | Promise<void>): void {
  Promise.resolve()
    .then(main)
    .then(() => document.documentElement.setAttribute("data-ready", "true"), failed);
}

export function failed(error: unknown): void {
  const text = error instanceof Error ? error.message : String(error);
  const box = element("p", { role: "alert", class: "warning" }, `This page does not work here: ${text}`);
  (document.querySelector("main") ?? document.body).prepend(box);
}

/** A number as tables show it: fixed decimals, or as many as are worth it. */
export function shown(value: number | null | undefined, decimals?: number | null): string {
  if (value === null || value === undefined || Number.isNaN(value)) {
    return "–";
  }
  const size = Math.abs(value);
  if (decimals !== undefined && decimals !== null) {
    return value.toFixed(decimals);
  }
  if (size !== 0 && (size < 1e-3 || size >= 1e6)) {
    return value.toExponential(2);
  }
  return String(Number(value.toPrecision(4)));
}

/** "N" as a unit in brackets or after a comma; nothing for numbers without one. */
export const unit_of = (unit: string | undefined, before = ", "): string =>
  unit === undefined || unit === "" || unit === "1" ? "" : `${before}${unit.replace(/\./g, " ").replace(/2$/, "²")}`;

/** Calls at most once for every frame, with what was said last. */
export function each_frame<T extends unknown[]>(work: (...given: T) => void): (...given: T) => void {
  let last: T | undefined;
  return (...given: T) => {
    if (last === undefined) {
      requestAnimationFrame(() => {
        const now = last as T;
        last = undefined;
        work(...now);
      });
    }
    last = given;
  };
}

const dark = matchMedia("(prefers-color-scheme: dark)");
const colours = new Map<string, string>();
dark.addEventListener("change", () => colours.clear());

/** A colour of the theme, as it is now. */
export function theme(name: string): string {
  let colour = colours.get(name);
  if (colour === undefined) {
    colour = getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
    colours.set(name, colour);
  }
  return colour;
}

/** Calls when the system changes between light and dark. */
export function on_scheme(work: () => void): void {
  dark.addEventListener("change", work);
}
