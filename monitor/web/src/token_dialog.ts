// The dialog in which an operator gives the token, or gives control up.
import {byId} from './dom.ts';

export class TokenDialog {
  readonly opener = byId<HTMLButtonElement>('control-open');
  private readonly dialog = byId<HTMLDialogElement>('token-dialog');
  private readonly input = byId<HTMLInputElement>('token');
  private readonly name = byId<HTMLInputElement>('operator');
  private readonly failure = byId('token-failure');

  constructor(onToken: (token: string, name: string) => void, onLeave: () => void, name: string) {
    this.name.value = name;
    this.opener.addEventListener('click', () => { if (!this.dialog.open) this.dialog.show(); });  // not modal: STOP stays at hand
    byId('token-close').addEventListener('click', () => this.dialog.close());
    byId('control-leave').addEventListener('click', () => {
      this.dialog.close();
      onLeave();
    });
    byId('token-form').addEventListener('submit', (event) => {
      event.preventDefault();
      this.fail('');
      onToken(this.input.value.trim(), this.name.value.trim());
    });
  }

  show(isOn: boolean): void {
    this.opener.hidden = false;
    this.opener.ariaPressed = String(isOn);
    byId('token-form').hidden = isOn;
    byId('control-on').hidden = !isOn;
    if (!isOn) return;
    this.input.value = '';
    this.fail('');
    this.dialog.close();
  }

  hide(): void {
    this.opener.hidden = true;
    this.dialog.close();
  }

  get isOpen(): boolean {
    return this.dialog.open;
  }

  fail(why: string): void {
    this.failure.textContent = why;
    this.failure.hidden = why === '';
  }
}
