// Equations by KaTeX, and the search of pages that are opened from a disk: there a browser loads neither JSON nor workers, so the
// index comes as a script and the worker runs in a hidden frame.

for (const place of document.querySelectorAll(".arithmatex")) {
  const source = place.textContent.trim();
  katex.render(source.slice(2, -2), place, { displayMode: source.startsWith("\\["), throwOnError: false });
}

class FrameWorker extends EventTarget {
  constructor(url) {
    super();
    this.waiting = [];
    this.frame = document.createElement("iframe");
    this.frame.hidden = true;
    this.frame.addEventListener("load", () => this.start(new URL(url, location).href), { once: true });
    document.body.append(this.frame);
  }

  start(url) {
    const inside = this.frame.contentWindow;
    inside.postMessage = (data) => this.dispatchEvent(new MessageEvent("message", { data }));
    const script = inside.document.createElement("script");
    script.src = url;
    script.onload = () => {
      this.postMessage = (data) => inside.dispatchEvent(new MessageEvent("message", { data }));
      this.waiting.forEach((data) => this.postMessage(data));
    };
    inside.document.body.append(script);
  }

  postMessage(data) {
    this.waiting.push(data);
  }
}

if (location.protocol === "file:") {
  window.__search = { index: Promise.resolve(window.rodwakeSearchIndex) };
  window.Worker = FrameWorker;
}
