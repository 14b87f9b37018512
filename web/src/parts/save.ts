// Files that a page gives away.
import { element } from "./page";

/** Offers `content` as a download. */
export function save(name: string, content: string | Blob, mime: string): void {
  const url = URL.createObjectURL(content instanceof Blob ? content : new Blob([content], { type: mime }));
  const link = element("a", { href: url, download: name });
  document.body.append(link);
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(url), 1000);
}

export interface Column {
  label: string;
  unit?: string;
  values: ArrayLike<number | string>;
}

/** A table of columns; every number with all of its digits. */
export function csv(columns: readonly Column[]): string {
  const cell = (text: string) => (/[",\n]/.test(text) ? `"${text.replace(/"/g, '""')}"` : text);
  const head = columns.map(({ label, unit }) => cell(unit && unit !== "1" ? `${label} [${unit}]` : label));
  const rows = Math.max(0, ...columns.map(({ values }) => values.length));
  const lines = Array.from({ length: rows }, (_, k) =>
    columns.map(({ values }) => {
      const value = values[k];
      return value === undefined || Number.isNaN(value) ? "" : cell(String(value));
    }).join(","),
  );
  return [head.join(","), ...lines, ""].join("\n");
}
