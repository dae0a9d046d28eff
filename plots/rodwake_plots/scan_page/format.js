// Numbers as text.

const RAISED = { "-": "⁻", 0: "⁰", 1: "¹", 2: "²", 3: "³", 4: "⁴", 5: "⁵", 6: "⁶", 7: "⁷", 8: "⁸", 9: "⁹" };
const element = id => document.getElementById(id);

/** 12 345 */
const grouped = count => String(count).replace(/\B(?=(\d{3})+$)/g, "\u2009");

function power(exponent) {
  return "10" + [...String(exponent)].map(sign => RAISED[sign]).join("");
}

/** With so many digits at most; a power of ten only where plain digits would be unreadable. */
function shown(value, digits = 5) {
  if (!Number.isFinite(value)) return "–";
  const [mantissa, exponent] = value.toExponential(digits - 1).split("e");
  if (+exponent >= -4 && +exponent < Math.max(digits, 6)) return signed(String(+value.toPrecision(digits)));
  return (+mantissa === 1 ? "" : signed(String(+mantissa)) + " × ") + power(+exponent);
}

const signed = text => text.replace("-", "−");
const percent = share => shown(100 * share, 2) + "\u2009%";

/** Round numbers from low to high, about so many: steps of 1, 2 or 5 times a power of ten. */
function roundNumbers(low, high, wanted) {
  const raw = (high - low) / wanted, decade = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map(one => one * decade).find(one => one >= raw * 0.999);
  const first = Math.ceil(low / step - 1e-9), last = Math.floor(high / step + 1e-9);
  return Array.from({ length: last - first + 1 }, (_, index) => (first + index) * step);
}

/** [{at: log10, text}]: decades, and 2 and 5 between few of them; the others without text. */
function decades(low, high, wanted) {
  if (high - low < 1) return roundNumbers(10 ** low, 10 ** high, wanted).filter(value => value > 0)
    .map(value => ({ at: Math.log10(value), text: shown(value, 4) }));
  const every = Math.ceil((high - low) / wanted), found = [];
  for (let decade = Math.floor(low); decade <= high; ++decade)
    for (let digit = 1; digit < 10; ++digit) {
      const at = decade + Math.log10(digit);
      const named = digit === 1 ? decade % every === 0 : high - low < 2 && (digit === 2 || digit === 5);
      const text = named ? shown(+(digit + "e" + decade), 4) : "";
      if (at >= low - 1e-9 && at <= high + 1e-9) found.push({ at, text });
    }
  return found;
}
