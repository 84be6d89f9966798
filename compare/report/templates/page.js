/* Hands out the files that the page holds, and draws its interactive charts as they come into view.
   Without it the page shows every figure as it is printed, and its links lead to files beside it. */
"use strict";
(() => {
  const say = (text) => { document.getElementById("said").textContent = text; };
  const all = (what, root = document) => [...root.querySelectorAll(what)];

  /* What the page holds under an id: base64 of its gzipped bytes. */
  function held(id) {
    const packed = Uint8Array.from(atob(document.getElementById(id).textContent), (c) => c.charCodeAt(0));
    return new Response(new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip")));
  }

  /* What is packed (compare/report/compression.py): its header, and a function that reads its numbers. */
  async function unpacked(id) {
    const buffer = await held(id).arrayBuffer();
    const end = 4 + new DataView(buffer).getUint32(0, true);
    const header = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, end - 4)));
    return [header, (part) => numbers(new Uint8Array(buffer, end + part.at, 4 * part.n), part)];
  }

  function numbers(bytes, { n, order, step = 1, log, zeros = [], gaps = [] }) {
    const found = new Float64Array(n);
    for (let i = 0; i < n; i += 1) {
      const code = (bytes[i] | bytes[n + i] << 8 | bytes[2 * n + i] << 16 | bytes[3 * n + i] << 24) >>> 0;
      found[i] = code % 2 ? -(code + 1) / 2 : code / 2;
    }
    for (let k = 0; k < order; k += 1) for (let i = 1; i < n; i += 1) found[i] += found[i - 1];
    const values = found.map(log ? (x) => Math.exp(x * step) : (x) => x * step);
    zeros.forEach((i) => { values[i] = 0; });
    gaps.forEach((i) => { values[i] = NaN; });
    return values;
  }

  /* A packed table as the text of a CSV file. */
  async function table(id) {
    const [{ rows, columns }, read] = await unpacked(id);
    const cells = columns.map((column) => cellsOf(column, rows, read));
    const lines = Array.from({ length: rows }, (_, i) => cells.map((cell) => cell[i]).join(","));
    return [columns.map((column) => column.name).join(","), ...lines, ""].join("\n");
  }

  function cellsOf(column, rows, read) {
    if ("levels" in column) return Array.from(read(column), (code) => column.levels[code] ?? "");
    if ("first" in column) {
      const step = (column.last - column.first) / (rows - 1);
      return Array.from({ length: rows }, (_, i) => +(column.first + i * step).toPrecision(9));
    }
    return Array.from(read(column), (x) => (Number.isNaN(x) ? "" : +x.toPrecision(7)));
  }

  /* A packed figure for plotly.js. */
  async function plot(id) {
    const [header, read] = await unpacked(id);
    const whole = (part) => {
      if (part === null || typeof part !== "object") return part;
      if (part.packed) return matrix(read(part.packed), part.packed.width);
      if (Array.isArray(part)) return part.map(whole);
      return Object.fromEntries(Object.entries(part).map(([key, one]) => [key, whole(one)]));
    };
    return whole(header);
  }

  function matrix(values, width) {
    if (!width) return values;
    return Array.from({ length: values.length / width }, (_, i) => values.subarray(i * width, (i + 1) * width));
  }

  /* Downloads. */
  const TYPES = { svg: "image/svg+xml", pdf: "application/pdf", csv: "text/csv;charset=utf-8" };

  async function content(link) {
    const id = link.dataset.held;
    if (id) return document.getElementById(id).dataset.kind === "table" ? table(id) : held(id).arrayBuffer();
    return new XMLSerializer().serializeToString(link.closest("figure").querySelector(".static svg"));
  }

  async function handOut(event) {
    const link = event.currentTarget;
    event.preventDefault();
    const name = link.getAttribute("download");
    const type = TYPES[name.split(".").pop()] ?? "application/octet-stream";
    const copy = document.createElement("a");
    copy.href = URL.createObjectURL(new Blob([await content(link)], { type }));
    copy.download = name;
    copy.click();
    setTimeout(() => URL.revokeObjectURL(copy.href), 60000);
    say(`${name} saved`);
  }

  /* Charts. */
  const CONFIG = { responsive: true, displaylogo: false, displayModeBar: true, scrollZoom: false,
    modeBarButtonsToRemove: ["select2d", "lasso2d"], showSendToCloud: false,
    toImageButtonOptions: { scale: 2 } };
  let library;

  function plotly() {
    library ??= held("held-charts").text().then((code) => {
      const script = document.createElement("script");
      script.textContent = code;
      document.head.append(script);
      return window.Plotly;
    });
    return library;
  }

  async function draw(figure) {
    const [Plotly, { data, layout }] = [await plotly(), await plot(figure.dataset.plot)];
    const box = figure.querySelector(".chart");
    figure.classList.add("live");
    dropLegend(layout);
    if (box.clientWidth < 600) makeRoom(layout);
    try {
      const config = { ...CONFIG, toImageButtonOptions: { ...CONFIG.toImageButtonOptions, filename: figure.id } };
      await Plotly.newPlot(box, data, layout, config);
      addToggles(figure.querySelector(".toggles"), box, Plotly);
    } catch (error) {
      figure.classList.remove("live");
      throw error;
    }
  }

  /* The page has buttons in its place; its room below the axis is not needed. */
  function dropLegend(layout) {
    if (!layout.showlegend) return;
    const { margin, legend, height } = layout;
    const room = margin.b + legend.y * (height - margin.t - margin.b);
    layout.showlegend = false;
    layout.height -= room;
    margin.b -= room;
  }

  /* On a narrow screen the buttons of a chart would lie on its heading. */
  function makeRoom(layout) {
    layout.margin.t += 26;
    layout.height += 26;
  }

  /* One button a curve, for all panels; in place of the chart's own legend, which no key reaches. */
  function addToggles(place, box, Plotly) {
    const groups = new Map();
    box.data.forEach((trace, i) => {
      if (!trace.legendgroup) return;
      const group = groups.get(trace.legendgroup) ?? { name: trace.name, rank: trace.legendrank ?? 1000, line: trace.line, traces: [] };
      group.traces.push(i);
      groups.set(trace.legendgroup, group);
    });
    if (groups.size < 2) return;
    place.replaceChildren(...[...groups.values()].sort((a, b) => a.rank - b.rank).map((group) => toggle(group, box, Plotly)));
  }

  function toggle({ name, line, traces }, box, Plotly) {
    const button = document.createElement("button");
    button.type = "button";
    button.setAttribute("aria-pressed", "true");
    button.innerHTML = '<svg width="34" height="10" aria-hidden="true"><line x1="0" x2="34" y1="5" y2="5"/></svg>';
    const sample = button.querySelector("line").style;
    Object.assign(sample, { stroke: line?.color ?? "#000", strokeWidth: line?.width ?? 2 });
    if (line?.dash?.includes("px")) sample.strokeDasharray = line.dash;
    button.append(name);
    button.addEventListener("click", () => {
      const shown = button.getAttribute("aria-pressed") === "false";
      button.setAttribute("aria-pressed", shown);
      Plotly.restyle(box, { visible: shown }, traces);
    });
    return button;
  }

  function watch() {
    const seen = new IntersectionObserver((entries) => {
      for (const { isIntersecting, target } of entries) {
        if (!isIntersecting) continue;
        seen.unobserve(target);
        draw(target).catch((error) => console.error(target.id, error));
      }
    }, { rootMargin: "300px" });
    all("figure[data-plot]").forEach((figure) => seen.observe(figure));
  }

  /* Commands to copy; boxes that scroll, for keys. */
  function addCopying() {
    if (!navigator.clipboard) return;
    for (const button of all(".copy")) {
      button.hidden = false;
      const text = button.previousElementSibling.textContent;
      button.setAttribute("aria-label", `Copy ${text}`);
      button.addEventListener("click", async () => {
        await navigator.clipboard.writeText(text);
        button.textContent = "Copied";
        say("Copied");
        setTimeout(() => { button.textContent = "Copy"; }, 2000);
      });
    }
  }

  function letKeysScroll() {
    for (const box of all(".scroll, .static")) box.tabIndex = box.scrollWidth > box.clientWidth ? 0 : -1;
  }

  addCopying();
  letKeysScroll();
  addEventListener("resize", letKeysScroll);
  if (!window.DecompressionStream) return;
  all("a[data-held], a[data-drawn]").forEach((link) => link.addEventListener("click", handOut));
  if (document.getElementById("held-charts")) watch();
})();
