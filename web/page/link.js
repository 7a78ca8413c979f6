// Program and settings in the fragment of the address: it never leaves the browser.

export function write(settings) {
  const bytes = new TextEncoder().encode(JSON.stringify(settings));
  const letters = Array.from(bytes, (byte) => String.fromCharCode(byte)).join("");
  return btoa(letters).replaceAll("+", "-").replaceAll("/", "_").replace(/=+$/, "");
}

// What a link holds; null where it is none of this page's.
export function read(fragment) {
  try {
    const letters = atob(fragment.replace(/^#/, "").replaceAll("-", "+").replaceAll("_", "/"));
    const bytes = Uint8Array.from(letters, (letter) => letter.charCodeAt(0));
    const settings = JSON.parse(new TextDecoder().decode(bytes));
    return typeof settings?.text === "string" && typeof settings.folder === "string" ? settings : null;
  } catch {
    return null;
  }
}
