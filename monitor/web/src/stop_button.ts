// The button that stops all robots, and its keys: S and Pause, wherever the focus is, but not while one writes a text.
import {byId, setText} from './dom.ts';
import {StopSwitch} from './stop_switch.ts';

const longestWait = 1_000;  // milliseconds, for an answer
const keys = ['s', 'S', 'Pause'];

export class StopButton {
  private readonly button = byId<HTMLButtonElement>('stop');
  private readonly logic = new StopSwitch();
  private sent: number[] = [];  // times of commands without an answer yet

  constructor(isOn: () => boolean, private readonly act: (what: 'stop' | 'release') => Promise<void>) {
    this.button.addEventListener('click', () => this.press());
    document.addEventListener('keydown', (event) => {
      if (!isOn() || !keys.includes(event.key) || event.ctrlKey || event.metaKey || event.altKey || takesText(event.target)) return;
      event.preventDefault();
      event.stopPropagation();
      if (event.repeat) return;
      this.logic.hurry(performance.now());
      void this.tell('stop');
    }, {capture: true});  // before a panel takes the key
  }

  update(allStopped: boolean): void {
    this.logic.stopped = allStopped;
    const now = performance.now();
    const label = this.logic.label(now);
    const confirms = label === 'RELEASE?';
    const isLate = this.sent.some((at) => now - at > longestWait);
    setText(this.button.firstElementChild!, confirms ? 'PRESS AGAIN' : label);
    setText(this.button.lastElementChild!, isLate ? 'NO ANSWER' : this.sent.length > 0 ? 'sending …' : confirms ? 'to release' : 'all robots');
    const kind = `stop${label === 'STOP' ? '' : ' release'}${confirms ? ' confirms' : ''}${isLate ? ' late' : ''}`;
    if (this.button.className === kind) return;
    this.button.className = kind;
    this.button.title = label === 'STOP' ? 'All robots brake at once and stand (S or Pause)' : 'Press twice: the robots may drive again';
  }

  private press(): void {
    const what = this.logic.press(performance.now());
    if (what) void this.tell(what);
    this.update(this.logic.stopped);
  }

  private async tell(what: 'stop' | 'release'): Promise<void> {
    for (const dialog of document.querySelectorAll('dialog')) dialog.close();  // the outcome shall be seen
    const at = performance.now();
    this.sent.push(at);
    this.update(this.logic.stopped);
    await this.act(what);
    this.sent.splice(this.sent.indexOf(at), 1);
    this.update(this.logic.stopped);
  }
}

function takesText(target: EventTarget | null): boolean {
  if (target instanceof HTMLInputElement) return !['checkbox', 'range', 'button', 'submit'].includes(target.type);
  return target instanceof HTMLTextAreaElement || (target instanceof HTMLElement && target.isContentEditable);
}
