// Touching the net: the face under the pointer, a finger or the keyboard is drawn over the view.
Object.assign(window.inet, {
  held: false, // a face that was clicked, tapped or reached by keys stays when the pointer leaves
  listen() {
    const view = document.querySelector(".ex-view");
    const outside = (event) => event.target.closest("button, a");
    let pressed = null;
    const on = (name, act) => view.addEventListener(name, act, { capture: true, passive: true });
    on("pointerdown", (e) => { pressed = outside(e) ? null : [e.clientX, e.clientY]; });
    on("pointermove", (e) => {
      if (e.pointerType !== "touch" && !e.buttons && !this.held && !outside(e)) this.at(e);
    });
    on("pointerup", (e) => {
      if (pressed && Math.hypot(e.clientX - pressed[0], e.clientY - pressed[1]) < 6) this.hold(e);
      pressed = null;
    });
    view.addEventListener("pointerleave", (e) => {
      if (e.pointerType !== "touch" && !this.held) this.touch("none");
    });
    view.addEventListener("keydown", (e) => this.step(e));
    document.addEventListener("keydown", (e) => this.undo(e));
    let drags = 0;
    const drag = (number) => window.trame.state.set("drag", number);
    document.addEventListener("pointerdown", (e) => e.target.closest(".v-slider") && drag((drags += 1)), true);
    document.addEventListener("pointerup", () => drag(0), true);
    window.trame.state.watch(["face", "marks"], (face, marks) => this.follow(face, marks));
  },
  at(event) {
    // In halves of the view's height from its middle, to the right and up.
    const box = document.querySelector(".ex-view canvas").getBoundingClientRect();
    const x = event.clientX - box.left - box.width / 2;
    const y = box.top + box.height / 2 - event.clientY;
    return this.touch("at", (2 * x) / box.height, (2 * y) / box.height);
  },
  async hold(event) {
    this.held = await this.at(event);
  },
  async step(event) {
    const how = { Enter: "middle", n: "next", p: "previous", Escape: "none" }[event.key];
    if (!how || event.ctrlKey || event.metaKey || event.target.closest("button")) return;
    event.preventDefault();
    this.held = await this.touch(how, 0, 0);
  },
  undo(event) {
    const key = event.key.toLowerCase();
    if (!(event.ctrlKey || event.metaKey) || !["z", "y"].includes(key)) return;
    if (event.target.matches("input[inputmode=decimal], input[type=number], textarea")) return;
    window.trame.trigger(key === "y" || event.shiftKey ? "redo" : "undo");
    event.preventDefault();
  },
  touch(how, x, y) {
    // One question at a time; of those that wait only the last is asked.
    this.question = [how, this.sight(), x, y];
    this.answer ??= this.ask().finally(() => { this.answer = null; });
    return this.answer;
  },
  async ask() {
    let touched = false; // whether there is a face
    while (this.question) {
      const question = this.question;
      this.question = null;
      touched = await window.trame.trigger("touch", question);
    }
    return touched;
  },
  sight() {
    const { position, focalPoint, viewUp, parallelScale } = this.view().getCamera();
    return { position, focalPoint, viewUp, parallelScale };
  },
  follow(face, marks) {
    // Drawn again whenever the camera or the size of the view has changed.
    this.quad = face?.quad;
    this.marks = marks ?? [];
    this.drawn = null;
    if (!this.quad) this.held = false;
    if (this.following) return;
    const frame = () => {
      this.following = this.draw() && requestAnimationFrame(frame);
    };
    frame();
  },
  draw() {
    const view = document.querySelector(".ex-view");
    if (!view) return false; // the page is going
    const svg = view.querySelector(".ex-touch") ?? view.appendChild(document.createElementNS("http://www.w3.org/2000/svg", "svg"));
    svg.setAttribute("class", "ex-touch");
    if (!this.quad && !this.marks.length) {
      svg.innerHTML = "";
      return false;
    }
    const { width, height } = view.getBoundingClientRect();
    const sight = this.sight();
    const now = JSON.stringify([sight, width, height]);
    if (now !== this.drawn) {
      const place = this.projection(sight, width, height);
      const marked = this.marks.map((quad) => this.mark(quad.map(place))).join("");
      svg.innerHTML = marked + (this.quad ? this.shape(this.quad.map(place)) : "");
      this.drawn = now;
    }
    return true;
  },
  projection(sight, width, height) {
    const minus = (a, b) => a.map((x, k) => x - b[k]);
    const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    const near = minus(sight.position, sight.focalPoint);
    const axes = [cross(sight.viewUp, near)];
    axes.push(cross(near, axes[0]));
    const [right, up] = axes.map((a) => a.map((x) => (x * height) / 2 / sight.parallelScale / Math.hypot(...a)));
    return (point) => {
      const d = minus(point, sight.focalPoint);
      return [width / 2 + dot(d, right), height / 2 - dot(d, up)];
    };
  },
  mark(quad) {
    const [x, y] = [0, 1].map((k) => quad.reduce((sum, p) => sum + p[k] / 4, 0));
    const small = Math.max(...quad.map((p) => Math.hypot(p[0] - x, p[1] - y))) < 12;
    const ring = small ? `<circle class="ring" cx="${x}" cy="${y}" r="14"/>` : "";
    return `<path class="mark" d="M${quad.join("L")}Z"/>${ring}`;
  },
  shape(quad) {
    const line = (name, a, b) => `<path class="${name}" d="M${a}L${b}"/>`;
    const middle = (a, b) => [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2];
    const edges = quad.map((a, k) => [a, quad[(k + 1) % 4]]);
    const mids = edges.map(([a, b]) => middle(a, b));
    const sides = mids.map((a, k) => [a, mids[(k + 1) % 4]]);
    return [
      `<path class="halo" d="M${quad.join("L")}Z"/><path class="fill" d="M${mids.join("L")}Z"/>`,
      ...edges.map((ends, k) => line(`edge ${"vu"[k % 2]}`, ...ends)),
      line("medial u", mids[0], mids[2]) + line("medial v", mids[1], mids[3]),
      ...sides.map((ends, k) => line(`side ${["d1", "d2"][k % 2]}`, ...ends)),
    ].join("");
  },
});
