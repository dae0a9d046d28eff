// Nodes of the page. Text stays text, whatever it holds: nothing that comes from a file is read as markup.

function node(tag, attributes = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  made.append(...children);
  return made;
}

/** Nodes of marked.py's parts: texts and [tag, parts...]. */
const marked = parts => parts.map(part => typeof part === "string" ? part : node(part[0], {}, ...marked(part.slice(1))));

const swatch = colour => node("i", { class: "swatch", style: `background:${colour}` });

/** Behind a number or a name. */
const unitOf = ({ unit }) => unit.length ? [" ", ...marked(unit)] : [];
