// Sliders, numbers, choices and presets: each changes the state and follows it.

/** A slider and a number for a parameter, with what its key means. */
function sliderOf(parameter, store) {
  const { name } = parameter, id = `slider-${name}`;
  const slider = make("input", { type: "range", id, min: "0", max: "1", step: "0.0005", "aria-describedby": `${id}-means` });
  const number = make("input", { type: "number", id: `${id}-number`, step: "any", "aria-label": `${parameter.symbol}, ${parameter.short}, as a number` });
  slider.addEventListener("input", () => {
    const place = Number(slider.value), value = parameter.scale === "both" && Math.abs(place - 0.5) < 0.006 ? 0 : valueAt(parameter, place);
    store.change({ [name]: rounded(value), time: 0 }, false);
  });
  slider.addEventListener("change", () => store.settle());
  number.addEventListener("change", () => {
    const value = Number(number.value);
    if (number.value !== "" && legal(parameter, value)) store.change({ [name]: value, time: 0 });
    else follow();
  });
  function follow() {
    const value = store.state[name];
    slider.value = String(Math.min(Math.max(placeOf(parameter, value), 0), 1));
    slider.setAttribute("aria-valuetext", `${numeral(value)} ${parameter.unit}`);
    if (document.activeElement !== number || Number(number.value) !== value) number.value = String(value);
  }
  const label = make("label", { for: id }, make("i", {}, parameter.symbol), ` ${parameter.short}`);
  const unit = make("span", { class: "unit" }, pretty(parameter.unit));
  const means = make("span", { id: `${id}-means`, class: "means" }, parameter.meaning);
  return { place: make("div", { class: "slider", title: parameter.meaning }, label, number, unit, slider, means), follow, name };
}

/** A number of a pose; headings in degrees. */
function numberOfPose(parameter, store) {
  const { name } = parameter, angle = name.startsWith("theta"), worth = angle ? DEGREE : 1;
  const input = make("input", { type: "number", id: `pose-${name}`, step: angle ? "5" : "0.1" });
  input.addEventListener("change", () => {
    const value = Number(input.value) * worth;
    if (input.value !== "" && Number.isFinite(value)) store.change({ [name]: Number(value.toPrecision(12)), time: 0 });
    else follow();
  });
  function follow() { input.value = String(Number((store.state[name] / worth).toPrecision(6))); }
  const label = make("label", { for: `pose-${name}` }, make("i", {}, parameter.symbol), angle ? ", °" : "");
  return { place: make("div", { class: "pose" }, label, input), follow, name };
}

/** A list of choices; `words` of each. */
function choiceOf(select, key, words, store) {
  for (const value of CHOICES[key]) select.append(make("option", { value }, words(value)));
  select.addEventListener("change", () => store.change({ [key]: select.value }));
  return { follow: () => { select.value = store.state[key]; }, name: key };
}

/** `look` gives the view of a state. */
function presetsOf(place, store, sentence, look) {
  const buttons = PRESETS.map(preset => {
    const state = { ...START, ...preset.state };
    const button = make("button", { type: "button", class: "preset", onclick: () => store.change({ ...state, time: 0, ...look(state) }) }, preset.name);
    place.append(button);
    return { button, preset, state };
  });
  const same = state => AXES.every(key => Math.abs(state[key] - store.state[key]) < 1e-9);
  return { name: "presets", follow: () => {
    const on = buttons.find(({ state }) => same(state));
    for (const { button } of buttons) button.setAttribute("aria-pressed", String(button === on?.button));
    sentence.textContent = on ? on.preset.sentence : "Your own encounter. Undo goes back; the address holds all of it.";
  } };
}

function buildControls(store, look) {
  const controls = [];
  const add = (selector, control) => {
    if (selector) find(selector).append(control.place);
    controls.push(control);
  };
  for (const name of SLIDERS) add(name.startsWith("t_") || name.startsWith("contact") ? "#sliders-run" : ["alpha", "eta"].includes(name) ? "#sliders-medium" : "#sliders-coupling", sliderOf(PARAMETERS[name], store));
  for (const name of PLACES) add(`#poses${name.slice(-1)}`, numberOfPose(PARAMETERS[name], store));
  const named = name => `${PARAMETERS[name].symbol}  ${PARAMETERS[name].short}`;
  add(null, choiceOf(find("#across"), "across", named, store));
  add(null, choiceOf(find("#up"), "up", named, store));
  for (const key of ["colour", "lines", "source"]) add(null, choiceOf(find(`#${key}`), key, value => WORDS[value], store));
  add(null, presetsOf(find("#presets"), store, find("#sentence"), look));
  return controls;
}
