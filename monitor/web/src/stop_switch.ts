// The logic of the button that stops all robots, and then releases them. A stop needs one press. A release needs two
// that follow each other at a calm pace, so that no hasty press on STOP, and no double click, releases the robots.

const confirmWithin = 3_000;  // milliseconds
const calm = 1_000;           // since the last hasty press
const doubleClick = 300;

export type Label = 'STOP' | 'RELEASE' | 'RELEASE?';

export class StopSwitch {
  stopped = false;  // all robots are, as far as is known
  private hasty = -Infinity;  // time of the last press that came after a stop, without calm between them
  private armed = -Infinity;  // time of the first press of a release

  label(now: number): Label {
    if (!this.stopped) return 'STOP';
    return now - this.armed <= confirmWithin ? 'RELEASE?' : 'RELEASE';
  }

  /// Somebody stopped the robots by other means than a press.
  hurry(now: number): void {
    this.hasty = now;
    this.armed = -Infinity;
  }

  /// What a press does.
  press(now: number): 'stop' | 'release' | undefined {
    if (!this.stopped || now - this.hasty < calm) {
      this.hurry(now);
      return this.stopped ? undefined : 'stop';
    }
    const since = now - this.armed;
    if (since < doubleClick) return undefined;
    this.armed = since <= confirmWithin ? -Infinity : now;
    return since <= confirmWithin ? 'release' : undefined;
  }
}
