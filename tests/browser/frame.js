// An independent reader of frames: what the report shows is compared with the files of the run.

import { readFileSync } from "node:fs";
import { inflateSync } from "node:zlib";
import { join } from "node:path";

const MARKER = "<AppendedData encoding=\"raw\">\n_";

/** Frames of a run as `{ time, file }`. */
export function frames(results) {
  const text = readFileSync(join(results, "frames", "frames.pvd"), "latin1");
  return [...text.matchAll(/timestep="([^"]*)".*file="([^"]*)"/g)].map(([, time, file]) => ({ time: Number(time), file: join(results, "frames", file) }));
}

/** The numbers of an array of a frame. */
export function array(file, name) {
  const bytes = readFileSync(file);
  const at = bytes.indexOf(MARKER, 0, "latin1");
  const element = bytes.subarray(0, at).toString("latin1").split("\n").find((line) => line.includes(` Name="${name}"`));
  let start = at + MARKER.length + Number(/ offset="(\d+)"/.exec(element)[1]);
  const word = (i) => Number(bytes.readBigUInt64LE(start + 8 * i));
  const blocks = word(0);
  const sizes = Array.from({ length: blocks }, (_, i) => word(3 + i));
  start += 8 * (3 + blocks);
  const parts = sizes.map((size) => {
    const part = inflateSync(bytes.subarray(start, start + size));
    start += size;
    return part;
  });
  const data = Buffer.concat(parts);
  const width = element.includes("Float64") ? 8 : 4;
  return Array.from({ length: data.length / width }, (_, i) => (width === 8 ? data.readDoubleLE(8 * i) : data.readFloatLE(4 * i)));
}

/** The columns of a history as arrays of texts. */
export function history(results) {
  const [header, ...rows] = readFileSync(join(results, "history.csv"), "utf8").trim().split("\n").map((line) => line.split(","));
  return Object.fromEntries(header.map((name, i) => [name, rows.map((row) => row[i])]));
}
