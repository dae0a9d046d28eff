
const bytes = Uint8Array.from(atob(KERNEL), letter => letter.charCodeAt(0));
let api = null;
export const ready = createKernel({ wasmBinary: bytes }).then(kernel => { api = rodwakeOn(kernel); });
const opened = () => api ?? (() => { throw new Error("await ready first"); })();
export const strain = (...of) => opened().strain(...of);
export const simulate = (...of) => opened().simulate(...of);
export const encounters = (...of) => opened().encounters(...of);
export const wakes = (...of) => opened().wakes(...of);
