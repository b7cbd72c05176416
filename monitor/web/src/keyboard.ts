// The keys of the page, in one table for the listener and for the help.
import {byId, element} from './dom.ts';

export interface Key {
  keys: string[];
  shown: string;
  does: string;
  act: (key: string) => void;
}

/// Explains the keys in a list of the help. They have an effect while they are on.
export function listenToKeys(table: readonly Key[], listId = 'help-keys', isOn = () => true): void {
  const list = byId(listId);
  for (const {shown, does} of table)
    list.append(element('dt', {}, ...shown.split(' ').map((key) => element('kbd', {}, key))), element('dd', {}, does));
  const actions = new Map(table.flatMap((entry) => entry.keys.map((key) => [key, entry.act] as const)));
  document.addEventListener('keydown', (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || !isOn() || isTaken(event)) return;
    const act = actions.get(event.key);
    if (!act) return;
    event.preventDefault();
    act(event.key);
  });
}

/// Whether the key belongs to the focused element.
function isTaken(event: KeyboardEvent): boolean {
  const target = event.target as HTMLElement;
  if (target.closest('dialog')) return event.key !== '?';
  if (target instanceof HTMLInputElement && target.type !== 'checkbox') return event.key !== 'Escape';
  if (target instanceof HTMLSelectElement) return true;
  const presses = event.key === ' ' || event.key === 'Enter';
  return presses && (target instanceof HTMLButtonElement || target instanceof HTMLInputElement);
}
