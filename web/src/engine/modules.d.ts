// What build.mjs makes beside TypeScript's own modules.
declare module "giveway:worker" {
  /** giveway_batch.js as a script that defines `serve`. */
  const text: string;
  export default text;
}
declare module "*.css";
