// The report of a study: one selection in scatter, parallel coordinates and table; a click computes a design.

import "../parts/theme.css";
import "./study.css";
import "./figures.css";
import { data, element, start } from "../parts/page";
import { save } from "../parts/save";
import { Beside } from "./beside";
import { DesignTable } from "./design_table";
import { draw_figures, type FigureData } from "./figures";
import { Parallel } from "./parallel";
import { Scatter, type Marked } from "./scatter";
import { Selection, type Only } from "./selection";
import { cell_text, FEASIBLE, Study, titled, type StudyData } from "./study_data";

const ONLY: Record<Only, string> = { all: "all designs", allowed: "those that meet all constraints", front: "the Pareto front" };

start(async () => {
  const given = data<StudyData & { figures: FigureData[] }>();
  draw_figures(given.figures);
  if (!given.columns) {
    return; // nothing is stored yet
  }
  const study = new Study(given);
  const place = (id: string): HTMLElement => document.getElementById(id) ?? document.body.appendChild(element("div"));
  const selection = new Selection(study);
  const marked: Marked = { chosen: study.chosen, picked: -1 };
  const tip = element("div", { class: "tip", role: "status", hidden: true });
  document.body.append(tip);

  const pick = (row: number): void => {
    marked.picked = row;
    scatter.draw();
    parallel.draw();
    table.mark();
    history.replaceState(null, "", `#design=${study.number[row]}`);
    void beside.show();
  };
  const hover = (row: number, event?: MouseEvent): void => tell(tip, study, row, event);

  bar(place("selection"), study, selection);
  const scatter = new Scatter(place("scatter"), study, selection, marked, { hover, pick });
  const parallel = new Parallel(place("parallel"), study, selection, marked);
  const table = new DesignTable(place("designs"), study, selection, marked, pick);
  place("scatter").append(svg_button("trade-off", () => scatter.svg()));
  place("parallel").append(svg_button("parallel coordinates", () => parallel.svg()));
  const beside = new Beside(place("beside"), study, marked, pick);
  const asked = /#design=(\d+)/.exec(location.hash);
  const first = asked ? Number(asked[1]) : study.data.best[1];
  marked.picked = first === undefined ? -1 : study.row_of(first);
  await beside.show();
});

function svg_button(name: string, drawn: () => string): HTMLElement {
  const click = () => save(`${name.replace(/\s/g, "_")}.svg`, drawn(), "image/svg+xml");
  return element("p", { class: "buttons" }, element("button", { type: "button", click, "aria-label": `${name} as SVG` }, "SVG"));
}

/** What is selected, in words, and how to take that back. */
function bar(where: HTMLElement, study: Study, selection: Selection): void {
  const said = element("span", { role: "status" });
  const only = element("select", { change: () => selection.show_only(only.value as Only) });
  for (const [value, words] of Object.entries(ONLY)) {
    only.append(element("option", { value }, words));
  }
  const all = element("button", { type: "button", click: () => selection.clear() }, "Select all");
  const tell_count = (): void => {
    const count = selection.count.toLocaleString("en");
    said.textContent = `${count} of ${study.count.toLocaleString("en")} designs selected`;
    only.value = selection.only;
    all.disabled = selection.is_all;
  };
  selection.on_change(tell_count);
  tell_count();
  const keys: [string, string][] = [["good", "on the Pareto front"], ["first", "meets all constraints"], ["quiet", "does not"], ["limit", "limit, and chosen design"]]; // prettier-ignore
  const legend = keys.map(([key, words]) => element("span", {}, element("span", { class: `key ${key}` }), words));
  where.append(
    element("p", { class: "buttons" }, element("label", {}, "among ", only), all, said),
    element("p", { class: "note legend" }, ...legend),
  );
}

/** All numbers of the design under the pointer. */
function tell(tip: HTMLElement, study: Study, row: number, event?: MouseEvent): void {
  tip.hidden = row < 0;
  if (row < 0) {
    return;
  }
  const place = (study.rank[row] ?? -1) + 1;
  const state = (study.flags[row] ?? 0) & FEASIBLE ? (place ? `, rank ${place}` : "") : ", not all constraints met";
  const lines = study.columns.map((column) => element("div", {}, `${titled(column)}: ${cell_text(column, row)}`));
  const more = [study.warning(row), study.reason(row)].filter(Boolean).map((text) => element("div", {}, text));
  tip.replaceChildren(element("strong", {}, `design ${study.number[row]}${state}`), ...lines, ...more);
  if (event) {
    const { clientWidth: wide, clientHeight: high } = tip;
    tip.style.left = `${Math.max(4, Math.min(event.clientX + 14, innerWidth - wide - 8))}px`;
    const below = event.clientY + 18;
    tip.style.top = `${Math.max(4, below + high > innerHeight ? event.clientY - high - 10 : below)}px`;
  }
}
