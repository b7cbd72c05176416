// Takes apart a stream of server-sent events (https://html.spec.whatwg.org/multipage/server-sent-events.html).

export interface ServerEvent {
  kind: string;
  data: string;
}

const longestEvent = 1 << 20;  // characters

export class EventParser {
  private rest = '';  // begins with an unfinished line
  private kind = '';
  private data: string[] = [];
  private length = 0;

  /// The events that end in this piece of the stream.
  feed(text: string): ServerEvent[] {
    const lines = (this.rest + text).split('\n');
    this.rest = lines.pop()!;
    const events: ServerEvent[] = [];
    for (const line of lines) this.take(line.replace(/\r$/, ''), events);
    if (this.rest.length + this.length > longestEvent) throw new Error(`an event of more than ${longestEvent} characters`);
    return events;
  }

  private take(line: string, events: ServerEvent[]): void {
    if (line === '') return this.finish(events);
    const colon = line.indexOf(':');
    if (colon === 0) return;  // a comment keeps the connection alive
    const field = colon < 0 ? line : line.slice(0, colon);
    const value = colon < 0 ? '' : line.slice(colon + 1).replace(/^ /, '');
    if (field === 'event') this.kind = value;
    if (field !== 'data') return;
    this.data.push(value);
    this.length += value.length;
  }

  private finish(events: ServerEvent[]): void {
    if (this.data.length > 0) events.push({kind: this.kind || 'message', data: this.data.join('\n')});
    this.kind = '';
    this.data = [];
    this.length = 0;
  }
}
