// A table that sorts by its heads and finds by text; of many rows only those in view are elements.
import { element, shown, unit_of } from "./page";

export interface TableColumn<Row> {
  label: string;
  unit?: string;
  decimals?: number | null;
  /** A number sorts as one. */
  value: (row: Row, index: number) => number | string | boolean | null;
}

export interface TableOptions<Row> {
  caption: string;
  columns: TableColumn<Row>[];
  rows: readonly Row[];
  filter?: boolean;
  /** A click, or Enter, on a row. */
  on_row?: (index: number) => void;
}

const AT_ONCE = 120;

export class Table<Row> {
  private readonly body = element("tbody");
  private readonly heads: HTMLTableCellElement[];
  private readonly found = element("input", { type: "search", placeholder: "find", input: () => this.fill() });
  private readonly count = element("span", { class: "note", role: "status" });
  private readonly box: HTMLElement;
  private order: { column: number; falling: boolean } | null = null;
  private among: readonly number[];
  private shown_rows: number[] = [];
  private selected: number | null = null;
  private written = 0;

  constructor(where: HTMLElement, private readonly options: TableOptions<Row>) {
    this.among = options.rows.map((_, i) => i);
    this.found.setAttribute("aria-label", `find in ${options.caption}`);
    this.heads = options.columns.map(({ label, unit }, i) =>
      element("th", { scope: "col" }, element("button", { type: "button", click: () => this.sort(i) }, `${label}${unit_of(unit)}`)),
    );
    const table = element("table", {}, element("caption", {}, options.caption), element("thead", {}, element("tr", {}, ...this.heads)), this.body);
    this.box = element("div", { class: "scroll", tabindex: 0, role: "region", "aria-label": options.caption, scroll: () => this.more() }, table);
    const bar = options.filter ? [element("p", { class: "buttons" }, this.found, this.count)] : [];
    where.append(element("div", { class: "table" }, ...bar, this.box));
    this.fill();
  }

  /** Only these rows, by their index; nothing: all. */
  show(indices: readonly number[] | null): void {
    this.among = indices ?? this.options.rows.map((_, i) => i);
    this.fill();
  }

  select(index: number | null): void {
    this.selected = index;
    for (const row of this.body.rows) {
      row.setAttribute("aria-selected", String(row.dataset.row === String(index)));
    }
  }

  private sort(column: number): void {
    this.order = { column, falling: this.order?.column === column ? !this.order.falling : false };
    this.heads.forEach((head, i) => {
      head.removeAttribute("aria-sort");
      if (i === column) head.setAttribute("aria-sort", this.order?.falling ? "descending" : "ascending");
    });
    this.fill();
  }

  private text(column: TableColumn<Row>, index: number): string {
    const value = column.value(this.options.rows[index] as Row, index);
    return typeof value === "number" || value === null ? shown(value, column.decimals) : String(value);
  }

  private fill(): void {
    const { columns, rows } = this.options;
    const words = this.found.value.toLowerCase();
    let chosen = [...this.among];
    if (words) {
      chosen = chosen.filter((i) => columns.some((column) => this.text(column, i).toLowerCase().includes(words)));
    }
    if (this.order) {
      const { column, falling } = this.order;
      const by = columns[column] as TableColumn<Row>;
      const keys = new Map(chosen.map((i) => [i, by.value(rows[i] as Row, i)]));
      const sign = falling ? -1 : 1;
      const empty = (value: unknown) => value === null || Number.isNaN(value);
      chosen.sort((a, b) => {
        const [one, other] = [keys.get(a)!, keys.get(b)!];
        if (empty(one) || empty(other)) return Number(empty(one)) - Number(empty(other)); // the empty ones last
        return sign * (typeof one === "string" ? one.localeCompare(String(other)) : Number(one) - Number(other));
      });
    }
    this.shown_rows = chosen;
    this.count.textContent = `${chosen.length} of ${rows.length}`;
    this.body.replaceChildren();
    this.written = 0;
    this.box.scrollTop = 0;
    this.write();
  }

  private more(): void {
    if (this.box.scrollTop + this.box.clientHeight > this.box.scrollHeight - 400) {
      this.write();
    }
  }

  private write(): void {
    const rows = this.shown_rows.slice(this.written, this.written + AT_ONCE).map((index) => {
      const cells = this.options.columns.map((column, i) =>
        i === 0 ? element("th", { scope: "row" }, this.text(column, index)) : element("td", {}, this.text(column, index)),
      );
      const row = element("tr", { "data-row": index, "aria-selected": String(index === this.selected) }, ...cells);
      if (this.options.on_row) {
        row.tabIndex = 0;
        row.addEventListener("click", () => this.options.on_row?.(index));
        row.addEventListener("keydown", (event) => event.key === "Enter" && this.options.on_row?.(index));
      }
      return row;
    });
    this.written += rows.length;
    this.body.append(...rows);
  }
}
