// Small helpers for the page's elements.

export function byId<T extends Element = HTMLElement>(id: string): T {
  const found = document.getElementById(id);
  if (!found) throw new Error(`the page has no #${id}`);
  return found as Element as T;
}

export function element<K extends keyof HTMLElementTagNameMap>(
  tag: K, properties: Partial<HTMLElementTagNameMap[K]> = {}, ...children: (Node | string)[]
): HTMLElementTagNameMap[K] {
  const made = Object.assign(document.createElement(tag), properties);
  made.append(...children);
  return made;
}

/// For a node that holds only text. Writes only a different text, because the browser lays out again whatever is
/// written. Writes into the same text node, which costs less than a new one.
export function setText(node: Node, text: string): void {
  const held = node.firstChild ?? node;
  if (!(held instanceof Text)) node.textContent = text;
  else if (held.data !== text) held.data = text;
}

/// A sign of the sheet in index.html.
export function sign(id: string): SVGSVGElement {
  const svg = document.createElementNS('http://www.w3.org/2000/svg', 'svg');
  svg.setAttribute('class', `sign ${id}`);
  svg.setAttribute('aria-hidden', 'true');
  const use = document.createElementNS('http://www.w3.org/2000/svg', 'use');
  use.setAttribute('href', `#${id}`);
  svg.append(use);
  return svg;
}
