// The token of an operator, and the name that others see with the orders. The token comes from the form, or once from the
// address (#token=…), and lasts as long as the tab.

const key = 'coppice-token';
const nameKey = 'coppice-operator';

/// Takes it out of the address, so that it does not stay in sight or in a bookmark.
export function takeToken(): string {
  const fragment = new URLSearchParams(location.hash.slice(1));
  const given = fragment.get('token');
  if (given === null) return kept();
  fragment.delete('token');
  const rest = fragment.toString();
  history.replaceState(null, '', location.pathname + location.search + (rest && `#${rest}`));
  keepToken(given);
  return given;
}

/// Nothing to keep: forgets it.
export function keepToken(token: string): void {
  try {
    if (token) sessionStorage.setItem(key, token);
    else sessionStorage.removeItem(key);
  } catch {
    // storage is forbidden: the token lasts until the page is loaded again
  }
}

function kept(): string {
  try {
    return sessionStorage.getItem(key) ?? '';
  } catch {  // storage is forbidden
    return '';
  }
}

/// The name outlives the tab, as it is no secret.
export function keepName(name: string): void {
  try {
    localStorage.setItem(nameKey, name);
  } catch {
    // storage is forbidden: the name lasts until the page is loaded again
  }
}

export function keptName(): string {
  try {
    return localStorage.getItem(nameKey) ?? '';
  } catch {
    return '';
  }
}
