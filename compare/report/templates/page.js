/* Hands out the files that the page holds. Without it the links lead to files beside the page. */
"use strict";
(() => {
  const say = (text) => { document.getElementById("said").textContent = text; };
  const all = (what, root = document) => [...root.querySelectorAll(what)];

  /* What the page holds under an id: base64 of its gzipped bytes. */
  function held(id) {
    const packed = Uint8Array.from(atob(document.getElementById(id).textContent), (c) => c.charCodeAt(0));
    return new Response(new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip")));
  }

  /* Downloads. */
  const TYPES = { pdf: "application/pdf", csv: "text/csv;charset=utf-8" };

  /* A link to a file of the page; to its drawing, that which the page shows. */
  async function address(link, type) {
    if (!link.dataset.held) return link.closest("figure").querySelector("img").src;
    const content = await held(link.dataset.held).arrayBuffer();
    return URL.createObjectURL(new Blob([content], { type }));
  }

  async function handOut(event) {
    const link = event.currentTarget;
    event.preventDefault();
    const name = link.getAttribute("download");
    const type = TYPES[name.split(".").pop()] ?? "application/octet-stream";
    const copy = document.createElement("a");
    copy.href = await address(link, type);
    copy.download = name;
    copy.click();
    setTimeout(() => URL.revokeObjectURL(copy.href), 60000);
    say(`${name} saved`);
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
})();
