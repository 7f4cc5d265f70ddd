// Words of the page's address that it does not know: a slip of the pen would pass in silence.

/// A sentence about them, empty where there are none. A word alone may be the name of a part of the page.
/// @param afterHash, inQuery what the page knows behind '#', and behind '?'
export function strangeWords(afterHash: string[], inQuery: string[]): string {
  const hash = [...new URLSearchParams(location.hash.slice(1))]
    .filter(([key, value]) => !afterHash.includes(key) && !(value === "" && document.getElementById(key))).map(([key]) => `#${key}`);
  const query = [...new URLSearchParams(location.search)].filter(([key]) => !inQuery.includes(key)).map(([key]) => `?${key}`);
  const strange = [...hash, ...query];
  return strange.length === 0 ? "" : `The address asks for ${strange.join(", ")}, which this page does not know. Expected behind '#': ${afterHash.join(", ")}.`;
}
