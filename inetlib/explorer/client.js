// What the explorer's page does on its own: the address, files, the clipboard, the keyboard.
// The view smooths its own picture at rest (see `rest`): several samples a pixel cost time twice.
{
  const { getContext } = HTMLCanvasElement.prototype;
  HTMLCanvasElement.prototype.getContext = function (kind, options) {
    return getContext.call(this, kind, kind === "webgl2" ? { ...options, antialias: false } : options);
  };
}
window.inet = {
  view() { return window.trame.refs.view; },
  camera() {
    const { position, focalPoint } = this.view().getCamera();
    return { position, focalPoint };
  },
  place() {
    const box = document.querySelector(".ex-view").getBoundingClientRect();
    return box.width > 0 && box.height > 0 ? box.width / box.height : 1;
  },
  link(query) {
    // Browsers count such changes: one when the values have come to rest.
    clearTimeout(this.waiting);
    if (decodeURIComponent(window.location.search).startsWith(`?${query}`)) return;
    const change = () => window.history.replaceState(null, "", `${window.location.pathname}?${query}`);
    this.waiting = setTimeout(change, 250);
  },
  copy(text, what) {
    const done = () => window.trame.state.set("alert", `${what} copied`);
    const failed = () => window.trame.state.set("alert", "the browser did not allow copying: select the text");
    if (navigator.clipboard) navigator.clipboard.writeText(text).then(done, failed);
    else failed();
  },
  copyLink(query) {
    // With the view and the theme, so that the other page looks the same.
    clearTimeout(this.waiting);
    const dark = Number(window.trame.state.get("dark"));
    window.history.replaceState(null, "", `${window.location.pathname}?${query}&dark=${dark}&camera=${this.angles()}`);
    this.copy(window.location.href, "link");
  },
  angles() {
    // Of the camera, as `Scene.place` wants them: azimuth, elevation, roll; half the height; middle.
    const { position, focalPoint, viewUp, parallelScale } = this.view().getCamera();
    const d = position.map((x, k) => x - focalPoint[k]);
    const flat = Math.hypot(d[0], d[1]);
    const e = Math.atan2(d[2], flat);
    const a = flat < 1e-6 * Math.abs(d[2]) ? -Math.PI / 2 : Math.atan2(d[1], d[0]);
    const along = (v) => v.reduce((sum, x, k) => sum + x * viewUp[k], 0);
    const up = along([-Math.sin(e) * Math.cos(a), -Math.sin(e) * Math.sin(a), Math.cos(e)]);
    const roll = Math.atan2(along([-Math.sin(a), Math.cos(a), 0]), up);
    const degrees = [a, e, roll].map((x) => ((x * 180) / Math.PI).toFixed(1));
    const unit = 10 ** (Math.floor(Math.log10(parallelScale)) - 3);
    const lengths = [parallelScale, ...focalPoint].map((x) => Number((Math.round(x / unit) * unit).toPrecision(6)));
    return [...degrees, ...lengths].join(",");
  },
  async save(suffix, mime) {
    const data = await window.trame.trigger("save", [suffix, this.camera()]);
    if (data) window.trame.utils.download(window.trame.state.get("stem") + suffix, data, mime);
  },
  turn(right, up) {
    // Around the point in the middle; z stays upright, as with the mouse it need not.
    const c = this.view().getCamera();
    const d = c.position.map((x, k) => x - c.focalPoint[k]);
    const r = Math.hypot(...d);
    const a = Math.atan2(d[1], d[0]) + (right * Math.PI) / 180;
    const flat = Math.hypot(d[0], d[1]) < 1e-6 * r;
    const azimuth = flat ? Math.atan2(-c.viewUp[1], -c.viewUp[0]) + (right * Math.PI) / 180 : a;
    const limit = Math.PI / 2 - 1e-3;
    const e = Math.max(-limit, Math.min(limit, Math.asin(Math.max(-1, Math.min(1, d[2] / r))) + (up * Math.PI) / 180));
    const towards = [Math.cos(e) * Math.cos(azimuth), Math.cos(e) * Math.sin(azimuth), Math.sin(e)];
    const viewUp = [-Math.sin(e) * Math.cos(azimuth), -Math.sin(e) * Math.sin(azimuth), Math.cos(e)];
    this.loads = 9;
    this.view().setCamera({ ...c, position: towards.map((x, k) => c.focalPoint[k] + r * x), viewUp });
  },
  zoom(factor) {
    const c = this.view().getCamera();
    this.loads = 9;
    this.view().setCamera({ ...c, parallelScale: c.parallelScale * factor });
  },
  keys(event) {
    const step = { ArrowLeft: [-10, 0], ArrowRight: [10, 0], ArrowUp: [0, 10], ArrowDown: [0, -10] }[event.key];
    if (step) this.turn(...step);
    else if (event.key === "+" || event.key === "=") this.zoom(0.8);
    else if (event.key === "-") this.zoom(1.25);
    else if (event.key === "f") window.trame.trigger("fit", [this.place()]);
    else return;
    event.preventDefault();
  },
  tour(step) {
    // Once for a browser, by itself; 0: it is over.
    try { window.localStorage.setItem("inet-tour", "seen"); } catch { /* not allowed: it comes again */ }
    window.trame.state.set("tour", step);
    if (step) document.documentElement.dataset.tour = step;
    else delete document.documentElement.dataset.tour;
    requestAnimationFrame(() => {
      const part = document.querySelector(".ex-tour [data-target]")?.dataset.target;
      const parts = step ? [...document.querySelectorAll(part)].reverse() : [];
      parts.forEach((e) => e.scrollIntoView({ block: "nearest" }));
    });
    setTimeout(() => { // after a dialog that closes, which gives the focus back
      document.querySelector(step ? ".in-next" : ".ex-view")?.focus({ preventScroll: true });
      if (this.loads < 9) this.refit(); // the view has another size
    }, 300);
  },
  welcome() {
    let seen = window !== window.top || !document.querySelector(".in-presets");
    try { seen ||= window.localStorage.getItem("inet-tour"); } catch { seen = true; }
    if (!seen) this.tour(1);
  },
  refit() {
    window.trame.trigger("refit", [this.place()]).catch(() => {}); // the page is going: nobody waits
  },
  loads: 0,
  loaded() {
    // A camera that came before the first scene was there is lost; from 9 on it is the reader's.
    this.loads += 1;
    if (this.loads === 1) this.welcome();
    if (this.loads <= 3) this.refit();
    this.rest();
  },
  // At rest the view is drawn with two pixels or more for one of the screen, and shrunk: smooth
  // curves.  While something moves it is drawn as coarse as the screen, and with thin curves where
  // there are many, which is quicker.  Widths: [the net's own, the one that is set] by property.
  screen: Object.getOwnPropertyDescriptor(window, "devicePixelRatio").get.bind(window),
  get ratio() { return this.screen() || 1; },
  fine: 1,
  widths: new Map(),
  rest() {
    clearTimeout(this.resting);
    this.resting = setTimeout(() => this.sharpen(), 300);
  },
  sharpen(fine = Math.max(1, 2 / this.ratio)) {
    const { renderer } = this.view().$.provides.view;
    if (!renderer || this.sharp === fine > 0) return;
    this.sharp = fine > 0;
    const known = this.widths;
    this.fine = fine || 1;
    this.widths = new Map(renderer.getActors().map((actor) => {
      const of = actor.getProperty(), now = of.getLineWidth(), before = known.get(of);
      const own = before?.[1] === now ? before[0] : now;
      const shown = this.sharp ? own * this.ratio * this.fine : own > 2 ? own : Math.min(own, 1);
      of.setLineWidth(shown);
      return [of, [own, shown]];
    }));
    this.view().resize();
  },
  ended() {
    // The page stays as it is and can be turned; what asks the program is dead.
    this.banner("The program that made this page has ended. Start it again with \u201cinet explore\u201d "
      + "and open the address it prints, or run the cell of the notebook again.");
    document.querySelectorAll(".ex-side, .ex-status, .ex-tools, .v-app-bar").forEach((e) => { e.inert = true; });
  },
  banner(words) {
    const box = Object.assign(document.createElement("div"), { className: "ex-banner", textContent: words });
    box.setAttribute("role", "alert");
    document.body.append(box);
  },
  arrive() {
    this.listen();
    window.trame.client.onConnectionClose(() => this.ended());
    if (!document.createElement("canvas").getContext("webgl2")) {
      this.banner("This browser does not draw the net: WebGL 2 is missing or switched off. Switch hardware "
        + "acceleration on in its settings, or open this address in another one. The numbers are those of "
        + "the net, and Save writes its picture.");
    }
    const dark = window.matchMedia("(prefers-color-scheme: dark)").matches;
    window.trame.trigger("arrive", [window.location.search, dark, this.place()]);
  },
};
Object.defineProperty(window, "devicePixelRatio", { get: () => window.inet.ratio * window.inet.fine });
for (const name of ["keydown", "pointerdown", "wheel"]) {
  document.addEventListener(name, (event) => {
    if (!window.inet.sharp) window.inet.rest();
    if (event.target.closest?.(".ex-view") && name !== "keydown") window.inet.loads = 9;
  }, { capture: true, passive: true });
}
document.addEventListener("keydown", (event) => {
  if (event.key === "Escape" && window.trame.state.get("tour")) window.inet.tour(0);
});
(function wait(tries) {
  if (window.trame && window.trame.refs.view && document.querySelector(".ex-view")) window.inet.arrive();
  else if (tries) setTimeout(wait, 50, tries - 1);
})(600);
