// What Python fills in: variables, robots and body regions, as their tables have them.

export type Value = number | boolean;
export type Values = Record<string, Value>;

export interface Variable {
  /** With its model: "testbed.slider.mass". */
  name: string;
  type: "real" | "integer" | "boolean";
  unit: string;
  minimum: number;
  maximum: number;
  start: Value;
  /** In the preset "paper", where that differs. */
  paper: Value | null;
  description: string;
  choices: string[] | null;
}

export interface Region {
  name: string;
  transient_n: number;
  lasting_n: number;
}

export interface Tables {
  version: string;
  variables: Variable[];
  /** Name to what its file says, by full name. */
  robots: Record<string, { title: string; values: Values }>;
  regions: Region[];
  /** Exponents of the base units, by unit. */
  units: Record<string, Record<string, number>>;
  notice: string;
  /** Units of inputs and outputs. */
  traces: Record<string, string>;
}

export interface Group {
  title: string;
  variables: Variable[];
}

// The first group whose prefix fits; names that fit none are in the last.
const GROUPS: readonly [string, readonly string[]][] = [
  ["Bumper", ["testbed.bumper.kind", "testbed.bumper.mount", "testbed.bumper.latch", "testbed.bumper.plate", "testbed.bumper.spring",
    "testbed.bumper.preload", "testbed.bumper.damping", "testbed.bumper.guide", "testbed.bumper.travel", "testbed.bumper.stop"]],
  ["Bumper: foam, gas, damper, series, lever", ["testbed.bumper.foam", "testbed.bumper.gas", "testbed.bumper.damper",
    "testbed.bumper.series", "testbed.bumper.lever"]],
  ["Bumper: measured table", ["testbed.bumper.table"]],
  ["Bumper: further", ["testbed.bumper."]],
  ["What collides", ["testbed.slider.", "testbed.contact.", "testbed.rope.", "testbed.wall."]],
  ["Robot: base and wheels", ["testbed.base.", "testbed.wheel.", "testbed.start.", "testbed.floor.", "testbed.push."]],
  ["Robot: rollers", ["testbed.roller."]],
  ["Robot: outline", ["testbed.outline."]],
  ["Robot: drivetrain, servo and electronics", ["testbed.drivetrain.", "testbed.motor.", "testbed.servo.", "testbed.electronics."]],
  ["Robot: accelerometer and gyro", ["testbed.imu."]],
  ["Controller: detector", ["controller.detector.", "controller.channels.", "controller.follower.", "controller.supervisor."]],
  ["Controller: reaction", ["controller.admittance.", "controller.reference.", "controller.contact."]],
  ["Controller: estimator", ["controller.estimator.", "controller.friction.", "controller.sensor_check.", "controller.imu."]],
  ["Controller: the robot as it knows it", ["controller.base.", "controller.geometry.", "controller.outline."]],
  ["Integration", ["testbed.solver."]],
];
export const LAST_GROUP = "Further";

/** Every parameter, each in one group. */
export function groups(variables: readonly Variable[]): Group[] {
  const all: Group[] = [...GROUPS.map(([title]) => ({ title, variables: [] })), { title: LAST_GROUP, variables: [] }];
  for (const variable of variables) {
    const found = GROUPS.findIndex(([, prefixes]) => prefixes.some((prefix) => variable.name.startsWith(prefix)));
    all[found < 0 ? all.length - 1 : found]?.variables.push(variable);
  }
  return all.filter((group) => group.variables.length > 0);
}

/** In words, as `giveway variables` has it. */
export function allowed(variable: Variable): string {
  if (variable.type === "boolean") {
    return "true or false";
  }
  const unit = variable.unit === "" || variable.unit === "1" ? "" : ` ${variable.unit}`;
  return `${variable.type === "integer" ? "a whole number" : "a number"} from ${variable.minimum} to ${variable.maximum}${unit}`;
}

/** Whether a parameter can have this value. */
export function fits(variable: Variable, value: unknown): value is Value {
  if (variable.type === "boolean") {
    return typeof value === "boolean";
  }
  const whole = variable.type === "real" || Number.isInteger(value);
  return typeof value === "number" && Number.isFinite(value) && whole && value >= variable.minimum && value <= variable.maximum;
}
