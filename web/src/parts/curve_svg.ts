// A panel of curves as an SVG of its own: text stays text, on white.
import type { CurvesOptions, Panel } from "./curves";
import { shown, unit_of } from "./page";

const [WIDTH, HEIGHT, LEFT, TOP, BOTTOM, ROW] = [720, 400, 64, 34, 44, 18];
const COLOURS: Record<string, string> = {
  truth: "#7a2ea0", estimate: "#0b64a8", limit: "#b03a00", first: "#0b64a8", second: "#b34700", third: "#08785a",
  fourth: "#7a2ea0", quiet: "#565d68",
};

const safe = (text: string) => text.replace(/&/g, "&amp;").replace(/</g, "&lt;").replace(/>/g, "&gt;");

function ticks(low: number, high: number, about: number): number[] {
  const raw = (high - low) / about;
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map((one) => one * power).find((one) => one >= raw) ?? raw;
  const first = Math.ceil(low / step);
  return Array.from({ length: Math.max(0, Math.floor(high / step) - first + 1) }, (_, i) => (first + i) * step);
}

/** What is in view of a panel. */
export function curve_svg(
  x: ArrayLike<number>, panel: Panel, options: CurvesOptions, view: { readonly x: readonly [number, number]; readonly y: readonly [number, number] },
): string {
  const rows = Math.ceil(panel.series.length / 3);
  const [plot_width, plot_height] = [WIDTH - LEFT - 14, HEIGHT - TOP - BOTTOM];
  const at_x = (value: number) => LEFT + ((value - view.x[0]) / (view.x[1] - view.x[0])) * plot_width;
  const at_y = (value: number) => TOP + plot_height - ((value - view.y[0]) / (view.y[1] - view.y[0])) * plot_height;
  const n = (value: number) => value.toFixed(2);
  const text = (px: number, py: number, words: string, more = "") => `<text x="${n(px)}" y="${n(py)}" ${more}>${safe(words)}</text>`;
  const parts: string[] = [text(LEFT, 20, `${panel.title}${unit_of(panel.unit)}`, 'font-size="14" font-weight="600"')];
  for (const tick of ticks(view.x[0], view.x[1], 8)) {
    parts.push(`<path d="M${n(at_x(tick))} ${TOP}v${plot_height}" stroke="#e2e5ea"/>`);
    parts.push(text(at_x(tick), TOP + plot_height + 16, shown(tick), 'text-anchor="middle"'));
  }
  for (const tick of ticks(view.y[0], view.y[1], 6)) {
    parts.push(`<path d="M${LEFT} ${n(at_y(tick))}h${plot_width}" stroke="#e2e5ea"/>`);
    parts.push(text(LEFT - 6, at_y(tick) + 4, shown(tick), 'text-anchor="end"'));
  }
  parts.push(text(LEFT + plot_width / 2, TOP + plot_height + 36, `${options.x_label}${unit_of(options.x_unit)}`, 'text-anchor="middle"'));
  const lines: string[] = [];
  for (const { tone, dash, values } of panel.series) {
    const points: string[] = [];
    for (let i = 0; i < x.length; i++) {
      const [px, value] = [x[i] as number, values[i] as number];
      if (px >= view.x[0] && px <= view.x[1] && Number.isFinite(value)) {
        points.push(`${n(at_x(px))},${n(at_y(value))}`);
      }
    }
    const dashed = dash ? ' stroke-dasharray="6 4"' : "";
    lines.push(`<polyline fill="none" stroke="${COLOURS[tone]}" stroke-width="1.6"${dashed} points="${points.join(" ")}"/>`);
  }
  for (const { label, value } of panel.limits ?? []) {
    lines.push(`<path d="M${LEFT} ${n(at_y(value))}h${plot_width}" stroke="${COLOURS.limit}" stroke-dasharray="8 4"/>`);
    lines.push(text(LEFT + plot_width - 4, at_y(value) - 4, label, `text-anchor="end" fill="${COLOURS.limit}"`));
  }
  (panel.marks ?? []).forEach(({ label, x: moment, tone }, i) => {
    const colour = COLOURS[tone ?? "quiet"];
    lines.push(`<path d="M${n(at_x(moment))} ${TOP}v${plot_height}" stroke="${colour}" stroke-dasharray="3 3"/>`);
    lines.push(text(at_x(moment) + 4, TOP + 12 + 13 * i, label, `fill="${colour}"`));
  });
  panel.series.forEach(({ label, tone, dash }, i) => {
    const [px, py] = [LEFT + (i % 3) * (plot_width / 3), HEIGHT + ROW * Math.floor(i / 3) + 4];
    parts.push(`<path d="M${n(px)} ${py - 4}h20" stroke="${COLOURS[tone]}" stroke-width="2.5"${dash ? ' stroke-dasharray="6 4"' : ""}/>`);
    parts.push(text(px + 26, py, label));
  });
  const clip = `<clipPath id="in"><rect x="${LEFT}" y="${TOP}" width="${plot_width}" height="${plot_height}"/></clipPath>`;
  const height = HEIGHT + ROW * rows + 6;
  return `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 ${WIDTH} ${height}" width="${WIDTH}" height="${height}" font-family="system-ui, sans-serif" font-size="12" fill="#1d2128">
<rect width="100%" height="100%" fill="#fff"/>${clip}${parts.join("")}<g clip-path="url(#in)">${lines.join("")}</g></svg>
`;
}
