// The button that stops all robots, and its keys: S and Pause, wherever the focus is, but not while one writes a text.
import {byId, setText} from './dom.ts';
import {StopSwitch} from './stop_switch.ts';

const keys = ['s', 'S', 'Pause'];

export class StopButton {
  private readonly button = byId<HTMLButtonElement>('stop');
  private readonly logic = new StopSwitch();
  private underWay = 0;  // commands without an answer yet

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
    document.addEventListener('click', (event) => {
      if (isOn() && event.target instanceof HTMLDialogElement && holds(this.button, event)) this.press();
    });  // the backdrop of a dialog lies over the button
  }

  update(allStopped: boolean): void {
    this.logic.stopped = allStopped;
    const label = this.logic.label(performance.now());
    const confirms = label === 'RELEASE?';
    setText(this.button.firstElementChild!, confirms ? 'PRESS AGAIN' : label);
    setText(this.button.lastElementChild!, this.underWay > 0 ? 'sending …' : confirms ? 'to release' : 'all robots');
    const kind = `stop${label === 'STOP' ? '' : ' release'}${confirms ? ' confirms' : ''}`;
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
    ++this.underWay;
    this.update(this.logic.stopped);
    await this.act(what);
    --this.underWay;
    this.update(this.logic.stopped);
  }
}

function takesText(target: EventTarget | null): boolean {
  if (target instanceof HTMLInputElement) return !['checkbox', 'range', 'button', 'submit'].includes(target.type);
  return target instanceof HTMLTextAreaElement || (target instanceof HTMLElement && target.isContentEditable);
}

function holds(button: HTMLElement, {clientX: x, clientY: y}: MouseEvent): boolean {
  const {left, right, top, bottom} = button.getBoundingClientRect();
  return x >= left && x <= right && y >= top && y <= bottom;
}
