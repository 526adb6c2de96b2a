// @ts-check
/**
 * Changes, sent on: as a link, as a file, as text on the clipboard.
 *
 * @module sharing
 */

const NOTED_MS = 300; // after the last change

/**
 * Copy a text.
 * @param {string} text
 * @returns {Promise<boolean>} whether the browser let it
 */
export async function copy(text) {
  try {
    await navigator.clipboard.writeText(text);
    return true;
  } catch {
    const area = document.createElement("textarea");
    area.value = text;
    document.body.append(area);
    area.select();
    const isCopied = document.execCommand("copy");
    area.remove();
    return isCopied;
  }
}

/**
 * Let the browser save a text as a file.
 * @param {string} name
 * @param {string} text
 * @param {string} type
 */
export function save(name, text, type) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([text], { type }));
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

/** What the address says of changes; of a section of the page, as its links name it, nothing. */
export function noted() {
  const words = location.hash.slice(1);
  return words.includes("=") ? words : "";
}

/** What waits to be noted: browsers refuse a page that changes its address at every key. */
let waiting = 0;

/**
 * Show what was changed in the address soon, without a step back to it.
 * @param {() => string} words
 */
export function note(words) {
  clearTimeout(waiting);
  waiting = window.setTimeout(() => {
    if (words() === noted()) return;
    try {
      const [page] = location.href.split("#");
      history.replaceState(null, "", words() ? `#${words()}` : page);
    } catch {
      // A page within another may have no address of its own.
    }
  }, NOTED_MS);
}
