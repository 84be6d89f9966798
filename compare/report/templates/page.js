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

  /* A chart for plotly.js; how its numbers are held: held_plot in render.py. */
  async function chart(id) {
    const bytes = new Uint8Array(await held(id).arrayBuffer()), end = bytes.indexOf(10);
    const restored = (key, value) => key === "bdata" ? inBase64(bytes.subarray(end + 1), ...value) : value;
    return JSON.parse(new TextDecoder().decode(bytes.subarray(0, end)), restored);
  }

  function inBase64(bytes, start, count) {
    const view = new DataView(new ArrayBuffer(4 * count));
    for (let i = 0, bits = 0; i < count; i++) {
      for (let k = 0; k < 4; k++) bits += bytes[start + k * count + i] * 256 ** k;
      view.setUint32(4 * i, bits >>>= 0, true);
    }
    return btoa(Array.from(new Uint8Array(view.buffer), (c) => String.fromCharCode(c)).join(""));
  }

  /* The numbers of a chart as the text of a CSV file: a row a point of each curve or image. */
  async function table(id) {
    const { data, layout } = await chart(id);
    const lines = [["subplot", "curve", layout.xaxis.title.text, "ordinate", "value"]];
    for (const trace of data) {
      const row = Number(trace.yaxis.slice(1) || 1), values = numbers(trace.z ?? trace.customdata ?? trace.y);
      const width = trace.z ? Number(trace.z.shape.split(",")[1]) : values.length;
      const x = places(trace, "x", width), y = trace.z && places(trace, "y", values.length / width);
      const about = [layout.annotations[row - 1].text, trace.name].map(quoted);
      const label = quoted(layout[`yaxis${row === 1 ? "" : row}`].title.text);
      values.forEach((value, i) => lines.push([...about, x[i % width], y ? y[Math.floor(i / width)] : label,
        Number.isNaN(value) ? "" : Number(value.toPrecision(6))]));
    }
    return lines.map((line) => line.join(",") + "\n").join("");
  }

  function numbers({ bdata }) {
    return [...new Float32Array(Uint8Array.from(atob(bdata), (c) => c.charCodeAt(0)).buffer)];
  }

  function places(trace, axis, count) {
    if (trace[axis]) return numbers(trace[axis]);
    return Array.from({ length: count }, (_, i) => Number((trace[`${axis}0`] + i * trace[`d${axis}`]).toPrecision(9)));
  }

  const quoted = (text) => `"${text.replaceAll("<br>", " ").replaceAll('"', '""')}"`;

  /* Downloads. */
  const TYPES = { svg: "image/svg+xml", pdf: "application/pdf", csv: "text/csv;charset=utf-8" };

  async function content(link) {
    if (link.dataset.numbers) return table(link.dataset.numbers);
    if (link.dataset.held) return held(link.dataset.held).arrayBuffer();
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
    const [Plotly, { data, layout }] = [await plotly(), await chart(figure.dataset.plot)];
    const box = figure.querySelector(".chart");
    figure.classList.add("live");
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

  /* On a narrow screen the buttons of a chart would lie on its heading. */
  function makeRoom(layout) {
    layout.margin.t += 26;
    layout.height += 26;
  }

  /* One button a curve, for all panels; a legend of the chart's own no key would reach. */
  function addToggles(place, box, Plotly) {
    const groups = new Map();
    box.data.forEach((trace, i) => {
      if (!trace.legendgroup) return;
      const group = groups.get(trace.legendgroup) ?? { name: trace.name, rank: trace.legendrank, line: trace.line, traces: [] };
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
  all("a[data-held], a[data-numbers], a[data-drawn]").forEach((link) => link.addEventListener("click", handOut));
  if (document.getElementById("held-charts")) watch();
})();
