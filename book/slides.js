// The slides of the lectures: reveal.js, with the arrow keys left to a net that has the focus.
Reveal.initialize({
  width: 1280,
  height: 720,
  margin: 0.05,
  center: false,
  hash: true,
  slideNumber: true,
  transition: "none",
  scrollActivationWidth: null, // the same slides on a telephone, smaller
  keyboardCondition: () => !document.activeElement?.closest(".scene"),
  plugins: [RevealNotes],
});
Reveal.on("slidechanged", ({ previousSlide }) => { // a net that nobody sees need not turn
  previousSlide?.querySelectorAll(".scene").forEach((scene) => {
    if (scene.inet) scene.inet.turning = false;
  });
});
