// The figures that Python has drawn, where the text wants them: <div class="drawn" data-figure="3">.

import { element } from "../parts/page";
import { Chart, plain, shade, type AxesData, type Paint } from "./chart";

export interface FigureData {
  columns: number;
  axes: AxesData[];
  legend: (Paint & { label: string; kind: "line" | "dash" | "point" | "area" })[];
  legend_title: string;
}

/** Draws all figures; returns their panels. */
export function draw_figures(figures: readonly FigureData[]): { chart: Chart; axes: AxesData }[] {
  const drawn: { chart: Chart; axes: AxesData }[] = [];
  for (const place of document.querySelectorAll<HTMLElement>(".drawn[data-figure]")) {
    const figure = figures[Number(place.dataset.figure)];
    if (figure) {
      place.append(legend(figure));
      const grid = element("div", { class: "panels" });
      grid.style.setProperty("--columns", String(figure.columns));
      for (const axes of figure.axes) {
        const panel = element("figure", { class: "curve panel" });
        grid.append(panel);
        drawn.push({ chart: new Chart(panel, axes, place.dataset.name ?? ""), axes });
      }
      place.append(grid);
    }
  }
  return drawn;
}

/** Outside the panels, where it covers nothing. */
function legend({ legend: entries, legend_title: title }: FigureData): HTMLElement {
  const keys = entries.map(({ label, kind, colour }) => {
    const key = element("span", { class: `key ${kind}` });
    const paint = () => key.style.setProperty("--key", shade(colour));
    paint();
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", paint);
    return element("span", {}, key, plain(label));
  });
  const head = title ? [element("span", {}, `${plain(title)}: `)] : [];
  return element("p", { class: "note legend", ...(keys.length ? {} : { hidden: true }) }, ...head, ...keys);
}
