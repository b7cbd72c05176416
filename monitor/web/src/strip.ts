// A strip that scrolls sideways. A button at each end appears if there is more beyond it.

const step = 0.8;  // of the visible width

export function showWhatIsBeyond(strip: HTMLElement, left: HTMLElement, right: HTMLElement): void {
  const update = () => {
    const most = strip.scrollWidth - strip.clientWidth;
    left.hidden = strip.scrollLeft <= 1;
    right.hidden = strip.scrollLeft >= most - 1;
  };
  const turn = (direction: number) => strip.scrollBy({left: direction * step * strip.clientWidth, behavior: 'smooth'});
  left.addEventListener('click', () => turn(-1));
  right.addEventListener('click', () => turn(1));
  strip.addEventListener('scroll', update, {passive: true});
  new ResizeObserver(update).observe(strip);
  update();
}
