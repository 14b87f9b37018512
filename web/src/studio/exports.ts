// A design as a scenario file (TOML), a parameter set (SSV), and its curves (CSV).
import { csv, type Column } from "../parts/save";
import { point_of } from "./hit";
import { outline_of } from "../parts/shapes";
import { base_of, type Complete } from "./design";
import { STEP_S } from "./results";
import type { Run } from "../engine/engine";
import type { Tables, Value, Values } from "./tables";

// Parameters that a scenario file has other keys for.
const KIND = "testbed.bumper.kind";

const word = (value: Value) => String(value);

/** A number of TOML that is read as what it is. */
const number = (value: Value) => (typeof value === "boolean" ? String(value) : word(value).replace(/e\+?/, "e"));

/** What differs from robot file and preset, model by model. */
export function changed(tables: Tables, { design, settings }: Complete): Values {
  // The scenario file states no robot file: all of a robot's numbers are in it.
  const start = base_of({ ...tables, robots: {} }, design);
  const found: Values = {};
  for (const { name } of tables.variables) {
    const value = settings[name];
    if (value !== undefined && value !== start[name]) found[name] = value;
  }
  return found;
}

/** A file for `giveway run`, which gives the same bits. */
export function toml(tables: Tables, complete: Complete, address: string): string {
  const { design, settings } = complete;
  const { hit } = design;
  const { point } = point_of(outline_of(settings), hit.around);
  const kinds = tables.variables.find(({ name }) => name === KIND)?.choices ?? [];
  const values = changed(tables, complete);
  delete values[KIND];
  values["testbed.slider.present"] = true; // what collides is stated by its parameters
  const about = [
    "# From the studio (giveway studio). Run it with `giveway run FILE --out DIR`.",
    `# Hit: at [${point.map((at) => at.toFixed(4)).join(", ")}] m of the outline, ${hit.speed_mps} m/s, ${hit.angle_deg} deg from straight in.`,
    `# Robot: ${tables.robots[design.robot]?.title ?? design.robot}, its numbers below where they differ from the default robot's.`,
    `# Design: #${address}`,
  ];
  const top = [
    "schema_version = 1",
    'name = "studio"',
    `duration = ${number(design.duration_s)}`,
    `bumper = "${kinds[Number(settings[KIND])]}"`,
    ...(design.preset === "default" ? [] : [`preset = "${design.preset}"`]),
    ...(design.region ? [`judge_as = "${design.region}"`] : []),
  ];
  const of = (model: string) => {
    const lines = Object.entries(values)
      .filter(([name]) => name.startsWith(`${model}.`))
      .map(([name, value]) => `"${name.slice(model.length + 1)}" = ${number(value)}`);
    return lines.length > 0 ? ["", `[${model}]`, ...lines] : [];
  };
  return [...about, "", ...top, ...of("testbed"), ...of("controller"), ""].join("\n");
}

const safe = (text: string) => text.replace(/&/g, "&amp;").replace(/</g, "&lt;").replace(/"/g, "&quot;");

/** System Structure Parameter Values 1.0, for both models, as `giveway ssp` names them. */
export function ssv(tables: Tables, complete: Complete): string {
  const variables = new Map(tables.variables.map((variable) => [variable.name, variable]));
  const used = new Set<string>();
  const parameters = Object.entries(changed(tables, complete)).map(([name, value]) => {
    const { type, unit } = variables.get(name) ?? { type: "real", unit: "1" };
    const kind = { real: "Real", integer: "Integer", boolean: "Boolean" }[type];
    const with_unit = unit !== "" && unit !== "1";
    if (with_unit) used.add(unit);
    const attributes = `value="${word(value)}"${with_unit ? ` unit="${safe(unit)}"` : ""}`;
    return `    <ssv:Parameter name="${safe(name)}">\n      <ssv:${kind} ${attributes}/>\n    </ssv:Parameter>`;
  });
  const units = [...used].sort().map((unit) => {
    const powers = Object.entries(tables.units[unit] ?? {}).map(([base, power]) => ` ${base}="${power}"`);
    return `    <ssc:Unit name="${safe(unit)}">\n      <ssc:BaseUnit${powers.join("")}/>\n    </ssc:Unit>`;
  });
  return [
    '<?xml version="1.0" encoding="UTF-8"?>',
    '<ssv:ParameterSet xmlns:ssv="http://ssp-standard.org/SSP1/SystemStructureParameterValues"' +
      ' xmlns:ssc="http://ssp-standard.org/SSP1/SystemStructureCommon" version="1.0" name="studio">',
    "  <ssv:Parameters>", ...parameters, "  </ssv:Parameters>",
    ...(units.length > 0 ? ["  <ssv:Units>", ...units, "  </ssv:Units>"] : []),
    "</ssv:ParameterSet>", "",
  ].join("\n");
}

/** Every recorded trace, with all digits. */
export function traces_csv(run: Run, units: (name: string) => string): string {
  const all = Object.entries(run.traces);
  const rows = all[0]?.[1].length ?? 0;
  const time: Column = { label: "time", unit: "s", values: Float64Array.from({ length: rows }, (_, k) => k * STEP_S) };
  return csv([time, ...all.map(([label, values]): Column => ({ label, unit: units(label), values }))]);
}
