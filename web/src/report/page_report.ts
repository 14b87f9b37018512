// The reports of runs, of the reproduced paper and of evidence: figures, and the motion if there is one.

import "../parts/theme.css";
import "./report.css";
import "./figures.css";
import "./drawn.css";
import { data, element, start } from "../parts/page";
import { Scene } from "../parts/scene";
import { draw_figures, type FigureData } from "./figures";
import { motion_of, type SceneData } from "./run_scene";

interface ReportData {
  figures: FigureData[];
  scenes?: SceneData[];
}

/** Axes over this time point at the motion, too. */
const SINCE = /^time since contact \((ms|s)\)$/;
const NARROW_PX = 240; // of one run: so narrow, runs are shown one at a time
const FIRST_S = -0.05; // shown when the page opens

start(() => {
  const { figures, scenes = [] } = data<ReportData>();
  const drawn = draw_figures(figures);
  const place = document.getElementById("scene");
  if (!place || scenes.length === 0) {
    return;
  }
  const scene = new Scene(place, { label: "The collision from above", height: 420 });
  const motions = scenes.map(motion_of);
  const show = (which: number): void => {
    scene.set(which < 0 ? motions : motions.slice(which, which + 1));
    scene.seek(scene.time_s || FIRST_S);
  };
  const narrow = matchMedia(`(max-width: ${NARROW_PX * motions.length}px)`);
  if (motions.length > 1) {
    const choice = element("select", { change: () => show(Number(choice.value)) });
    const names = ["beside each other", ...motions.map(({ title }) => title)];
    choice.append(...names.map((name, k) => element("option", { value: k - 1 }, name)));
    choice.value = narrow.matches ? "0" : "-1";
    place.before(element("p", { class: "buttons" }, element("label", {}, "runs ", choice)));
  }
  show(narrow.matches ? 0 : -1);
  for (const { chart, axes } of drawn) {
    const unit = SINCE.exec(axes.x.label);
    if (unit) {
      chart.on_x = (x) => scene.seek(unit[1] === "ms" ? x / 1000 : x);
    }
  }
});
