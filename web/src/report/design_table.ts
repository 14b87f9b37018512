// The selected designs as a table, page by page: sorts by its heads, a row shows its design.

import { element } from "../parts/page";
import { csv, save, type Column as CsvColumn } from "../parts/save";
import type { Marked } from "./scatter";
import type { Selection } from "./selection";
import { cell_text, FRONT, titled, type Study } from "./study_data";

const PAGE = 15;

interface Head {
  label: string;
  text: (row: number) => string;
  /** Sorts; NaN comes last. */
  value: (row: number) => number;
}

export class DesignTable {
  private readonly _heads: Head[];
  private readonly _cells: { line: HTMLTableRowElement; cells: HTMLElement[]; row: number }[] = [];
  private readonly _titles: HTMLTableCellElement[] = [];
  private readonly _said = element("span", { role: "status" });
  private readonly _found = element("input", { type: "search", placeholder: "find", "aria-label": "find designs" });
  private readonly _buttons: HTMLButtonElement[];
  /** Rows as they are sorted, and those of them that are shown. */
  private _sorted: Int32Array;
  private _shown: Int32Array;
  private _by = { head: -1, sign: 1 };
  private _first = 0;

  constructor(
    where: HTMLElement,
    private readonly _study: Study,
    private readonly _selection: Selection,
    private readonly _marked: Marked,
    private readonly _pick: (row: number) => void,
  ) {
    this._heads = heads_of(_study);
    this._sorted = this._shown = by_rank(_study);
    const body = element("tbody");
    for (let k = 0; k < Math.min(PAGE, _study.count); k++) {
      body.append(this._line());
    }
    const titles = this._heads.map((head, k) => {
      const title = element("th", { scope: "col" }, element("button", { type: "button", click: () => this._sort(k) }, head.label));
      this._titles.push(title);
      return title;
    });
    const table = element("table", { class: "designs" }, element("thead", {}, element("tr", {}, ...titles)), body);
    const move = (words: string, by: () => number) =>
      element("button", { type: "button", click: () => this._go(by()) }, words);
    this._buttons = [move("Previous", () => this._first - PAGE), move("Next", () => this._first + PAGE)];
    const out = element("button", { type: "button", click: () => this._save() }, "CSV");
    out.setAttribute("aria-label", "selected designs as CSV");
    this._found.addEventListener("input", () => this._choose(true));
    where.replaceChildren(
      element("p", { class: "buttons" }, this._found, ...this._buttons, this._said, out),
      element("div", { class: "scroll", tabindex: 0, role: "region", "aria-label": "selected designs" }, table),
    );
    _selection.on_change(() => this._choose(true));
    this._choose(true);
  }

  /** Marks the designs that are shown below. */
  mark(): void {
    this._write();
  }

  private _line(): HTMLTableRowElement {
    const cells = this._heads.map((_, k) => element(k ? "td" : "th", k ? {} : { scope: "row" }));
    const line = element("tr", { tabindex: 0 }, ...cells);
    const one = { line, cells, row: -1 };
    line.addEventListener("click", () => one.row >= 0 && this._pick(one.row));
    line.addEventListener("keydown", (event) => event.key === "Enter" && one.row >= 0 && this._pick(one.row));
    this._cells.push(one);
    return line;
  }

  private _sort(head: number): void {
    const sign = this._by.head === head ? -this._by.sign : 1;
    this._by = { head, sign };
    this._titles.forEach((title, k) => {
      title.removeAttribute("aria-sort");
      if (k === head) {
        title.setAttribute("aria-sort", sign > 0 ? "ascending" : "descending");
      }
    });
    const value = this._heads[head]?.value ?? (() => 0);
    const keys = Float64Array.from({ length: this._study.count }, (_, row) => value(row));
    this._sorted = this._sorted.slice().sort((a, b) => {
      const [one, other] = [keys[a] ?? NaN, keys[b] ?? NaN];
      if (Number.isNaN(one) || Number.isNaN(other)) {
        return Number(Number.isNaN(one)) - Number(Number.isNaN(other));
      }
      return sign * (one - other) || 0;
    });
    this._choose(true);
  }

  private _choose(from_start: boolean): void {
    const { mask } = this._selection;
    const words = this._found.value.trim().toLowerCase();
    this._shown = this._sorted.filter((row) => mask[row] === 1);
    if (words) {
      this._shown = this._shown.filter((row) => this._heads.some((head) => head.text(row).toLowerCase().includes(words)));
    }
    this._first = from_start ? 0 : this._first;
    this._write();
  }

  private _go(first: number): void {
    this._first = Math.max(0, Math.min(first, this._shown.length - 1));
    this._write();
  }

  private _write(): void {
    const { _first: first, _shown: shown } = this;
    this._cells.forEach((one, k) => {
      const row = shown[first + k];
      one.line.hidden = row === undefined;
      one.row = row ?? -1;
      if (row !== undefined) {
        one.cells.forEach((cell, j) => {
          const text = this._heads[j]?.text(row) ?? "";
          if (cell.textContent !== text) {
            cell.textContent = text;
          }
        });
        one.line.classList.toggle("chosen", row === this._marked.chosen);
        one.line.setAttribute("aria-selected", String(row === this._marked.picked));
      }
    });
    const last = Math.min(first + PAGE, shown.length);
    const all = this._study.count.toLocaleString("en");
    const selected = shown.length.toLocaleString("en");
    this._said.textContent = shown.length
      ? `${(first + 1).toLocaleString("en")} to ${last.toLocaleString("en")} of ${selected} selected; ${all} in all`
      : `none of ${all} designs is selected`;
    const [previous, next] = this._buttons;
    (previous as HTMLButtonElement).disabled = first === 0;
    (next as HTMLButtonElement).disabled = last >= shown.length;
  }

  private _save(): void {
    const rows = this._shown;
    const columns: CsvColumn[] = [{ label: "design", values: Array.from(rows, (row) => this._study.number[row] ?? -1) }];
    for (const column of this._study.columns) {
      const named = column.kind === "choice" || column.kind === "boolean";
      const values = Array.from(rows, (row) => (named ? cell_text(column, row) : (column.values[row] ?? NaN)));
      columns.push({ label: column.label, unit: column.unit, values });
    }
    columns.push({ label: "front", values: Array.from(rows, (row) => ((this._study.flags[row] ?? 0) & FRONT ? 1 : 0)) });
    columns.push({ label: "warnings", values: Array.from(rows, (row) => this._study.warning(row)) });
    save(`${this._study.data.name} designs.csv`.replace(/\s+/g, "_"), csv(columns), "text/csv");
  }
}

function heads_of(study: Study): Head[] {
  const heads: Head[] = [
    { label: "design", text: (row) => String(study.number[row]), value: (row) => study.number[row] ?? 0 },
    {
      label: "rank",
      text: (row) => ((study.rank[row] ?? -1) < 0 ? "-" : String((study.rank[row] ?? 0) + 1)),
      value: (row) => ((study.rank[row] ?? -1) < 0 ? NaN : (study.rank[row] ?? 0)),
    },
  ];
  for (const column of study.columns) {
    const value = (row: number) => column.values[row] ?? NaN;
    heads.push({ label: titled(column), text: (row) => cell_text(column, row), value });
  }
  const on_front = (row: number) => (study.flags[row] ?? 0) & FRONT;
  heads.push({ label: "front", text: (row) => (on_front(row) ? "yes" : ""), value: (row) => -on_front(row) });
  if (study.has_warnings) {
    const count = (row: number) => (study.warning(row) ? 0 : 1);
    heads.push({ label: "warnings", text: study.warning, value: count });
  }
  return heads;
}

/** The best first, then those without a rank by their number. */
function by_rank(study: Study): Int32Array {
  const place = (row: number) => ((study.rank[row] ?? -1) < 0 ? Infinity : (study.rank[row] ?? 0));
  const rows = Int32Array.from({ length: study.count }, (_, row) => row);
  return rows.sort((a, b) => (place(a) === place(b) ? a - b : place(a) - place(b)));
}
