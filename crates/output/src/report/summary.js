// Tables of what came out, how it was run, warnings and texts.

/** A table of rows [name, number, unit] or [name, text]. */
function table(caption, rows) {
  const body = make("tbody");
  for (const [name, value, unit] of rows) {
    const cells = [make("th", { scope: "row" }, name)];
    if (unit === undefined) cells.push(make("td", { class: "text", colspan: "2" }, value));
    else cells.push(make("td", { class: "number" }, value), make("td", { class: "unit" }, unit));
    body.append(make("tr", {}, ...cells));
  }
  return make("table", {}, make("caption", {}, caption), body);
}

function duration(seconds) {
  if (seconds === null || !Number.isFinite(seconds)) return "\u2013";
  if (seconds < 60) return `${seconds.toFixed(1)} s`;
  const whole = Math.round(seconds);
  const [hours, minutes] = [Math.floor(whole / 3600), Math.floor(whole / 60) % 60];
  return hours > 0 ? `${hours} h ${String(minutes).padStart(2, "0")} min` : `${minutes} min ${String(whole % 60).padStart(2, "0")} s`;
}

/** Groups of three digits, by thin spaces. */
function whole(number) {
  return String(number).replace(/\B(?=(\d{3})+$)/g, "\u2009");
}

const STATUS = { completed: "completed", failed: "failed", interrupted: "interrupted" };

function showSummary() {
  const { summary, record } = DATA;
  const status = summary ? STATUS[summary.status] : "no summary: the run is under way or was killed";
  element("heading").textContent = DATA.heading;
  const shown = summary ? `${DATA.case} \u00b7 ${status} at ${withUnit(summary.simulated_time, "s", 4)}` : `${DATA.case} \u00b7 ${status}`;
  element("subheading").textContent = shown;
  if (summary && summary.status !== "completed") element("subheading").className = "failed";
  const tables = element("tables");
  if (summary) {
    const { energies, extremes } = summary;
    const joule = DATA.energy_unit;
    tables.append(table("Run", [
      ["status", status, ""],
      ["simulated time", ...shownValue(summary.simulated_time, "s")],
      ["steps", whole(summary.steps), ""],
      ["particles", whole(summary.particles), ""],
      ["evaluation points", whole(summary.points), ""],
      ["neighbours per particle", digits(summary.neighbours_per_particle, 4), ""],
      ["wall-clock time", duration(summary.wall_seconds), ""],
      ["particle steps per second", digits(summary.particle_steps_per_second, 4), "1/s"],
    ]));
    const kinds = Object.keys(energies).filter((kind) => kind !== "balance");
    const scale = scaleFor(joule, Math.max(...kinds.map((kind) => Math.abs(energies[kind] ?? 0))));
    const fixed = (value) => (value === null ? "\u2013" : tickText(value * scale.factor, 3));
    const names = { external: "work of loads", contact: "work of obstacles", plastic: "plastic dissipation", friction: "dissipated by friction" };
    tables.append(table("Energies at the end", [
      ...kinds.map((kind) => [names[kind] ?? kind, fixed(energies[kind]), scale.unit]),
      ...(summary.kinetic_to_internal === null ? [] : [["kinetic, of elastic and plastic", tickText(100 * summary.kinetic_to_internal, 4), "%"]]),
      ["balance, of the largest", energies.balance === null ? "\u2013" : tickText(100 * energies.balance, 4), "%"],
    ]));
    const values = Object.entries(summary.probes);
    const known = values.filter(([, value]) => value !== null);
    const probes = known.map(([name, value]) => [name.replaceAll("_", " "), ...shownValue(value, DATA.probe_units[name] ?? "")]);
    const missing = values.length - known.length;
    if (missing > 0) probes.push([`${missing} probe values are missing: no particle is near their points`, "\u2013", ""]);
    tables.append(table("Extremes and probes at the end", [
      ["largest plastic strain", digits(extremes.equivalent_plastic_strain), ""],
      ["smallest volume ratio J", digits(extremes.jacobian_min), ""],
      ["largest volume ratio J", digits(extremes.jacobian_max), ""],
      ["inverted cells", whole(summary.inverted_cells), ""],
      ...probes,
    ]));
  }
  if (record) {
    const run = table("How it was run", [
      ["version", record.version + (record.commit ? ` (${record.commit})` : "")],
      ["command", record.command.join(" ")],
      ["machine", [record.machine.cpu, record.machine.os].filter(Boolean).join(", ")],
      ["threads", String(record.threads)],
      ["started", record.start_time],
      ["ended", record.end_time ?? "not yet, or killed"],
      ["because", record.exit_reason ?? "\u2013"],
    ]);
    run.className = "wide";
    tables.append(run);
  }
  const warnings = summary?.warnings ?? [];
  if (warnings.length > 0) {
    element("warnings").hidden = false;
    element("warnings").append(...warnings.map((text) => make("p", {}, text)));
  }
  element("case-text").textContent = DATA.case_text;
  element("original-text").textContent = DATA.original_case;
  element("original").hidden = DATA.original_case === "";
  element("log-text").textContent = DATA.log || "No log was recorded.";
  const { kept, total, is_quantised: isQuantised, particles, total_particles: all, has_faces: hasFaces } = DATA.frames;
  const notes = [];
  if (particles < all) notes.push(`${whole(particles)} of ${whole(all)} particles are in this report, ${hasFaces ? "all of the surface and a sample of the inside" : "a sample"}; the rest is in frames/.`);
  if (kept.length < total) notes.push(`${kept.length} of ${total} frames are in this report; the rest is in frames/.`);
  if (isQuantised) notes.push("Positions and fields are rounded to 1/65535 of their range to keep this file small.");
  element("frames-note").textContent = notes.join(" ");
  element("footer").textContent = `jstsph ${DATA.version}. All exported numbers are in SI units.`;
}
