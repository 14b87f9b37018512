// Whether what was computed here has the bits of what the study has stored: FNV-1a, as page_runs.py computes it.

const [OFFSET, PRIME] = [0x811c9dc5, 0x01000193];

/** Of the bits of numbers, little endian; never 0, and all NaN are one. */
export function check_of(numbers: readonly number[]): number {
  const view = new DataView(new ArrayBuffer(8));
  let found = OFFSET;
  for (const number of numbers) {
    if (Number.isNaN(number)) {
      view.setBigUint64(0, 0x7ff8000000000000n, true);
    } else {
      view.setFloat64(0, number, true);
    }
    for (let k = 0; k < 8; k++) {
      found = Math.imul(found ^ view.getUint8(k), PRIME);
    }
  }
  return found >>> 0 || 1;
}
